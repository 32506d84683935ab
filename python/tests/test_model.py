"""Models: curves, derivatives, fits."""

from __future__ import annotations

import enum
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import types
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pullout_fe as po
from pullout_fe.fenics import SmallStrainModel

BAR = po.point("linear_elastic", {"E": 100.0, "nu": 0.25}, "3d", [po.ramp(10, e11=0.01, e22="hold", e33="hold")])
PARAMETERS = {"E": ("material.props.E", "log"), "nu": "material.props.nu"}
FIBRE = Path(__file__).parents[2] / "cases/chapter-6/6.14-plane.json"
GRID = np.linspace(0.0, 0.01, 7)


def oedometer(young: float, nu: float) -> np.ndarray:
    return GRID * young * (1 - nu) / (1 + nu) / (1 - 2 * nu)


def model() -> po.Model:
    return po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID, on_failure=np.nan)


def test_a_model_is_its_curve() -> None:
    made = pickle.loads(pickle.dumps(model()))
    assert np.array_equal(made.x0, [100.0, 0.25])
    assert np.allclose(made([200.0, 0.1]), oedometer(200.0, 0.1))
    points = np.array([[100.0, 0.1], [50.0, 0.2]])
    for executor in (None, ThreadPoolExecutor(2)):
        assert np.allclose(made.batch(points, executor), [oedometer(*point) for point in points])
    with pytest.raises(po.CaseError, match="E, nu"):
        made([1.0])
    # what the case does not admit fails like a run, where a number is to stand for that
    assert np.isnan(made([1.0, 0.9])).all() and made([1.0, 0.9]).shape == GRID.shape
    with pytest.raises(po.CaseError, match="nu"):
        po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID)([1.0, 0.9])
    # but not what is wrong with any parameters
    with pytest.raises(po.CaseError, match="no parameter 'mu'"):
        po.Model(BAR, {"mu": "material.props.mu"}, ("e11", "s11"), GRID, on_failure=np.nan)([0.1])


MISPLACED = ["material.prop.E", "material.props.EE", "steps[7].target.e11", "steps[0].target.e1", "title.x", "mode", "titel"]


@pytest.mark.parametrize("place", MISPLACED)
@pytest.mark.parametrize("is_foreign", [False, True])
def test_a_misplaced_parameter_is_no_failed_run(place: str, is_foreign: bool, umats: dict[str, Path]) -> None:
    bar: Any = BAR
    if is_foreign:
        place = {"material.prop.E": "material.prop[0]", "material.props.EE": "material.props.E"}.get(place, place)
        material = {"plugin": str(umats["refuses"]), "props": [100.0], "nstatv": 1}
        bar = BAR.with_({"material": material})
    made = po.Model(bar, {"x": place}, ("e11", "s11"), GRID, on_failure=np.nan)
    with pytest.raises(po.CaseError) as caught:
        made([0.1])
    assert "structure" in caught.value.kinds and len(caught.value.kinds) == len(caught.value.problems)
    assert pickle.loads(pickle.dumps(caught.value)).kinds == caught.value.kinds


def test_a_case_that_is_wrong_elsewhere_is_no_failed_run() -> None:
    wrong = BAR.with_({"characteristic_length": -1.0})
    # nu keeps its default: that does not concern the rest
    open_case = po.Case({**wrong.document, "material": {"plugin": "linear_elastic", "props": {"E": 100.0}}})
    for case, free in ((wrong, PARAMETERS), (open_case, {"nu": "material.props.nu"})):
        with pytest.raises(po.CaseError, match="characteristic_length"):
            po.Model(case, free, ("e11", "s11"), GRID, on_failure=np.nan)([0.1] * len(free))


