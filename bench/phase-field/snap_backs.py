#!/usr/bin/env python3
"""Bars and plates that snap back when they crack: the path against its closed form, and what the crack takes of G_f times its area.

    python3 snap_backs.py PROGRAM OUT [--only WORD ...]

PROGRAM is a build of `pullout`, OUT a folder for meshes and runs. Halves of Q8 elements, the crack on their line of symmetry. Softening is
linear. Lengths in mm, forces in N.
"""
import argparse
import csv
import json
import subprocess
from pathlib import Path

MODULUS, STRENGTH, LENGTH = 30000.0, 3.0, 5.0
WIDTH, HEIGHT, NOTCH, SPOT = 100.0, 150.0, 20.0, (10.0, 6.0)


def write_mesh(path, xs, ys, part_of, sets):
    """Q8 elements between the lines x and y; `part_of`: part of the middle of an element."""
    nodes, elements = {}, []

    def node(x, y):
        return nodes.setdefault((round(x, 9), round(y, 9)), len(nodes) + 1)

    for left, right in zip(xs, xs[1:]):
        for low, high in zip(ys, ys[1:]):
            x, y = 0.5 * (left + right), 0.5 * (low + high)
            corners = [node(left, low), node(right, low), node(right, high), node(left, high)]
            middles = [node(x, low), node(right, y), node(x, high), node(left, y)]
            elements.append((part_of(x, y), corners + middles))
    parts = sorted({part for part, _ in elements})
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(sets) + len(parts))]
    lines += [f'0 {tag} "{name}"' for tag, name in enumerate(sets, 10)]
    lines += [f'2 {tag} "{name}"' for tag, name in enumerate(parts, 1)] + ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{tag} {x:.12g} {y:.12g} 0" for (x, y), tag in nodes.items()] + ["$EndNodes", "$Elements"]
    rows = [f"15 2 {tag} {tag} {node}" for tag, is_in in enumerate(sets.values(), 10)
            for (x, y), node in nodes.items() if is_in(x, y)]
    rows += [f"16 2 {parts.index(part) + 1} {parts.index(part) + 1} " + " ".join(map(str, nodes_of))
             for part, nodes_of in elements]
    lines += [str(len(rows)), *(f"{tag} {row}" for tag, row in enumerate(rows, 1)), "$EndElements", ""]
    path.write_text("\n".join(lines))


def run(program, path, strengths, poisson, energy, length, slip, direction, supports, increments):
    def part(strength):
        props = {"E": MODULUS, "nu": poisson, "f_t": strength, "G_f": energy, "l": length, "p": 2.0, "a_2": -0.5, "a_3": 0.0}
        return {"model": "plane_stress", "thickness": 1.0, "material": {"plugin": "concrete_phase_field", "props": props}}

    case = {"kind": "pullout", "title": path.stem, "mesh": {"file": path.with_suffix(".msh").name},
            "parts": {name: part(strength) for name, strength in strengths.items()},
            "grip": {"nodes": "end", "direction": direction, "lateral": "free"}, "supports": supports,
            "steps": [{"slip": slip, "increments": increments}], "output": {"vtu": False, "plots": False},
            "field": {"kind": "phase_field"}}
    path.write_text(json.dumps(case, indent=1))
    results = path.with_suffix("")
    subprocess.run([program, "run", path, "--out", results, "--overwrite", "--quiet"], check=True)
    with open(results / "history.csv", newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    passes = json.loads((results / "summary.json").read_text())["statistics"]["field_passes"]
    pairs = list(zip(rows, rows[1:]))
    least = min(after["damage_energy"] - before["damage_energy"] for before, after in pairs)
    back = sum(max(before["slip"] - after["slip"], 0.0) for before, after in pairs)
    return rows, f"{len(rows)} rows, {passes} passes, turned back {back:.4f}, least dissipation of an increment {least:.1e}"


def bar(program, out, half, parts, increments):
    energy, size = 0.009, LENGTH / parts
    name = f"bar-{half:g}-{parts}-{increments or 'automatic'}"
    xs = [size * k for k in range(round(half / size) + 1)]
    sets = {"end": lambda x, y: x == 0, "middle": lambda x, y: x == half, "base": lambda x, y: y == 0}
    write_mesh(out / f"{name}.msh", xs, [0.0, 1.0], lambda x, y: "weak" if x > half - size else "bar", sets)
    elastic, opened = half * STRENGTH / MODULUS, energy / STRENGTH
    control = increments or {"initial": 0.05, "maximum": 0.05, "minimum": 1e-9}
    rows, text = run(program, out / f"{name}.json", {"bar": STRENGTH, "weak": 0.99 * STRENGTH}, 0.0, energy, LENGTH,
                     elastic + 0.002, [-1, 0], {"middle": {"direction": "x"}, "base": {"direction": "y"}}, control)
    peak = max(range(len(rows)), key=lambda k: rows[k]["load"])
    path = max(abs(row["slip"] - elastic * row["load"] / STRENGTH - opened * (1 - row["load"] / STRENGTH)) / elastic
               for row in rows[peak:] if row["load"] > 0.1 * STRENGTH)
    print(f"{name}: peak {rows[peak]['load'] / STRENGTH:.3f}, path {100 * path:.1f} %, "
          f"dissipation {rows[-1]['damage_energy'] / (0.5 * energy):.3f}, {text}", flush=True)


def plate(program, out, kind, length, parts):
    energy, size = 0.03, length / parts
    name = f"plate-{kind}-{length:g}-{parts}"
    xs = [size * k for k in range(round(WIDTH / size) + 1)]
    ys, step = [size * k for k in range(3 * parts + 1)], size
    while ys[-1] < HEIGHT:
        step *= 1.5
        ys.append(HEIGHT if ys[-1] + 1.5 * step > HEIGHT else ys[-1] + step)
    is_notched = kind == "notch"
    start = NOTCH if is_notched else 0.0
    sets = {"end": lambda x, y: y == HEIGHT, "ligament": lambda x, y: y == 0 and x >= start,
            "corner": lambda x, y: y == 0 and x == WIDTH}
    is_weak = lambda x, y: not is_notched and x < SPOT[0] and y < SPOT[1]  # noqa: E731
    write_mesh(out / f"{name}.msh", xs, ys, lambda x, y: "weak" if is_weak(x, y) else "plate", sets)
    strengths = {"plate": STRENGTH} | ({} if is_notched else {"weak": 0.8 * STRENGTH})
    rows, text = run(program, out / f"{name}.json", strengths, 0.2, energy, length, 0.03, [0, 1],
                     {"ligament": {"direction": "y"}, "corner": {"direction": "x"}},
                     {"initial": 0.02, "maximum": 0.02, "minimum": 1e-9})
    area = WIDTH - start
    print(f"{name}: dissipation {rows[-1]['damage_energy'] / (0.5 * energy * area):.3f}, {text}", flush=True)


RUNS = [(bar, 60.0, 2, 0), (bar, 60.0, 4, 0), (bar, 60.0, 4, 4), (bar, 60.0, 8, 0), (bar, 120.0, 4, 0), (bar, 240.0, 4, 0)]
RUNS += [(plate, "spot", 5.0, 2), (plate, "spot", 5.0, 4), (plate, "notch", 10.0, 2), (plate, "notch", 5.0, 2), (plate, "notch", 5.0, 4)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*", default=[], help="runs with all these words: bar, spot")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for scene, *values in RUNS:
        words = [scene.__name__, *map(str, values)]
        if all(word in words for word in options.only):
            scene(options.program.resolve(), options.out, *values)


if __name__ == "__main__":
    main()
