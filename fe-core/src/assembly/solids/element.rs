//! One element: from end displacements to internal forces and stiffness.

use super::heat::ElementCoupling;
use super::kernel::{Nodal, PointShape, add_product, mirror};
use super::points::{PointIncrement, Points, is_symmetric};
use super::record::number_of;
use super::{LEAST_VOLUME_RATIO, TangentChoice};
use crate::assembly::{Setback, USUAL_FRACTION};
use crate::element::MAX_NODES;
use crate::kinematics::finite::{
    AverageRates, Components, FiniteIncrement, GRADIENT_COMPONENTS, Gradient, IDENTITY, Moduli, NominalTangent, mean,
    nominal_tangent, small_strain, with_mean,
};
use umat_abi::law::Request;

/// The most points that an element has.
pub(super) const MAX_POINTS: usize = 9;

/// Trouble at a point of the element.
pub(super) type ElementTrouble = (usize, Setback);

/// The reference configuration of one element.
pub(super) struct ReferenceElement<'a, const N: usize> {
    /// ∂N/∂X at each point.
    pub(super) gradients: &'a [Nodal<N>],
    /// Shape functions at each point.
    pub(super) values: &'a [[f64; MAX_NODES]],
    /// dV of each point.
    pub(super) volumes: &'a [f64],
    /// Reference position of each point.
    pub(super) positions: &'a [[f64; 2]],
    /// Whether x is a radius.
    pub(super) axisymmetric: bool,
    /// B-bar.
    pub(super) average: bool,
    /// The element's first point among those of its block.
    pub(super) first_point: usize,
}

impl<'a, const N: usize> ReferenceElement<'a, N> {
    fn points(&self) -> std::ops::Range<usize> {
        0..self.volumes.len()
    }

    fn at(&self, point: usize) -> PointShape<'a, N> {
        let hoop = self.axisymmetric.then(|| {
            let radius = self.positions[point][0];
            std::array::from_fn(|node| self.values[point][node] / radius)
        });
        PointShape { gradients: &self.gradients[point], hoop }
    }

    /// Σ value dV.
    fn integral(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.points().map(|point| value(point) * self.volumes[point]).sum()
    }
}

/// Request to an element.
#[derive(Clone, Copy)]
pub(super) struct Task {
    pub(super) request: Request,
    pub(super) choice: TangentChoice,
}

/// Small strains: the points advance to the strain of `end`; `forces` become ∫ Bᵀ σ dV. `changed` is set when a
/// tangent is another one.
pub(super) fn advance_small<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    points: &mut Points,
    end: &Nodal<N>,
    task: Task,
    forces: &mut Nodal<N>,
    changed: &mut bool,
) -> Result<(), ElementTrouble> {
    let mut strains = [[0.0; 4]; MAX_POINTS];
    for point in shape.points() {
        strains[point] = small_strain(shape.at(point).gradient(end));
    }
    if shape.average {
        let dilatation = shape.integral(|point| 3.0 * mean(&strains[point])) / shape.integral(|_| 1.0);
        strains[shape.points()].iter_mut().for_each(|strain| *strain = with_mean(strain, dilatation / 3.0));
    }
    for point in shape.points() {
        let index = shape.first_point + point;
        let start = points.committed.strain[index];
        let increment = PointIncrement { strain: std::array::from_fn(|k| strains[point][k] - start[k]), motion: None };
        let [x, y] = shape.positions[point];
        (points.call.coords, points.call.npt) = ([x, y, 0.0], number_of(point));
        *changed |= points.advance(index, &increment, task.request, task.choice).map_err(|trouble| (point, trouble))?;
        // What the displacements say, not a sum of increments.
        points.set_trial_strain(index, strains[point]);
    }
    let pressure = mean_stress(shape, points, |_| 1.0);
    *forces = [[0.0; 2]; N];
    for point in shape.points() {
        let stress = shared_stress(&points.acting[shape.first_point + point], pressure);
        shape.at(point).add_conjugate(&symmetric_gradient(&stress), shape.volumes[point], forces);
    }
    Ok(())
}

/// p̄ of an element with averaged dilatation.
fn mean_stress<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    points: &Points,
    ratio: impl Fn(usize) -> f64,
) -> Option<f64> {
    shape.average.then(|| {
        let pressure = |point: usize| mean(&points.acting[shape.first_point + point]);
        shape.integral(|point| pressure(point) * ratio(point)) / shape.integral(&ratio)
    })
}

