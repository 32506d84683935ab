#![doc = include_str!("phase_field.md")]

use super::evolution::{Branch, Evolution, History};
use super::stress_and_tangent::Point;
use super::{HISTORY, Parameters as ConcreteProperties, State as ImplicitState, plane_stress};
use crate::damage_law::DamageLaw;
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use crate::tensor::{Elasticity, work};
use std::f64::consts::PI;
use umat_abi::law::{ConfigurationError, Failure, Heat, Increment, Law, LawInfo, Request, Response};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};
use umat_abi::table::{Field, Parameters as _, require};

/// The law.
pub struct ConcretePhaseField;

/// k: what is left of the stiffness of a broken point, as a part of the virgin one.
const RESIDUAL: f64 = 1e-9;

/// The softening of a crack: p, a_2, a_3 of ω(d).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackSoftening {
    p: f64,
    a_2: f64,
    a_3: f64,
}

impl Field<3> for CrackSoftening {
    #[inline(always)]
    fn read([p, a_2, a_3]: [f64; 3]) -> Result<Self, ConfigurationError> {
        Ok(Self { p, a_2, a_3 })
    }
}

/// Rows of the parameters of `concrete_damage`.
const CONCRETE: &[Parameter] = ConcreteProperties::TABLE;

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        pub elasticity: Elasticity = CONCRETE[0], CONCRETE[1];
        /// f_t.
        pub tensile_strength: f64 =
            Parameter::new(c"f_t", c"MPa", 3.0, c"tensile strength").above(0.0).typically(0.1, 20.0);
        /// G_f.
        pub fracture_energy: f64 =
            Parameter::new(c"G_f", c"N/mm", 0.09, c"fracture energy in tension").above(0.0).typically(0.002, 20.0);
        /// l.
        pub length: f64 =
            Parameter::new(c"l", c"mm", 5.0, c"length of the phase field: a crack is smeared over pi l").above(0.0).typically(0.01, 100.0);
        /// p, a_2, a_3.
        pub softening: CrackSoftening =
            Parameter::new(c"p", c"-", 3.1667, c"exponent of the degradation function").at_least(2.0).at_most(20.0),
            Parameter::new(c"a_2", c"-", -1.0, c"second coefficient of the degradation function"),
            Parameter::new(c"a_3", c"-", 1.9791, c"third coefficient of the degradation function");
        /// A_c, B_c, Y_c0.
        pub compression: DamageLaw = CONCRETE[5], CONCRETE[6], CONCRETE[7];
        /// β: how much of the hydrostatic stiffness compressive damage takes.
        pub beta: f64 = CONCRETE[8];
        /// ζ_c: how much confinement delays compressive damage.
        pub zeta_c: f64 = CONCRETE[9];
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η of ω(d).
        pub eta_t: f64 = StateVariable::new(c"eta_t", c"-", c"tensile damage D_t/(1 - D_t) of the phase field");
        /// η_c.
        pub eta_c: f64 = HISTORY[1];
        /// H without its threshold.
        pub driving_force: f64 =
            StateVariable::new(c"H", c"MPa", c"largest energy so far that opening cracks would release");
        /// The largest Y_c.
        pub compression_maximum: f64 = HISTORY[3];
        /// Ψ.
        pub stored_energy: f64 = StateVariable::new(c"stored_energy", c"N*mm/mm^3", c"stored energy");
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// Work that is not stored.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

/// ω of one d.
#[derive(Clone, Copy, Debug)]
struct Degradation {
    /// 1/ω − 1.
    eta: f64,
    /// ∂σ/∂d = `stress_slope` (σ_0 − σ_NT): ω', or 0 where d is outside 0 … 1.
    stress_slope: f64,
    /// ω' and ω'' as the field equation has them.
    slope: f64,
    curvature: f64,
}

impl Parameters {
    /// λ + 2μ: the modulus of a band that opens between its neighbours.
    #[inline]
    fn band_modulus(&self) -> f64 {
        self.elasticity.lambda + 2.0 * self.elasticity.shear_modulus
    }

    /// The energy at which d leaves 0.
    #[inline]
    fn threshold(&self) -> f64 {
        0.5 * self.tensile_strength * self.tensile_strength / self.band_modulus()
    }

