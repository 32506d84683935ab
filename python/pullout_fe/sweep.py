"""Sweeps: run a case thousands of times and keep numbers and curves."""

from __future__ import annotations

import json
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Literal, Mapping, Protocol, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .case import Case, CaseLike, _text, array_of, whole
from .errors import CaseError, PulloutError

__all__ = ["Sweep", "sweep"]

#: how often the runs of a lost worker are handed out again
ROUNDS = 3
#: number of parts per worker: a slow or lost worker delays one part
PARTS_PER_WORKER = 4
#: prefix of the names of columns with curves
CURVE = "curve."
#: the file from which the program reads the sweep
STREAM = "/dev/stdin"


class Future(Protocol):
    """The result of ``submit``."""

    def result(self) -> Any:
        """Wait for the call and return its result."""


class Submits(Protocol):
    """Executors of :mod:`concurrent.futures`, ``distributed.Client``, and any other object with ``submit``."""

    def submit(self, function: Any, /, *arguments: Any) -> Future:
        """Schedule a call."""


#: by name, or an object with ``submit``; "dask": the current client of Dask Distributed, or one on this machine
Executor = Union[Literal["processes", "threads", "dask"], Submits]
Design = Union[Mapping[str, Sequence[Any]], Sequence[Mapping[str, Any]], Any]


def sweep(
    case: CaseLike,
    design: Design,
    *,
    out: str | os.PathLike[str],
    quantities: Mapping[str, Any] | Sequence[str] | None = None,
    curves: Sequence[str] = (),
    grid: ArrayLike | None = None,
    curve: tuple[str, str] | None = None,
    work_to: float | None = None,
    executor: Executor | None = "processes",
    workers: int | None = None,
    chunk_runs: int | None = None,
    progress: bool = False,
) -> Sweep:
    """Run a case for all points of a design. Finished runs in the folder ``out`` are not repeated.

    ``design``: lists of values by place in the case, of which every combination is run
    (``{"material.props.E": [2e4, 3e4]}``); or a list of dictionaries; or a table of pandas or polars with the places as columns.
    ``quantities``: names as in studies (``["peak", "work"]``), or a dictionary of them. ``curves``: columns to keep, interpolated
    on the ``grid``, a list of values of the curve's x, if there is one.

    ``executor``: "processes" or "threads" of this machine, ``workers`` of them; "dask"; or any object with ``submit``. Each run is
    executed in a child of the worker, so that a library that ends its process costs one run and not the worker. "threads" execute
    their runs in one process if all libraries were built with this package, otherwise in children. ``None``: the sweep is only
    planned; run it later by :meth:`Sweep.work`, or by ``pullout sweep work`` or ``submit``.

    A failed run is a row of the table with its ``status``; no error is raised.
    """
    made = Case(case)
    document = _document(made, design, quantities, curves, grid, curve, work_to)
    if not made._folder.is_dir():
        raise CaseError(f"{made._folder} is no folder")
    folder = Path(out).absolute()
    paths = [f"--plugin-path={path}" for path in made._plugin_paths]
    text = _text({"title": folder.name, **document})
    # names of files are relative to the folder of the case
    _call("plan", STREAM, "--out", os.fspath(folder), *paths, document=text, of=made)
    planned = Sweep(out)
    if executor is not None:
        planned.work(executor, workers=workers, chunk_runs=chunk_runs, progress=progress)
    return planned


