"""What the fit recovers, over many knobs and draws of the noise: `python benches/study_recovery.py`.

Three studies, each printed as a table and written to `benches/results/*.json`: the paper's Table 2, random
knobs from no starting values, and random knobs on a rig with the paper's sensors.
"""

import argparse
import json
from pathlib import Path

import study_basin
import study_rig
import study_table2

RESULTS = Path(__file__).with_name("results")


def main() -> None:
    parser = argparse.ArgumentParser(description="Statistical studies of the fit.")
    parser.add_argument("--draws", type=int, default=1000, help="draws of the noise for Table 2")
    parser.add_argument("--knobs", type=int, default=200, help="knobs fitted from no starting values")
    parser.add_argument("--peers", type=int, default=30, help="of these, knobs that the peers fit too")
    parser.add_argument("--rig", type=int, default=300, help="knobs per motion on the rig")
    parser.add_argument("--springs", type=int, default=30, help="knobs with a spring per motion")
    counts = parser.parse_args()
    table2 = study_table2.run(counts.draws)
    basin = study_basin.run(counts.knobs, counts.peers)
    rig = study_rig.run(counts.rig, counts.springs)
    RESULTS.mkdir(exist_ok=True)
    for name, result, lines in (
        ("table2", table2, study_table2.report(table2)),
        ("basin", basin, study_basin.report(basin)),
        ("rig", rig, study_rig.report(rig)),
    ):
        text = list(lines)
        print(*text, "", sep="\n")
        document = json.dumps({"report": text, "result": result}, indent=0)
        (RESULTS / f"{name}.json").write_text(document + "\n", "utf-8")


if __name__ == "__main__":
    main()
