//! The uniform strains and stresses that displacements and loads of the nodes prescribe.

use super::element::Brick;
use super::keywords::LinePosition;
use super::model::{Change, Model, Quantity};
use std::collections::{BTreeMap, BTreeSet};

/// Names of the strains in cases.
pub(super) const STRAINS: [&str; 6] = ["e11", "e22", "e33", "g12", "g13", "g23"];
/// Names of the stresses in cases.
pub(super) const STRESSES: [&str; 6] = ["s11", "s22", "s33", "s12", "s13", "s23"];
/// Components of the shears, and the two axes of each.
const SHEARS: [(usize, usize, usize); 3] = [(3, 0, 1), (4, 0, 2), (5, 1, 2)];
/// Relative difference of values that are the same.
pub(super) const SAME: f64 = 1e-6;

/// A matrix, row by row.
pub(super) type Matrix = [[f64; 3]; 3];

/// A quantity from the start of a step to its end.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Value at the start; `None`: that of a free node.
    pub(super) from: Option<f64>,
    pub(super) change: Change,
}

/// Values of all quantities at some time.
pub(super) type Values<'c> = BTreeMap<Quantity, (f64, &'c Change)>;

/// What is prescribed of a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Control {
    Strain(f64),
    Stress(f64),
}

/// What is prescribed at some time.
#[derive(Clone, Debug)]
pub(super) struct Target {
    /// Of each component that the mode has.
    pub(super) controls: [Option<Control>; 6],
    /// The deformation gradient, where rotations matter.
    pub(super) gradient: Option<Matrix>,
}

/// The axes that a component couples.
pub(super) fn axes_of(component: usize) -> [usize; 2] {
    SHEARS.iter().find(|(shear, ..)| *shear == component).map_or([component; 2], |(_, i, j)| [*i, *j])
}

/// What the nodes prescribe, and what is noticed on the way.
pub(super) struct Loading<'m> {
    model: &'m Model,
    brick: &'m Brick,
    nlgeom: bool,
    is_turned: bool,
    pub(super) left_out: Vec<String>,
    /// Shear strains that are held at 0 though nodes are free to shear the element.
    pub(super) loose_shears: BTreeSet<&'static str>,
}

impl<'m> Loading<'m> {
    pub(super) fn new(model: &'m Model, brick: &'m Brick, nlgeom: bool) -> Self {
        Self { model, brick, nlgeom, is_turned: false, left_out: Vec::new(), loose_shears: BTreeSet::new() }
    }

    /// Returns the strains and stresses that values prescribe.
    ///
    /// # Errors
    /// They are not those of a uniform state, with the place of one of them.
    pub(super) fn target(&mut self, values: &Values<'_>) -> Result<Target, String> {
        let (brick, model) = (self.brick, self.model);
        let dimensions = brick.shape.dimensions;
        let mut gradient = [[None; 3]; 3];
        for axis in 0..dimensions {
            gradient[axis] = displacement_gradient(values, brick, model, axis)?;
            let is_partial = gradient[axis][axis].is_some() && !is_enforced(values, brick, model, axis, axis);
            if let Some((.., place)) = displacements(values, model, axis).last().filter(|_| is_partial) {
                let message =
                    "a displacement of only some nodes of a face: the case has uniform strain, as if all nodes had it";
                let omission = format!("{place}: {message}");
                if !self.left_out.contains(&omission) {
                    self.left_out.push(omission);
                }
            }
        }
        let stresses = stresses(values, brick, model)?;
        let mut controls = [None; 6];
        let mut is_sheared = false;
        for (component, i, j) in SHEARS.into_iter().filter(|(_, i, j)| *i < dimensions && *j < dimensions) {
            let pair = [gradient[i][j], gradient[j][i]];
            is_sheared |= pair.iter().flatten().any(|entry| *entry != 0.0);
            controls[component] = Some(Control::Stress(0.0));
            // a free one of the two turns the element instead
            let [Some(a), Some(b)] = pair else { continue };
            controls[component] = Some(Control::Strain(a + b));
            let is_enforced = is_enforced(values, brick, model, i, j) && is_enforced(values, brick, model, j, i);
            if !is_enforced && a + b != 0.0 {
                return Err(self.free_faces(values, component, [i, j]));
            }
            if !is_enforced {
                self.loose_shears.insert(STRAINS[component]);
            }
        }
        let mut hoop = None;
        if brick.is_axisymmetric() {
            hoop = hoop_strain(values, brick, model, gradient[0][0])?;
        }
        let in_plane = (0..dimensions).map(|axis| (axis, gradient[axis][axis], stresses[axis]));
        let around = brick.is_axisymmetric().then_some((2, hoop, stresses[0]));
        for (axis, strain, stress) in in_plane.chain(around) {
            controls[axis] = Some(strain.map_or(Control::Stress(stress), Control::Strain));
        }
        let mut target = Target { controls, gradient: None };
        if self.nlgeom && (is_sheared || self.is_turned) {
            let place = first_place(values).unwrap_or_default();
            let refusal =
                || format!("{place}: a shear at large deformations with free displacements: its rotation is not known");
            let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            for i in 0..dimensions {
                for j in 0..dimensions {
                    rows[i][j] += gradient[i][j].ok_or_else(refusal)?;
                }
            }
            if brick.is_axisymmetric() {
                rows[2][2] += hoop.ok_or_else(refusal)?;
            }
            // strains alone would keep the rotation of a step before
            self.is_turned = true;
            target.gradient = Some(rows);
        }
        Ok(target)
    }