class Sweep:
    """The folder of a sweep: its status and its table."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder).absolute()
        self._read: tuple[Any, list[tuple[str, Any]]] | None = None
        if not (self.folder / "sweep.json").is_file():
            raise CaseError(f"{self.folder} is no folder of a sweep")

    def work(
        self,
        executor: Executor = "processes",
        *,
        workers: int | None = None,
        chunk_runs: int | None = None,
        again: bool = False,
        progress: bool = False,
    ) -> None:
        """Execute the remaining runs. ``again`` repeats those that failed, crashed or took too long."""
        for name, count in (("workers", workers), ("chunk_runs", chunk_runs)):
            if count is not None:
                whole(count, name)
        options = [] if chunk_runs is None else [f"--chunk-runs={chunk_runs}"]
        options += ["--again"] if again else []
        if executor in ("processes", "threads"):
            options += [] if workers is None else [f"--jobs={workers}"]
            options += ["--in-process"] if executor == "threads" else []
            options += [] if progress else ["--quiet"]
            _call("work", os.fspath(self.folder), *options, shown=progress)
            return
        submits = _dask() if executor == "dask" else executor
        if isinstance(submits, str):
            raise CaseError(f"executor {submits!r}: give 'processes', 'threads', 'dask' or an object with submit")
        parts = PARTS_PER_WORKER * (workers or os.cpu_count() or 1)
        trouble: Exception | None = None
        for _ in range(ROUNDS):
            futures = [submits.submit(_work, os.fspath(self.folder), part, parts, options) for part in range(parts)]
            for future in futures:
                try:
                    future.result()
                except Exception as error:  # a lost worker: the next round takes its remaining runs
                    trouble = error
            if self.status()["left"] == 0:
                return
            options = [option for option in options if option != "--again"]
        raise PulloutError(f"{self.folder}: {self.status()['left']} runs are left after {ROUNDS} rounds") from trouble

    def status(self) -> dict[str, int]:
        """Return numbers of runs: all (``runs``), by outcome, and remaining (``left``)."""
        printed = _call("status", os.fspath(self.folder))
        found = re.search(r": (\d+) runs, \d+ finished(?: \((.*?)\))?, (\d+) to do", printed)
        if found is None:
            raise PulloutError(printed.strip())
        counts = {"runs": int(found[1]), "left": int(found[3])}
        for part in filter(None, (found[2] or "").split(", ")):
            count, name = part.split(" ")
            counts[name] = int(count)
        return counts

    @property
    def table(self) -> dict[str, NDArray[Any]]:
        """One row for each run of the current plan, by column: texts as objects, whole numbers as integers if all
        rows have one, other numbers as floats, NaN for missing ones. A remaining run has the ``status`` "left" and
        its parameters.
        """
        return {name: np.array(values, dtype=object if isinstance(values, list) else None) for name, values in self._columns()
                if not name.startswith(CURVE)}

    def _columns(self) -> list[tuple[str, Any]]:
        """Return all columns. They are read again when something was added to the folder."""
        plan = (self.folder / "sweep.json").stat()
        # parts are written once
        parts = sorted(entry.name for entry in os.scandir(self.folder / "parts")) if (self.folder / "parts").is_dir() else []
        stamp = (plan.st_mtime_ns, plan.st_size, parts)
        if self._read is None or self._read[0] != stamp:
            self._read = (stamp, _core.collect(self.folder))
        return self._read[1]

    def to_pandas(self) -> Any:
        """Return the table as a ``pandas.DataFrame``."""
        import pandas

        return pandas.DataFrame(self.table)

    def to_arrow(self) -> Any:
        """Return the table with the curves as a ``pyarrow.Table``."""
        from pyarrow import parquet

        with tempfile.TemporaryDirectory() as place:
            file = os.path.join(place, "table.parquet")
            _call("collect", os.fspath(self.folder), "--out", file)
            return parquet.read_table(file)

    def curves(self, name: str) -> NDArray[np.float64]:
        """Return a kept column of all runs, one row per run, padded with NaN if lengths differ."""
        kept = {column.removeprefix(CURVE): lists for column, lists in self._columns() if column.startswith(CURVE)}
        if name not in kept:
            raise KeyError(f"{name!r} is not one of the curves that were kept: {', '.join(kept) or 'none'}")
        filled = np.full((len(kept[name]), max(map(len, kept[name]), default=0)), np.nan)
        for row, values in zip(filled, kept[name]):
            row[: len(values)] = values
        return filled

    def __repr__(self) -> str:
        counts = self.status()
        return f"<Sweep {self.folder}: {', '.join(f'{count} {name}' for name, count in counts.items())}>"


def _document(
    case: Case,
    design: Design,
    quantities: Mapping[str, Any] | Sequence[str] | None,
    curves: Sequence[str],
    grid: ArrayLike | None,
    curve: tuple[str, str] | None,
    work_to: float | None,
) -> dict[str, Any]:
    """Return the content of the sweep file."""
    _, text, _, overrides, _ = case._parts()
    document: dict[str, Any] = {"kind": "sweep", "base": json.loads(text or "{}")}
    changes = (override.split("=", 1) for override in overrides)
    if overrides:
        document["set"] = {path: json.loads(value) for path, value in changes}
    if hasattr(design, "to_dict"):
        # pandas; polars has to_dicts
        design = design.to_dicts() if hasattr(design, "to_dicts") else design.to_dict("records")
    try:
        if isinstance(design, Mapping):
            document["parameters"] = {path: _values(values) for path, values in design.items()}
        else:
            document["points"] = [dict(point) for point in design]
    except (TypeError, ValueError):
        raise CaseError([("design", "is a dictionary of lists of values, a list of dictionaries, or a table")]) from None
    if quantities is not None:
        named = quantities if isinstance(quantities, Mapping) else {name: name for name in quantities}
        document["quantities"] = dict(named)
    if curves:
        document["curves"] = list(curves)
    if grid is not None:
        document["grid"] = array_of(grid, "grid").tolist()
    if curve is not None:
        document["curve"] = {"x": curve[0], "y": curve[1]}
    if work_to is not None:
        document["work_to"] = work_to
    return document


def _values(values: Any) -> list[Any]:
    if isinstance(values, str):
        raise TypeError
    return list(values)


def _dask() -> Submits:
    import distributed

    try:
        client = distributed.get_client()
    except ValueError:
        client = distributed.Client()
    # a call with the same arguments must be executed again: it depends on the folder
    executor: Submits = client.get_executor(pure=False, retries=0)
    return executor


def _work(folder: str, part: int, parts: int, options: list[str]) -> None:
    """Execute a part of the runs in a worker."""
    _call("work", folder, f"--chunk={part}/{parts}", "--jobs=1", "--quiet", *options)


def _call(*arguments: str, shown: bool = False, document: str = "", of: Case | None = None) -> str:
    """Return the output of `pullout sweep`. It reads ``document``, made from the case ``of``, from :data:`STREAM`, in the case's folder."""
    from . import program

    done = subprocess.run(
        [program(), "sweep", *arguments],
        input=document,
        cwd=None if of is None else of._folder,
        stdout=None if shown else subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    # users do not know the document by this name
    name = f"{of._file}: " if of is not None and of._file is not None else ""
    words = done.stderr.replace(f"{STREAM}: ", name).strip()
    if done.returncode == 2:
        raise CaseError(words)
    if done.returncode != 0:
        raise PulloutError(words or f"pullout sweep {arguments[0]} ended with code {done.returncode}")
    return done.stdout or ""
