"""Runs: a case in, curves out."""

from __future__ import annotations

import html
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, Literal, Mapping, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .case import Case, CaseLike, array_of, whole
from .errors import CaseError, PluginCrashed, PulloutError, RunFailed, Stopped, TimeLimit
from .fields import Mesh, Series

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow
    import xarray
    from matplotlib.axes import Axes

    from .law import Law, Props

__all__ = ["Failure", "History", "Peak", "Progress", "Run", "View", "point", "ramp", "read", "run", "table"]

#: receives the fraction done and the current row by columns; an exception ends the run
Progress = Callable[[float, "dict[str, float]"], None]


#: time between two checks of a flag, s
LOOK = 0.05


class Peak(NamedTuple):
    """Extremes of a column."""

    max: float | None
    min: float | None
    #: step and increment of the largest value, and of the smallest
    max_at: tuple[int, int] | None
    min_at: tuple[int, int] | None


class Failure(NamedTuple):
    """How a run failed."""

    #: "crashed", "timeout", or why the increment has no solution
    kind: str
    step: int
    increment: int
    message: str
    #: for a point, the state in which the increment was given up, by columns: within that increment, after the last row of the history
    reached: dict[str, float] = {}


def _is_no_place(*_: Any, **__: Any) -> Any:
    raise TypeError("the columns of a run cannot be changed: dict(run.history) is a dictionary of your own")


class History(Dict[str, "NDArray[np.float64]"]):
    """The rows of a run by column: read-only arrays that share the engine's memory."""

    # a dictionary, because other packages support only that; but read-only
    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _is_no_place

    def __init__(self, columns: Mapping[str, NDArray[np.float64]], units: Mapping[str, str]) -> None:
        super().__init__(columns)
        for column in self.values():
            column.flags.writeable = False
        #: units by columns, empty for numbers
        self.units = dict(units)

    def __missing__(self, name: str) -> NDArray[np.float64]:
        raise KeyError(f"{name!r} is not one of the columns {', '.join(self)}")

    def __reduce__(self) -> tuple[Any, ...]:
        # an unpickled history is read-only as well
        return History, (dict(self), self.units)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, History) or list(self) != list(other) or self.units != other.units:
            return False
        return all(np.array_equal(column, other[name], equal_nan=True) for name, column in self.items())

    def __ne__(self, other: object) -> bool:
        return not self == other

    @property
    def rows(self) -> int:
        """Number of rows, including the initial state. With several tables, that of the longest."""
        return max((len(column) for column in self.values()), default=0)

    def _equal(self) -> dict[str, NDArray[np.float64]]:
        """Return columns of equal length: those of shorter tables end in NaN."""

        def filled(column: NDArray[np.float64]) -> NDArray[np.float64]:
            missing = self.rows - len(column)
            return np.concatenate([column, np.full(missing, np.nan)]) if missing else column

        return {name: filled(column) for name, column in self.items()}

    def to_pandas(self) -> pandas.DataFrame:
        """Return a DataFrame with copies of the values; pandas must be installed."""
        import pandas

        return pandas.DataFrame(self._equal(), copy=True)

    def to_polars(self) -> polars.DataFrame:
        """Return a DataFrame; polars must be installed."""
        import polars

        return polars.DataFrame(self._equal())

    def to_arrow(self) -> pyarrow.Table:
        """Return a Table; pyarrow must be installed."""
        import pyarrow

        return pyarrow.table(self._equal())

    def to_xarray(self) -> xarray.Dataset:
        """Return a Dataset with the dimension "row" and the units as attributes; xarray must be installed."""
        import xarray

        columns = {name: ("row", values, {"units": self.units.get(name, "")}) for name, values in self._equal().items()}
        return xarray.Dataset(columns)

    def __repr__(self) -> str:
        return f"<History of {self.rows} rows: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        most = 5
        head = "".join(
            f"<th>{html.escape(name)}{f' ({html.escape(unit)})' if (unit := self.units.get(name)) else ''}</th>"
            for name in self
        )
        columns = list(self._equal().values())
        shown = list(range(self.rows)) if self.rows <= 2 * most else [*range(most), -1, *range(self.rows - most, self.rows)]
        lines = [
            "<tr>" + "".join(f"<td>{column[row]:.6g}</td>" if row >= 0 else "<td>…</td>" for column in columns) + "</tr>"
            for row in shown
        ]
        return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


