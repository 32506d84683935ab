//! Constraints eliminated: every displacement as a combination of independent ones and of the drives.
//!
//! ```text
//! u_f = Σ c_fe q_e + Σ s_fd a_d        u = T q + S a
//! ```
//!
//! with the equations' unknowns q and the drives' values a. Supports and couplings choose which freedoms have no
//! equation of their own; forces on these go to the equations and drives that move them (Tᵀ f, Sᵀ f). Supports in
//! rotated axes are couplings of the two components of a node.

use crate::model::{Coupling, Freedom, Model, ModelError, Support};
use crate::plane::dot;

#[cfg(test)]
mod test;

/// A freedom's share of equations and drives.
#[derive(Clone, Debug, Default, PartialEq)]
struct Expression {
    equations: Vec<(usize, f64)>,
    drives: Vec<(usize, f64)>,
}

/// Dependence of a freedom on other freedoms and drives, before chains of couplings are resolved.
#[derive(Clone, Debug, PartialEq)]
struct Dependence {
    terms: Vec<(usize, f64)>,
    drives: Vec<(usize, f64)>,
    /// Support or coupling that asked for it, for messages.
    by: String,
    is_coupling: bool,
}

/// The freedoms of a model by equations and drives.
#[derive(Clone, Debug)]
pub struct Equations {
    expressions: Vec<Expression>,
    /// The freedom that each equation belongs to.
    freedoms: Vec<usize>,
    /// Whether several freedoms follow an equation.
    shared: Vec<bool>,
    drive_count: usize,
    /// Couplings in the order in which forces pass from dependent freedoms to their terms.
    transfers: Vec<(usize, Vec<(usize, f64)>)>,
}

impl Equations {
    /// Makes the equations of a model's supports and couplings.
    ///
    /// # Errors
    ///
    /// Couplings that follow each other in a circle, two supports or couplings that prescribe one displacement differently, a
    /// direction without length, an index out of range, NaN or infinity: the first found.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let freedom_count = 2 * model.mesh.nodes().len();
        let mut dependences: Vec<Option<Dependence>> = vec![None; freedom_count];
        for (node, held) in held_directions(model)?.into_iter().enumerate() {
            for (freedom, dependence) in support_dependences(node, &held)? {
                dependences[freedom] = Some(dependence);
            }
        }
        for coupling in &model.couplings {
            add_coupling(&mut dependences, coupling)?;
        }
        // Nodes that no element has carry no stiffness: they move only as far as something moves them.
        let free = model.mesh.free_nodes();
        let used_by_couplings: Vec<usize> =
            model.couplings.iter().flat_map(|c| c.terms.iter().map(|(freedom, _)| freedom.index())).collect();
        for freedom in free.iter().flat_map(|node| [2 * node, 2 * node + 1]) {
            if dependences[freedom].is_none() && !used_by_couplings.contains(&freedom) {
                let by = "having no element".to_owned();
                dependences[freedom] =
                    Some(Dependence { terms: Vec::new(), drives: Vec::new(), by, is_coupling: false });
            }
        }
        Self::resolve(&dependences, model.drives.len())
    }

    fn resolve(dependences: &[Option<Dependence>], drive_count: usize) -> Result<Self, ModelError> {
        let order = dependence_order(dependences)?;
        let mut expressions = vec![Expression::default(); dependences.len()];
        let mut freedoms = Vec::new();
        for (freedom, dependence) in dependences.iter().enumerate() {
            if dependence.is_none() {
                expressions[freedom].equations.push((freedoms.len(), 1.0));
                freedoms.push(freedom);
            }
        }
        for &freedom in &order {
            let Some(dependence) = &dependences[freedom] else { continue };
            let mut expression = Expression::default();
            expression.drives.extend(&dependence.drives);
            for &(term, coefficient) in &dependence.terms {
                add_scaled(&mut expression.equations, &expressions[term].equations, coefficient);
                add_scaled(&mut expression.drives, &expressions[term].drives, coefficient);
            }
            expressions[freedom] = expression;
        }
        // Forces go the other way round: from what depends to what it depends on.
        let transfers = order
            .iter()
            .rev()
            .filter_map(|&freedom| {
                let dependence = dependences[freedom].as_ref()?;
                dependence.is_coupling.then(|| (freedom, dependence.terms.clone()))
            })
            .collect();
        let mut shared = vec![false; freedoms.len()];
        for (freedom, expression) in expressions.iter().enumerate() {
            for (equation, _) in &expression.equations {
                shared[*equation] |= dependences[freedom].is_some();
            }
        }
        Ok(Self { expressions, freedoms, shared, drive_count, transfers })
    }

    /// Returns how many equations there are.
    pub fn count(&self) -> usize {
        self.freedoms.len()
    }

    /// Returns how many freedoms there are: two per node.
    pub(crate) fn freedom_count(&self) -> usize {
        self.expressions.len()
    }

    /// The freedom that each equation belongs to; the others that follow it are coupled.
    pub fn freedoms(&self) -> &[usize] {
        &self.freedoms
    }

    /// The equations of a freedom with their coefficients.
    pub(crate) fn equations_of(&self, freedom: usize) -> &[(usize, f64)] {
        &self.expressions[freedom].equations
    }

    /// The drives of a freedom with their coefficients.
    pub(crate) fn drives_of(&self, freedom: usize) -> &[(usize, f64)] {
        &self.expressions[freedom].drives
    }

    /// Returns whether the freedom is held still, or its own equation that no other freedom follows.
    pub(crate) fn is_plain(&self, freedom: usize) -> bool {
        let Expression { equations, drives } = &self.expressions[freedom];
        drives.is_empty()
            && match equations[..] {
                [] => true,
                [(equation, 1.0)] => !self.shared[equation],
                _ => false,
            }
    }

    /// u += T q + S a.
    ///
    /// # Panics
    ///
    /// If the lengths are not [`Self::freedom_count`], [`Self::count`] and the number of drives.
    pub(crate) fn add_displacements(&self, unknowns: &[f64], drives: &[f64], displacements: &mut [f64]) {
        assert!(unknowns.len() == self.count() && drives.len() == self.drive_count);
        assert_eq!(displacements.len(), self.freedom_count());
        for (displacement, expression) in displacements.iter_mut().zip(&self.expressions) {
            for &(equation, coefficient) in &expression.equations {
                *displacement += coefficient * unknowns[equation];
            }
            for &(drive, coefficient) in &expression.drives {
                *displacement += coefficient * drives[drive];
            }
        }
    }

    /// Tᵀ f.
    pub fn reduce(&self, forces: &[f64]) -> Vec<f64> {
        let mut reduced = vec![0.0; self.count()];
        for (force, expression) in forces.iter().zip(&self.expressions) {
            for &(equation, coefficient) in &expression.equations {
                reduced[equation] += coefficient * force;
            }
        }
        reduced
    }

    /// Sᵀ f: the force that each drive needs, conjugate to its value.
    pub(crate) fn drive_forces(&self, forces: &[f64]) -> Vec<f64> {
        let mut drives = vec![0.0; self.drive_count];
        for (force, expression) in forces.iter().zip(&self.expressions) {
            for &(drive, coefficient) in &expression.drives {
                drives[drive] += coefficient * force;
            }
        }
        drives
    }

    /// Moves the forces on freedoms of couplings to the freedoms that they follow: what is left at held freedoms are
    /// the forces of the supports.
    pub(crate) fn transfer_coupled_forces(&self, forces: &mut [f64]) {
        for (freedom, terms) in &self.transfers {
            let force = std::mem::take(&mut forces[*freedom]);
            for &(term, coefficient) in terms {
                forces[term] += coefficient * force;
            }
        }
    }
}

