"""Laws: description, updates, threads, pickles, libraries of others."""

from __future__ import annotations

import os
import pickle
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import pullout_fe as po

E, NU = 30000.0, 0.2


def elastic() -> np.ndarray:
    lame, shear = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    moduli = np.zeros((6, 6))
    moduli[:3, :3] = lame
    moduli[range(6), range(6)] += [2 * shear] * 3 + [shear] * 3
    return moduli


def cracking(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).normal(scale=1e-4, size=(count, 6))


def test_a_law_describes_itself() -> None:
    law = po.Law("linear_elastic")
    assert list(law.parameters) == ["E", "nu"]
    young = law.parameters["E"]
    assert young.unit == "MPa" and young.bounds == "> 0" and young.lower == 0.0 and young.upper is None
    assert law.modes == ["3d", "plane_strain", "axisymmetric", "plane_stress"]
    assert law.nstatv == len(law.states)
    assert "concrete_damage" in po.plugins() and "pullout_utilities" not in po.plugins()
    text = po.Law("concrete_damage")._repr_html_()
    assert "<td>G_f</td>" in text and "N/mm" in text


def test_hookes_law() -> None:
    law = po.Law("linear_elastic")
    strain = cracking(50)
    update = law.evaluate(0.0, strain, props={"E": E, "nu": NU})
    assert np.allclose(update.stress, strain @ elastic(), rtol=1e-13)
    assert update.tangent is not None and np.allclose(update.tangent, elastic(), rtol=1e-13)
    # the plane of these strains
    plane = law.evaluate(0.0, strain[:, :4], props={"E": E, "nu": NU}, mode="plane_strain", tangent=False)
    assert np.allclose(plane.stress, strain[:, :4] @ elastic()[:4, :4], rtol=1e-13) and plane.tangent is None


@pytest.mark.parametrize("name", ["concrete_damage", "j2_plasticity", "drucker_prager"])
def test_the_same_numbers_as_a_run(name: str) -> None:
    """A path point by point, with what each update gives to the next, is what the driver makes of it."""
    props = {"j2_plasticity": {"hardening": [[200.0, 0.0], [300.0, 0.1]]}}.get(name, {})
    law = po.Law(name)
    count, end = 20, 4e-3
    steps = [po.ramp(count, e11=end, e22=-1e-3, e33="hold", g12=1e-3, g13="hold", g23="hold")]
    history = po.run(po.point(law.name, props, "3d", steps)).history
    total = np.array([end, -1e-3, 0.0, 1e-3, 0.0, 0.0])
    stress, state = np.zeros((1, 6)), np.zeros((1, law.nstatv))
    for k in range(count):
        start, stop = total * (k / count), total * ((k + 1) / count if k + 1 < count else 1.0)
        law.evaluate(start, [stop - start], state, props, stress=stress, out=(stress, state), tangent=False, dtime=1 / count)
        driven = [history[column][k + 1] for column in ("s11", "s22", "s33", "s12", "s13", "s23")]
        assert np.allclose(stress[0], driven, rtol=1e-9, atol=1e-9), k


def test_the_tangent_is_the_derivative() -> None:
    law = po.Law("concrete_damage")
    props, base, step = law.props({}), cracking(1, 5), 1e-9
    moduli = law.evaluate(0.0, base, props=props).tangent
    assert moduli is not None
    moved = np.concatenate([base + step * np.eye(6), base - step * np.eye(6)])
    stress = law.evaluate(0.0, moved, props=props, tangent=False).stress
    # column j: derivative by strain j
    differences = ((stress[:6] - stress[6:]) / (2 * step)).T
    assert np.allclose(moduli[0], differences, atol=1e-5 * np.abs(differences).max())


def test_threads_give_the_same_bits_and_release_the_interpreter() -> None:
    law = po.Law("concrete_damage")
    strain = cracking(20001)
    one = law.evaluate(0.0, strain)
    for threads in (2, 7):
        several = law.evaluate(0.0, strain, threads=threads)
        assert all(np.array_equal(a, b) for a, b in zip(one, several))
    steps = 0
    done = threading.Event()

    def count() -> None:
        nonlocal steps
        while not done.is_set():
            steps += 1

    counter = threading.Thread(target=count)
    counter.start()
    time.sleep(0.05)
    before, start = steps, time.perf_counter()
    for _ in range(5):
        law.evaluate(0.0, strain)
    during, took = steps - before, time.perf_counter() - start
    done.set()
    counter.join()
    assert during > 1e4 * took, (during, took)


