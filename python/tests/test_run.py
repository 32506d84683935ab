"""Runs: curves, errors, progress, Ctrl-C."""

from __future__ import annotations

import asyncio
import functools
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import pullout_fe as po

Compile = Callable[[str, Path], Path]

CRUSHING = {
    "kind": "point",
    "title": "Uniaxial compression, then unloading",
    "material": {"plugin": "concrete_damage", "props": {"E": 31800.0, "nu": 0.18, "b_c": 0.3}},
    "mode": "3d",
    "steps": [{"increments": 100, "target": {"e11": -0.003}}, {"increments": 50, "target": {"s11": 0.0}}],
}

FIBRE = Path(__file__).resolve().parents[2] / "cases/chapter-6/6.14-plane.json"

#: takes long
LONG = {**CRUSHING, "steps": [{"increments": 3_000_000, "target": {"e11": -0.003}}]}


def test_a_run_gives_columns_that_are_not_copied() -> None:
    run = po.run(CRUSHING)
    assert run.status == "done" and run.failure is None and run.replay is None
    stress = run.history["s11"]
    assert stress is run.history["s11"] and not stress.flags.writeable and stress.shape == (151,)
    # the array's memory is the engine's, handed over
    assert not stress.flags.owndata
    assert run.history.units["s11"] == "MPa"
    assert run.peak("s11").min == stress.min() and run.peak("s11").min_at is not None
    assert list(run.history)[:2] == ["step", "increment"]
    with pytest.raises(KeyError, match="s11"):
        run.history["sigma"]
    assert "<th>s11 (MPa)</th>" in run._repr_html_() and "150 increments" in repr(run)


def test_a_run_is_what_the_program_makes_of_it(tmp_path: Path) -> None:
    program = po.program()
    assert program is not None
    file = tmp_path / "case.json"
    file.write_text(json.dumps(CRUSHING))
    subprocess.run([program, "run", "--quiet", "--out", tmp_path / "out", file], check=True)
    written = np.genfromtxt(tmp_path / "out/history.csv", delimiter=",", names=True)
    run = po.run(file)
    for name in run.history:
        assert np.array_equal(run.history[name], written[name]), name
    assert not list(Path(".").glob("out"))


def test_cases_are_made_and_changed() -> None:
    case = po.Case(CRUSHING)
    softer = case.with_({"material.props.E": 2e4, "steps[0].increments": np.int64(10)})
    assert softer.document["material"]["props"]["E"] == 2e4 and case.document["material"]["props"]["E"] == 31800.0
    assert po.run(softer).history.rows == 61
    assert po.run(pickle.loads(pickle.dumps(softer))).history.rows == 61
    made = po.point("linear_elastic", {"E": 10.0, "nu": 0.0}, "3d", [po.ramp(4, e11=1e-3)])
    assert np.allclose(po.run(made).history["s11"], 1e-2 * np.arange(5) / 4)
    assert "steps" in po.schema()["$defs"]["PointCase"]["properties"] if "$defs" in po.schema() else True


def test_everything_that_is_wrong_is_reported_at_once(tmp_path: Path) -> None:
    wrong = {**CRUSHING, "mode": "4d", "steps": []}
    for act in (po.Case(wrong).check, lambda: po.run(wrong)):
        with pytest.raises(po.CaseError) as caught:
            act()
        assert {place for place, _ in caught.value.problems} == {"$.mode", "$.steps"}
        assert isinstance(caught.value, ValueError) and pickle.loads(pickle.dumps(caught.value)).problems
    with pytest.raises(po.PluginError, match="no_law"):
        po.run(po.Case(CRUSHING).with_({"material.plugin": "no_law"}))
    with pytest.raises(po.CaseError, match="cannot be read"):
        po.run(tmp_path / "nothing.json")
    with pytest.raises(po.CaseError, match="has no place in a case"):
        po.Case({"kind": object()})
    for mode in (float("nan"), "\ud800"):
        with pytest.raises(po.CaseError):
            po.run({**CRUSHING, "mode": mode})


