"""The blocks of the README and of the book work as they stand there."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PIECE = re.compile(r"<!-- copy: (?P<copy>\S+) -->|(?:<!-- file: (?P<file>\S+) -->\n)?```(?P<language>\w+)\n(?P<text>.*?)```", re.S)


@pytest.mark.parametrize("page", ["README.md", "python/README.md", pytest.param("docs/using/python.md", marks=pytest.mark.slow)])
def test_a_page(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    blocks = 0
    for piece in PIECE.finditer((ROOT / page).read_text(encoding="utf-8")):
        if piece["copy"]:
            shutil.copy(ROOT / piece["copy"], tmp_path)
        elif piece["file"]:
            Path(piece["file"]).write_text(piece["text"])
        elif piece["language"] == "python":
            blocks += 1
            if "my_umat.f" in piece["text"] and shutil.which("gfortran") is None:
                continue
            exec(compile(piece["text"], f"{page}, block {blocks}", "exec"), names)
    assert blocks > 0


def test_the_idioms_of_the_pages_have_types(tmp_path: Path) -> None:
    mypy = pytest.importorskip("mypy.api")
    for number, page in enumerate(["README.md", "python/README.md", "docs/using/python.md"]):
        pieces = PIECE.finditer((ROOT / page).read_text(encoding="utf-8"))
        text = "\n".join(piece["text"] for piece in pieces if piece["language"] == "python")
        (tmp_path / f"page_{number}.py").write_text(text)
    words, errors, code = mypy.run(["--strict", "--cache-dir", str(tmp_path / "cache"), *map(str, tmp_path.glob("*.py"))])
    assert code == 0, words + errors


RECIPES = re.split(r"^## (.+)$", (ROOT / "docs/using/recipes.md").read_text(encoding="utf-8"), flags=re.M)[1:]
#: a recipe of the book, and what it imports
PACKAGES = {"scipy": "scipy", "lmfit": "lmfit", "SALib": "SALib", "emcee": "emcee", "Optuna": "optuna", "UM-Bridge": "umbridge"}


def _blocks(title: str) -> str:
    text = RECIPES[RECIPES.index(title) + 1]
    return "\n".join(piece["text"] for piece in PIECE.finditer(text) if piece["language"] == "python")


@pytest.mark.slow
@pytest.mark.parametrize("title", RECIPES[2::2])
def test_a_recipe(title: str) -> None:
    """Each recipe works alone after the first block. If third-party packages are required, all must be installed."""
    if not os.environ.get("PULLOUT_REQUIRE_RECIPES"):
        pytest.importorskip(PACKAGES[title])
    exec(compile(_blocks("The model") + _blocks(title), title, "exec"), {})
