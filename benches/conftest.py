"""What pytest leaves alone here: programs that read a file named on their command line."""

collect_ignore = ["scripts"]