def test_a_failure_has_what_was_reached_and_a_case_that_repeats_it() -> None:
    # a stress that cannot be reached
    wrong = po.Case(CRUSHING).with_({"steps": [{"increments": 20, "target": {"s11": -1e4}}]})
    with pytest.raises(po.RunFailed) as caught:
        po.run(wrong)
    run = caught.value.run
    assert run is not None and run.status == "failed" and run.failure is not None and run.failure.kind == "failed"
    assert 0 < run.history.rows < 20 and run.failure.increment == run.history.rows
    assert caught.value.replay is not None
    with pytest.raises(po.RunFailed):
        po.run(caught.value.replay)
    assert po.run(wrong, on_failure="return").status == "failed"


@pytest.mark.parametrize("is_foreign", [False, True])
def test_a_failure_has_the_state_in_which_an_increment_was_given_up(is_foreign: bool, umats: dict[str, Path]) -> None:
    if is_foreign:
        # asks for smaller increments where the strain passes 1, from 0.9: pieces lead up to it
        case = umat(umats["refuses"], 3.6)
    else:
        case = po.Case(CRUSHING).with_({"steps": [{"increments": 1, "target": {"s11": -40.0}}]})
    with pytest.raises(po.RunFailed) as caught:
        po.run(case)
    run = caught.value.run
    assert run is not None and run.failure is not None
    reached = run.failure.reached
    if is_foreign:
        assert 0.99 < reached["e11"] <= 1.0 and reached["s11"] == pytest.approx(3e4 * reached["e11"])
        assert run.history["e11"][-1] == pytest.approx(0.9)
    else:
        # the peak of the curve that the driver makes under control of the strain
        peak = po.run(CRUSHING).peak("s11").min
        assert reached["s11"] == pytest.approx(peak, rel=2e-2) and run.history["s11"][-1] == 0.0


def umat(library: Path, end: float) -> po.Case:
    material = {"plugin": str(library), "props": [3e4], "nstatv": 1, "call_time_limit_s": 1.0}
    steps = [{"increments": 4, "target": {"e11": end}}]
    return po.Case({"kind": "point", "material": material, "mode": "3d", "steps": steps})


def test_a_umat_that_stops_or_hangs_does_not_end_python(umats: dict[str, Path]) -> None:
    assert po.run(umat(umats["stops"], 0.5)).history["s11"][-1] == 1.5e4
    assert str(umats["stops"]) not in Path("/proc/self/maps").read_text()
    for name, error in (("stops", po.PluginCrashed), ("hangs", po.TimeLimit)):
        with pytest.raises(error) as caught:
            po.run(umat(umats[name], 2.0))
        run = caught.value.run
        assert run is not None and run.failure is not None and (run.failure.step, run.failure.increment) == (1, 3)
        assert run.history["e11"][-1] == 1.0 and caught.value.replay is not None
        # the folder of the run is gone
        assert "replay case" not in str(caught.value) and "replay case" not in run.summary["message"]
    with pytest.raises(po.PluginCrashed):
        po.run(caught.value.replay.with_({"material.plugin": str(umats["stops"])}))


@pytest.mark.parametrize("is_foreign", [False, True])
def test_progress_is_heard_by_the_calling_thread(is_foreign: bool, umats: dict[str, Path]) -> None:
    heard: list[tuple[float, dict[str, float], int]] = []
    start = time.monotonic()
    case = po.Case(LONG).with_({"steps[0].increments": 100_000})
    if is_foreign:
        case = umat(umats["stops"], -0.5).with_({"steps[0].increments": 200_000})
    po.run(case, progress=lambda part, row: heard.append((part, row, threading.get_ident())))
    took = time.monotonic() - start
    assert heard and {ident for _, _, ident in heard} == {threading.get_ident()}
    assert len(heard) <= 2 + 20 * took
    parts = [part for part, _, _ in heard]
    assert parts == sorted(parts) and 0.0 < parts[0] <= parts[-1] <= 1.0
    assert "s11" in heard[-1][1] and heard[-1][1]["e11"] < 0.0


