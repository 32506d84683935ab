//! What is thrown at a law: strains of 17 decades, zeros, subnormal numbers, repeated principal strains, full
//! damage, corners of the parameters, numbers that are none. Every answer must be finite and hold the law's
//! invariants; the tangent of ordinary parameter sets is compared with differences.
//!
//! `PULLOUT_STATES` is the number of states of each law and stress state (default 10 000). The long run:
//!
//! ```text
//! PULLOUT_STATES=1000000 cargo test --release -p models --lib stability -- --nocapture
//! ```

mod strain;
mod test;

use super::tangent::{directional_error, near_kink, one_sided_error};
use super::{Point, Random, STRESS_STATES, Sample};
use crate::damage_law::integrity;
use std::collections::BTreeMap;
use std::fmt;
use strain::Thrown;
use umat_abi::law::{Failure, Increment, Law, Request, Response, StressState, check_properties};

/// Increments of one history.
const LEGS: usize = 5;

/// One law (or one form of it) and what it promises.
pub struct Subject<'p> {
    /// Printed after the law's name.
    pub label: &'static str,
    /// Ordinary parameters: their tangents are compared with differences.
    pub samples: Vec<Sample<'p>>,
    /// Any admissible parameters and a characteristic length.
    pub corner: fn(&mut Random) -> (Vec<f64>, Option<f64>),
    /// States that never decrease; of them those named `eta…` are D/(1 − D).
    pub monotone: &'static [&'static str],
    /// Dissipation never decreases.
    pub dissipative: bool,
    /// The stress is a continuous function of the strain.
    pub continuous: bool,
    /// A committed strain met again gives the same stress.
    pub steady: bool,
}

/// What happened; printed as one row.
#[derive(Default)]
pub struct Ledger {
    states: usize,
    /// Parameter sets that the law refuses as inconsistent.
    sets_refused: usize,
    /// By reason: how often, and where first.
    cut_backs: BTreeMap<&'static str, (usize, String)>,
    /// Bad numbers on entry, all sent back.
    bad_numbers: usize,
    tangents: usize,
    /// Right on one side of a kink that they stand on.
    one_sided: usize,
    /// Tangents so small that differences of the stress do not resolve them to 1e-6: not compared further.
    unresolved: usize,
    /// Within the reach of the differences of a kink: not compared.
    kinks: usize,
    /// The same of strains that were not placed on kinks.
    generic_tangents: usize,
    generic_kinks: usize,
    worst_tangent: f64,
    /// Strains at or near repeated principal values whose stress was compared with that of a neighbour.
    repeated: usize,
    /// How often each invariant failed, and where first.
    violations: BTreeMap<&'static str, (usize, String)>,
}

impl Ledger {
    fn require(&mut self, invariant: &'static str, holds: bool, context: impl Fn() -> String) {
        if !holds {
            self.violations.entry(invariant).or_insert_with(|| (0, context())).0 += 1;
        }
    }
}

impl fmt::Display for Ledger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cut_backs: usize = self.cut_backs.values().map(|(count, _)| count).sum();
        write!(f, "{:>8} states | {cut_backs} cut back", self.states)?;
        for (reason, (count, context)) in &self.cut_backs {
            write!(f, " ({reason}: {count}, first {context})")?;
        }
        write!(f, " | {} sets refused | {} bad numbers refused", self.sets_refused, self.bad_numbers)?;
        write!(f, " | {} repeated strains", self.repeated)?;
        write!(
            f,
            " | {} tangents, {} one-sided, {} below rounding, {} excluded ({} of {} not placed on kinks), worst {:.1e}",
            self.tangents,
            self.one_sided,
            self.unresolved,
            self.kinks,
            self.generic_kinks,
            self.generic_tangents,
            self.worst_tangent
        )?;
        write!(f, " | {} violations", self.violations.values().map(|(count, _)| count).sum::<usize>())?;
        for (invariant, (count, context)) in &self.violations {
            write!(f, "\n    {invariant}: {count}, first {context}")?;
        }
        Ok(())
    }
}

/// States of each law and stress state.
fn states_wanted() -> usize {
    std::env::var("PULLOUT_STATES").map_or(10_000, |text| text.parse().expect("PULLOUT_STATES is a number"))
}

