"""Constitutive laws, material points and fibre pull-out: the engine of the program ``pullout`` in Python."""

from __future__ import annotations

import sys
from pathlib import Path

from . import _core
from ._core import Stop
from .case import Case, Example, examples, schema
from .errors import (
    CaseError,
    PluginCrashed,
    PluginError,
    PulloutError,
    RunFailed,
    Stopped,
    TimeLimit,
    UpdateFailed,
)
from .lab import Lab, lab
from .law import Heat, Law, Parameter, State, Update, plugins
from .model import Fit, Model, Models
from .fields import Mesh
from .run import Failure, History, Peak, Run, View, point, ramp, read, run, table
from .sweep import Sweep, sweep

__all__ = [
    "Case",
    "CaseError",
    "Example",
    "Failure",
    "Fit",
    "Heat",
    "History",
    "Lab",
    "Law",
    "Mesh",
    "Model",
    "Models",
    "Parameter",
    "Peak",
    "PluginCrashed",
    "PluginError",
    "PulloutError",
    "Run",
    "RunFailed",
    "State",
    "Stop",
    "Stopped",
    "Sweep",
    "TimeLimit",
    "Update",
    "UpdateFailed",
    "View",
    "__version__",
    "examples",
    "lab",
    "plugins",
    "point",
    "program",
    "ramp",
    "read",
    "run",
    "schema",
    "sweep",
    "table",
]

__version__: str = _core.VERSION


def program() -> Path:
    """Path of the program ``pullout`` installed with this package."""
    # lib/python3.*/site-packages/pullout_fe, or the target folder of pip
    package = Path(__file__).resolve().parent
    for prefix in (*package.parents[3:4], Path(sys.prefix), package.parent):
        if _core.is_shipped(prefix / "lib" / "pullout" / _core.UTILITIES):
            return prefix / "bin" / "pullout"
    raise PulloutError("the program pullout is not installed next to this package")


try:
    _core.set_program(program(), _core.__file__)
except PulloutError:
    # laws and runs work without it
    pass
