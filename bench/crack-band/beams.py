#!/usr/bin/env python3
"""Crack band of the elements: notched beams on aligned, uneven and free meshes against a cohesive crack.

    python3 beams.py PROGRAM OUT [--only WORD ...] [--law LAW ...] [--integration full]

PROGRAM is the release build of `pullout`, OUT a folder for meshes and runs. Each run adds a line to OUT/results.csv;
what stands there is not run again. Free meshes need the Python module gmsh. Lengths in mm, forces in N.
"""
import argparse
import csv
import json
import random
import resource
import subprocess
import time
from pathlib import Path

HERE = Path(__file__).parent
LENGTH, SPAN, DEPTH, NOTCH, NOTCH_WIDTH, LOAD = 340.0, 300.0, 100.0, 50.0, 2.0, 5.0
END = 0.3
COARSE = 12.0
KINDS = {"T3": 2, "Q4": 3, "T6": 9, "Q8": 16}
SIZES = [10.0, 5.0, 2.5]
LAWS = ["concrete_damage", "concrete_damage_implex", "concrete_damage_fixed"]
COLUMNS = ["law", "mesh", "kind", "size", "elements", "peak_N", "peak_ratio", "work_Nmm", "work_ratio", "share",
           "increments", "cpu_s", "exit"]


def graded(start, end, first, ratio=1.3, largest=COARSE):
    """Positions from start to end, steps growing from `first`."""
    steps = []
    while sum(steps) < abs(end - start):
        steps.append(min(largest, first * ratio ** len(steps)))
    scale = (end - start) / sum(steps)
    return [start + scale * sum(steps[:k]) for k in range(1, len(steps) + 1)]


def evenly(start, end, size):
    count = max(1, round(abs(end - start) / size))
    return [start + (end - start) * k / count for k in range(1, count + 1)]


def aligned(kind, size):
    """Rows and columns of quadrilaterals, halved for triangles; the notch is the column above which the crack runs."""
    half = [0.5 * size]
    if half[-1] < LOAD:
        half += evenly(half[-1], LOAD, 0.75 * size)
    half += graded(LOAD, 0.5 * SPAN, size)
    half += evenly(0.5 * SPAN, 0.5 * LENGTH, 10.0)
    xs = [-x for x in reversed(half)] + half
    below = [NOTCH - y for y in graded(0.0, NOTCH, size)]
    ys = [y for y in reversed(below)] + [NOTCH] + evenly(NOTCH, DEPTH, size)
    ys[0] = 0.0
    nodes, elements = {}, []
    quadratic = kind in ("T6", "Q8")

    def node(x, y):
        return nodes.setdefault((round(x, 9), round(y, 9)), len(nodes) + 1)

    def element(corners):
        middles = [[0.5 * (a[k] + b[k]) for k in (0, 1)] for a, b in zip(corners, corners[1:] + corners[:1])]
        elements.append([node(*p) for p in corners + (middles if quadratic else [])])

    for x0, x1 in zip(xs, xs[1:]):
        for y0, y1 in zip(ys, ys[1:]):
            if x0 < 0.0 < x1 and y0 < NOTCH - 1e-9:
                continue
            a, b, c, d = [x0, y0], [x1, y0], [x1, y1], [x0, y1]
            if kind in ("Q4", "Q8"):
                element([a, b, c, d])
            else:
                element([a, b, c])
                element([a, c, d])
    points = {"load": [(-LOAD, DEPTH), (LOAD, DEPTH)], "left": [(-0.5 * SPAN, 0.0)], "right": [(0.5 * SPAN, 0.0)]}
    return nodes, elements, {name: [node(*p) for p in at] for name, at in points.items()}


def uneven(kind, size, part=0.05):
    """The aligned mesh with the nodes around the ligament moved at random by up to a part of `size`."""
    nodes, elements, sets = aligned(kind, size)
    position = {tag: [x, y] for (x, y), tag in nodes.items()}
    corners = 3 if kind in ("T3", "T6") else 4
    chance = random.Random(3)
    for tag in sorted({tag for element in elements for tag in element[:corners]}):
        x, y = position[tag]
        if abs(x) < 40.0 and NOTCH <= y < DEPTH:
            across, along = (part * size * chance.uniform(-1.0, 1.0) for _ in range(2))
            position[tag] = [x + across, y + along if y > NOTCH else y]
    for element in elements:
        for k, middle in enumerate(element[corners:]):
            ends = [position[element[k]], position[element[(k + 1) % corners]]]
            position[middle] = [0.5 * (a + b) for a, b in zip(*ends)]
    return {tuple(at): tag for tag, at in position.items()}, elements, sets


