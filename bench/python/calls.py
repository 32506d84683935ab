"""What calls from Python cost: one run, many points in one call, a sweep of point runs.

    python bench/python/calls.py [--sweep 100000] [--out FOLDER]

The Python has the wheel.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np

import pages
import pullout_fe as po

INCREMENTS, POINTS, BATCHES = 150, 100_000, 20


def case(modulus: float = 31800.0) -> po.Case:
    """Tension of a concrete with free sides, past its peak."""
    return po.point("concrete_damage", {"E": modulus, "nu": 0.18}, "3d", [po.ramp(INCREMENTS, e11=6e-4)])


def seconds(call: Callable[[], Any], times: int) -> np.ndarray:
    """By the clock, of each of `times` calls after a first one."""
    call()
    found = np.empty(times)
    for k in range(times):
        start = time.perf_counter()
        call()
        found[k] = time.perf_counter() - start
    return found


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--sweep", type=int, default=100_000)
    parser.add_argument("--out", type=Path)
    wishes = parser.parse_args()
    rows: list[list[Any]] = []
    notes: list[str] = []

    def row(name: str, best: float, median: float, unit: str, wanted: float, smaller: bool) -> None:
        reached = median <= wanted if smaller else median >= wanted
        rows.append([name, best, median, unit, ("≤ " if smaller else "≥ ") + f"{wanted:g}", "reached" if reached else "**missed**"])

    document = case()
    batches = []
    for _ in range(BATCHES):
        batches.append(1e3 * seconds(lambda: po.run(document), 200))
        # another moment of a machine that others share
        time.sleep(1.0)
    row(f"`run` of a point, {INCREMENTS} increments", np.min(batches), float(np.median(batches)), "ms", 1.0, True)
    medians = np.sort(np.median(batches, axis=1))
    notes.append(f"Medians of the batches of runs: {', '.join(f'{median:.2f}' for median in medians)} ms.")

    random = np.random.default_rng(11)
    zero = np.zeros((POINTS, 6))
    for name, kind, scale, wanted in [
        ("linear_elastic", "elastic", 1e-5, 5e6),
        ("concrete_damage", "elastic", 1e-6, 5e6),
        ("concrete_damage", "cracking", 2e-4, 0.8e6),
    ]:
        law = po.Law(name)
        props = law.props({"E": 31800.0, "nu": 0.18})
        increment = random.normal(scale=scale, size=(POINTS, 6))
        if kind == "cracking":
            # every point is stretched past its strength
            increment[:, 0] = np.abs(increment[:, 0]) + 2e-4
        stress, state, _ = law.evaluate(zero, increment, props=props, tangent=False)
        out = (np.empty_like(stress), np.empty_like(state))
        rate = POINTS / seconds(lambda: law.evaluate(zero, increment, props=props, tangent=False, out=out), 40)
        row(f"`Law.evaluate`, `{name}`, {kind}", rate.max(), float(np.median(rate)), "points/s", wanted, False)
        if kind == "cracking":
            eta_t = state[:, [entry.name for entry in law.states].index("eta_t")]
            notes.append(f"Of the points that crack, {100.0 * np.mean(eta_t > 0.0):.3g} % have damage after the call.")

    for executor, wanted in [("threads", 60.0), ("processes", 120.0)]:
        with tempfile.TemporaryDirectory() as place:
            start = time.perf_counter()
            points = [{"material.props.E": modulus} for modulus in random.uniform(2e4, 4e4, wishes.sweep).tolist()]
            made = po.sweep(document, points, out=Path(place) / "sweep", quantities=["peak"], executor=executor, workers=2)
            taken = time.perf_counter() - start
            done = int(np.sum(np.asarray(made.table["status"]) == "done"))
        row(f"`sweep` of {wishes.sweep} runs of {INCREMENTS} increments, 2 {executor}", taken, taken, "s", wanted * wishes.sweep / 1e5, True)
        notes.append(f"Sweep by {executor}: {done} of {wishes.sweep} runs done.")

    method = f"""
`concrete_damage` in tension with free sides, {INCREMENTS} increments to a strain of 6e-4, as arrays without files; {POINTS} points in one call of `Law.evaluate`, stresses only, one thread; sweeps with plan
and table. By the clock: the best and the median (runs: {BATCHES} times 200 with a second between, since the machine is shared with others; calls: 40; sweeps: once); the median is judged."""
    pages.write("python-calls", "What calls from Python cost", method, ["call", "best", "median", "unit", "wanted", ""], rows, notes, wishes.out)


if __name__ == "__main__":
    main()
