"""A page in headless Chromium, driven by the DevTools protocol over a pipe."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from types import TracebackType
from typing import Any

import pytest


class Browser:
    """One page of a Chromium of its own, which ends with the block."""

    def __init__(self, place: Path, size: tuple[int, int] = (1280, 900), *options: str) -> None:
        program = shutil.which("chromium")
        if program is None:
            assert not os.environ.get("PULLOUT_REQUIRE_CHROMIUM")
            pytest.skip("no chromium")
        hear, self._say = os.pipe()
        self._hear, say = os.pipe()
        own = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", f"--user-data-dir={place / 'profile'}"]
        line = [program, *own, f"--window-size={size[0]},{size[1]}", *options, "about:blank"]
        # the protocol's descriptors are 3 and 4
        shell = ["bash", "-c", f'exec "$@" 3<&{hear} 4>&{say}', "bash", *line]
        self._process = subprocess.Popen(shell, pass_fds=(hear, say), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(hear)
        os.close(say)
        self._buffer = b""
        self._number = 0
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Page.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=False)

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        os.close(self._say)
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._hear)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Calls a method of the page."""
        return self._call(method, self._session, **parameters)

    def _call(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self._say, json.dumps(message).encode() + b"\0")
        while True:
            text, end, rest = self._buffer.partition(b"\0")
            if not end:
                piece = os.read(self._hear, 1 << 16)
                assert piece, "Chromium has ended"
                self._buffer += piece
                continue
            self._buffer = rest
            answer = json.loads(text)
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                result: dict[str, Any] = answer["result"]
                return result

    def open(self, address: str) -> None:
        """Goes to a page."""
        self.call("Page.navigate", url=address)

    def enter(self, address: str) -> None:
        """Goes into the frame that shows a page of another site; what is called from then on is its."""
        for _ in range(500):
            frames = self._call("Target.getTargets")["targetInfos"]
            for frame in frames:
                if frame["type"] == "iframe" and frame["url"] == address:
                    self._session = self._call("Target.attachToTarget", targetId=frame["targetId"], flatten=True)["sessionId"]
                    return
            time.sleep(0.02)
        raise AssertionError(f"no frame shows {address}: {frames}")

    def evaluate(self, expression: str) -> Any:
        """The value of an expression in the page; of a promise what it becomes."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def wait(self, condition: str, seconds: float = 30.0) -> Any:
        """Waits until an expression is true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if value := self.evaluate(condition):
                return value
            time.sleep(0.02)
        raise AssertionError(f"not within {seconds} s: {condition}; {self.evaluate('document.body.innerText')}")

    def picture(self, file: Path) -> None:
        """Keeps what is seen of the whole page."""
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        file.write_bytes(base64.b64decode(shot["data"]))
