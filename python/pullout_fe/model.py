"""Models: parameters in, a curve out, for optimisers, samplers and sensitivity studies."""

from __future__ import annotations

import copy
import warnings
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any, Callable, Iterable, Literal, Mapping, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .case import Case, CaseLike, array_of, whole
from .errors import CaseError, PulloutError, RunFailed, Stopped
from .run import Run, run

__all__ = ["Fit", "Model", "Models"]

Array = NDArray[np.float64]
#: place of a parameter in the case; with "log", its logarithm varies
Free = Union[str, "tuple[str, str]"]

#: relative step of differences: smaller steps drown in the tolerance of a specimen's equilibrium
STEP = 1e-6


class Fit(NamedTuple):
    """The result of a fit."""

    #: parameters by name
    values: dict[str, float]
    #: covariance and correlations of the parameters, in their order
    covariance: Array
    correlations: Array
    #: parameters that the data do not determine: other values fit as well
    not_identifiable: list[str]
    #: half the sum of the squares of the residuals
    cost: float
    #: number of runs
    evaluations: int
    #: parameters that ended on a bound, with the bound: the best value may lie beyond
    on_bound: dict[str, float] = {}

    def standard_errors(self) -> dict[str, float]:
        """Return the standard errors of the parameters, by name."""
        return dict(zip(self.values, np.sqrt(np.diag(self.covariance)).tolist()))