/// Runs all stress states and prints a row each; fails on a violation, on more than 5 % of tangents at kinks or below
/// rounding, or on more than one state in a thousand that is cut back.
pub fn check<L: Law>(subject: &Subject<'_>) {
    for stress_state in STRESS_STATES {
        let ledger = run::<L>(subject, stress_state, states_wanted());
        let name = format!("{} {}", L::INFO.name.to_string_lossy(), subject.label);
        println!("stability | {name:<32} | {:<25} | {ledger}", format!("{stress_state:?}"));
        assert!(ledger.violations.is_empty(), "{name} {stress_state:?}: {ledger}");
        assert!(
            ledger.generic_kinks * 20 <= ledger.generic_tangents,
            "{name} {stress_state:?}: too many kinks: {ledger}"
        );
        assert!(
            ledger.unresolved * 20 <= ledger.tangents,
            "{name} {stress_state:?}: too many below rounding: {ledger}"
        );
        assert!(
            ledger.cut_backs.values().map(|(count, _)| count).sum::<usize>() * 1000 <= ledger.states,
            "{name}: too many cut-backs"
        );
    }
}

fn run<L: Law>(subject: &Subject<'_>, stress_state: StressState, states: usize) -> Ledger {
    let mut random = Random(0x57AB_1117);
    let mut ledger = Ledger::default();
    while ledger.states < states {
        if random.unit() < 0.5 {
            let sample = subject.samples[(random.unit() * subject.samples.len() as f64) as usize];
            let history = History::<L>::new(subject, sample, stress_state, true).expect("ordinary parameters");
            history.run(&mut random, &mut ledger);
        } else {
            let (props, characteristic_length) = (subject.corner)(&mut random);
            let sample = Sample { props: &props, size: 3e-4, characteristic_length };
            match History::<L>::new(subject, sample, stress_state, false) {
                Some(history) => history.run(&mut random, &mut ledger),
                None => ledger.sets_refused += 1,
            }
        }
    }
    ledger
}

/// One point on its way through random increments.
struct History<'s, 'p, L: Law> {
    subject: &'s Subject<'p>,
    sample: Sample<'s>,
    point: Point<'s, L>,
    /// An ordinary parameter set.
    ordinary: bool,
    /// Largest strain so far.
    reach: f64,
}

impl<'s, 'p, L: Law> History<'s, 'p, L> {
    /// `None` if the law refuses the parameters (a law that needs the stress state to decide refuses later).
    fn new(subject: &'s Subject<'p>, sample: Sample<'s>, stress_state: StressState, ordinary: bool) -> Option<Self> {
        check_properties(&L::INFO, sample.props).expect("parameters within their bounds");
        let parameters = L::parameters(sample.props).ok()?;
        if let Some(length) = sample.characteristic_length {
            L::check_characteristic_length(&parameters, length).ok()?;
        }
        let point = Point {
            parameters,
            stress_state,
            strain: [0.0; 6],
            stress: [0.0; 6],
            state: vec![0.0; L::INFO.states.len()],
            characteristic_length: sample.characteristic_length,
        };
        Some(Self { subject, sample, point, ordinary, reach: 0.0 })
    }

