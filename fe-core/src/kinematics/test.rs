use super::*;
use crate::element::{ElementKind, MappedPoint};
use approx::assert_abs_diff_eq;
use strain_displacement::{RadiusError, StrainDisplacement};

pub(crate) mod strain_displacement;

impl StrainDisplacement {
    /// Adds Bᵀ σ dV to the forces of the element's nodes.
    ///
    /// # Panics
    ///
    /// If `forces` does not hold two for each node.
    pub(crate) fn add_internal_force(&self, stress: &[f64; MAX_COMPONENTS], volume: f64, forces: &mut [f64]) {
        assert_eq!(forces.len(), self.columns().len(), "two forces for each node");
        for (column, force) in self.columns().iter().zip(forces) {
            let power: f64 = column.iter().zip(stress).map(|(entry, stress)| entry * stress).sum();
            *force += power * volume;
        }
    }
}

/// The patch of MacNeal and Harder (1985), shifted off the axis: five quadrilaterals in a rectangle of 0.24 by 0.12.
const PATCH_NODES: [[f64; 2]; 8] =
    [[0.1, 0.0], [0.34, 0.0], [0.34, 0.12], [0.1, 0.12], [0.14, 0.02], [0.28, 0.03], [0.26, 0.08], [0.18, 0.08]];
const PATCH_QUADRILATERALS: [[usize; 4]; 5] = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]];

/// Nodes of each element of the patch; middle nodes are off their chords, so edges are curved.
fn patch(kind: ElementKind) -> Vec<Vec<[f64; 2]>> {
    let corners: Vec<Vec<usize>> = PATCH_QUADRILATERALS
        .iter()
        .flat_map(|&[a, b, c, d]| match kind.corner_count() {
            3 => vec![vec![a, b, c], vec![a, c, d]],
            _ => vec![vec![a, b, c, d]],
        })
        .collect();
    corners
        .iter()
        .map(|element| {
            let mut nodes: Vec<_> = element.iter().map(|&node| PATCH_NODES[node]).collect();
            if kind.node_count() > kind.corner_count() {
                for (i, &start) in element.iter().enumerate() {
                    let end = element[(i + 1) % element.len()];
                    let (a, b) = (PATCH_NODES[start.min(end)], PATCH_NODES[start.max(end)]);
                    // To the same side seen from either element.
                    nodes
                        .push([0.5 * (a[0] + b[0]) - 0.03 * (b[1] - a[1]), 0.5 * (a[1] + b[1]) + 0.03 * (b[0] - a[0])]);
                }
            }
            let corners = element.len() as f64;
            let centre = [0, 1].map(|k| nodes[..element.len()].iter().map(|node| node[k]).sum::<f64>() / corners);
            nodes.resize(kind.node_count(), centre);
            nodes
        })
        .collect()
}

/// Runs `check` with B and the nodes at every point of every rule of every element of the patch.
fn for_each_point(model: PlaneModel, mut check: impl FnMut(&StrainDisplacement, &[[f64; 2]], &MappedPoint)) {
    for kind in ElementKind::ALL {
        let elements = patch(kind);
        let area: f64 = elements.iter().map(|nodes| crate::element::area(kind, nodes).unwrap()).sum();
        assert!((area / (0.24 * 0.12) - 1.0).abs() < 0.1, "the patch covers the rectangle, except at its curved sides");
        for nodes in elements {
            for point in kind
                .full_integration_points()
                .iter()
                .chain(kind.integration_points(crate::element::Integration::Reduced).unwrap_or_default())
            {
                let mapped = MappedPoint::new(kind, &nodes, point.coordinates).unwrap();
                check(&StrainDisplacement::new(model, &mapped).unwrap(), &nodes, &mapped);
            }
        }
    }
}

fn displacements(nodes: &[[f64; 2]], field: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    nodes.iter().flat_map(|&x| field(x)).collect()
}

fn assert_strain(found: [f64; 4], expected: [f64; 4]) {
    for component in 0..4 {
        assert_abs_diff_eq!(found[component], expected[component], epsilon = 1e-12);
    }
}