/// The stress that nodal forces see.
fn shared_stress(stress: &Components, pressure: Option<f64>) -> Components {
    pressure.map_or(*stress, |pressure| with_mean(stress, pressure))
}

/// A symmetric tensor as a gradient.
fn symmetric_gradient([s11, s22, s33, s12]: &Components) -> Gradient {
    [*s11, *s12, *s12, *s22, *s33]
}

/// Component of stress or strain for each component of a gradient.
const COMPONENT_OF: [usize; GRADIENT_COMPONENTS] = [0, 3, 3, 1, 2];

/// ∫ Bᵀ C B dV. Returns whether it is symmetric.
pub(super) fn stiffness_small<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    moduli: &[Moduli],
    stiffness: &mut [Nodal<N>],
) -> bool {
    stiffness.fill([[0.0; 2]; N]);
    let symmetric = moduli.iter().all(is_symmetric);
    let mut average = Average::<N>::default_of(shape);
    for point in shape.points() {
        let at = shape.at(point);
        let volume = shape.volumes[point];
        let moduli = match &mut average {
            None => moduli[point],
            Some(average) => average.add_small(&at, volume, &moduli[point]),
        };
        let tangent = COMPONENT_OF.map(|row| COMPONENT_OF.map(|column| moduli[row][column]));
        if symmetric {
            at.add_stiffness::<true>(&tangent, volume, stiffness);
        } else {
            at.add_stiffness::<false>(&tangent, volume, stiffness);
        }
    }
    if let Some(average) = &average {
        average.add_to(stiffness);
    }
    if symmetric {
        mirror(stiffness);
    }
    symmetric
}

/// The motions of the points of an element.
pub(super) type Motions = [FiniteIncrement; MAX_POINTS];

/// Large displacements: the points advance from `start` to `end`; `forces` become ∫ σ ∂N/∂x dv over the end.
pub(super) fn advance_finite<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    points: &mut Points,
    [start, end]: [&Nodal<N>; 2],
    task: Task,
    forces: &mut Nodal<N>,
    changed: &mut bool,
) -> Result<Motions, ElementTrouble> {
    let (motions, gradients) = motions(shape, [start, end])?;
    let dilatation = mean_dilatation(shape, &motions);
    for point in shape.points() {
        let mut strain = motions[point].strain_increment();
        if let Some(dilatation) = dilatation {
            strain = with_mean(&strain, dilatation / 3.0);
        }
        let [f0, f1] = &gradients[point];
        let increment = PointIncrement { strain, motion: Some((&motions[point], f0, f1)) };
        let [x, y] = present_position(shape.positions[point], &shape.values[point], end);
        (points.call.coords, points.call.npt) = ([x, y, 0.0], number_of(point));
        *changed |= points
            .advance(shape.first_point + point, &increment, task.request, task.choice)
            .map_err(|trouble| (point, trouble))?;
    }
    let pressure = mean_stress(shape, points, |point| motions[point].volume_ratio);
    *forces = [[0.0; 2]; N];
    for point in shape.points() {
        let stress = shared_stress(&points.acting[shape.first_point + point], pressure);
        shape.at(point).add_conjugate(&motions[point].nominal_stress(&stress), shape.volumes[point], forces);
    }
    Ok(motions)
}

/// The motions of the points, and F at the start and at the end.
pub(super) fn motions<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    ends: [&Nodal<N>; 2],
) -> Result<(Motions, [[Gradient; 2]; MAX_POINTS]), ElementTrouble> {
    let mut motions = [FiniteIncrement::REST; MAX_POINTS];
    let mut gradients = [[IDENTITY; 2]; MAX_POINTS];
    for point in shape.points() {
        let at = shape.at(point);
        gradients[point] = ends.map(|displacements| {
            let h = at.gradient(displacements);
            std::array::from_fn(|k| IDENTITY[k] + h[k])
        });
        motions[point] = motion(&gradients[point]).map_err(|trouble| (point, trouble))?;
    }
    Ok((motions, gradients))
}

fn motion([start, end]: &[Gradient; 2]) -> Result<FiniteIncrement, Setback> {
    let trouble = |reason: String| Setback { reason, fraction: Some(USUAL_FRACTION) };
    let motion = FiniteIncrement::new(start, end).map_err(|error| trouble(error.to_string()))?;
    if motion.volume_ratio < LEAST_VOLUME_RATIO {
        let ratio = motion.volume_ratio;
        return Err(trouble(format!("the volume ratio (det F) is {ratio:.4}, less than {LEAST_VOLUME_RATIO}")));
    }
    Ok(motion)
}

