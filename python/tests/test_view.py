"""The viewer of a specimen in `report.html` and in a notebook, looked at in headless Chromium."""

from __future__ import annotations

import html
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import pullout_fe as po

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 700, 700

#: goes to a state once the viewer is there, and shows the viewer alone
MOVE = """<script>
const timer = setInterval(() => {
  const viewer = document.getElementById("viewer");
  if (!viewer || viewer.querySelector(".stage").hidden || !viewer.querySelector(".readout").textContent) return;
  clearInterval(timer);
  document.body.replaceChildren(viewer);
  const slider = viewer.querySelector(".state");
  slider.value = %s;
  slider.oninput();
}, 20);
</script>"""


#: what the viewer says when it is there, after keys, after a pinch of two fingers, and where the wheel and one finger go
TRY = """<script>
const timer = setInterval(() => {
  const viewer = document.getElementById("viewer"), part = (name) => viewer.querySelector("." + name);
  if (!viewer || part("stage").hidden || !part("readout").textContent) return;
  clearInterval(timer);
  const canvas = part("mesh"), found = { opened: part("readout").textContent, touchAction: getComputedStyle(canvas).touchAction };
  const key = (target, name) => !target.dispatchEvent(new KeyboardEvent("keydown", { key: name, cancelable: true }));
  const wheel = (ctrlKey) => !canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: -100, ctrlKey, cancelable: true }));
  const touch = (kind, ...xs) => {
    const box = canvas.getBoundingClientRect();
    const touches = xs.map((x, identifier) => new Touch({ identifier, target: canvas, clientX: box.left + x, clientY: box.top + 50 }));
    return !canvas.dispatchEvent(new TouchEvent(kind, { touches, cancelable: true }));
  };
  found.keys = [key(canvas, "+"), key(canvas, "ArrowLeft"), key(canvas, "Tab")];
  found.wheel = [wheel(false), wheel(true)];
  found.touch = [touch("touchstart", 50), touch("touchmove", 60), touch("touchstart", 50, 100), touch("touchmove", 40, 120)];
  found.bar = ["least", "most"].map((name) => part(name).textContent);
  part("parts").value = [...part("parts").options].find((option) => option.text.includes("matrix")).value;
  part("parts").onchange();
  key(part("curve"), "End");
  found.names = [...viewer.querySelectorAll("canvas, button, select, input")].filter((control) =>
    !(control.getAttribute("aria-label") || control.textContent.trim() && control.tagName === "BUTTON" || control.closest("label")));
  found.names = found.names.map((control) => control.outerHTML);
  // what is saved is a picture
  HTMLAnchorElement.prototype.click = function () { found.saved = [this.download, this.href.split(":")[0]]; };
  part("picture").onclick();
  // the viewer draws with the next frame of the browser, which a busy machine gives late
  let looks = 0;
  const later = setInterval(() => {
    if (!(found.saved && part("readout").textContent.startsWith("end: ")) && ++looks < 500) return;
    clearInterval(later);
    [found.end, found.clipped] = [part("readout").textContent, part("most").textContent];
    // a range that is typed begins with that of all
    const chosen = () => [!part("chosen").hidden, ...["low", "high"].map((name) => part(name).valueAsNumber)];
    found.before = chosen()[0];
    part("parts").value = [...part("parts").options].find((option) => option.text === "from").value;
    part("parts").onchange();
    found.chosen = chosen();
    [part("low").value, part("high").value] = ["1", "2"];
    part("high").oninput();
    found.typed = ["least", "most"].map((name) => part(name).textContent);
    const result = document.createElement("pre");
    result.id = "found";
    result.textContent = JSON.stringify(found);
    document.body.replaceChildren(result);
  }, 20);
}, 20);
</script>"""


@pytest.fixture(scope="module")
def fibre(tmp_path_factory: pytest.TempPathFactory) -> po.Run:
    case = po.Case(ROOT / "cases/chapter-6/6.14-plane.json").with_({"steps[0].slip": 0.1})
    return po.run(case, out=tmp_path_factory.mktemp("fibre") / "out")


