"""Errors. Every error is a :class:`PulloutError`, and also the builtin exception that fits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence, cast

if TYPE_CHECKING:
    from .case import Case
    from .run import Run

__all__ = [
    "CaseError",
    "PluginCrashed",
    "PluginError",
    "PulloutError",
    "RunFailed",
    "Stopped",
    "TimeLimit",
    "UpdateFailed",
]


class PulloutError(Exception):
    """Base class: the engine refused or failed."""


class CaseError(PulloutError, ValueError):
    """A case or an argument is wrong.

    ``problems`` lists all errors as pairs of the place in the case (``$.steps[0].target``) and the message. ``kinds`` has one entry
    for each: "input" (another value may be right at this place), "structure" (the case has no such place, or needs something else
    there) or "plugin" (a library cannot be loaded).
    """

    problems: list[tuple[str, str]]
    kinds: list[str]

    def __init__(self, problems: str | Sequence[tuple[str, str]], kinds: Sequence[str] | None = None) -> None:
        self.problems = [("$", problems)] if isinstance(problems, str) else list(problems)
        self.kinds = ["input"] * len(self.problems) if kinds is None else list(kinds)
        words = [message if place == "$" else f"{place}: {message}" for place, message in self.problems]
        super().__init__("\n".join(words))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.problems, self.kinds)


class PluginError(PulloutError, OSError):
    """A plugin cannot be found or loaded, or must not be loaded here."""


class RunFailed(PulloutError, RuntimeError):
    """A run failed.

    ``run`` has the results so far. It is ``None`` in errors of :meth:`Law.evaluate`, which has no run. ``replay`` is a case that
    repeats the failed increment or call, if it can be repeated.
    """

    run: Run

    def __init__(self, message: str, run: Run | None = None, replay: Case | None = None) -> None:
        super().__init__(message)
        self.run = cast("Run", run)
        self.replay = replay

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.run, self.replay)


class Stopped(RunFailed):
    """A run was stopped by ``pullout_fe.Stop``. If it had started, ``run`` has its results so far."""


class PluginCrashed(RunFailed):
    """A plugin ended its process."""


class TimeLimit(RunFailed):
    """A plugin call did not return in time."""


class UpdateFailed(RunFailed):
    """Points of :meth:`Law.evaluate` that the law did not update.

    ``points`` has for each the index, the reason, and the fraction of the increment to try next (``None``: no fraction helps).
    """

    points: list[tuple[int, str, float | None]]

    def __init__(self, name: str, points: Sequence[tuple[int, str, float | None]]) -> None:
        self.name = name
        self.points = list(points)
        first, words, _ = self.points[0]
        others = f", and {len(self.points) - 1} more points" if len(self.points) > 1 else ""
        super().__init__(f"{name}, point {first}: {words}{others}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.name, self.points)