/// Adds `coefficient` times `terms`, merging equal indices.
fn add_scaled(to: &mut Vec<(usize, f64)>, terms: &[(usize, f64)], coefficient: f64) {
    for &(index, value) in terms {
        match to.iter_mut().find(|(present, _)| *present == index) {
            Some((_, sum)) => *sum += coefficient * value,
            None => to.push((index, coefficient * value)),
        }
    }
}

/// A unit direction in which a node is held, the drive that moves it, and the support's name.
#[derive(Clone, Debug)]
struct Held {
    direction: [f64; 2],
    drive: Option<usize>,
    by: String,
}

/// Returns the held directions of each node.
fn held_directions(model: &Model) -> Result<Vec<Vec<Held>>, ModelError> {
    let mut held = vec![Vec::new(); model.mesh.nodes().len()];
    for support in &model.supports {
        let direction = unit_direction(support)?;
        if let Some(drive) = support.drive.filter(|drive| *drive >= model.drives.len()) {
            return Err(unusable(&support.name, &format!("there is no drive {} (from 1)", drive + 1)));
        }
        for &node in &support.nodes {
            let Some(held) = held.get_mut(node) else {
                return Err(unusable(&support.name, &format!("there is no node {} (from 1)", node + 1)));
            };
            held.push(Held { direction, drive: support.drive, by: support.name.clone() });
        }
    }
    Ok(held)
}

fn unusable(by: &str, problem: &str) -> ModelError {
    ModelError(format!("{by}: {problem}"))
}

fn unit_direction(support: &Support) -> Result<[f64; 2], ModelError> {
    let [x, y] = support.direction;
    let length = x.hypot(y);
    if length > 0.0 && length.is_finite() {
        Ok([x / length, y / length])
    } else {
        Err(unusable(&support.name, &format!("({x}, {y}) is no direction")))
    }
}

/// Directions closer than this (sine of the angle between them) count as one.
const SAME_DIRECTION: f64 = 1e-9;

