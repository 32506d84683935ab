"""Laws: their metadata, and updates of many points at once."""

from __future__ import annotations

import html
import json
import math
import operator
import os
import warnings
from functools import partial
from pathlib import Path
from typing import Any, Literal, Mapping, NamedTuple, Sequence, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._worker import RemotePlugin
from .case import _text, array_of, whole
from .errors import CaseError, PluginError, PulloutError, UpdateFailed

__all__ = ["Heat", "Law", "Parameter", "State", "Update", "plugins"]

Array = NDArray[np.float64]
Props = Union[Mapping[str, Any], Sequence[float], Array, None]
#: as in the material of a case
Expansion = Union[float, Mapping[str, Any], None]
Orientation = Union[float, Sequence[Sequence[float]], None]
Mode = Literal["3d", "plane_strain", "axisymmetric", "plane_stress", "1d", "beam"]

#: Components of each mode, in the order 11, 22, 33, 12, 13, 23 (plane stress: 11, 22, 12; beam: 11, 12). Shear strains are engineering strains.
COMPONENTS: dict[str, int] = {"3d": 6, "plane_strain": 4, "axisymmetric": 4, "plane_stress": 3, "1d": 1, "beam": 2}


#: inputs of a point besides its strains, and the shape of a row; -1: any length
OTHERS: list[tuple[str, tuple[int, ...]]] = [
    ("length", ()),
    ("temperature", ()),
    ("dtemperature", ()),
    ("fields", (-1,)),
    ("dfields", (-1,)),
    ("dfgrd0", (3, 3)),
    ("dfgrd1", (3, 3)),
    ("drot", (3, 3)),
    ("coords", (3,)),
]
#: whether a value is None
NOTHING = partial(operator.is_, None)


def plugins() -> list[str]:
    """Return the names of all plugins in this package and in ``PULLOUT_PLUGIN_PATH``."""
    return _core.plugins()


class Parameter(NamedTuple):
    """A parameter of a law."""

    name: str
    unit: str
    default: float | None
    doc: str
    #: ``None`` if there is no bound
    lower: float | None
    upper: float | None
    #: as text, such as "> 0"
    bounds: str
    #: smallest and largest usual value, if the law gives them
    typical: tuple[float, float] | None
    #: numbers by name, if it selects among options
    choices: dict[str, float]


class State(NamedTuple):
    """A state variable of a law."""

    name: str
    unit: str
    doc: str


class Heat(NamedTuple):
    """Thermal terms that points return (RPL and its derivatives, DDSDDT). Terms that the law does not set are 0."""

    #: (…): heat generated per volume and time
    rpl: Array
    #: (…, components): derivative of the stress with respect to the temperature
    ddsddt: Array
    #: (…, components): derivative of RPL with respect to the strain increment, with engineering shear
    drplde: Array
    #: (…): derivative of RPL with respect to the temperature
    drpldt: Array


#: the tangent: an array, or nothing
T = TypeVar("T", bound="Array | None", covariant=True)


class Update(tuple[Array, Array, T]):
    """The result of ``Law.evaluate``: ``stress, state, tangent``. Array shapes begin with the shape of the points."""

    _energies: Array | None
    _heat: Heat | None

    def __new__(
        cls, stress: Array, state: Array, tangent: T, energies: Array | None = None, heat: Heat | None = None
    ) -> Update[T]:
        made = super().__new__(cls, (stress, state, tangent))
        made._energies, made._heat = energies, heat
        return made

    @property
    def stress(self) -> Array:
        """(…, components)"""
        return self[0]

    @property
    def state(self) -> Array:
        """(…, states)"""
        return self[1]

    @property
    def tangent(self) -> T:
        """(…, components, components), if requested"""
        return self[2]

    @property
    def energies(self) -> Array:
        """(…, 3): stored, plastic and creep energy. Raises an error if they were not requested."""
        if self._energies is None:
            raise PulloutError("the energies were not asked for: energies=True, or those at the start")
        return self._energies

    @property
    def heat(self) -> Heat:
        """RPL, DDSDDT, DRPLDE and DRPLDT. Raises an error if they were not requested."""
        if self._heat is None:
            raise PulloutError("the heat was not asked for: heat=True")
        return self._heat

    def __reduce__(self) -> tuple[Any, ...]:
        return Update, (*self, self._energies, self._heat)

    def __repr__(self) -> str:
        return f"<Update of points {self.stress.shape[:-1]}: {self.stress.shape[-1]} components, {self.state.shape[-1]} states>"


