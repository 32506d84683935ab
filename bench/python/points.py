"""Uniaxial tension of a J2 law with free sides, ten thousand times with other parameters, through `pullout_fe` and simcoon.

    python bench/python/points.py [--runs 10000] [--out FOLDER]

The Python has the wheel and `pip install simcoon`.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import os
import tempfile
import time
from pathlib import Path
from typing import Any, Callable

# before NumPy and simcoon load it: more threads of linear algebra only wait for each other, in processor's time that counts
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np

import pages
import pullout_fe as po
from simcoon import solver

STRAIN, INCREMENTS = 0.02, 100
#: runs of a turn: the programs alternate
TURN = 250


def ours(modulus: float, ratio: float, limit: float, hardening: float) -> np.ndarray:
    table = [[limit, 0.0], [limit + 10.0 * hardening, 10.0]]
    props = {"E": modulus, "nu": ratio, "hardening": table}
    return po.run(po.point("j2_plasticity", props, "3d", [po.ramp(INCREMENTS, e11=STRAIN)])).history["s11"][1:]


def theirs(modulus: float, ratio: float, limit: float, hardening: float) -> np.ndarray:
    control = ["strain"] + 5 * ["stress"]
    step = solver.StepMeca(control=control, value=[STRAIN, 0, 0, 0, 0, 0], ninc=INCREMENTS)
    props = [modulus, ratio, 0.0, limit, hardening, 1.0]
    # a record of the tangents is nothing that the other side keeps
    result = solver.solve(step, "EPICP", props, 8, record_tangent=False)
    return np.asarray(result["Stress"])[0][-INCREMENTS:]


def exact(modulus: float, _: float, limit: float, hardening: float) -> np.ndarray:
    strain = STRAIN * np.arange(1, INCREMENTS + 1) / INCREMENTS
    beyond = limit + modulus * hardening / (modulus + hardening) * (strain - limit / modulus)
    return np.where(strain < limit / modulus, modulus * strain, beyond)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--out", type=Path)
    wishes = parser.parse_args()
    random = np.random.default_rng(23)
    low, high = [1.5e5, 0.2, 250.0, 500.0], [2.5e5, 0.35, 500.0, 5000.0]
    samples = random.uniform(low, high, (wishes.runs, 4)).tolist()

    programs: dict[str, Callable[..., np.ndarray]] = {"pullout_fe": ours, "simcoon": theirs}
    for program in programs.values():
        program(*samples[0])
    times: dict[str, list[float]] = {name: [] for name in programs}
    errors = dict.fromkeys(programs, 0.0)
    for first in range(0, wishes.runs, TURN):
        for name, program in programs.items():
            start = time.process_time()
            found = [program(*sample) for sample in samples[first : first + TURN]]
            times[name].append(time.process_time() - start)
            for sample, stress in zip(samples[first:], found):
                right = exact(*sample)
                errors[name] = max(errors[name], float(np.abs(stress - right).max() / right.max()))

    # the same as a sweep: cases are varied where they are run, and the greatest stress is kept
    with tempfile.TemporaryDirectory() as place:
        names = ["E", "nu", "hardening"]
        points = [
            dict(zip([f"material.props.{name}" for name in names], [e, nu, [[limit, 0.0], [limit + 10.0 * h, 10.0]]]))
            for e, nu, limit, h in samples
        ]
        first = {name: points[0][f"material.props.{name}"] for name in names}
        base = po.point("j2_plasticity", first, "3d", [po.ramp(INCREMENTS, e11=STRAIN)])
        start = time.perf_counter()
        made = po.sweep(base, points, out=Path(place) / "sweep", quantities=["peak"], executor="threads", workers=1)
        sweep_s = time.perf_counter() - start
        peaks = made.table["q.peak"]
        right = np.array([exact(*sample)[-1] for sample in samples])
        sweep_error = float(np.abs(peaks / right - 1.0).max())

    version = {"simcoon": f"simcoon {importlib.metadata.version('simcoon')}", "pullout_fe": f"pullout_fe {po.__version__}"}
    ratio = float(np.median(np.divide(times["simcoon"], times["pullout_fe"])))
    rows: list[list[Any]] = [
        [version[name], wishes.runs, sum(times[name]), 1e3 * sum(times[name]) / wishes.runs, ratio if name == "simcoon" else 1.0, errors[name]]
        for name in programs
    ]
    rows.append(["po.sweep, one thread (by the clock)", wishes.runs, sweep_s, 1e3 * sweep_s / wishes.runs, sweep_s / sum(times["pullout_fe"]), sweep_error])
    method = f"""
Uniaxial stress to a strain of {STRAIN} in {INCREMENTS} increments with free sides, isotropic linear hardening, {wishes.runs} runs with other E, ν, yield stress and hardening, each
a call from Python that gives arrays: `po.run(po.point("j2_plasticity", …))` with its reading and checking of the case, and simcoon's `solver.solve(step, "EPICP", …)`, both on one thread. Processor's time, in turns of {TURN} runs
that alternate; the ratio is the median over the turns. The error is the worst of all stresses against the exact ones, relative to the largest of the run. The last row is the same as one sweep, with its plan and table."""
    notes = [f"simcoon takes {ratio:.3g} times our processor's time, with a worst error of {errors['simcoon']:.2g} against {errors['pullout_fe']:.2g}."]
    header = ["program", "runs", "s", "ms a run", "ratio", "error"]
    pages.write("python-points", "Ten thousand points from Python", method, header, rows, notes, wishes.out)


if __name__ == "__main__":
    main()
