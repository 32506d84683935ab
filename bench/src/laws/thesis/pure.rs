//! Box 4.1.

use super::{Components, DamageSurface, Point, elastic_energy};
use models::tensor::Elasticity;

/// D, Y and f of the last step.
pub(super) struct PureDamage {
    elasticity: Elasticity,
    surface: DamageSurface,
    damage: f64,
    release_rate: f64,
}

impl PureDamage {
    /// Virgin; PROPS as `pure_damage` has them.
    pub fn new(props: &[f64]) -> Self {
        Self {
            elasticity: Elasticity::new(props[0], props[1]),
            surface: DamageSurface::new(&props[2..5]),
            damage: 0.0,
            release_rate: 0.0,
        }
    }
}

impl Point for PureDamage {
    fn update(&mut self, strain: &Components) -> Result<Components, String> {
        // 1
        let release_rate = elastic_energy(&self.elasticity, strain);
        // 2 and 3: unloading from a damaged state; 4: below the surface
        let was_damaging = self.surface.value(self.release_rate, self.damage) >= 0.0;
        let unloads = was_damaging && release_rate < self.release_rate;
        if !unloads && self.surface.value(release_rate, self.damage) > 0.0 {
            // 5
            self.damage = self.surface.damage(release_rate);
        }
        self.release_rate = release_rate;
        // 6
        Ok(self.elasticity.stress(strain).map(|stress| (1.0 - self.damage) * stress))
    }
}
