from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any, final

from numpy import float64
from numpy.typing import NDArray

__all__ = [
    "Plugin",
    "Stop",
    "Trail",
    "UTILITIES",
    "VERSION",
    "check",
    "document",
    "dotted",
    "find",
    "is_shipped",
    "main",
    "place_between",
    "plugins",
    "program",
    "run",
    "schema",
    "set_program",
    "sha256",
    "unit",
]

VERSION: str
UTILITIES: str

_Parts = tuple[Path | None, str | None, Path, list[str], list[Path]]

@final
class Plugin:
    def __new__(cls, path: str | PathLike[str], law: str | None = None, in_process: bool = False) -> Plugin: ...
    def describe(self) -> str: ...
    def props(self, props: str) -> list[float]: ...
    def needs_length(self, props: NDArray[float64]) -> str | None: ...
    def evaluate(
        self,
        mode: str,
        props: NDArray[float64],
        strain: NDArray[float64],
        dstrain: NDArray[float64],
        stress: NDArray[float64],
        state: NDArray[float64],
        tangent: NDArray[float64] | None,
        lengths: NDArray[float64] | None,
        time: tuple[float, float],
        threads: int,
    ) -> list[tuple[int, str, float | None]]: ...

def find(name: str) -> Path: ...
def plugins() -> list[str]: ...
def is_shipped(path: str | PathLike[str]) -> bool: ...
def main(arguments: list[str]) -> int: ...
def sha256(path: str | PathLike[str]) -> str: ...
def set_program(file: str | PathLike[str], module: str | PathLike[str]) -> None: ...
def program() -> Path: ...
def unit(column: str) -> str: ...
def schema() -> str: ...
def dotted(path: str) -> str: ...
def place_between(bounds: list[list[float]], number: int) -> list[float]: ...
def document(case: _Parts) -> str: ...
def check(case: _Parts) -> list[str]: ...
@final
class Stop:
    def __new__(cls) -> Stop: ...
    def set(self) -> None: ...

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
) -> tuple[list[tuple[str, str, NDArray[float64]]], str, bool, str | None, str | None, Trail | None, str | None]: ...
