from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, final

from numpy import float64, int64
from numpy.typing import NDArray

__all__ = [
    "Plugin",
    "STACK",
    "STARTS",
    "Stop",
    "Trail",
    "UTILITIES",
    "VERSION",
    "check",
    "collect",
    "document",
    "dotted",
    "examples",
    "find",
    "is_shipped",
    "least_squares",
    "main",
    "off_grid",
    "on_grid",
    "plugins",
    "program",
    "run",
    "schema",
    "set_program",
    "sha256",
    "unit",
]

VERSION: str
STARTS: int
UTILITIES: str
STACK: int

_Parts = tuple[Path | None, str | None, Path, list[str], list[Path]]

@final
class Plugin:
    def __new__(cls, path: str | PathLike[str], law: str | None = None, in_process: bool = False, has_stack: bool = False) -> Plugin: ...
    def describe(self) -> str: ...
    def props(self, props: str) -> list[float]: ...
    def needs_length(self, props: NDArray[float64]) -> str | None: ...
    def initial(
        self,
        mode: str,
        coords: NDArray[float64],
        per_element: int,
        stress: NDArray[float64],
        state: NDArray[float64],
        frame: str = "",
    ) -> None: ...
    def evaluate(
        self,
        mode: str,
        arrays: Mapping[str, NDArray[float64]],
        time: tuple[float, float],
        per_element: int,
        threads: int,
        may_refuse: bool,
        frame: str = "",
    ) -> tuple[list[tuple[int, str, float | None]], str | None]: ...

def find(name: str) -> Path: ...
def plugins() -> list[str]: ...
def is_shipped(path: str | PathLike[str]) -> bool: ...
def main(arguments: list[str]) -> int: ...
def sha256(path: str | PathLike[str]) -> str: ...
def set_program(file: str | PathLike[str], module: str | PathLike[str]) -> None: ...
def program() -> Path: ...
def examples(words: list[str]) -> list[tuple[Path, str, str]]: ...
def unit(column: str) -> str: ...
def schema() -> str: ...
def dotted(path: str) -> str: ...
def least_squares(
    residuals: Callable[[list[float]], NDArray[float64]],
    derivatives: Callable[[list[float]], NDArray[float64]],
    ranges: list[tuple[float, float, bool]],
    start: list[float],
    limits: tuple[int, int],
    scale: float,
    is_known: bool,
) -> tuple[list[float], list[float], list[list[float]], float, list[float | None], str | None]: ...
def off_grid(name: str, x: NDArray[float64], grid: NDArray[float64], point: int) -> str | None: ...
def on_grid(name: str, x: NDArray[float64], y: NDArray[float64], grid: NDArray[float64]) -> tuple[NDArray[float64], str | None]: ...
def document(case: _Parts) -> str: ...
def check(case: _Parts) -> list[str]: ...
def collect(
    folder: str | PathLike[str],
) -> list[tuple[str, NDArray[float64] | NDArray[int64] | list[str] | list[NDArray[float64]]]]: ...
@final
class Stop:
    def __new__(cls) -> Stop: ...
    def set(self) -> None: ...
    def is_set(self) -> bool: ...

@final
class Trail:
    def together(self, count: int) -> list[Trail]: ...
    def leave(self) -> None: ...

def run(
    case: _Parts,
    threads: int,
    listener: Callable[[float, dict[str, float]], Any] | None,
    in_process: bool,
    along: Trail | None,
    keeps: tuple[bool, bool],
    stop: Stop | None,
    fields: str | PathLike[str] | None,
) -> tuple[list[tuple[str, str, NDArray[float64]]], dict[str, str], bool, Trail | None]: ...