def test_errors_of_a_foreign_library_s_case_keep_place_and_kind(umats: dict[str, Path]) -> None:
    material = {"plugin": str(umats["refuses"]), "props": [100.0], "nstatv": 1}
    case = {**BAR.document, "material": material, "mode": "4d", "characteristic_length": -1.0, "titel": "x"}
    own = {**case, "material": BAR.document["material"]}
    for act in (po.run, lambda wrong: po.Case(wrong).check()):
        found = []
        for wrong in (case, own):
            with pytest.raises(po.CaseError) as caught:
                act(wrong)
            found.append((caught.value.problems, caught.value.kinds))
        assert found[0] == found[1]
        assert sorted(zip([place for place, _ in found[0][0]], found[0][1])) == [
            ("$.characteristic_length", "input"), ("$.mode", "structure"), ("$.titel", "structure")]


@pytest.mark.parametrize("name", ["batch", "jac"])
def test_ctrl_c_ends_runs_in_threads(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """They hear of no signals."""
    ended: list[po.Run] = []
    run, main, pressed = po.model.run, threading.get_ident(), threading.Event()

    def watched(*arguments: Any, **keywords: Any) -> po.Run:
        if threading.get_ident() != main and not pressed.is_set():
            pressed.set()
            # when all have begun
            threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        made = run(*arguments, **keywords)
        ended.append(made)
        return made

    monkeypatch.setattr(po.model, "run", watched)
    long = po.point("concrete_damage", {"E": 31800.0}, "3d", [po.ramp(3_000_000, e11=-0.003)])
    case = long if name == "batch" else po.Case(FIBRE).with_({"steps.0.slip": 0.1})
    place = "material.props.E" if name == "batch" else "contact.law.props.k_e"
    made = po.Model(case, {"x": place}, ("e11", "s11") if name == "batch" else ("slip", "load"), [0.0])
    with pytest.raises(KeyboardInterrupt):
        made.batch([[3e4], [3.1e4]]) if name == "batch" else made.jac(made.x0)
    # but the first of those of derivatives
    assert len(ended) == (name == "jac")


def test_failures_have_the_length_of_the_curve() -> None:
    free = po.Model(BAR, PARAMETERS, ("e11", "s11"), on_failure=np.nan)
    with pytest.raises(po.CaseError, match="give a grid"):
        free([1.0, 0.9])
    with pytest.raises(po.CaseError, match="give a grid"):
        free.batch([[1.0, 0.9], [1.0, 0.8]])
    curves = free.batch([[1.0, 0.9], [1.0, 0.2]])
    assert curves.shape == (2, 11) and np.isnan(curves[0]).all() and np.isfinite(curves[1]).all()
    assert free([1.0, 0.9]).shape == (11,)


def test_bounds_are_of_parameters_and_kept_by_derivatives() -> None:
    with pytest.raises(po.CaseError, match="EE"):
        po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID, bounds={"EE": (1.0, 2.0)})
    with pytest.raises(po.CaseError, match="not below"):
        po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID, bounds={"E": (2.0, 1.0)})

    class Watched(po.Model):
        """A model that notes what it is asked for."""

        def _attempt(self, x: np.ndarray) -> np.ndarray | None:
            assert x[0] <= 120.0, x
            return super()._attempt(x)

    made = Watched(BAR, {"E": "material.props.E"}, ("e11", "s11"), GRID, bounds={"E": (10.0, 120.0)})
    assert np.allclose(made.jac([120.0])[:, 0], oedometer(1.0, 0.25), rtol=1e-5)


def test_a_fit_says_what_scatters_and_what_ended_on_a_bound() -> None:
    scatter = 0.01 * np.array([1, -1, 1, 0, -1, 1, -1])
    one = po.Model(BAR, {"E": "material.props.E"}, ("e11", "s11"), GRID)
    fit = one.fit(oedometer(80.0, 0.25) + scatter)
    # of a line: s² / Σ(∂y/∂E)² with s² = Σr² / (n - 1)
    left = one([fit.values["E"]]) - oedometer(80.0, 0.25) - scatter
    expected = np.sum(left**2) / 6 / np.sum(oedometer(1.0, 0.25) ** 2)
    assert fit.covariance[0, 0] == pytest.approx(expected, rel=1e-4)
    assert fit.on_bound == {} and fit.not_identifiable == []
    low = po.Model(BAR, {"E": "material.props.E"}, ("e11", "s11"), GRID, bounds={"E": (90.0, 200.0)})
    assert low.fit(oedometer(80.0, 0.25)).on_bound == {"E": 90.0}
    with pytest.raises(po.CaseError, match="give sigma"):
        po.Model(BAR, {"E": "material.props.E"}, ("e11", "s11"), [0.01]).fit([1.0])


