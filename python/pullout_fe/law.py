"""Laws: what they say of themselves, and updates of many points at once."""

from __future__ import annotations

import html
import json
import os
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._worker import RemotePlugin
from .case import _text, array_of
from .errors import CaseError, PluginError, UpdateFailed

__all__ = ["Law", "Parameter", "State", "Update", "plugins"]

Props = Union[Mapping[str, Any], Sequence[float], NDArray[np.float64], None]

#: Components of each mode, in the order 11, 22, 33, 12, 13, 23 (plane stress: 11, 22, 12); shear strains are engineering's.
COMPONENTS = {"3d": 6, "plane_strain": 4, "axisymmetric": 4, "plane_stress": 3}


def plugins() -> list[str]:
    """Names of the plugins that are found: those of this package and of ``PULLOUT_PLUGIN_PATH``."""
    return _core.plugins()


class Parameter(NamedTuple):
    """A parameter of a law."""

    name: str
    unit: str
    default: float | None
    doc: str
    #: ``None`` where there is no bound
    lower: float | None
    upper: float | None
    #: in words, such as "> 0"
    bounds: str
    #: the least and the greatest usual value, if the law says them
    typical: tuple[float, float] | None
    #: numbers by name, where it selects
    choices: dict[str, float]


class State(NamedTuple):
    """A state variable of a law."""

    name: str
    unit: str
    doc: str


class Update(NamedTuple):
    """What :meth:`Law.evaluate` returns."""

    #: (n, components)
    stress: NDArray[np.float64]
    #: (n, states)
    state: NDArray[np.float64]
    #: (n, components, components), if it was asked for
    tangent: NDArray[np.float64] | None


