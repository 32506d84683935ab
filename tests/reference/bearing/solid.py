"""Force on a bar that is pressed sideways into a block of Drucker-Prager concrete, in space: at depth, near a face, and as a dowel.

    python3 solid.py > solid.csv            (numpy, scipy and the package pullout_fe; five minutes of one processor)

Lengths in diameters of the bar, which runs along z from the free face z = 0. Half of a block, y >= 0: C3D20R between the hole and a
held cylinder of ten diameters; it stands on z = 8 without friction. A section of the bar is rigid and bonded to the half of the hole
in front of it, u_x = w(z), u_y = 0; the other half is free. The program's own law `drucker_prager` gives the stresses.

dowel   a steel bar that is pushed at the face, w(0) given, without a moment there; bending by the moments of its round section. What
        is in front of it changes sides where w changes its sign (at the end of the beam's run). `law` is the same bar on the bearing
        k f_c with k = min(5.07, sqrt(E u / f_c)) as a fine beam, `model_code` 1.3 sqrt(f_c f_y) of the Model Code 1990.
depth   a slab between two planes of symmetry, w the same everywhere: the plane problem of `dowel.py`.
face    the same w in the whole block: k against the distance from the free face.

The cone "plane_strain" is the one that dowel.py has; "outer" has the uniaxial strength f_c in space.
A row is a displacement (w, or w(0)) and a force over f_c: per length, or of the dowel.
"""

import math
import sys

import numpy as np
import pullout_fe as po
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

STRENGTH, MODULUS, FRICTION, DILATION = 40.0, 33e3, 37.0, 12.0
YIELD, STEEL = 1050.0, 200e3
RADIUS, DEPTH = 10.0, 8.0
PLACES = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3)
LIMIT = 5.07
CONES = ("plane_strain", "outer")