def test_out_takes_the_place_of_what_came_in() -> None:
    law = po.Law("concrete_damage")
    strain = cracking(10)
    fresh = law.evaluate(0.0, strain)
    stress, state, moduli = np.zeros((10, 6)), np.zeros((10, law.nstatv)), np.zeros((10, 6, 6))
    update = law.evaluate(0.0, strain, state, stress=stress, out=(stress, state, moduli))
    assert update.stress is stress and update.state is state and update.tangent is moduli
    assert all(np.array_equal(a, b) for a, b in zip(fresh, update))
    for wrong in (np.zeros((10, 5)), np.zeros((10, 6), dtype="f4"), np.zeros((6, 10)).T):
        with pytest.raises(po.CaseError, match=r"out\[0\]"):
            law.evaluate(0.0, strain, out=(wrong, state))
    with pytest.raises(po.CaseError, match="another array"):
        law.evaluate(0.0, stress, out=(stress, state))


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_updates_between_points(threads: int) -> None:
    law, count = po.Law("concrete_damage"), 1_000_000
    stress, state = np.zeros((count, 6)), np.zeros((count, law.nstatv))

    def interrupt() -> None:
        while not stress[0].any():
            time.sleep(1e-3)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        law.evaluate(0.0, np.full((count, 6), 1e-4), tangent=False, threads=threads, out=(stress, state))
    assert stress[0].any() and not stress[-1].any()


def test_what_is_wrong_is_said_with_its_place() -> None:
    with pytest.raises(po.PluginError, match="linear_elastic"):
        po.Law("linear_elastik")
    with pytest.raises(po.PluginError, match="no library file"):
        po.Law("./libnowhere.so")
    law = po.Law("linear_elastic")
    with pytest.raises(po.CaseError) as caught:
        law.props({"E": -1.0, "mu": 1.0})
    assert [place for place, _ in caught.value.problems] == ["$.material.props.mu", "$.material.props.E"]
    with pytest.raises(po.CaseError, match="threads"):
        law.evaluate(0.0, np.zeros((1, 6)), threads=0)
    with pytest.raises(ValueError, match="mode"):
        law.evaluate(0.0, np.zeros((1, 6)), mode="2d")
    with pytest.raises(po.CaseError, match=r"\(3, 5\)"):
        law.evaluate(np.zeros((3, 5)), np.zeros((3, 6)))
    with pytest.raises(po.CaseError, match="bond_slip"):
        po.Law("bond_slip").evaluate(0.0, np.zeros((1, 6)))


def test_a_crack_band_needs_a_length() -> None:
    law, strain = po.Law("concrete_damage"), [[4e-4, 0, 0, 0, 0, 0]]
    with pytest.raises(po.CaseError, match="length: is missing: concrete_damage"):
        law.evaluate(0.0, strain, props={"G_f": 0.1})
    wide, narrow = (law.evaluate(0.0, strain, props={"G_f": 0.1}, length=length).stress[0, 0] for length in (200.0, 50.0))
    assert wide != narrow
    law.evaluate(0.0, strain)


def test_points_that_are_refused(umats: dict[str, Path]) -> None:
    law = po.Law(umats["refuses"], nstatv=1)
    strain = np.zeros((4, 6))
    strain[2, 0] = 2.0
    with pytest.raises(po.UpdateFailed, match="PNEWDT") as caught:
        law.evaluate(0.0, strain, props=[E])
    (point,) = caught.value.points
    assert point[0] == 2 and point[2] == 0.5
    update = law.evaluate(0.0, strain, props=[E], on_failure="nan")
    assert np.isnan(update.stress[2]).all() and np.array_equal(update.state[:, 0], [1.0, 1.0, 0.0, 1.0])