    /// H at the end of an increment, 0 as long as nothing has cracked, from the one reached before.
    #[inline]
    fn driving_force(&self, point: &Point, reached: f64) -> f64 {
        let force = point.evolution.solid.tensile_force();
        if force > reached.max(self.threshold()) { force } else { reached }
    }

    /// a_1.
    #[inline]
    fn a_1(&self) -> f64 {
        2.0 * self.fracture_energy / (PI * self.length * self.threshold())
    }

    /// ω at a value of the field. Below 0 it is that of 0 to the stress, and goes on as a parabola in the field equation.
    #[inline]
    fn degradation(&self, d: f64) -> Degradation {
        let CrackSoftening { p, a_2, a_3 } = self.softening;
        let a_1 = self.a_1();
        if d <= 0.0 {
            let curvature = 2.0 * a_1 * (a_1 - p - a_2);
            let slope = -a_1 + curvature * d;
            // the derivative to the side of growth
            let stress_slope = if d == 0.0 { slope } else { 0.0 };
            return Degradation { eta: 0.0, stress_slope, slope, curvature };
        }
        if d >= 1.0 {
            return Degradation { eta: (1.0 - RESIDUAL) / RESIDUAL, stress_slope: 0.0, slope: 0.0, curvature: 0.0 };
        }
        let rest = 1.0 - d;
        let power = rest.powf(p - 2.0);
        let [g, g_1, g_2] = [power * rest * rest, -p * power * rest, p * (p - 1.0) * power];
        let q = a_1 * d * (1.0 + d * (a_2 + d * a_3));
        let q_1 = a_1 * (1.0 + d * (2.0 * a_2 + 3.0 * d * a_3));
        let q_2 = a_1 * (2.0 * a_2 + 6.0 * d * a_3);
        let sum = g + q;
        let numerator = g_1 * q - g * q_1;
        let slope = (1.0 - RESIDUAL) * numerator / (sum * sum);
        let curvature = (1.0 - RESIDUAL) * ((g_2 * q - g * q_2) - 2.0 * (g_1 + q_1) * numerator / sum) / (sum * sum);
        // so rounding does not heal a point that is all but broken
        let eta = (1.0 - RESIDUAL) / (g / q + RESIDUAL);
        Degradation { eta, stress_slope: slope, slope, curvature }
    }

    /// The concrete, which neither damages in tension by itself nor keeps an inelastic strain.
    #[inline]
    fn concrete(&self) -> ConcreteProperties {
        let &Self { elasticity, compression, beta, zeta_c, .. } = self;
        ConcreteProperties {
            elasticity,
            tension: DamageLaw { a: 1.0, b: 1.0, threshold: f64::MAX },
            compression,
            beta,
            zeta_c,
            b_t: 0.0,
            b_c: 0.0,
            fracture_energy: 0.0,
            crushing_energy: 0.0,
        }
    }
}

impl Law for ConcretePhaseField {
    const INFO: LawInfo = LawInfo {
        name: c"concrete_phase_field",
        description: c"Concrete: cracks as a phase field (PF-CZM), passed as temperature; closure and crushing of IV-H",
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };
    const COUPLED: bool = true;
    type Parameters<'p> = Parameters;
    type State = State;

