//! Bearing of a wire that presses sideways into concrete.

use super::Scene;
use crate::document::pullout::{Bearing, BearingWord};
use crate::reader::Reader;
use fe_core::mesh::Mesh;
use fe_core::mesh::specimen::SurfaceRole;
use fe_core::model::{ContactLaw, ContactPair, PluginLaw, Width};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use umat_abi::host::{CallOutcome, LawDescription, Validation};
use umat_abi::law::{Request, StressState};
use umat_abi::metadata::stress_states;

/// Bearing strength of concrete under a thin bar over its uniaxial strength, on the diameter: the dowel formula of Model Code 1990,
/// F = 1.3 φ² √(f_c f_y) = φ² √(k f_c f_y/3), has 5.07 (`tests/reference/bearing`).
const FACTOR: f64 = 5.07;
/// The largest strain of the compression test, and its increments.
const LARGEST_STRAIN: f64 = 0.01;
const INCREMENTS: usize = 400;
/// Iterations for the lateral strain, and the lateral stress that may be left, as a part of the axial one.
const ITERATIONS: usize = 30;
const LATERAL_TOLERANCE: f64 = 1e-6;
/// A law whose slope at the largest strain is more than this part of the first one has no strength.
const STILL_RISING: f64 = 0.02;
/// Roles of the two parameters of a contact law that bears.
const ROLES: [&str; 2] = ["bearing_strength", "bearing_depth"];

/// What the case says of the bearing of its pairs.
#[derive(Debug, Default)]
pub struct Bearings {
    /// Of all pairs.
    pub all: Option<Bearing>,
    /// Of single ones, by their names.
    pub named: BTreeMap<String, Bearing>,
}

impl Bearings {
    fn of(&self, pair: &str) -> Option<Bearing> {
        self.named.get(pair).copied().or(self.all)
    }
}

/// Fills in what the concrete under the lines of round fibres bears, where a contact law leaves it to the host.
///
/// The force per length φ f_c √(E u/(f_c φ)) of a cylinder that is pressed into Drucker–Prager concrete by u grows up to
/// `factor` φ f_c, where the concrete is crushed.
pub fn fill(
    reader: &mut Reader<'_>,
    given: &Bearings,
    contacts: &mut [ContactPair],
    scene: Scene<'_>,
    matrix: Option<(usize, &PluginLaw)>,
) {
    let (Some((ground, mesh)), Some((part, matrix))) = (scene.ground.zip(scene.mesh), matrix) else { return };
    let mut found = None;
    for pair in contacts {
        let line = ground.specimen.contact_pairs.iter().find(|default| default.name == pair.name);
        let Some(line) = line.filter(|line| line.role != SurfaceRole::End) else { continue };
        let (Some(line_width), Width::Given(width)) = (line.width, pair.width) else { continue };
        let ContactLaw::Uinter(law) = &mut pair.law else { continue };
        let Some(description) = law.plugin.law.clone() else { continue };
        let factor = match given.of(&pair.name) {
            None | Some(Bearing::Word(BearingWord::Rigid)) => continue,
            Some(Bearing::Word(BearingWord::Crushed)) => FACTOR,
            Some(Bearing::Factor(factor)) => factor.0,
        };
        let Concrete { strength, modulus } = match *found.get_or_insert_with(|| compressed(matrix, mesh, part)) {
            Some(concrete) => concrete,
            None => break,
        };
        let diameter = line_width / (0.5 * PI);
        let values = [factor * strength * diameter / width, factor * factor * strength / modulus * diameter];
        if let Some(filled) = filled(&description, &law.plugin.props, values) {
            law.plugin.props = filled;
            reader.note(format!(
                "bearing: a wire of {diameter} mm crushes the concrete under it at {:.1} MPa of contact pressure, {factor} f_c on \
                 its diameter, reached {:.4} mm deep; f_c {strength:.2} MPa and E {modulus:.0} MPa are those of the matrix's \
                 law in uniaxial compression",
                values[0], values[1]
            ));
        }
    }
}

/// PROPS with the bearing filled in, if the law has such parameters, leaves them to the host, and admits them.
fn filled(law: &LawDescription, props: &[f64], values: [f64; 2]) -> Option<Vec<f64>> {
    let [strength, depth] = ROLES.map(|role| law.role(role).filter(|k| *k < props.len()));
    let strength = strength.filter(|k| props[*k] == 0.0)?;
    let mut filled = props.to_vec();
    filled[strength] = values[0];
    if let Some(depth) = depth.filter(|k| props[*k] == 0.0) {
        filled[depth] = values[1];
    }
    (!matches!(law.validate(&filled, None), Validation::Invalid(_))).then_some(filled)
}

/// What a law says of concrete in uniaxial compression.
#[derive(Clone, Copy, Debug)]
struct Concrete {
    /// f_c, MPa.
    strength: f64,
    /// E, MPa.
    modulus: f64,
}

/// Compresses a cube of the law along 1 with free sides, on which an isotropic one bears nothing; `None`: it has no strength, or
/// cannot be asked.
fn compressed(law: &PluginLaw, mesh: &Mesh, part: usize) -> Option<Concrete> {
    let description = law.plugin.law.as_ref().filter(|_| law.plugin.frame.is_none())?;
    if description.stress_states & stress_states::THREE_D == 0 {
        return None;
    }
    let mut call = law.plugin.plain_umat(StressState::ThreeD).ok()?;
    let element = (0..mesh.elements().len()).find(|&element| mesh.elements()[element].part() == part)?;
    call.celent = mesh.characteristic_length(element);
    let mut statev = law.statev0.clone().unwrap_or_else(|| vec![0.0; law.plugin.nstatv]);
    let (mut strain, mut stress, mut energies) = ([0.0; 6], [0.0; 6], [0.0; 3]);
    let step = LARGEST_STRAIN / INCREMENTS as f64;
    // of the lateral strain to the axial one
    let mut ratio = -0.2;
    let mut curve = Vec::with_capacity(INCREMENTS);
    for _ in 0..INCREMENTS {
        let mut last: Option<[f64; 2]> = None;
        let mut is_found = false;
        for _ in 0..ITERATIONS {
            let [axial, lateral] = [-step, -step * ratio];
            let increment = [axial, lateral, lateral, 0.0, 0.0, 0.0];
            call.set_point([&strain, &increment, &stress], &statev, energies);
            let is_done = matches!(call.call(Request::Stress), Ok(CallOutcome::Done));
            let [s11, s22] = [call.stress()[0], call.stress()[1]];
            if !is_done || !s11.is_finite() || !s22.is_finite() {
                return None;
            }
            if s22.abs() <= LATERAL_TOLERANCE * s11.abs() {
                is_found = true;
                break;
            }
            let next = match last {
                Some([before, was]) if s22 != was => ratio - s22 * (ratio - before) / (s22 - was),
                _ => ratio - 0.1,
            };
            last = Some([ratio, s22]);
            ratio = next;
        }
        if !is_found {
            break;
        }
        stress.copy_from_slice(call.stress());
        statev.copy_from_slice(call.statev());
        energies = call.energies;
        strain = [strain[0] - step, strain[1] - step * ratio, strain[2] - step * ratio, 0.0, 0.0, 0.0];
        curve.push(-stress[0]);
    }
    let modulus = curve.first()? / step;
    let strength = curve.iter().copied().fold(0.0, f64::max);
    let last = curve.len().checked_sub(2)?;
    let is_rising = (curve[last + 1] - curve[last]) / step > STILL_RISING * modulus;
    (!is_rising && modulus > 0.0 && strength > 0.0).then_some(Concrete { strength, modulus })
}
