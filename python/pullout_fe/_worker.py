"""Call untrusted libraries in a process of their own, which they may end."""

from __future__ import annotations

import atexit
import mmap
import multiprocessing.connection
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from .errors import PluginCrashed, TimeLimit

Array = NDArray[np.float64]
Connection = multiprocessing.connection.Connection

#: number of unused helpers that are kept, since the next law of a library may come soon
MOST_IDLE = 4
#: alignment of arrays, bytes
ALIGNMENT = 64
#: time that the library of a helper has to finish its analysis after the helper was asked to end, s
PATIENCE = 1.0


class RemotePlugin:
    """A plugin in another process, with the methods of ``_core.Plugin``. All of a library share one :class:`_Helper`."""

    def __init__(self, path: Path, law: str | None, time_limit: float, about: str | None = None) -> None:
        self._law, self._time_limit, self._about = law, time_limit, about
        self._helper = _helper_of(path)

    def describe(self) -> str:
        if self._about is None:
            self._about = str(self._ask("describe"))
        return self._about

    def props(self, props: str) -> list[float]:
        return list(self._ask("props", props))

    def needs_length(self, props: Array) -> str | None:
        answer: str | None = self._ask("needs_length", props)
        return answer

    def initial(self, mode: str, coords: Array, per_element: int, stress: Array, state: Array, frame: str = "") -> None:
        self._ask("initial", mode, per_element, frame, inputs={"coords": coords}, results={"stress": stress, "state": state})

    def evaluate(
        self,
        mode: str,
        arrays: Mapping[str, Array],
        time: tuple[float, float],
        per_element: int,
        threads: int,
        may_refuse: bool,
        frame: str = "",
    ) -> tuple[list[tuple[int, str, float | None]], str | None]:
        results = {name: arrays[name] for name in ("stress", "state", "tangent", "energies", "heat") if name in arrays}
        inputs = {name: array for name, array in arrays.items() if name not in results}
        answer: tuple[list[tuple[int, str, float | None]], str | None] = self._ask(
            "evaluate", mode, time, per_element, threads, may_refuse, frame, inputs=inputs, results=results
        )
        return answer

    def _ask(self, method: str, *arguments: Any, inputs: Mapping[str, Array] = {}, results: Mapping[str, Array] = {}) -> Any:
        return self._helper.ask(self._law, self._time_limit, (method, *arguments), inputs, results)

    def __del__(self) -> None:
        if hasattr(self, "_helper"):
            _leave(self._helper)


class _Helper:
    """A process that calls a library for all its laws in this process. If it ended, the next call starts it again."""

    def __init__(self, path: Path) -> None:
        self.path = path
        #: laws that refer to it
        self.users = 0
        #: whether the next call is the first of an analysis: the earlier laws are gone
        self.is_fresh = False
        self._child: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        #: shared memory for arrays; those that a call changes go in both directions
        self._memory: mmap.mmap | None = None
        self._descriptor = -1
        # a message and its answer belong together
        self._turn = threading.Lock()

    def ask(
        self, law: str | None, time_limit: float, call: tuple[Any, ...], inputs: Mapping[str, Array], results: Mapping[str, Array]
    ) -> Any:
        """Return the answer to a call. If there is one, ``results`` are written."""
        with self._turn:
            try:
                if self.is_fresh and self._connection is not None:
                    self._connection.send(None)
                self.is_fresh = False
                if self._child is None or self._child.poll() is not None:
                    self._start()
                assert self._connection is not None
                places, size = _places({**inputs, **results})
                memory = self._room(size)
                for name, place in places.items():
                    # these are not read
                    if name not in ("tangent", "heat"):
                        _view(memory, place)[...] = inputs.get(name, results.get(name))
                self._connection.send((law, call, places, len(memory)))
                if not self._connection.poll(time_limit):
                    raise TimeLimit(f"{self.path}: it did not come back within {time_limit:g} s")
                is_good, answer = self._connection.recv()
                for name, array in results.items() if is_good else ():
                    array[...] = _view(memory, places[name])
            except (EOFError, ConnectionError):
                raise PluginCrashed(f"{self.path}: it ended its process, {self._ending()}") from None
            except BaseException:
                self.end()
                raise
        if is_good:
            return answer
        raise answer

    def _room(self, size: int) -> mmap.mmap:
        if self._memory is None or len(self._memory) < size:
            size = max(size, 1 << 16)
            os.ftruncate(self._descriptor, size)
            self._memory = mmap.mmap(self._descriptor, size)
        return self._memory

    def _start(self) -> None:
        self.end()
        ours, theirs = socket.socketpair()
        self._descriptor = _memory_file()
        with theirs:
            shared = [theirs.fileno(), self._descriptor]
            command = [sys.executable, "-c", f"from {__name__} import main; main()", *map(str, shared)]
            folder = str(Path(__file__).resolve().parent.parent)
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [folder, os.environ.get("PYTHONPATH")]))}
            self._child = subprocess.Popen(command, pass_fds=shared, env=environment, stdin=subprocess.DEVNULL)
        self._connection = Connection(ours.detach())
        self._connection.send(self.path)
        # the start of Python is not the library's time
        self._connection.recv()

    def _ending(self) -> str:
        """Return a text with the reason why the child ended."""
        assert self._child is not None
        try:
            code = self._child.wait(5.0)
        except subprocess.TimeoutExpired:
            self.end()
            return "or closed what it answers by"
        if code >= 0:
            return f"with exit code {code}"
        try:
            return f"by {signal.Signals(-code).name}"
        except ValueError:
            return f"by signal {-code}"

    def end(self, is_kind: bool = False) -> None:
        """End the process. ``is_kind``: the library may finish its analysis first."""
        child, self._child = self._child, None
        if child is not None and is_kind:
            try:
                assert self._connection is not None
                self._connection.send(None)
                self._connection.send("end")
                child.wait(PATIENCE)
            except (OSError, subprocess.TimeoutExpired):
                pass
        self.forget()
        if child is not None:
            child.kill()
            child.wait()

    def forget(self) -> None:
        """Release the process without ending it: after a fork it belongs to the parent."""
        if self._connection is not None:
            self._connection.close()
        if self._descriptor >= 0:
            os.close(self._descriptor)
        self._child, self._connection, self._memory, self._descriptor = None, None, None, -1