class Law:
    """A law: a plugin by name, or any UMAT by file.

    A library built with this package is called in this process. Any other library is called in its own process, so that a
    crash does no harm. ``in_process=True`` calls it in this process; use it only for libraries that you trust.

    ``nstatv`` is the number of state variables, needed if the library has no metadata. ``law`` chooses among several laws of a
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
        _description: str | None = None,
    ) -> None:
        if nstatv is not None:
            nstatv = whole(nstatv, "nstatv", 0)
        self._recipe = (os.fspath(name), nstatv, law, in_process, time_limit)
        self.path = Path(_core.find(os.fspath(name)))
        self._plugin: _core.Plugin | RemotePlugin
        if _core.is_shipped(self.path) or in_process:
            self._plugin = _core.Plugin(self.path, law, in_process)
        else:
            self._plugin = RemotePlugin(self.path, law, time_limit, _description)
        description = json.loads(self._plugin.describe())
        about: dict[str, Any] | None = description["law"]
        self._about = about or {}
        #: whether the library sets initial states or stresses of points
        self._sets_start = not {"sdvini", "sigini"}.isdisjoint(description["routines"])
        stem = self.path.stem
        #: the law's name, or that of the file if the library has no metadata
        self.name: str = self._about.get("name", stem[3:] if stem.startswith("lib") else stem)
        self.description: str = self._about.get("description", "")
        #: stress states that it supports
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
        self.nstatv: int = len(self.states) if nstatv is None else nstatv

    def props(self, props: Props = None) -> NDArray[np.float64]:
        """Return PROPS from parameters by name, with defaults for the others, or from an array in PROPS order. All
        values are checked."""
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

    def initial(
        self,
        points: int | tuple[int, ...] = 1,
        *,
        mode: Mode = "3d",
        coords: ArrayLike | None = None,
        orientation: Orientation = None,
    ) -> tuple[Array, Array]:
        """Return initial stress and state of points: the values that the library's SIGINI and SDVINI set, or zeros.

        ``points``: their number, or their shape, such as (elements, points per element). ``coords``: their positions (COORDS).
        ``orientation``: local axes of SIGINI's stresses, as in :meth:`evaluate`.
        """
        shape = (points,) if not isinstance(points, tuple) else points
        shape = tuple(whole(count, "points", 0) for count in shape)
        stress, state = np.zeros((*shape, self._components(mode))), np.zeros((*shape, self.nstatv))
        if self._sets_start and stress.size:
            given = _rows(np.zeros(3) if coords is None else coords, shape, (3,), "coords")
            rows, states = (array.reshape(-1, array.shape[-1]) for array in (stress, state))
            frame = self._frame(orientation=orientation)
            self._plugin.initial(mode, given, shape[-1] if len(shape) > 1 else 1, rows, states, frame)
        return stress, state

    @staticmethod
    def _frame(**given: Any) -> str:
        """The keys of a material that define the frame in which a law sees its points, as text; empty if there are none."""
        said = {name: value for name, value in given.items() if value is not None}
        return _text(said) if said else ""

    @staticmethod
    def _components(mode: str) -> int:
        if mode not in COMPONENTS:
            raise CaseError([("mode", f"'{mode}' is not one of the modes {', '.join(COMPONENTS)}")])
        return COMPONENTS[mode]

    @overload
    def evaluate(
        self,
        strain: ArrayLike,
        dstrain: ArrayLike,
        state: ArrayLike | None = None,
        props: Props = None,
        *,
        mode: Mode = "3d",
        stress: ArrayLike | None = None,
        tangent: Literal[True] = True,
        threads: int = 1,
        out: tuple[Array, ...] | None = None,
        length: ArrayLike | None = None,
        time: float = 0.0,
        dtime: float = 1.0,
        on_failure: Literal["raise", "nan"] = "raise",
        temperature: ArrayLike | None = None,
        dtemperature: ArrayLike | None = None,
        fields: ArrayLike | None = None,
        dfields: ArrayLike | None = None,
        dfgrd0: ArrayLike | None = None,
        dfgrd1: ArrayLike | None = None,
        drot: ArrayLike | None = None,
        coords: ArrayLike | None = None,
        energies: ArrayLike = False,
        heat: bool = False,
        expansion: Expansion = None,
        shrinkage: Mapping[str, Any] | None = None,
        orientation: Orientation = None,
    ) -> Update[Array]: ...

    @overload
    def evaluate(
        self,
        strain: ArrayLike,
        dstrain: ArrayLike,
        state: ArrayLike | None = None,
        props: Props = None,
        *,
        mode: Mode = "3d",
        stress: ArrayLike | None = None,
        tangent: bool,
        threads: int = 1,
        out: tuple[Array, ...] | None = None,
        length: ArrayLike | None = None,
        time: float = 0.0,
        dtime: float = 1.0,
        on_failure: Literal["raise", "nan"] = "raise",
        temperature: ArrayLike | None = None,
        dtemperature: ArrayLike | None = None,
        fields: ArrayLike | None = None,
        dfields: ArrayLike | None = None,
        dfgrd0: ArrayLike | None = None,
        dfgrd1: ArrayLike | None = None,
        drot: ArrayLike | None = None,
        coords: ArrayLike | None = None,
        energies: ArrayLike = False,
        heat: bool = False,
        expansion: Expansion = None,
        shrinkage: Mapping[str, Any] | None = None,
        orientation: Orientation = None,
    ) -> Update[Array | None]: ...

    def evaluate(
        self,
        strain: ArrayLike,
        dstrain: ArrayLike,
        state: ArrayLike | None = None,
        props: Props = None,
        *,
        mode: Mode = "3d",
        stress: ArrayLike | None = None,
        tangent: bool = True,
        threads: int = 1,
        out: tuple[Array, ...] | None = None,
        length: ArrayLike | None = None,
        time: float = 0.0,
        dtime: float = 1.0,
        on_failure: Literal["raise", "nan"] = "raise",
        temperature: ArrayLike | None = None,
        dtemperature: ArrayLike | None = None,
        fields: ArrayLike | None = None,
        dfields: ArrayLike | None = None,
        dfgrd0: ArrayLike | None = None,
        dfgrd1: ArrayLike | None = None,
        drot: ArrayLike | None = None,
        coords: ArrayLike | None = None,
        energies: ArrayLike = False,
        heat: bool = False,
        expansion: Expansion = None,
        shrinkage: Mapping[str, Any] | None = None,
        orientation: Orientation = None,
    ) -> Update[Array | None]:
        """Update n points at once, from rows of ``strain`` at the start and of its increment ``dstrain``.

        The dimensions before the components may have any shape, such as (elements, points per element, 6). Results have the same
        shape, and NOEL and NPT count along it. A single row applies to all points. The number 0 means zeros; no other single number
        is accepted if a point has several values.

        ``state`` and ``stress`` are the values at the start (default: those of :meth:`initial`). ``props`` are as in :meth:`props`;
        an array may have one row per point. ``length`` is the characteristic length (CELENT), one number or one per point; laws with
        a crack band (``G_f``) need it. Likewise ``temperature`` and ``fields`` are the values at the start (TEMP, PREDEF),
        ``dtemperature`` and ``dfields`` their increments, and ``coords`` the positions. Deformations are small unless you pass the
        gradients ``dfgrd0`` at the start and ``dfgrd1`` at the end, and the rotation ``drot`` of the increment: 3 × 3, row i,
        column j.

        ``expansion``, ``shrinkage`` and ``orientation`` are those of a case's material, for all points: thermal expansion in addition
        to the law, a strain over ``time``, and local axes. Strains and stresses of this call are always in the caller's axes. There
        is no expansion at the ``initial_temperature`` of ``expansion`` (default 0).

        ``time`` is the time at the start. If an increment begins later than the previous one, the previous one has converged:
        UEXTERNALDB is called and KINC increases. KINC is 1 at time 0.

        ``out``: arrays for stress and state, and optionally a third for the tangent. They may be the arrays of the start.
        Row i, column j of a point's tangent is the derivative of stress i with respect to strain increment j. ``energies``: ``True``,
        or the energies at the start; the result has those at the end. ``heat=True``: the result has the law's RPL, DDSDDT, DRPLDE and
        DRPLDT. With an expansion they belong to the strain that the law sees.

        If the law refuses points, :class:`UpdateFailed` is raised and ``out`` is unchanged. With ``on_failure="nan"`` these points
        get NaN stresses and keep their states. Input that is not finite, and parameters that the law does not admit, raise
        :class:`CaseError`, since no smaller increment helps; with "nan", points whose input is NaN get NaN. The GIL is released, and
        ``threads`` share the points. The results do not depend on the number of threads, to the bit.
        """
        components = self._components(mode)
        if on_failure not in ("raise", "nan"):
            raise CaseError([("on_failure", "is 'raise' or 'nan'")])
        threads = whole(threads, "threads")
        if not isinstance(props, np.ndarray):
            props = self.props(props)
        if not (np.isfinite(dtime) and dtime > 0.0):
            raise CaseError([("dtime", f"is {dtime}, but an increment takes a finite time > 0")])
        if not np.isfinite(time):
            raise CaseError([("time", f"is {time}, not a finite number")])
        if out is not None and len(out) not in (2, 3):
            raise CaseError([("out", "has the arrays for stress and state, and one for the tangent")])
        both = [array_of(strain, "strain"), array_of(dstrain, "dstrain")]
        shape, other = (array.shape[:-1] for array in both)
        try:
            if shape != other:
                shape = np.broadcast_shapes(shape, other)
        except ValueError:
            message = f"has the shape {both[0].shape}, dstrain {both[1].shape}: both are of the same points"
            raise CaseError([("strain", message)]) from None
        shape = shape or (1,)
        arrays = {
            "props": _rows(props, shape, (-1,), "props"),
            "strain": _rows(both[0], shape, (components,), "strain"),
            "dstrain": _rows(both[1], shape, (components,), "dstrain"),
        }
        if dfgrd0 is not None and dfgrd1 is None:
            raise CaseError([("dfgrd1", "is needed where dfgrd0 is given: the gradient at the end")])
        if dfgrd0 is None and dfgrd1 is not None:
            dfgrd0 = np.eye(3)
        others = (length, temperature, dtemperature, fields, dfields, dfgrd0, dfgrd1, drot, coords)
        if not all(map(NOTHING, others)):
            for (name, row), values in zip(OTHERS, others):
                if values is not None:
                    arrays[name] = _rows(values, shape, row, name)
        frame = self._frame(expansion=expansion, shrinkage=shrinkage, orientation=orientation)
        widths = {"stress": components, "state": self.nstatv, "tangent": components**2, "energies": 3}
        start: dict[str, ArrayLike | None] = {"stress": stress, "state": state}
        if not isinstance(energies, (bool, np.bool_)):
            start["energies"] = energies
        elif energies:
            start["energies"] = 0.0
        if self._sets_start and (stress is None or state is None):
            first = self.initial(shape, mode=mode, coords=coords, orientation=orientation)
            of_library = dict(zip(("stress", "state"), first))
            start.update({name: of_library[name] for name, values in start.items() if values is None})
        begun = {name: _rows(values, shape, (widths[name],), name) for name, values in start.items() if values is not None}
        # nothing is written before everything was checked
        targets: dict[str, Array] = {}
        kept: list[tuple[Array, Array]] = []
        if out is not None:
            targets = dict(zip(("stress", "state", "tangent"), out))
            for place, (name, array) in enumerate(targets.items()):
                row = (components, components) if name == "tangent" else (widths[name],)
                self._check_out(array, (*shape, *row), place)
                lies_over = [*arrays.values(), *(other for key, other in targets.items() if key != name)]
                lies_over += [other for key, other in begun.items() if key != name]
                if any(np.may_share_memory(array, other) for other in lies_over):
                    raise CaseError([(f"out[{place}]", "lies over another array of the call")])
            kept = [(array, array.copy()) for name, array in targets.items() if name != "tangent"]
        count = math.prod(shape)
        for name in start:
            target = targets.get(name)
            if target is None:
                target = targets[name] = np.zeros((*shape, widths[name]))
            if name in begun:
                target.reshape(count, widths[name])[...] = begun[name]
            elif out is not None:
                target[...] = 0.0
        if tangent and "tangent" not in targets:
            targets["tangent"] = np.zeros((*shape, components, components))
        arrays.update({name: array.reshape(count, widths[name]) for name, array in targets.items()})
        if heat:
            arrays["heat"] = np.zeros((count, 2 + 2 * components))
        times = (float(time), float(dtime))
        try:
            refused, reason = self._plugin.evaluate(
                mode, arrays, times, shape[-1] if len(shape) > 1 else 1, threads, on_failure == "nan", frame
            )
            if refused and on_failure == "raise":
                raise UpdateFailed(self.name, refused)
        except Exception:
            for array, values in kept:
                array[...] = values
            raise
        if reason is not None:
            warnings.warn(f"{self.name} is called with NTENS = 6: {reason}", stacklevel=2)
        if refused:
            points = [point for point, _, _ in refused]
            for name in ("stress", "tangent", "heat"):
                if name in arrays:
                    arrays[name][points] = np.nan
        coupling = self._heat_of(arrays["heat"].reshape(*shape, -1), components) if heat else None
        return Update(targets["stress"], targets["state"], targets.get("tangent"), targets.get("energies"), coupling)

    @staticmethod
    def _heat_of(values: Array, components: int) -> Heat:
        ddsddt, drplde = values[..., 2 : 2 + components], values[..., 2 + components :]
        return Heat(values[..., 0], ddsddt, drplde, values[..., 1])

    def _check_length(self, props: NDArray[np.float64], length: ArrayLike | None) -> None:
        """Raise an error if the length is missing but needed: the law could not detect that its CELENT is arbitrary."""
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
        return _law_of, (name, *others, _core.sha256(self.path), self._plugin.describe())

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


def _rows(values: ArrayLike, shape: tuple[int, ...], row: tuple[int, ...], name: str) -> Array:
    """Return values as one row per point of a shape, or one row for all; -1: a row of any length."""
    array = array_of(values, name)
    # the usual case in a loop over increments
    if len(row) == 1 and array.ndim == 2 and array.shape == shape + row and array.flags.c_contiguous:
        return array
    if array.ndim == 0 and row not in ((), (1,)):
        if array != 0.0:
            message = f"is one number, {float(array):g}, for all components: give a row of them for each point, or one for all"
            raise CaseError([(name, message)])
        array = np.zeros(row)
    array = array.reshape(row) if array.ndim == 0 else array
    split = array.ndim - len(row)
    wanted = tuple(given if length < 0 else length for given, length in zip(array.shape[max(split, 0) :], row))
    if split < 0 or array.shape[split:] != wanted:
        raise CaseError([(name, f"has the shape {array.shape}, {(*shape, *row)} is needed".replace("-1", "…"))])
    width, count = math.prod(wanted), math.prod(shape)
    if math.prod(array.shape[:split]) == 1:
        return np.ascontiguousarray(array).reshape(1, width)
    try:
        array = np.broadcast_to(array, (*shape, *wanted))
    except ValueError:
        raise CaseError([(name, f"has the shape {array.shape}, {(*shape, *wanted)} is needed")]) from None
    return np.ascontiguousarray(array).reshape(count, width)


def _law_of(
    name: str, nstatv: int | None, law: str | None, in_process: bool, time_limit: float, digest: str, description: str | None = None
) -> Law:
    """Return the law of a pickle. The file must have the same content."""
    made = Law(name, nstatv, law=law, in_process=in_process, time_limit=time_limit, _description=description)
    if _core.sha256(made.path) != digest:
        raise PluginError(f"{made.path} is another build than the one that was pickled")
    return made