    /// Returns why a shear is not that of the element.
    fn free_faces(&self, values: &Values<'_>, component: usize, axes: [usize; 2]) -> String {
        let given = axes.into_iter().flat_map(|axis| displacements(values, self.model, axis));
        let place = given.filter(|(_, value, _)| *value != 0.0).last().map(|(.., place)| place.to_string());
        format!(
            "{}: {} is not uniform in the element: nodes are free along {} or {}. A uniform shear needs both \
             displacements of all nodes",
            place.unwrap_or_default(),
            STRAINS[component],
            axes[0] + 1,
            axes[1] + 1
        )
    }
}

/// Returns whether the displacement along an axis is prescribed wherever a stress on the faces normal to another one has a
/// nodal force: at all nodes except those half-way between these faces.
fn is_enforced(values: &Values<'_>, brick: &Brick, model: &Model, axis: usize, normal: usize) -> bool {
    let prescribed: BTreeSet<usize> = displacements(values, model, axis).map(|(node, ..)| node).collect();
    (0..brick.nodes.len()).all(|node| brick.nodes[node][normal] == 0.5 || prescribed.contains(&node))
}

fn first_place(values: &Values<'_>) -> Option<String> {
    values.values().next().map(|(_, change)| change.place.to_string())
}

/// The displacements along an axis that nodes of the element have prescribed: node, value, place.
fn displacements<'v>(
    values: &'v Values<'_>,
    model: &'v Model,
    axis: usize,
) -> impl Iterator<Item = (usize, f64, &'v LinePosition)> {
    values.iter().filter_map(move |(quantity, (value, change))| match *quantity {
        Quantity::Displacement(node, along) if along == axis => {
            Some((model.node_in_element(node)?, *value, &change.place))
        }
        _ => None,
    })
}

/// Returns what the displacements along an axis say of their gradient.
fn displacement_gradient(
    values: &Values<'_>,
    brick: &Brick,
    model: &Model,
    axis: usize,
) -> Result<[Option<f64>; 3], String> {
    let prescribed: Vec<(usize, f64)> =
        displacements(values, model, axis).map(|(node, value, _)| (node, value)).collect();
    brick.gradient(&prescribed, axis).map_err(|reason| {
        let place = displacements(values, model, axis).last().map(|(.., place)| format!("{place}: "));
        format!("{}the displacements along {} {reason}", place.unwrap_or_default(), axis + 1)
    })
}

/// u/r, where displacements prescribe it.
fn hoop_strain(values: &Values<'_>, brick: &Brick, model: &Model, radial: Option<f64>) -> Result<Option<f64>, String> {
    if brick.origin[0].abs() <= SAME * brick.edges[0] {
        return Ok(radial);
    }
    let mut strains = Vec::new();
    let mut sides = BTreeSet::new();
    for (node, value, _) in displacements(values, model, 0) {
        let share = brick.nodes[node][0];
        strains.push(value / (brick.origin[0] + share * brick.edges[0]));
        sides.insert(share > 0.5);
    }
    let is_uniform = |radial: f64| strains.iter().all(|strain| (strain - radial).abs() <= SAME * radial.abs());
    match radial {
        Some(radial) if sides.len() > 1 && is_uniform(radial) => Ok(Some(radial)),
        _ => {
            let place = first_place(values).unwrap_or_default();
            Err(format!("{place}: an axisymmetric element off the axis is strained uniformly only by u = k r"))
        }
    }
}

/// Normal stresses of the loads on the faces.
fn stresses(values: &Values<'_>, brick: &Brick, model: &Model) -> Result<[f64; 3], String> {
    // of each axis: of its near and its far face
    let mut tractions: BTreeMap<usize, BTreeMap<bool, f64>> = BTreeMap::new();
    let mut forces: BTreeMap<(usize, bool), Vec<f64>> = BTreeMap::new();
    let mut places = BTreeMap::new();
    for (quantity, (value, change)) in values {
        let place = &change.place;
        match *quantity {
            Quantity::Pressure { face, .. } => {
                let normal = brick.normal(face).ok_or_else(|| format!("{place}: there is no face {face}"))?;
                let (axis, is_far) = normal;
                *tractions.entry(axis).or_default().entry(is_far).or_insert(0.0) -= value;
                places.insert(axis, place);
            }
            Quantity::Force(node, axis) => {
                let Some(node) = model.node_in_element(node) else { continue };
                if brick.is_axisymmetric() || brick.shape.nodes > brick.shape.corners || axis >= brick.shape.dimensions
                {
                    return Err(format!("{place}: forces at nodes of such an element cannot be imported: use *DSLOAD"));
                }
                forces.entry((axis, brick.nodes[node][axis] > 0.5)).or_default().push(*value);
                places.insert(axis, place);
            }
            _ => {}
        }
    }
    for ((axis, is_far), forces) in forces {
        let place = places[&axis];
        let is_even = forces.iter().all(|force| (force - forces[0]).abs() <= SAME * forces[0].abs());
        let is_zero = forces.iter().all(|force| *force == 0.0);
        if !is_zero && (forces.len() != brick.shape.corners / 2 || !is_even) {
            return Err(format!("{place}: forces that are not the same at all nodes of a face make no uniform stress"));
        }
        let outward = if is_far { 1.0 } else { -1.0 };
        let traction = outward * forces.iter().sum::<f64>() / brick.area(axis);
        *tractions.entry(axis).or_default().entry(is_far).or_insert(0.0) += traction;
    }
    let mut stresses = [0.0; 3];
    for (axis, sides) in tractions {
        let values: Vec<_> = sides.values().copied().collect();
        if values.iter().any(|value| (value - values[0]).abs() > SAME * values[0].abs()) {
            return Err(format!("{}: different loads on opposite faces make no uniform stress", places[&axis]));
        }
        stresses[axis] = values[0];
    }
    Ok(stresses)
}
