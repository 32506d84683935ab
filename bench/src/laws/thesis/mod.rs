//! The thesis's own algorithms (Boxes 4.1, 4.2 and 5.1), for comparison: they live here and are in no plugin.
//!
//! They follow the steps of the boxes. Where a box contradicts the text around it, the text counts: the damage surfaces
//! are those at the damage of the last step, and tension and compression go their own ways.

mod biaxial;
mod inelastic;
mod pure;

use super::path::Components;
use models::tensor::{Elasticity, work};

/// Box 4.1: model I.
pub fn pure(props: &[f64], strains: &[Components], every: usize) -> Result<Vec<Components>, String> {
    follow(pure::PureDamage::new(props), strains, every)
}

/// Box 4.2: model II.
pub fn inelastic(props: &[f64], strains: &[Components], every: usize) -> Result<Vec<Components>, String> {
    follow(inelastic::InelasticDamage::new(props), strains, every)
}

/// Box 5.1: model IV.
pub fn biaxial(props: &[f64], strains: &[Components], every: usize) -> Result<Vec<Components>, String> {
    follow(biaxial::BiaxialDamage::new(props), strains, every)
}

/// A material point as a box keeps it.
trait Point {
    /// The stress at the end of an increment, MPa.
    fn update(&mut self, strain: &Components) -> Result<Components, String>;
}

fn follow(mut point: impl Point, strains: &[Components], every: usize) -> Result<Vec<Components>, String> {
    let mut stresses = Vec::with_capacity(strains.len() / every);
    for (i, strain) in strains.iter().enumerate() {
        let stress = point.update(strain)?;
        if (i + 1).is_multiple_of(every) {
            stresses.push(stress);
        }
    }
    Ok(stresses)
}

/// A, B, Y₀ and the functions of the boxes, in D itself.
#[derive(Clone, Copy, Debug)]
struct DamageSurface {
    a: f64,
    b: f64,
    threshold: f64,
}

impl DamageSurface {
    /// Makes a damage surface of A, B, Y₀ in PROPS.
    fn new(props: &[f64]) -> Self {
        Self { a: props[0], b: props[1], threshold: props[2] }
    }

    /// f = Y − Y₀ − Z(D), Z = (1/A) (D/(1−D))^(1/B) (eqs 4.23, 4.24).
    fn value(&self, release_rate: f64, damage: f64) -> f64 {
        release_rate - self.threshold - (damage / (1.0 - damage)).powf(1.0 / self.b) / self.a
    }

    /// D = 1 − 1/(1 + [A (Y − Y₀)]^B) (eq. 4.25).
    fn damage(&self, release_rate: f64) -> f64 {
        1.0 - 1.0 / (1.0 + (self.a * (release_rate - self.threshold)).powf(self.b))
    }
}

/// ½ ε : K⁰ : ε.
fn elastic_energy(elasticity: &Elasticity, strain: &Components) -> f64 {
    0.5 * work(&elasticity.stress(strain), strain)
}
