"""Libraries of others, compiled once."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

#: elasticity of one modulus; what it does at the call that DSTRAN(1) chooses
SOURCE = """
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      IMPLICIT REAL*8(A-H,O-Z)
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),DDSDDE(NTENS,NTENS),
     1 STRAN(NTENS),DSTRAN(NTENS),PROPS(NPROPS),TIME(2)
      IF (STRAN(1)+DSTRAN(1).GT.1.D0) THEN
{act}
      END IF
      DO 10 I=1,NTENS
      DO 10 J=1,NTENS
      DDSDDE(I,J)=0.D0
   10 CONTINUE
      DO 20 I=1,NTENS
      DDSDDE(I,I)=PROPS(1)
      STRESS(I)=STRESS(I)+PROPS(1)*DSTRAN(I)
   20 CONTINUE
      STATEV(1)=STATEV(1)+1.D0
      RETURN
      END
"""

ACTS = {
    "stops": "      STOP",
    "hangs": "   30 IF (NTENS.GT.0) GOTO 30",
    "refuses": "      PNEWDT=0.5D0\n      RETURN",
}


#: begins a UMAT in free form, with arrays for so many components: what a source has as "@umat ntens"
UMAT = """subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, &
    temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, &
    dfgrd1, noel, npt, layer, kspt, jstep, kinc)
  implicit real*8(a-h,o-z)
  character*80 cmname
  dimension stress({n}), statev(nstatv), ddsdde({n},{n}), stran({n}), dstran({n}), time(2), predef(*), dpred(*), &
    props(nprops), coords(3), drot(3,3), dfgrd0(3,3), dfgrd1(3,3), jstep(4)"""


def _compile(text: str, source: Path) -> Path:
    compiler = shutil.which("gfortran")
    if compiler is None:
        pytest.skip("no gfortran")
    source.write_text(re.sub(r"^@umat (\w+)$", lambda found: UMAT.format(n=found[1]), text, flags=re.M))
    library = source.with_name(f"lib{source.stem}.so")
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-w", "-o", library, source], check=True, cwd=source.parent)
    return library


@pytest.fixture(scope="session")
def compile_fortran() -> Callable[[str, Path], Path]:
    """Makes a library of a source that is written into a file."""
    return _compile


@pytest.fixture(scope="session")
def umats(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Libraries by what they do."""
    folder = tmp_path_factory.mktemp("umats")
    return {name: _compile(SOURCE.format(act=act), folder / f"{name}.f") for name, act in ACTS.items()}


@pytest.fixture(autouse=True)
def interruptible() -> None:
    """Ctrl-C counts, also in a process that was started in the background, where shells switch it off."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
