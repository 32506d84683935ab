"""Uniaxial stress in jaxmat's loader with a law of its own: for each line that is read, the path from the start.

    python jaxmat_point.py LAW NSTATV INCREMENTS STRAIN PROPS...

As `simcoon_point.py`. All increments are one compiled loop, in double precision; compiling belongs to the process, not to the solver.
"""

import sys
import time

import jax

jax.config.update("jax_enable_x64", True)

import equinox
import numpy
from jax import numpy as jnp
from jaxmat import materials
from jaxmat.loader import ImposedLoading, solve_mechanical_state
from jaxmat.tensors import SymmetricTensor2


class Hardening(equinox.Module):
    first: float
    slope: float

    def __call__(self, p):
        return self.first + self.slope * p


@equinox.filter_jit
def along(material, state, strains):
    free = {f"sig{name}": jnp.zeros(1) for name in ("yy", "zz", "xy", "xz", "yz")}

    def increment(start, strain):
        loading = jax.tree.map(lambda values: values[0], ImposedLoading(epsxx=strain[None], **free))
        eps, state, _ = solve_mechanical_state(*start, loading, material, 1.0)
        return (eps, state), state.stress.array

    return jax.lax.scan(increment, (SymmetricTensor2(), state), strains)[1]


def main():
    law, _, increments, strain, *props = sys.argv[1:]
    modulus, ratio, *hardening = map(float, props)
    elasticity = materials.LinearElasticIsotropic(E=modulus, nu=ratio)
    if law == "elastic":
        material = materials.ElasticBehavior(elasticity)
    else:
        material = materials.vonMisesIsotropicHardening(elasticity=elasticity, yield_stress=Hardening(*hardening))
    strains = jnp.linspace(0.0, float(strain), int(increments) + 1)[1:]
    along(material, material.init_state(), strains).block_until_ready()
    for line in sys.stdin:
        start = time.process_time()
        stresses = along(material, material.init_state(), strains).block_until_ready()
        seconds = time.process_time() - start
        if line.strip():
            numpy.column_stack([strains, stresses]).astype("<f8").tofile(line.strip())
        print(repr(seconds), flush=True)


if __name__ == "__main__":
    main()
