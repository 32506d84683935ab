#!/usr/bin/env python3
"""Oblique cracks on five free meshes each: a beam with an eccentric notch, a notched plate in shear, an L-shaped panel.

    python3 scenes.py PROGRAM OUT [--only SCENE ...] [--seeds N]

PROGRAM is the release build of `pullout`, OUT a folder for meshes and runs. Each run adds a line to OUT/scenes.csv; what stands there
is not run again. Needs the Python module gmsh. Lengths in mm, forces in N.
"""
import argparse
import csv
import json
import math
import resource
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "crack-band"))
import beams  # noqa: E402

# the opening curve of concrete_damage, as in cases/verification/notched-beam-phase-field.json
CURVE = {"p": 3.1667, "a_2": -1.0, "a_3": 1.9791}
CONCRETE = {"E": 30e3, "nu": 0.2, "f_t": 3.0, "G_f": 0.09006, "l": 5.0, **CURVE, "A_c": 18.05145902257159, "B_c": 1.05,
            "Y_c0": 0.0005113966666666666, "beta": 0.1584110575718895, "zeta_c": 0.0}
# Winkler's concrete: E, ν, f_t as measured; compression stays elastic
PANEL = {**CONCRETE, "E": 25850.0, "nu": 0.18, "f_t": 2.7, "G_f": 0.09, "l": 10.0}
COLUMNS = ["scene", "seed", "elements", "l", "h", "peak_N", "slip_at_peak_mm", "end_mm", "work_Nmm", "load_at_end_N", "energy_error",
           "field_over_damage", "increments", "iterations", "cpu_s", "exit"]
MOST = 12.0


class Scene:
    """An outline, the way that the crack may take, where elements have the size h, and what is held."""

    def __init__(self, outline, path, reach, sets, thickness, props, direction, supports, lateral, end, increments):
        self.outline, self.path, self.reach, self.sets, self.thickness, self.props = outline, path, reach, sets, thickness, props
        self.direction, self.supports, self.lateral, self.end, self.increments = direction, supports, lateral, end, increments


def eccentric():
    at, half, span, long = -65.0, 1.0, 150.0, 170.0
    outline = [(-long, 0), (-span, 0), (at - half, 0), (at - half, 50), (at + half, 50), (at + half, 0), (span, 0), (long, 0),
               (long, 100), (5, 100), (-5, 100), (-long, 100)]
    sets = {"load": [(-5, 100), (5, 100)], "left": [(-span, 0)], "right": [(span, 0)]}
    supports = {"left": {"direction": "both"}, "right": {"direction": "y"}}
    return Scene(outline, [(at, 50), (-30, 75), (0, 100)], 20.0, sets, 50.0, CONCRETE, [0, -1], supports, "free", 0.2, 60)


def shear():
    outline = [(0, 0), (100, 0), (100, 100), (0, 100), (0, 51), (50, 51), (50, 49), (0, 49)]
    sets = {"load": lambda x, y: y == 100.0, "bottom": lambda x, y: y == 0.0}
    path = [(50, 50), (75, 20), (100, 0)]
    return Scene(outline, path, 25.0, sets, 50.0, CONCRETE, "x", {"bottom": {"direction": "both"}}, "held", 0.12, 60)


def panel():
    outline = [(0, 0), (250, 0), (250, 250), (465, 250), (475, 250), (500, 250), (500, 500), (0, 500)]
    sets = {"load": [(465, 250), (475, 250)], "bottom": lambda x, y: y == 0.0}
    path = [(250, 250), (150, 300), (0, 320)]
    return Scene(outline, path, 50.0, sets, 100.0, PANEL, "y", {"bottom": {"direction": "both"}}, "free", 0.6, 60)


SCENES = {"eccentric": eccentric, "shear": shear, "panel": panel}


def distance(x, y, path):
    """From a point to a line of straight pieces."""
    least = math.inf
    for (ax, ay), (bx, by) in zip(path, path[1:]):
        dx, dy = bx - ax, by - ay
        along = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
        least = min(least, math.hypot(x - ax - along * dx, y - ay - along * dy))
    return least


