"""`pullout lab` in headless Chromium: what one drags, types, saves and drops, and what is seen of it."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.request import urlopen

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
        # an earlier curve stays next to the new one
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


def strengths(browser: Browser) -> dict[str, float]:
    """The numbers of a mix, by their names."""
    rows = browser.evaluate("[...document.querySelectorAll('#strengths tr')].map((row) => [...row.cells].map((cell) => cell.textContent))")
    return {str(name): float(value) for name, value, _ in rows}


def test_a_mix_of_fibres(tmp_path: Path) -> None:
    with lab(tmp_path, "bridging") as browser:
        first = strengths(browser)
        assert {"fL", "fR1", "fR2", "fR3", "fR4"} <= first.keys()
        before = browser.evaluate("document.querySelector('#figures svg').outerHTML")
        times = [browser.evaluate(DRAG % ("Fibre content (steel), kg/m³", place)) for place in range(600, 620)]
        print(f"slider to picture of a mix: {statistics.median(times):.1f} ms")
        more = strengths(browser)
        assert more["fR3"] > first["fR3"] and browser.evaluate("document.querySelector('#figures svg').outerHTML") != before
        browser.evaluate(DRAG % ("Fibre length, mm", 200))
        assert strengths(browser)["fR3"] < more["fR3"], "short fibres pull out early"
        # walls lay fibres along the beam
        free = strengths(browser)["Orientation factor η"]
        assert free == 0.5
        browser.evaluate("(() => { const s = document.querySelector('select[aria-label=Orientation]'); s.selectedIndex = 2; s.dispatchEvent(new Event('change')); })()")
        browser.wait("[...document.querySelectorAll('#strengths td')].some((cell) => Number(cell.textContent) > 0.55 && Number(cell.textContent) < 0.6)")
        # the case has the content as a part of the volume
        case = json.loads(browser.evaluate("document.getElementById('case').value"))
        shown = float(browser.evaluate("document.querySelector('input[type=number][aria-label^=\"Fibre content\"]').value"))
        assert case["volume_fraction"] == pytest.approx(shown / 7850)
        # what a mix has not is not there
        for place in ("law-label", "mode-label", "length-label"):
            assert browser.evaluate(f"document.getElementById('{place}').checkVisibility()") is False, place


#: chooses a measured curve of columns `strain,stress`, which is compared with e11 and s11
DROP = """(() => {
  const transfer = new DataTransfer();
  transfer.items.add(new File([`%s`], "measured.csv"));
  const field = document.getElementById("data");
  field.files = transfer.files;
  field.dispatchEvent(new Event("change"));
})()"""
#: ticks parameters by their labels and starts the fit
FIT = """(() => {
  for (const label of %s) [...document.querySelectorAll("#free label")].find((one) => one.textContent.trim() === label).firstChild.click();
  document.getElementById("start-fit").click();
})()"""


def measured(case: dict[str, Any], every: int = 1) -> str:
    run = po.run(case)
    rows = zip(run.history["e11"][::every], run.history["s11"][::every])
    return "strain,stress\n" + "".join(f"{x},{y}\n" for x, y in rows)


def test_parameters_fitted_to_a_measured_curve(tmp_path: Path) -> None:
    steps = [{"increments": 60, "target": {"e11": 0.01}}]
    case = {"kind": "point", "title": "A bar", "material": {"plugin": "j2_plasticity", "props": {"E": 2e5, "hardening": [[300.0, 0.0], [320.0, 0.01]]}}, "steps": steps}
    truth = {**case, "material": {"plugin": "j2_plasticity", "props": {"E": 1.7e5, "hardening": [[260.0, 0.0], [290.0, 0.01]]}}}
    (tmp_path / "case.json").write_text(json.dumps(case))
    with lab(tmp_path, "case.json") as browser:
        assert browser.evaluate("document.getElementById('fit').checkVisibility()") is False, "there are no data yet"
        browser.evaluate(DROP % measured(truth))
        browser.wait("document.getElementById('fit').checkVisibility()")
        browser.evaluate("document.getElementById('fit').open = true")
        browser.evaluate(FIT % json.dumps(["E, MPa", "yield_stress 1, MPa", "yield_stress 2, MPa"]))
        browser.wait("document.querySelectorAll('#estimates tr').length === 3", 60)
        # the controls, and with them the case, have what was found
        browser.wait("JSON.parse(document.getElementById('case').value).material.props.E !== 2e5")
        found = json.loads(browser.evaluate("document.getElementById('case').value"))["material"]["props"]
        assert found["E"] == pytest.approx(1.7e5, rel=1e-5)
        assert found["hardening"] == [[pytest.approx(260.0, rel=1e-5), 0.0], [pytest.approx(290.0, rel=1e-4), 0.01]]
        assert browser.evaluate("document.querySelector('#ghosts input').value") == "before the fit"
        # a lower bound above the upper one is refused with its place
        browser.evaluate("(() => { const f = document.querySelector('#free input[type=number]'); f.value = 5e6; f.dispatchEvent(new Event('change')); })()")
        browser.evaluate("document.getElementById('start-fit').click()")
        browser.wait("document.getElementById('fitted').textContent.includes('material.props.E')")


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="no gfortran")
def test_constants_of_a_source_fitted_and_a_fit_stopped(tmp_path: Path) -> None:
    (tmp_path / "j2.f90").write_text((ROOT / "tests/umats/j2.f90").read_text())
    (tmp_path / "case.json").write_text(json.dumps(J2))
    # the same law of another program
    truth = {**J2, "material": {"plugin": "j2_plasticity", "props": {"E": 2e5, "nu": 0.3, "hardening": [[260.0, 0.0], [300.0, 0.02]]}}}
    with lab(tmp_path, "case.json") as browser:
        browser.evaluate(DROP % measured(truth, 5))
        browser.wait("document.getElementById('fit').checkVisibility()")
        browser.evaluate("document.getElementById('fit').open = true")
        browser.evaluate(FIT % json.dumps(["PROPS(3)"]))
        browser.wait("document.getElementById('start-fit').textContent === 'Stop'")
        browser.evaluate("document.getElementById('start-fit').click()")
        browser.wait("document.getElementById('fitted').textContent === 'stopped'", 30)
        browser.evaluate("document.getElementById('start-fit').click()")
        browser.wait("document.querySelectorAll('#estimates tr').length === 1", 120)
        browser.wait("JSON.parse(document.getElementById('case').value).material.props[2] !== 300")
        found = json.loads(browser.evaluate("document.getElementById('case').value"))["material"]["props"]
        assert found == [2e5, 0.3, pytest.approx(260.0, rel=1e-4), 2e3]


def test_a_finished_run(tmp_path: Path) -> None:
    case = {"kind": "point", "title": "A bar", "material": {"plugin": "concrete_damage"}, "steps": [{"increments": 50, "target": {"e11": 5e-4}}]}
    po.run(case, out=tmp_path / "out")
    with lab(tmp_path, "out") as browser:
        assert browser.evaluate("document.getElementById('title').textContent") == "A bar"
        assert browser.evaluate("document.getElementById('status').textContent").startswith("done: 50 increments")
        assert browser.evaluate("document.getElementById('material').hidden")
        # its report, in which scripts run but as nobody's page
        browser.evaluate("document.getElementById('report').click()")
        browser.wait("document.querySelector('h1')?.textContent === 'A bar' && location.pathname === '/report'")
        assert browser.evaluate("origin") == "null"


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


def start(lab: po.Lab) -> dict[str, Any]:
    """What the page in a notebook's frame begins with."""
    found = re.search('src="([^"]+)"', lab._repr_html_())
    assert found is not None
    with urlopen(found[1] + "start") as answer:
        begun: dict[str, Any] = json.load(answer)
    return begun