def free(kind, size, seed=1):
    """Gmsh's mesh, which knows nothing of the crack: `size` within 20 mm of the ligament. Other seeds: other algorithms and sizes."""
    import gmsh

    size *= 1.0 + 0.02 * (seed - 1)
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    w, s, l, n = 0.5 * NOTCH_WIDTH, 0.5 * SPAN, 0.5 * LENGTH, NOTCH
    outline = [(-l, 0), (-s, 0), (-w, 0), (-w, n), (w, n), (w, 0), (s, 0), (l, 0), (l, DEPTH), (LOAD, DEPTH),
               (-LOAD, DEPTH), (-l, DEPTH)]
    points = [geo.addPoint(x, y, 0) for x, y in outline]
    lines = [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1])]
    geo.addPlaneSurface([geo.addCurveLoop(lines)], 1)
    geo.synchronize()
    field = mesh.field.add("MathEval")
    distance = f"(abs(x)+Max(0,{NOTCH - 5.0}-y))"
    # halved below
    target = 2.0 * size if kind in ("Q4", "Q8") else size
    mesh.field.setString(field, "F", f"Min({max(COARSE, target)},{target}+0.2*Max(0,{distance}-20))")
    mesh.field.setAsBackgroundMesh(field)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber("Mesh." + option, 0)
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    if kind in ("Q4", "Q8"):
        gmsh.option.setNumber("Mesh.Algorithm", 8)
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1)
        mesh.setRecombine(2, 1)
    else:
        gmsh.option.setNumber("Mesh.Algorithm", [6, 5, 1][(seed - 1) % 3])
    mesh.generate(2)
    if kind in ("T6", "Q8"):
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        mesh.setOrder(2)
    tags, coordinates, _ = mesh.getNodes()
    nodes = {}
    for k, tag in enumerate(tags):
        nodes[tuple(round(v, 9) for v in coordinates[3 * k:3 * k + 2])] = int(tag)
    types, _, lists = mesh.getElements(2)
    count = {"T3": 3, "T6": 6, "Q4": 4, "Q8": 8}[kind]
    if list(types) != [KINDS[kind]]:
        raise SystemExit(f"{kind}: the mesh has elements of the types {types}")
    elements = [[int(v) for v in lists[0][i:i + count]] for i in range(0, len(lists[0]), count)]
    sets = {"load": [nodes[(-LOAD, DEPTH)], nodes[(LOAD, DEPTH)]], "left": [nodes[(-s, 0.0)]],
            "right": [nodes[(s, 0.0)]]}
    gmsh.finalize()
    return nodes, elements, sets


MESHES = {"aligned": aligned, "uneven": uneven, "free": free}


def write_mesh(path, kind, nodes, elements, sets):
    names = {name: (0, k) for k, name in enumerate(sets, 1)} | {"beam": (2, 4)}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{dimension} {tag} "{name}"' for name, (dimension, tag) in names.items()]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{tag} {x:.12g} {y:.12g} 0" for (x, y), tag in nodes.items()]
    rows = [f"15 2 {names[name][1]} {names[name][1]} {tag}" for name, tags in sets.items() for tag in tags]
    rows += [f"{KINDS[kind]} 2 4 4 " + " ".join(map(str, element)) for element in elements]
    lines += ["$EndNodes", "$Elements", str(len(rows))]
    lines += [f"{k} {row}" for k, row in enumerate(rows, 1)] + ["$EndElements", ""]
    path.write_text("\n".join(lines))