def mesh(scene, size, seed):
    """T6 elements of Gmsh; other seeds: other algorithms and sizes."""
    import gmsh

    size *= 1.0 + 0.02 * (seed - 1)
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    geo, maker = gmsh.model.geo, gmsh.model.mesh
    points = [geo.addPoint(x, y, 0) for x, y in scene.outline]
    lines = [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1])]
    geo.addPlaneSurface([geo.addCurveLoop(lines)], 1)
    geo.synchronize()
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber("Mesh." + option, 0)
    far = max(MOST, 4.0 * size)
    maker.setSizeCallback(lambda dim, tag, x, y, z, lc: min(far, size + 0.2 * max(0.0, distance(x, y, scene.path) - scene.reach)))
    gmsh.option.setNumber("Mesh.Algorithm", [6, 5, 1][(seed - 1) % 3])
    maker.generate(2)
    maker.setOrder(2)
    tags, at, _ = maker.getNodes()
    nodes = {tuple(round(v, 9) for v in at[3 * k:3 * k + 2]): int(tag) for k, tag in enumerate(tags)}
    _, _, lists = maker.getElements(2)
    elements = [[int(v) for v in lists[0][i:i + 6]] for i in range(0, len(lists[0]), 6)]
    gmsh.finalize()
    sets = {name: [tag for (x, y), tag in nodes.items() if given(x, y)] if callable(given) else [nodes[point] for point in given]
            for name, given in scene.sets.items()}
    return nodes, elements, sets


def run(program, out, name, seed):
    scene = SCENES[name]()
    length = scene.props["l"]
    size = 0.5 * length
    nodes, elements, sets = mesh(scene, size, seed)
    file = f"{name}-{seed}"
    beams.write_mesh(out / f"{file}.msh", "T6", nodes, elements, sets)
    largest = 1.0 / scene.increments
    case = {
        "kind": "pullout",
        "mesh": {"file": f"{file}.msh"},
        "parts": {"beam": {"model": "plane_stress", "thickness": scene.thickness,
                           "material": {"plugin": "concrete_phase_field", "props": scene.props}}},
        "field": {"kind": "phase_field"},
        "grip": {"nodes": "load", "direction": scene.direction} | ({"lateral": "free"} if scene.lateral == "free" else {}),
        "supports": scene.supports,
        "steps": [{"slip": scene.end, "increments": {"initial": largest, "maximum": largest, "minimum": 1e-9}}],
        "output": {"vtu": False, "plots": False},
    }
    path = out / f"{file}.json"
    path.write_text(json.dumps(case, indent=1))
    results = path.with_suffix("")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(path.with_suffix(".txt"), "w") as log:
        code = subprocess.run([program, "run", path, "--out", results, "--overwrite"], stdout=log, stderr=log).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = sum(getattr(after, k) - getattr(before, k) for k in ("ru_utime", "ru_stime"))
    with open(results / "history.csv", newline="") as history:
        rows = list(csv.DictReader(history))
    column = lambda key: [float(row[key]) for row in rows]  # noqa: E731
    slip, load = column("slip"), column("load")
    peak, work, _ = beams.peak_and_work(results / "history.csv", scene.end)
    return [name, seed, len(elements), f"{length:g}", f"{size:g}", f"{peak:.1f}", f"{slip[load.index(peak)]:.4f}", f"{slip[-1]:.4g}",
            f"{work:.2f}", f"{load[-1]:.1f}", f"{column('energy_error')[-1]:.1e}",
            f"{column('field_energy')[-1] / column('damage_energy')[-1]:.3f}", len(rows) - 1, int(sum(column("iterations"))),
            f"{cpu:.1f}", code]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*", default=list(SCENES), choices=list(SCENES), help="scenes")
    parser.add_argument("--seeds", type=int, default=5, help="meshes of each")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    table = options.out / "scenes.csv"
    done = {(row["scene"], row["seed"]) for row in beams.rows_of(table, COLUMNS)}
    for seed in range(1, options.seeds + 1):
        for name in options.only:
            if (name, str(seed)) not in done:
                row = run(options.program, options.out, name, seed)
                print(*row, flush=True)
                beams.add_row(table, row)


if __name__ == "__main__":
    main()
