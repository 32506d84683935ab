//! The axis of a fibre, by its arc length.

/// A line through the origin that leans to the right of +y, and bends back to it after the origin if it is bent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Angle from +y, rad.
    pub(super) angle: f64,
    /// Radius of the bend that starts at the origin, mm; `None`: straight.
    pub(super) bend_radius: Option<f64>,
}

impl Axis {
    /// Arc length at which the bend ends, mm: 0 without one.
    pub(super) fn bend_end(&self) -> f64 {
        self.bend_radius.map_or(0.0, |radius| radius * self.angle)
    }

    /// The angle from +y at an arc length, rad.
    pub(super) fn lean(&self, s: f64) -> f64 {
        match self.bend_radius {
            Some(radius) if s > 0.0 => (self.angle - s / radius).max(0.0),
            _ => self.angle,
        }
    }

    /// The unit normal to the left.
    pub(super) fn left(&self, s: f64) -> [f64; 2] {
        let (sine, cosine) = self.lean(s).sin_cos();
        [-cosine, sine]
    }

    /// The point at an arc length (0 at the origin, negative below), so far to the left of the axis.
    pub(super) fn point(&self, s: f64, left: f64) -> [f64; 2] {
        let (sine, cosine) = self.angle.sin_cos();
        let [n_x, n_y] = self.left(s);
        let [x, y] = match self.bend_radius {
            Some(radius) if s > 0.0 => {
                let (lean_sine, lean_cosine) = self.lean(s).sin_cos();
                let beyond = (s - self.bend_end()).max(0.0);
                [radius * (lean_cosine - cosine), radius * (sine - lean_sine) + beyond]
            }
            _ => [s * sine, s * cosine],
        };
        [x + left * n_x, y + left * n_y]
    }

    /// The arc length at which an exit edge of this radius begins on the wall `offset` to the left of the axis (negative:
    /// to the right): there a circle touches the wall and the face y = 0 from within the block. May lie above the end of
    /// the fibre.
    pub(super) fn exit_start(&self, offset: f64, exit_radius: f64) -> f64 {
        let (sine, cosine) = self.angle.sin_cos();
        // the circle's centre lies on the line at this distance from the axis, `exit_radius` below the face
        let centre = offset + exit_radius.copysign(offset);
        let straight = (-exit_radius - centre * sine) / cosine;
        match self.bend_radius {
            Some(radius) if straight > 0.0 => {
                let lean = ((radius * sine + exit_radius) / (radius - centre)).asin();
                radius * (self.angle - lean)
            }
            _ => straight,
        }
    }

    /// The radius of the exit edge that begins at an arc length of the wall `offset` to the left of the axis.
    pub(super) fn exit_radius(&self, offset: f64, s: f64) -> f64 {
        let ([_, y], [_, n_y]) = (self.point(s, offset), self.left(s));
        -y / (1.0 + n_y.copysign(n_y * offset))
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn the_bend_turns_the_axis_to_the_normal_of_the_face() {
        let axis = Axis { angle: 1.0, bend_radius: Some(0.6) };
        let step = 1e-6;
        for s in [-2.0, -0.1, 0.2, 0.5, 0.7, 3.0] {
            let ([a_x, a_y], [b_x, b_y]) = (axis.point(s - step, 0.0), axis.point(s + step, 0.0));
            let (tangent, lean) = ([(b_x - a_x) / (2.0 * step), (b_y - a_y) / (2.0 * step)], axis.lean(s));
            assert!((tangent[0] - lean.sin()).abs() < 1e-8 && (tangent[1] - lean.cos()).abs() < 1e-8, "{s}");
        }
        assert_eq!(axis.lean(axis.bend_end() + 0.1), 0.0);
    }

    #[test]
    fn the_exit_edge_touches_wall_and_face() {
        for degrees in [0.0_f64, 5.0, 14.0, 37.0, 60.0, 75.0] {
            for bend_radius in [None, Some(0.609)] {
                for offset in [0.203, -0.203] {
                    let axis = Axis { angle: degrees.to_radians(), bend_radius };
                    let s = axis.exit_start(offset, 0.1015);
                    let ([_, y], [_, n_y]) = (axis.point(s, offset), axis.left(s));
                    // the centre is `radius` from the wall, into the block, and from the face
                    let centre = y + 0.1015 * n_y * offset.signum();
                    assert!((centre + 0.1015).abs() < 1e-12, "{degrees} {bend_radius:?} {offset}: {centre}");
                    assert!((axis.exit_radius(offset, s) - 0.1015).abs() < 1e-12, "{degrees} {offset}");
                }
            }
        }
    }
}