class _Fitted:
    """Parameters, and the curve that a fit adjusts."""

    #: names of the parameters
    names: list[str]
    #: parameters to start from; NaN if no case gives them
    x0: Array
    bounds: list[tuple[float, float]]
    _is_log: NDArray[np.bool_]

    def __call__(self, x: ArrayLike) -> Array:
        """Return the curve of these parameters."""
        raise NotImplementedError

    def jac(self, x: ArrayLike) -> Array:
        """Return the derivatives of the curve (rows) with respect to the parameters (columns)."""
        raise NotImplementedError

    def _outside(self, x: Array, point: int) -> str:
        """Return why the run of these parameters has no value at a point of the data."""
        raise NotImplementedError

    def residual(self, x: ArrayLike, data: ArrayLike, sigma: ArrayLike = 1.0) -> Array:
        """Return curve minus data, in standard deviations; 0 where the data are NaN."""
        target, curve = np.atleast_1d(array_of(data, "data")), self(x)
        if target.shape != curve.shape:
            raise CaseError([("data", f"have the shape {target.shape}, the curve has {curve.shape}")])
        difference = (curve - target) / array_of(sigma, "sigma")
        return np.where(np.isnan(target), 0.0, difference)

    def fit(
        self, data: ArrayLike, sigma: ArrayLike | None = None, x0: ArrayLike | None = None, *, starts: int | None = None, max_runs: int = 1000
    ) -> Fit:
        """Fit the parameters to data by the least squares of ``pullout fit``.

        ``starts``: number of starting points, ``x0`` and others between the ``bounds``. The best result counts. The default is 4
        as in ``pullout fit``, or 1 if a bound is infinite. ``max_runs``: largest number of runs of all searches. Where a run fails,
        the search goes back, except at the first point.

        The covariance assumes data errors of ``sigma``. Without ``sigma`` it assumes errors as large as the remaining differences, as in
        ``pullout fit``.
        """
        start = self.x0 if x0 is None else array_of(x0, "x0")
        if start.shape != self.x0.shape:
            raise CaseError([("x0", f"has the shape {start.shape}, {self.x0.shape} is needed")])
        if not np.all(np.isfinite(start)):
            missing = [name for name, value in zip(self.names, start) if not np.isfinite(value)]
            raise CaseError(f"the case does not say {', '.join(missing)}: give x0")
        named = list(zip(self.names, start.tolist(), self.bounds, self._is_log))
        outside = [("x0", f"{name} = {value} is not within {low}:{high}") for name, value, (low, high), _ in named if not low <= value <= high]
        outside += [("x0", f"{name} = {value} has no logarithm") for name, value, _, is_log in named if is_log and value <= 0.0]
        unbounded = [name for name, bound in zip(self.names, self.bounds) if not np.all(np.isfinite(bound))]
        starts = (1 if unbounded else _core.STARTS) if starts is None else whole(starts, "starts")
        if starts > 1 and unbounded:
            outside.append(("starts", f"lie between bounds: give those of {', '.join(unbounded)}"))
        if outside:
            raise CaseError(outside)
        target = array_of(data, "data")
        deviations = array_of(1.0 if sigma is None else sigma, "sigma")
        if np.isinf(target).any() or np.isnan(target).all():
            raise CaseError([("data", "has no finite number" if np.isnan(target).all() else "is infinite: NaN is what is not known")])
        if not np.all(np.isfinite(deviations) & (deviations > 0.0)):
            raise CaseError([("sigma", "is a finite number > 0, or one for each point")])
        known = np.atleast_1d(~np.isnan(target))
        count, freedom = len(self.names), int(np.count_nonzero(known)) - len(self.names)
        if sigma is None and freedom < 1:
            raise CaseError(f"{freedom + count} points cannot determine errors of {count} parameters: give sigma")
        runs = 0

        def residual(x: ArrayLike) -> Array:
            nonlocal runs
            runs += 1
            try:
                found = self.residual(x, target, deviations)[known]
            except (CaseError, RunFailed) as error:
                if runs == 1 or isinstance(error, Stopped):
                    raise
                return np.full(freedom + count, np.nan)
            if runs == 1 and np.isnan(found).any():
                raise CaseError([("data", self._outside(start, int(np.flatnonzero(known)[np.argmax(np.isnan(found))])))])
            return found

        def derivatives(x: ArrayLike) -> Array:
            nonlocal runs
            runs += 1 + count
            slopes: Array = self.jac(x)[known] / np.broadcast_to(deviations, known.shape)[known][:, None]
            return slopes

        ranges = [(*bound, bool(is_log)) for bound, is_log in zip(self.bounds, self._is_log)]
        scale = float(np.max(np.abs(np.where(known, target, 0.0)) / deviations)) or 1.0
        limits = (starts, whole(max_runs, "max_runs"))
        found = _core.least_squares(residual, derivatives, ranges, start.tolist(), limits, scale, sigma is not None)
        values, deviation, rows, cost, on_bound, trouble = found
        if trouble is not None:
            warnings.warn(trouble, stacklevel=2)
        # nothing is known of some
        errors = np.where(np.isfinite(deviation), deviation, np.nan)
        correlations = np.array(rows)
        correlations[np.isnan(errors)] = np.nan
        correlations[:, np.isnan(errors)] = np.nan
        return Fit(
            dict(zip(self.names, values)),
            correlations * np.outer(errors, errors),
            correlations,
            [name for name, error in zip(self.names, errors) if np.isnan(error)],
            cost,
            runs,
            {name: bound for name, bound in zip(self.names, on_bound) if bound is not None},
        )


