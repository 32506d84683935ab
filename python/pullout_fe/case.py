"""Cases: descriptions of runs."""

from __future__ import annotations

import html
import json
import operator
import os
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping, NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from .errors import CaseError

__all__ = ["Case", "CaseLike", "Example", "examples", "schema"]


#: type of array elements, as arrays hold it
FLOAT = np.dtype(np.float64)


def schema() -> dict[str, Any]:
    """Return the JSON schema of cases and studies."""
    made: dict[str, Any] = json.loads(_core.schema())
    return made


class Example(NamedTuple):
    """A case installed with the package."""

    path: Path
    #: "point", "interface", "pullout", "bridging", "study" or "sweep"
    kind: str
    title: str


def examples(*words: str) -> list[Example]:
    """List the cases of the package that have all these words in path, title or description.

    ``po.run(example.path)`` runs one. Those of kind "study" are for the command ``pullout study``.
    """
    return [Example(*found) for found in _core.examples(list(words))]


def array_of(values: Any, name: str) -> NDArray[np.float64]:
    """Return numbers as an array. Values that would lose information are refused: masks, imaginary parts, texts."""
    if type(values) is np.ndarray and values.dtype is FLOAT:
        return values
    if np.ma.isMaskedArray(values):
        raise CaseError([(name, "is a masked array: give what counts, or NaN in its place, by filled()")])
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biufO":
            raise TypeError(f"{array.dtype} is no type of real numbers")
        # a complex number among objects has no float
        return array.astype(float, copy=False)
    except (TypeError, ValueError) as error:
        raise CaseError([(name, f"is no array of real numbers: {error}")]) from None


def whole(value: Any, name: str, least: int = 1) -> int:
    """Return a count: an integer of at least ``least``."""
    try:
        number = operator.index(value)
    except TypeError:
        raise CaseError([(name, f"is {value!r}, but a whole number is needed")]) from None
    if number < least:
        raise CaseError([(name, f"is {least} or more")])
    return number


def _wrong_numbers(value: Any, place: str) -> Iterator[tuple[str, str]]:
    """Find the numbers that JSON cannot express, with their places."""
    if isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _wrong_numbers(entry, f"{place}.{key}")
    elif isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim > 0):
        for k, entry in enumerate(value):
            yield from _wrong_numbers(entry, f"{place}[{k}]")
    elif isinstance(value, (float, np.floating)) and not np.isfinite(value):
        yield place, f"is {value}, not a finite number"


def _plain(value: Any) -> Any:
    """Convert values that JSON does not know: arrays and numbers of NumPy, paths."""
    if np.ma.isMaskedArray(value):
        raise TypeError("a masked array has no place in a case: give what counts, by compressed()")
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a {type(value).__name__} has no place in a case")


def _text(value: Any, place: str = "$") -> str:
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise CaseError(list(_wrong_numbers(value, place)) or str(error)) from None


class Case:
    """A case: a file, or a dictionary in `the case format <case-format>`. A case file is read once, here; each run reads
    the files that the case names.

    ``folder``: file names in a dictionary are relative to it (default: the working directory). Plugins are searched
    for in ``plugin_paths`` first.
    """

    def __init__(
        self,
        source: CaseLike,
        *,
        folder: str | os.PathLike[str] | None = None,
        plugin_paths: Iterable[str | os.PathLike[str]] = (),
    ) -> None:
        self._file: Path | None = None
        self._document: str | None = None
        self._overrides: list[str] = []
        self._folder: Path
        self._plugin_paths: list[Path]
        paths = [Path(path).absolute() for path in plugin_paths]
        if isinstance(source, Case):
            self._file, self._document, self._overrides = source._file, source._document, list(source._overrides)
            self._folder, paths = source._folder, paths + source._plugin_paths
        elif isinstance(source, Mapping):
            self._document = _text(dict(source))
            self._folder = Path(folder or "").absolute()
        else:
            self._file = Path(source).absolute()
            self._folder = self._file.parent
            # later changes of the file have no effect
            try:
                self._document = _core.document((self._file, None, self._folder, [], []))
            except CaseError as error:
                raise CaseError([(place, f"{self._file}: {message}") for place, message in error.problems]) from None
        self._plugin_paths = paths

    def with_(self, changes: Mapping[str, Any]) -> Case:
        """Return the case with other values: ``{"material.props.E": 2e5, "steps[0].increments": 10}``."""
        changed = Case(self)
        changed._overrides += [f"{_core.dotted(path)}={_text(value, path)}" for path, value in changes.items()]
        return changed

    @property
    def document(self) -> dict[str, Any]:
        """The case as a dictionary, with all changes."""
        made: dict[str, Any] = json.loads(_core.document(self._parts()))
        return made

    def check(self) -> list[str]:
        """Check the whole case, and return its warnings.

        Raises :class:`CaseError` with all errors, or :class:`PluginError`. A case whose plugins run in a separate process is
        checked in one, which reports errors but no warnings.
        """
        return list(_core.check(self._parts()))

    def _parts(self) -> tuple[Path | None, str | None, Path, list[str], list[Path]]:
        return self._file, self._document, self._folder, self._overrides, self._plugin_paths

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Case) and self._parts() == other._parts()

    def __hash__(self) -> int:
        return hash((self._file, self._document, self._folder, *self._overrides))

    def __repr__(self) -> str:
        name = str(self._file) if self._file is not None else f"{self.document.get('kind', 'no kind')}"
        changes = f" with {', '.join(self._overrides)}" if self._overrides else ""
        return f"<Case {name}{changes}>"

    def _repr_html_(self) -> str:
        document = self.document
        title = html.escape(str(document.get("title", self._file or "case")))
        text = html.escape(json.dumps(document, indent=2, ensure_ascii=False))
        return f"<details><summary>{title}</summary><pre>{text}</pre></details>"


CaseLike = Union[Case, Mapping[str, Any], str, "os.PathLike[str]"]
