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
#: a parameter closer to a bound than this fraction of the distance between the bounds lies on it
ON_BOUND = 1e-6


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

    def fit(self, data: ArrayLike, sigma: ArrayLike | None = None, x0: ArrayLike | None = None, *, starts: int = 1, **options: Any) -> Fit:
        """Fit the parameters to data by ``scipy.optimize.least_squares``, which receives ``options``.

        ``starts``: number of starting points, ``x0`` and others between the ``bounds``, as in ``pullout fit``. The best result counts.

        The covariance assumes data errors of ``sigma``. Without ``sigma`` it assumes errors as large as the remaining differences, as in
        ``pullout fit``.
        """
        from scipy.optimize import least_squares

        start = self.x0 if x0 is None else array_of(x0, "x0")
        if start.shape != self.x0.shape:
            raise CaseError([("x0", f"has the shape {start.shape}, {self.x0.shape} is needed")])
        if not np.all(np.isfinite(start)):
            missing = [name for name, value in zip(self.names, start) if not np.isfinite(value)]
            raise CaseError(f"the case does not say {', '.join(missing)}: give x0")
        starts = whole(starts, "starts")
        logarithmic = self._is_log
        target = array_of(data, "data")
        deviations = array_of(1.0 if sigma is None else sigma, "sigma")
        if np.isinf(target).any() or np.isnan(target).all():
            raise CaseError([("data", "has no finite number" if np.isnan(target).all() else "is infinite: NaN is what is not known")])
        if not np.all(np.isfinite(deviations) & (deviations > 0.0)):
            raise CaseError([("sigma", "is a finite number > 0, or one for each point")])
        weight = np.where(np.isnan(target), 0.0, 1.0) / deviations
        freedom = int(np.count_nonzero(~np.isnan(target))) - len(self.names)
        if sigma is None and freedom < 1:
            raise CaseError(f"{freedom + len(self.names)} points cannot determine errors of {len(self.names)} parameters: give sigma")

        def outer(z: Array) -> Array:
            return np.where(logarithmic, np.exp(np.where(logarithmic, z, 0.0)), z)

        def inner(x: Array) -> Array:
            return np.where(logarithmic, np.log(np.where(logarithmic, x, 1.0)), x)

        def derivatives(z: Array) -> Array:
            x = outer(z)
            matrix: Array = self.jac(x) * weight[:, None] * np.where(logarithmic, x, 1.0)
            return matrix

        runs = 0

        def residual(z: Array) -> Array:
            nonlocal runs
            runs += 1
            found = self.residual(outer(z), target, deviations)
            if runs == 1 and np.isnan(found).any():
                raise CaseError([("data", self._outside(start, int(np.argmax(np.isnan(found)))))])
            return found

        lower, upper = (np.array([bound[side] for bound in self.bounds], dtype=float) for side in (0, 1))
        with np.errstate(divide="ignore"):
            # logarithms need positive bounds
            limits = [inner(np.where(logarithmic, np.maximum(lower, 0.0), lower)), inner(upper)]
        unbounded = [name for name, bound in zip(self.names, self.bounds) if not np.all(np.isfinite(bound))]
        if starts > 1 and unbounded:
            raise CaseError([("starts", f"lie between bounds: give those of {', '.join(unbounded)}")])

        def search(begin: Array) -> Any:
            return least_squares(residual, inner(begin), derivatives, bounds=(limits[0], limits[1]), x_scale="jac", **options)

        found = search(start)
        of_derivatives = int(found.njev or 0)
        for number in range(1, starts):
            begin = np.array(_core.place_between(np.transpose([outer(limit) for limit in limits]).tolist(), number))
            try:
                other = search(begin)
            except (PulloutError, ValueError):
                # the case does not run there
                continue
            of_derivatives += int(other.njev or 0)
            found = min(found, other, key=lambda end: float(end.cost))
        values = outer(found.x)
        jacobian = np.asarray(found.jac) / np.where(logarithmic, values, 1.0)
        scatter = 1.0 if sigma is not None else float(np.sqrt(2.0 * found.cost / freedom))
        covariance, unknown = _covariance(jacobian, values, scatter)
        errors = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore", divide="ignore"):
            correlations = covariance / np.outer(errors, errors)
        on_bound = {}
        for name, value, (low, high) in zip(self.names, values.tolist(), self.bounds):
            near = ON_BOUND * (high - low if np.isfinite(high - low) else abs(value))
            on_bound.update({name: float(bound) for bound in (low, high) if abs(bound - value) <= near})
        return Fit(
            dict(zip(self.names, values.tolist())),
            covariance,
            correlations,
            [name for name, is_unknown in zip(self.names, unknown) if is_unknown],
            float(found.cost),
            runs + of_derivatives * (1 + len(self.names)),
            on_bound,
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


def _covariance(jacobian: Array, values: Array, scatter: float) -> tuple[Array, NDArray[np.bool_]]:
    """Return the covariance for residuals with this scatter, and a mask of the parameters that it does not cover: those of directions
    that change nothing."""
    scale = np.where(values == 0.0, 1.0, np.abs(values))
    _, singular, directions = np.linalg.svd(jacobian * scale, full_matrices=False)
    # a relative change of 1 that moves the curve by less than a thousandth of a standard deviation is not seen
    is_seen = singular > max(1e-3 * scatter, 1e-9 * float(singular.max(initial=0.0)))
    unknown: NDArray[np.bool_] = np.any(np.abs(directions[~is_seen]) > 0.1, axis=0)
    inverse = directions[is_seen].T @ np.diag(singular[is_seen] ** -2.0) @ directions[is_seen]
    covariance = inverse * np.outer(scale, scale) * scatter**2
    covariance[unknown, :] = np.nan
    covariance[:, unknown] = np.nan
    return covariance, unknown


def _number(document: Any, path: str) -> float:
    """Return the number at a place of a case, such as ``steps[0].target.e11``."""
    for part in _core.dotted(path).split("."):
        try:
            document = document[int(part)] if isinstance(document, list) else document[part]
        except (KeyError, IndexError, ValueError, TypeError):
            return float("nan")
    return float(document) if isinstance(document, (int, float)) else float("nan")