/// θ̄ of an element with averaged dilatation.
fn mean_dilatation<const N: usize>(shape: &ReferenceElement<'_, N>, motions: &Motions) -> Option<f64> {
    shape.average.then(|| {
        let ratio = |point: usize| motions[point].middle_volume_ratio;
        shape.integral(|point| motions[point].dilatation() * ratio(point)) / shape.integral(ratio)
    })
}

/// x + Σ N_i u_i.
pub(super) fn present_position([mut x, mut y]: [f64; 2], values: &[f64], displacements: &[[f64; 2]]) -> [f64; 2] {
    for ([u, v], value) in displacements.iter().zip(values) {
        x += value * u;
        y += value * v;
    }
    [x, y]
}

/// Computes the derivative of the forces of [`advance_finite`], which is not symmetric.
pub(super) fn stiffness_finite<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    motions: &Motions,
    points: &Points,
    stiffness: &mut [Nodal<N>],
) {
    stiffness.fill([[0.0; 2]; N]);
    let first = shape.first_point;
    let mut average = Average::<N>::default_of(shape);
    if let Some(average) = &mut average {
        average.start(shape, motions, points);
    }
    for point in shape.points() {
        let (stress, moduli) = (&points.acting[first + point], &points.acting_moduli(first + point));
        let (at, volume) = (shape.at(point), shape.volumes[point]);
        let tangent = match &mut average {
            None => nominal_tangent(&motions[point], stress, moduli),
            Some(average) => average.add_finite(&at, volume, &motions[point], stress, moduli),
        };
        at.add_stiffness::<false>(&tangent, volume, stiffness);
    }
    if let Some(average) = &average {
        average.add_to(stiffness);
    }
}

/// ∫ ∂N/∂X · ∂P/∂θ N_j dV, and ∫ N_i ∂r/∂ε ∂ε/∂u dV. Two changes are left out: of a thickness with θ, and of the weights by which the
/// dilatation is averaged under large displacements with u.
pub(super) fn coupling<const N: usize>(
    shape: &ReferenceElement<'_, N>,
    points: &Points,
    motions: Option<&Motions>,
) -> ElementCoupling {
    let [mut force_by_field, mut source_by_displacement] = [[[[0.0; 2]; N]; N]; 2];
    let ratio = |point: usize| motions.map_or(1.0, |motions| motions[point].volume_ratio);
    let middle_ratio = |point: usize| motions.map_or(1.0, |motions| motions[point].middle_volume_ratio);
    for node in 0..N {
        let rates = |point: usize| {
            let value = shape.values[point][node];
            points.coupling(shape.first_point + point).map(|rates| rates.map(|rate| value * rate))
        };
        let means = shape.average.then(|| {
            let pressure = shape.integral(|point| mean(&rates(point)[0]) * ratio(point)) / shape.integral(ratio);
            (pressure, shape.integral(|point| mean(&rates(point)[1])) / shape.integral(middle_ratio))
        });
        for point in shape.points() {
            let [mut stress, mut source] = rates(point);
            if let Some((pressure, of_dilatation)) = means {
                stress = with_mean(&stress, pressure);
                source = with_mean(&source, of_dilatation * middle_ratio(point));
            }
            let [force, by_displacement] = match motions {
                None => [symmetric_gradient(&stress), symmetric_gradient(&source)],
                Some(motions) => [motions[point].nominal_stress(&stress), motions[point].strain_conjugate(&source)],
            };
            let (at, volume) = (shape.at(point), shape.volumes[point]);
            at.add_conjugate(&force, volume, &mut force_by_field[node]);
            at.add_conjugate(&by_displacement, volume, &mut source_by_displacement[node]);
        }
    }
    let flat = |nodal: [Nodal<N>; N]| nodal.as_flattened().as_flattened().to_vec();
    ElementCoupling { force_by_field: flat(force_by_field), source_by_displacement: flat(source_by_displacement) }
}

/// Contribution of the means over an element to its stiffness: (∂f/∂θ̄) ⊗ ∂θ̄/∂u + (∂f/∂p̄) ⊗ ∂p̄/∂u.
struct Average<const N: usize> {
    force_by_dilatation: Nodal<N>,
    force_by_pressure: Nodal<N>,
    dilatation: Nodal<N>,
    /// ∂p̄/∂u at fixed θ̄.
    pressure: Nodal<N>,
    pressure_by_dilatation: f64,
    /// Σ dv at the end and at the middle.
    volume: f64,
    middle_volume: f64,
    mean_dilatation: f64,
    mean_pressure: f64,
}