#[test]
fn rigid_motion_gives_no_strain() {
    for model in [PlaneModel::PlaneStress, PlaneModel::PlaneStrain] {
        for_each_point(model, |b, nodes, _| {
            let motion = displacements(nodes, |[x, y]| [0.3 - 0.8 * y, -0.2 + 0.8 * x]);
            assert_strain(b.strain(&motion), [0.0; 4]);
        });
    }
    // About an axis only the shift along it is rigid.
    for_each_point(PlaneModel::Axisymmetric, |b, nodes, _| {
        assert_strain(b.strain(&displacements(nodes, |_| [0.0, 0.7])), [0.0; 4]);
    });
}

#[test]
fn linear_displacement_gives_constant_strain_on_distorted_patches() {
    let field = |[x, y]: [f64; 2]| [0.1 + 0.7 * x - 0.4 * y, -0.3 + 0.9 * x + 0.2 * y];
    for_each_point(PlaneModel::PlaneStress, |b, nodes, _| {
        assert_strain(b.strain(&displacements(nodes, field)), [0.7, 0.2, 0.5, 0.0]);
    });
    for_each_point(PlaneModel::PlaneStrain, |b, nodes, _| {
        assert_strain(b.strain(&displacements(nodes, field)), [0.7, 0.2, 0.0, 0.5]);
    });
}

#[test]
fn hoop_strain_is_radial_displacement_over_radius() {
    // u = 0.7 r stretches circles uniformly; u = 0.05 shifts all, so that ε_θθ = 0.05/r varies.
    for_each_point(PlaneModel::Axisymmetric, |b, nodes, point| {
        let radius = point.position[0];
        let strain = b.strain(&displacements(nodes, |[r, z]| [0.05 + 0.7 * r, 0.2 * z + 0.9 * r]));
        assert_strain(strain, [0.7, 0.2, 0.7 + 0.05 / radius, 0.9]);
    });
}

/// δu · f = δε · σ dV for each degree of freedom.
#[test]
fn internal_force_is_conjugate_to_the_strain() {
    let (stress, volume) = ([3.0, -1.7, 0.6, 2.2], 0.31);
    for model in PlaneModel::ALL {
        for_each_point(model, |b, nodes, _| {
            let mut forces = vec![1.0; 2 * nodes.len()];
            b.add_internal_force(&stress, volume, &mut forces);
            for freedom in 0..forces.len() {
                let mut virtual_displacements = vec![0.0; forces.len()];
                virtual_displacements[freedom] = 1.0;
                let strain = b.strain(&virtual_displacements);
                let work: f64 = (0..4).map(|component| strain[component] * stress[component] * volume).sum();
                assert_abs_diff_eq!(forces[freedom] - 1.0, work, epsilon = 1e-12);
            }
        });
    }
}

/// Pappus: the volume of a body of revolution is 2π r̄ A; r is linear and det J constant on straight T3 and T6.
#[test]
fn depth_gives_the_volume_of_a_ring() {
    let (low, high, height) = (2.0_f64, 5.0_f64, 1.5);
    let corners = [[low, 0.0], [high, 0.0], [high, height], [low, height]];
    let exact = std::f64::consts::PI * (high * high - low * low) * height;
    let volume: f64 = ElementKind::Q4
        .full_integration_points()
        .iter()
        .map(|point| {
            let mapped = MappedPoint::new(ElementKind::Q4, &corners, point.coordinates).unwrap();
            PlaneModel::Axisymmetric.depth(mapped.position[0], f64::NAN) * mapped.determinant * point.weight
        })
        .sum();
    approx::assert_relative_eq!(volume, exact, max_relative = 1e-15);
    assert_eq!(PlaneModel::PlaneStrain.depth(7.0, 3.26), 3.26);
}