@pytest.mark.parametrize("is_foreign", [False, True])
def test_an_error_in_progress_ends_the_run(is_foreign: bool, umats: dict[str, Path]) -> None:
    long = umat(umats["stops"], -0.5).with_({"steps[0].increments": 9_000_000}) if is_foreign else LONG

    heard: list[float] = []

    def hear(part: float, row: dict[str, float]) -> None:
        heard.append(part)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        po.run(long, progress=hear)
    assert len(heard) == 1 and heard[0] < 0.5


class Begun:
    """For ``progress``: calls ``act`` in another thread when the run has begun, however late a busy machine begins it."""

    def __init__(self, act: Callable[[], object]) -> None:
        self.act, self.parts = act, list[float]()

    def __call__(self, part: float, row: dict[str, float]) -> None:
        self.parts.append(part)
        if len(self.parts) == 1:
            threading.Thread(target=self.act).start()


def when_written(out: Path, act: Callable[[], object]) -> None:
    """Calls ``act`` in another thread when a run with rows is in the folder."""

    def wait() -> None:
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            if (out / "history.csv").is_file() and (out / "history.csv").read_bytes().count(b"\n") > 12:
                act()
                return
            time.sleep(0.01)

    threading.Thread(target=wait, daemon=True).start()


def press_ctrl_c() -> None:
    os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.parametrize("case", [LONG, FIBRE], ids=["point", "specimen"])
def test_ctrl_c_ends_a_run_at_once(case: Any) -> None:
    begun = Begun(press_ctrl_c)
    with pytest.raises(KeyboardInterrupt):
        po.run(case, progress=begun)
    assert 0.0 < begun.parts[-1] < 0.9


def test_ctrl_c_leaves_the_results_up_to_there(tmp_path: Path) -> None:
    when_written(tmp_path, press_ctrl_c)
    with pytest.raises(KeyboardInterrupt):
        po.run({**LONG, "output": {"plots": False}}, out=tmp_path)
    assert po.read(tmp_path).status == "interrupted"


