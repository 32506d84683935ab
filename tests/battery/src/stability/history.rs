//! One point on its way through what is thrown at it.

use super::TestedLaw;
use super::ledger::{Ledger, TANGENT};
use super::strain::Thrown;
use crate::differences::{directional_error, near_kink, one_sided_error};
use crate::{Point, Random, Sample};
use models::damage_law::integrity;
use models::tensor::work;
use umat_abi::law::{Failure, Law, Request, Response, StressState, check_properties, parameters_of};

/// Increments of one history.
const LEGS: usize = 5;
/// Allowed distance of a tangent from differences of the stress, relative to its largest entry.
const TANGENT_ERROR: f64 = 1e-6;

const ANSWERED: &str = "ordinary parameters are answered";

/// One point on its way through random increments.
pub(super) struct History<'s, 'p, L: Law> {
    subject: &'s TestedLaw<'p>,
    sample: Sample<'s>,
    point: Point<'s, L>,
    /// An ordinary parameter set.
    ordinary: bool,
    /// Largest strain so far.
    reach: f64,
}

impl<'s, 'p, L: Law> History<'s, 'p, L> {
    /// `None` if the law refuses the parameters (a law that needs the stress state to decide refuses later).
    pub fn new(
        subject: &'s TestedLaw<'p>,
        sample: Sample<'s>,
        stress_state: StressState,
        ordinary: bool,
    ) -> Option<Self> {
        check_properties(&L::INFO, sample.props).expect("parameters within their bounds");
        let parameters = parameters_of::<L>(sample.props).ok()?;
        if let Some(length) = sample.characteristic_length {
            L::check_characteristic_length(&parameters, Some(length)).ok()?;
        }
        let point = Point {
            parameters,
            stress_state,
            strain: [0.0; 6],
            stress: [0.0; 6],
            state: vec![0.0; L::INFO.states.len()],
            characteristic_length: sample.characteristic_length,
            time_increment: 1.0,
            temperature: 0.0,
        };
        Some(Self { subject, sample, point, ordinary, reach: 0.0 })
    }

    pub fn run(mut self, random: &mut Random, ledger: &mut Ledger) {
        for _ in 0..LEGS {
            if L::COUPLED {
                // a phase field, which grows to 1
                self.point.temperature += random.unit().powi(3) * (1.0 - self.point.temperature);
            }
            let thrown = Thrown::random(random, self.point.stress_state, &self.point.strain, self.sample.size);
            if random.unit() < 0.02 {
                self.bad_number(random, &thrown.strain, ledger);
            }
            if !self.step(random, &thrown, ledger) {
                ledger.sets_refused += 1;
                return;
            }
        }
    }

    fn context(&self, strain: &[f64; 6]) -> String {
        format!(
            "{:?} {:?} {:?}: {strain:?} from {:?}, {:?}",
            self.sample.props,
            self.sample.characteristic_length,
            self.point.stress_state,
            self.point.strain,
            self.point.state
        )
    }

    /// NaN or infinity must not end as a finite stress (the boundary sends back what is not finite).
    fn bad_number(&self, random: &mut Random, strain: &[f64; 6], ledger: &mut Ledger) {
        let components = self.point.stress_state.components();
        let mut strain = *strain;
        strain[components[(random.unit() * components.len() as f64) as usize]] =
            [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][(random.unit() * 3.0) as usize];
        let refused = match self.point.respond(&strain, Request::StressAndTangent).0 {
            Ok(response) => response.stress.iter().any(|x| !x.is_finite()),
            Err(Failure::CutBack { fraction, .. }) => fraction > 0.0 && fraction < 1.0,
            Err(Failure::Configuration(_)) => !self.ordinary,
        };
        ledger.require("NaN or infinity on entry is refused", refused, || self.context(&strain));
    }

