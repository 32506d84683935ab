"""A law of ours in simcoon's solver of a material point, through ctypes: a line of 12 numbers for each increment, the
strains and the stresses (11, 22, 33, 12, 13, 23; engineering shear).

    python material_point.py LIBRARY.so LAW NSTATV --props E nu ... --targets 20:4e-4 40:-3e-3 --direction 1 0 0 0 0 0

The strain along the direction goes to the targets; components where the direction is 0 are free of stress.
"""

import argparse
import ctypes
import os

import numpy
import simcoon


class Umat(simcoon.PythonUMAT):
    """The `umat_` of a shared library."""

    def __init__(self, library, law, props, nstatv):
        self.function = ctypes.CDLL(library).umat_
        self.function.restype = None
        self.props = numpy.array(props, dtype=float)
        self.nstatev = nstatv
        self.cmname = ctypes.create_string_buffer(law.upper().encode("ascii").ljust(80), 80)

    def integrate(self, *, Etot, DEtot, sigma, statev, props, T, DT, Time, DTime, Wm, ndi, nshr, **_):
        # copies: the law updates stress and state in place
        stress, state = numpy.array(sigma, dtype=float), numpy.array(statev, dtype=float)
        stran, dstran = (numpy.ascontiguousarray(values, dtype=float) for values in (Etot, DEtot))
        tangent = numpy.zeros((6, 6), order="F")
        energies, thermal, field = numpy.zeros(4), numpy.zeros((3, 6)), numpy.zeros(1)
        identity, coords, pnewdt = numpy.eye(3, order="F"), numpy.zeros(3), numpy.array([1e36])

        def array(values):
            return values.ctypes.data_as(ctypes.c_void_p)

        def number(value):
            return ctypes.byref(ctypes.c_double(value))

        def integer(*values):
            return (ctypes.c_int32 * len(values))(*values)

        sse, spd, scd, rpl = (array(energies[k:]) for k in range(4))
        time = numpy.array([Time, Time])
        self.function(
            array(stress), array(state), array(tangent), sse, spd, scd, rpl, array(thermal[0]), array(thermal[1]),
            array(thermal[2]), array(stran), array(dstran), array(time), number(DTime), number(T), number(DT),
            array(field), array(field), self.cmname, integer(ndi), integer(nshr), integer(ndi + nshr),
            integer(len(state)), array(self.props), integer(len(self.props)), array(coords), array(identity),
            array(pnewdt), number(1.0), array(identity), array(identity), integer(1), integer(1), integer(1),
            integer(1), integer(1, 1, 0, 0), integer(1), ctypes.c_size_t(80),
        )  # fmt: skip
        if pnewdt[0] < 1.0:
            raise simcoon.StepCut(float(pnewdt[0]))
        work = numpy.array(Wm, dtype=float)
        work[0] += 0.5 * (sigma + stress) @ dstran
        return stress, tangent, state, work


def target(text):
    """`increments:value`"""
    increments, value = text.split(":")
    return int(increments), float(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=os.path.abspath, help="the law's library")
    parser.add_argument("law", help="its name, for CMNAME")
    parser.add_argument("nstatv", type=int, help="number of state variables")
    parser.add_argument("--props", type=float, nargs="+", required=True, help="its parameters in order")
    parser.add_argument("--targets", type=target, nargs="+", required=True, metavar="INCREMENTS:VALUE")
    parser.add_argument("--direction", type=float, nargs=6, default=[1, 0, 0, 0, 0, 0])
    arguments = parser.parse_args()
    law = Umat(arguments.library, arguments.law, arguments.props, arguments.nstatv)
    control = ["strain" if along else "stress" for along in arguments.direction]
    steps = [
        simcoon.solver.StepMeca(control=control, value=[value * along for along in arguments.direction], ninc=count)
        for count, value in arguments.targets
    ]
    block = simcoon.solver.Block(steps=steps)
    result = simcoon.solver.solve(block, law, precision=1e-12, maxiter=100, miniter=1)
    print("RESULT")
    for strain, stress in zip(numpy.asarray(result["Strain"]).T, numpy.asarray(result["Stress"]).T):
        print(*map(repr, strain.tolist() + stress.tolist()))


if __name__ == "__main__":
    main()
