#!/usr/bin/env python3
"""Notched beams whose crack is a phase field, against a cohesive crack with the same opening curve.

    python3 beams.py PROGRAM OUT [--only WORD ...]

PROGRAM is the release build of `pullout`, OUT a folder for meshes and runs. Each run adds a line to OUT/results.csv; what stands
there is not run again. OUT/table.md has the table. Needs the Python module gmsh. The meshes are those of ../crack-band.
"""
import argparse
import csv
import json
import resource
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "crack-band"))
import beams  # noqa: E402

# the cohesive crack with the curve of these parameters: peak, N, and work up to 0.3 mm, N mm
REFERENCE = 1348.6, 170.9
COLUMNS = ["mesh", "kind", "l", "h", "elements", "increments", "coupling", "peak_N", "peak_ratio", "work_Nmm", "work_ratio",
           "field_over_damage", "iterations", "cpu_s", "exit"]
# mesh, seed, kind, l, h, increments, coupling
RUNS = [("aligned", 0, "T6", 5.0, 5.0, 60, "staggered"), ("free", 1, "T6", 5.0, 5.0, 60, "staggered"),
        ("aligned", 0, "T6", 5.0, 2.5, 60, "staggered")]
RUNS += [("free", seed, "T6", 5.0, 2.5, 60, "staggered") for seed in range(1, 6)]
RUNS += [("free", seed, "T6", 5.0, 5.0, 60, "staggered") for seed in range(2, 6)]
RUNS += [("aligned", 0, "T6", 5.0, 5.0, 150, coupling) for coupling in ("staggered", "one_pass")]
RUNS += [(mesh, seed, "T6", 5.0, 2.5, 150, "one_pass") for mesh, seed in (("aligned", 0), ("free", 1))]
RUNS += [(mesh, seed, kind, 5.0, 2.5, 60, "staggered")
         for kind in ("Q8", "Q4", "T3") for mesh, seed in (("aligned", 0), ("free", 1))]
RUNS += [("aligned", 0, "T6", 2.5, 1.25, 60, "staggered"), ("free", 1, "T6", 2.5, 1.25, 60, "staggered")]


def run(program, out, mesh, seed, kind, length, size, increments, coupling):
    name = f"{mesh}{seed or ''}-{kind}-{size:g}"
    nodes, elements, sets = beams.free(kind, size, seed) if seed else beams.MESHES[mesh](kind, size)
    beams.write_mesh(out / f"{name}.msh", kind, nodes, elements, sets)
    case = json.loads((HERE.parents[1] / "cases/verification/notched-beam-phase-field.json").read_text())
    case["mesh"] = {"file": f"{name}.msh"}
    case["parts"]["beam"]["material"]["props"]["l"] = length
    case["field"]["coupling"] = coupling
    largest = beams.END / increments
    case["steps"][0]["increments"] = {"initial": largest / beams.END, "maximum": largest / beams.END, "minimum": 1e-9}
    case["output"] = {"vtu": False, "plots": False}
    path = out / f"{name}-{length:g}-{increments}-{coupling}.json"
    path.write_text(json.dumps(case, indent=1))
    results = path.with_suffix("")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(path.with_suffix(".txt"), "w") as log:
        arguments = [program, "run", path, "--out", results, "--overwrite"]
        code = subprocess.run(arguments, stdout=log, stderr=log).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = sum(getattr(after, k) - getattr(before, k) for k in ("ru_utime", "ru_stime"))
    peak, work, _ = beams.peak_and_work(results / "history.csv")
    with open(results / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    energies = float(rows[-1]["field_energy"]) / float(rows[-1]["damage_energy"])
    iterations = sum(int(float(row["iterations"])) for row in rows)
    return [f"{mesh}{seed or ''}", kind, f"{length:g}", f"{size:g}", len(elements), len(rows) - 1, coupling, f"{peak:.1f}",
            f"{peak / REFERENCE[0]:.3f}", f"{work:.1f}", f"{work / REFERENCE[1]:.3f}", f"{energies:.3f}", iterations,
            f"{cpu:.1f}", code]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*", default=[], help="runs with all these words: T6, 2.5")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    table = options.out / "results.csv"
    columns = ["run", *COLUMNS]
    done = {row["run"] for row in beams.rows_of(table, columns)}
    for case in RUNS:
        words = [str(word) for word in case]
        key = " ".join(words)
        if key not in done and all(word in words for word in options.only):
            row = run(options.program, options.out, *case)
            print(*row, flush=True)
            beams.add_row(table, [key, *row])
    rows = beams.rows_of(table, columns)
    shown = ["mesh", "kind", "l", "h", "elements", "coupling", "increments", "peak_ratio", "work_ratio", "field_over_damage",
             "iterations", "cpu_s"]
    lines = ["| " + " | ".join(shown) + " |", "|---" * len(shown) + "|"]
    lines += ["| " + " | ".join(row[name] for name in shown) + " |" for row in rows]
    (options.out / "table.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