class View:
    """A self-contained page that shows a specimen over a run, in a notebook or a browser."""

    def __init__(self, page: str, height: int) -> None:
        #: the page
        self.html = page
        self.height = height

    def _repr_html_(self) -> str:
        # a page within the page: names and styles of the two do not mix
        return f'<iframe srcdoc="{html.escape(self.html)}" style="width: 100%; height: {self.height}px; border: 0"></iframe>'

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the page into a file for a browser."""
        Path(file).write_text(self.html, encoding="utf-8")

    def __repr__(self) -> str:
        return f"<View, {len(self.html) / 1e6:.1f} MB: a notebook shows it, save(FILE) writes it>"


class Run:
    """The results of a run."""

    def __init__(
        self, case: Case | None, history: History, texts: Mapping[str, str], folder: Path | None = None, is_done: bool = False
    ) -> None:
        self.case = case
        self.history = history
        #: the result folder, if there is one
        self.folder = folder
        # the summary and the documents of the run by their names, and what else is text
        self._texts = dict(texts)
        replay = self._document("replay")
        #: a case that repeats the failed increment or call
        self.replay = None if replay is None else Case(replay)
        increments = self._document("increments")
        #: for a run with ``record=True``: ``case.with_({"increments": run.increments})`` repeats the increments of this run
        self.increments: dict[str, Any] | None = None if increments is None else {"recorded": increments}
        #: output of plugins in another process, or with ``out``; otherwise they print where the interpreter does
        self.prints: str = self._texts.get("prints", "")
        self._trail: _core.Trail | None = None
        #: the folder of the fields, which is deleted with this object
        self._fields: tempfile.TemporaryDirectory[str] | None = None
        self._is_done = is_done
        #: how and where it failed, if it did
        self.failure: Failure | None = None
        if not is_done and self.status == "failed":
            place = self.summary.get("failed_at") or {}
            self.failure = Failure(
                place.get("kind", "failed"),
                place.get("step", 0),
                place.get("increment", 0),
                self.summary.get("message", ""),
                self.summary.get("reached", {}),
            )

    def __getstate__(self) -> dict[str, Any]:
        # the states and fields of a specimen stay in their process; its increments are pickled
        return {**self.__dict__, "_trail": None, "_fields": None}

    def _document(self, name: str) -> Any:
        text = self._texts.get(name)
        return None if text is None else json.loads(text)

    # read on demand: that takes as long as fifty increments of a point
    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of ``summary.json``."""
        made: dict[str, Any] = self._document("summary")
        return made

    @property
    def status(self) -> str:
        """How the run ended: "done", "failed" or "interrupted"."""
        return str(self.summary["status"])

    @property
    def warnings(self) -> list[str]:
        """Warnings of the run."""
        return list(self.summary["warnings"])

    def peak(self, column: str) -> Peak:
        """Return the extremes of a column over all increments, written or not.

        A run of kind "bridging" has no increments: its greatest stresses and their openings are in ``summary["bridging"]``.
        """
        peaks = self.summary["peaks"]
        if "bridging" in self.summary:
            raise KeyError(
                "a run of kind 'bridging' has no peaks over increments: summary['bridging'] has 'sigma_peak' at 'w_peak' and "
                "'sigma_fibre_peak' at 'w_fibre_peak'; of other columns take the greatest of the history"
            )
        if column not in peaks:
            raise KeyError(f"{column!r} is not one of {', '.join(peaks)}" if peaks else "a run of this kind has no peaks: see its history")
        row = peaks[column]

        def place(name: str) -> tuple[int, int] | None:
            return (row[name]["step"], row[name]["increment"]) if row[name] else None

        return Peak(row["max"], row["min"], place("max_at"), place("min_at"))

    @property
    def series(self) -> Series:
        """All meshes with fields, kept by ``fields=True`` or written into the result folder."""
        if self._fields is not None:
            return Series(Path(self._fields.name))
        if self.folder is None:
            raise PulloutError("the run kept no fields: run the case with fields=True, or with out=…")
        return Series(self.folder)

    def mesh(self, frame: int = -1) -> Mesh:
        """Return the mesh with its fields: the last one, or number ``frame`` of those written."""
        return self.series.mesh(frame)

    def fields(self, name: str, frame: int = -1) -> NDArray[Any]:
        """Return a field by name, with one row for each node or cell."""
        mesh = self.mesh(frame)
        fields = {**mesh.cell_data, **mesh.point_data}
        if name not in fields:
            raise KeyError(f"{name!r} is not one of {', '.join(fields)}")
        return fields[name]

    def plot(self, y: str, x: str | None = None, *, ax: Axes | None = None, **options: Any) -> Axes:
        """Plot a column against another one (default: the time, or the column after "increment") with matplotlib,
        which must be installed.

        ``ax``: the axes to draw into; ``options`` are passed to matplotlib's ``plot``. Returns the axes.
        """
        from matplotlib import pyplot

        if x is None:
            x = "time" if "time" in self.history else [*self.history][min(2, len(self.history) - 1)]
        columns = [self.history[name] for name in (x, y)]
        axes: Axes = pyplot.subplots()[1] if ax is None else ax
        axes.plot(*columns, **options)
        units = self.history.units
        labels = [f"{name} ({units[name]})" if units.get(name) else name for name in (x, y)]
        axes.set(xlabel=labels[0], ylabel=labels[1])
        return axes

    def view(self, height: int = 900) -> View:
        """Return the viewer of ``report.html``: the deformed specimen with its fields over the run, and the load–slip curve."""
        page = self._texts.get("view") or self._view_of_report()
        if page is None:
            raise PulloutError("there is no view: it is of specimens, run with view=True, or with out=… and their pictures")
        return View(page, height)

    def _view_of_report(self) -> str | None:
        """Return the viewer in ``report.html`` of the folder, if there is one."""
        report = None if self.folder is None else self.folder / "report.html"
        if report is None or not report.is_file():
            return None
        text = report.read_text(encoding="utf-8")
        head, _, body = text.partition("</head>")
        found = re.search(r'<div id="viewer">(?:.*?</script>){3}</div>', body, re.S)
        return f"{head}</head><body>{found[0]}</body></html>" if found else None

    def __repr__(self) -> str:
        title = self.summary.get("title", "")
        return f"<Run {title!r}: {self.status}, {self.summary['increments']} increments, {self.history.rows} rows>"

    def _repr_html_(self) -> str:
        words = html.escape(repr(self)[1:-1])
        message = f"<br>{html.escape(self.failure.message)}" if self.failure else ""
        page = self._texts.get("view") or self._view_of_report()
        view = "" if page is None else View(page, 900)._repr_html_()
        return f"<b>{words}</b>{message}{view}{self.history._repr_html_()}"