def test_cycles_are_interpolated_branch_by_branch() -> None:
    steps = [po.ramp(40, slip=0.02), po.ramp(40, slip=0.005), po.ramp(40, slip=0.03)]
    props = {"law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4}
    bond = {"kind": "interface", "material": {"plugin": "bond_slip", "props": props}, "steps": steps}
    history = po.run(bond).history
    free = {"k_e": "material.props.k_e"}
    made = po.Model(bond, free, ("slip", "tau"), history["slip"])
    assert np.allclose(made([950.0]), history["tau"], rtol=0, atol=1e-12)
    # a branch that the run does not have
    once = po.Model({**bond, "steps": steps[:1]}, free, ("slip", "tau"), [0.01, 0.02, 0.01])
    assert np.array_equal(np.isnan(once([950.0])), [False, False, True])


@pytest.mark.parametrize("back", [0.0985, 0.095, 0.092])
def test_small_loops_are_followed_and_what_is_not_is_said(back: float) -> None:
    steps = [po.ramp(50, slip=0.1), po.ramp(20, slip=back), po.ramp(50, slip=0.2)]
    props = {"law": "A", "k_e": 950.0, "a_1": 1.5921, "b_1": 0.0832, "k_u": 300.0}
    bond = {"kind": "interface", "material": {"plugin": "bond_slip", "props": props}, "steps": steps}
    history = po.run(bond).history
    free = {"k_u": "material.props.k_u"}
    made = po.Model(bond, free, ("slip", "tau"), history["slip"])
    assert np.array_equal(made([300.0]), history["tau"]) and np.abs(made.jac([300.0])).max() > 0
    once = po.Model({**bond, "steps": [po.ramp(50, slip=0.2)]}, free, ("slip", "tau"), history["slip"])
    with pytest.warns(UserWarning, match="counts as scatter"):
        once([300.0])


@pytest.mark.slow
def test_derivatives_by_what_steps_ask_for() -> None:
    """Where the steps of a specimen lead, and how long they take: at each time, against differences of runs."""
    fibre = po.Case(FIBRE).with_({"steps[0].slip": 0.005, "mesh.specimen.embedded_elements": 6, "output.vtu": False})
    fibre = fibre.with_({"steps[0].time": 1.0})
    for place, value in (("steps[0].slip", 0.005), ("steps[0].time", 1.0)):
        made = po.Model(fibre, {"x": place}, ("time", "load"), [0.2, 0.5, 0.8])
        step = 1e-3 * value
        expected = (made([value + step]) - made([value - step])) / (2 * step)
        assert np.allclose(made.jac([value])[:, 0], expected, rtol=1e-2)
    base = po.run(fibre, record=True)
    assert po.run(fibre.with_({"steps[0].time": 2.0}), along=base).history["time"][-1] == pytest.approx(2.0)
    longer = po.run(fibre.with_({"steps[1].slip": 0.006}), along=base)
    assert longer.history["slip"][-1] == pytest.approx(0.006)
    shorter = po.run(fibre.with_({"until": {"quantity": "slip", "greater_than": 0.003}}), along=base)
    assert 0.003 < shorter.history["slip"][-1] < 0.004


def test_derivatives() -> None:
    young, nu = 120.0, 0.2
    found = model().jac([young, nu])
    by_nu = (2 * nu * (2 - nu)) / ((1 + nu) * (1 - 2 * nu)) ** 2
    assert np.allclose(found[:, 0], oedometer(1.0, nu), rtol=1e-5)
    assert np.allclose(found[:, 1], GRID * young * by_nu, rtol=1e-4)


@pytest.mark.slow
def test_derivatives_are_of_the_increments_of_one_run() -> None:
    """A specimen that chooses its increments; and they are repeated to the bit."""
    fibre = po.Case(FIBRE).with_({"steps[0].slip": 0.03, "output.vtu": False})
    slips = np.array([0.005, 0.01, 0.02, 0.025])
    made = po.Model(fibre, {"k": "contact.law.props.k_e", "a": "contact.law.props.a_1"}, ("slip", "load"), slips)
    base = po.run(fibre, record=True)
    frozen = fibre.with_({"increments": base.increments})
    assert np.array_equal(po.run(frozen).history["load"], base.history["load"])
    # what the tolerance leaves in the loads is more than they differ by
    exact = frozen.with_({"controls.force_tolerance": 1e-10})
    central = po.Model(exact, {"k": "contact.law.props.k_e", "a": "contact.law.props.a_1"}, ("slip", "load"), slips)
    # larger ones meet the kinks of the law
    steps = np.diag(1e-5 * made.x0)
    expected = np.array([(central(made.x0 + step) - central(made.x0 - step)) / (2 * step.sum()) for step in steps]).T
    assert np.allclose(made.jac(made.x0), expected, rtol=0, atol=1e-4 * np.abs(expected).max(axis=0))


def test_a_fit_finds_what_was_put_in_and_says_what_it_cannot_know() -> None:
    target = oedometer(80.0, 0.25)
    one = po.Model(BAR, {"E": PARAMETERS["E"]}, ("e11", "s11"), GRID)
    fit = one.fit(target, sigma=0.01)
    assert fit.values["E"] == pytest.approx(80.0, rel=1e-8) and fit.not_identifiable == []
    # of a line: σ² / Σ(∂y/∂E)²
    expected = 0.01**2 / np.sum(oedometer(1.0, 0.25) ** 2)
    assert fit.covariance[0, 0] == pytest.approx(expected, rel=1e-4)
    # one slope does not determine two constants
    assert set(model().fit(target, sigma=0.01).not_identifiable) == {"E", "nu"}


def test_a_fit_from_several_places_takes_the_best_end() -> None:
    made = po.Model(BAR, {"nu": "material.props.nu"}, ("e11", "s11"), GRID, bounds={"nu": (-0.6, 0.45)})
    # (1 - nu)/(1 + nu)/(1 - 2 nu) is least at 0: from below, the way leads to the lower bound
    target = oedometer(100.0, 0.4)
    one = made.fit(target, sigma=1.0, x0=[-0.3], starts=1)
    # as many as the program has
    four = made.fit(target, sigma=1.0, x0=[-0.3])
    assert one.on_bound == {"nu": -0.6} and four.values["nu"] == pytest.approx(0.4, rel=1e-6)
    assert four.evaluations > one.evaluations
    with pytest.raises(po.CaseError, match="starts: lie between bounds: give those of E"):
        po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID, bounds={"nu": (0.0, 0.4)}).fit(target, starts=2)


