"""The blocks of the README and of the book work as they stand there."""

from __future__ import annotations

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