    /// One increment, committed if it was answered. False if the parameters do not suit the stress state.
    fn step(&mut self, random: &mut Random, thrown: &Thrown, ledger: &mut Ledger) -> bool {
        let strain = &thrown.strain;
        let (outcome, state) = self.point.respond(strain, Request::StressAndTangent);
        let response = match outcome {
            Ok(response) => response,
            Err(Failure::Configuration(_)) if !self.ordinary => return false,
            Err(Failure::Configuration(error)) => panic!("{error}: {}", self.context(strain)),
            Err(Failure::CutBack { fraction, reason }) => {
                ledger.states += 1;
                ledger.cut_backs.entry(reason).or_insert_with(|| (0, self.context(strain))).0 += 1;
                if self.ordinary {
                    ledger.require(ANSWERED, false, || self.context(strain));
                }
                ledger.digest(&[fraction]);
                ledger.require("0 < PNEWDT < 1", fraction > 0.0 && fraction < 1.0, || self.context(strain));
                return true;
            }
        };
        ledger.states += 1;
        ledger.digest(&response.stress);
        ledger.digest(response.tangent.as_flattened());
        ledger.digest(&state);
        if self.ordinary {
            ledger.require(ANSWERED, true, String::new);
        }
        self.invariants(strain, &response, &state, ledger);
        if let Some(neighbour) = &thrown.neighbour
            && self.ordinary
        {
            self.continuity(strain, neighbour, &response, ledger);
        }
        self.reach = strain.iter().fold(self.reach, |m, x| m.max(x.abs()));
        if self.ordinary {
            self.tangent(random, thrown, ledger);
        }
        self.point.commit(strain, &response, state);
        if self.ordinary && self.subject.steady {
            self.zero_increment(&response, ledger);
        }
        true
    }

    fn invariants(&self, strain: &[f64; 6], response: &Response, state: &[f64], ledger: &mut Ledger) {
        let context = || format!("{}: {response:?} {state:?}", self.context(strain));
        let before = &self.point.state;
        let last = state.len() - 1;
        let energies = [response.stored_energy, response.dissipated_energy];
        let mut numbers = response.stress.iter().chain(response.tangent.as_flattened()).chain(&energies).chain(state);
        ledger.require("every number is finite", numbers.all(|x| x.is_finite()), context);
        ledger.require("dissipation is also a state", response.dissipated_energy == state[last], context);
        if self.subject.dissipative {
            ledger.require("dissipation never decreases", state[last] >= before[last], context);
            if self.subject.continuous {
                let negative = (-response.stored_energy).max(0.0);
                ledger.within("the stored energy is not negative", negative, self.energy_rounding(strain), context);
            }
        }
        if self.subject.quadratic && self.ordinary {
            let error = (0.5 * work(&response.stress, strain) - response.stored_energy).abs();
            let allowed = 1e-12 * response.stored_energy.abs() + self.energy_rounding(strain);
            ledger.within("the stored energy is half of stress : strain", error, allowed, context);
        }
        for (k, variable) in L::INFO.states.iter().enumerate() {
            if self.subject.monotone.contains(&variable.name()) {
                ledger.require("damage, maxima, peeq never decrease", state[k] >= before[k], context);
                if variable.name().starts_with("eta") {
                    ledger.require("0 ≤ D < 1", state[k] >= 0.0 && integrity(state[k]) > 0.0, context);
                }
            }
        }
        let (again, state_again) = self.point.respond(strain, Request::StressAndTangent);
        let same = again.is_ok_and(|again| {
            again.stress == response.stress
                && again.tangent == response.tangent
                && again.stored_energy == response.stored_energy
        });
        ledger.require("the same call gives the same answer", same && state_again == state, context);
        let (without, state_without) = self.point.respond(strain, Request::Stress);
        let same = without.is_ok_and(|without| without.stress == response.stress);
        ledger.require("stress only is the same stress", same && state_without == state, context);
    }

    /// The stored energy of a nearly fully damaged solid is known to the rounding of the undamaged one's.
    fn energy_rounding(&self, strain: &[f64; 6]) -> f64 {
        let size = strain.iter().fold(self.reach, |m, x| m.max(x.abs()));
        let [e, nu] = [self.sample.props[0], self.sample.props[1]];
        1e-15 * e * size * size / (1.0 - 2.0 * nu)
    }

