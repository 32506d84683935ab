//! Integration rules on the reference elements.

use super::ElementKind;
use schemars::JsonSchema;
use serde::Deserialize;

/// Integration of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Integration {
    /// Exact for undistorted elements.
    Full,
    /// One order less: 2 × 2 for Q8.
    Reduced,
}

impl std::fmt::Display for Integration {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Full => "full",
            Self::Reduced => "reduced",
        })
    }
}

/// A point of a rule on a reference element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegrationPoint {
    /// (ξ, η).
    pub coordinates: [f64; 2],
    /// Weight; they sum to the area of the reference element.
    pub weight: f64,
}

impl ElementKind {
    /// The integration of this kind by default: reduced for Q8, full for the rest.
    pub const fn default_integration(self) -> Integration {
        if self.description().reduced.is_some() { Integration::Reduced } else { Integration::Full }
    }

    /// The points of a rule; `None` where this kind has no such rule (see the module's table).
    pub const fn integration_points(self, integration: Integration) -> Option<&'static [IntegrationPoint]> {
        match integration {
            Integration::Full => Some(self.full_integration_points()),
            Integration::Reduced => self.description().reduced,
        }
    }

    /// The points of the full rule, which every kind has.
    pub(crate) const fn full_integration_points(self) -> &'static [IntegrationPoint] {
        self.description().full
    }
}

/// 1/√3.
const GAUSS_2_ABSCISSA: f64 = 0.577_350_269_189_625_8;
/// √(3/5).
const GAUSS_3_ABSCISSA: f64 = 0.774_596_669_241_483_4;

const THIRD: f64 = 1.0 / 3.0;
const SIXTH: f64 = 1.0 / 6.0;

pub(super) static CENTROID: [IntegrationPoint; 1] = [IntegrationPoint { coordinates: [THIRD, THIRD], weight: 0.5 }];

/// The interior three-point rule: its points do not lie on edges, where neighbours would share them.
pub(super) static TRIANGLE_3: [IntegrationPoint; 3] = [
    IntegrationPoint { coordinates: [SIXTH, SIXTH], weight: SIXTH },
    IntegrationPoint { coordinates: [4.0 * SIXTH, SIXTH], weight: SIXTH },
    IntegrationPoint { coordinates: [SIXTH, 4.0 * SIXTH], weight: SIXTH },
];

pub(super) static GAUSS_2X2: [IntegrationPoint; 4] = product([-GAUSS_2_ABSCISSA, GAUSS_2_ABSCISSA], [1.0, 1.0]);

pub(super) static GAUSS_3X3: [IntegrationPoint; 9] =
    product([-GAUSS_3_ABSCISSA, 0.0, GAUSS_3_ABSCISSA], [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0]);

/// The product of a rule on −1 … 1 with itself, ξ running fastest; POINTS = COUNT².
const fn product<const COUNT: usize, const POINTS: usize>(
    abscissae: [f64; COUNT],
    weights: [f64; COUNT],
) -> [IntegrationPoint; POINTS] {
    let mut points = [IntegrationPoint { coordinates: [0.0; 2], weight: 0.0 }; POINTS];
    let mut index = 0;
    while index < POINTS {
        let (column, row) = (index % COUNT, index / COUNT);
        points[index] = IntegrationPoint {
            coordinates: [abscissae[column], abscissae[row]],
            weight: weights[column] * weights[row],
        };
        index += 1;
    }
    points
}