    #[inline(always)]
    fn check(parameters: &Parameters) -> Result<(), ConfigurationError> {
        let CrackSoftening { p, a_2, a_3 } = parameters.softening;
        let end = 1.0 + a_2 + a_3;
        let lowest = if a_3 > 0.0 { (-a_2 / (2.0 * a_3)).clamp(0.0, 1.0) } else { 1.0 };
        let least = (1.0 + lowest * (a_2 + lowest * a_3)).min(end);
        require(least > 0.0, "1 + a_2 d + a_3 d^2 must be positive between d = 0 and 1", least)?;
        let rule = "l is too large for E, G_f and f_t: 4 E' G_f/(pi l f_t^2) must be greater than a_2 + p + 1/2, E' = lambda + 2 mu";
        require(parameters.a_1() > a_2 + p + 0.5, rule, parameters.length)
    }

    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        Ok(Self::update_coupled(parameters, increment, state, request)?.0)
    }

    #[inline(never)]
    fn update_coupled(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<(Response, Heat), Failure> {
        let concrete = parameters.concrete();
        let degradation = parameters.degradation(increment.temperature);
        let history = History {
            tension: Branch { eta: degradation.eta, maximum: 0.0 },
            compression: Branch { eta: state.eta_c, maximum: state.compression_maximum },
        };
        let softening = concrete.softening(None);
        let evolve = |strain: &[f64; 3]| Evolution::new(&concrete, &softening, &history, strain);
        let start = ImplicitState { history, strain_33: state.strain_33, ..ImplicitState::default() };
        let point = Point::solve(&concrete, evolve, &history, increment, &start)?;
        let stress = point.stress(&concrete);
        let tangent = if request.wants_tangent() { point.tangent(&concrete) } else { [[0.0; 6]; 6] };
        let heat = parameters.heat(&concrete, &point, increment.temperature, &degradation, state.driving_force);
        let stored_energy = point.evolution.solid.energy();
        let mean = std::array::from_fn(|i| 0.5 * (increment.stress[i] + stress[i]));
        let compression = point.evolution.history.compression;
        *state = State {
            eta_t: degradation.eta,
            eta_c: compression.eta,
            driving_force: parameters.driving_force(&point, state.driving_force),
            compression_maximum: compression.maximum,
            stored_energy,
            strain_33: point.trial[2],
            dissipated_energy: state.dissipated_energy + work(&mean, &increment.strain_increment)
                - (stored_energy - state.stored_energy),
        };
        let dissipated_energy = state.dissipated_energy;
        Ok((Response { stress, tangent, stored_energy, dissipated_energy }, heat))
    }
}

impl Parameters {
    /// The source of the field equation at a point, with the derivatives (phase_field.md).
    fn heat(
        &self,
        concrete: &ConcreteProperties,
        point: &Point,
        d: f64,
        degradation: &Degradation,
        reached: f64,
    ) -> Heat {
        let solid = &point.evolution.solid;
        let force = solid.tensile_force();
        let least = reached.max(self.threshold());
        let drive = least.max(force);
        let by_drive = -PI / (2.0 * self.length * self.fracture_energy) * degradation.slope;
        let curvature = -PI / (2.0 * self.length * self.fracture_energy) * degradation.curvature * drive;
        let per_area = 1.0 / (self.length * self.length);
        // beyond 1 the other way: back to it
        let (local, local_slope) = if d > 1.0 { (1.0 - d, -1.0) } else { (d - 1.0, 1.0) };
        let rpl = by_drive * drive + local * per_area;
        let mut drpldt = curvature + local_slope * per_area;
        let softening = solid.tensile_softening();
        let mut by_field = softening.map(|difference| -degradation.stress_slope * difference);
        let mut by_strain = [0.0; 3];
        if force > least {
            let through_crushing = self.force_by_crushing(concrete, point);
            by_strain = std::array::from_fn(|j| by_drive * (-softening[j] + through_crushing[j]));
        }
        if let Some(normal) = point.normal {
            let (tangent, _) = point.evolution.tangent(concrete);
            let row = tangent[normal];
            let pivot = plane_stress::pivot(&row, normal);
            let (field, strain) = (by_field[normal] / pivot, by_strain[normal]);
            drpldt -= strain * field;
            by_field =
                std::array::from_fn(|a| if a == normal { 0.0 } else { by_field[a] - tangent[a][normal] * field });
            by_strain = std::array::from_fn(|b| if b == normal { 0.0 } else { by_strain[b] - strain * row[b] / pivot });
        }
        Heat { rpl, ddsddt: point.axes.stress(&by_field), drplde: point.axes.stress(&by_strain), drpldt }
    }

    /// Returns what growing compressive damage adds to the gradient of ψ_0 − ψ_NT.
    fn force_by_crushing(&self, concrete: &ConcreteProperties, point: &Point) -> [f64; 3] {
        let Some(damage) = &point.evolution.growth[1] else { return [0.0; 3] };
        let [without_cracks, with_cracks] = point.evolution.solid.degradable_energies(concrete);
        let by_damage = with_cracks - without_cracks;
        point.evolution.criteria.compression_gradient(concrete).map(|slope| by_damage * damage.rate * slope)
    }
}
