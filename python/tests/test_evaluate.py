"""Calls of laws as a finite element program makes them: what else a library has, what points are given, what is refused."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import pullout_fe as po
from pullout_fe.fenics import SmallStrainModel

E = 2000.0
Compile = Callable[[str, Path], Path]

#: E comes from UEXTERNALDB, states from SDVINI, a stress from SIGINI; the states end as what the UMAT was given
SOURCE = """
subroutine uexternaldb(lop, lrestart, time, dtime, kstep, kinc)
  implicit real*8(a-h,o-z)
  dimension time(2)
  common /table/ young, calls(0:6), clock(3)
  if (lop == 0) young = 2000.d0
  calls(lop) = calls(lop) + 1.d0
  if (lop == 2) clock = (/ time(2), dtime, dble(kinc) /)
end subroutine
subroutine sdvini(statev, coords, nstatv, ncrds, noel, npt, layer, kspt)
  implicit real*8(a-h,o-z)
  dimension statev(nstatv), coords(ncrds)
  statev(1) = 100*noel + 10*npt + coords(1)
end subroutine
subroutine sigini(sigma, coords, ntens, ncrds, noel, npt, layer, kspt, lrebar, names)
  implicit real*8(a-h,o-z)
  dimension sigma(ntens), coords(ncrds)
  character*80 names(2)
  sigma(2) = 7.d0
end subroutine
@umat ntens
  common /table/ young, calls(0:6), clock(3)
  ddsdde = 0.d0
  do i = 1, ntens
    ddsdde(i,i) = young
    stress(i) = stress(i) + young*dstran(i)
  end do
  sse = sse + 0.5d0*young*dstran(1)**2
  spd = props(1)
  scd = celent
  statev(2:8) = calls
  statev(9:11) = clock
  i = nint(props(2))
  statev(12:) = (/ temp, dtemp, predef(i), dpred(i), coords(3), drot(1,2), dfgrd0(1,2), dfgrd1(1,2), dble(noel), dble(npt), &
    dble(kinc), time(2), celent, props(1), dble(jstep(3)) /)