    fn run(mut self, random: &mut Random, ledger: &mut Ledger) {
        for _ in 0..LEGS {
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

    fn update(&self, strain: &[f64; 6], request: Request) -> (Result<Response, Failure>, Vec<f64>) {
        let mut state = self.point.state.clone();
        let increment = Increment {
            stress_state: self.point.stress_state,
            strain: *strain,
            strain_increment: std::array::from_fn(|i| strain[i] - self.point.strain[i]),
            stress: self.point.stress,
            characteristic_length: self.point.characteristic_length,
        };
        (L::update(&self.point.parameters, &increment, &mut state, request), state)
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
        let refused = match self.update(&strain, Request::StressAndTangent).0 {
            Ok(response) => response.stress.iter().any(|x| !x.is_finite()),
            Err(Failure::CutBack { fraction, .. }) => fraction > 0.0 && fraction < 1.0,
            Err(Failure::Configuration(_)) => !self.ordinary,
        };
        ledger.bad_numbers += 1;
        ledger.require("NaN or infinity on entry is refused", refused, || self.context(&strain));
    }

    /// One increment, committed if it was answered. False if the parameters do not suit the stress state.
    fn step(&mut self, random: &mut Random, thrown: &Thrown, ledger: &mut Ledger) -> bool {
        let strain = &thrown.strain;
        let (outcome, state) = self.update(strain, Request::StressAndTangent);
        let response = match outcome {
            Ok(response) => response,
            Err(Failure::Configuration(_)) if !self.ordinary => return false,
            Err(Failure::Configuration(error)) => panic!("{error}: {}", self.context(strain)),
            Err(Failure::CutBack { fraction, reason }) => {
                ledger.states += 1;
                ledger.cut_backs.entry(reason).or_insert_with(|| (0, self.context(strain))).0 += 1;
                ledger.require("ordinary parameters are answered", !self.ordinary, || self.context(strain));
                ledger.require("0 < PNEWDT < 1", fraction > 0.0 && fraction < 1.0, || self.context(strain));
                return true;
            }
        };
        ledger.states += 1;
        self.invariants(strain, &response, &state, ledger);
        if let Some(neighbour) = &thrown.neighbour
            && self.ordinary
        {
            ledger.repeated += 1;
            self.continuity(strain, neighbour, &response, ledger);
        }
        self.reach = strain.iter().fold(self.reach, |m, x| m.max(x.abs()));
        if self.ordinary {
            self.tangent(random, thrown, ledger);
        }
        self.point.strain = *strain;
        self.point.stress = response.stress;
        self.point.state = state;
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
            ledger.require("stored energy is not negative", self.stored_energy_holds(strain, response), context);
        }
        for (k, variable) in L::INFO.states.iter().enumerate() {
            if self.subject.monotone.contains(&variable.name()) {
                ledger.require("damage, maxima, peeq never decrease", state[k] >= before[k], context);
                if variable.name().starts_with("eta") {
                    ledger.require("0 ≤ D < 1", state[k] >= 0.0 && integrity(state[k]) > 0.0, context);
                }
            }
        }
        let (again, state_again) = self.update(strain, Request::StressAndTangent);
        let same = again.is_ok_and(|again| {
            again.stress == response.stress
                && again.tangent == response.tangent
                && again.stored_energy == response.stored_energy
        });
        ledger.require("the same call gives the same answer", same && state_again == state, context);
        let (without, state_without) = self.update(strain, Request::Stress);
        let same = without.is_ok_and(|without| without.stress == response.stress);
        ledger.require("stress only is the same stress", same && state_without == state, context);
    }

    /// The thesis's energy of model III may be negative (models.md §5.1), no other.
    fn stored_energy_holds(&self, strain: &[f64; 6], response: &Response) -> bool {
        let size = strain.iter().fold(self.reach, |m, x| m.max(x.abs()));
        // one of a nearly fully damaged solid is known to the rounding of the undamaged one's
        let [e, nu] = [self.sample.props[0], self.sample.props[1]];
        let rounding = 1e-15 * e * size * size / (1.0 - 2.0 * nu);
        !self.subject.continuous || response.stored_energy >= -rounding
    }

    /// Between two neighbouring strains the stress may change by as much as the tangents at both allow, tenfold.
    fn continuity(&self, strain: &[f64; 6], neighbour: &[f64; 6], response: &Response, ledger: &mut Ledger) {
        let (Ok(other), _) = self.update(neighbour, Request::StressAndTangent) else {
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
        ledger.require("the stress is continuous at repeated strains", change <= allowed, || {
            format!("{change:e} > {allowed:e}: {} and {neighbour:?}", self.context(strain))
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
        ledger.tangents += 1;
        ledger.generic_tangents += usize::from(thrown.generic);
        if error <= 1e-6 {
            ledger.worst_tangent = ledger.worst_tangent.max(error);
        } else if error <= self.difference_resolution(strain) {
            ledger.unresolved += 1;
        } else if self.is_right_on_one_side(random, strain) {
            ledger.one_sided += 1;
        } else if near_kink(&self.point, strain, error) {
            ledger.kinks += 1;
            ledger.generic_kinks += usize::from(thrown.generic);
        } else {
            ledger.require("the tangent is the derivative", false, || format!("{error:e}: {}", self.context(strain)));
        }
    }

    /// What rounding leaves of the longest differences, relative to the tangent: the stress of a nearly fully damaged
    /// solid, and in plane stress that of one whose bulk modulus survives, is a difference of undamaged stresses, and σ33 = 0 is
    /// solved to some roundings of its terms (where its modulus falls below 1e-12 E, models.md §11 bounds that).
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
        let (Ok(still), state) = self.update(strain, Request::Stress) else {
            return ledger.require("a zero increment is answered", false, || self.context(strain));
        };
        let rounding = 1e-13 * self.sample.props[0] * self.reach / (1.0 - 2.0 * self.sample.props[1]);
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
