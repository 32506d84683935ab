#![doc = include_str!("doc.md")]

mod envelope;
mod friction;
mod law_a;
mod law_b;
mod normal;
mod parameters;
mod tangential;
#[cfg(test)]
mod test;

pub use envelope::{Envelope, Strength};
pub use parameters::BondSlipParameters;

use normal::NormalLaw;
use tangential::{BondFraction, Contribution, Slip};
use umat_abi::law::{
    Failure, InterfaceIncrement, InterfaceLaw, InterfaceResponse, LawInfo, Request, TangentialIncrement,
    TangentialResponse,
};
use umat_abi::metadata::{StateVariable, flags};
use umat_abi::table::require;

/// The law.
pub struct BondSlip;

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// Total slip.
        pub slip: [f64; 2] =
            StateVariable::new(c"slip_1", c"mm", c"total slip in direction 1"),
            StateVariable::new(c"slip_2", c"mm", c"total slip in direction 2");
        /// Direction of first debonding.
        pub side: f64 = StateVariable::new(
            c"side", c"-", c"law A: direction of first debonding, +-1 along direction 1; 0: none yet",
        );
        /// κ.
        pub largest_slip: f64 =
            StateVariable::new(c"kappa", c"mm", c"largest slip (law A after debonding: towards its side)");
        /// g_pl.
        pub plastic_slip: [f64; 2] =
            StateVariable::new(c"g_pl_1", c"mm", c"law A: inelastic slip of the bond in direction 1"),
            StateVariable::new(c"g_pl_2", c"mm", c"law A: inelastic slip of the bond in direction 2");
        /// g_s.
        pub friction_slip: [f64; 2] =
            StateVariable::new(c"g_s_1", c"mm", c"slip of the friction slider in direction 1"),
            StateVariable::new(c"g_s_2", c"mm", c"slip of the friction slider in direction 2");
        /// 1: broken.
        pub open: f64 = StateVariable::new(c"open", c"-", c"1: the normal bond is broken for good");
        /// Largest opening.
        pub opening: f64 = StateVariable::new(
            c"opening", c"mm", c"largest gap beyond the start of opening (tension cap, or 0.8 g_0)",
        );
        /// d.
        pub damage: f64 = StateVariable::new(c"d", c"-", c"law B: damage of the bond");
        /// Energy dissipated by friction, bond and opening.
        pub dissipated_energy: f64 =
            StateVariable::new(c"dissipated_energy", c"N/mm", c"energy dissipated since the virgin state");
    }
}

impl InterfaceLaw for BondSlip {
    const INFO: LawInfo = LawInfo {
        name: c"bond_slip",
        description: c"Bond and friction of a fibre-matrix interface with opening",
        flags: flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<BondSlipParameters<'_>, State>()
    };

    type Parameters<'p> = BondSlipParameters<'p>;
    type State = State;

    #[inline]
    fn update(
        parameters: &BondSlipParameters<'_>,
        increment: &InterfaceIncrement,
        state: &mut State,
        _request: Request,
    ) -> Result<InterfaceResponse, Failure> {
        if let NormalLaw::Hard(law) = &parameters.normal {
            let rule = "the hard normal law needs normal_stiffness > 0: a host fills a 0 before it calls";
            require(law.stiffness > 0.0, rule, law.stiffness)?;
        }
        // directions that the host does not have may hold anything
        let present = |i: usize| if i < increment.directions { increment.relative_displacement[i] } else { 0.0 };
        let slip = Slip { start: state.slip, end: [present(1), present(2)] };
        let BondSlipParameters { tangential, friction, normal } = parameters;
        let (normal, tangential) = if let Some(hard) = parameters.mixed_mode() {
            // the damage first: slip and gap drive it, and it takes shear and tension
            let penetration = [present(0) - increment.increment[0], present(0)];
            let (gap, pressed) = ((-penetration[1]).max(0.0), hard.stiffness * penetration[1].max(0.0));
            let whole = BondFraction { start: 1.0, end: 1.0 };
            let bond = tangential.advance(friction, &slip, gap, pressed, whole, state);
            (hard.damaged(penetration, &bond.integrity, state), bond)
        } else {
            let start = normal.bond_fraction(state);
            let normal = normal.advance(present(0), state);
            let fraction = BondFraction { start, end: normal.bond_fraction };
            (normal, tangential.advance(friction, &slip, 0.0, normal.pressure, fraction, state))
        };
        state.dissipated_energy += normal.dissipation + tangential.dissipation;

        let mut response = InterfaceResponse {
            stored_energy: normal.stored_energy + tangential.stored_energy,
            dissipated_energy: state.dissipated_energy,
            ..Default::default()
        };
        response.traction[0] = normal.pressure;
        response.tangent[0][0] = normal.stiffness;
        for i in 0..increment.directions.clamp(1, 3) - 1 {
            response.traction[1 + i] = tangential.traction[i];
            response.tangent[0][1 + i] = normal.by_slip[i];
            // the pressure and the fade of the bond, or its damage, follow the penetration
            response.tangent[1 + i][0] = tangential.pressure_tangent[i] * normal.stiffness
                + tangential.bond_fraction_tangent[i] * normal.bond_fraction_slope
                - tangential.gap_tangent[i];
            for j in 0..increment.directions.clamp(1, 3) - 1 {
                response.tangent[1 + i][1 + j] = tangential.slip_tangent[i][j];
            }
        }
        Ok(response)
    }

    #[inline]
    fn update_tangential(
        parameters: &BondSlipParameters<'_>,
        increment: &TangentialIncrement,
        state: &mut State,
        _request: Request,
    ) -> Result<TangentialResponse, Failure> {
        let present = |i: usize| if i < increment.directions { increment.slip_increment[i] } else { 0.0 };
        let slip = Slip { start: state.slip, end: [0, 1].map(|i| state.slip[i] + present(i)) };
        let fraction = parameters.bond_fraction(state);
        let fraction = BondFraction { start: fraction, end: fraction };
        let before = parameters.tangential.inelastic_slip(state);
        let Contribution { traction, slip_tangent, pressure_tangent, stored_energy, dissipation, .. } =
            parameters.tangential.advance(&parameters.friction, &slip, 0.0, increment.pressure, fraction, state);
        state.dissipated_energy += dissipation;
        let after = parameters.tangential.inelastic_slip(state);
        let mut response =
            TangentialResponse { stored_energy, dissipated_energy: state.dissipated_energy, ..Default::default() };
        for i in 0..increment.directions.min(2) {
            response.traction[i] = traction[i];
            response.pressure_tangent[i] = pressure_tangent[i];
            response.inelastic_slip_increment[i] = after[i] - before[i];
            for j in 0..increment.directions.min(2) {
                response.slip_tangent[i][j] = slip_tangent[i][j];
            }
        }
        Ok(response)
    }
}