    /// Between two neighbouring strains the stress may change by as much as the tangents at both allow, tenfold.
    fn continuity(&self, strain: &[f64; 6], neighbour: &[f64; 6], response: &Response, ledger: &mut Ledger) {
        let (Ok(other), _) = self.point.respond(neighbour, Request::StressAndTangent) else {
            return ledger.require("repeated strains are answered", false, || self.context(neighbour));
        };
        if !self.subject.continuous {
            return;
        }
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let difference = |a: &[f64; 6], b: &[f64; 6]| largest(&std::array::from_fn::<f64, 6, _>(|i| a[i] - b[i]));
        let tangent = largest(response.tangent.as_flattened()).max(largest(other.tangent.as_flattened()));
        let rounding =
            1e-13 * self.sample.props[0] * largest(strain).max(self.reach) / (1.0 - 2.0 * self.sample.props[1]);
        let change = difference(&response.stress, &other.stress);
        let allowed = 10.0 * tangent * difference(strain, neighbour) + rounding;
        ledger.within("the stress is continuous at repeated strains", change, allowed, || {
            format!("{} and {neighbour:?}", self.context(strain))
        });
    }

    /// The tangent along a random direction against differences, where the stress is resolved: not at strains far
    /// below those of the history, whose stress is a difference of large numbers.
    fn tangent(&self, random: &mut Random, thrown: &Thrown, ledger: &mut Ledger) {
        let strain = &thrown.strain;
        let size = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if size < 1e-2 * self.reach || size < 1e-30 {
            return;
        }
        let direction = random.strain(self.point.stress_state, 1.0);
        let error = directional_error(&self.point, strain, &[direction]);
        ledger.generic_tangents[0] += u64::from(thrown.generic);
        if error <= TANGENT_ERROR {
            ledger.within(TANGENT, error, TANGENT_ERROR, String::new);
        } else if error <= self.difference_resolution(strain) {
            ledger.unresolved += 1;
            ledger.exclude(TANGENT);
        } else if self.is_right_on_one_side(random, strain) {
            ledger.one_sided += 1;
            ledger.require(TANGENT, true, String::new);
        } else if near_kink(&self.point, strain, error) {
            ledger.generic_tangents[1] += u64::from(thrown.generic);
            ledger.exclude(TANGENT);
        } else {
            ledger.within(TANGENT, error, TANGENT_ERROR, || self.context(strain));
        }
    }

    /// Returns the rounding error of the longest differences, relative to the tangent: the stress of a nearly fully
    /// damaged solid, and in plane stress that of one whose bulk modulus survives, is a difference of undamaged
    /// stresses, and σ33 = 0 is solved to some roundings of its terms (`drucker_prager` bounds its modulus from below
    /// by 1e-12 E).
    fn difference_resolution(&self, strain: &[f64; 6]) -> f64 {
        let tangent = self.point.trial(strain).0.tangent;
        let scale = tangent.as_flattened().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let [e, nu] = [self.sample.props[0], self.sample.props[1]];
        let size = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        16.0 * f64::EPSILON * e / (1.0 - 2.0 * nu) * self.reach / (1e-4 * size * scale)
    }

    /// On a kink the tangent is the one-sided derivative in a sector of directions; where tension and compression
    /// both begin to grow there are four sectors, so that a few directions are tried.
    fn is_right_on_one_side(&self, random: &mut Random, strain: &[f64; 6]) -> bool {
        (0..8).any(|_| {
            let direction = random.strain(self.point.stress_state, 1.0);
            one_sided_error(&self.point, strain, &direction) <= 1e-5
        })
    }

    /// A committed strain met again changes nothing.
    fn zero_increment(&self, response: &Response, ledger: &mut Ledger) {
        let strain = &self.point.strain;
        let (Ok(still), state) = self.point.respond(strain, Request::Stress) else {
            return ledger.require("a zero increment is answered", false, || self.context(strain));
        };
        // subnormal strains are no more than rounding
        let resolution = 1e-13 * self.reach + f64::MIN_POSITIVE;
        let rounding = self.sample.props[0] * resolution / (1.0 - 2.0 * self.sample.props[1]);
        // η next to its threshold is known to the rounding of Y, hence D and not η
        let same = |name: &str, a: f64, b: f64| {
            (a - b).abs() <= 1e-12 * b.abs() + if name.starts_with("eta") { 1e-12 } else { 0.0 }
        };
        let unchanged = (0..6).all(|i| (still.stress[i] - response.stress[i]).abs() <= rounding)
            && L::INFO.states.iter().enumerate().all(|(k, variable)| {
                !self.subject.monotone.contains(&variable.name())
                    || same(variable.name(), state[k], self.point.state[k])
            });
        ledger.require("a zero increment changes nothing", unchanged, || format!("{still:?} {}", self.context(strain)));
    }
}
