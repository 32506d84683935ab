use super::*;
use approx::assert_abs_diff_eq;

impl ElementKind {
    /// The area of the reference element: ½ or 4.
    pub(crate) fn reference_area(self) -> f64 {
        if self.corner_count() == 3 { 0.5 } else { 4.0 }
    }
}

/// Points inside, on the edges and at corners of the reference element.
fn sample_points(kind: ElementKind) -> Vec<[f64; 2]> {
    let unit = [0.0, 0.13, 0.31, 0.5, 0.77, 1.0];
    let grid = unit.iter().flat_map(|&a| unit.iter().map(move |&b| [a, b]));
    match kind.corner_count() {
        // The square collapsed onto the triangle.
        3 => grid.map(|[a, b]| [a, b * (1.0 - a)]).collect(),
        _ => grid.map(|[a, b]| [2.0 * a - 1.0, 2.0 * b - 1.0]).collect(),
    }
}

/// Nodes of a distorted element, with curved edges where it has middle nodes, and each middle node's offset from the
/// middle of its chord.
fn distorted(kind: ElementKind) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let corners = [[1.1, -0.3], [4.2, 0.4], [3.6, 2.9], [0.7, 2.2]];
    let offsets = [[0.12, -0.21], [0.18, 0.09], [-0.07, 0.16], [0.11, 0.05]];
    let count = kind.corner_count();
    let mut nodes = corners[..count].to_vec();
    if kind.edge_kind() == EdgeKind::Linear {
        return (nodes, Vec::new());
    }
    let centre = [0, 1].map(|k| corners[..count].iter().map(|corner| corner[k]).sum::<f64>() / count as f64);
    for edge in 0..count {
        let (start, end) = (corners[edge], corners[(edge + 1) % count]);
        nodes.push([0, 1].map(|k| 0.5 * (start[k] + end[k]) + offsets[edge][k]));
    }
    nodes.resize(kind.node_count(), centre);
    (nodes, offsets[..count].to_vec())
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Polygon of the corners; between a chord c and the parabola of offset d lies ⅔ d × c, outward positive.
fn exact_area(kind: ElementKind, nodes: &[[f64; 2]], offsets: &[[f64; 2]]) -> f64 {
    let count = kind.corner_count();
    let polygon: f64 = (0..count).map(|i| 0.5 * cross(nodes[i], nodes[(i + 1) % count])).sum();
    let segments: f64 = offsets
        .iter()
        .enumerate()
        .map(|(i, &offset)| {
            let (start, end) = (nodes[i], nodes[(i + 1) % count]);
            2.0 / 3.0 * cross(offset, [end[0] - start[0], end[1] - start[1]])
        })
        .sum();
    polygon + segments
}

#[test]
fn shape_functions_are_one_at_their_node_and_zero_at_the_others() {
    for kind in ElementKind::ALL {
        assert_eq!(kind.reference_coordinates().len(), kind.node_count());
        for (i, &coordinates) in kind.reference_coordinates().iter().enumerate() {
            for (j, &value) in kind.shape_functions(coordinates).values().iter().enumerate() {
                assert_eq!(value, if i == j { 1.0 } else { 0.0 }, "{kind} N{} at node {}", j + 1, i + 1);
            }
        }
    }
}

#[test]
fn shape_functions_sum_to_one_and_reproduce_the_coordinates() {
    for kind in ElementKind::ALL {
        for point in sample_points(kind) {
            let shape = kind.shape_functions(point);
            assert_abs_diff_eq!(shape.values().iter().sum::<f64>(), 1.0, epsilon = 1e-15);
            for k in 0..2 {
                assert_abs_diff_eq!(shape.derivatives().iter().map(|d| d[k]).sum::<f64>(), 0.0, epsilon = 1e-14);
                let coordinate: f64 =
                    shape.values().iter().zip(kind.reference_coordinates()).map(|(n, x)| n * x[k]).sum();
                assert_abs_diff_eq!(coordinate, point[k], epsilon = 1e-15);
            }
        }
    }
}

