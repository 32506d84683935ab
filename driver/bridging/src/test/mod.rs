mod beam;
mod closed_forms;
mod composite;
mod hook;
mod invalid;
mod inverse;
mod orientation;
mod properties;
mod scatter;
mod shear_lag;
mod spalling;
mod table;
mod work;

use crate::*;

/// L_f 30, d 0.5, E 210 000.
fn fibre() -> Fibre {
    Fibre { diameter: 0.5, length: 30.0, modulus: 210_000.0, strength: None, rupture_f: 0.0 }
}

/// E 30 000, f_t 3, brittle.
fn matrix() -> Matrix {
    Matrix { modulus: 30_000.0, ft: 3.0, softening: Softening::None, fracture_energy: 0.0, fc: None }
}

/// τ 3.
fn friction(debonding: Debonding, sliding: Sliding) -> Closed {
    Closed { tau: 3.0, beta: 0.0, debonding_energy: 0.0, debonding, sliding, hook: None }
}

/// V_f 1 %, snubbing f 0.5.
fn composite(fibre: Fibre, bond: &Bond, sides: Sides, orientation: &Orientation) -> Composite {
    let fibre = BridgingFibre::new(fibre, bond, Inclination::Exp { f: 0.5 }, sides, 0.0).expect("a fibre");
    Composite::new(fibre, 0.01, orientation, matrix(), 0.0).expect("a composite")
}

/// C2.
fn pulled_out(fibre: Fibre, orientation: &Orientation) -> Composite {
    composite(fibre, &Bond::Closed(friction(Debonding::Rigid, Sliding::Shortening)), Sides::One, orientation)
}
