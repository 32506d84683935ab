"""Uniaxial stress in singlepointsim with a UMAT: for each line that is read, the path from the start.

    python singlepointsim_point.py SOURCE NSTATV INCREMENTS STRAIN PROPS...

As `simcoon_point.py`. It prescribes a stretch, whose logarithm is the strain of a row, and records the equivalent stress alone, which
stands for the stress along the path. The UMAT is compiled here once, by f2py.
"""

import contextlib
import io
import os
import sys
import time
from pathlib import Path

import numpy
from singlepointsim.compile_umat import compile_umat
from singlepointsim.sps_input import SPSInput


def main():
    source, nstatv, increments, strain, *props = sys.argv[1:]
    # it starts "python" and meson's programs by name, and passes JSTEP as a number
    os.environ["PATH"] = os.pathsep.join([os.path.dirname(sys.executable), os.environ["PATH"]])
    file = Path(source)
    text = file.read_text()
    file.write_text(text.replace("jstep(4)", "jstep").replace("predef(*), dpred(*)", "predef(1), dpred(1)"))
    with contextlib.redirect_stdout(io.StringIO()):
        umat = compile_umat(file).umat
    # the last increment of those that it is given is left out
    count = int(increments) + 1
    increment, stretch = 1.0 / count, (numpy.exp(float(strain)) - 1.0) * count / int(increments)
    step = {"loading_scenario": "tension", "loading_direction_i": 1, "loading_direction_j": 1, "displacements": [float(stretch)]}
    step |= {"dtime": increment, "dtime_max": increment, "time_max": 1.0}
    for line in sys.stdin:
        (made,) = SPSInput(props=[float(value) for value in props], nstatv=int(nstatv), steps=[dict(step)]).steps
        # it prints in each increment
        with contextlib.redirect_stdout(io.StringIO()):
            start = time.process_time()
            outputs = made.loading_scenario(made, umat).run_simulation()
            seconds = time.process_time() - start
        if line.strip():
            rows = numpy.zeros((len(outputs.stress), 7))
            rows[:, 0], rows[:, 1] = numpy.array(outputs.strain)[:, 0], outputs.stress
            rows.astype("<f8").tofile(line.strip())
        print(repr(seconds), flush=True)


if __name__ == "__main__":
    main()