def run(
    case: CaseLike,
    *,
    threads: int = 1,
    progress: bool | Progress = False,
    in_process: bool = False,
    on_failure: Literal["raise", "return"] = "raise",
    out: str | os.PathLike[str] | None = None,
    record: bool = False,
    along: Run | None = None,
    view: bool = True,
    fields: bool = False,
    stop: _core.Stop | None = None,
) -> Run:
    """Run a case: a file, a dictionary, or a :class:`Case`. Nothing is written unless ``out`` is given.

    ``out``: result folder. The program pullout then runs the case and writes pictures, report and fields; progress is not reported.

    ``threads`` share the work of a specimen. The results do not depend on their number, to the bit. ``progress``: ``True`` shows a
    bar. A function receives the fraction done and the current row, at most 20 times a second; if it raises an exception, the run
    ends. Ctrl-C ends the run too; with ``out`` the folder has the results so far, unless you press it again.

    ``view`` keeps the data of :meth:`Run.view` for a specimen: up to a few MB and a few percent of the time.

    ``record`` keeps the increments as ``increments`` of the run, so that runs with other parameters can repeat them. ``along``: such
    a run of the same specimen with nearly the same parameters. Each increment then takes an iteration or two, and the difference of
    the two runs is that of the solutions, whatever the tolerance; use it for derivatives. Runs of points repeat the increments.
    ``along`` is ignored if the steps of the case choose other increments, differ in number, or end by another ``until``.

    ``fields`` keeps the fields of a specimen for :meth:`Run.mesh` in a temporary folder, which is deleted with the run.

    ``stop`` ends the run when another thread sets it. :class:`Stopped` is raised, with the results so far.

    Plugins that were not built with this package run in their own process. ``in_process=True`` runs those of this case in this
    process; use it only for plugins that you trust.

    A failed run raises :class:`RunFailed` (:class:`PluginCrashed`, :class:`TimeLimit`). The error has the results so far as
    ``run``, and a case that repeats the failure as ``replay``. With ``on_failure="return"`` the failed run is returned instead.
    """
    threads = whole(threads, "threads")
    case = case if isinstance(case, Case) else Case(case)
    if on_failure not in ("raise", "return"):
        raise CaseError([("on_failure", "is 'raise' or 'return'")])
    trail = None
    if along is not None:
        if out is not None or along.increments is None:
            raise CaseError([("along", "is a run with record=True, and of one without out")])
        # if the run was read, or its case is unknown, the user is responsible for its increments
        ends_alike = along.case is None or _choices(along.case.document) == _choices(case.document)
        trail = along._trail if ends_alike else None
        if along._trail is None and ends_alike:
            case = case.with_({"increments": along.increments})
    if out is not None:
        return _ended(_run_into(case, Path(out).absolute(), threads, in_process, record, stop), on_failure)
    kept = None
    if fields:
        if case.document.get("kind") != "pullout":
            raise CaseError([("fields", "are of specimens")])
        kept = tempfile.TemporaryDirectory(prefix="pullout-")
        case = case.with_({"output.vtu": case.document.get("output", {}).get("vtu") or True})
    bar = _Bar() if progress is True else None
    listener: Progress | None = bar if bar is not None else progress if callable(progress) else None
    try:
        columns, texts, is_done, states = _core.run(
            case._parts(), threads, listener, in_process, trail, (record, view), stop, None if kept is None else kept.name
        )
    finally:
        if bar is not None:
            bar.close()
    history = History({name: values for name, _, values in columns}, {name: unit for name, unit, _ in columns})
    made = Run(case, history, texts, is_done=is_done)
    made._trail, made._fields = states, kept
    return _ended(made, on_failure)


