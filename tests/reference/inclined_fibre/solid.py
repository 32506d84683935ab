"""Stiffness of a round fibre in a block of elastic concrete, in space: C3D20, half model, CalculiX.

    python3 solid.py > solid.csv            (needs `ccx`; a few minutes)

The fibre (diameter 0.406, embedded 12.2, E 210000, nu 0.3) is bonded perfectly to the block (25.4 x 12.7 x t, E 23700,
nu 0.15), leans by an angle from the normal of the face y = 0 and reaches 0.25 mm out of it. z = 0 is the plane of symmetry;
z = t/2 does not move along z either, as in a row of such fibres; both sides x = +-12.7 are held. The nodes of the outer
end all move by the same displacement along the fibre ("axial", free across it) or across it in the plane ("lateral", free
along it). The stiffness is the force of the whole fibre over this displacement, N/mm.

Each layer of elements is mapped: core and rim of the fibre, a ring from the fibre to a box around it, and the rest of the
block to both sides. A row of the table is one angle and thickness at one mesh; `elements_45` is the number of elements on an
eighth of the circumference.
"""

import math
import os
import subprocess
import sys
import tempfile

DIAMETER, EMBEDDED, OUTSIDE = 0.406, 12.2, 0.25
WIDTH, DEPTH = 25.4, 12.7
STEEL, CONCRETE = (210e3, 0.3), (23.7e3, 0.15)
DISPLACEMENT = 1e-3
RADIUS, HALF = 0.5 * DIAMETER, 0.5 * WIDTH
BOX = 2.0  # half of the width of the box around the fibre, mm

# Corners and middles of edges of a C3D20 in its cube, in CalculiX's order.
CORNERS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
PLACES = CORNERS + [tuple((CORNERS[a][k] + CORNERS[b][k]) // 2 for k in range(3)) for a, b in EDGES]


def graded(start, end, first, growth, largest):
    """Positions from start to end, sizes growing from the first."""
    sizes, size, length = [], first, abs(end - start)
    while sum(sizes) < length:
        sizes.append(size)
        size = min(size * growth, largest)
    scale = (end - start) / sum(sizes)
    positions = [start]
    for size in sizes:
        positions.append(positions[-1] + size * scale)
    positions[-1] = end
    return positions


def at(positions, index):
    """A position by twice its index; odd ones lie in the middle."""
    return positions[index // 2] if index % 2 == 0 else 0.5 * (positions[index // 2] + positions[index // 2 + 1])


class Mesh:
    def __init__(self):
        self.nodes, self.numbers, self.elements = [], {}, {"fibre": [], "concrete": []}

    def node(self, point):
        key = tuple(round(x * 1e6) for x in point)
        if key not in self.numbers:
            self.nodes.append(point)
            self.numbers[key] = len(self.nodes)
        return self.numbers[key]

    def block(self, part, counts, point):
        """Elements of a block; `point` maps twice the indices."""
        for i in range(counts[0]):
            for j in range(counts[1]):
                for k in range(counts[2]):
                    middle = (2 * i + 1, 2 * j + 1, 2 * k + 1)
                    places = [tuple(m + d for m, d in zip(middle, place)) for place in PLACES]
                    points = [point(*place) for place in places]
                    self.elements[part].append([self.node(p) for p in oriented(points)])


def oriented(points):
    """The same element with a positive volume."""
    a, b, d, e = points[0], points[1], points[3], points[4]
    u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, d, e))
    volume = sum(u[k] * (v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3]) for k in range(3))
    if volume > 0:
        return points
    order = [4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19]
    return [points[k] for k in order]


def sections(n, top):
    """Blocks of a cross-section (a across the fibre, c = z): name, part of it, counts, map of twice the indices.

    `a` is stretched by 1/cos(angle) in a horizontal layer; the ring's outer side and the rest are given by x itself.
    """
    core = 0.55 * RADIUS

    def circle(u):  # u from 0 to 8n: twice the elements around half of the circumference
        angle = math.pi * u / (8 * n)
        return RADIUS * math.cos(angle), RADIUS * math.sin(angle)

    def square(u, half, height):
        """The way around three sides of a rectangle: up on the right, to the left, down."""
        if u <= 2 * n:
            return half, height * u / (2 * n)
        if u <= 6 * n:
            return half * (1 - (u - 2 * n) / (2 * n)), height
        return -half, height * (8 * n - u) / (2 * n)

    radial = graded(0.0, 1.0, 0.05, 1.45, 0.25)

    def bulged(a, c):
        """A square with curved sides: better elements than one with straight sides."""
        return a + 0.15 * a * (1 - (c / core) ** 2), c + 0.15 * c * (1 - (a / core) ** 2)

    def in_core(i, j):
        return bulged(core * (i / (2 * n) - 1.0), core * j / (2 * n)), 0.0, None

    def rim(i, j):
        share = j / 4
        (a, c), (b, d) = bulged(*square(i, core, core)), circle(i)
        return (a + share * (b - a), c + share * (d - c)), 0.0, None

    def ring(i, j):
        return circle(i), at(radial, j), square(i, BOX, top)

    return [("core", (2 * n, n), in_core), ("rim", (4 * n, 2), rim), ("ring", (4 * n, len(radial) - 1), ring)]


