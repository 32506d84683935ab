"""Models: curves, derivatives, fits."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pullout_fe as po
from pullout_fe.fenics import SmallStrainModel

BAR = po.point("linear_elastic", {"E": 100.0, "nu": 0.25}, "3d", [po.ramp(10, e11=0.01, e22="hold", e33="hold")])
PARAMETERS = {"E": ("material.props.E", "log"), "nu": "material.props.nu"}
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
    with pytest.raises(po.CaseError, match="nu"):
        made([1.0, 0.9])


def test_derivatives() -> None:
    young, nu = 120.0, 0.2
    found = model().jac([young, nu])
    by_nu = (2 * nu * (2 - nu)) / ((1 + nu) * (1 - 2 * nu)) ** 2
    assert np.allclose(found[:, 0], oedometer(1.0, nu), rtol=1e-5)
    assert np.allclose(found[:, 1], GRID * young * by_nu, rtol=1e-4)


def test_a_fit_finds_what_was_put_in_and_says_what_it_cannot_know() -> None:
    pytest.importorskip("scipy")
    target = oedometer(80.0, 0.25)
    one = po.Model(BAR, {"E": PARAMETERS["E"]}, ("e11", "s11"), GRID)
    fit = one.fit(target, sigma=0.01)
    assert fit.values["E"] == pytest.approx(80.0, rel=1e-8) and fit.not_identifiable == []
    # of a line: σ² / Σ(∂y/∂E)²
    expected = 0.01**2 / np.sum(oedometer(1.0, 0.25) ** 2)
    assert fit.covariance[0, 0] == pytest.approx(expected, rel=1e-4)
    # one slope does not tell two constants
    assert set(model().fit(target, sigma=0.01).not_identifiable) == {"E", "nu"}


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
    made.evaluate_without_tangent(2.0, 1.0, np.zeros(count * size * size), before, history)
    assert np.allclose(before, stress)
