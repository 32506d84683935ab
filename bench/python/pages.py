"""Pages of results: a table as CSV and as Markdown, as those of `pullout-bench`."""

from __future__ import annotations

import csv
import datetime
import os
import platform
from pathlib import Path
from typing import Any, Sequence

RESULTS = Path(__file__).resolve().parents[1] / "results"


def machine() -> str:
    """Processor, number of its cores, system, Python, day."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    day = datetime.datetime.now(datetime.timezone.utc).date()
    name = names[0] if names else platform.processor()
    return f"{name}, {os.cpu_count()} cores, {platform.system().lower()} {platform.machine()}; Python {platform.python_version()}; {day}."


def shown(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


def write(
    name: str, title: str, method: str, header: Sequence[str], rows: Sequence[Sequence[Any]], notes: Sequence[str], folder: Path | None
) -> None:
    """Writes `name`.csv and `name`.md into bench/results, or another folder."""
    folder = folder or RESULTS
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / f"{name}.csv", "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])
    right = ["---" if isinstance(cell, str) else "---:" for cell in rows[0]]
    lines = [header, right, *([shown(cell) for cell in row] for row in rows)]
    table = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    text = f"# {title}\n\n{method.strip()}\n\n{machine()}\n\n{table}\n\n## Notes\n\n" + "\n".join(f"- {note}" for note in notes)
    made = f"\n\nAll numbers: [{name}.csv]({name}.csv). Made anew by `python bench/python/{name.removeprefix('python-')}.py`.\n"
    (folder / f"{name}.md").write_text(text + made, encoding="utf-8")
    print(text)
