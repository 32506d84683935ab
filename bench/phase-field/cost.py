#!/usr/bin/env python3
"""What runs cost, as a table: increments, iterations, passes, factorisations, solutions, processor time.

    python3 cost.py FOLDER ...

Each FOLDER has the results of a run of `pullout`, such as those of beams.py here and in ../crack-band. Iterations are those of accepted
increments. Factorisations are those of the displacements; that of the field is made once in each pass.
"""
import argparse
import csv
import json
from pathlib import Path

COUNTS = ["field_passes", "factorisations", "contact_factorisations", "solutions"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", type=Path, nargs="+")
    shown = ["run", "slip", "increments", "iterations", *COUNTS, "cpu_s"]
    print("| " + " | ".join(shown) + " |", "|---" * len(shown) + "|", sep="\n")
    for folder in parser.parse_args().folders:
        with open(folder / "history.csv", newline="") as history:
            rows = list(csv.DictReader(history))
        summary = json.loads((folder / "summary.json").read_text())
        iterations = sum(int(float(row["iterations"])) for row in rows)
        counts = [summary["statistics"][name] for name in COUNTS]
        row = [folder.name, rows[-1]["slip"], len(rows) - 1, iterations, *counts, f"{summary['cpu_time_s']:.1f}"]
        print("| " + " | ".join(map(str, row)) + " |")


if __name__ == "__main__":
    main()
