"""A plane strain job in OOFEM on the mesh of a result of `pullout run`, and how far its displacements are apart.

    python block.py RESULT.vtu LIBRARY.so LAW NSTATV --props E nu ... --targets 8:-0.08

The mesh (3-node triangles) and the displacements to compare with are those of the VTU file; the left side is
held, the right side is moved along x by the targets. Prints nodes, elements, the largest displacement, and the largest
difference of a displacement, mm.
"""

import argparse
import os
import pathlib
import tempfile
import xml.etree.ElementTree as xml
import zlib

import job
import numpy
import oofem

TYPES = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}
TRIANGLE = 5


def arrays(file):
    """Return the arrays of a VTU file by name: each is appended as a zlib block after four counts of 8 bytes."""
    head, _, tail = pathlib.Path(file).read_bytes().partition(b'<AppendedData encoding="raw">')
    appended = tail.partition(b"_")[2]
    found = {}
    for array in xml.fromstring(head + b"</VTKFile>").iter("DataArray"):
        start = int(array.get("offset"))
        blocks, _, _, size = numpy.frombuffer(appended, "<u8", 4, start)
        block = appended[start + 32 : start + 32 + int(size)]
        data = numpy.frombuffer(zlib.decompress(block) if blocks else b"", TYPES[array.get("type")])
        components = int(array.get("NumberOfComponents", "1"))
        found[array.get("Name")] = data.reshape(-1, components) if components > 1 else data
    return found


def deck(arguments, points, triangles, increments):
    """OOFEM's input."""

    def side(number, x):
        nodes = numpy.flatnonzero(numpy.isclose(points[:, 0], x, rtol=0, atol=1e-9)) + 1
        return f"Set {number} nodes {len(nodes)} {' '.join(map(str, nodes))}"

    count = len(triangles)
    records = ["block.out", "Block", job.analysis(increments, arguments.full_newton, arguments.iterations), "domain PlaneStrain", "OutputManager"]
    records += [f"ndofman {len(points)} nelem {count} ncrosssect 1 nmat 1 nbc 2 nic 0 nltf 2 nset 3"]
    # repr: all digits of a coordinate
    records += [f"node {k} coords 3 {x!r} {y!r} 0" for k, (x, y) in enumerate(points[:, :2].tolist(), 1)]
    records += [f"TrPlaneStrain {k} nodes 3 {' '.join(map(str, t + 1))}" for k, t in enumerate(triangles, 1)]
    records += ["SimpleCS 1 thick 1.0 material 1 set 1"]
    records += [job.material(arguments.library, arguments.law, arguments.props, arguments.nstatv)]
    records += ["BoundaryCondition 1 loadTimeFunction 1 dofs 2 1 2 values 2 0 0 set 2"]
    records += ["BoundaryCondition 2 loadTimeFunction 2 dofs 1 1 values 1 1 set 3"]
    records += ["ConstantFunction 1 f(t) 1", job.ramp(2, arguments.targets), f"Set 1 elementranges {{(1 {count})}}"]
    records += [side(2, points[:, 0].min()), side(3, points[:, 0].max()), ""]
    return "\n".join(records)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    job.add_law(parser)
    arguments = parser.parse_args()
    increments = sum(count for count, _ in arguments.targets)
    result = arrays(arguments.result)
    if not (result["types"] == TRIANGLE).all():
        parser.error(f"{arguments.result}: not a mesh of 3-node triangles")
    points, expected = result["Points"], result["displacement"][:, :2]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("block.in", "w", encoding="ascii") as file:
            file.write(deck(arguments, points, result["connectivity"].reshape(-1, 3), increments))
        dofs = oofem.DofIDItem.D_u, oofem.DofIDItem.D_v
        nodes = range(1, len(points) + 1)
        # while the job lasts: OOFEM's domain goes with it
        for done, (domain, step) in enumerate(job.solve("block.in", increments), 1):
            if done == increments:
                found = numpy.array([[job.displacement(domain, node, dof, step) for dof in dofs] for node in nodes])
        os.chdir("/")
    # OOFEM's own messages go before
    print("RESULT")
    print(len(points), len(result["types"]), abs(expected).max(), abs(found - expected).max())


if __name__ == "__main__":
    main()
