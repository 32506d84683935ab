"""OOFEM with a law of ours as AbaqusUserMaterial: input records, and the run increment by increment."""

import contextlib
import ctypes
import os
import re
import sys
import tempfile

import oofem

# what OOFEM writes of an increment without equilibrium before it goes on; residuals that are NaN pass for converged
NO_EQUILIBRIUM = re.compile(r"No success in solving problem|^NRSolver:.*nan", re.MULTILINE)


def material(library, law, props, nstatv):
    """Record of material 1. OOFEM calls `umat_` with NTENS = 6 in every mode, and ignores PNEWDT."""
    values = " ".join(repr(float(value)) for value in props)
    return (
        f'AbaqusUserMaterial 1 d 1.0 umat "{library}" properties {len(props)} {values} '
        f'numstate {nstatv} name "{law.upper()}"'
    )


def ramp(number, targets):
    """Record of a time function: 0 at the start, then linear to each (increments, value); an increment lasts 1."""
    times, values = [0], [0.0]
    for increments, value in targets:
        times.append(times[-1] + increments)
        values.append(float(value))
    count = len(times)
    return (
        f"PiecewiseLinFunction {number} nPoints {count} t {count} {' '.join(map(str, times))} "
        f"f(t) {count} {' '.join(map(repr, values))}"
    )


def analysis(increments, full_newton, iterations, tolerance=1e-12):
    """Record of the analysis. OOFEM assembles the symmetric part of an element's stiffness: with an unsymmetric DDSDDE
    the matrix of the start of the increment converges better than one that is updated in every iteration."""
    update = "manrmsteps 1 " if full_newton else ""
    return (
        f"StaticStructural nsteps {increments} rtolf {tolerance} rtolv {tolerance} maxiter {iterations} "
        f"{update}lstype 0 smtype 1 nmodules 0"
    )


def add_law(parser):
    """Arguments that name a law, its parameters, and the path."""
    parser.add_argument("library", type=os.path.abspath, help="the law's library")
    parser.add_argument("law", help="its name, for CMNAME")
    parser.add_argument("nstatv", type=int, help="number of state variables")
    parser.add_argument("--props", type=float, nargs="+", required=True, help="its parameters in order")
    parser.add_argument("--targets", type=_target, nargs="+", required=True, metavar="INCREMENTS:VALUE")
    parser.add_argument("--full-newton", action="store_true", help="update the matrix in every iteration")
    parser.add_argument("--iterations", type=int, default=100, help="of an increment, at most")


def _target(text):
    increments, value = text.split(":")
    return int(increments), float(value)


@contextlib.contextmanager
def log_of_solver():
    """What OOFEM prints meanwhile, as a list of one text; it is printed all the same. OOFEM writes through C's own buffers."""
    flush = ctypes.CDLL(None).fflush
    flush(None)
    sys.stdout.flush()
    streams = {number: os.dup(number) for number in (1, 2)}
    text = []
    with tempfile.TemporaryFile() as file:
        for number in streams:
            os.dup2(file.fileno(), number)
        try:
            yield text
        finally:
            flush(None)
            for number, stream in streams.items():
                os.dup2(stream, number)
                os.close(stream)
            file.seek(0)
            text.append(file.read().decode(errors="replace"))
            print(text[0], end="", flush=True)


def solve(file, increments):
    """Runs an input file; yields domain and time step after each increment.

    Ends the program at an increment without equilibrium: OOFEM itself warns and goes on from a wrong state.
    """
    reader = oofem.OOFEMTXTDataReader(file)
    problem = oofem.InstanciateProblem(reader, oofem.problemMode.processor, 0, None, False)
    problem.checkProblemConsistency()
    problem.init()
    problem.postInitialize()
    timer = problem.giveTimer()
    timer.startTimer(oofem.EngngModelTimerType.EMTT_AnalysisTimer)
    for number in range(1, increments + 1):
        problem.preInitializeNextStep()
        problem.giveNextStep()
        step = problem.giveCurrentStep()
        problem.initMetaStepAttributes(problem.giveMetaStep(1))
        timer.startTimer(oofem.EngngModelTimerType.EMTT_SolutionStepTimer)
        problem.initializeYourself(step)
        with log_of_solver() as log:
            problem.solveYourselfAt(step)
        if NO_EQUILIBRIUM.search(log[0]):
            raise SystemExit(f"increment {number} of {increments}: OOFEM finds no equilibrium")
        problem.updateYourself(step)
        problem.terminate(step)
        yield problem.giveDomain(1), step


def displacement(domain, node, dof, step):
    """A displacement of a node (numbers from 1)."""
    return domain.giveDofManager(node).giveDofWithID(dof).giveUnknown(oofem.ValueModeType.VM_Total, step)


def tensor(element, point, quantity, step):
    """Six components of a tensor at an integration point (from 0): 11, 22, 33, 23, 13, 12, as OOFEM orders them."""
    values = oofem.FloatArray()
    element.giveIPValue(values, element.giveDefaultIntegrationRulePtr().getIntegrationPoint(point), quantity, step)
    return [values[k] for k in range(6)]


def integration_points(element):
    """Their number."""
    return element.giveDefaultIntegrationRulePtr().giveNumberOfIntegrationPoints()