def test_a_fit_keeps_a_single_bound_and_goes_back_where_a_run_fails() -> None:
    def fitted(place: str, bounds: tuple[float, float], target: np.ndarray, x0: float) -> po.model.Fit:
        return po.Model(BAR, {"x": place}, ("e11", "s11"), GRID, bounds={"x": bounds}).fit(target, sigma=1.0, x0=[x0])

    for place in (PARAMETERS["E"], PARAMETERS["E"][0]):
        assert fitted(place, (90.0, np.inf), oedometer(80.0, 0.25), 100.0).on_bound == {"x": 90.0}
        assert fitted(place, (-np.inf, 70.0), oedometer(80.0, 0.25), 60.0).on_bound == {"x": 70.0}
    with pytest.raises(po.CaseError, match="x0: x = 80.0 is not within 90.0:inf"):
        fitted(PARAMETERS["E"], (90.0, np.inf), oedometer(80.0, 0.25), 80.0)
    # the first step from 0.1 leads beyond 0.5, which the law refuses
    free = fitted(PARAMETERS["nu"], (-np.inf, np.inf), oedometer(100.0, 0.45), 0.1)
    assert free.values["x"] == pytest.approx(0.45, rel=1e-6)


def test_a_fit_passes_on_what_a_function_raises() -> None:
    class Stops(po.Model):
        def residual(self, *arguments: Any) -> np.ndarray:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Stops(BAR, {"E": "material.props.E"}, ("e11", "s11"), GRID).fit(oedometer(80.0, 0.25))