def test_a_run_in_memory_has_the_view_of_the_report(fibre: po.Run) -> None:
    alone = po.run(fibre.case)
    report = (fibre.folder / "report.html").read_text(encoding="utf-8")
    for view in (alone.view(), fibre.view()):
        head = view.html.split('<script class="head"')[1].split("</script>")[0]
        assert head in report
        assert view._repr_html_().startswith("<iframe srcdoc=")
    assert "<iframe" in alone._repr_html_() and "<iframe" in fibre._repr_html_()
    without = po.run(fibre.case.with_({"steps[0].slip": 0.01}), view=False)
    assert "<iframe" not in without._repr_html_()
    with pytest.raises(po.PulloutError, match="view=True"):
        without.view()


def test_a_view_is_a_page_of_its_own(fibre: po.Run, tmp_path: Path) -> None:
    fibre.view().save(tmp_path / "view.html")
    assert (tmp_path / "view.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    point = po.run(po.point("linear_elastic", {"E": 1.0}, "3d", [po.ramp(2, e11=1e-3)]))
    with pytest.raises(po.PulloutError, match="specimens"):
        point.view()


def test_it_is_drawn_and_follows_the_slider(fibre: po.Run, tmp_path: Path) -> None:
    report = (fibre.folder / "report.html").read_text(encoding="utf-8")
    notebook = fibre.view(HEIGHT)
    pages = []
    for state in ("0", "slider.max"):
        # the report as it is, and what a notebook puts into its page, with the frame within the frame
        pages.append(report + MOVE % state)
        pages.append(po.View(notebook.html + MOVE % state, HEIGHT)._repr_html_())
    frames = "".join(f'<iframe srcdoc="{html.escape(page)}"></iframe>' for page in pages)
    style = f"body {{ margin: 0; display: grid; grid-template-columns: 1fr 1fr; }} iframe {{ width: {WIDTH}px; height: {HEIGHT}px; border: 0; }}"
    (tmp_path / "page.html").write_text(f"<!DOCTYPE html><style>{style}</style>{frames}", encoding="utf-8")
    image = screenshot(tmp_path / "page.html", 2 * WIDTH, 2 * HEIGHT + 100, tmp_path)
    assert image.shape[0] >= 2 * HEIGHT and image.shape[1] == 2 * WIDTH
    found = {}
    for k, name in enumerate(["report, begin", "notebook, begin", "report, end", "notebook, end"]):
        row, column = divmod(k, 2)
        found[name] = coloured(image[row * HEIGHT : (row + 1) * HEIGHT, column * WIDTH : (column + 1) * WIDTH])
    for place in ("report", "notebook"):
        begin, end = found[f"{place}, begin"], found[f"{place}, end"]
        # without stress the specimen has one colour (three quarters of what is coloured, with that under the lines of elements
        # and the key another), later many (a seventh)
        assert sum(begin.values()) > 0.05 * WIDTH * HEIGHT, f"{place}: nothing is drawn"
        assert max(begin.values()) > 0.5 * sum(begin.values()) and max(end.values()) < 0.3 * sum(end.values()), place
        assert len(end) > 1.5 * len(begin), (place, len(begin), len(end))


def test_it_opens_at_the_peak_and_hears_keys_and_fingers(fibre: po.Run, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text((fibre.folder / "report.html").read_text(encoding="utf-8") + TRY, encoding="utf-8")
    document = chromium(page, tmp_path, "--dump-dom", size=(390, 800))
    found = json.loads(html.unescape(document.split('<pre id="found">')[1].split("</pre>")[0]))
    load = np.asarray(fibre.history["load"])
    assert found["opened"].startswith("peak: ") and f"load {load.max():.4g} N" in found["opened"], found
    assert found["end"].startswith("end: "), found
    # one finger and the wheel alone are the page's; two fingers, Ctrl + wheel and keys but Tab the viewer's
    assert found["touchAction"] == "pan-x pan-y"
    assert (found["keys"], found["wheel"], found["touch"]) == ([True, True, False], [False, True], [False, False, True, True])
    # each part has its range in the key; in that of the matrix the fibre lies beyond, which the bar says
    assert all("fibre" in end and "matrix" in end for end in found["bar"]), found["bar"]
    assert found["clipped"].startswith("≥ "), found["clipped"]
    assert found["names"] == [], "controls without a name"
    stress = max(np.asarray(fibre.history["stress_max"]))
    shown, low, high = found["chosen"]
    assert not found["before"] and shown and low < 0 and high == pytest.approx(stress, rel=0.05), found["chosen"]
    assert found["typed"] == ["≤ 1", "≥ 2 MPa"], found["typed"]
    assert re.fullmatch(r"state-\d+\.png", found["saved"][0]) and found["saved"][1] == "blob", found["saved"]


def test_pictures_keep_the_colours_of_their_data_in_the_dark(fibre: po.Run, tmp_path: Path) -> None:
    report = (fibre.folder / "report.html").read_text(encoding="utf-8")
    style = report.split("<style>")[1].split("</style>")[0]
    picture = (fibre.folder / "plots/principal_stress_max_peak.svg").read_text(encoding="utf-8")
    page = tmp_path / "page.html"
    page.write_text(f'<!DOCTYPE html><meta name="color-scheme" content="light dark"><style>{style}</style><div class="pictures"><figure>{picture}</figure></div>', encoding="utf-8")
    light, dark = (coloured(screenshot(page, 700, 700, tmp_path, f"--blink-settings=preferredColorScheme={scheme}")) for scheme in (1, 0))
    assert len(light) > 5 and light == dark


def test_labels_of_pictures_stand_where_the_program_draws_them(tmp_path: Path) -> None:
    case = ROOT / "cases/chapter-5/5.3-compression-concrete-damage.json"
    program = Path(sys.executable).with_name("pullout")
    subprocess.run([program, "run", "--quiet", case, "--out", tmp_path / "out"], check=True)
    subprocess.run([program, "plot", "--png", tmp_path / "out"], check=True)
    picture = tmp_path / "out/plots/stress_strain.svg"
    # an index lowers the text that follows, and takes the place of what moves the label away from the edge if it begins with one
    assert "<tspan" in picture.read_text(encoding="utf-8")
    shots = {"Chromium": screenshot(picture, 640, 600, tmp_path), "the program": pixels(picture.with_suffix(".png"))}
    for who, image in shots.items():
        scale = image.shape[1] / 640
        # where the labels of both axes have ink: from the left edge and from the lower one, px
        dark = image[: int(464 * scale)].max(axis=2) < 128
        left = np.flatnonzero(dark[:, : int(60 * scale)].any(axis=0))
        below = np.flatnonzero(dark[::-1][: int(50 * scale)].any(axis=1))
        assert left[0] / scale > 4, f"{who} cuts the label at the left: ink from {left[0] / scale} px on"
        assert below[0] / scale > 4, f"{who} cuts the label below: ink from {below[0] / scale} px on"


def pixels(picture: Path) -> NDArray[np.uint8]:
    from PIL import Image

    return np.asarray(Image.open(picture).convert("RGB"))


def screenshot(page: Path, width: int, height: int, place: Path, *more: str) -> NDArray[np.uint8]:
    """What Chromium shows of a page."""
    shot = place / "shot.png"
    shot.unlink(missing_ok=True)
    chromium(page, place, f"--screenshot={shot}", "--hide-scrollbars", *more, size=(width, height))
    if kept := os.environ.get("PULLOUT_KEEP_SCREENSHOT"):
        shutil.copy(shot, kept)
    return pixels(shot)


def chromium(page: Path, place: Path, *options: str, size: tuple[int, int]) -> str:
    """What Chromium prints of a page."""
    program = shutil.which("chromium")
    if not os.environ.get("PULLOUT_REQUIRE_CHROMIUM"):
        pytest.importorskip("PIL")
        if program is None:
            pytest.skip("no chromium")
    assert program is not None
    own = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--virtual-time-budget=20000"]
    own += [f"--user-data-dir={place / 'profile'}", f"--window-size={size[0]},{size[1]}"]
    ended = subprocess.run([program, *own, *options, page.as_uri()], capture_output=True, text=True, timeout=120)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def coloured(image: NDArray[np.uint8]) -> dict[int, int]:
    """How often which colour is there, greys and what is between two colours at an edge left out."""
    coarse = (image >> 4).astype(int)
    is_coloured = coarse.max(axis=2) - coarse.min(axis=2) > 2
    codes, counts = np.unique(coarse[is_coloured] @ [256, 16, 1], return_counts=True)
    return {int(code): int(count) for code, count in zip(codes, counts) if count > 50}