class Law:
    """A law: a plugin by its name, or any UMAT by its file.

    A library that was built with this package is called here. Any other one is called in a process of its own, which it may
    end without harm; ``in_process=True`` says that you answer for it, and calls it here.

    ``nstatv`` is the number of state variables where the library does not tell. ``law`` chooses among several laws of a
    library. ``time_limit``: seconds that an evaluation in another process may take.
    """

    def __init__(
        self,
        name: str | os.PathLike[str],
        nstatv: int | None = None,
        *,
        law: str | None = None,
        in_process: bool = False,
        time_limit: float = 60.0,
    ) -> None:
        self._recipe = (os.fspath(name), nstatv, law, in_process, time_limit)
        self.path = Path(_core.find(os.fspath(name)))
        self._plugin: _core.Plugin | RemotePlugin
        if _core.is_shipped(self.path) or in_process:
            self._plugin = _core.Plugin(self.path, law, in_process)
        else:
            self._plugin = RemotePlugin(self.path, law, time_limit)
        about: dict[str, Any] | None = json.loads(self._plugin.describe())
        self._about = about or {}
        stem = self.path.stem
        #: the law's name, or the file's where the library says nothing
        self.name: str = self._about.get("name", stem[3:] if stem.startswith("lib") else stem)
        self.description: str = self._about.get("description", "")
        #: stress states that it has
        self.modes: list[str] = self._about.get("modes", list(COMPONENTS))
        self.parameters: dict[str, Parameter] = {
            row["name"]: Parameter(**{**row, "typical": tuple(row["typical"]) if row["typical"] else None})
            for row in self._about.get("parameters", [])
        }
        self.states: list[State] = [State(**row) for row in self._about.get("states", [])]
        if nstatv is None and about is None:
            raise CaseError(
                [("nstatv", f"{self.path}: the library describes no law (it has no metadata): give the number of its states")]
            )
        if nstatv is not None and nstatv < len(self.states):
            raise CaseError([("nstatv", f"{self.name} needs {len(self.states)} state variables, {nstatv} given")])
        #: number of state variables
        self.nstatv: int = len(self.states) if nstatv is None else int(nstatv)

    def props(self, props: Props = None) -> NDArray[np.float64]:
        """PROPS: parameters by name, the others by default; or an array in their order, as it is. All are checked."""
        if isinstance(props, Mapping):
            props = dict(props)
        elif props is not None:
            props = array_of(props, "props").tolist()
            names = [*self.parameters, *(f"[{k}]" for k in range(len(self.parameters), len(props)))]
            for name, value in zip(names, props):
                _text(value, f"props.{name}".replace(".[", "["))
        elif not self._about:
            props = []
        return np.array(self._plugin.props(_text(props, "props")), dtype=float)

    def evaluate(
        self,
        strain: ArrayLike,
        dstrain: ArrayLike,
        state: ArrayLike | None = None,
        props: Props = None,
        *,
        mode: str = "3d",
        stress: ArrayLike | None = None,
        tangent: bool = True,
        threads: int = 1,
        out: tuple[NDArray[np.float64], ...] | None = None,
        length: ArrayLike | None = None,
        time: float = 0.0,
        dtime: float = 1.0,
        on_failure: str = "raise",
    ) -> Update:
        """Update n points at once: rows of ``strain`` at the start and of its increment ``dstrain``.

        ``state`` and ``stress`` are those at the start, zero if not given. ``props`` are as in :meth:`props`; an array is taken
        as it is. ``length`` is the characteristic length (CELENT), one number or one a point; laws with a crack band (``G_f``) need
        it. Deformations are small.

        ``out``: arrays for stress and state, and for the tangent if there is a third; they may be those of the start.
        Row i, column j of a point's tangent is the derivative of stress i by strain increment j.

        Points that the law refuses raise :class:`UpdateFailed`, or, with ``on_failure="nan"``, get stresses of NaN and keep
        their states. The GIL is released, and ``threads`` share the points; the results have the same bits with any number.
        """
        if mode not in COMPONENTS:
            raise CaseError([("mode", f"'{mode}' is not one of the modes {', '.join(COMPONENTS)}")])
        if on_failure not in ("raise", "nan"):
            raise CaseError([("on_failure", "is 'raise' or 'nan'")])
        if not isinstance(props, np.ndarray):
            props = self.props(props)
        components = COMPONENTS[mode]
        if not (np.isfinite(dtime) and dtime > 0.0):
            raise CaseError([("dtime", f"is {dtime}, but an increment takes a finite time > 0")])
        if not np.isfinite(time):
            raise CaseError([("time", f"is {time}, not a finite number")])
        counts = [len(np.atleast_2d(array_of(values, name))) for values, name in ((strain, "strain"), (dstrain, "dstrain"))]
        count = max(counts) if all(counts) else 0

        def rows(values: ArrayLike | None, columns: int, name: str) -> NDArray[np.float64]:
            array = array_of(0.0 if values is None else values, name)
            if array.shape == (count, columns):
                return np.ascontiguousarray(array)
            try:
                return np.ascontiguousarray(np.broadcast_to(array, (count, columns)))
            except ValueError:
                message = f"has the shape {array.shape}, ({count}, {columns}) is needed"
                raise CaseError([(name, message)]) from None

        def start(values: ArrayLike | None, columns: int, name: str, place: int) -> NDArray[np.float64]:
            """The array that the start becomes the end in."""
            if out is None:
                return np.array(rows(values, columns, name)) if values is not None else np.zeros((count, columns))
            target = out[place]
            self._check_out(target, (count, columns), place)
            if target is not values:
                target[...] = rows(values, columns, name)
            return target

        if out is not None and len(out) not in (2, 3):
            raise CaseError([("out", "has the arrays for stress and state, and one for the tangent")])
        strains, increments = rows(strain, components, "strain"), rows(dstrain, components, "dstrain")
        stresses = start(stress, components, "stress", 0)
        states = start(state, self.nstatv, "state", 1)
        moduli = None
        if out is not None and len(out) == 3:
            moduli = out[2]
            self._check_out(moduli, (count, components, components), 2)
        elif tangent:
            moduli = np.zeros((count, components, components))
        if out is not None:
            for place, array in enumerate(out):
                others = [strains, increments, *(other for k, other in enumerate(out) if k != place)]
                if any(np.may_share_memory(array, other) for other in others):
                    raise CaseError([(f"out[{place}]", "lies over another array of the call")])
        if threads < 1:
            raise CaseError([("threads", "is 1 or more")])
        self._check_length(props, length)
        lengths = None if length is None else np.ascontiguousarray(np.broadcast_to(array_of(length, "length"), (count,)))
        refused = self._plugin.evaluate(
            mode,
            np.ascontiguousarray(props, dtype=float),
            strains,
            increments,
            stresses,
            states,
            moduli,
            lengths,
            (float(time), float(dtime)),
            int(threads),
        )
        if refused:
            if on_failure == "raise":
                raise UpdateFailed(self.name, refused)
            points = [point for point, _, _ in refused]
            stresses[points] = np.nan
            if moduli is not None:
                moduli[points] = np.nan
        return Update(stresses, states, moduli)

    def _check_length(self, props: NDArray[np.float64], length: ArrayLike | None) -> None:
        """Refuses that the length is missing: no law would know that the one which it then gets is nobody's."""
        needed = self._plugin.needs_length(np.ascontiguousarray(props, dtype=float)) if length is None else None
        if needed is not None:
            raise CaseError([("length", f"is missing: {self.name}: {needed}")])

    @staticmethod
    def _check_out(array: NDArray[np.float64], shape: tuple[int, ...], place: int) -> None:
        is_usable = isinstance(array, np.ndarray) and array.dtype == np.float64 and array.flags.c_contiguous
        if not is_usable or array.shape != shape or not array.flags.writeable:
            raise CaseError([(f"out[{place}]", f"is no writeable C-contiguous float64 array of the shape {shape}")])

    def __reduce__(self) -> tuple[Any, ...]:
        name, *others = self._recipe
        name = str(self.path) if os.sep in name or name.endswith((".so", ".dylib", ".dll")) else name
        return _law_of, (name, *others, _core.sha256(self.path))

    def __repr__(self) -> str:
        return f"<Law {self.name}: {len(self.parameters)} parameters, {self.nstatv} states, {', '.join(self.modes)}>"

    def _repr_html_(self) -> str:
        def table(head: Sequence[str], body: Sequence[Sequence[str]]) -> str:
            cells = "".join(f"<th>{html.escape(title)}</th>" for title in head)
            lines = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in body)
            return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"

        parameters = [
            (p.name, "" if p.default is None else f"{p.default:g}", p.unit, p.bounds, p.doc) for p in self.parameters.values()
        ]
        states = [(state.name, state.unit, state.doc) for state in self.states]
        return (
            f"<b>{html.escape(self.name)}</b>: {html.escape(self.description)}"
            + table(("parameter", "default", "unit", "bounds", "meaning"), parameters)
            + table(("state", "unit", "meaning"), states)
        )


def _law_of(
    name: str, nstatv: int | None, law: str | None, in_process: bool, time_limit: float, digest: str
) -> Law:
    """The law of a pickle: the same file as then, by its content."""
    made = Law(name, nstatv, law=law, in_process=in_process, time_limit=time_limit)
    if _core.sha256(made.path) != digest:
        raise PluginError(f"{made.path} is another build than the one that was pickled")
    return made