def test_places_have_one_meaning() -> None:
    from pullout_fe import _core

    # as the program reads them: what is no index is a key
    for path, dotted in [("$.steps[0].target", "steps.0.target"), ("a[-1]", "a[-1]"), ("a['b']", "a['b']")]:
        assert _core.dotted(path) == dotted


@pytest.mark.slow
def test_the_program_fits_to_the_same_values(tmp_path: Path) -> None:
    props = {"law": "A", "k_e": 700.0, "a_1": 8.0, "b_1": 0.4}
    bond = {"kind": "interface", "material": {"plugin": "bond_slip", "props": props}, "steps": [po.ramp(500, slip=0.01)]}
    slips = np.array([2e-4, 4e-4, 1e-3, 2e-3, 5e-3, 1e-2])
    # near the curve of k_e = 950, a_1 = 10, and none of the law
    tractions = np.array([0.2, 0.37, 0.63, 0.85, 1.18, 1.60])
    paths = {"k_e": "material.props.k_e", "a_1": "material.props.a_1"}
    bounds = {"k_e": (100.0, 5000.0), "a_1": (1.0, 50.0)}
    fit = po.Model(bond, paths, ("slip", "tau"), slips, bounds=bounds).fit(tractions)
    (tmp_path / "bond.json").write_text(json.dumps(bond))
    np.savetxt(tmp_path / "data.csv", np.array([slips, tractions]).T, delimiter=",", header="slip,tau", comments="")
    free = [f"--free={paths[name]}={low}:{high}" for name, (low, high) in bounds.items()]
    command = [po.program(), "fit", "bond.json", "--data=data.csv", "--curve=slip,tau", "--out=found", *free]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    found = json.loads((tmp_path / "found" / "fit.json").read_text())["parameters"]
    assert [number["value"] for number in found] == pytest.approx(list(fit.values.values()), rel=1e-8)
    assert [number["standard_error"] for number in found] == pytest.approx(list(fit.standard_errors().values()), rel=1e-6)


@pytest.mark.parametrize("constraint", ["FULL", "PLANE_STRAIN", "PLANE_STRESS"])
def test_the_protocol_of_fenics(constraint: str) -> None:
    """Two increments in Mandel notation are those of evaluate."""
    law = po.Law("concrete_damage")
    made = SmallStrainModel(law, {}, constraint)
    assert made.constraint.name == constraint
    size, dimension, count = made.geometric_dim, made.stress_strain_dim, 5
    dimensions = made.history_dim
    assert dimensions is not None
    history = {name: np.zeros(count * int(np.prod(dim))) for name, dim in dimensions.items()}
    stress, tangent = np.zeros(count * dimension), np.zeros(count * dimension**2)
    gradients = np.random.default_rng(3).normal(scale=1e-4, size=(2, count, size, size))
    mode = {"FULL": "3d", "PLANE_STRAIN": "plane_strain", "PLANE_STRESS": "plane_stress"}[constraint]
    rows = {"FULL": [0, 1, 2, 3, 4, 5], "PLANE_STRAIN": [0, 1, 2, 3], "PLANE_STRESS": [0, 1, 3]}[constraint]
    strain = np.zeros((count, len(rows)))
    state, own = np.zeros((count, law.nstatv)), np.zeros((count, len(rows)))
    for time, gradient in enumerate(gradients):
        whole = np.zeros((count, 3, 3))
        whole[:, :size, :size] = (gradient + gradient.transpose(0, 2, 1)) / 2
        pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
        increment = np.array([[(1 if i == j else 2) * e[i, j] for i, j in pairs] for e in whole])[:, rows]
        update = law.evaluate(strain, increment, state, {}, mode=mode, stress=own, time=float(time))
        made.evaluate(float(time), 1.0, gradient.ravel(), stress, tangent, history)
        strain, state, own = strain + increment, update.state, update.stress
        found = stress.reshape(count, dimension)
        factors = np.array([1.0 if row < 3 else np.sqrt(2.0) for row in rows])
        assert np.allclose(found[:, rows], own * factors, rtol=1e-12)
        # dσ = D dε holds in both notations
        mandel = tangent.reshape(count, dimension, dimension)
        probe = np.random.default_rng(4).normal(size=(count, len(rows)))
        direct = np.einsum("nij,nj->ni", update.tangent, probe) * factors
        embedded = np.zeros((count, dimension))
        embedded[:, rows] = probe / factors
        assert np.allclose(np.einsum("nij,nj->ni", mandel, embedded)[:, rows], direct, rtol=1e-9, atol=1e-6)
    assert np.allclose(history["strain"].reshape(count, -1), strain)
    assert np.array_equal(history["state"].reshape(count, -1), state)
    before = stress.copy()
    with pytest.raises(po.CaseError, match="length: is missing"):
        SmallStrainModel(law, {"G_f": 0.1}, constraint)
    SmallStrainModel(law, {"G_f": 0.1}, constraint, length=50.0)
    made.evaluate_without_tangent(2.0, 1.0, np.zeros(count * size * size), before, history)
    assert np.allclose(before, stress)


