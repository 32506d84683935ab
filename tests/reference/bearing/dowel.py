"""Force on a dowel that is pressed sideways into Drucker-Prager concrete, in the plane across it.

    python3 dowel.py PULLOUT > dowel.csv            (a minute; Python without packages)

A long dowel of diameter 1 mm that moves sideways all along its length strains the concrete in planes across it alone. Half of the
plane: a polar mesh of Q8 from the hole to a held circle of 20 diameters. The front half of the hole moves by u, bonded; the back half
is free. Mohr-Coulomb's f_c and friction angle give the cone of plane strain; the dilation angle is a third of the friction angle.
A row is a displacement and the force per length over f_c times the diameter.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile

AROUND, RADIUS, GROWTH, LARGEST = 24, 20.0, 1.12, 2.0
# f_c, E, friction angle, dilation angle
CONCRETES = [(40.0, 33e3, 30.0, 10.0), (40.0, 33e3, 37.0, 12.0), (80.0, 38e3, 37.0, 12.0)]
PLACES = (0.0025, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1)


def mesh(path):
    sizes, size = [], 0.5 * math.pi / AROUND
    while sum(sizes) < RADIUS - 0.5:
        sizes.append(size)
        size = min(size * GROWTH, LARGEST)
    scale = (RADIUS - 0.5) / sum(sizes)
    radii = [0.5]
    for size in sizes:
        radii.append(radii[-1] + size * scale)
    numbers, nodes, elements, edges = {}, [], [], []

    def node(i, j):
        if (i, j) not in numbers:
            angle = math.pi * i / (2 * AROUND)
            r = 0.5 * (radii[j // 2] + radii[(j + 1) // 2])
            nodes.append((r * math.cos(angle), r * math.sin(angle)))
            numbers[i, j] = len(nodes)
        return numbers[i, j]

    last = 2 * (len(radii) - 1)
    for i in range(0, 2 * AROUND, 2):
        for j in range(0, last, 2):
            ring = [(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0)]
            elements.append([node(i + a, j + b) for a, b in ring])
        edges.append((2 if i < AROUND else 5, [node(i, 0), node(i + 2, 0), node(i + 1, 0)]))
        edges.append((3, [node(i, last), node(i + 2, last), node(i + 1, last)]))
    for j in range(0, last, 2):
        for i in (0, 2 * AROUND):
            edges.append((4, [node(i, j), node(i, j + 2), node(i, j + 1)]))
    names = {1: (2, "block"), 2: (1, "front"), 3: (1, "outer"), 4: (1, "axis"), 5: (1, "back")}
    with open(path, "w") as file:
        file.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n" % len(names))
        file.writelines('%d %d "%s"\n' % (dimension, tag, name) for tag, (dimension, name) in names.items())
        file.write("$EndPhysicalNames\n$Nodes\n%d\n" % len(nodes))
        file.writelines("%d %.12g %.12g 0\n" % (k, x, y) for k, (x, y) in enumerate(nodes, 1))
        file.write("$EndNodes\n$Elements\n%d\n" % (len(elements) + len(edges)))
        rows = [(16, 1, element) for element in elements] + [(8, tag, edge) for tag, edge in edges]
        file.writelines("%d %d 2 %d %d %s\n" % (k, kind, tag, tag, " ".join(map(str, of))) for k, (kind, tag, of) in enumerate(rows, 1))
        file.write("$EndElements\n")


def curve(program, folder, strength, modulus, friction, dilation):
    sine, cosine = math.sin(math.radians(friction)), math.cos(math.radians(friction))
    props = {"E": modulus, "nu": 0.2, "cohesion": strength * (1 - sine) / (2 * cosine), "friction_angle_deg": friction,
             "dilation_angle_deg": dilation, "cone": "plane_strain"}
    material = {"plugin": "drucker_prager", "props": props}
    case = {"kind": "pullout", "mesh": {"file": "dowel.msh"},
            "parts": {"block": {"material": material, "model": "plane_strain", "integration": "reduced"}},
            "supports": {"outer": {}, "axis": {"direction": "y"}, "fx": {"nodes": "front", "direction": "x", "drive": "u"},
                         "fy": {"nodes": "front", "direction": "y"}},
            "measure": {"slip": "u", "load": "fx"}, "steps": [{"drives": {"u": PLACES[-1]}}],
            "controls": {"locate_peak": False}, "output": {"plots": False, "vtu": False}}
    with open(os.path.join(folder, "case.json"), "w") as file:
        json.dump(case, file)
    subprocess.run([program, "run", "case.json", "--out", "out", "--quiet"], cwd=folder, check=True)
    with open(os.path.join(folder, "out", "history.csv")) as file:
        rows = [(float(row["slip"]), 2.0 * abs(float(row["load"])) / strength) for row in csv.DictReader(file)]
    for place in PLACES:
        for (a, p), (b, q) in zip(rows, rows[1:]):
            if a <= place <= b + 1e-12:
                yield place, p + (q - p) * (place - a) / (b - a)
                break


if __name__ == "__main__":
    print("f_c,E,friction_deg,dilation_deg,u_over_diameter,k,law")
    with tempfile.TemporaryDirectory() as folder:
        mesh(os.path.join(folder, "dowel.msh"))
        for strength, modulus, friction, dilation in CONCRETES:
            for place, k in curve(os.path.abspath(sys.argv[1]), folder, strength, modulus, friction, dilation):
                law = min(5.07, math.sqrt(modulus / strength * place))
                print(f"{strength:g},{modulus:g},{friction:g},{dilation:g},{place:g},{k:.3f},{law:.3f}", flush=True)