def solve(degrees, thickness, n):
    angle, top = math.radians(degrees), 0.5 * thickness
    sine, cosine, tangent = math.sin(angle), math.cos(angle), math.tan(angle)
    tail = -EMBEDDED * cosine
    mesh = Mesh()
    down = graded(0.0, tail, 0.24 / n, 1.0 + 0.75 / n, 3.0 / n)
    below = graded(tail, -DEPTH, 0.3, 1.5, 2.0)

    def centre(y):
        return max(y, tail) * tangent

    def in_layer(part, y):
        """The point of a section's place in a horizontal layer."""
        (a, c), share, outer = part
        x, z = centre(y) + a / cosine, c
        if outer is not None:
            u, v = centre(y) + outer[0], outer[1]
            x, z = x + share * (u - x), z + share * (v - z)
        return x, y, z

    for name, counts, place in sections(n, top):
        for layers, is_embedded in ((down, True), (below, False)):
            part = "fibre" if name != "ring" and is_embedded else "concrete"
            size = (*counts, len(layers) - 1)
            mesh.block(part, size, lambda i, j, k: in_layer(place(i, j), at(layers, k)))
        if name != "ring":
            outside = [OUTSIDE * k / 3 for k in range(4)]

            def beyond(i, j, k):
                # layers turn from the face to the section across the axis
                (a, c), s = place(i, j)[0], at(outside, k)
                share = s / OUTSIDE
                along = ((1 - share) / cosine + share * cosine, -share * sine)
                return s * sine + a * along[0], s * cosine + a * along[1], c

            mesh.block("fibre", (*counts, 3), beyond)
    aside = graded(0.0, 1.0, 0.06, 1.4, 0.3)
    for layers in (down, below):
        for sign in (1.0, -1.0):

            def side(i, j, k):
                y, share = at(layers, k), at(aside, j)
                start = centre(y) + sign * BOX
                return start + share * (sign * HALF - start), y, top * i / (2 * n)

            mesh.block("concrete", (n, len(aside) - 1, len(layers) - 1), side)
    end = [k for k, (x, y, z) in enumerate(mesh.nodes, 1) if abs(x * sine + y * cosine - OUTSIDE) < 1e-6 and y > 0]
    directions = {"axial": (sine, cosine), "lateral": (cosine, -sine)}
    return {name: stiffness(mesh, end, top, directions, name) for name in directions}, len(mesh.nodes)


def stiffness(mesh, end, top, directions, name):
    (sine, cosine), (x_force, y_force) = directions["axial"], directions[name]
    freedom = list(directions).index(name) + 1
    lines = ["*NODE, NSET=ALL"]
    lines += ["%d, %.12g, %.12g, %.12g" % (k, *point) for k, point in enumerate(mesh.nodes, 1)]
    number = 0
    for part, elements in mesh.elements.items():
        lines.append(f"*ELEMENT, TYPE=C3D20, ELSET={part}")
        for nodes in elements:
            number += 1
            lines.append(f"{number}, " + ", ".join(map(str, nodes[:10])) + ",")
            lines.append(", ".join(map(str, nodes[10:])))
    for part, (modulus, poisson) in (("fibre", STEEL), ("concrete", CONCRETE)):
        lines += [f"*MATERIAL, NAME={part}", "*ELASTIC", f"{modulus}, {poisson}"]
        lines += [f"*SOLID SECTION, ELSET={part}, MATERIAL={part}"]
    near = lambda a, b: abs(a - b) < 1e-6
    sets = {
        "END": end,
        "FLAT": [k for k, (x, y, z) in enumerate(mesh.nodes, 1) if near(z, 0.0) or near(z, top)],
        "SIDES": [k for k, (x, y, z) in enumerate(mesh.nodes, 1) if near(abs(x), HALF)],
    }
    for group, nodes in sets.items():
        lines += [f"*NSET, NSET={group}"] + [f"{node}," for node in nodes]
    lines += ["*TRANSFORM, NSET=END, TYPE=R", f"{sine:.15g}, {cosine:.15g}, 0, {cosine:.15g}, {-sine:.15g}, 0"]
    lines += ["*BOUNDARY", "FLAT, 3, 3", "SIDES, 1, 2"]
    lines += ["*STEP", "*STATIC", "*BOUNDARY", f"END, {freedom}, {freedom}, {DISPLACEMENT}"]
    lines += ["*NODE PRINT, NSET=END, TOTALS=ONLY", "RF", "*END STEP"]
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "job.inp"), "w") as file:
            file.write("\n".join(lines) + "\n")
        done = subprocess.run(["ccx", "job"], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0 or not os.path.exists(os.path.join(folder, "job.dat")):
            sys.exit(done.stdout[-2000:])
        with open(os.path.join(folder, "job.dat")) as file:
            numbers = [line.split() for line in file if line.strip() and not line.strip().startswith("total")]
    x, y, _ = (float(number) for number in numbers[-1])
    if abs(x * y_force - y * x_force) > 1e-6 * math.hypot(x, y):
        sys.exit(f"the force ({x}, {y}) is not along ({x_force}, {y_force})")
    # half of the fibre
    return 2.0 * (x * x_force + y * y_force) / DISPLACEMENT


if __name__ == "__main__":
    cases = [(0, 3.26, 2), (0, 3.26, 3), (45, 3.26, 2), (45, 3.26, 3), (0, 12.7, 3), (45, 12.7, 3)]
    print("angle_deg,thickness,elements_45,nodes,axial,lateral")
    for degrees, thickness, n in cases:
        found, nodes = solve(degrees, thickness, n)
        print(f"{degrees},{thickness},{n},{nodes},{found['axial']:.1f},{found['lateral']:.1f}", flush=True)