/// T6 and Q8 hold every polynomial of degree 2, Q4 also ξη, Q8 also ξ²η and ξη².
#[test]
fn shape_functions_interpolate_their_polynomials_exactly() {
    let monomials: [(ElementKind, &[[i32; 2]]); 3] = [
        (ElementKind::Q4, &[[1, 1]]),
        (ElementKind::T6, &[[2, 0], [1, 1], [0, 2]]),
        (ElementKind::Q8, &[[2, 0], [1, 1], [0, 2], [2, 1], [1, 2]]),
    ];
    for (kind, exponents) in monomials {
        for [a, b] in exponents {
            let monomial = |[xi, eta]: [f64; 2]| xi.powi(*a) * eta.powi(*b);
            for point in sample_points(kind) {
                let shape = kind.shape_functions(point);
                let interpolated: f64 =
                    shape.values().iter().zip(kind.reference_coordinates()).map(|(n, &x)| n * monomial(x)).sum();
                assert_abs_diff_eq!(interpolated, monomial(point), epsilon = 1e-15);
            }
        }
    }
}

/// Central differences are exact for polynomials of degree 2 in the variable: only rounding is left.
#[test]
fn derivatives_agree_with_central_differences() {
    let step = 1e-3;
    for kind in ElementKind::ALL {
        for point in sample_points(kind) {
            let derivatives = kind.shape_functions(point);
            for k in 0..2 {
                let at = |shift: f64| {
                    let mut shifted = point;
                    shifted[k] += shift;
                    kind.shape_functions(shifted)
                };
                let (plus, minus) = (at(step), at(-step));
                for node in 0..kind.node_count() {
                    let difference = (plus.values()[node] - minus.values()[node]) / (2.0 * step);
                    assert_abs_diff_eq!(derivatives.derivatives()[node][k], difference, epsilon = 2e-12);
                }
            }
        }
    }
}

