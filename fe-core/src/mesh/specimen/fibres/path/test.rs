use super::*;

fn bent(angle: f64, radius: f64) -> Path {
    let bend = Segment::Arc { radius, to: 0.0 };
    Path::new(angle, &[Segment::Straight { length: 12.2 }, bend, Segment::Straight { length: 3.0 }], 12.2, 0.0)
}

fn paths() -> Vec<Path> {
    let hook = [
        Segment::Straight { length: 2.0 },
        Segment::Arc { radius: 0.75, to: -0.6 },
        Segment::Straight { length: 1.5 },
        Segment::Arc { radius: 0.75, to: 0.3 },
        Segment::Straight { length: 10.0 },
    ];
    let wave = [Segment::Wave { amplitude: 0.4, length: 8.0, count: 2.5 }, Segment::Straight { length: 1.0 }];
    vec![bent(1.0, 0.6), Path::new(0.3, &hook, 12.0, 1.0), Path::new(-0.2, &wave, 15.0, -3.0)]
}

#[test]
fn a_path_is_continuous_with_its_tangent_and_measured_by_its_arc_length() {
    let step = 1e-5;
    for path in paths() {
        let [x, y] = path.point(0.0, 0.0);
        assert!(y.abs() < 1e-12, "{x} {y}");
        for k in 0..400 {
            let s = -15.0 + f64::from(k) * 0.049;
            let ([a_x, a_y], [b_x, b_y]) = (path.point(s - step, 0.0), path.point(s + step, 0.0));
            let (tangent, lean) = ([(b_x - a_x) / (2.0 * step), (b_y - a_y) / (2.0 * step)], path.lean(s));
            let off = (tangent[0] - lean.sin()).abs().max((tangent[1] - lean.cos()).abs());
            // across a change of curvature the difference is that of the step
            assert!(off < 2e-5, "{s}: {tangent:?} {lean}");
        }
    }
}

#[test]
fn a_wave_turns_by_the_curvature_of_its_crests() {
    let wave = Segment::Wave { amplitude: 0.4, length: 8.0, count: 3.0 };
    let path = Path::new(0.0, &[wave], 5.0, 0.0);
    let step = 1e-4;
    let curvature = |s: f64| (path.lean(s + step) - path.lean(s - step)) / (2.0 * step);
    // half a wave from its beginning the crest lies 2a off the axis
    let length = path.end() + 5.0;
    let crest = -5.0 + length / 6.0;
    let ([start, _], [x, _]) = (path.point(-5.0, 0.0), path.point(crest, 0.0));
    assert!((start - x - 0.8).abs() < 1e-9);
    assert!((curvature(crest).abs() * wave.least_radius() - 1.0).abs() < 1e-3);
}

#[test]
fn the_exit_edge_touches_wall_and_face() {
    for degrees in [0.0_f64, 5.0, 14.0, 37.0, 60.0, 75.0] {
        for path in [
            Path::new(degrees.to_radians(), &[Segment::Straight { length: 12.2 }], 12.2, 0.0),
            bent(degrees.to_radians(), 0.609),
        ] {
            for offset in [0.203, -0.203] {
                let s = path.exit_start(offset, 0.1015, 5.0).unwrap();
                let ([_, y], [_, n_y]) = (path.point(s, offset), path.left(s));
                // the centre is `radius` from the wall, into the block, and from the face
                let centre = y + 0.1015 * n_y * offset.signum();
                assert!((centre + 0.1015).abs() < 1e-12, "{degrees} {offset}: {centre}");
                assert!((path.exit_radius(offset, s) - 0.1015).abs() < 1e-12, "{degrees} {offset}");
            }
        }
    }
}

#[test]
fn the_nearest_point_is_found_on_lines_and_arcs() {
    let path = bent(0.7, 0.6);
    for s in [-8.0, -1.0, 0.2, 1.5] {
        let (found, distance) = path.nearest(path.point(s, 0.3), [-12.2, 3.0]);
        assert!((found - s).abs() < 0.01 && (distance - 0.3).abs() < 1e-3, "{s}: {found} {distance}");
    }
    assert_eq!(path.nearest([0.0, 1.0], [-12.2, 0.0]).0, 0.0);
}

/// The nearest of a thousand places along each piece is never nearer.
#[test]
fn the_nearest_point_is_found_on_many_pieces() {
    let mut segments = Vec::new();
    for k in 0..40 {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        segments.push(Segment::Straight { length: 0.7 });
        segments.push(Segment::Arc { radius: 0.8, to: side * 1.2 });
        segments.push(Segment::Wave { amplitude: 0.1 * side, length: 1.0, count: 1.5 });
    }
    let path = Path::new(0.3, &segments, 60.0, 1.0);
    let range = [-60.0, path.end()];
    for k in 0..200 {
        let s = range[0] + (range[1] - range[0]) * f64::from(k) / 199.0;
        let point = path.point(s, 2.0 * (f64::from(k) * 0.7).sin());
        let (found, nearest) = path.nearest(point, range);
        assert_eq!(distance(point, path.point(found, 0.0)), nearest);
        let places = (0..=60_000).map(|k| range[0] + (range[1] - range[0]) * f64::from(k) / 60_000.0);
        let least = places.map(|s| distance(point, path.point(s, 0.0))).fold(f64::INFINITY, f64::min);
        // curves are looked at in 64 places each
        assert!(nearest - least < 2e-3 && least - nearest < 1e-3, "{s}: {nearest} {least}");
        assert_eq!(path.nearest_within(point, range, nearest), None);
        assert_eq!(path.nearest_within(point, range, nearest + 1e-9), Some((found, nearest)));
    }
}
