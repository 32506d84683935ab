#!/usr/bin/env python3
"""Cracks along a rigid wall: what a bar between rigid plates, and a strip peeled from a wall, dissipate of G_f times their area.

    python3 walls.py PROGRAM OUT

PROGRAM is a build of `pullout`, OUT a folder for meshes and runs. Lengths in mm, forces in N.
"""
import argparse
import csv
import json
import subprocess
from pathlib import Path

STRENGTH, ENERGY, LENGTH = 3.0, 0.1, 0.5
LAW = {"plugin": "concrete_phase_field", "props": {
    "E": 30000.0, "nu": 0.2, "f_t": STRENGTH, "G_f": ENERGY, "l": LENGTH, "p": 2.0, "a_2": -0.5, "a_3": 0.0, "A_c": 18.05,
    "B_c": 1.05, "Y_c0": 5e-4, "beta": 0.158, "zeta_c": 0.0}}
PLATE = {"plugin": "linear_elastic", "props": {"E": 3e7, "nu": 0.2}}
# length, columns, height, rows, opening at the end, greatest increment as a part of it
SHAPES = {"bar": (0.5, 2, 5.0, 20, 0.08, 0.02), "peel": (4.0, 16, 2.5, 10, 0.2, 0.005)}
# what the field is at the wall: whether it is held at 0, goes on beyond, begins with a notch
WALLS = {"free": (False, False, False), "held": (True, False, False), "continued": (False, True, False),
         "free, notch": (False, False, True), "continued, notch": (False, True, True)}
NOTCH, BEYOND, PLATE_HEIGHT = 0.76, 1.0, 10.0


def write_mesh(path, shape, goes_on):
    """Q8 elements in columns and rows; the strip is below a stiff plate that turns about its right end."""
    length, columns, height, rows, _, _ = SHAPES[shape]
    nodes, elements = {}, []

    def node(x, y):
        return nodes.setdefault((round(x, 9), round(y, 9)), len(nodes) + 1)

    def block(start, end, count, part):
        for row in range(count):
            for column in range(columns):
                left, right = length * column / columns, length * (column + 1) / columns
                low, high = start + (end - start) * row / count, start + (end - start) * (row + 1) / count
                x, y = 0.5 * (left + right), 0.5 * (low + high)
                corners = [node(left, low), node(right, low), node(right, high), node(left, high)]
                elements.append((part, corners + [node(x, low), node(right, y), node(x, high), node(left, y)]))

    block(0.0, height, rows, 1)
    if shape == "peel":
        block(height, height + PLATE_HEIGHT, 2, 2)
    if goes_on:
        block(-BEYOND, 0.0, 4, 3)
    sets = {"wall": lambda x, y: y <= 0, "edge": lambda x, y: y == 0, "notch": lambda x, y: y == 0 and x <= NOTCH,
            "top": lambda x, y: y == height, "pull": lambda x, y: (x, y) == (0, height),
            "pin": lambda x, y: (x, y) == (length, height)}
    parts = {1: "strip", 2: "plate", 3: "beyond"}
    used = sorted({part for part, _ in elements})
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(sets) + len(used))]
    lines += [f'0 {tag} "{name}"' for tag, name in enumerate(sets, 10)] + [f'2 {part} "{parts[part]}"' for part in used]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{tag} {x:.12g} {y:.12g} 0" for (x, y), tag in nodes.items()]
    rows = [f"15 2 {tag} {tag} {node}" for tag, is_in in enumerate(sets.values(), 10)
            for (x, y), node in nodes.items() if is_in(x, y)]
    rows += [f"16 2 {part} {part} " + " ".join(map(str, element)) for part, element in elements]
    lines += ["$EndNodes", "$Elements", str(len(rows))] + [f"{k} {row}" for k, row in enumerate(rows, 1)]
    path.write_text("\n".join([*lines, "$EndElements", ""]))
    return [parts[part] for part in used]


def run(program, out, shape, wall):
    is_held, goes_on, has_notch = WALLS[wall]
    length, _, _, _, opening, largest = SHAPES[shape]
    name = f"{shape}-{wall}".replace(", ", "-")
    parts = write_mesh(out / f"{name}.msh", shape, goes_on)
    fixed = [{"nodes": "top", "value": 0.0}]
    fixed += [{"nodes": "edge", "value": 0.0}] * is_held + [{"nodes": "notch", "value": 1.0}] * has_notch
    is_peeled = shape == "peel"
    case = {
        "kind": "pullout", "title": name, "mesh": {"file": f"{name}.msh"},
        "parts": {part: {"model": "plane_strain", "thickness": 1.0, "material": PLATE if part == "plate" else LAW}
                  for part in parts},
        "grip": {"nodes": "pull" if is_peeled else "top", "direction": [0, 1], "lateral": "free" if is_peeled else "fixed"},
        "supports": {"wall": {"direction": "both"}} | ({"pin": {"direction": "both"}} if is_peeled else {}),
        "steps": [{"slip": opening, "increments": {"initial": 0.002, "maximum": largest, "minimum": 1e-9}}],
        "output": {"vtu": False, "plots": False},
        "field": {"kind": "phase_field", "parts": [part for part in parts if part != "plate"], "fixed": fixed},
    }
    path = out / f"{name}.json"
    path.write_text(json.dumps(case, indent=1))
    subprocess.run([program, "run", path, "--out", path.with_suffix(""), "--overwrite", "--quiet"], check=True)
    with open(path.with_suffix("") / "history.csv", newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    whole = ENERGY * length
    peak = max(row["load"] for row in rows) / (STRENGTH * length)
    print(f"{name}: peak {peak:.3f}, dissipation {rows[-1]['damage_energy'] / whole:.3f}, "
          f"field_energy {rows[-1]['field_energy'] / whole:.3f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for shape in SHAPES:
        for wall in WALLS:
            if shape == "peel" or not wall.endswith("notch"):
                run(options.program.resolve(), options.out, shape, wall)


if __name__ == "__main__":
    main()
