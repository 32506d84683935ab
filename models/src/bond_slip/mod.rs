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
    ConfigurationError, Failure, InterfaceIncrement, InterfaceLaw, InterfaceResponse, LawInfo, Request,
    TangentialIncrement, TangentialResponse,
};
use umat_abi::metadata::{StateVariable, flags};

/// The law.
pub struct BondSlip;

const STATES: [StateVariable; 12] = [
    StateVariable::new(c"slip_1", c"mm", c"total slip in direction 1"),
    StateVariable::new(c"slip_2", c"mm", c"total slip in direction 2"),
    StateVariable::new(c"side", c"-", c"law A: direction of first debonding, +-1 along direction 1; 0: none yet"),
    StateVariable::new(c"kappa", c"mm", c"largest slip (law A after debonding: towards its side)"),
    StateVariable::new(c"g_pl_1", c"mm", c"law A: inelastic slip of the bond in direction 1"),
    StateVariable::new(c"g_pl_2", c"mm", c"law A: inelastic slip of the bond in direction 2"),
    StateVariable::new(c"g_s_1", c"mm", c"slip of the friction slider in direction 1"),
    StateVariable::new(c"g_s_2", c"mm", c"slip of the friction slider in direction 2"),
    StateVariable::new(c"open", c"-", c"1: the normal bond is broken for good"),
    StateVariable::new(c"opening", c"mm", c"largest gap beyond the start of opening (tension cap, or 0.8 g_0)"),
    StateVariable::new(c"d", c"-", c"law B: damage of the bond"),
    StateVariable::new(c"dissipated_energy", c"N/mm", c"energy dissipated since the virgin state"),
];

/// The state variables by name; all zero is the virgin point.
#[derive(Clone, Copy, Debug)]
struct State {
    slip: [f64; 2],
    side: f64,
    /// κ
    largest_slip: f64,
    /// g_pl
    plastic_slip: [f64; 2],
    /// g_s
    friction_slip: [f64; 2],
    open: f64,
    opening: f64,
    /// d
    damage: f64,
    dissipated_energy: f64,
}

impl State {
    /// Reads STATEV; `None` if it is too short or holds a number that is none.
    fn read(values: &[f64]) -> Option<Self> {
        let &[s_1, s_2, side, largest_slip, p_1, p_2, f_1, f_2, open, opening, damage, dissipated_energy] = values
        else {
            return None;
        };
        values.iter().all(|x| x.is_finite()).then_some(Self {
            slip: [s_1, s_2],
            side,
            largest_slip,
            plastic_slip: [p_1, p_2],
            friction_slip: [f_1, f_2],
            open,
            opening,
            damage,
            dissipated_energy,
        })
    }

    fn write(&self, values: &mut [f64]) {
        let ([s_1, s_2], [p_1, p_2], [f_1, f_2]) = (self.slip, self.plastic_slip, self.friction_slip);
        values.copy_from_slice(&[
            s_1,
            s_2,
            self.side,
            self.largest_slip,
            p_1,
            p_2,
            f_1,
            f_2,
            self.open,
            self.opening,
            self.damage,
            self.dissipated_energy,
        ]);
    }
}

/// A host's NaN or a state that no update wrote: nothing to integrate from.
const NOT_FINITE: Failure = Failure::CutBack { fraction: 0.5, reason: "displacement, pressure or state is not finite" };

/// The result if every number of it is one.
fn finite<R>(result: R, numbers: impl IntoIterator<Item = f64>) -> Result<R, Failure> {
    if numbers.into_iter().all(f64::is_finite) { Ok(result) } else { Err(NOT_FINITE) }
}

impl InterfaceLaw for BondSlip {
    const INFO: LawInfo = LawInfo {
        name: c"bond_slip",
        description: c"Bond and friction of a fibre-matrix interface with opening",
        parameters: &parameters::PARAMETERS,
        repeating: Some(parameters::POINTS),
        states: &STATES,
        derived: &[],
        flags: flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
    };

    type Parameters<'p> = BondSlipParameters<'p>;

