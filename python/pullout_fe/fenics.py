"""Laws in dolfinx: models with the interface of fenics-constitutive (``IncrSmallStrainModel``). They do not need dolfinx themselves."""

from __future__ import annotations

import importlib
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .case import array_of
from .errors import CaseError
from .law import Law, Mode, Props

__all__ = ["Constraint", "SmallStrainModel"]

Array = NDArray[np.float64]


class Constraint(NamedTuple):
    """A stand-in for fenics-constitutive's ``StressStrainConstraint`` if that is not installed."""

    name: str
    stress_strain_dim: int
    geometric_dim: int


#: by name: our mode, and which of the Mandel components our components are
_MODES: dict[str, tuple[Mode, list[int]]] = {
    "FULL": ("3d", [0, 1, 2, 3, 4, 5]),
    "PLANE_STRAIN": ("plane_strain", [0, 1, 2, 3]),
    "PLANE_STRESS": ("plane_stress", [0, 1, 3]),
}


class SmallStrainModel:
    """A law for all integration points of a mesh.

    Stresses, strains and tangents are in Mandel notation, in flat arrays with one point after the other. The history has the
    total strains and the law's states. ``history_dim`` gives their numbers, and they begin as zeros. If the library sets initial
    states or stresses (SDVINI, SIGINI), the history also has ``begun``, a mark that it has done so. ``length`` is the
    characteristic length of the elements, one number or one per point; laws with a crack band (``G_f``) need it. ``coords``:
    positions of the points, (n, 3).

    If the law refuses a point, :class:`~pullout_fe.UpdateFailed` is raised; the caller then tries a smaller increment.
    """

    def __init__(
        self,
        law: Law | str,
        props: Props = None,
        constraint: Any = "FULL",
        *,
        length: Any = None,
        coords: Any = None,
        threads: int = 1,
    ) -> None:
        self.law = law if isinstance(law, Law) else Law(law)
        self.props = self.law.props(props)
        self.law._check_length(self.props, length)
        self.length, self.coords, self.threads = length, coords, threads
        # the solver compares enumerators: return the one that was given
        self._constraint = None if isinstance(constraint, str) else constraint
        name = constraint if isinstance(constraint, str) else constraint.name
        if name not in _MODES:
            raise CaseError([("constraint", f"'{name}' is not one of {', '.join(_MODES)}")])
        self._name = name
        self._mode, self._components = _MODES[name]
        # Mandel's shear strains are engineering's over √2, its shear stresses ours times √2
        self._factors = np.array([1.0 if component < 3 else np.sqrt(2.0) for component in self._components])

    @property
    def constraint(self) -> Any:
        """The given enumerator; for a name, that of fenics-constitutive, or a :class:`Constraint`."""
        if self._constraint is not None:
            return self._constraint
        # up to 0.1.2 the package itself has it, later its models
        for module in ("fenics_constitutive.models", "fenics_constitutive"):
            try:
                return importlib.import_module(module).StressStrainConstraint[self._name]
            except (ImportError, AttributeError):
                continue
        return Constraint(self._name, self.stress_strain_dim, self.geometric_dim)

    @property
    def stress_strain_dim(self) -> int:
        """Components of stress and strain: 6, or 4 in a plane."""
        return 6 if self._name == "FULL" else 4

    @property
    def geometric_dim(self) -> int:
        """Dimensions of space."""
        return 3 if self._name == "FULL" else 2

    @property
    def history_dim(self) -> dict[str, int | tuple[int, int]]:
        """Number of values per point that the caller keeps, by name."""
        dimensions: dict[str, int | tuple[int, int]] = {"strain": len(self._components)}
        if self.law.nstatv > 0:
            dimensions["state"] = self.law.nstatv
        if self.law._sets_start:
            dimensions["begun"] = 1
        return dimensions

    def evaluate(
        self,
        t: float,
        del_t: float,
        grad_del_u: Array,
        stress: Array,
        tangent: Array | None,
        history: dict[str, Array] | None,
    ) -> None:
        """Overwrite stress, tangent and history with those at the end of the increment."""
        if history is None:
            raise CaseError([("history", "is needed: it keeps the strains")])
        dimension, components = self.stress_strain_dim, self._components
        increment = self._strain(array_of(grad_del_u, "grad_del_u"))
        strain = history["strain"].reshape(-1, len(components))
        state = history["state"].reshape(-1, self.law.nstatv) if self.law.nstatv > 0 else None
        mandel = stress.reshape(-1, dimension)
        own = mandel[:, components] / self._factors
        begun = history["begun"].reshape(-1) if self.law._sets_start else None
        if begun is not None and not begun.all():
            first, first_state = self.law.initial(len(strain), mode=self._mode, coords=self.coords)
            is_first = begun == 0.0
            # a stress that the caller has set is the start
            own[is_first] = np.where(own[is_first].any(axis=1, keepdims=True), own[is_first], first[is_first])
            state = None if state is None else np.where(is_first[:, None], first_state, state)
        update = self.law.evaluate(
            strain,
            increment,
            state,
            self.props,
            mode=self._mode,
            stress=own,
            tangent=tangent is not None,
            threads=self.threads,
            length=self.length,
            coords=self.coords,
            time=t,
            # laws divide by it
            dtime=1e-12 if del_t == 0.0 else del_t,
        )
        mandel[:, components] = update.stress * self._factors
        strain += increment
        if state is not None:
            history["state"].reshape(update.state.shape)[...] = update.state
        if begun is not None:
            begun[:] = 1.0
        if tangent is not None and update.tangent is not None:
            moduli = tangent.reshape(-1, dimension, dimension)
            moduli[...] = 0.0
            moduli[:, np.array(components)[:, None], components] = update.tangent * np.outer(self._factors, self._factors)

    def evaluate_without_tangent(
        self, t: float, del_t: float, grad_del_u: Array, stress: Array, history: dict[str, Array] | None
    ) -> None:
        """Like :meth:`evaluate`, without the tangent; faster."""
        self.evaluate(t, del_t, grad_del_u, stress, None, history)

    def update(self) -> None:
        """Do nothing: the history holds the whole state of a point."""

    def _strain(self, gradient: Array) -> Array:
        """Return strains with engineering shear, in our order, from gradients row by row."""
        size = self.geometric_dim
        gradient = gradient.reshape(-1, size, size)
        strain = np.zeros((len(gradient), 6))
        for k in range(size):
            strain[:, k] = gradient[:, k, k]
        strain[:, 3] = gradient[:, 0, 1] + gradient[:, 1, 0]
        if size == 3:
            strain[:, 4] = gradient[:, 0, 2] + gradient[:, 2, 0]
            strain[:, 5] = gradient[:, 1, 2] + gradient[:, 2, 1]
        return np.ascontiguousarray(strain[:, self._components])
