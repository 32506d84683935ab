"""The lab: a law's parameters and curves in the browser, or in a notebook."""

from __future__ import annotations

import atexit
import html
import json
import os
import queue
import subprocess
import tempfile
import threading
import webbrowser
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Iterable, Mapping, Union

from . import _core
from .case import Case
from .errors import CaseError, PulloutError
from .law import Law

__all__ = ["Lab", "Subject", "lab"]

#: subject of a lab
Subject = Union[Law, Case, Mapping[str, Any], str, "os.PathLike[str]", None]


class Lab:
    """A running lab, whose page a notebook shows. It ends with ``close``, at the end of its ``with`` block, or with
    the interpreter."""

    def __init__(self, child: subprocess.Popen[str], address: str, height: int) -> None:
        self._child, self._owner = child, os.getpid()
        #: the page's address for a browser on this machine, with the token
        self.address = address
        #: height of the page in a notebook, in pixels
        self.height = height
        atexit.register(self.close)

    @property
    def is_open(self) -> bool:
        """Whether the lab is still running."""
        return self._child.poll() is None

    def open(self) -> None:
        """Show the page in the desktop's browser."""
        webbrowser.open(self.address)

    def close(self) -> None:
        """End the lab."""
        atexit.unregister(self.close)
        # a copy of this process by fork does not own it
        if self._owner == os.getpid() and self.is_open:
            _end(self._child)

    def __enter__(self) -> Lab:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Lab {self.address}>" if self.is_open else "<Lab, closed>"

    def _repr_html_(self) -> str:
        if not self.is_open:
            return html.escape(repr(self))
        # a frame of another site gets no cookies: the path contains the token
        origin, token = self.address.split("?token=")
        return f'<iframe src="{origin}{token}/" style="width: 100%; height: {self.height}px; border: 0"></iframe>'


def lab(
    subject: Subject = None,
    *,
    port: int = 0,
    plugin_paths: Iterable[str | os.PathLike[str]] = (),
    height: int = 900,
) -> Lab:
    """Open a lab, like ``pullout lab``: sliders for a law's parameters, its curves, and the verdict of the checks.

    ``subject``: a law's name, a :class:`Law`, a source (Fortran, C, C++) or library, or a case as a file, a dictionary or a
    :class:`Case`. A source is built again whenever it is saved. ``port``: 0 chooses any free port. ``height``: height of the page
    in a notebook, in pixels.

    The lab listens on 127.0.0.1 of the machine that runs Python. If the browser is on another machine, forward the port.
    """
    command: list[str | Path] = [_core.program(), "lab", "--no-open", f"--port={port}", f"--parent={os.getpid()}"]
    folder, text = Path().absolute(), ""
    if isinstance(subject, Law):
        subject = _case_of(subject)
    if isinstance(subject, (Case, Mapping)):
        case = Case(subject, plugin_paths=plugin_paths)
        file, _, folder, _, plugin_paths = case._parts()
        text = json.dumps({"title": "case" if file is None else file.stem, **case.document})
        subject = "/dev/stdin"
    command += [f"--plugin-path={Path(path).absolute()}" for path in plugin_paths]
    command += [] if subject is None else ["--", os.fspath(subject)]
    with tempfile.TemporaryFile("w+") as complaints:
        child = _started(command, folder, complaints)
        assert child.stdin is not None and child.stdout is not None
        try:
            with child.stdin as pipe:
                pipe.write(text)
        except BrokenPipeError:
            # it has ended, and said why
            pass
        with child.stdout as pipe:
            address = pipe.readline().strip()
        if not address:
            code = child.wait()
            complaints.seek(0)
            words = complaints.read().strip() or f"the lab ended with exit code {code}"
            # exit code 2 means bad input
            raise CaseError(words) if code == 2 else PulloutError(words)
    return Lab(child, address, height)


def _case_of(law: Law) -> dict[str, Any] | str:
    """Return the subject for the lab of a law: its name or, for the user's own library, a case without steps."""
    if _core.is_shipped(law.path):
        return law.name
    material: dict[str, Any] = {"plugin": os.fspath(law.path), "nstatv": law.nstatv, "props": []}
    _, _, name, _, _ = law._recipe
    material |= {} if name is None else {"cmname": name.upper()}
    return {"kind": "point", "title": law.name, "material": material, "mode": "3d", "steps": []}


def _started(command: list[str | Path], folder: Path, complaints: IO[str]) -> subprocess.Popen[str]:
    """Start a child that ends with this process, however that ends. The system ends the child with the thread that started it, so the
    thread stays."""
    made: queue.SimpleQueue[subprocess.Popen[str] | OSError] = queue.SimpleQueue()

    def start() -> None:
        pipe = subprocess.PIPE
        try:
            # Ctrl-C of a terminal is for this process
            child = subprocess.Popen(
                command, cwd=folder, stdin=pipe, stdout=pipe, stderr=complaints, text=True, start_new_session=True
            )
        except OSError as error:
            made.put(error)
            return
        made.put(child)
        child.wait()

    threading.Thread(target=start, name="pullout lab", daemon=True).start()
    child = made.get()
    if isinstance(child, OSError):
        raise PulloutError(f"the lab cannot be started: {child}")
    return child


def _end(child: subprocess.Popen[str]) -> None:
    child.terminate()
    try:
        child.wait(5.0)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
