//! Bearing of a wire that presses sideways into concrete.

use super::KnownMesh;
use super::mesh::MATRIX;
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::document::pullout::BearingWord;
use crate::problem::Place;
use crate::reader::Reader;
use fe_core::mesh::Mesh;
use fe_core::mesh::specimen::{ContactSurfaces, SurfaceRole};
use fe_core::model::{Bearing, ContactPair, Enforcement, PluginLaw, Width};
use pullout_run::number::rounded;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use umat_abi::host::CallOutcome;
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

/// Factor of the penalty of what is crushed: it yields by 10⁻² mm under its strength, and a penalty that is stiffer by orders of size
/// takes ten times as many iterations where it begins to.
const PENALTY_FACTOR: f64 = 1.0;

/// A contact pair of the case with its name, without one if it is all of them, what it says of bearing, and the place of that.
type Given<'c> = (Option<&'c str>, &'c document::Pair, Option<document::Bearing>, Place);

/// Sets what the concrete under round fibres carries: for the lines of hooked fibres, and for those where the case says
/// so.
///
/// The force per length of a cylinder that is pressed into concrete by u grows as φ f_c √(E u/(f_c φ)) up to `factor` φ
/// f_c, where the concrete is crushed.
pub fn fill(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    contacts: &mut [ContactPair],
    scene: KnownMesh<'_>,
    laws: &[PluginLaw],
) {
    let given = given(case);
    let (Some(ground), Some(mesh)) = (scene.ground, scene.mesh) else { return };
    let hooked = hooked(case);
    let part = mesh.parts().iter().position(|part| part.name == MATRIX);
    // compressed once, and only where it is asked for
    let mut matrix = None;
    let [mut met, mut refused] = [BTreeSet::new(), BTreeSet::new()];
    for pair in contacts {
        let line = ground.specimen.contact_pairs.iter().find(|default| default.name == pair.name);
        let line = line.filter(|line| line.role != SurfaceRole::End);
        let Some((line, line_width)) = line.and_then(|line| Some((line, line.width?))) else { continue };
        let Width::Given(width) = pair.width else { continue };
        let own = given.iter().position(|(name, ..)| name.is_none_or(|name| name == pair.name));
        met.extend(own);
        let factor = match own.and_then(|own| given[own].2) {
            Some(document::Bearing::Word(BearingWord::Rigid)) => continue,
            Some(document::Bearing::Factor(factor)) => factor.0,
            Some(document::Bearing::Word(BearingWord::Crushing)) => FACTOR,
            None if hooked.iter().any(|name| is_of(line, name)) => FACTOR,
            None => continue,
        };
        let of_part = || part.and_then(|part| compressed(&laws[part], mesh, part));
        let Some(Concrete { strength, modulus }) = *matrix.get_or_insert_with(of_part) else {
            const REASON: &str = "the matrix's law has no strength in uniaxial compression";
            match own.filter(|own| given[*own].2.is_some()) {
                Some(own) if refused.insert(own) => {
                    reader.problem(&given[own].3, format!("{REASON}: leave it out, or give \"rigid\""));
                }
                Some(_) => {}
                None => reader.note(format!("bearing: rigid, since {REASON}")),
            }
            continue;
        };
        let diameter = line_width / (0.5 * PI);
        let bearing = Bearing {
            strength: factor * strength * diameter / width,
            depth: factor * factor * strength / modulus * diameter,
        };
        pair.bearing = Some(bearing);
        let said = own.map(|own| given[own].1);
        if said.is_none_or(|said| said.penalty_factor.is_none() && said.enforcement.is_none()) {
            (pair.penalty_factor, pair.enforcement) = (PENALTY_FACTOR, Enforcement::Penalty);
        }
        reader.note(format!(
            "bearing: a wire of {diameter} mm crushes the concrete under it at p_b = {:.1} MPa of contact pressure, k = {factor} times f_c \
             on its diameter, reached {:.4} mm deep; f_c = {strength:.2} MPa and E = {modulus:.0} MPa are those of the matrix's law in \
             uniaxial compression; penalty factor {}",
            bearing.strength,
            bearing.depth,
            pair.penalty_factor,
            diameter = rounded(diameter),
        ));
    }
    for (_, (_, _, bearing, place)) in given.iter().enumerate().filter(|(own, _)| !met.contains(own)) {
        if bearing.is_some_and(|bearing| !matches!(bearing, document::Bearing::Word(BearingWord::Rigid))) {
            reader.problem(place, "is for the sides of round fibres in plane specimens: there are none here");
        }
    }
}

/// What the case says of its pairs.
fn given(case: &PulloutCase) -> Vec<Given<'_>> {
    let place = Place::root().key("contact");
    let of = |pair, name, place: &Place| -> Given<'_> {
        let pair: &document::Pair = pair;
        (name, pair, pair.bearing, place.key("bearing"))
    };
    match &case.contact {
        None => Vec::new(),
        Some(document::Contact::All(pair)) => vec![of(&**pair, None, &place)],
        Some(document::Contact::Pairs(pairs)) => {
            let pairs = pairs.iter().enumerate();
            pairs.map(|(k, pair)| of(pair, Some(pair.name.as_deref().unwrap_or("")), &place.index(k))).collect()
        }
    }
}

/// The names of the fibres with hooked ends.
fn hooked(case: &PulloutCase) -> Vec<&str> {
    let document::MeshSource::Specimen(source) = &case.mesh else { return Vec::new() };
    let document::Specimen::Fibres(given) = &source.specimen else { return Vec::new() };
    let hooked = given.fibres.iter().filter(|fibre| matches!(fibre.path, document::FibrePath::Hooked(_)));
    hooked.map(|fibre| fibre.name.as_str()).collect()
}

/// Returns whether a line is a side of a fibre with this name.
fn is_of(line: &ContactSurfaces, name: &str) -> bool {
    line.master
        .strip_prefix("fibre.")
        .and_then(|rest| rest.strip_prefix(name))
        .is_some_and(|rest| rest.starts_with('.'))
}

/// What a law says of concrete in uniaxial compression.
#[derive(Clone, Copy, Debug)]
struct Concrete {
    /// f_c, MPa.
    strength: f64,
    /// E, MPa.
    modulus: f64,
}

/// Compresses a cube of the law along 1 with free sides, where an isotropic law carries nothing; `None`: it has no
/// strength, or cannot be asked.
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