class Model(_Fitted):
    """A case as a function of some of its parameters.

    ``parameters``: names, each with its place in the case (``"material.props.E"``), or with a pair of the place and ``"log"``:
    steps and fits then use the logarithm. ``curve``: two columns of the history. The second is interpolated on the ``grid``, a list
    of values of the first, where the run first passes each value. It is NaN before the beginning and after the end. A grid with
    reversals, as in measured cycles, is interpolated branch by branch, with NaN on branches that the run does not have. Without a
    grid the curve has the rows of the run, and the increments must not depend on the parameters.

    ``on_failure``: "raise", or a number such as ``np.nan`` that replaces the whole curve if a run fails or the case does not admit
    the parameters. Fits and the steps of derivatives respect the ``bounds``.
    """

    def __init__(
        self,
        case: CaseLike,
        parameters: Mapping[str, Free],
        curve: tuple[str, str],
        grid: ArrayLike | None = None,
        *,
        on_failure: Literal["raise"] | float = "raise",
        bounds: Mapping[str, tuple[float, float]] | None = None,
        in_process: bool = False,
    ) -> None:
        self.case = Case(case)
        self.names = list(parameters)
        self._paths = [free if isinstance(free, str) else free[0] for free in parameters.values()]
        places = [_core.dotted(path) for path in self._paths]
        twice = [(f"parameters[{name!r}]", f"has the place of {self.names[places.index(place)]!r}") for k, (name, place) in
                 enumerate(zip(self.names, places)) if place in places[:k]]
        scales = [(f"parameters[{name!r}]", f"is a place, or a place and 'log', not {free[1]!r}") for name, free in parameters.items()
                  if not isinstance(free, str) and free[1] != "log"]
        if twice or scales:
            raise CaseError(twice + scales)
        if isinstance(on_failure, str) and on_failure != "raise":
            raise CaseError([("on_failure", "is 'raise' or a number")])
        self._is_log = np.array([not isinstance(free, str) and free[1] == "log" for free in parameters.values()], dtype=bool)
        self.curve = curve
        self.grid = None if grid is None else array_of(grid, "grid")
        self.on_failure = on_failure
        self.in_process = in_process
        self._along: Run | None = None
        #: stops runs in threads
        self._stop: _core.Stop | None = None
        #: number of points of a curve without a grid, once a run has finished
        self._length: int | None = None
        given = bounds or {}
        self._check_bounds(given)
        self.bounds = [given.get(name, (-np.inf, np.inf)) for name in self.names]
        document = self.case.document
        #: the parameters of the case; NaN if it uses their defaults
        self.x0: Array = np.array([_number(document, path) for path in self._paths])

    def _check_bounds(self, bounds: Mapping[str, tuple[float, float]]) -> None:
        names = ", ".join(self.names)
        problems = [(f"bounds[{name!r}]", f"is no parameter: {names}") for name in bounds if name not in self.names]
        for name, (low, high) in bounds.items():
            if not low < high:
                problems.append((f"bounds[{name!r}]", f"{low} is not below {high}"))
        if problems:
            raise CaseError(problems)

    def __call__(self, x: ArrayLike) -> Array:
        """Return the curve of these parameters."""
        return self._filled(self._attempt(x))

    def _attempt(self, x: ArrayLike) -> Array | None:
        """Return the curve, or ``None`` if the run failed and a number replaces it."""
        return self._run(x)[0]

    def _filled(self, curve: Array | None) -> Array:
        """Return the curve, or the number that replaces it."""
        if curve is not None:
            return curve
        length = self._length if self.grid is None else len(self.grid)
        if length is None:
            raise CaseError("the run failed, and how long its curve would be is not known before another one is done: give a grid")
        return np.full(length, float(self.on_failure))

    def _counts_as_failure(self, error: PulloutError) -> bool:
        """Return whether the parameters are the reason, not the case itself, and a number replaces the curve."""
        if isinstance(self.on_failure, str):
            return False
        if isinstance(error, RunFailed):
            return True
        # a place that the case does not have is an error for any parameters
        if not isinstance(error, CaseError) or set(error.kinds) != {"input"}:
            return False
        try:
            self.case.check()
        except CaseError as wrong:
            # values that the parameters give may be missing in the case
            open_places = {_core.dotted(path) for path, value in zip(self._paths, self.x0) if not np.isfinite(value)}
            if not {_core.dotted(place) for place, _ in wrong.problems} <= open_places:
                raise
        return True

    def _run(self, x: ArrayLike, record: bool = False) -> tuple[Array | None, Run | None]:
        """Return the curve and the run."""
        values = np.atleast_1d(array_of(x, "x"))
        if values.shape != (len(self.names),):
            raise CaseError(f"{len(self.names)} parameters ({', '.join(self.names)}) are needed, the shape is {values.shape}")
        try:
            case = self.case.with_(dict(zip(self._paths, values.tolist())))
            made = run(case, in_process=self.in_process, record=record, along=self._along, view=False, stop=self._stop)
        except Stopped:
            raise
        except (CaseError, RunFailed) as error:
            if self._counts_as_failure(error):
                return None, None
            raise
        along, values = (made.history[name] for name in self.curve)
        if self.grid is None:
            self._length = len(values)
            return np.array(values), made
        return _on_grid(self.curve[0], along, values, self.grid), made

    def batch(self, points: ArrayLike, executor: Executor | None = None, workers: int | None = None) -> Array:
        """Return the curves for rows of parameters, computed in threads or by your own executor."""
        rows = list(np.atleast_2d(array_of(points, "points")))
        workers = None if workers is None else whole(workers, "workers")
        if executor is not None:
            curves = list(executor.map(self._attempt, rows))
        else:
            model = copy.copy(self)
            model._stop = stop = _core.Stop()
            curves = _in_threads(model._attempt, rows, stop=stop, workers=workers)
        return self._table(curves)

    def _table(self, curves: list[Array | None]) -> Array:
        """Return curves as rows, with the number that replaces failed ones."""
        lengths = {len(curve) for curve in curves if curve is not None}
        self._length = next(iter(lengths), self._length)
        if len(lengths) > 1:
            raise CaseError(f"the curves have {min(lengths)} to {max(lengths)} points: give a grid")
        return np.array([self._filled(curve) for curve in curves])

    def _perturbed(self, base: Run, trail: _core.Trail, points: Array) -> Array:
        """Return the curves of rows of parameters from simultaneous runs along the states of one run: they share factors."""

        def curve(point: Array, turn: _core.Trail) -> Array | None:
            model, along = copy.copy(self), copy.copy(base)
            model._along, along._trail, model._stop = along, turn, stop
            try:
                return model._attempt(point)
            finally:
                turn.leave()

        stop, count = _core.Stop(), len(points)
        return self._table(_in_threads(curve, points, trail.together(count), stop=stop, workers=count))

    def jac(self, x: ArrayLike, executor: Executor | None = None) -> Array:
        """Return the derivatives of the curve (rows) with respect to the parameters (columns), by forward differences of
        ``STEP``, or backward ones near an upper bound.

        The runs follow the run at ``x`` (``along`` of :func:`run`). This avoids jumps from automatic increments, and an iteration or two
        per increment are enough. Executors with other processes repeat the increments of that run.
        """
        start = np.atleast_1d(array_of(x, "x"))
        steps = STEP * np.where(start == 0.0, 1.0, np.abs(start))
        upper = np.array([high for _, high in self.bounds])
        # the step after rounding
        moved = start + np.diag(np.where(start + steps > upper, -steps, steps))
        curve, made = self._run(start, record=True)
        base = self._filled(curve)
        if executor is None and made is not None and made._trail is not None:
            curves = self._perturbed(made, made._trail, moved)
        else:
            frozen = copy.copy(self)
            if executor is None or isinstance(executor, ThreadPoolExecutor):
                frozen._along = made
            elif made is not None and made.increments is not None:
                # other processes do not have the states of this one
                frozen.case = self.case.with_({"increments": made.increments})
            curves = frozen.batch(moved, executor)
        derivatives: Array = ((curves - base) / (np.diag(moved) - start)[:, None]).T
        return derivatives

    def _outside(self, x: Array, point: int) -> str:
        """Return why the run of these parameters has no value at a point of the data."""
        made = self._run(x)[1]
        if made is None or self.grid is None:
            return "there is no curve at the parameters to start from: their run fails"
        words = _core.off_grid(self.curve[0], made.history[self.curve[0]], self.grid, point)
        return words or "the curve is NaN at the parameters to start from"