# corners and middles of edges of a C3D20 in its cube
CORNERS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
CUBE = np.array(CORNERS + [tuple((CORNERS[a][k] + CORNERS[b][k]) // 2 for k in range(3)) for a, b in EDGES])
GAUSS = np.array(CORNERS) / math.sqrt(3.0)


def graded(start, end, first, growth):
    sizes = []
    while sum(sizes) < end - start:
        sizes.append(first * growth ** len(sizes))
    return start + np.concatenate(([0.0], np.cumsum(sizes))) * (end - start) / sum(sizes)


def gradients(point):
    """Derivatives of the 20 shape functions."""
    x, result = np.array(point), np.zeros((20, 3))
    for number, node in enumerate(CUBE):
        if number < 8:
            f = 1.0 + node * x
            sum_ = node @ x - 2.0
            for k in range(3):
                others = np.prod(np.delete(f, k))
                result[number, k] = 0.125 * node[k] * others * (sum_ + f[k])
        else:
            flat = int(np.flatnonzero(node == 0)[0])
            f = np.where(node == 0, 1.0 - x * x, 1.0 + node * x)
            slope = np.where(node == 0, -2.0 * x, node)
            for k in range(3):
                result[number, k] = 0.25 * slope[k] * np.prod(np.delete(f, k))
            assert f[flat] == 1.0 - x[flat] ** 2
    return result


class Block:
    """Elements around the hole, from layer to layer of `heights`."""

    def __init__(self, heights, around, first, growth):
        radii = graded(0.5, RADIUS, first, growth)
        counts = (len(radii) - 1, around, len(heights) - 1)
        numbers, places, elements = {}, [], []
        at = lambda values, k: values[k // 2] if k % 2 == 0 else 0.5 * (values[k // 2] + values[k // 2 + 1])
        for i in range(counts[0]):
            for j in range(counts[1]):
                for k in range(counts[2]):
                    element = []
                    for a, b, c in np.array([2 * i + 1, 2 * j + 1, 2 * k + 1]) + CUBE:
                        if (a, b, c) not in numbers:
                            r, angle = at(radii, a), math.pi * b / (2 * around)
                            numbers[a, b, c] = len(places)
                            places.append((r * math.cos(angle), r * math.sin(angle), at(heights, c)))
                        element.append(numbers[a, b, c])
                    elements.append(element)
        self.places, self.elements = np.array(places), np.array(elements)
        self.indices = np.zeros((len(places), 3), int)
        for key, number in numbers.items():
            self.indices[number] = key
        self.last = 2 * np.array(counts)
        self.levels = np.array([at(heights, c) for c in range(self.last[2] + 1)])
        self.dofs = (3 * self.elements[:, :, None] + np.arange(3)).reshape(len(elements), 60)
        points = [gradients(point) for point in GAUSS]
        self.b = np.zeros((len(elements), 8, 6, 60))
        self.volumes = np.zeros((len(elements), 8))
        for q, slopes in enumerate(points):
            jacobian = np.einsum("nk,enl->ekl", slopes, self.places[self.elements])
            self.volumes[:, q] = np.linalg.det(jacobian)
            d = np.einsum("ekl,nl->enk", np.linalg.inv(jacobian), slopes)
            for row, (k, l) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
                self.b[:, q, row, k::3] += d[:, :, l]
                if k != l:
                    self.b[:, q, row, l::3] += d[:, :, k]
        assert (self.volumes > 0).all()


class Solid:
    """Equilibrium of a block with Newton's method; `bonded(x, z)` says which nodes of the hole are."""

    def __init__(self, block, bonded, is_slab, cone):
        sine, cosine = math.sin(math.radians(FRICTION)), math.cos(math.radians(FRICTION))
        self.law = po.Law("drucker_prager")
        self.props = self.law.props({"E": MODULUS, "nu": 0.2, "cohesion": STRENGTH * (1 - sine) / (2 * cosine),
                                     "friction_angle_deg": FRICTION, "dilation_angle_deg": DILATION, "cone": cone})
        self.block, n = block, len(block.places)
        shape = block.volumes.shape
        self.strain, self.stress, self.state = np.zeros((*shape, 6)), np.zeros((*shape, 6)), np.zeros((*shape, self.law.nstatv))
        i, j, k = block.indices.T
        x, _, z = block.places.T
        is_bonded = (i == 0) & bonded(x, z)
        levels = len(block.levels)
        # unknowns: -1 held, then the levels of the bar, then the rest
        self.map = np.full((n, 3), -2)
        self.map[i == block.last[0]] = -1
        self.map[(j == 0) | (j == block.last[1]) | is_bonded, 1] = -1
        self.map[k == block.last[2], 2] = -1
        if is_slab:
            self.map[k == 0, 2] = -1
        self.map[is_bonded, 0] = k[is_bonded]
        free = self.map == -2
        self.map[free] = levels + np.arange(free.sum())
        self.map = self.map.ravel()
        self.size, self.levels = levels + int(free.sum()), levels
        element_map = self.map[block.dofs]
        keep = element_map >= 0
        self.keep = keep
        self.rows = np.broadcast_to(element_map[:, :, None], (*element_map.shape, 60))
        self.columns = np.broadcast_to(element_map[:, None, :], (*element_map.shape, 60))
        self.pairs = (self.rows >= 0) & (self.columns >= 0)
        self.element_map = element_map

    def forces(self, increment, with_tangent=True):
        """Forces and tangent after an increment of the unknowns, and the new states."""
        full = np.append(increment, 0.0)[self.map]
        change = np.einsum("eqcd,ed->eqc", self.block.b, full[self.block.dofs])
        new = self.law.evaluate(self.strain, change, self.state, self.props, stress=self.stress, on_failure="nan")
        if not np.isfinite(new.stress).all():
            return None
        scaled = self.block.b * self.block.volumes[:, :, None, None]
        of_elements = np.einsum("eqcd,eqc->ed", scaled, new.stress)
        force = np.zeros(self.size)
        np.add.at(force, self.element_map[self.keep], of_elements[self.keep])
        local = np.einsum("eqcd,eqcf->edf", scaled, np.einsum("eqab,eqbf->eqaf", new.tangent, self.block.b), optimize=True)
        entries = (local[self.pairs], (self.rows[self.pairs], self.columns[self.pairs]))
        tangent = coo_matrix(entries, (self.size, self.size)).tocsr()
        return force, tangent, (self.strain + change, new.stress.copy(), new.state.copy())

    def accept(self, states):
        self.strain, self.stress, self.state = states


def moments(curvature):
    """Moment of the bar's round section and its derivative; the flow of the steel hardens by a thousandth of E."""
    y = (np.arange(40) + 0.5) / 40 - 0.5
    width = 2.0 * np.sqrt(0.25 - y * y) / 40
    width *= math.pi / 4 / width.sum()
    strain = curvature[..., None] * y
    flows = np.abs(strain) > YIELD / STEEL
    stress = np.where(flows, np.sign(strain) * YIELD + 1e-3 * STEEL * (strain - np.sign(strain) * YIELD / STEEL), STEEL * strain)
    modulus = np.where(flows, 1e-3 * STEEL, STEEL)
    return (stress * y * width).sum(-1), (modulus * y * y * width).sum(-1)


class Bar:
    """A beam of Hermite's elements between the levels: half of its forces, since the block is half of one. Unknowns: w, then slopes."""

    def __init__(self, levels):
        self.n, self.elements = len(levels), []
        for a, length in enumerate(np.diff(levels)):
            for s, weight in ((-math.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (math.sqrt(0.6), 5 / 9)):
                second = np.array([6 * s, (3 * s - 1) * length, -6 * s, (3 * s + 1) * length]) / length**2
                self.elements.append(([a, self.n + a, a + 1, self.n + a + 1], second, 0.25 * weight * length))
        self.dofs = np.array([e[0] for e in self.elements])
        self.second = np.array([e[1] for e in self.elements])
        self.weights = np.array([e[2] for e in self.elements])

    def forces(self, values):
        moment, modulus = moments((self.second * values[self.dofs]).sum(-1))
        force, tangent = np.zeros(2 * self.n), np.zeros((2 * self.n, 2 * self.n))
        np.add.at(force, self.dofs, (self.weights * moment)[:, None] * self.second)
        local = (self.weights * modulus)[:, None, None] * self.second[:, :, None] * self.second[:, None, :]
        np.add.at(tangent, (self.dofs[:, :, None], self.dofs[:, None, :]), local)
        return force, tangent


def newton(residual, start, held, tolerance=1e-5):
    """Solves for all unknowns that are not held; None if it does not converge. `residual(x)` gives forces, tangent, states."""
    free = np.setdiff1d(np.arange(len(start)), held)
    x, best = start.copy(), None
    answer = residual(x)
    for _ in range(25):
        if answer is None:
            return None
        force, tangent, states = answer
        scale = np.abs(force[held]).sum() + 1e-9
        error = np.abs(force[free]).max() / scale
        if error < tolerance:
            return x, force, states
        step = splu(tangent[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01,
                    options={"SymmetricMode": True}).solve(force[free])
        norm = np.linalg.norm(force[free])
        part = 1.0
        while True:
            trial = x.copy()
            trial[free] -= part * step
            answer = residual(trial)
            if answer is not None and (np.linalg.norm(answer[0][free]) < norm or part < 0.2):
                x = trial
                break
            part *= 0.5
            if part < 0.02:
                return None
    return None


def follow(solid, bar, held_of, places):
    """Ramps the displacement; yields (displacement, forces on the levels) at the places. Increments are halved where needed."""
    size = solid.size + (bar.n if bar else 0)
    n = solid.levels
    total, at, step = np.zeros(size), 0.0, places[0] / 2
    held = held_of(n)
    last = None
    for place in places:
        while at < place - 1e-12:
            step = min(step, place - at)
            start = last * (step / last_step) if last is not None else np.zeros(size)
            start[held] = step

            def residual(change):
                answer = solid.forces(change[: solid.size])
                if answer is None or bar is None:
                    return answer
                force, tangent, states = answer
                of = np.append(np.arange(n), solid.size + np.arange(n))
                bent, stiffness = bar.forces((total + change)[of])
                force = np.append(force, np.zeros(n))
                force[of] += bent
                i, j = np.nonzero(stiffness)
                tangent = tangent.tocoo()
                entries = (np.append(tangent.data, stiffness[i, j]), (np.append(tangent.row, of[i]), np.append(tangent.col, of[j])))
                return force, coo_matrix(entries, (size, size)).tocsr(), states

            answer = newton(residual, start, held)
            if answer is None:
                step, last = step / 2, None
                if step < 1e-5:
                    return
                continue
            change, force, states = answer
            solid.accept(states)
            total += change
            last, last_step, at = change, step, at + step
            print(f"# w {at:.5f} force {2 * force[held].sum() / STRENGTH:.4f}", file=sys.stderr, flush=True)
            step = 1.5 * step
        yield place, 2.0 * force[:n] / STRENGTH, total


def beam(places):
    """The dowel on its bearing by a fine beam: (place, force over f_c, (levels, w)). Its energy is convex: Newton's method with halving."""
    levels = graded(0.0, DEPTH, 0.04, 1.05)
    bar, n = Bar(levels), len(levels)
    share = np.zeros(n)
    share[:-1] += 0.25 * STRENGTH * np.diff(levels)
    share[1:] += 0.25 * STRENGTH * np.diff(levels)
    small = 1e-4  # the root, which begins with an endless slope, is a straight line up to here

    def forces(values):
        u = np.abs(values[:n])
        root = np.sqrt(MODULUS / STRENGTH * np.maximum(u, small))
        k = np.minimum(LIMIT, np.where(u < small, root * u / small, root))
        slope = np.where(k >= LIMIT, 1e-3, np.where(u < small, root / small, 0.5 * root / np.maximum(u, small)))
        force, tangent = bar.forces(values)
        force[:n] += share * k * np.sign(values[:n])
        tangent[np.arange(n), np.arange(n)] += share * slope
        return force, tangent

    values, at = np.zeros(2 * n), 0.0
    for place in places:
        for part in np.linspace(at, place, 21)[1:]:
            if values[0]:
                values *= part / values[0]
            values[0] = part
            force, tangent = forces(values)
            for _ in range(300):
                norm = np.linalg.norm(force[1:])
                if norm < 1e-8 * abs(force[0]):
                    break
                step, length = np.append(0.0, np.linalg.solve(tangent[1:, 1:], force[1:])), 1.0
                while True:
                    force, tangent = forces(values - length * step)
                    # downhill along the step, as far as it goes
                    if force @ step >= -1e-12 or length < 1e-4:
                        break
                    length *= 0.5
                values = values - length * step
            else:
                raise RuntimeError("the beam finds no balance")
        at = place
        yield place, 2.0 * force[0] / STRENGTH, (levels, values[:n].copy())


def main():
    print("problem,cone,z_over_diameter,u_over_diameter,force,law")
    show = lambda name, cone, z, place, force, law: print(f"{name},{cone},{z},{place:g},{force:.3f},{law:.3f}", flush=True)
    root = lambda u: min(LIMIT, math.sqrt(MODULUS / STRENGTH * u))
    everywhere = lambda x, z: x > -1e-9

    beams, turn = {}, 0.0
    for place, force, (levels, w) in beam(PLACES):
        beams[place], first = force, int(np.argmax(w < 0)) + 1
        turn = float(np.interp(0.0, -w[:first], levels[:first]))
    heights = graded(0.0, DEPTH, 0.2, 1.35)
    block = Block(heights, 6, 0.25, 1.6)
    turned = lambda x, z: np.where(z < turn, x > -1e-9, x < 1e-9)
    for cone in CONES:
        for place, forces, _ in follow(Solid(block, turned, False, cone), Bar(block.levels), lambda n: np.array([0]), PLACES):
            show("dowel", cone, "", place, forces[0], beams[place])
    print(f"model_code,,,,{1.3 * math.sqrt(YIELD / STRENGTH):.3f},", flush=True)

    slab = Block(np.array([0.0, 0.5]), 12, 0.125, 1.2)
    for place, forces, _ in follow(Solid(slab, everywhere, True, CONES[0]), None, np.arange, PLACES):
        show("depth", CONES[0], "", place, forces.sum() / 0.5, root(place))
    for place, forces, _ in follow(Solid(block, everywhere, False, CONES[0]), None, np.arange, PLACES):
        for m, length in enumerate(np.diff(heights)):
            # the middle of an element has four sixths of its load
            show("face", CONES[0], f"{block.levels[2 * m + 1]:.3f}", place, forces[2 * m + 1] / (4 / 6 * length), root(place))


if __name__ == "__main__":
    main()