end subroutine
"""
STATES = 26
GIVEN = {name: 11 + k for k, name in enumerate(
    "temp dtemp predef dpred coords drot dfgrd0 dfgrd1 noel npt kinc time celent props nlgeom".split())}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory, compile_fortran: Compile) -> Path:
    return compile_fortran(SOURCE, tmp_path_factory.mktemp("recorder") / "recorder.f90")


@pytest.fixture(params=[False, True], ids=["apart", "here"])
def recorder(library: Path, tmp_path: Path, request: pytest.FixtureRequest) -> po.Law:
    """A copy of its own: what COMMON holds is that of a file."""
    own = tmp_path / "librecorder.so"
    own.write_bytes(library.read_bytes())
    return po.Law(own, nstatv=STATES, in_process=request.param)


def test_what_stands_around_a_umat_is_called_as_a_run_calls_it(recorder: po.Law) -> None:
    strain = np.zeros((2, 3, 6))
    strain[..., 0] = 1e-3
    update = recorder.evaluate(0.0, strain, props=[1.0, 1.0], coords=[0.5, 0, 0])
    # E of UEXTERNALDB, stress of SIGINI, states of SDVINI
    assert np.allclose(update.stress[..., 0], E * 1e-3) and np.all(update.stress[..., 1] == 7.0)
    assert np.array_equal(update.state[..., 0], [[110.5, 120.5, 130.5], [210.5, 220.5, 230.5]])
    case = po.point(recorder, [1.0, 1.0], "3d", [po.ramp(1, e11=1e-3, e22="hold", e33="hold", g12="hold", g13="hold", g23="hold")])
    driven = po.run(case, in_process=True).history
    assert driven["s11"][-1] == update.stress[0, 0, 0] and driven["s22"][-1] == 7.0 and driven["sdv1"][-1] == 110.0
    # what is given counts
    assert recorder.evaluate(0.0, strain[0], np.zeros(STATES), [1.0, 1.0], stress=np.zeros(6)).stress[0, 1] == 0.0


def test_uexternaldb_is_called_for_the_increments(recorder: po.Law) -> None:
    def calls(time: float, dtime: float) -> tuple[list[float], list[float], float]:
        state = recorder.evaluate(0.0, np.zeros((1, 6)), props=[1.0, 1.0], time=time, dtime=dtime).state[0]
        return state[1:8].tolist(), state[8:11].tolist(), state[GIVEN["kinc"]]

    # LOP 0 to 6; the end of the last increment
    assert calls(0.0, 1.0) == ([1, 1, 0, 0, 0, 1, 0], [0, 0, 0], 1)
    # iterations of the same increment, and one that was cut back
    assert calls(0.0, 1.0)[0] == [1, 1, 0, 0, 0, 1, 0]
    assert calls(0.0, 0.5) == ([1, 2, 0, 0, 0, 1, 0], [0, 0, 0], 1)
    assert calls(0.5, 0.25) == ([1, 3, 1, 0, 0, 1, 0], [0.5, 0.5, 1], 2)
    assert calls(0.75, 0.25) == ([1, 4, 2, 0, 0, 1, 0], [0.75, 0.25, 2], 3)


def test_an_analysis_begins_with_the_first_law_of_a_library(library: Path, tmp_path: Path) -> None:
    for in_process in (False, True):
        own = tmp_path / f"librecorder{in_process}.so"
        own.write_bytes(library.read_bytes())

        def begun(law: po.Law) -> float:
            return float(law.evaluate(0.0, np.zeros(6), props=[1.0, 1.0]).state[0, 1])

        one, other = (po.Law(own, nstatv=STATES, in_process=in_process) for _ in range(2))
        assert begun(one) == begun(other) == 1
        del one, other
        # its memory is gone with the laws: what UEXTERNALDB reads, it reads again
        assert begun(po.Law(own, nstatv=STATES, in_process=in_process)) == 1


def test_a_model_of_fenics_begins_as_the_library_says(recorder: po.Law) -> None:
    model = SmallStrainModel(recorder, [1.0, 1.0], "PLANE_STRAIN", coords=[[0.25, 0, 0], [0.5, 0, 0]])
    dimensions = model.history_dim
    assert dimensions is not None
    history = {name: np.zeros(2 * int(np.prod(size))) for name, size in dimensions.items()}
    stress, tangent = np.zeros(8), np.zeros(32)
    gradient = np.zeros((2, 2, 2))
    gradient[:, 0, 0] = 1e-3
    for number in (1, 2):
        model.evaluate(number - 1.0, 1.0, gradient.ravel(), stress, tangent, history)
        assert np.allclose(stress.reshape(2, 4)[:, :2], [[number * E * 1e-3, 7.0]] * 2)
        assert np.array_equal(history["state"].reshape(2, -1)[:, 0], [110.25, 210.5])
    assert history["state"].reshape(2, -1)[0, GIVEN["kinc"]] == 2


def test_points_are_given_what_a_umat_can_be_given(recorder: po.Law) -> None:
    shape = (2, 3)
    numbers = np.arange(6.0).reshape(shape)
    matrices = np.tile(np.eye(3), (2, 3, 1, 1))
    matrices[..., 0, 1] = 0.1 * numbers
    update = recorder.evaluate(
        0.0,
        np.full((*shape, 6), 1e-3),
        props=np.stack([numbers, np.full(shape, 2.0)], axis=-1),
        length=10.0 + numbers,
        temperature=20.0,
        dtemperature=numbers,
        fields=[1.0, 2.0],
        dfields=np.stack([numbers, 2 * numbers], axis=-1),
        dfgrd1=matrices,
        drot=matrices[1, 2],
        coords=np.stack([numbers, numbers, 3 * numbers], axis=-1),
        time=4.0,
        energies=np.broadcast_to([0.25, 0.0, 0.0], (*shape, 3)),
    )
    assert update.stress.shape == (2, 3, 6) and update.tangent.shape == (2, 3, 6, 6) and update.state.shape == (2, 3, STATES)
    expected = {
        "temp": 20.0, "dtemp": numbers, "predef": 2.0, "dpred": 2 * numbers, "coords": 3 * numbers, "drot": 0.5, "dfgrd0": 0.0,
        "dfgrd1": 0.1 * numbers, "noel": [[1] * 3, [2] * 3], "npt": [[1, 2, 3]] * 2, "time": 4.0, "celent": 10.0 + numbers,
        "props": numbers, "nlgeom": 1.0,
    }
    for name, values in expected.items():
        assert np.allclose(update.state[..., GIVEN[name]], values), name
    assert np.allclose(update.energies, np.stack([np.full(shape, 0.25 + 0.5 * E * 1e-6), numbers, 10.0 + numbers], axis=-1))
    # three things come out, as ever
    stress, _, _ = pickle.loads(pickle.dumps(update))
    assert np.array_equal(stress, update.stress)
    flat = recorder.evaluate(0.0, np.full((6, 6), 1e-3), props=[1.0, 1.0])
    assert np.array_equal(flat.state[:, GIVEN["noel"]], range(1, 7))
    with pytest.raises(po.PulloutError, match="energies=True"):
        flat.energies
    with pytest.raises(po.CaseError, match="dfgrd1: is needed"):
        recorder.evaluate(0.0, np.zeros(6), props=[1.0, 1.0], dfgrd0=np.eye(3))


@pytest.mark.parametrize("threads", [1, 3])
def test_parameters_of_each_point(threads: int) -> None:
    law = po.Law("linear_elastic")
    young = np.linspace(1e4, 4e4, 40)
    strain = np.zeros((40, 6))
    strain[:, 3] = 1e-3
    update = law.evaluate(0.0, strain, props=np.stack([young, np.full(40, 0.25)], axis=-1), threads=threads)
    assert np.allclose(update.stress[:, 3], young / 2.5 * 1e-3, rtol=1e-13)
    with pytest.raises(po.CaseError, match=r"props\[7\]: linear_elastic"):
        young[7] = -1.0
        law.evaluate(0.0, strain, props=np.stack([young, np.full(40, 0.25)], axis=-1))


def test_one_number_is_no_row_of_components() -> None:
    law = po.Law("linear_elastic")
    for wrong in (1e-3, np.full((4, 1), 1e-3), np.full(1, 1e-3), np.full((4, 3), 1e-3), np.nan):
        with pytest.raises(po.CaseError, match="strain: (has the shape|is one number)"):
            law.evaluate(np.zeros((4, 6)), wrong)
    for name in ("stress", "state"):
        with pytest.raises(po.CaseError, match=f"{name}: has the shape|{name}: is one number"):
            po.Law("concrete_damage").evaluate(0.0, np.zeros((4, 6)), **{name: np.ones((4, 1))})
    with pytest.raises(po.CaseError, match="length: has the shape"):
        law.evaluate(0.0, np.zeros((4, 6)), length=np.ones(3))


def test_what_would_lose_something_on_the_way_is_refused() -> None:
    law = po.Law("linear_elastic")
    strain = np.full((2, 6), 1e-3)
    for wrong in (strain + 1j, strain.astype(str), strain.astype(object) + 1j, [[1.0], [1.0, 2.0]]):
        with pytest.raises(po.CaseError, match="dstrain: is no array of real numbers"):
            law.evaluate(0.0, wrong)
    with pytest.raises(po.CaseError, match="props: is no array of real numbers"):
        law.evaluate(0.0, strain, props=np.array([3e4 + 1j, 0.2]))
    for threads in (2.5, "2", None, 0, -1):
        for call in (law.evaluate, po.run):
            with pytest.raises(po.CaseError, match="threads: is"):
                call(*((0.0, strain) if call is not po.run else ({},)), threads=threads)
    with pytest.raises(po.CaseError, match="nstatv: is 2.5"):
        po.Law("linear_elastic", nstatv=2.5)  # type: ignore[arg-type]


def test_input_that_no_increment_is_right_for_is_an_error_of_input() -> None:
    law = po.Law("concrete_damage")
    strain = np.full((3, 6), 1e-5)
    for name in ("strain", "dstrain", "stress", "state", "length"):
        values = np.ones(3) if name == "length" else np.zeros((3, law.nstatv if name == "state" else 6))
        values[2:] = np.nan
        with pytest.raises(po.CaseError, match=rf"{name}\[2\].*: is NaN, not a finite number") as caught:
            law.evaluate(**{"strain": 0.0, "dstrain": strain, name: values})
        assert not isinstance(caught.value, po.RunFailed)
        # where a number stands for what failed, those points have it
        update = law.evaluate(**{"strain": 0.0, "dstrain": strain, name: values, "on_failure": "nan"})
        assert np.isnan(update.stress[2]).all() and np.isfinite(update.stress[:2]).all()
    for props in (np.full(len(law.parameters), -1.0), np.zeros(2), np.array([]), np.full(len(law.parameters), np.nan)):
        for on_failure in ("raise", "nan"):
            with pytest.raises(po.CaseError, match="props"):
                law.evaluate(0.0, strain, props=props, on_failure=on_failure)
    # a band in which the curve would snap back
    with pytest.raises(po.CaseError, match=r"length\[0\]"):
        law.evaluate(0.0, strain, props={"G_f": 0.1}, length=1e6)


def test_what_is_refused_leaves_out_as_it_was(umats: dict[str, Path]) -> None:
    law = po.Law(umats["refuses"], nstatv=1)
    stress, state = np.full((3, 6), 3.0), np.full((3, 1), 5.0)
    strain = np.zeros((3, 6))
    strain[1, 0] = 2.0

    def unchanged() -> bool:
        return bool(np.all(stress == 3.0) and np.all(state == 5.0))

    for wrong in ({"threads": 0}, {"length": np.ones(2)}, {"props": [np.nan]}, {"out": (stress, state, np.zeros((3, 5, 5)))}):
        with pytest.raises(po.CaseError):
            law.evaluate(**{"strain": 0.0, "dstrain": strain, "props": [E], "out": (stress, state), **wrong})
        assert unchanged(), wrong
    # also that of points that went well: the caller tries a smaller increment from the same start
    with pytest.raises(po.UpdateFailed):
        law.evaluate(0.0, strain, state, [E], stress=stress, out=(stress, state))
    assert unchanged()
    law.evaluate(0.0, strain / 4, state, [E], stress=stress, out=(stress, state))
    assert np.all(state == 6.0) and stress[1, 0] == 3.0 + E * 0.5


#: knows six components only
SOLID = """
@umat 6
  ddsdde = 0.d0
  do i = 1, 6
    ddsdde(i,i) = props(1)
  end do
  ddsdde(1:3,1:3) = ddsdde(1:3,1:3) + props(2)
  stress = stress + matmul(ddsdde, dstran)