def test_runs_in_threads() -> None:
    expected = po.run(CRUSHING).history["s11"]
    found: list[np.ndarray] = []
    threads = [threading.Thread(target=lambda: found.append(po.run(CRUSHING).history["s11"])) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and all(np.array_equal(curve, expected) for curve in found)


def test_the_program_is_there() -> None:
    program = Path(sys.prefix) / "bin/pullout"
    listed = subprocess.run([program, "plugin", "list"], check=True, capture_output=True, text=True, env={}).stdout
    assert "concrete_damage" in listed


def test_other_tables() -> None:
    history = po.run(CRUSHING).history
    pandas = pytest.importorskip("pandas")
    frame = history.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame["s11"].iloc[-1] == history["s11"][-1]
    # what is in it is its own
    frame.loc[0, "s11"] = 1.0
    frame["s11"] += 1.0
    assert history["s11"][0] == 0.0
    direct = pandas.DataFrame(history)
    assert direct.shape == (history.rows, len(history)) and list(direct) == list(history)
    direct.iloc[0, 0] = 7.0
    assert history["step"][0] == 0.0


def test_a_history_is_a_dictionary_that_stays_as_it_is() -> None:
    history = po.run(CRUSHING).history
    assert isinstance(history, dict) and history == po.run(CRUSHING).history and not history != po.run(CRUSHING).history
    for act in (lambda: history.update(x=1), lambda: history.pop("s11"), lambda: history.__setitem__("x", 1), history.clear):
        with pytest.raises(TypeError, match="cannot be changed"):
            act()
    assert history.get("sigma") is None and "sigma" not in history
    own = dict(history)
    own["s11"] = -own["s11"]
    assert own["s11"].max() > 0 and history["s11"].min() < 0


def test_xarray_has_columns_and_units() -> None:
    pytest.importorskip("xarray")
    history = po.run(CRUSHING).history
    made = history.to_xarray()
    assert np.array_equal(made["s11"], history["s11"]) and made["s11"].attrs["units"] == "MPa" and made["s11"].dims == ("row",)


def test_a_plot_has_the_curve() -> None:
    pytest.importorskip("matplotlib").use("agg")
    run = po.run(CRUSHING)
    axes = run.plot("s11", "e11", color="k")
    assert np.array_equal(axes.lines[0].get_xydata(), np.array([run.history["e11"], run.history["s11"]]).T)
    assert axes.get_ylabel() == "s11 (MPa)" and axes.get_xlabel() == "e11"
    assert run.plot("e11", ax=axes) is axes and axes.get_xlabel() == "time (s)"
    with pytest.raises(KeyError, match="sigma"):
        run.plot("sigma")


@pytest.mark.slow
def test_a_fibre_with_its_fields(tmp_path: Path) -> None:
    case = po.Case(FIBRE).with_({"steps.0.slip": 0.1})
    run = po.run(case.with_({"output.vtu": True, "output.plots": False}), out=tmp_path / "out")
    memory = po.run(case)
    assert run.status == "done" and run.history.units["load"] == "N"
    assert np.array_equal(run.history["load"], memory.history["load"])
    assert run.peak("load").max == memory.peak("load").max > 0.0
    mesh = run.mesh()
    assert repr(mesh).startswith(f"<Mesh at time 1: {len(mesh.points)} nodes") and len(repr(mesh)) < 1000
    assert mesh.points.shape == (len(mesh.point_data["node"]), 3) and len(mesh.cells()) == len(mesh.types)
    assert run.fields("displacement").shape == mesh.points.shape
    assert len(run.series.times) > 1 and run.series.contact().point_data["pressure"].shape[0] > 0
    assert po.read(tmp_path / "out").peak("load") == run.peak("load")
    with pytest.raises(po.PulloutError, match="no results"):
        po.read(tmp_path)
    with pytest.raises(po.PulloutError, match="fields=True"):
        memory.mesh()


@pytest.mark.slow
def test_fibres_across_a_crack(tmp_path: Path) -> None:
    case = FIBRE.parents[1] / "bridging/beam.json"
    run, kept = po.run(case), po.run(case, out=tmp_path / "out")
    assert list(run.history) == list(kept.history) and {"w", "sigma", "cmod"} <= set(run.history)
    assert all(np.array_equal(run.history[name], kept.history[name], equal_nan=True) for name in run.history)
    with pytest.raises(KeyError, match="sigma_peak"):
        run.peak("sigma")
    assert run.summary["bridging"]["sigma_peak"] >= run.history["sigma"].max()


def test_a_case_holds_what_its_file_had(tmp_path: Path) -> None:
    file = tmp_path / "bar.json"

    def write(young: float) -> None:
        props = {"E": young, "nu": 0.2}
        material = {"plugin": "linear_elastic", "props": props}
        file.write_text(json.dumps({"kind": "point", "material": material, "mode": "3d", "steps": [po.ramp(2, e11=1e-3)]}))

    write(1000.0)
    case = po.Case(file)
    pickled = pickle.dumps(case)
    run = po.run(case)
    stress = run.history["s11"]
    assert run.summary["title"] == "bar"
    write(7000.0)
    assert run.case is not None and run.case.document["material"]["props"]["E"] == 1000.0
    for later in (case, pickle.loads(pickled), case.with_({"title": "bar"})):
        assert po.run(later).history == run.history
    assert np.array_equal(po.run(case, out=tmp_path / "out").history["s11"], stress)
    assert po.read(tmp_path / "out").summary["title"] == "bar"
    assert po.run(file).history != run.history and po.Case(file) != case
    file.unlink()
    assert po.run(case).history == run.history
    file.write_text('{"kind": "point", "kind": "point"}')
    with pytest.raises(po.CaseError, match="kind"):
        po.Case(file)


def test_a_case_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    broken = tmp_path / "broken.json"
    broken.write_text("{")
    for file in (broken, tmp_path / "missing.json"):
        with pytest.raises(po.CaseError, match=file.name):
            po.run(file)
    with pytest.raises(po.CaseError, match="on_failure: is 'raise' or 'return'"):
        po.run(CRUSHING, on_failure="ignore")


def test_arrays_are_a_path(tmp_path: Path) -> None:
    time = np.cumsum(np.random.default_rng(3).uniform(0.1, 1.0, 50))
    strain = -2e-3 * np.sin(np.linspace(0, 3, 50))
    np.savetxt(tmp_path / "path.csv", np.stack([strain, time, 0.1 * strain], axis=-1), "%.17g", ",", header="e11,time,s22", comments="")
    arrays = po.point("concrete_damage", {"E": 31800.0}, "3d", [po.table(time, e11=strain, s22=0.1 * strain)])
    file = po.Case({**arrays.document, "steps": [{"table": "path.csv"}]}, folder=tmp_path)
    assert po.run(arrays).history == po.run(file).history and po.run(arrays).history.rows == 51
    bond = {"kind": "interface", "material": {"plugin": "bond_slip", "props": {"law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4}}}
    made = po.run({**bond, "steps": [po.table(slip=[0.001, 0.002])]}).history
    assert np.array_equal(made["slip"], [0.0, 0.001, 0.002])
    for wrong, message in (({"e11": [1e-3], "s22": [0.0, 0.0]}, "the column 's22' has 2 values"), ({"e12": [0.0]}, "no component is called"), ({}, "no rows")):
        with pytest.raises(po.CaseError, match=message) as caught:
            po.run(arrays.with_({"steps": [{"table": wrong}]}))
        assert caught.value.problems[0][0] == "$.steps[0].table"
    with pytest.raises(po.CaseError, match="e11: has the shape"):
        po.table(e11=np.zeros((2, 2)))


def test_what_is_no_number_is_named() -> None:
    for number in (np.nan, np.inf):
        with pytest.raises(po.CaseError, match="material.props.E: is (nan|inf)"):
            po.Case(CRUSHING).with_({"material.props.E": number})
        with pytest.raises(po.CaseError) as caught:
            po.point("linear_elastic", {"E": 1.0, "nu": number}, "3d", [])
        assert caught.value.problems[0][0] == "$.material.props.nu"


def test_a_run_is_pickled_with_its_increments() -> None:
    run = pickle.loads(pickle.dumps(po.run(CRUSHING, record=True)))
    assert po.run(CRUSHING, along=run).history == run.history
    with pytest.raises(ValueError, match="read-only"):
        run.history["s11"][0] = 1.0


PRINTING = """
@umat ntens
  ddsdde = 0.d0
  do i = 1, ntens
    ddsdde(i,i) = props(1)
    stress(i) = stress(i) + props(1)*dstran(i)
  end do
  statev(1) = statev(1) + 1
  if (dstran(1) > 0) write (6, *) "increment", kinc
end subroutine
"""


def test_what_a_umat_prints_is_kept(tmp_path: Path, compile_fortran: Compile, capfd: pytest.CaptureFixture[str]) -> None:
    case = umat(compile_fortran(PRINTING, tmp_path / "prints.f90"), 0.5)
    for run in (po.run(case), po.run(case, out=tmp_path / "out"), po.read(tmp_path / "out")):
        assert [int(line.split()[1]) for line in run.prints.splitlines()] == [1, 2, 3, 4]
    assert capfd.readouterr().out == "" and po.run(CRUSHING).prints == ""


def test_a_source_is_compiled(tmp_path: Path, compile_fortran: Compile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    library = compile_fortran(PRINTING, tmp_path / "prints.f90")
    source = library.with_name("prints.f90")
    assert po.run(umat(source, 0.5)).history == po.run(umat(library, 0.5)).history
    assert po.Law(source, nstatv=1).evaluate(0.0, [[0.1, 0, 0, 0, 0, 0]], props=[3e4]).stress[0, 0] == pytest.approx(3e3)
    source.write_text("      this is no fortran")
    with pytest.raises(po.PluginError, match="prints.f90"):
        po.run(umat(source, 0.5))


@pytest.mark.parametrize("is_foreign", [False, True])
def test_another_thread_stops_a_run(is_foreign: bool, umats: dict[str, Path], tmp_path: Path) -> None:
    long = umat(umats["stops"], -0.5).with_({"steps[0].increments": 9_000_000}) if is_foreign else LONG
    stop = po.Stop()
    with pytest.raises(po.Stopped) as caught:
        po.run(long, stop=stop, progress=Begun(stop.set))
    runs = [caught.value.run]
    stop = po.Stop()
    when_written(tmp_path / "out", stop.set)
    with pytest.raises(po.Stopped) as caught:
        po.run({**po.Case(long).document, "output": {"plots": False}}, stop=stop, out=tmp_path / "out")
    runs.append(caught.value.run)
    stop = po.Stop()
    runs.append(po.run(long, stop=stop, progress=Begun(stop.set), on_failure="return"))
    for run in runs:
        assert run is not None and run.status == "interrupted" and 10 < run.history.rows < 9_000_000


@pytest.mark.parametrize("is_foreign", [False, True])
def test_a_run_that_is_stopped_before_it_starts_leaves_the_results_of_the_run_before(is_foreign: bool, umats: dict[str, Path], tmp_path: Path) -> None:
    case = po.Case({**po.Case(umat(umats["stops"], 0.5)).document, "output": {"plots": False}}) if is_foreign else po.Case(CRUSHING)
    po.run(case, out=tmp_path / "out")
    before = (tmp_path / "out" / "summary.json").read_bytes()
    stop = po.Stop()
    stop.set()
    for out in (None, tmp_path / "none", tmp_path / "out"):
        with pytest.raises(po.Stopped) as caught:
            po.run(case, stop=stop, out=out)
        assert caught.value.run is None or caught.value.run.status == "interrupted"
    assert (tmp_path / "out" / "summary.json").read_bytes() == before and po.read(tmp_path / "out").status == "done"


def test_a_task_of_asyncio_stops_its_run() -> None:
    async def main() -> str:
        stop, begun = po.Stop(), asyncio.Event()
        ready = Begun(functools.partial(asyncio.get_running_loop().call_soon_threadsafe, begun.set))
        task = asyncio.create_task(asyncio.to_thread(po.run, LONG, stop=stop, progress=ready, on_failure="return"))
        await begun.wait()
        stop.set()
        return (await task).status

    assert asyncio.run(main()) == "interrupted"


def test_a_folder_for_temporary_files_that_cannot_be_written_is_named(umats: dict[str, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", "/proc/sys")
    with pytest.raises(po.PulloutError, match="/proc/sys; TMPDIR names another one") as caught:
        po.run(umat(umats["stops"], 0.5))
    assert not isinstance(caught.value, po.CaseError)


@pytest.mark.slow
def test_a_run_in_memory_has_its_fields() -> None:
    case = po.Case(FIBRE).with_({"steps.0.slip": 0.02, "output.plots": False})
    run = po.run(case, fields=True)
    mesh = run.mesh()
    assert len(run.series.times) > 1 and mesh.points.shape == (len(mesh.point_data["node"]), 3)
    # the far end is pulled
    assert np.abs(run.fields("displacement")).max() == pytest.approx(0.02) and run.fields("von_mises").max() > 0.0
    place = Path(run._fields.name)  # type: ignore[union-attr]
    assert place.is_dir()
    del run
    assert not place.exists()
    with pytest.raises(po.CaseError, match="fields: are of specimens"):
        po.run(CRUSHING, fields=True)
