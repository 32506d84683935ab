//! Bearing of a wire that presses sideways into concrete.

use super::KnownMesh;
use super::mesh::MATRIX;
use super::uniaxial;
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::document::pullout::BearingWord;
use crate::problem::{Place, Problem};
use crate::reader::Reader;
use fe_core::mesh::Mesh;
use fe_core::mesh::specimen::{ContactSurfaces, SurfaceRole};
use fe_core::model::{Bearing, PluginLaw, Width};
use pullout_run::number::rounded;
use std::cell::OnceCell;
use std::f64::consts::PI;

/// Bearing strength of concrete under a thin bar over its uniaxial strength, on the diameter: the dowel formula of Model Code 1990,
/// F = 1.3 φ² √(f_c f_y) = φ² √(k f_c f_y/3), has 5.07 (`tests/reference/bearing`).
const FACTOR: f64 = 5.07;
/// The largest strain of the compression test, and its increments.
const LARGEST_STRAIN: f64 = 0.01;
const INCREMENTS: usize = 400;
/// A law whose slope at the largest strain is more than this part of the first one has no strength.
const STILL_RISING: f64 = 0.02;

/// Default factor of the penalty of what is crushed: it yields by 10⁻² mm under its strength, and a penalty that is stiffer by orders of
/// size takes ten times as many iterations where it begins to.
pub const PENALTY_FACTOR: f64 = 1.0;

/// What the concrete of a case resists under round fibres.
pub struct Bearings<'s> {
    scene: KnownMesh<'s>,
    /// The matrix's law, if it is known, and its part.
    matrix: Option<(&'s PluginLaw, usize)>,
    /// Names of the fibres with hooked ends.
    hooked: Vec<&'s str>,
    /// What the matrix's law says of it: it is compressed once, and only where it is asked for.
    concrete: OnceCell<Option<Concrete>>,
}

impl<'s> Bearings<'s> {
    /// Makes them of the laws of the parts, if these could be read.
    pub fn new(case: &'s PulloutCase, scene: KnownMesh<'s>, laws: Option<&'s [PluginLaw]>) -> Self {
        let part = scene.mesh.and_then(|mesh| mesh.parts().iter().position(|part| part.name == MATRIX));
        let matrix = part.zip(laws).map(|(part, laws)| (&laws[part], part));
        Self { scene, matrix, hooked: hooked(case), concrete: OnceCell::new() }
    }

    /// Returns whether a line is a side of a round fibre, which may crush the concrete under it.
    pub fn is_side(line: &ContactSurfaces) -> bool {
        line.role != SurfaceRole::End && line.width.is_some()
    }

    /// Returns what the concrete resists under a line of contact: where the case says so, and by default under the sides of hooked fibres.
    /// `None`: any pressure.
    ///
    /// The force per length of a cylinder that is pressed into concrete by u grows as φ f_c √(E u/(f_c φ)) up to `factor` φ f_c, where the
    /// concrete is crushed.
    pub fn of(
        &self,
        reader: &mut Reader<'_>,
        pair: &document::Pair,
        line: Option<&ContactSurfaces>,
        width: Width,
        place: &Place,
    ) -> Option<Bearing> {
        let line = line.filter(|line| Self::is_side(line))?;
        let Width::Given(width) = width else { return None };
        let factor = match pair.bearing {
            Some(document::Bearing::Word(BearingWord::Rigid)) => return None,
            Some(document::Bearing::Factor(factor)) => factor.0,
            Some(document::Bearing::Word(BearingWord::Crushing)) => FACTOR,
            None if self.hooked.iter().any(|name| is_of(line, name)) => FACTOR,
            None => return None,
        };
        let (law, part) = self.matrix?;
        let concrete = self.concrete.get_or_init(|| compressed(law, self.scene.mesh?, part));
        let Some(Concrete { strength, modulus }) = *concrete else {
            const REASON: &str = "the matrix's law has no strength in uniaxial compression";
            if pair.bearing.is_none() {
                reader.note(format!("bearing: rigid, since {REASON}"));
            } else {
                let problem = Problem::new(place.key("bearing"), format!("{REASON}: leave it out, or give \"rigid\""));
                // reported once for all lines
                if !reader.problems.contains(&problem) {
                    reader.push(problem);
                }
            }
            return None;
        };
        let diameter = line.width? / (0.5 * PI);
        let bearing = Bearing {
            strength: factor * strength * diameter / width,
            depth: factor * factor * strength / modulus * diameter,
        };
        reader.highlight(format!(
            "bearing under a wire of {} mm: f_c = {strength:.2} MPa of the matrix's law, k = {factor}, crushed at p_b = {:.1} MPa of contact \
             pressure",
            rounded(diameter),
            bearing.strength,
        ));
        reader.note(format!(
            "bearing: p_b is k f_c on the wire's diameter, reached {:.4} mm deep; f_c and E = {modulus:.0} MPa are those of the matrix's law \
             in uniaxial compression",
            bearing.depth,
        ));
        Some(bearing)
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

/// Compresses a cube of the law along 1; `None`: it has no strength, or cannot be asked.
fn compressed(law: &PluginLaw, mesh: &Mesh, part: usize) -> Option<Concrete> {
    let step = LARGEST_STRAIN / INCREMENTS as f64;
    let curve: Vec<f64> =
        uniaxial::states(law, mesh, part, -step, INCREMENTS)?.iter().map(|state| -state.stress).collect();
    let modulus = curve.first()? / step;
    let strength = curve.iter().copied().fold(0.0, f64::max);
    let last = curve.len().checked_sub(2)?;
    let is_rising = (curve[last + 1] - curve[last]) / step > STILL_RISING * modulus;
    (!is_rising && modulus > 0.0 && strength > 0.0).then_some(Concrete { strength, modulus })
}