/// The dependent freedoms of a node that is held in some directions: none, one or both.
fn support_dependences(node: usize, held: &[Held]) -> Result<Vec<(usize, Dependence)>, ModelError> {
    let mut independent: Vec<&Held> = Vec::new();
    for one in held {
        let parallel = |other: &&&Held| {
            let ([a, b], [c, d]) = (one.direction, other.direction);
            (a * d - b * c).abs() < SAME_DIRECTION
        };
        match independent.iter().find(parallel) {
            // opposite directions agree if nothing moves
            Some(same)
                if same.drive == one.drive && (one.drive.is_none() || dot(one.direction, same.direction) > 0.0) => {}
            Some(other) => return Err(contradiction(node, &other.by, &one.by)),
            None if independent.len() == 2 => {
                return Err(contradiction(node, &independent[0].by, &one.by));
            }
            None => independent.push(one),
        }
    }
    let dependence = |terms, drives, one: &Held| Dependence { terms, drives, by: one.by.clone(), is_coupling: false };
    Ok(match independent[..] {
        [] => Vec::new(),
        [one] => {
            // u_k = (a − n_j u_j)/n_k, with the larger n_k
            let k = usize::from(one.direction[1].abs() > one.direction[0].abs());
            let (n_k, n_j) = (one.direction[k], one.direction[1 - k]);
            let terms = if n_j.abs() < SAME_DIRECTION { Vec::new() } else { vec![(2 * node + 1 - k, -n_j / n_k)] };
            let drives = one.drive.map(|drive| (drive, 1.0 / n_k)).into_iter().collect();
            vec![(2 * node + k, dependence(terms, drives, one))]
        }
        [first, second, ..] => {
            let [x, y] = both_components(first, second);
            vec![(2 * node, dependence(Vec::new(), x, first)), (2 * node + 1, dependence(Vec::new(), y, first))]
        }
    })
}

fn contradiction(node: usize, first: &str, second: &str) -> ModelError {
    let node = format!("node {} (from 1)", node + 1);
    ModelError(format!("{node} is held twice along one direction, by {first} and by {second}"))
}

/// Both components of a node held in two directions: the drives of each with their coefficients.
fn both_components(first: &Held, second: &Held) -> [Vec<(usize, f64)>; 2] {
    let ([a, b], [c, d]) = (first.direction, second.direction);
    let determinant = a * d - b * c;
    let inverse = [[d / determinant, -b / determinant], [-c / determinant, a / determinant]];
    inverse.map(|row| {
        let mut drives = Vec::new();
        for (held, coefficient) in [first, second].into_iter().zip(row) {
            if let Some(drive) = held.drive {
                add_scaled(&mut drives, &[(drive, 1.0)], coefficient);
            }
        }
        drives.retain(|(_, coefficient)| *coefficient != 0.0);
        drives
    })
}

fn add_coupling(dependences: &mut [Option<Dependence>], coupling: &Coupling) -> Result<(), ModelError> {
    let by = format!("the coupling of node {} (from 1)", coupling.dependent.node + 1);
    let in_range = |freedom: &Freedom| freedom.component < 2 && freedom.index() < dependences.len();
    if !in_range(&coupling.dependent) || !coupling.terms.iter().all(|(freedom, _)| in_range(freedom)) {
        return Err(unusable(&by, "it names a freedom that does not exist"));
    }
    if !coupling.terms.iter().all(|(_, coefficient)| coefficient.is_finite()) {
        return Err(unusable(&by, "a coefficient is not finite"));
    }
    let dependent = coupling.dependent.index();
    if let Some(present) = &dependences[dependent] {
        return Err(contradiction(coupling.dependent.node, &present.by, &by));
    }
    let mut terms = Vec::new();
    for (freedom, coefficient) in &coupling.terms {
        add_scaled(&mut terms, &[(freedom.index(), 1.0)], *coefficient);
    }
    dependences[dependent] = Some(Dependence { terms, drives: Vec::new(), by, is_coupling: true });
    Ok(())
}

/// The dependent freedoms, each after those it depends on.
fn dependence_order(dependences: &[Option<Dependence>]) -> Result<Vec<usize>, ModelError> {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; dependences.len()];
    let mut order = Vec::new();
    for start in 0..dependences.len() {
        // depth first, with the place among the terms of each open freedom
        let mut open = vec![(start, 0)];
        while let Some((freedom, next)) = open.pop() {
            let Some(dependence) = dependences[freedom].as_ref().filter(|_| marks[freedom] != Mark::Done) else {
                continue;
            };
            marks[freedom] = Mark::Open;
            match dependence.terms.get(next) {
                None => {
                    marks[freedom] = Mark::Done;
                    order.push(freedom);
                }
                Some(&(term, _)) if marks[term] == Mark::Open => {
                    let node = term / 2 + 1;
                    return Err(ModelError(format!("the coupling of node {node} (from 1) depends on itself")));
                }
                Some(&(term, _)) => {
                    open.push((freedom, next + 1));
                    open.push((term, 0));
                }
            }
        }
    }
    Ok(order)
}
