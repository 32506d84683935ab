"""What crashes cost a sweep, and what a killed driver: on processes, Dask and SLURM of this machine.

    python bench/python/sweeps.py [--runs 2000] [--kills 10] [--out FOLDER]

The Python has the wheel with `[dask]`, and pyarrow. SLURM is that of Debian's packages munge, slurmctld, slurmd and slurm-client, started here
by root with folders of its own; without them its rows are left out.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, Callable, Iterator

import distributed
import numpy as np
import pages
import pullout_fe as po

PROGRAM = str(po.program())
#: call limit, s
LIMIT = 2.0
#: processes, workers, jobs
WORKERS = 2
KILLER, FAILING, HANGING = "ends its process", "raises", "hangs"

SOURCE = """
#include <stdlib.h>
void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
           double *drplde, double *drpldt, const double *stran, const double *dstran, const double *time, const double *dtime,
           const double *temp, const double *dtemp, const double *predef, const double *dpred, const char *cmname, const int *ndi,
           const int *nshr, const int *ntens, const int *nstatv, const double *props, const int *nprops, const double *coords,
           const double *drot, double *pnewdt) {
    if (props[1] == 1.0 && stran[0] + dstran[0] > 5e-4) abort();
    if (props[1] == 2.0 && stran[0] + dstran[0] > 5e-4) { *pnewdt = 0.1; return; }
    for (volatile double x = 0.0; props[1] == 3.0;) x += 1.0;
    for (int i = 0; i < *ntens * *ntens; i++) ddsdde[i] = i % (*ntens + 1) ? 0.0 : props[0];
    for (int i = 0; i < *ntens; i++) stress[i] += props[0] * dstran[i];
}
"""


class Slurm:
    """munged, slurmctld and slurmd with one node, ended with the block."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.daemons: list[subprocess.Popen[bytes]] = []

    @staticmethod
    def is_installed() -> bool:
        return os.geteuid() == 0 and all(map(shutil.which, ["munged", "slurmctld", "slurmd", "sbatch"]))

    def __enter__(self) -> Slurm:
        for name in ("munge", "state", "spool"):
            (self.place / name).mkdir()
            (self.place / name).chmod(0o755)
        key, munge = self.place / "munge/key", self.place / "munge/socket"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        host, ports = socket.gethostname(), [free_port(), free_port()]
        settings = f"""
ClusterName=bench
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={munge}
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SwitchType=switch/none
StateSaveLocation={self.place / "state"}
SlurmdSpoolDir={self.place / "spool"}
SlurmctldPidFile={self.place / "slurmctld.pid"}
SlurmdPidFile={self.place / "slurmd.pid"}
SlurmctldLogFile={self.place / "slurmctld.log"}
SlurmdLogFile={self.place / "slurmd.log"}
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs={WORKERS} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""
        (self.place / "slurm.conf").write_text(settings)
        self.environment = {**os.environ, "SLURM_CONF": str(self.place / "slurm.conf")}
        files = {name: self.place / "munge" / name for name in ("pid", "seed", "log")}
        self.start("munged", "--foreground", "--force", f"--socket={munge}", f"--key-file={key}", *(f"--{n}-file={f}" for n, f in files.items()))
        wait(munge.exists)
        self.start("slurmctld", "-D", "-i")
        self.start("slurmd", "-D")
        wait(lambda: self.ask("sinfo", "-h", "-o", "%t") == "idle")
        return self

    def start(self, *command: str) -> None:
        with open(self.place / f"{command[0]}.out", "wb") as log:
            self.daemons.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log))

    def ask(self, *command: str) -> str:
        return subprocess.run(command, env=self.environment, stdout=subprocess.PIPE, text=True).stdout.strip()

    def __exit__(self, *_: object) -> None:
        for daemon in reversed(self.daemons):
            daemon.kill()
            daemon.wait()

    def work(self, folder: Path) -> None:
        """The array of jobs that `pullout sweep submit` writes, to its end."""
        script = subprocess.run(
            [PROGRAM, "sweep", "submit", folder, "--slurm", "--array", f"0-{WORKERS - 1}"], stdout=subprocess.PIPE, text=True, check=True
        ).stdout
        (self.place / "job.sh").write_text(script)
        path = f"{Path(PROGRAM).parent}:{os.environ['PATH']}"
        submitted = subprocess.run(
            ["sbatch", "--parsable", "job.sh"], cwd=self.place, env={**self.environment, "PATH": path}, stdout=subprocess.PIPE, text=True, check=True
        )
        wait(lambda: not self.ask("squeue", "-h", "-j", submitted.stdout.strip()))


def free_port() -> int:
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        return int(place.getsockname()[1])


def wait(is_so: Callable[[], bool], patience: float = 300.0) -> None:
    end = time.monotonic() + patience
    while not is_so():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.02)


def planned(place: Path, library: Path, runs: int, faults: dict[int, float], increments: int) -> po.Sweep:
    """A sweep without a row."""
    material = {"plugin": str(library), "nstatv": 1, "props": [1000.0, 0.0], "call_time_limit_s": LIMIT}
    case = po.Case({"kind": "point", "mode": "3d", "material": material, "steps": [{"increments": increments, "target": {"e11": 1e-3}}]})
    points = [{"material.props.0": 1000.0 + k, "material.props.1": faults.get(k, 0.0)} for k in range(runs)]
    return po.sweep(case, points, out=place, quantities=["peak"], executor=None)


def ways(slurm: Slurm | None) -> Iterator[tuple[str, Callable[[po.Sweep], None]]]:
    yield f"processes, {WORKERS}", lambda sweep: sweep.work("processes", workers=WORKERS)

    def dask(sweep: po.Sweep) -> None:
        with distributed.LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster):
                sweep.work("dask", workers=WORKERS)

    yield f"Dask LocalCluster, {WORKERS} workers, with its start", dask
    if slurm is not None:
        yield f"SLURM, array of {WORKERS} jobs", lambda sweep: slurm.work(sweep.folder)


def crashes(place: Path, library: Path, runs: int, slurm: Slurm | None) -> list[list[Any]]:
    """Clean sweeps, and those of which three runs are bad."""
    rows: list[list[Any]] = []
    kinds = {int(0.35 * runs): KILLER, int(0.55 * runs): FAILING, int(0.75 * runs): HANGING}
    faults = {run: float(1 + k) for k, run in enumerate(kinds)}
    expected = {KILLER: "crashed", FAILING: "failed", HANGING: "timeout"}
    for number, (name, work) in enumerate(ways(slurm)):
        seconds = []
        for bad in ({}, faults):
            sweep = planned(place / f"{number}-{len(bad)}", library, runs, bad, 50)
            start = time.perf_counter()
            work(sweep)
            seconds.append(time.perf_counter() - start)
        states = sweep.table["status"]
        found = {int(run): states[run] for run in np.flatnonzero(states != "done")}
        right = found == {run: expected[kind] for run, kind in kinds.items()} and len(states) == runs
        rows.append([name, runs, *seconds, seconds[1] - seconds[0], "right" if right else f"wrong: {found}"])
    return rows


def kills(place: Path, library: Path, runs: int, count: int) -> list[str]:
    """A driver that is killed at moments of chance, started again each time."""
    command = [PROGRAM, "sweep", "work", "--quiet", f"--jobs={WORKERS}"]
    undisturbed = planned(place / "undisturbed", library, runs, {}, 6000)
    start = time.perf_counter()
    subprocess.run([*command, str(undisturbed.folder)], check=True)
    whole = time.perf_counter() - start
    sweep = planned(place / "kills", library, runs, {}, 6000)
    chance = random.Random(23)
    # all of them together are shorter than the whole: none comes after the end
    first, last = 0.05 * whole / count, 0.9 * whole / count
    for _ in range(count):
        driver = subprocess.Popen([*command, str(sweep.folder)])
        time.sleep(chance.uniform(first, last))
        assert driver.poll() is None, "it was over before"
        driver.send_signal(signal.SIGKILL)
        driver.wait()
    subprocess.run([*command, str(sweep.folder)], check=True)
    rows = written(sweep.folder)
    keys = [key for key, status in rows if status == "done"]
    lost = sum(status == "lost" for _, status in rows)
    table = sweep.table
    each = float(np.mean(table["wall_s"]))
    assert len(keys) == len(set(keys)) == runs and sweep.status() == {"runs": runs, "left": 0, "done": runs}
    return [
        f"Driver killed (`kill -9`) at {count} moments of chance within {first:.2g} to {last:.2g} s, {runs} runs of {each:.2g} s by {WORKERS} children, and started again each time: {runs} rows, none "
        f"lost, none twice; {lost} runs were begun and computed again, that is at most {lost * each:.2g} s of {runs * each:.3g} s of work, and at most {WORKERS} runs for a kill."
    ]


def written(folder: Path) -> list[tuple[str, str]]:
    """Key and status of every row that was ever written."""
    found: list[tuple[str, str]] = []
    for part in sorted((folder / "parts").glob("*.jsonl")):
        rows = map(json.loads, part.read_text().splitlines())
        found += [(row["key"], row["status"]) for row in rows]
    return found


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--out", type=Path)
    wishes = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        source, library = place / "bad.c", place / "libbad.so"
        source.write_text(SOURCE)
        subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "-o", library, source], check=True)
        if Slurm.is_installed():
            (place / "slurm").mkdir()
            with Slurm(place / "slurm") as slurm:
                rows = crashes(place, library, wishes.runs, slurm)
        else:
            rows = crashes(place, library, wishes.runs, None)
        notes = kills(place, library, wishes.runs, wishes.kills)
    if os.path.getsize(PROGRAM) > 6e7:
        notes.append("Made with a wheel of the development profile: its runs take several times as long as those of a wheel for others.")
    most = max(row[4] for row in rows)
    reached = "reached" if most <= 10.0 and all(row[5] == "right" for row in rows) else "**missed**"
    notes.insert(0, f"Names are to be right, and at most 10 s more: {most:.2g} s at most: {reached}.")
    method = f"""
{wishes.runs} runs of a point with a library of another's (a linear law in C, 50 increments), of which one ends its process (`abort`), one gives up every increment, one never comes back; calls
may take {LIMIT:g} s. Wall time, once each, compared with the same sweep without the three. Names: the statuses of all rows are correct ("crashed", "failed", "timeout", otherwise "done")."""
    header = ["worked off by", "runs", "clean s", "with the three s", "more s", "names"]
    pages.write("python-sweeps", "What crashes cost a sweep", method, header, rows, notes, wishes.out)


if __name__ == "__main__":
    main()