def curve(path):
    """Deflections and loads of a history, downwards positive, from the start."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [float(row["slip"]) for row in rows], [float(row["load"]) for row in rows]


def peak_and_work(path, end=END):
    """The greatest load, and the work up to `end`, by the trapezoidal rule."""
    x, f = curve(path)
    work = 0.0
    for k in range(1, len(x)):
        if x[k - 1] >= end:
            break
        part = min(1.0, (end - x[k - 1]) / (x[k] - x[k - 1])) if x[k] > x[k - 1] else 1.0
        last = f[k - 1] + part * (f[k] - f[k - 1])
        work += 0.5 * (f[k - 1] + last) * part * (x[k] - x[k - 1])
    return max(f), work, min(1.0, max(x) / end)


def run(program, out, law, mesh, kind, size, integration):
    name = f"{mesh}-{kind}-{size:g}"
    nodes, elements, sets = MESHES[mesh](kind, size)
    write_mesh(out / f"{name}.msh", kind, nodes, elements, sets)
    case = json.loads((HERE / "beam.json").read_text())
    case["title"] = f"{name}-{law}"
    case["mesh"] = {"file": f"{name}.msh"}
    case["parts"]["beam"]["material"]["plugin"] = law
    if integration:
        case["parts"]["beam"]["integration"] = integration
    path = out / f"{name}-{law}.json"
    path.write_text(json.dumps(case, indent=1))
    results = out / f"{name}-{law}"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.time()
    with open(out / f"{name}-{law}.txt", "w") as log:
        code = subprocess.run([program, "run", path, "--out", results, "--overwrite"], stdout=log, stderr=log).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = sum(getattr(after, k) - getattr(before, k) for k in ("ru_utime", "ru_stime"))
    peak, work, share = peak_and_work(results / "history.csv")
    reached = share * END
    reference_peak, reference_work, _ = peak_and_work(HERE / "cohesive.csv", reached)
    increments = len(curve(results / "history.csv")[0]) - 1
    row = [law, mesh, kind, f"{size:g}", len(elements), f"{peak:.1f}", f"{peak / reference_peak:.3f}", f"{work:.1f}",
           f"{work / reference_work:.3f}", f"{share:.3f}", increments, f"{cpu:.1f}", code]
    print(*row, f"({time.time() - start:.0f} s)", flush=True)
    return row


def markdown(path):
    """The results as a table, one line a mesh: the implicit law, IMPL-EX, and IMPL-EX with cracks of fixed direction."""
    with open(path, newline="") as file:
        rows = {tuple(row[k] for k in COLUMNS[:4]): row for row in csv.DictReader(file)}
    cells = ["peak_ratio", "work_ratio", "share", "increments"]
    lines = ["| mesh | element | size | elements |" + len(LAWS) * " peak | work | share | increments |",
             "|---|---|---|---|" + len(LAWS) * len(cells) * "---|"]
    for mesh in MESHES:
        for kind in KINDS:
            for size in SIZES:
                of_laws = [rows.get((law, mesh, kind, f"{size:g}")) for law in LAWS]
                if all(of_laws):
                    values = [row[cell] for row in of_laws for cell in cells]
                    lines.append(f"| {mesh} | {kind} | {size:g} | {of_laws[0]['elements']} | {' | '.join(values)} |")
    return "\n".join(lines) + "\n"


def rows_of(table, columns):
    """The rows of a table, which is begun if there is none: their runs are not repeated."""
    if not table.exists():
        table.write_text(",".join(columns) + "\n")
    with open(table, newline="") as file:
        return list(csv.DictReader(file))


def add_row(table, row):
    with open(table, "a", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(row)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", nargs="*", default=[], help="meshes with all these words: free, Q8, 2.5")
    parser.add_argument("--law", nargs="*", default=LAWS)
    parser.add_argument("--integration", help="that of the elements instead of their usual one")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    table = options.out / "results.csv"
    done = {tuple(row[k] for k in COLUMNS[:4]) for row in rows_of(table, COLUMNS)}
    for size in SIZES:
        for mesh in MESHES:
            for kind in KINDS:
                for law in options.law:
                    key = (law, mesh, kind, f"{size:g}")
                    if key in done or not all(word in key for word in options.only):
                        continue
                    row = run(options.program, options.out, law, mesh, kind, size, options.integration)
                    add_row(table, row)
    (options.out / "table.md").write_text(markdown(table))


if __name__ == "__main__":
    main()