def test_two_tests_share_their_parameters() -> None:
    """A bar that is held and one that is free: s11 = E (1 - nu) / ((1 + nu) (1 - 2 nu)) e11 and E e11. Neither determines both."""
    free = po.point("linear_elastic", {"E": 60.0}, "3d", [po.ramp(10, e11=0.01)])
    bounds = {"E": (10.0, 300.0), "nu": (0.0, 0.4)}
    held = po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID, bounds=bounds)
    other = po.Model(free, {"E": PARAMETERS["E"]}, ("e11", "s11"), GRID[:3], bounds={"E": (20.0, 400.0)})
    both = po.Models([other, held])
    assert (both.names, both.x0.tolist(), both.bounds) == (["E", "nu"], [60.0, 0.25], [(20.0, 300.0), (0.0, 0.4)])
    data = np.concatenate([80.0 * GRID[:3], oedometer(80.0, 0.3)])
    found = both.fit(data, sigma=np.concatenate([np.full(3, 1e-3), np.full(len(GRID), 1e-2)]))
    assert np.allclose(list(found.values.values()), [80.0, 0.3], rtol=1e-6)
    assert found.not_identifiable == []
    assert held.fit(oedometer(80.0, 0.3), sigma=1e-2).not_identifiable == ["E", "nu"]
    # columns of a parameter that a model does not have are 0
    slopes = both.jac([80.0, 0.3])
    assert np.all(slopes[:3, 1] == 0.0) and np.allclose(slopes[:3, 0], GRID[:3])
    with pytest.raises(po.CaseError, match="a logarithm in some models only"):
        po.Models([held, po.Model(free, {"E": "material.props.E"}, ("e11", "s11"), GRID)])
    with pytest.raises(po.CaseError, match="the run ends at e11 0.01, the data go on to 0.02"):
        po.Models([held, po.Model(free, {"E": PARAMETERS["E"]}, ("e11", "s11"), [0.02])]).fit(np.ones(len(GRID) + 1), sigma=1.0)


def test_a_curve_that_goes_backwards_and_a_grid_beyond_it() -> None:
    """Compression, whose strains fall: outside of what the run passes there is no value."""
    bar = po.point("linear_elastic", {"E": 100.0, "nu": 0.25}, "3d", [po.ramp(7, e11=-0.01)])
    grid = np.array([0.001, 0.0, -0.003, -0.01 - 1e-13, -0.011])
    made = po.Model(bar, {"E": "material.props.E"}, ("e11", "s11"), grid)
    assert np.allclose(made([100.0]), [np.nan, 0.0, -0.3, -1.0, np.nan], equal_nan=True)