    fn parameters(props: &[f64]) -> Result<BondSlipParameters<'_>, ConfigurationError> {
        BondSlipParameters::read(props)
    }

    #[inline]
    fn update(
        parameters: &BondSlipParameters<'_>,
        increment: &InterfaceIncrement,
        state: &mut [f64],
        _request: Request,
    ) -> Result<InterfaceResponse, Failure> {
        if let NormalLaw::Hard(law) = &parameters.normal {
            let rule = "the hard normal law needs normal_stiffness > 0: a host fills a 0 before it calls";
            envelope::require(law.stiffness > 0.0, rule, law.stiffness)?;
        }
        let mut point = State::read(state).ok_or(NOT_FINITE)?;
        // directions that the host does not have may hold anything
        let present = |i: usize| if i < increment.directions { increment.relative_displacement[i] } else { 0.0 };
        let start = parameters.normal.bond_fraction(&point);
        let normal = parameters.normal.advance(present(0), &mut point);
        let slip = Slip { start: point.slip, end: [present(1), present(2)] };
        let fraction = BondFraction { start, end: normal.bond_fraction };
        let tangential =
            parameters.tangential.advance(&parameters.friction, &slip, normal.pressure, fraction, &mut point);
        point.dissipated_energy += normal.dissipation + tangential.dissipation;

        let mut response = InterfaceResponse {
            stored_energy: normal.stored_energy + tangential.stored_energy,
            dissipated_energy: point.dissipated_energy,
            ..Default::default()
        };
        response.traction[0] = normal.pressure;
        response.tangent[0][0] = normal.stiffness;
        for i in 0..increment.directions.clamp(1, 3) - 1 {
            response.traction[1 + i] = tangential.traction[i];
            // the pressure and the fade of the bond both follow the penetration
            response.tangent[1 + i][0] = tangential.pressure_tangent[i] * normal.stiffness
                + tangential.bond_fraction_tangent[i] * normal.bond_fraction_slope;
            for j in 0..increment.directions.clamp(1, 3) - 1 {
                response.tangent[1 + i][1 + j] = tangential.slip_tangent[i][j];
            }
        }
        point.write(state);
        // a NaN slip hides behind a friction limit of 0
        let numbers = slip.end.into_iter().chain([response.stored_energy, response.dissipated_energy]);
        finite(response, numbers.chain(response.traction).chain(response.tangent.into_iter().flatten()))
    }

    #[inline]
    fn update_tangential(
        parameters: &BondSlipParameters<'_>,
        increment: &TangentialIncrement,
        state: &mut [f64],
        _request: Request,
    ) -> Result<TangentialResponse, Failure> {
        let mut point = State::read(state).ok_or(NOT_FINITE)?;
        let present = |i: usize| if i < increment.directions { increment.slip_increment[i] } else { 0.0 };
        let slip = Slip { start: point.slip, end: [0, 1].map(|i| point.slip[i] + present(i)) };
        let fraction = parameters.normal.bond_fraction(&point);
        let fraction = BondFraction { start: fraction, end: fraction };
        let before = parameters.tangential.inelastic_slip(&point);
        let Contribution { traction, slip_tangent, pressure_tangent, stored_energy, dissipation, .. } =
            parameters.tangential.advance(&parameters.friction, &slip, increment.pressure, fraction, &mut point);
        point.dissipated_energy += dissipation;
        let after = parameters.tangential.inelastic_slip(&point);
        let mut response =
            TangentialResponse { stored_energy, dissipated_energy: point.dissipated_energy, ..Default::default() };
        for i in 0..increment.directions.min(2) {
            response.traction[i] = traction[i];
            response.pressure_tangent[i] = pressure_tangent[i];
            response.inelastic_slip_increment[i] = after[i] - before[i];
            for j in 0..increment.directions.min(2) {
                response.slip_tangent[i][j] = slip_tangent[i][j];
            }
        }
        point.write(state);
        // a NaN pressure hides behind ⟨p⟩ = 0, a NaN slip behind a friction limit of 0
        let numbers = [increment.pressure, response.stored_energy, response.dissipated_energy].into_iter();
        finite(
            response,
            numbers.chain(slip.end).chain(response.traction).chain(response.slip_tangent.into_iter().flatten()),
        )
    }
}