impl<const N: usize> Average<N> {
    /// Returns an average of zeros over the reference volume; `None` for an element that is not averaged.
    fn default_of(shape: &ReferenceElement<'_, N>) -> Option<Self> {
        let zero = [[0.0; 2]; N];
        shape.average.then(|| {
            let volume = shape.integral(|_| 1.0);
            Self {
                force_by_dilatation: zero,
                force_by_pressure: zero,
                dilatation: zero,
                pressure: zero,
                pressure_by_dilatation: 0.0,
                volume,
                middle_volume: volume,
                mean_dilatation: 0.0,
                mean_pressure: 0.0,
            }
        })
    }

    /// The means under large displacements.
    fn start(&mut self, shape: &ReferenceElement<'_, N>, motions: &Motions, points: &Points) {
        self.volume = shape.integral(|point| motions[point].volume_ratio);
        self.mean_pressure = mean_stress(shape, points, |point| motions[point].volume_ratio).unwrap_or_default();
        self.middle_volume = shape.integral(|point| motions[point].middle_volume_ratio);
        self.mean_dilatation = mean_dilatation(shape, motions).unwrap_or_default();
    }

    /// Adds a point of small strains; returns its moduli between deviators.
    fn add_small(&mut self, at: &PointShape<'_, N>, volume: f64, moduli: &Moduli) -> Moduli {
        const DIRECT: std::ops::Range<usize> = 0..3;
        // Of a unit θ̄, by row; of a unit strain, the mean by column.
        let by_dilatation: Components = std::array::from_fn(|row| moduli[row][DIRECT].iter().sum::<f64>() / 3.0);
        let pressure: Components =
            std::array::from_fn(|column| DIRECT.map(|row| moduli[row][column]).sum::<f64>() / 3.0);
        let stiffness = mean(&by_dilatation);
        let deviator = |k: usize, entry: f64, of_mean: f64| if k < 3 { entry - of_mean } else { entry };
        let by_dilatation_deviator: Components =
            std::array::from_fn(|row| deviator(row, by_dilatation[row], stiffness));
        let pressure_deviator: Components = std::array::from_fn(|column| deviator(column, pressure[column], stiffness));
        at.add_conjugate(&symmetric_gradient(&by_dilatation_deviator), volume, &mut self.force_by_dilatation);
        at.add_conjugate(&symmetric_gradient(&pressure_deviator), volume / self.volume, &mut self.pressure);
        at.add_conjugate(&IDENTITY, volume, &mut self.force_by_pressure);
        at.add_conjugate(&IDENTITY, volume / self.volume, &mut self.dilatation);
        self.pressure_by_dilatation += stiffness * volume / self.volume;
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let without_column = deviator(column, moduli[row][column], by_dilatation[row]);
                deviator(row, without_column, pressure_deviator[column])
            })
        })
    }

    /// Adds a point of large displacements; returns ∂P/∂F at fixed means.
    fn add_finite(
        &mut self,
        at: &PointShape<'_, N>,
        volume: f64,
        motion: &FiniteIncrement,
        stress: &Components,
        moduli: &Moduli,
    ) -> NominalTangent {
        let (tangent, rates) = AverageRates::of(motion, stress, self.mean_pressure, moduli);
        at.add_conjugate(&rates.by_dilatation, volume, &mut self.force_by_dilatation);
        at.add_conjugate(&rates.by_pressure, volume, &mut self.force_by_pressure);
        at.add_conjugate(&rates.pressure, volume / self.volume, &mut self.pressure);
        self.pressure_by_dilatation += volume / self.volume * rates.pressure_by_dilatation;
        let middle = volume * motion.middle_volume_ratio / self.middle_volume;
        at.add_conjugate(&rates.dilatation, middle, &mut self.dilatation);
        let excess = motion.dilatation() - self.mean_dilatation;
        at.add_conjugate(&rates.middle_volume, middle * excess, &mut self.dilatation);
        tangent
    }

    fn add_to(&self, stiffness: &mut [Nodal<N>]) {
        add_product(&self.force_by_dilatation, &self.dilatation, stiffness);
        let pressure: Nodal<N> = std::array::from_fn(|node| {
            std::array::from_fn(|k| self.pressure[node][k] + self.pressure_by_dilatation * self.dilatation[node][k])
        });
        add_product(&self.force_by_pressure, &pressure, stiffness);
    }
}