def answers(address: str) -> bool:
    """Whether a lab is there."""
    port = int(address.split("/")[2].split(":")[1])
    try:
        socket.create_connection(("127.0.0.1", port), 5.0).close()
    except ConnectionRefusedError:
        return False
    return True


def test_a_notebook_shows_a_lab_in_a_frame(tmp_path: Path) -> None:
    with po.lab("j2_plasticity", height=700) as lab:
        page = f"<!doctype html><title>a notebook</title>{lab._repr_html_()}".encode()

        class Notebook(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(page)

            def log_message(self, format: str, *arguments: Any) -> None:
                pass

        with ThreadingHTTPServer(("127.0.0.1", 0), Notebook) as server, Browser(tmp_path) as browser:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            # another site than the lab's 127.0.0.1, as Jupyter's usual one is
            browser.open(f"http://localhost:{server.server_port}/")
            browser.enter(lab.address.replace("?token=", "") + "/")
            browser.wait("document.querySelectorAll('#figures svg').length > 0")
            before = browser.evaluate("document.querySelector('#figures svg').outerHTML")
            browser.evaluate(DRAG % ("E, MPa", 400))
            assert browser.evaluate("document.querySelector('#figures svg').outerHTML") != before
            server.shutdown()


def test_a_lab_of_laws_and_cases(tmp_path: Path) -> None:
    case = next(po.Case(example.path) for example in po.examples() if example.path.name == "6.14-axisymmetric.json")
    with po.lab(case.with_({"steps[0].slip": 0.25})) as lab:
        document = start(lab)["document"]
        assert (document["kind"], document["steps"][0]["slip"]) == ("pullout", 0.25)
    with po.lab(po.Law("bond_slip")) as lab:
        assert start(lab)["document"]["material"]["plugin"] == "bond_slip"
    # by files, relative to the folder of the case
    (tmp_path / "table.csv").write_text("time,e11\n1,1e-3\n")
    (tmp_path / "case.json").write_text(json.dumps({"kind": "point", "material": {"plugin": "linear_elastic"}, "steps": [{"table": "table.csv"}]}))
    for subject in (tmp_path / "case.json", po.Case(tmp_path / "case.json")):
        with po.lab(subject) as lab:
            begun = start(lab)["document"]
            assert (begun["title"], begun["steps"]) == ("case", [{"table": "table.csv"}])
    with pytest.raises(po.CaseError, match="nonsense: neither a law"):
        po.lab("nonsense")


def test_a_lab_of_a_library(umats: dict[str, Path]) -> None:
    law = po.Law(umats["stops"], nstatv=3)
    with po.lab(law) as lab:
        begun = start(lab)
        assert begun["document"]["material"] == {"plugin": str(umats["stops"]), "nstatv": 3, "props": []}
        assert begun["library"]["library"] == str(umats["stops"])


def test_a_lab_ends_with_its_block_and_with_the_interpreter() -> None:
    lab = po.lab()
    assert lab.is_open and answers(lab.address) and lab.address in repr(lab)
    lab.close()
    lab.close()
    assert not lab.is_open and not answers(lab.address) and "iframe" not in lab._repr_html_()
    opened = "import pullout_fe as po, sys; print(po.lab().address, flush=True); sys.stdin.readline()"
    for how in (None, signal.SIGKILL):
        with subprocess.Popen([sys.executable, "-c", opened], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            address = process.stdout.readline().strip()
            assert answers(address)
            if how is not None:
                process.send_signal(how)
            process.communicate("")
        end = time.monotonic() + 10
        while answers(address):
            assert time.monotonic() < end, how
            time.sleep(0.02)


def test_examples_are_those_of_the_command(tmp_path: Path) -> None:
    found = po.examples()
    assert len(found) > 100 and all(example.path.is_file() for example in found)
    some = po.examples("AXISYMMETRIC", "fig. 6.14")
    assert "6.14-axisymmetric.json" in {example.path.name for example in some} and len(some) < 10
    assert all(example.kind == json.loads(example.path.read_text())["kind"] and example.title for example in some)
    # below the working directory it shows relative paths
    command = [po.program(), "examples", "AXISYMMETRIC", "fig. 6.14"]
    listed = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path).stdout
    assert all(str(example.path) in listed for example in some)
    assert po.examples("no such word") == []
