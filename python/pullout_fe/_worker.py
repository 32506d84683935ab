"""Calls of libraries that nobody vouches for: in a process of their own, which they may end."""

from __future__ import annotations

import multiprocessing.connection
import os
import select
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import PluginCrashed, PluginError, TimeLimit

Connection = multiprocessing.connection.Connection


class RemotePlugin:
    """A plugin in a child process, with the methods of ``_core.Plugin``. One that ended is started again by the next call."""

    def __init__(self, path: Path, law: str | None, time_limit: float) -> None:
        self._path, self._law, self._time_limit = path, law, time_limit
        self._child: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        # a message and its answer belong together
        self._turn = threading.Lock()

    def describe(self) -> str:
        return str(self._ask("describe"))

    def props(self, props: str) -> list[float]:
        return list(self._ask("props", props))

    def needs_length(self, props: NDArray[np.float64]) -> str | None:
        answer: str | None = self._ask("needs_length", props)
        return answer

    def evaluate(
        self,
        mode: str,
        props: NDArray[np.float64],
        strain: NDArray[np.float64],
        dstrain: NDArray[np.float64],
        stress: NDArray[np.float64],
        state: NDArray[np.float64],
        tangent: NDArray[np.float64] | None,
        lengths: NDArray[np.float64] | None,
        time: tuple[float, float],
        threads: int,
    ) -> list[tuple[int, str, float | None]]:
        arguments = (mode, props, strain, dstrain, stress, state, tangent, lengths, time, threads)
        refused, arrays = self._ask("evaluate", *arguments)
        for own, answer in zip((stress, state, tangent), arrays):
            if own is not None:
                own[...] = answer
        return list(refused)

    def _ask(self, method: str, *arguments: Any) -> Any:
        with self._turn:
            try:
                if self._child is None or self._child.poll() is not None:
                    self._start()
                assert self._connection is not None
                self._connection.send((method, arguments))
                if not self._connection.poll(self._time_limit):
                    raise TimeLimit(f"{self._path}: it did not come back within {self._time_limit:g} s")
                is_good, answer = self._connection.recv()
            except (EOFError, ConnectionError):
                raise PluginCrashed(f"{self._path}: it ended its process, {self._ending()}") from None
            except BaseException:
                self._end()
                raise
        if is_good:
            return answer
        raise answer

    def _start(self) -> None:
        ours, theirs = socket.socketpair()
        with theirs:
            command = [sys.executable, "-c", f"from {__name__} import main; main()", str(theirs.fileno())]
            folder = str(Path(__file__).resolve().parent.parent)
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [folder, os.environ.get("PYTHONPATH")]))}
            self._child = subprocess.Popen(command, pass_fds=[theirs.fileno()], env=environment, stdin=subprocess.DEVNULL)
        self._connection = Connection(ours.detach())
        self._connection.send((self._path, self._law))
        # the start of Python is not the library's time
        self._connection.recv()

    def _ending(self) -> str:
        """Why the child is gone, in words."""
        assert self._child is not None
        try:
            code = self._child.wait(5.0)
        except subprocess.TimeoutExpired:
            self._end()
            return "or closed what it answers by"
        if code >= 0:
            return f"with exit code {code}"
        try:
            return f"by {signal.Signals(-code).name}"
        except ValueError:
            return f"by signal {-code}"

    def _end(self) -> None:
        if self._connection is not None:
            self._connection.close()
        if self._child is not None:
            self._child.kill()
            self._child.wait()
        self._child = self._connection = None

    def __del__(self) -> None:
        self._end()


def _serve(connection: Connection) -> None:
    """Answers until the other end is closed."""
    from . import _core

    path, law = connection.recv()
    connection.send(None)
    plugin: Any = None
    while True:
        method, arguments = connection.recv()
        try:
            if plugin is None:
                plugin = _core.Plugin(path, law, True)
            answer = getattr(plugin, method)(*arguments)
            if method == "evaluate":
                _, _, _, _, stress, state, tangent, *_ = arguments
                answer = answer, (stress, state, tangent)
            connection.send((True, answer))
        except Exception as error:
            connection.send((False, error))


def main() -> None:
    """What the child does."""
    # Ctrl-C is for the parent, which ends this process
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    descriptor = int(sys.argv[1])
    connection = Connection(descriptor)

    def watch() -> None:
        """Ends this process with its parent, also in a call that does not come back."""
        hangup = select.poll()
        hangup.register(descriptor, 0)
        hangup.poll()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    try:
        _serve(connection)
    except (EOFError, ConnectionError):
        pass