#[test]
fn a_point_on_or_beyond_the_axis_is_refused() {
    let corners = [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
    for (xi, radius) in [(0.0, 0.0), (-0.5, -0.5)] {
        let point = MappedPoint::new(ElementKind::Q4, &corners, [xi, 0.0]).unwrap();
        assert_eq!(StrainDisplacement::new(PlaneModel::Axisymmetric, &point), Err(RadiusError { radius }));
        assert!(StrainDisplacement::new(PlaneModel::PlaneStrain, &point).is_ok());
    }
}

type PointsOfVolume = Vec<(StrainDisplacement, f64)>;

/// All points of a Q4 with B-bar and without, each with its volume.
fn averaged(model: PlaneModel, nodes: &[[f64; 2]]) -> (PointsOfVolume, PointsOfVolume) {
    let plain: Vec<_> = ElementKind::Q4
        .full_integration_points()
        .iter()
        .map(|point| {
            let mapped = MappedPoint::new(ElementKind::Q4, nodes, point.coordinates).unwrap();
            let volume = model.depth(mapped.position[0], 1.0) * mapped.determinant * point.weight;
            (StrainDisplacement::new(model, &mapped).unwrap(), volume)
        })
        .collect();
    let mut averaged = plain.clone();
    StrainDisplacement::average_dilatation(&mut averaged);
    (averaged, plain)
}

#[test]
fn average_dilatation_keeps_the_deviator_and_the_mean() {
    let field = |[x, y]: [f64; 2]| [x * y + 0.3 * x * x, 0.7 * y - 0.2 * x * y];
    for model in [PlaneModel::PlaneStrain, PlaneModel::Axisymmetric] {
        for nodes in patch(ElementKind::Q4) {
            let displacements = displacements(&nodes, field);
            let (averaged, plain) = averaged(model, &nodes);
            let strains = |points: &[(StrainDisplacement, f64)]| -> Vec<([f64; 4], f64)> {
                points.iter().map(|(b, volume)| (b.strain(&displacements), *volume)).collect()
            };
            let trace = |strain: &[f64; 4]| strain[0] + strain[1] + strain[2];
            let (averaged, plain) = (strains(&averaged), strains(&plain));
            let volume: f64 = plain.iter().map(|(_, volume)| volume).sum();
            let mean = plain.iter().map(|(strain, volume)| trace(strain) * volume).sum::<f64>() / volume;
            let mut spread = 0.0_f64;
            for ((new, _), (old, _)) in averaged.iter().zip(&plain) {
                spread = spread.max((trace(old) - mean).abs());
                assert_abs_diff_eq!(trace(new), mean, epsilon = 1e-13);
                for direct in 0..3 {
                    let deviator = |strain: &[f64; 4]| strain[direct] - trace(strain) / 3.0;
                    assert_abs_diff_eq!(deviator(new), deviator(old), epsilon = 1e-13);
                }
                assert_eq!(new[3], old[3]);
            }
            assert!(spread > 1e-3, "the plain element has a dilatation to average");
        }
    }
}

#[test]
fn average_dilatation_changes_neither_constant_strain_nor_plane_stress() {
    let field = |[x, y]: [f64; 2]| [0.1 + 0.7 * x - 0.4 * y, -0.3 + 0.9 * x + 0.2 * y];
    for nodes in patch(ElementKind::Q4) {
        for (b, _) in averaged(PlaneModel::PlaneStrain, &nodes).0 {
            assert_strain(b.strain(&displacements(&nodes, field)), [0.7, 0.2, 0.0, 0.5]);
        }
        let (averaged, plain) = averaged(PlaneModel::PlaneStress, &nodes);
        assert_eq!(averaged, plain);
    }
}

/// Bending of a square without B-bar costs volume at its points; with it none, so it does not lock.
#[test]
fn average_dilatation_frees_bending_from_volume_change() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let bending = displacements(&square, |[x, y]| [(x - 0.5) * (y - 0.5), 0.0]);
    let largest = |points: &[(StrainDisplacement, f64)]| {
        points.iter().map(|(b, _)| b.strain(&bending)[..3].iter().sum::<f64>().abs()).fold(0.0, f64::max)
    };
    let (averaged, plain) = averaged(PlaneModel::PlaneStrain, &square);
    // The points are at ±1/(2√3) from the middle.
    assert_abs_diff_eq!(largest(&plain), 0.5 / 3.0_f64.sqrt(), epsilon = 1e-15);
    assert_abs_diff_eq!(largest(&averaged), 0.0, epsilon = 1e-15);
}
