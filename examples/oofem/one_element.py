"""One brick in OOFEM, strained along x, its other sides free: prints a line `e11 e22 s11` for each
increment and integration point.

    python one_element.py LIBRARY.so LAW NSTATV --props E nu ... --targets 20:4e-4 40:-3e-3

Uniaxial stress: `pullout run` of a case with the targets as e11 gives the same numbers.
"""

import argparse
import os
import tempfile

import job
import oofem

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def deck(arguments, increments):
    """OOFEM's input: a unit cube held at x = 0, y = 0, z = 0 against the direction of each."""

    def face(axis, at):
        return [number for number, corner in enumerate(CORNERS, 1) if corner[axis] == at]

    def node_set(number, nodes):
        return f"Set {number} nodes {len(nodes)} {' '.join(map(str, nodes))}"

    return "\n".join(
        ["one_element.out", "One element", job.analysis(increments, arguments.full_newton, arguments.iterations), "domain 3d", "OutputManager"]
        + ["ndofman 8 nelem 1 ncrosssect 1 nmat 1 nbc 4 nic 0 nltf 2 nset 5"]
        + [f"node {number} coords 3 {x} {y} {z}" for number, (x, y, z) in enumerate(CORNERS, 1)]
        + ["LSpace 1 nodes 8 1 2 3 4 5 6 7 8", "SimpleCS 1 material 1 set 1"]
        + [job.material(arguments.library, arguments.law, arguments.props, arguments.nstatv)]
        + [f"BoundaryCondition {d} loadTimeFunction 1 dofs 1 {d} values 1 0 set {d + 1}" for d in (1, 2, 3)]
        + ["BoundaryCondition 4 loadTimeFunction 2 dofs 1 1 values 1 1 set 5"]
        + ["ConstantFunction 1 f(t) 1", job.ramp(2, arguments.targets), "Set 1 elements 1 1"]
        + [node_set(axis + 2, face(axis, 0)) for axis in range(3)]
        + [node_set(5, face(0, 1)), ""]
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    job.add_law(parser)
    arguments = parser.parse_args()
    increments = sum(count for count, _ in arguments.targets)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("one_element.in", "w", encoding="ascii") as file:
            file.write(deck(arguments, increments))
        for domain, step in job.solve("one_element.in", increments):
            element = domain.giveElement(1)
            for point in range(job.integration_points(element)):
                strain = job.tensor(element, point, oofem.InternalStateType.IST_StrainTensor, step)
                stress = job.tensor(element, point, oofem.InternalStateType.IST_StressTensor, step)
                rows.append((strain[0], strain[1], stress[0]))
        os.chdir("/")
    # OOFEM's own messages go before
    print("RESULT")
    for row in rows:
        print(*map(repr, row))


if __name__ == "__main__":
    main()
