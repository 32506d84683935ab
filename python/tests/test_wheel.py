"""Files of the wheel other than the package."""

from __future__ import annotations

import importlib.metadata
import json

FILES = importlib.metadata.files("pullout-fe") or []


def bill(name: str) -> set[str]:
    """Names of the packages in a bill of materials."""
    (file,) = [file for file in FILES if file.name.endswith(name)]
    made = json.loads(file.read_text())
    assert made["bomFormat"] == "CycloneDX"
    return {component["name"] for component in made["components"]}


def test_it_says_what_it_is_made_of() -> None:
    # maturin's, of the extension; ours, of everything
    extension = bill(".cyclonedx.json")
    assert {"pyo3", "faer", "serde_json"} <= extension
    everything = bill("pullout.cdx.json")
    assert {"pyo3", "faer", "serde_json", "resvg", "parquet"} <= everything


def test_it_has_the_licences_of_others() -> None:
    (file,) = [file for file in FILES if file.name == "THIRD-PARTY.txt"]
    text = file.read_text(encoding="utf-8")
    assert "resvg 0.45" in text and "Permission is hereby granted" in text and "Apache License" in text
    assert {"LICENSE-MIT", "LICENSE-APACHE"} <= {file.name for file in FILES}


def test_it_has_program_laws_and_headers() -> None:
    names = {file.name for file in FILES}
    assert {"pullout", "libpullout_laws.so", "libconcrete_damage.so", "pullout_umat.h", "pullout_umat.f90", "pullout.1"} <= names