#: helpers by the library's file and its content; the one that was used last comes last
_HELPERS: dict[tuple[Any, ...], _Helper] = {}
#: reentrant: a law may be collected while the lock is held
_LOCK = threading.RLock()


def _helper_of(path: Path) -> _Helper:
    about = path.stat()
    key = (path, about.st_dev, about.st_ino, about.st_size, about.st_mtime_ns)
    with _LOCK:
        helper = _HELPERS.pop(key, None) or _Helper(path)
        _HELPERS[key] = helper
        helper.is_fresh |= helper.users == 0
        helper.users += 1
    return helper


def _leave(helper: _Helper) -> None:
    """Release a helper of a law that is gone."""
    with _LOCK:
        helper.users -= 1
        idle = [key for key, other in _HELPERS.items() if other.users == 0]
        ended = [_HELPERS.pop(key) for key in idle[:-MOST_IDLE]]
    for other in ended:
        other.end(is_kind=True)


def _end_all() -> None:
    for helper in _HELPERS.values():
        helper.end(is_kind=True)


def _after_fork() -> None:
    global _LOCK
    _LOCK = threading.RLock()
    for helper in _HELPERS.values():
        helper.forget()
        helper._turn = threading.Lock()


atexit.register(_end_all)
os.register_at_fork(after_in_child=_after_fork)


def _memory_file() -> int:
    """Open a file without a name, in memory if the system supports that."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create("pullout")
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())


def _places(arrays: Mapping[str, Array]) -> tuple[dict[str, tuple[int, tuple[int, ...]]], int]:
    """Return offsets and shapes of arrays that follow one another, and the total length in bytes."""
    places, offset = {}, 0
    for name, array in arrays.items():
        places[name] = (offset, array.shape)
        offset += -(-array.nbytes // ALIGNMENT) * ALIGNMENT
    return places, offset


def _view(memory: mmap.mmap, place: tuple[int, tuple[int, ...]]) -> Array:
    offset, shape = place
    return np.ndarray(shape, np.float64, memory, offset) if np.prod(shape) else np.zeros(shape)


def _serve(connection: Connection, descriptor: int) -> None:
    """Answer calls until asked to end, or until the other end is closed."""
    from . import _core

    path = connection.recv()
    connection.send(None)
    plugins: dict[str | None, Any] = {}
    memory: mmap.mmap | None = None
    while (message := connection.recv()) != "end":
        if message is None:
            # the analysis of the laws so far is over
            plugins.clear()
            continue
        law, (method, *arguments), places, size = message
        try:
            if memory is None or len(memory) != size:
                memory = mmap.mmap(descriptor, size)
            if law not in plugins:
                plugins[law] = _core.Plugin(path, law, True, True)
            arrays = {name: _view(memory, place) for name, place in places.items()}
            if method == "evaluate":
                mode, *others = arguments
                arguments = [mode, arrays, *others]
            elif method == "initial":
                mode, per_element, frame = arguments
                arguments = [mode, arrays["coords"], per_element, arrays["stress"], arrays["state"], frame]
            connection.send((True, getattr(plugins[law], method)(*arguments)))
        except Exception as error:
            connection.send((False, error))


def main() -> None:
    """Run the helper."""
    from . import _core

    # Ctrl-C is for the parent, which ends this process
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    descriptor, memory = map(int, sys.argv[1:])
    connection = Connection(descriptor)

    def watch() -> None:
        """End this process with its parent, even during a call that never returns."""
        hangup = select.poll()
        hangup.register(descriptor, 0)
        hangup.poll()
        os._exit(1)

    def answer_calls() -> None:
        try:
            _serve(connection, memory)
        except (EOFError, ConnectionError):
            pass

    threading.Thread(target=watch, daemon=True).start()
    # the library is called on this thread, with the stack that it may want
    threading.stack_size(_core.STACK)
    server = threading.Thread(target=answer_calls)
    server.start()
    server.join()
