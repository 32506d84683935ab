//! Parameter sets that the law is tried at.

pub const E: f64 = 23_700.0;
pub const NU: f64 = 0.15;
pub const COHESION: f64 = 38.1;
pub const ANGLE: f64 = 18.8;

pub const fn props(dilation: f64, cone: f64) -> [f64; 6] {
    [E, NU, COHESION, ANGLE, dilation, cone]
}

pub const SETS: [[f64; 6]; 9] = [
    props(ANGLE, 0.0),
    props(ANGLE, 1.0),
    props(ANGLE, 2.0),
    props(0.0, 0.0),
    props(8.0, 1.0),
    props(0.0, 2.0),
    [E, 0.45, 20.0, 40.0, 40.0, 2.0],
    [E, 0.0, 20.0, 30.0, 10.0, 0.0],
    [E, -0.3, 20.0, 30.0, 30.0, 1.0],
];
