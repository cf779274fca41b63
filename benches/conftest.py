"""What pytest leaves alone here."""

# Programs that read a file named on their command line; what plants faults, by a parser of its own.
collect_ignore = ["scripts", "planting.py", "study_mutants.py"]
