//! Choice of the stress-free component whose place each linear relation takes.

use crate::document::{self, EndValue};
use crate::problem::Place;
use crate::reader::Reader;
use nalgebra::{Matrix6, RowVector6};
use pullout_run::program::{Constraint, Control, Mode, STRAIN_NAMES, STRESS_NAMES};

/// Young's modulus and Poisson's ratio of the elastic bodies on which a set of relations is tried. Two bodies with
/// unrelated numbers, so that relations whose coefficients happen to be elastic constants are not mistaken
/// for singular ones.
const PROBES: [(f64, f64); 2] = [(27183.1, 0.2137), (1.618, 0.3141)];
/// Rows are scaled to length 1; a smallest singular value below this means linear dependence up to rounding.
const SINGULAR: f64 = 1e-10;

/// Assigns the relations of a step to components; sets their controls.
///
/// `named` says which components the step controls already.
pub fn assign(
    reader: &mut Reader<'_>,
    given: &[document::Constraint],
    controls: &mut [Control; 6],
    named: &[bool; 6],
    mode: Mode,
    place: &Place,
) -> Vec<Constraint> {
    let constraints: Vec<Constraint> =
        given.iter().enumerate().map(|(k, constraint)| read(reader, constraint, mode, &place.index(k))).collect();
    let free: Vec<usize> = mode.controllable().iter().copied().filter(|i| !named[*i]).collect();
    let mut chosen = 0_u32;
    for count in 1..=constraints.len() {
        let first = &constraints[..count];
        if !first.iter().all(has_coefficient) {
            return constraints;
        }
        let matching = matching_sets(first, &free);
        let regular: Vec<u32> =
            matching.iter().copied().filter(|set| is_regular(first, controls, *set, mode)).collect();
        let Some(&set) = regular.first() else {
            let message = if matching.is_empty() {
                "it has no stress-free component of its own whose place it could take: give it a coefficient of a \
                 component that the step does not control, or leave a control out"
            } else {
                "the constraints are singular: it repeats or contradicts the controls and constraints before it"
            };
            reader.problem(&place.index(count - 1), message);
            return constraints;
        };
        chosen = set;
        if regular.len() > 1 && count == constraints.len() {
            let names: Vec<&str> = members(set).map(|i| STRESS_NAMES[i]).collect();
            reader.warn(format!(
                "{place}: the constraints could take the place of different stress-free components; chosen: {}",
                names.join(", ")
            ));
        }
    }
    // The equations are the same whichever relation of the set is booked under which of its components.
    for (k, component) in members(chosen).enumerate() {
        controls[component] = Control::Constraint(k);
    }
    constraints
}

fn read(reader: &mut Reader<'_>, given: &document::Constraint, mode: Mode, place: &Place) -> Constraint {
    let [strain, stress] = given.coefficients.strain_and_stress();
    for i in (0..6).filter(|i| !mode.controllable().contains(i)) {
        for (name, coefficient) in [(STRAIN_NAMES[i], strain[i]), (STRESS_NAMES[i], stress[i])] {
            if coefficient.is_some() {
                reader.problem(&place.key(name), fixed_by_mode(name, mode));
            }
        }
    }
    let constraint = Constraint {
        strain: strain.map(Option::unwrap_or_default),
        stress: stress.map(Option::unwrap_or_default),
        equals: if let Some(EndValue::Value(value)) = given.equals { value } else { 0.0 },
        hold: matches!(given.equals, Some(EndValue::Hold(_))),
    };
    if !has_coefficient(&constraint) {
        reader.problem(
            place,
            "has no coefficient other than 0; write for example {\"s22\": 1, \"s11\": -0.5, \"equals\": 0}",
        );
    }
    constraint
}

fn has_coefficient(constraint: &Constraint) -> bool {
    constraint.strain.iter().chain(&constraint.stress).any(|c| *c != 0.0)
}

fn members(set: u32) -> impl Iterator<Item = usize> {
    (0..6).filter(move |i| set >> i & 1 == 1)
}

/// Returns the sets of free components (as bits) that can be matched one to one with the relations. Each relation has a
/// coefficient of its component.
fn matching_sets(constraints: &[Constraint], free: &[usize]) -> Vec<u32> {
    let touches = |constraint: &Constraint, i: usize| constraint.strain[i] != 0.0 || constraint.stress[i] != 0.0;
    let mut sets = vec![0_u32];
    for constraint in constraints {
        let mut larger: Vec<u32> = Vec::new();
        for set in &sets {
            larger
                .extend(free.iter().filter(|i| set >> **i & 1 == 0 && touches(constraint, **i)).map(|i| set | 1 << i));
        }
        larger.sort_unstable_by_key(|set| set.reverse_bits());
        larger.reverse();
        larger.dedup();
        sets = larger;
    }
    sets
}

/// Returns whether the step's six conditions determine the strains of an elastic body.
fn is_regular(constraints: &[Constraint], controls: &[Control; 6], set: u32, mode: Mode) -> bool {
    PROBES.iter().any(|&(modulus, ratio)| {
        let stiffness = elastic_stiffness(modulus, ratio);
        let mut rows = [RowVector6::zeros(); 6];
        let mut next = constraints.iter();
        for i in 0..6 {
            let strain_is_given = match controls[i] {
                _ if !mode.controllable().contains(&i) => !(mode == Mode::PlaneStress || mode.is_of_line()),
                Control::Strain(_) | Control::HoldStrain => true,
                _ => false,
            };
            let constraint = if set >> i & 1 == 1 { next.next() } else { None };
            rows[i] = match constraint {
                Some(c) => RowVector6::from(c.strain) + RowVector6::from(c.stress) * stiffness,
                None if strain_is_given => RowVector6::from_fn(|_, j| f64::from(i == j)),
                None => stiffness.row(i).into_owned(),
            };
        }
        let matrix = Matrix6::from_rows(&rows.map(|row| if row.norm() > 0.0 { row.normalize() } else { row }));
        matrix.singular_values().min() > SINGULAR
    })
}

fn elastic_stiffness(modulus: f64, ratio: f64) -> Matrix6<f64> {
    let shear = modulus / (2.0 * (1.0 + ratio));
    let lame = 2.0 * shear * ratio / (1.0 - 2.0 * ratio);
    Matrix6::from_fn(|i, j| match (i < 3, j < 3, i == j) {
        (true, true, true) => lame + 2.0 * shear,
        (true, true, false) => lame,
        (false, false, true) => shear,
        _ => 0.0,
    })
}

/// The message for a component that the mode fixes.
pub fn fixed_by_mode(name: &str, mode: Mode) -> String {
    let fixed = match mode {
        Mode::ThreeD => "nothing",
        Mode::PlaneStrain => "e33 = g13 = g23 = 0",
        Mode::Axisymmetric => "g13 = g23 = 0",
        Mode::PlaneStress => "s33 = s13 = s23 = 0",
        Mode::OneD => "all but e11 and s11",
        Mode::Beam => "all but e11, g12, s11 and s12",
    };
    format!("mode {} fixes {fixed}: leave '{name}' out", mode.name())
}