def test_a_pickle_is_a_recipe(tmp_path: Path, umats: dict[str, Path]) -> None:
    law = pickle.loads(pickle.dumps(po.Law("concrete_damage")))
    assert np.array_equal(law.evaluate(0.0, cracking(3)).stress, po.Law("concrete_damage").evaluate(0.0, cracking(3)).stress)
    library = tmp_path / "libmine.so"
    library.write_bytes(umats["refuses"].read_bytes())
    kept = pickle.dumps(po.Law(library, nstatv=1))
    assert pickle.loads(kept).nstatv == 1
    library.write_bytes(umats["stops"].read_bytes())
    with pytest.raises(po.PluginError, match="another build"):
        pickle.loads(kept)


def test_a_library_that_stops_ends_its_own_process_only(
    umats: dict[str, Path], capfd: pytest.CaptureFixture[str]
) -> None:
    law = po.Law(umats["stops"], nstatv=1)
    strain = np.zeros((2, 6))
    strain[0, 0] = 1e-3
    update = law.evaluate(0.0, strain, props=[E])
    assert update.stress[0, 0] == E * 1e-3
    assert capfd.readouterr().err == ""
    with pytest.raises(po.PluginCrashed, match="exit code 0"):
        law.evaluate(0.0, strain + [2.0, 0, 0, 0, 0, 0], props=[E])
    # and is there again
    assert law.evaluate(0.0, strain, props=[E]).stress[0, 0] == E * 1e-3


def test_a_library_that_hangs_is_ended(umats: dict[str, Path]) -> None:
    law = po.Law(umats["hangs"], nstatv=1, time_limit=2.0)
    with pytest.raises(po.TimeLimit, match="2 s"):
        law.evaluate(0.0, [[2.0, 0, 0, 0, 0, 0]], props=[E])
    # by a process of its own, which is ended, and started again
    assert law.evaluate(0.0, [[1e-4, 0, 0, 0, 0, 0]], props=[E]).stress.any()


def test_a_library_runs_here_if_one_answers_for_it(umats: dict[str, Path], tmp_path: Path) -> None:
    library = tmp_path / "libmine.so"
    library.write_bytes(umats["refuses"].read_bytes())
    apart, here = po.Law(library, nstatv=1), po.Law(library, nstatv=1, in_process=True)

    def loaded() -> bool:
        return str(library) in Path("/proc/self/maps").read_text()

    assert loaded()
    other = po.Law(umats["stops"], nstatv=1)
    assert str(umats["stops"]) not in Path("/proc/self/maps").read_text() and other.nstatv == 1
    strain = cracking(5)
    assert np.array_equal(
        apart.evaluate(0.0, strain, props=[E]).stress, here.evaluate(0.0, strain, props=[E], threads=2).stress
    )


def test_a_library_without_metadata_needs_the_number_of_its_states(umats: dict[str, Path]) -> None:
    with pytest.raises(po.CaseError, match="nstatv"):
        po.Law(umats["stops"])


def test_times_and_numbers_that_are_none_are_refused() -> None:
    law = po.Law("concrete_damage_implex")
    for dtime in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(po.CaseError, match="dtime: is"):
            law.evaluate(0.0, np.zeros((1, 6)), dtime=dtime)
    with pytest.raises(po.CaseError, match="time: is nan"):
        law.evaluate(0.0, np.zeros((1, 6)), time=np.nan)
    with pytest.raises(po.CaseError, match="props.E: is nan"):
        law.props({"E": np.nan})
    values = law.props()
    values[1] = np.inf
    with pytest.raises(po.CaseError, match=f"props.{list(law.parameters)[1]}: is inf"):
        law.props(values)
    with pytest.raises(po.CaseError, match="strain: is a masked array"):
        law.evaluate(np.ma.masked_all((1, 6)), np.zeros((1, 6)))


def test_no_points_are_no_work() -> None:
    law = po.Law("concrete_damage")
    update = law.evaluate(0.0, np.zeros((0, 6)))
    assert update.stress.shape == (0, 6) and update.state.shape == (0, law.nstatv)
    assert update.tangent is not None and update.tangent.shape == (0, 6, 6)
    assert law.evaluate(np.zeros((0, 4)), 0.0, mode="plane_strain", threads=2).stress.shape == (0, 4)
    with pytest.raises(po.CaseError, match="strain: has the shape"):
        law.evaluate(np.zeros((5, 6)), np.zeros((0, 6)))


def test_laws_that_are_listed_can_be_opened() -> None:
    assert "linear_elastic" in po.plugins() and "pullout_laws" not in po.plugins()