def _choices(value: Any) -> list[Any]:
    """Return the settings of increments and of the ends of steps and run in a case, in order."""
    if isinstance(value, list):
        return [[_choices(entry) for entry in value]]
    if not isinstance(value, dict):
        return []
    own = [value[key] for key in ("until", "increments", "repeat") if key in value]
    inner = [choice for key, entry in sorted(value.items()) if key in ("steps", "cycles") for choice in _choices(entry)]
    return own + inner


def _ended(made: Run, on_failure: str) -> Run:
    if made.failure is not None and on_failure != "return":
        kinds = {"crashed": PluginCrashed, "timeout": TimeLimit}
        raise kinds.get(made.failure.kind, RunFailed)(made.failure.message, made, made.replay)
    if not made._is_done and on_failure != "return" and made.status == "interrupted":
        raise Stopped(str(made.summary.get("message", "the run was asked to end")), made)
    return made


def _is_on_file(case: Case) -> bool:
    """Return whether a case's file still has its document."""
    file, document, folder, _, _ = case._parts()
    try:
        return _core.document((file, None, folder, [], [])) == document
    except CaseError:
        return False


def _run_into(case: Case, out: Path, threads: int, in_process: bool, record: bool, stop: _core.Stop | None) -> Run:
    """Run a case by the program pullout."""
    case.check()
    if stop is not None and stop.is_set():
        raise Stopped("the run was asked to end before it started")
    file, document, folder, overrides, plugin_paths = case._parts()
    # a document is passed through a pipe; file names are relative to its folder
    command: list[str | Path] = [_core.program(), "run", "--quiet", f"--threads={threads}", f"--out={out}"]
    command += ["--in-process"] if in_process else []
    command += ["--record-increments"] if record else []
    if file is not None and not _is_on_file(case):
        named = {"title": file.stem, **json.loads(document or "{}")}
        file, document = None, json.dumps(named)
    command += [f"--plugin-path={path}" for path in plugin_paths] + [f"--set={text}" for text in overrides]
    command += ["--", "/dev/stdin" if file is None else file]
    summary = out / "summary.json"
    # of a run before this one, whose results stay if this one does not start
    before = summary.stat() if summary.is_file() else None
    pipe = subprocess.PIPE
    # Ctrl-C in the terminal goes to this process only
    with subprocess.Popen(command, cwd=folder, stdin=pipe, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as child:
        try:
            words = _words_of(child, document or "", stop)
        except BaseException:
            try:
                # it writes its results so far
                child.terminate()
                child.wait()
            finally:
                child.kill()
            raise
    is_stopped = stop is not None and stop.is_set()
    after = summary.stat() if summary.is_file() else None
    is_new = after is not None and (before is None or (after.st_ino, after.st_mtime_ns) != (before.st_ino, before.st_mtime_ns))
    if (child.returncode not in (0, 1) and not is_stopped) or not is_new:
        message = words.strip() or f"the program ended with exit code {child.returncode}"
        raise Stopped(message) if is_stopped else PulloutError(message)
    made = read(out)
    made.case = case
    return made


def _words_of(child: subprocess.Popen[str], document: str, stop: _core.Stop | None) -> str:
    """Return the error output of a child, which is terminated once ``stop`` is set."""
    is_stopped = False
    given: str | None = document
    while True:
        try:
            return child.communicate(given, timeout=None if stop is None or is_stopped else LOOK)[1]
        except subprocess.TimeoutExpired:
            given = None
            if stop is not None and stop.is_set():
                is_stopped = True
                child.terminate()


def read(folder: str | os.PathLike[str]) -> Run:
    """Read a run from its result folder."""
    folder = Path(folder).absolute()
    # for a case of kind "bridging", its tables side by side
    others = [table for table in (folder / "bridging.csv", folder / "beam.csv") if table.is_file()]
    columns: dict[str, NDArray[np.float64]] = {}
    try:
        documents = [folder / "summary.json", *folder.glob("*.json")]
        texts = {file.stem: file.read_text(encoding="utf-8", errors="replace") for file in documents}
        printed = [folder / name for name in ("umat.log", "umat.msg")]
        texts["prints"] = "".join(file.read_text(encoding="utf-8", errors="replace") for file in printed if file.is_file())
        for table in others or [folder / "history.csv"]:
            with open(table, encoding="utf-8") as file:
                names = file.readline().strip().split(",")
                values = np.loadtxt(file, delimiter=",", ndmin=2)
            columns.update(zip(names, np.ascontiguousarray(values.reshape(-1, len(names)).T)))
        return Run(None, History(columns, {name: _core.unit(name) for name in columns}), texts, folder)
    except (OSError, ValueError) as error:
        raise PulloutError(f"{folder} has no results: {error}") from None


def ramp(increments: int, time: float | None = None, **target: Union[float, str]) -> dict[str, Any]:
    """Return a step of a case: ``ramp(100, e11=-3e-3, s22="hold")``."""
    step: dict[str, Any] = {"increments": increments, "target": target}
    if time is not None:
        step["time"] = time
    return step


def table(
    time: ArrayLike | None = None, **columns: ArrayLike
) -> dict[str, Any]:
    """Return a step of a case with one increment per row: ``table(time, e11=strains, s22=stresses)``.

    ``time``: time at the end of each increment, from the beginning of the step (default: 1 s per increment).
    """
    given = columns if time is None else {"time": time, **columns}
    arrays = {name: array_of(values, name) for name, values in given.items()}
    wrong = [(name, f"has the shape {array.shape}, a column of numbers is needed") for name, array in arrays.items() if array.ndim != 1]
    if wrong:
        raise CaseError(wrong)
    return {"table": {name: array.tolist() for name, array in arrays.items()}}


def point(
    law: Law | str, props: Props, mode: str, steps: Sequence[Mapping[str, Any]], *, title: str = "", **others: Any
) -> Case:
    """Return a case of kind "point" for :func:`run`; ``others`` are further keys, such as ``characteristic_length=10.0``."""
    material: dict[str, Any] = {"plugin": law if isinstance(law, str) else str(law.path)}
    if props is not None:
        material["props"] = props
    if not isinstance(law, str) and not law.parameters:
        material["nstatv"] = law.nstatv
    return Case({"kind": "point", "title": title, "material": material, "mode": mode, "steps": list(steps), **others})


class _Bar:
    """The bar of tqdm if it is installed, otherwise one line."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._bar: Any = None
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return
        self._bar = tqdm(total=100.0, bar_format="{l_bar}{bar}| [{elapsed}<{remaining}]")

    def __call__(self, fraction: float, row: dict[str, float]) -> None:
        if self._bar is not None:
            self._bar.update(100.0 * fraction - self._bar.n)
        else:
            words = f"{100.0 * fraction:3.0f} %  {time.monotonic() - self._start:.1f} s"
            print(f"\r{words}", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        else:
            print(file=sys.stderr)
