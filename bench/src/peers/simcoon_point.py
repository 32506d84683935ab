"""Uniaxial stress in simcoon's solver with a law of its own: for each line that is read, the path from the start.

    python point.py LAW NSTATV INCREMENTS STRAIN PROPS...

A line names a file for the rows (strain and six stresses, as doubles, an increment), or is empty. What is printed then is the processor's
time of the solver alone, s.
"""

import sys
import time

import numpy
import simcoon


def main():
    law, nstatv, increments, strain, *props = sys.argv[1:]
    step = simcoon.solver.StepMeca(
        control=["strain"] + 5 * ["stress"], value=[float(strain), 0, 0, 0, 0, 0], ninc=int(increments)
    )
    block = simcoon.solver.Block(steps=[step])
    props = [float(value) for value in props]
    for line in sys.stdin:
        start = time.process_time()
        # a record of the tangents is nothing that the other side keeps
        result = simcoon.solver.solve(block, law, props, int(nstatv), record_tangent=False)
        seconds = time.process_time() - start
        if line.strip():
            strains = numpy.linspace(0.0, float(strain), int(increments) + 1)[1:]
            numpy.column_stack([strains, numpy.asarray(result["Stress"]).T]).astype("<f8").tofile(line.strip())
        print(repr(seconds), flush=True)


if __name__ == "__main__":
    main()