fn factorial(n: i32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// ∫ ξᵃ ηᵇ over the reference element.
fn exact_integral(kind: ElementKind, [a, b]: [i32; 2]) -> f64 {
    let interval = |n: i32| if n % 2 == 0 { 2.0 / f64::from(n + 1) } else { 0.0 };
    match kind.corner_count() {
        3 => factorial(a) * factorial(b) / factorial(a + b + 2),
        _ => interval(a) * interval(b),
    }
}

fn quadrature(points: &[IntegrationPoint], [a, b]: [i32; 2]) -> f64 {
    points.iter().map(|p| p.weight * p.coordinates[0].powi(a) * p.coordinates[1].powi(b)).sum()
}

#[test]
fn rules_integrate_polynomials_of_their_degree_and_no_higher() {
    let rules = [
        (ElementKind::T3, Integration::Full, 1, 1),
        (ElementKind::T6, Integration::Full, 3, 2),
        (ElementKind::Q4, Integration::Full, 4, 3),
        (ElementKind::Q8, Integration::Reduced, 4, 3),
        (ElementKind::Q8, Integration::Full, 9, 5),
    ];
    for (kind, integration, count, degree) in rules {
        let points = kind.integration_points(integration).unwrap();
        assert_eq!(points.len(), count);
        assert_abs_diff_eq!(quadrature(points, [0, 0]), kind.reference_area(), epsilon = 1e-15);
        let triangle = kind.corner_count() == 3;
        for a in 0..=degree {
            // Triangles: total degree; quadrilaterals: degree in each variable.
            for b in 0..=if triangle { degree - a } else { degree } {
                assert_abs_diff_eq!(quadrature(points, [a, b]), exact_integral(kind, [a, b]), epsilon = 2e-15);
            }
        }
        // The least of these errors is that of T6, 66/1296 − 1/20 = 9.3e-4.
        let beyond = [degree + 1, 0];
        assert!((quadrature(points, beyond) - exact_integral(kind, beyond)).abs() > 9e-4, "{kind} {integration}");
    }
}

#[test]
fn rules_that_would_have_mechanisms_are_not_offered() {
    for kind in [ElementKind::T3, ElementKind::T6, ElementKind::Q4] {
        assert_eq!(kind.integration_points(Integration::Reduced), None);
        assert_eq!(kind.default_integration(), Integration::Full);
    }
    assert_eq!(ElementKind::Q8.default_integration(), Integration::Reduced);
}

#[test]
fn integration_points_run_along_xi_first() {
    let points = ElementKind::Q8.integration_points(Integration::Reduced).unwrap();
    let signs: Vec<_> = points.iter().map(|p| p.coordinates.map(f64::signum)).collect();
    assert_eq!(signs, [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]);
}

#[test]
fn gauss_legendre_integrates_to_degree_2n_minus_1() {
    assert!(gauss_legendre(0).is_empty());
    for count in 1..=20 {
        let points = gauss_legendre(count);
        assert!(points.is_sorted_by(|a, b| a.coordinate < b.coordinate));
        for degree in 0..2 * count as i32 {
            let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
            let sum: f64 = points.iter().map(|p| p.weight * p.coordinate.powi(degree)).sum();
            assert_abs_diff_eq!(sum, exact, epsilon = 5e-15);
        }
    }
}

#[test]
fn product_rules_are_products_of_gauss_legendre() {
    for (kind, count) in [(ElementKind::Q4, 2), (ElementKind::Q8, 3)] {
        let line = gauss_legendre(count);
        for (index, point) in kind.full_integration_points().iter().enumerate() {
            let (a, b) = (line[index % count], line[index / count]);
            assert_abs_diff_eq!(point.coordinates[0], a.coordinate, epsilon = 2e-16);
            assert_abs_diff_eq!(point.coordinates[1], b.coordinate, epsilon = 2e-16);
            assert_abs_diff_eq!(point.weight, a.weight * b.weight, epsilon = 1e-15);
        }
    }
}

#[test]
fn area_is_that_of_the_polygon_and_its_parabolic_segments() {
    for kind in ElementKind::ALL {
        let (nodes, offsets) = distorted(kind);
        let exact = exact_area(kind, &nodes, &offsets);
        assert_abs_diff_eq!(area(kind, &nodes).unwrap(), exact, epsilon = 4e-15 * exact);
    }
}

#[test]
fn reduced_rule_gives_the_area_of_curved_q8_exactly() {
    let (nodes, offsets) = distorted(ElementKind::Q8);
    let points = ElementKind::Q8.integration_points(Integration::Reduced).unwrap();
    let sum: f64 = points
        .iter()
        .map(|p| p.weight * MappedPoint::new(ElementKind::Q8, &nodes, p.coordinates).unwrap().determinant)
        .sum();
    assert_abs_diff_eq!(sum, exact_area(ElementKind::Q8, &nodes, &offsets), epsilon = 2e-14);
}

/// ½ ∮ x × dx over the edges, by edge shape functions only.
#[test]
fn area_is_the_integral_around_the_edges() {
    for kind in ElementKind::ALL {
        let (nodes, offsets) = distorted(kind);
        let mut sum = 0.0;
        for edge in 0..kind.corner_count() {
            let (local, _) = kind.edge_nodes(edge);
            let edge_nodes = local.map(|node| nodes.get(node).copied().unwrap_or([f64::NAN; 2]));
            for LinePoint { coordinate, weight } in gauss_legendre(2) {
                let point = kind.edge_kind().point(&edge_nodes, coordinate);
                sum += 0.5 * weight * cross(point.position, point.tangent);
            }
        }
        assert_abs_diff_eq!(sum, exact_area(kind, &nodes, &offsets), epsilon = 2e-14);
    }
}

#[test]
fn edges_run_along_the_element_with_their_normal_outward() {
    for kind in ElementKind::ALL {
        let (nodes, _) = distorted(kind);
        for edge in 0..kind.corner_count() {
            let (local, count) = kind.edge_nodes(edge);
            assert_eq!(count, kind.edge_kind().node_count());
            let edge_nodes = local.map(|node| nodes.get(node).copied().unwrap_or([0.0; 2]));
            let (from, to) = (kind.reference_coordinates()[local[0]], kind.reference_coordinates()[local[1]]);
            for s in [-1.0, -0.4, 0.0, 0.3, 1.0] {
                let reference = [0, 1].map(|k| 0.5 * ((1.0 - s) * from[k] + (1.0 + s) * to[k]));
                let inside = MappedPoint::new(kind, &nodes, reference).unwrap();
                let along = kind.edge_kind().point(&edge_nodes, s);
                let normal = along.outward_normal().unwrap();
                assert_abs_diff_eq!(normal[0].hypot(normal[1]), 1.0, epsilon = 1e-15);
                // From the edge into the element, in reference and then in real coordinates.
                let inward = [0, 1].map(|k| {
                    let d = [0.2 - reference[0], 0.2 - reference[1]];
                    inside.jacobian[k][0] * d[0] + inside.jacobian[k][1] * d[1]
                });
                assert!(normal[0] * inward[0] + normal[1] * inward[1] < 0.0);
                for k in 0..2 {
                    assert_abs_diff_eq!(along.position[k], inside.position[k], epsilon = 2e-15);
                    let tangent =
                        0.5 * (inside.jacobian[k][0] * (to[0] - from[0]) + inside.jacobian[k][1] * (to[1] - from[1]));
                    assert_abs_diff_eq!(along.tangent[k], tangent, epsilon = 1e-14);
                }
            }
        }
    }
}

#[test]
fn edge_derivatives_agree_with_central_differences() {
    let step = 1e-3;
    for kind in [EdgeKind::Linear, EdgeKind::Quadratic] {
        for s in [-1.0, -0.3, 0.0, 0.6, 1.0] {
            assert_abs_diff_eq!(kind.shape_functions(s).iter().sum::<f64>(), 1.0, epsilon = 1e-15);
            for node in 0..3 {
                let (plus, minus) = (kind.shape_functions(s + step)[node], kind.shape_functions(s - step)[node]);
                assert_abs_diff_eq!(kind.shape_derivatives(s)[node], (plus - minus) / (2.0 * step), epsilon = 1e-12);
                let (plus, minus) = (kind.shape_derivatives(s + step)[node], kind.shape_derivatives(s - step)[node]);
                assert_abs_diff_eq!(
                    kind.shape_second_derivatives()[node],
                    (plus - minus) / (2.0 * step),
                    epsilon = 1e-12
                );
            }
        }
    }
    assert_eq!(
        [-1.0, 1.0, 0.0].map(|s| EdgeKind::Quadratic.shape_functions(s)),
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    );
    assert_eq!([-1.0, 1.0].map(|s| EdgeKind::Linear.shape_functions(s)), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn gradients_of_a_linear_field_are_exact_on_distorted_elements() {
    let (gradient, constant) = ([0.7, -1.3], 0.4);
    for kind in ElementKind::ALL {
        let (nodes, _) = distorted(kind);
        for point in sample_points(kind) {
            let mapped = MappedPoint::new(kind, &nodes, point).unwrap();
            for k in 0..2 {
                let found: f64 = mapped
                    .shape
                    .derivatives()
                    .iter()
                    .zip(&nodes)
                    .map(|(d, x)| d[k] * (gradient[0] * x[0] + gradient[1] * x[1] + constant))
                    .sum();
                assert_abs_diff_eq!(found, gradient[k], epsilon = 5e-14);
            }
        }
    }
}

#[test]
fn characteristic_length_is_the_side_of_a_square_and_the_leg_of_its_half_of_which_quadratic_triangles_crack_two_thirds()
{
    for kind in ElementKind::ALL {
        let area = kind.reference_area();
        let length = match (kind, kind.corner_count()) {
            (ElementKind::T6, _) => 2.0 / 3.0,
            (_, 3) => 1.0,
            _ => 2.0,
        };
        assert_abs_diff_eq!(characteristic_length(kind, area), length, epsilon = 1e-15);
    }
}

#[test]
fn inverted_collapsed_and_broken_elements_are_refused() {
    for kind in ElementKind::ALL {
        let reference = kind.full_integration_points()[0].coordinates;
        let (nodes, _) = distorted(kind);
        let map = |f: fn([f64; 2]) -> [f64; 2]| {
            MappedPoint::new(kind, &nodes.iter().copied().map(f).collect::<Vec<_>>(), reference)
        };
        assert!(matches!(map(|[x, y]| [-x, y]), Err(MappingError::Jacobian { determinant }) if determinant < 0.0));
        assert_eq!(map(|[x, _]| [x, 0.0]), Err(MappingError::Jacobian { determinant: 0.0 }));
        assert!(matches!(map(|[x, _]| [x, f64::NAN]), Err(MappingError::Jacobian { .. })));
        assert_eq!(
            MappedPoint::new(kind, &nodes[1..], reference),
            Err(MappingError::NodeCount { kind, found: kind.node_count() - 1 })
        );
    }
}