end subroutine
"""


def test_a_umat_that_knows_six_components_is_called_with_six(tmp_path: Path, compile_fortran: Compile) -> None:
    library = compile_fortran(SOLID, tmp_path / "solid.f90")
    law = po.Law(library, nstatv=0)
    strain = np.array([[1e-3, -4e-4, 0.0, 6e-4]])
    with pytest.warns(UserWarning, match="NTENS = 6"):
        update = law.evaluate(0.0, strain, props=[100.0, 50.0], mode="plane_strain")
    assert np.allclose(update.stress, [[0.13, -0.01, 0.03, 0.06]], rtol=1e-12)
    with pytest.raises(po.CaseError, match="mode: "):
        law.evaluate(0.0, strain[:, :3], props=[100.0, 50.0], mode="plane_stress")


def children() -> set[str]:
    listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(os.getpid())], capture_output=True, text=True).stdout.split()
    # it lists itself
    return {pid for pid in listed if Path(f"/proc/{pid}").exists()}


def test_a_library_has_one_process_however_often_a_law_is_unpickled(umats: dict[str, Path], tmp_path: Path) -> None:
    library = tmp_path / "libmine.so"
    library.write_bytes(umats["refuses"].read_bytes())
    before = children()
    law = po.Law(library, nstatv=1)
    strain = np.random.default_rng(1).normal(scale=1e-4, size=(500, 6))
    expected = law.evaluate(0.0, strain, props=[E]).stress
    assert len(children() - before) == 1
    kept = pickle.dumps(law)
    del law

    def work(_: int) -> bool:
        return np.array_equal(pickle.loads(kept).evaluate(0.0, strain, props=[E]).stress, expected)

    with ThreadPoolExecutor(8) as threads:
        assert all(threads.map(work, range(32)))
    assert len(children() - before) == 1
    # only what is called needs one
    other = tmp_path / "libother.so"
    other.write_bytes(umats["refuses"].read_bytes())
    kept = pickle.dumps(po.Law(other, nstatv=1))
    script = f"import os, pickle\nlaw = pickle.loads({kept!r})\nos.execvp('ps', ['ps', '-o', 'comm=', '--ppid', str(os.getpid())])"
    listed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout
    assert listed.strip() == ""


def test_a_forked_process_has_a_helper_of_its_own(umats: dict[str, Path]) -> None:
    law = po.Law(umats["refuses"], nstatv=1)
    strain = np.full((1, 6), 1e-4)
    law.evaluate(0.0, strain, props=[E])
    child = os.fork()
    if child == 0:
        os._exit(0 if law.evaluate(0.0, strain, props=[E]).stress[0, 0] == E * 1e-4 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert law.evaluate(0.0, strain, props=[E]).stress[0, 0] == E * 1e-4
