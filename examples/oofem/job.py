"""OOFEM with a law of ours as AbaqusUserMaterial: input records, and the run increment by increment."""

import os

import oofem


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


def analysis(increments, full_newton, tolerance=1e-12, iterations=50):
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


def _target(text):
    increments, value = text.split(":")
    return int(increments), float(value)


def solve(file, increments):
    """Runs an input file; yields domain and time step after each increment."""
    reader = oofem.OOFEMTXTDataReader(file)
    problem = oofem.InstanciateProblem(reader, oofem.problemMode.processor, 0, None, False)
    problem.checkProblemConsistency()
    problem.init()
    problem.postInitialize()
    timer = problem.giveTimer()
    timer.startTimer(oofem.EngngModelTimerType.EMTT_AnalysisTimer)
    for _ in range(increments):
        problem.preInitializeNextStep()
        problem.giveNextStep()
        step = problem.giveCurrentStep()
        problem.initMetaStepAttributes(problem.giveMetaStep(1))
        timer.startTimer(oofem.EngngModelTimerType.EMTT_SolutionStepTimer)
        problem.initializeYourself(step)
        problem.solveYourselfAt(step)
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
