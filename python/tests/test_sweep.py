"""Sweeps: the same rows by every executor, and ends of processes that have names."""

from __future__ import annotations

import json
import os
import signal
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import pullout_fe as po
from pullout_fe import _core

BASE = po.point("concrete_damage", {"E": 31800.0}, "3d", [po.ramp(20, e11=2e-3)])
DESIGN = {"material.props.E": [28000.0, 30000.0, 32000.0], "material.props.nu": [0.15, 0.2]}


def test_rows_are_those_of_single_runs(tmp_path: Path) -> None:
    made = po.sweep(BASE, DESIGN, out=tmp_path / "sweep", quantities=["peak", "work"], workers=2)
    table = made.table
    assert made.status() == {"runs": 6, "left": 0, "done": 6}
    # words, also where none are
    assert table["message"].tolist() == [""] * 6
    assert sorted(set(table["par.material.props.E"])) == DESIGN["material.props.E"]
    for modulus, ratio, peak in zip(table["par.material.props.E"], table["par.material.props.nu"], table["q.peak"]):
        alone = po.run(BASE.with_({"material.props.E": modulus, "material.props.nu": ratio}))
        assert peak == alone.history["s11"].max()


def test_a_table_is_read_when_something_is_new_and_has_types(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reads: list[Path] = []
    collect = _core.collect

    def counted(folder: Path) -> object:
        reads.append(folder)
        return collect(folder)

    monkeypatch.setattr(_core, "collect", counted)
    design = {"material.props.E": np.linspace(2e4, 3e4, 2), "steps[0].increments": [10, 20]}
    made = po.sweep(BASE, design, out=tmp_path / "sweep", quantities=["peak"], executor=None, curves=["s11"])
    left = made.table
    assert left["increments"].dtype == float and np.isnan(left["increments"]).all() and left["run"].dtype == np.int64
    made.work(workers=1)
    reads.clear()
    table = made.table
    whole = {name for name, column in table.items() if column.dtype == np.int64}
    assert whole == {"run", "par.steps.0.increments", "increments", "iterations", "cutbacks", "attempt"}
    assert table["par.material.props.E"].dtype == float and table["q.peak"].dtype == float and table["status"].dtype == object
    assert np.array_equal(table["increments"], table["par.steps.0.increments"]) and not any(name.startswith("curve") for name in table)
    # what is done with it stays there
    table["q.peak"][:] = 0.0
    del table["run"]
    assert made.table["q.peak"].min() > 0.0 and "run" in made.table and made.curves("s11").shape == (4, 21)
    assert len(reads) == 1
    po.sweep(BASE, {**design, "material.props.E": [1e4]}, out=tmp_path / "sweep", quantities=["peak"], curves=["s11"])
    assert made.table["par.material.props.E"].tolist() == [1e4, 1e4] and len(reads) == 2


def test_a_plan_refuses_what_is_wrong_with_it(tmp_path: Path) -> None:
    with pytest.raises(po.CaseError, match=r"\$\.points"):
        po.sweep(BASE, [], out=tmp_path / "sweep")
    for wrong in ({"material.props.E": 3e4}, {"material.props.E": "3e4"}, np.array([[3e4]]), 1):
        with pytest.raises(po.CaseError, match="design: is a dictionary of lists"):
            po.sweep(BASE, wrong, out=tmp_path / "sweep")
    with pytest.raises(po.CaseError, match="workers: is 1 or more"):
        po.sweep(BASE, DESIGN, out=tmp_path / "sweep", workers=0)
    with pytest.raises(po.CaseError, match="no column 's1'"):
        po.sweep(BASE, DESIGN, out=tmp_path / "sweep", quantities={"q": {"column": "s1"}})


def test_a_plan_names_the_file_of_its_case(tmp_path: Path) -> None:
    file = tmp_path / "bar.json"
    file.write_text(json.dumps(BASE.document))
    case = po.Case(file)
    with pytest.raises(po.CaseError, match="bar.json: .*props.EE"):
        po.sweep(case, {"material.props.EE": [1.0]}, out=tmp_path / "sweep")
    # what is written into it from now on changes nothing
    file.write_text("{}")
    assert po.sweep(case, {"material.props.E": [3e4]}, out=tmp_path / "sweep").status()["done"] == 1


def test_a_sweep_is_planned_and_worked_off_later(tmp_path: Path) -> None:
    made = po.sweep(BASE, DESIGN, out=tmp_path / "sweep", executor=None)
    assert made.status() == {"runs": 6, "left": 6}
    made.work(workers=2)
    assert made.status() == {"runs": 6, "left": 0, "done": 6}


@pytest.mark.slow
def test_executors_give_the_same_rows(tmp_path: Path) -> None:
    points = [{"material.props.E": modulus} for modulus in np.linspace(2e4, 4e4, 11)]
    tables = []
    with ThreadPoolExecutor(2) as threads:
        for name, executor in [("processes", "processes"), ("threads", "threads"), ("own", threads)]:
            table = po.sweep(BASE, points, out=tmp_path / name, quantities=["peak"], executor=executor, workers=2).table
            tables.append({key: table[key].tolist() for key in ("run", "key", "status", "q.peak")})
    assert tables[0] == tables[1] == tables[2]


def test_what_is_there_is_not_run_again(tmp_path: Path) -> None:
    first = po.sweep(BASE, {"material.props.E": [3e4]}, out=tmp_path / "sweep").table
    more = po.sweep(BASE, {"material.props.E": [3e4, 3.1e4]}, out=tmp_path / "sweep").table
    # not even what it cost has changed
    assert [first[name][0] for name in ("key", "wall_s")] == [more[name][0] for name in ("key", "wall_s")]
    assert len(more["key"]) == 2


def test_a_library_that_ends_its_process_costs_one_run(umats: dict[str, Path], tmp_path: Path) -> None:
    # stretched beyond 1 it stops
    stops = {"plugin": str(umats["stops"]), "props": [200.0], "nstatv": 1}
    case = po.Case({"kind": "point", "material": stops, "steps": [{"increments": 4, "target": {"e11": 0.1}}]})
    points = [{"steps.0.target.e11": end} for end in (0.1, 2.0, 0.2)]
    made = po.sweep(case, points, out=tmp_path / "sweep", quantities=["peak"], workers=1)
    assert made.table["status"].tolist() == ["done", "crashed", "done"]
    threads = po.sweep(case, points, out=tmp_path / "threads", quantities=["peak"], executor="threads", workers=1)
    assert threads.table["status"].tolist() == ["done", "crashed", "done"]
    assert made.status() == {"runs": 3, "left": 0, "done": 2, "crashed": 1}


def test_errors_name_no_file_that_nobody_wrote(tmp_path: Path) -> None:
    missing = po.point("linear_elastic", {"E": 3e4, "nu": 0.2}, "3d", [{"table": "none.csv"}])
    for case, design in [(BASE, {"material.props.EE": [1.0]}), (missing, {"material.props.E": [3e4]})]:
        with pytest.raises(po.CaseError) as caught:
            po.sweep(case, design, out=tmp_path / "sweep")
        assert str(caught.value).startswith("$.") and "/tmp" not in str(caught.value), caught.value
    failed = po.sweep(BASE, {"material.props.nu": [0.2, 0.7]}, out=tmp_path / "failed").table
    assert failed["message"][1].startswith("$.material.props.nu: nu = 0.7"), failed["message"]
    with pytest.raises(po.CaseError, match=r"the path steps\.0\.increments is given twice"):
        po.sweep(BASE, [{"steps[0].increments": 5, "steps.0.increments": 7}], out=tmp_path / "sweep")
    with pytest.raises(po.CaseError, match="is no folder"):
        po.sweep(po.Case(BASE.document, folder=tmp_path / "none"), DESIGN, out=tmp_path / "sweep")


def test_a_design_that_grows_keeps_the_place_of_each_value(tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    po.sweep(BASE, {"material.props.nu": [0.1, 0.2]}, out=folder, quantities=["peak"])
    design = {"steps[0].increments": [20, 30], "material.props.nu": [0.1, 0.2]}
    grown = po.sweep(BASE, design, out=folder, quantities=["peak"], executor=None)
    assert grown.table["status"].tolist() == ["done", "done", "left", "left"]
    assert grown.table["par.steps.0.increments"].tolist() == [20.0, 20.0, 30.0, 30.0]
    assert np.isnan(grown.table["q.peak"]).tolist() == [False, False, True, True]
    grown.work()
    assert grown.table["par.material.props.nu"].tolist() == [0.1, 0.2, 0.1, 0.2]
    assert not np.isnan(grown.table["q.peak"]).any()


def test_a_case_that_is_wrong_is_reported(tmp_path: Path) -> None:
    with pytest.raises(po.CaseError, match="nearest valid name"):
        po.sweep(BASE, {"material.props.EE": [1.0]}, out=tmp_path / "sweep")
    with pytest.raises(po.CaseError, match="no folder of a sweep"):
        po.Sweep(tmp_path)
    with pytest.raises(po.CaseError, match="with submit"):
        po.sweep(BASE, {"material.props.E": [3e4]}, out=tmp_path / "other", executor="prozesse")


class Unreliable(ThreadPoolExecutor):
    """Loses the first of its workers."""

    lost = 0

    def submit(self, function, /, *arguments, **keywords):  # type: ignore[no-untyped-def]
        Unreliable.lost += 1
        if Unreliable.lost == 1:
            return super().submit(_lost)
        return super().submit(function, *arguments, **keywords)


def _lost() -> None:
    raise RuntimeError("the worker is gone")


@pytest.mark.slow
def test_what_a_lost_worker_left_is_handed_out_again(tmp_path: Path) -> None:
    points = [{"material.props.E": modulus} for modulus in np.linspace(2e4, 4e4, 20)]
    with Unreliable(2) as executor:
        made = po.sweep(BASE, points, out=tmp_path / "sweep", executor=executor, workers=2)
    assert made.status() == {"runs": 20, "left": 0, "done": 20}


@pytest.mark.slow
def test_dask(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    points = [{"material.props.E": modulus} for modulus in np.linspace(2e4, 4e4, 40)]
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            # one worker is killed in the middle
            victim = next(iter(client.run(os.getpid).values()))
            os.kill(victim, signal.SIGKILL)
            made = po.sweep(BASE, points, out=tmp_path / "sweep", quantities=["peak"], executor="dask", workers=2)
    assert made.status() == {"runs": 40, "left": 0, "done": 40}
    plain = po.sweep(BASE, points, out=tmp_path / "plain", quantities=["peak"])
    assert made.table["q.peak"].tolist() == plain.table["q.peak"].tolist()


def test_curves(tmp_path: Path) -> None:
    grid = [0.0, 5e-4, 1e-3]
    made = po.sweep(BASE, {"material.props.E": [3e4, 3.2e4]}, out=tmp_path / "sweep", curves=["s11"], grid=grid)
    curves = made.curves("s11")
    assert curves.shape == (2, 3) and np.all(curves[:, 0] == 0.0) and np.all(curves[:, 1:] > 0.0)
    with pytest.raises(KeyError, match="kept: s11"):
        made.curves("s22")
