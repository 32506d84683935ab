"""One brick in Kratos with a law of ours, stretched along x and sheared in xz, free along y: prints a line of 12 numbers for
each increment, the strains and the stresses (11, 22, 33, 12, 13, 23; engineering shear).

    python one_element.py LIBRARY.so LAW NSTATV --props E nu ... --targets 20:4e-4 40:-3e-3 --shear 0.5

e11 goes to the targets, g13 to `shear` times as much. LIBRARY is the law's in the folder `kratos`: Kratos orders shears
12, 23, 13.
"""

import argparse
import os

import KratosMultiphysics as kratos
import KratosMultiphysics.GeoMechanicsApplication
import KratosMultiphysics.StructuralMechanicsApplication

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
# Kratos's 11, 22, 33, 12, 23, 13 in the order 11, 22, 33, 12, 13, 23
ORDER = [0, 1, 2, 3, 5, 4]


def variable(name):
    return kratos.KratosGlobals.GetVariable(name)


def vector(values):
    result = kratos.Vector(len(values))
    for k, value in enumerate(values):
        result[k] = value
    return result


def brick(model, arguments):
    """A unit cube of one element: u_x and u_z are prescribed everywhere, u_y where y = 0."""
    part = model.CreateModelPart("brick", 2)
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 3
    for quantity in (kratos.DISPLACEMENT, kratos.REACTION, kratos.VOLUME_ACCELERATION):
        part.AddNodalSolutionStepVariable(quantity)
    material = part.CreateNewProperties(1)
    material.SetValue(kratos.CONSTITUTIVE_LAW, kratos.KratosGlobals.GetConstitutiveLaw("SmallStrainUMAT3DLaw").Clone())
    for name, value in {
        "DENSITY": 0.0,
        "UDSM_NAME": arguments.library,
        "IS_FORTRAN_UDSM": True,
        "UMAT_PARAMETERS": vector(arguments.props),
        "STATE_VARIABLES": vector([0.0] * arguments.nstatv),
    }.items():
        material.SetValue(variable(name), value)
    for number, corner in enumerate(CORNERS, 1):
        part.CreateNewNode(number, *map(float, corner))
    for axis in "XYZ":
        kratos.VariableUtils().AddDof(variable(f"DISPLACEMENT_{axis}"), variable(f"REACTION_{axis}"), part)
    part.CreateNewElement("SmallDisplacementElement3D8N", 1, list(range(1, 9)), material)
    for node in part.Nodes:
        node.Fix(kratos.DISPLACEMENT_X)
        node.Fix(kratos.DISPLACEMENT_Z)
        if node.Y0 == 0:
            node.Fix(kratos.DISPLACEMENT_Y)
    return part


def strategy(part):
    """Newton's method with the law's own tangent."""
    settings = kratos.Parameters("""{"solver_type": "skyline_lu_factorization"}""")
    solver = kratos.LinearSolverFactory().Create(settings)
    criterion = kratos.ResidualCriteria(1e-13, 1e-13)
    scheme = kratos.ResidualBasedIncrementalUpdateStaticScheme()
    builder = kratos.ResidualBasedBlockBuilderAndSolver(solver)
    reactions, reform_dofs, move_mesh, most_iterations = True, False, False, 50
    newton = kratos.ResidualBasedNewtonRaphsonStrategy(
        part, scheme, criterion, builder, most_iterations, reactions, reform_dofs, move_mesh
    )
    newton.SetEchoLevel(0)
    newton.Initialize()
    return newton


def path(targets):
    """The strain at the end of each increment."""
    start = 0.0
    for increments, target in targets:
        for k in range(1, increments + 1):
            yield start + (target - start) * k / increments
        start = target


def target(text):
    """`increments:value`"""
    increments, value = text.split(":")
    return int(increments), float(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=os.path.abspath, help="the law's library")
    parser.add_argument("law", help="its name (Kratos passes none)")
    parser.add_argument("nstatv", type=int, help="number of state variables")
    parser.add_argument("--props", type=float, nargs="+", required=True, help="its parameters in order")
    parser.add_argument("--targets", type=target, nargs="+", required=True, metavar="INCREMENTS:VALUE")
    parser.add_argument("--shear", type=float, default=0.0, help="g13 / e11")
    arguments = parser.parse_args()
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)

    model = kratos.Model()
    part = brick(model, arguments)
    newton = strategy(part)
    element = part.GetElement(1)
    rows = []
    for step, strain in enumerate(path(arguments.targets), 1):
        part.CloneTimeStep(float(step))
        part.ProcessInfo[kratos.STEP] = step
        for node in part.Nodes:
            node.SetSolutionStepValue(kratos.DISPLACEMENT_X, strain * (node.X0 + arguments.shear * node.Z0))
            node.SetSolutionStepValue(kratos.DISPLACEMENT_Z, 0.0)
        newton.InitializeSolutionStep()
        newton.Predict()
        converged = newton.SolveSolutionStep()
        newton.FinalizeSolutionStep()
        if not converged:
            raise SystemExit(f"increment {step}: no equilibrium")
        strains, stresses = (
            element.CalculateOnIntegrationPoints(variable(name), part.ProcessInfo)
            for name in ("GREEN_LAGRANGE_STRAIN_VECTOR", "CAUCHY_STRESS_VECTOR")
        )
        for point in zip(strains, stresses):
            rows.append([quantity[k] for quantity in point for k in ORDER])
    # Kratos's own messages go before
    print("RESULT")
    for row in rows:
        print(*map(repr, row))


if __name__ == "__main__":
    main()
