"""`pullout lab` in headless Chromium: what one drags, types, saves and drops, and what is seen of it."""

from __future__ import annotations

import json
import os
import shutil
import statistics
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from devtools import Browser

import pullout_fe as po

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]

#: E, nu, yield stress, hardening modulus of `j2.f90`
J2 = {"kind": "point", "material": {"plugin": "j2.f90", "props": [2e5, 0.3, 300.0, 2e3], "nstatv": 7}, "steps": [{"increments": 100, "target": {"e11": 0.01}}]}

#: sets a slider of a control, by the name that is read out, and waits for the next picture; returns the milliseconds
DRAG = """new Promise((resolve) => {
  const slider = document.querySelector(`input[aria-label="%s, slider"]`), start = performance.now();
  window.addEventListener("shown", () => requestAnimationFrame(() => resolve(performance.now() - start)), { once: true });
  slider.value = %d;
  slider.dispatchEvent(new Event("input"));
})"""


@contextmanager
def lab(folder: Path, *subject: str, size: tuple[int, int] = (1280, 900)) -> Iterator[Browser]:
    program = Path(sys.executable).with_name("pullout")
    with subprocess.Popen([program, "lab", "--no-open", *subject], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        try:
            assert process.stdout is not None
            address = process.stdout.readline().strip()
            with Browser(folder, size) as browser:
                browser.open(address)
                browser.wait("document.querySelectorAll('#figures svg').length > 0")
                yield browser
        finally:
            process.terminate()
            process.wait(10)


def verdict(browser: Browser) -> str:
    return str(browser.wait("(() => { const badge = document.querySelector('#conclusion .badge'); return badge && badge.textContent; })()", 60))


def test_a_slider_moves_the_curve_and_the_case_repeats_it(tmp_path: Path) -> None:
    with lab(tmp_path, "j2_plasticity") as browser:
        before = browser.evaluate("document.querySelector('#figures svg').outerHTML")
        times = [browser.evaluate(DRAG % ("E, MPa", place)) for place in range(400, 440)]
        assert browser.evaluate("document.querySelector('#figures svg').outerHTML") != before
        print(f"slider to picture: {statistics.median(times):.1f} ms")
        # what is taken away is what is seen
        case = json.loads(browser.evaluate("document.getElementById('case').value"))
        shown = browser.evaluate("fetch('/csv', { method: 'POST', body: JSON.stringify({ page: 'test', document: JSON.parse(document.getElementById('case').value) }) }).then((a) => a.text())")
        head, *rows = str(shown).splitlines()
        run = po.run(case)
        for column in ("e11", "s11", "peeq"):
            seen = [float(row.split(",")[head.split(",").index(column)]) for row in rows]
            assert seen == list(np.asarray(run.history[column])), column
        assert verdict(browser) == "pass"
        # an earlier curve stays beside the new one
        browser.evaluate("document.getElementById('pin').click()")
        browser.evaluate(DRAG % ("nu", 300))
        browser.wait("document.querySelector('#figures svg').outerHTML.includes('earlier 1')")
        # values at the pointer
        browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=640, y=300)
        browser.wait("document.getElementById('cursor').textContent.includes('MPa')")
        # every control has a name, and is reached by keys alone
        nameless = "[...document.querySelectorAll('button, select, input, textarea')].filter((c) => !(c.ariaLabel || c.textContent.trim() || c.closest('label'))).map((c) => c.outerHTML)"
        assert browser.evaluate(nameless) == []


def test_another_law_and_path_by_the_keyboard(tmp_path: Path) -> None:
    with lab(tmp_path, size=(390, 800)) as browser:
        assert browser.evaluate("document.documentElement.scrollWidth <= 390"), "nothing is wider than a phone"
        choose = "(() => {{ const s = document.getElementById('{0}'); s.value = '{1}'; s.dispatchEvent(new Event('change')); }})()"
        for law, path in (("concrete_damage", "cyclic"), ("bond_slip", "slips"), ("drucker_prager", "triaxial")):
            browser.evaluate(choose.format("law", law))
            browser.evaluate(choose.format("path", path))
            browser.wait(f"document.getElementById('case').value.includes('\"{law}\"') && document.getElementById('status').textContent.startsWith('done')")
            said = str(browser.evaluate("document.getElementById('problems').textContent"))
            assert all(line.startswith("warning: ") for line in said.splitlines()), said


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="no gfortran")
def test_a_umat_that_is_saved(tmp_path: Path) -> None:
    good = (ROOT / "tests/umats/j2.f90").read_text()
    source = tmp_path / "j2.f90"
    source.write_text(good)
    (tmp_path / "case.json").write_text(json.dumps(J2))
    with lab(tmp_path, "case.json") as browser:
        assert verdict(browser) == "pass"
        source.write_text(good.replace("factor = 9 * mu**2", "factor = 4 * mu**2"))
        browser.wait("document.querySelector('#conclusion .fail') !== null", 60)
        assert "consistent tangent" in str(browser.evaluate("document.getElementById('findings').textContent"))
        assert "before the last change" in str(browser.evaluate("document.querySelector('#figures svg').outerHTML"))
        source.write_text(good.replace("hardening = props(4)", "hardening = = props(4)"))
        browser.wait("document.getElementById('problems').textContent.includes('j2.f90:21')", 60)
        source.write_text(good)
        browser.wait("document.querySelector('#conclusion .pass') !== null && document.getElementById('problems').hidden", 60)
        if kept := os.environ.get("PULLOUT_KEEP_SCREENSHOT"):
            browser.picture(Path(kept))
