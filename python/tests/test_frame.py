"""Updates in all modes, in local axes, less strains that are free of stress, and what couples with a temperature; against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import pullout_fe as po

E, G, NU = 2000.0, 700.0, 0.25
Compile = Callable[[str, Path], Path]

#: moduli of their own along the axes, without a coupling of them; a stress along the first at the start. What couples with the
#: temperature: stress -= 3 T, RPL = strain(1) T. States: NDI, NSHR, NTENS
SOURCE = """
@umat ntens
  dimension ddsddt(ntens), drplde(ntens)
  ddsdde = 0.d0
  do i = 1, ntens
    ddsdde(i,i) = props(min(i, 2))
    if (i > ndi) ddsdde(i,i) = props(3)
  end do
  stress = stress + matmul(ddsdde, dstran)
  stress(1) = stress(1) - 3*dtemp
  statev = (/ ndi, nshr, ntens /)
  rpl = (stran(1) + dstran(1))*(temp + dtemp)
  if (props(4) > 0) then
    ddsddt(1) = -3
    drplde(1) = temp + dtemp
    drpldt = stran(1) + dstran(1)
  end if
end subroutine
subroutine sigini(sigma, coords, ntens, ncrds, noel, npt, layer, kspt, lrebar, names)
  implicit real*8(a-h,o-z)
  dimension sigma(ntens), coords(ncrds)
  character*80 names(2)
  sigma(1) = 8.d0
end subroutine
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory, compile_fortran: Compile) -> Path:
    return compile_fortran(SOURCE, tmp_path_factory.mktemp("axes") / "axes.f90")


@pytest.fixture(params=[False, True], ids=["apart", "here"])
def axes(library: Path, request: pytest.FixtureRequest) -> po.Law:
    return po.Law(library, nstatv=3, in_process=request.param)


def elastic(mode: po.law.Mode, strain: object, **given: object) -> np.ndarray:
    law = po.Law("linear_elastic")
    return law.evaluate(0.0, strain, props={"E": E, "nu": NU}, mode=mode, **given).stress  # type: ignore[arg-type,no-any-return]


def test_bars_and_beams(axes: po.Law) -> None:
    nothing = np.zeros(1)
    bar = axes.evaluate(0.0, [[1e-3], [2e-3]], props=[E, E, G, 0], mode="1d", stress=nothing)
    assert np.allclose(bar.stress, [[2.0], [4.0]], rtol=1e-14) and np.array_equal(bar.state, [[1, 0, 1]] * 2)
    assert np.array_equal(bar.tangent, [[[E]]] * 2)
    beam = axes.evaluate([1e-3, 0.0], [1e-3, 2e-3], props=[E, E, G, 0], mode="beam", stress=[2.0, 0.0])
    assert np.allclose(beam.stress, [[4.0, 1.4]], rtol=1e-14) and np.array_equal(beam.state, [[1, 1, 2]])
    assert np.array_equal(beam.tangent, [[[E, 0.0], [0.0, G]]])
    # as a run has it
    steps = [po.ramp(1, e11=1e-3, g12=2e-3)]
    run = po.run(po.point(axes, [E, E, G, 0], "beam", steps), in_process=True).history
    assert run["s11"][-1] == 8.0 + E * 1e-3 and run["s12"][-1] == G * 2e-3
    with pytest.raises(po.CaseError, match=r"dstrain: has the shape"):
        axes.evaluate(0.0, np.zeros((1, 2)), props=[E, E, G, 0], mode="1d")


def test_what_is_held_while_it_expands() -> None:
    heat, alpha = 40.0, 1e-5
    bulk = E / (3 * (1 - 2 * NU))
    held = elastic("3d", np.zeros((3, 6)), expansion=alpha, temperature=0.0, dtemperature=heat)
    assert np.allclose(held, [[-3 * bulk * alpha * heat] * 3 + [0] * 3] * 3, rtol=1e-13)
    plane = elastic("plane_stress", np.zeros((2, 3)), expansion=alpha, dtemperature=[0.0, heat])
    assert np.allclose(plane, [[0, 0, 0], [-E * alpha * heat / (1 - NU)] * 2 + [0]], rtol=1e-13)
    # along the axes, over the temperature, from that at which nothing expands: 2e-5 (60 - 20) - 1e-5 (20 - 20)
    table = {"alpha": [[1e-5, 0, 0], [2e-5, 0, 0]], "temperatures": [20, 60], "zero_temperature": 20, "initial_temperature": 20}
    strain = [2e-5 * heat, 0, 0, 0, 0, 0]
    assert np.allclose(elastic("3d", strain, expansion=table, temperature=20.0, dtemperature=heat), 0.0, atol=1e-12)
    # turned by 30 degrees: a c2 + b s2 and so on
    a, b, (s, c) = 3e-5, 1e-5, (0.5, np.sqrt(0.75))
    strain = [(a * c * c + b * s * s) * heat, (a * s * s + b * c * c) * heat, b * heat, 2 * (a - b) * s * c * heat, 0, 0]
    given = {"expansion": {"alpha": [a, b, b]}, "orientation": 30.0, "dtemperature": heat}
    assert np.allclose(elastic("3d", strain, **given), 0.0, atol=1e-12)