class Models(_Fitted):
    """Models of several tests that share parameters: parameters with the same name have the same value.

    The curves of the models are joined in their order, as are data and deviations of :meth:`fit`:
    ``Models([a, b]).fit(np.concatenate([data_a, data_b]), sigma=np.concatenate([sigma_a, sigma_b]))``. The deviations weight the
    tests against each other. If bounds differ, the narrower ones apply. Each start value is that of the first model that has one.
    """

    def __init__(self, models: Iterable[Model]) -> None:
        self.models = list(models)
        self.names = list(dict.fromkeys(name for model in self.models for name in model.names))
        places = {name: k for k, name in enumerate(self.names)}
        #: indices of each model's parameters among all
        self._places = [np.array([places[name] for name in model.names], dtype=int) for model in self.models]
        self.x0 = np.full(len(self.names), np.nan)
        self._is_log = np.zeros(len(self.names), dtype=bool)
        self.bounds = [(-np.inf, np.inf)] * len(self.names)
        problems = [] if self.models else [("models", "are none")]
        for number, (model, own) in enumerate(zip(self.models, self._places)):
            for k, start, is_log, bound in zip(own.tolist(), model.x0.tolist(), model._is_log.tolist(), model.bounds):
                name, place = self.names[k], f"models[{number}].parameters[{self.names[k]!r}]"
                is_new = not any(name in other.names for other in self.models[:number])
                if not is_new and is_log != self._is_log[k]:
                    problems.append((place, "is a logarithm in some models only"))
                self._is_log[k] = is_log
                self.x0[k] = start if np.isnan(self.x0[k]) else self.x0[k]
                low, high = max(bound[0], self.bounds[k][0]), min(bound[1], self.bounds[k][1])
                if not low < high:
                    problems.append((place, f"{low} is not below {high}: its bounds exclude those of the models before"))
                self.bounds[k] = (low, high)
        if problems:
            raise CaseError(problems)

    def _of(self, x: ArrayLike) -> Iterable[tuple[Model, NDArray[np.int_], Array]]:
        """Return the models, the indices of their parameters, and their values."""
        values = np.atleast_1d(array_of(x, "x"))
        if values.shape != (len(self.names),):
            raise CaseError(f"{len(self.names)} parameters ({', '.join(self.names)}) are needed, the shape is {values.shape}")
        return [(model, own, values[own]) for model, own in zip(self.models, self._places)]

    def __call__(self, x: ArrayLike) -> Array:
        """Return the curves of these parameters, joined in the order of the models."""
        return np.concatenate([model(values) for model, _, values in self._of(x)])

    def jac(self, x: ArrayLike) -> Array:
        """Return the derivatives of the curves (rows) with respect to the parameters (columns); see :meth:`Model.jac`."""
        blocks = []
        for model, own, values in self._of(x):
            of_model = model.jac(values)
            block = np.zeros((len(of_model), len(self.names)))
            block[:, own] = of_model
            blocks.append(block)
        return np.concatenate(blocks)

    def _outside(self, x: Array, point: int) -> str:
        for model, _, values in self._of(x):
            length = len(model(values))
            if point < length:
                return model._outside(values, point)
            point -= length
        return "there is no such point"

def _on_grid(name: str, along: Array, values: Array, grid: Array) -> Array:
    """Interpolate the second column of a run on values of the first, branch by branch if these have reversals."""
    found, warning = _core.on_grid(name, along, values, grid)
    if warning is not None:
        warnings.warn(warning, stacklevel=2)
    return found


def _in_threads(work: Callable[..., Array | None], *rows: Iterable[Any], stop: _core.Stop, workers: int | None) -> list[Array | None]:
    """Return the curves of rows of arguments."""
    with ThreadPoolExecutor(workers) as threads:
        try:
            return list(threads.map(work, *rows))
        except BaseException:
            # threads do not receive Ctrl-C, and their other runs are useless
            stop.set()
            raise


def _number(document: Any, path: str) -> float:
    """Return the number at a place of a case, such as ``steps[0].target.e11``."""
    for part in _core.dotted(path).split("."):
        try:
            document = document[int(part)] if isinstance(document, list) else document[part]
        except (KeyError, IndexError, ValueError, TypeError):
            return float("nan")
    return float(document) if isinstance(document, (int, float)) else float("nan")