def test_a_fit_refuses_data_without_information() -> None:
    one = po.Model(BAR, {"E": "material.props.E"}, ("e11", "s11"), GRID)
    target = oedometer(80.0, 0.25)
    for sigma in (-1.0, 0.0, np.nan):
        with pytest.raises(po.CaseError, match="sigma: is a finite number > 0"):
            one.fit(target, sigma=sigma)
    with pytest.raises(po.CaseError, match="data: has no finite number"):
        one.fit(np.full(len(GRID), np.nan), sigma=1.0)
    with pytest.raises(po.CaseError, match="masked"):
        one.fit(np.ma.masked_greater(target, 0.5))
    with pytest.raises(po.CaseError, match="has the place of 'E'"):
        po.Model(BAR, {"E": "material.props.E", "F": ("$.material.props.E", "log")}, ("e11", "s11"), GRID)
    beyond = po.Model(BAR, {"E": "material.props.E"}, ("e11", "s11"), [0.005, 0.02])
    with pytest.raises(po.CaseError, match="the run ends at e11 0.01, the data go on to 0.02"):
        beyond.fit([1.0, 2.0], sigma=1.0)
    with pytest.raises(po.CaseError, match="begins at e11 0, the data also have -0.001"):
        po.Model(BAR, {"E": "material.props.E"}, ("e11", "s11"), [-0.001, 0.01]).fit([1.0, 2.0], sigma=1.0)


def test_what_would_silently_be_something_else_is_refused() -> None:
    with pytest.raises(po.CaseError, match="'log', not 'ln'"):
        po.Model(BAR, {"E": ("material.props.E", "ln")}, ("e11", "s11"), GRID)
    with pytest.raises(po.CaseError, match="'raise' or a number"):
        po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID, on_failure="nan")
    for data in (np.ones(1), np.ones(5)):
        with pytest.raises(po.CaseError, match="data: have the shape"):
            model().residual([100.0, 0.2], data)
    with pytest.raises(po.CaseError, match="x0: has the shape"):
        model().fit(oedometer(90.0, 0.2), x0=[90.0])


def test_parameters_that_are_no_numbers_fail() -> None:
    assert np.isnan(model()([np.nan, 0.2])).all()
    with pytest.raises(po.CaseError, match="material.props.E: is nan"):
        po.Model(BAR, PARAMETERS, ("e11", "s11"), GRID)([np.nan, 0.2])


@pytest.mark.parametrize("module", ["fenics_constitutive", "fenics_constitutive.models"])
def test_the_constraint_is_an_enumerator_of_fenics(module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = enum.Enum("StressStrainConstraint", ["FULL", "PLANE_STRAIN", "PLANE_STRESS"])
    law = po.Law("linear_elastic")
    assert SmallStrainModel(law, {}, "PLANE_STRAIN").constraint == ("PLANE_STRAIN", 4, 2)
    given = SmallStrainModel(law, {}, theirs["PLANE_STRESS"])
    assert given.constraint is theirs["PLANE_STRESS"] and given.stress_strain_dim == 4
    # releases have it at the top, later versions among the models
    monkeypatch.setitem(sys.modules, "fenics_constitutive", types.ModuleType("fenics_constitutive"))
    installed = types.ModuleType(module)
    setattr(installed, "StressStrainConstraint", theirs)
    monkeypatch.setitem(sys.modules, module, installed)
    assert SmallStrainModel(law, {}, "PLANE_STRAIN").constraint is theirs["PLANE_STRAIN"]


def test_fenics_may_ask_for_no_points() -> None:
    made = SmallStrainModel(po.Law("concrete_damage"), {}, "PLANE_STRAIN")
    dimensions = made.history_dim
    assert dimensions is not None
    none = np.zeros(0)
    made.evaluate(0.0, 1.0, none, none.copy(), none.copy(), {name: none.copy() for name in dimensions})