def test_what_shrinks_over_the_time(axes: po.Law) -> None:
    shrinkage = {"times": [0, 10], "strain": [0, -1e-3]}
    stress = np.zeros((1, 1))
    for number in range(5):
        times = {"time": 2.0 * number, "dtime": 2.0}
        stress = axes.evaluate(0.0, [[0.0]], props=[E, E, G, 0], mode="1d", stress=stress, shrinkage=shrinkage, **times).stress
    assert np.allclose(stress, E * 1e-3, rtol=1e-12)


def test_local_axes(axes: po.Law) -> None:
    props, strain = [4 * E, E, G, 0], 1e-3

    def pulled(orientation: po.law.Orientation) -> po.Update:
        return axes.evaluate(0.0, [strain, 0, 0, 0, 0, 0], props=props, stress=np.zeros(6), orientation=orientation)

    assert pulled(None).stress[0, 0] == 4 * E * strain
    assert np.allclose(pulled(90.0).stress, [[E * strain, 0, 0, 0, 0, 0]], atol=1e-12)
    # local strains e/2, e/2, -e; a quarter of both moduli, and G
    turned = pulled(45.0)
    expected = [5 * E / 4 + G, 5 * E / 4 - G, 0, 3 * E / 4, 0, 0]
    assert np.allclose(turned.stress / strain, [expected], rtol=1e-12, atol=1e-9)
    assert turned.tangent is not None and np.allclose(turned.tangent[0, :, 0], expected, rtol=1e-12, atol=1e-9)
    assert np.allclose(pulled([[1, 1, 0], [-1, 1, 0]]).stress, turned.stress, rtol=1e-12, atol=1e-12)
    # SIGINI speaks of the local axes: along 2 here
    stress, _ = axes.initial(1, orientation=90.0)
    assert np.allclose(stress, [[0, 8, 0, 0, 0, 0]], atol=1e-12)
    assert np.allclose(axes.evaluate(0.0, np.zeros(6), props=props, orientation=90.0).stress, stress, atol=1e-12)


def test_as_a_run_has_it() -> None:
    material = {"expansion": {"alpha": [2e-5, 1e-5, 0]}, "orientation": 25.0, "shrinkage": {"times": [0, 1], "strain": [0, -2e-4]}}
    law = po.Law("concrete_damage")
    strain = np.array([4e-4, -1e-4, 0.0, 3e-4, 0.0, 0.0])
    held = {"e33": "hold", "g13": "hold", "g23": "hold"}
    step = {"increments": 1, "temperature": 15.0, "target": {"e11": 4e-4, "e22": -1e-4, "g12": 3e-4, **held}}
    case = {"kind": "point", "characteristic_length": 10, "material": {"plugin": "concrete_damage", **material}, "steps": [step]}
    run = po.run(case).history
    update = law.evaluate(0.0, strain, length=10.0, dtemperature=15.0, **material)
    names = ["s11", "s22", "s33", "s12", "s13", "s23"]
    assert [run[name][-1] for name in names] == update.stress[0].tolist()


def test_what_couples_with_a_temperature(axes: po.Law) -> None:
    strain = np.zeros((2, 6))
    strain[:, 0] = [1e-3, 2e-3]
    given = {"temperature": 20.0, "dtemperature": 5.0, "stress": np.zeros(6), "heat": True}
    update = axes.evaluate(0.0, strain, props=[E, E, G, 1], **given)
    assert np.allclose(update.heat.rpl, [0.025, 0.05]) and np.allclose(update.heat.drpldt, [1e-3, 2e-3])
    assert np.array_equal(update.heat.ddsddt, [[-3, 0, 0, 0, 0, 0]] * 2)
    assert np.array_equal(update.heat.drplde, [[25, 0, 0, 0, 0, 0]] * 2)
    assert np.allclose(update.stress[:, 0], E * strain[:, 0] - 15.0)
    # in local axes along 2; what is not set is 0, whatever the call before had
    turned = axes.evaluate(0.0, strain, props=[E, E, G, 1], orientation=90.0, **given).heat
    assert np.allclose(turned.ddsddt, [[0, -3, 0, 0, 0, 0]] * 2, atol=1e-12)
    props = np.array([[E, E, G, 1], [E, E, G, 0]])
    assert np.array_equal(axes.evaluate(0.0, strain, props=props, **given).heat.drpldt, [1e-3, 0.0])
    bar = axes.evaluate(0.0, [[1e-3]], props=[E, E, G, 1], mode="1d", **{**given, "stress": 0.0}).heat
    assert bar.ddsddt.shape == bar.drplde.shape == (1, 1) and bar.rpl.shape == (1,)
    with pytest.raises(po.PulloutError, match="heat=True"):
        axes.evaluate(0.0, strain, props=[E, E, G, 1]).heat


def test_a_wrong_frame_is_reported_with_its_place() -> None:
    for place, given in [
        ("material.orientation", {"orientation": [[1, 0, 0], [2, 0, 0]]}),
        ("material.expansion", {"expansion": "steel"}),
        ("material.expansion.alpha", {"expansion": {"alpha": [1e-5, 2e-5]}}),
        ("material.expansion", {"expansion": {"alpha": 1e-5, "temperture": 20}}),
        ("material.shrinkage.times", {"shrinkage": {"times": [1, 0], "strain": [0, 0]}}),
    ]:
        with pytest.raises(po.CaseError) as caught:
            elastic("3d", np.zeros(6), **given)
        assert place in str(caught.value), caught.value
    with pytest.raises(po.CaseError, match="NaN|finite|nan"):
        elastic("3d", np.zeros(6), expansion=float("nan"))
