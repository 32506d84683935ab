"""Derivatives of a pull-out curve by five parameters: what they cost and how far off they are, as `Model.jac` takes them.

    python bench/python/gradient.py [--out FOLDER]

The Python has the wheel. Costs are processor time, as parts of one run's: whatever else the machine does.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np

import pages
import pullout_fe as po

CASES = Path(__file__).resolve().parents[2] / "cases"
BOND = {name: f"contact.law.props.{name}" for name in ("k_e", "a_1", "b_1")}
MODULI = {"E_fibre": "parts.fibre.material.props.E", "E_matrix": "parts.matrix.material.props.E"}
FIBRES: dict[str, tuple[str, dict[str, Any], list[float]]] = {
    "perpendicular, elastic mortar": (
        "chapter-6/6.14-plane.json",
        {"steps.0.slip": 0.045},
        [0.004, 0.012, 0.02, 0.03, 0.04],
    ),
    "bent, 45°, cracking mortar, cover": (
        "chapter-7/inclined-fibre.json",
        {"steps.0.slip": 0.55, "mesh.specimen.cover": True, "contact.law.props.p_0": 3},
        [0.02, 0.1, 0.18, 0.3, 0.5],
    ),
}


def spent(work: Callable[[], Any]) -> tuple[float, Any]:
    start = time.process_time()
    made = work()
    return time.process_time() - start, made


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path)
    wishes = parser.parse_args()
    rows = []
    for name, (file, changes, slips) in FIBRES.items():
        case = po.Case(CASES / file).with_({"output.vtu": False, **changes})
        free = {**BOND, **MODULI}
        model = po.Model(case, free, ("slip", "load"), slips)
        one, base = spent(lambda: po.run(case, record=True, view=False))
        along, slopes = spent(lambda: model.jac(model.x0))
        # the same by runs that repeat all increments, on both sides
        repeated = po.Model(case.with_({"increments": base.increments}), free, ("slip", "load"), slips)
        moves = np.diag(1e-6 * np.where(model.x0 == 0.0, 1.0, np.abs(model.x0)))
        both, curves = spent(lambda: repeated.batch(np.concatenate([model.x0 + moves, model.x0 - moves])))
        expected = ((curves[:5] - curves[5:]) / (2.0 * np.diag(moves))[:, None]).T
        error = np.max(np.abs(slopes - expected) / np.abs(expected).max(axis=0))
        rows.append([name, base.history.rows - 1, one, along / one - 1.0, 0.5 * both / one, float(error)])
    pages.write(
        "python-gradient",
        "Derivatives of pull-out curves",
        """
Five derivatives of the load at five slips across the peak: by the bond's stiffness and the factor and exponent of its rise, and by Young's moduli. `Model.jac` takes one run, and one for each parameter along its states, all at once ([how](../../docs/theory/stepping.md)); before, each
of these repeated the increments of the first. The error is the largest difference to central differences of such repeated runs, as part of each parameter's largest derivative. Processor time, each as a part of that of one run.
""",
        ["specimen", "increments", "one run, s", "five derivatives along it", "five by repeated runs", "largest difference"],
        rows,
        [
            "The five go at once: the first factorises once in each round of an increment, the others correct with its factor.",
            "What is left are the laws, twice in each round or a little more often. The perpendicular specimen, whose mortar stays elastic, calls them but 2.8 times in an increment of its own run, the bent one 8.6 times.",
        ],
        wishes.out,
    )


if __name__ == "__main__":
    main()
