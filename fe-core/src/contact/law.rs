//! Tractions from gap and slip: the calls of UINTER and FRIC.

use super::history::{PointState, PointStatus};
use super::kinematics::Kinematics;
use super::normal::{HostNormal, NormalState};
use super::quadrature::ContactPoint;
use crate::assembly::Setback;
use crate::model::{ContactLaw, ContactPair, Enforcement, FieldValues, IncrementContext, ModelError, PluginLaw};
use umat_abi::host::recorder::{FricRecord, RecordedArguments, UinterRecord};
use umat_abi::host::{CallFailure, FricAnswer, FricCall, Plugin, SurfaceFields, UinterCall, Validation, judge};

/// Fraction of the increment to repeat with: a plugin that returned NaN or infinity may do better with a smaller one.
const FRACTION_AFTER_NAN: f64 = 0.25;
/// STRESS(1) is on the line ε_N · RDISP(1) within this relative error.
const ON_THE_LINE: f64 = 1e-9;

/// A point as a law sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Situation<'a> {
    pub gap: f64,
    pub slip: f64,
    pub point: &'a ContactPoint,
    /// Index of the point.
    pub index: usize,
    pub kinematics: &'a Kinematics,
    pub start: &'a PointState,
    pub start_statev: &'a [f64],
    pub context: &'a IncrementContext,
}

/// ∂(p, τ)/∂(penetration, slip), MPa/mm.
pub(super) type Tangent = [[f64; 2]; 2];

/// The law that gives the traction of a pair's points.
#[derive(Debug)]
pub(super) enum PointLaw {
    Uinter {
        call: Box<UinterCall>,
        /// ε_N of an augmented normal direction.
        augmented: Option<f64>,
    },
    Fric {
        call: Box<FricCall>,
        normal: HostNormal,
        /// ε_T where the plugin asks the host to stick, MPa/mm.
        sticking: f64,
    },
}

impl PointLaw {
    /// Makes a pair's law with its penalties, the initial temperature and field variables.
    ///
    /// # Errors
    /// The law refuses its parameters, cannot be called, or cannot be enforced as requested.
    pub fn new(pair: &ContactPair, penalty: f64, initial: &FieldValues) -> Result<Self, ModelError> {
        let ratio = match pair.enforcement {
            Enforcement::PerturbedLagrangian { ratio } => 1.0 + ratio,
            Enforcement::Penalty | Enforcement::Uzawa { .. } => 1.0,
        };
        let failed = |law: &PluginLaw, error| ModelError::of_pair(&pair.name, law.error(error));
        let mut made = match &pair.law {
            ContactLaw::Uinter(law) => {
                let (filled, normal) = filled(pair, law, Some(ratio * penalty), penalty)?;
                let needs = |reason: &str| Err(ModelError::of_pair(&pair.name, reason));
                let augmented = match (pair.enforcement, normal) {
                    (Enforcement::Penalty, _) | (Enforcement::PerturbedLagrangian { .. }, Some((_, true))) => None,
                    (Enforcement::Uzawa { .. }, Some((value, _))) if value > 0.0 => Some(value),
                    (Enforcement::Uzawa { .. }, _) => {
                        return needs("Uzawa updates of a UINTER need a parameter whose role is normal_penalty");
                    }
                    (Enforcement::PerturbedLagrangian { .. }, _) => {
                        return needs(
                            "a perturbed Lagrangian of a UINTER needs a parameter whose role is normal_penalty, left at 0 \
                             for the host to fill",
                        );
                    }
                };
                let mut call = filled.uinter(2).map_err(|error| failed(law, error))?;
                filled.probe_uinter(&mut call).map_err(|error| failed(law, error))?;
                Self::Uinter { call: Box::new(call), augmented }
            }
            ContactLaw::Fric { law, normal } => {
                let (filled, _) = filled(pair, law, None, penalty)?;
                let normal = HostNormal { law: *normal, stiffness: ratio * penalty };
                let mut call = filled.fric(1).map_err(|error| failed(law, error))?;
                filled.probe_fric(&mut call).map_err(|error| failed(law, error))?;
                Self::Fric { call: Box::new(call), normal, sticking: penalty }
            }
        };
        made.set_fields(initial, initial);
        Ok(made)
    }

    /// Passes temperature and field variables at the start and at the end of the increment to the law.
    pub fn set_fields(&mut self, start: &FieldValues, end: &FieldValues) {
        let fields: &mut SurfaceFields = match self {
            Self::Uinter { call, .. } => &mut call.fields,
            Self::Fric { call, .. } => &mut call.fields,
        };
        fields.set([start.temperature, end.temperature], [&start.variables, &end.variables]);
    }

    /// The traction at the end of an increment, with the point's law state: `end` and `statev` hold it afterwards.
    ///
    /// # Errors
    /// The plugin wants a smaller increment, wrote where it must not, or returned NaN or infinity.
    pub fn advance(
        &mut self,
        situation: &Situation<'_>,
        end: &mut PointState,
        statev: &mut [f64],
    ) -> Result<Tangent, Setback> {
        let result = match self {
            Self::Uinter { call, augmented } => uinter(call, *augmented, situation, end, statev),
            Self::Fric { call, normal, sticking } => fric(call, normal, *sticking, situation, end, statev),
        };
        result.map_err(|Setback { reason, fraction }| {
            let reason = format!("plugin '{}': {reason}", self.plugin());
            Setback { reason, fraction }
        })
    }

    fn plugin(&self) -> &str {
        match self {
            Self::Uinter { call, .. } => call.plugin(),
            Self::Fric { call, .. } => call.plugin(),
        }
    }

    /// Returns what users should know of how the plugin is called.
    pub fn remark(&self) -> Option<String> {
        let why = match self {
            Self::Uinter { call, .. } => call.why_wide(),
            Self::Fric { call, .. } => call.why_wide(),
        };
        why.map(|reason| format!("{} is called with two slip directions: {reason}", self.plugin()))
    }

    /// Calls of the plugin so far.
    pub fn calls(&self) -> u64 {
        match self {
            Self::Uinter { call, .. } => call.calls(),
            Self::Fric { call, .. } => call.calls(),
        }
    }

    /// The last call of the plugin, if it was for this point, from its state at the start.
    pub fn last_call(&self, point: usize, start: &PointState, statev: &[f64]) -> Option<RecordedArguments> {
        let number = i32::try_from(point + 1).ok().filter(|_| self.calls() > 0);
        let statev = statev.to_vec();
        match self {
            Self::Uinter { call, .. } if Some(call.node) == number => Some(RecordedArguments::Uinter(UinterRecord {
                stress: vec![start.pressure, start.shear],
                statev,
                energies: start.plugin_energies.to_vec(),
                flags: start.flags.map(f64::from).to_vec(),
                ..UinterRecord::of(call)
            })),
            Self::Fric { call, .. } if Some(call.node) == number => Some(RecordedArguments::Fric(FricRecord {
                lm: vec![start.stick.into()],
                tau: vec![start.shear],
                statev,
                energies: start.plugin_energies[..2].to_vec(),
                ..FricRecord::of(call)
            })),
            _ => None,
        }
    }
}

/// The law with penalties by role in place of zeros; with it the value of its normal penalty, and whether the host
/// filled it. A tangential one only where the law refuses its 0: others derive it from their own stiffness.
fn filled(
    pair: &ContactPair,
    law: &PluginLaw,
    normal_penalty: Option<f64>,
    tangential_penalty: f64,
) -> Result<(Plugin, Option<(f64, bool)>), ModelError> {
    let mut filled = law.plugin.clone();
    let Some(description) = &law.law else { return Ok((filled, None)) };
    let normal = normal_penalty.and_then(|penalty| {
        let k = description.role("normal_penalty").filter(|k| *k < law.props.len())?;
        let is_empty = law.props[k] == 0.0;
        Some((if is_empty { penalty } else { law.props[k] }, is_empty))
    });
    filled.props = description.with_penalties(&law.props, normal_penalty, tangential_penalty);
    match description.validate(&filled.props, None) {
        // a characteristic length it gets at each call
        Validation::Valid | Validation::NeedsCharacteristicLength(_) => Ok((filled, normal)),
        Validation::Invalid(message) => {
            Err(ModelError::of_pair(&pair.name, format!("{}: {message}", description.name)))
        }
    }
}

fn failed(failure: CallFailure) -> Setback {
    Setback { reason: failure.to_string(), fraction: failure.fraction(FRACTION_AFTER_NAN) }
}

/// Step and total time at the end of the increment.
fn end_times(context: &IncrementContext) -> [f64; 2] {
    [context.step_time, context.total_time].map(|time| time + context.dtime())
}

fn counter(number: u32) -> i32 {
    i32::try_from(number).unwrap_or(i32::MAX)
}

/// Number of a point, from 1.
fn number_of(index: usize) -> i32 {
    i32::try_from(index + 1).unwrap_or(i32::MAX)
}

fn uinter(
    call: &mut UinterCall,
    augmented: Option<f64>,
    situation: &Situation<'_>,
    end: &mut PointState,
    statev: &mut [f64],
) -> Result<Tangent, Setback> {
    let Situation { start, context, .. } = *situation;
    let shift = |state: &NormalState| augmented.map_or(0.0, |penalty| state.multiplier / penalty);
    let penetration = shift(&end.normal) - situation.gap;
    call.rdisp = [penetration, situation.slip, 0.0];
    call.drdisp = [penetration - (shift(&start.normal) - start.gap), situation.slip - start.slip, 0.0];
    call.stress_mut().copy_from_slice(&[start.pressure, start.shear]);
    call.statev_mut().copy_from_slice(situation.start_statev);
    call.energies = start.plugin_energies;
    call.flags = start.flags;
    call.time = end_times(context);
    call.dtime = context.dtime();
    call.area = situation.point.area;
    call.chrlngth = situation.point.edge_length;
    let Kinematics { position: [x, y], normal: [n_1, n_2], tangent: [t_1, t_2], .. } = *situation.kinematics;
    call.coords = [x, y, 0.0];
    call.local_directions = [n_1, n_2, 0.0, t_1, t_2, 0.0, 0.0, 0.0, 1.0];
    call.counters = [context.step, context.increment, context.iteration].map(counter);
    call.node = number_of(situation.index);
    let outcome = call.call();
    judge(outcome, call.not_finite().or_else(|| call.moduli_not_finite())).map_err(failed)?;
    [end.pressure, end.shear] = [call.stress()[0], call.stress()[1]];
    statev.copy_from_slice(call.statev());
    (end.plugin_energies, end.flags) = (call.energies, call.flags);
    let tangent = [0, 1].map(|row| [0, 1].map(|column| call.tangent(row, column)));
    let dissipated = |energies: &[f64; 5]| energies[1..].iter().sum::<f64>();
    end.status = if end.pressure == 0.0 && end.shear == 0.0 && penetration < 0.0 {
        PointStatus::Open
    } else if dissipated(&end.plugin_energies) > dissipated(&start.plugin_energies) {
        PointStatus::Slipping
    } else {
        PointStatus::Sticking
    };
    end.held = augmented.is_some_and(|penalty| is_held(penalty, situation.gap, end));
    Ok(tangent)
}

/// Returns whether a UINTER's answer is that of a hard, bonded, closed point: p = ε_N · RDISP(1).
fn is_held(penalty: f64, gap: f64, end: &PointState) -> bool {
    let elastic = end.normal.multiplier - penalty * gap;
    let scale = end.normal.multiplier.abs().max((penalty * gap).abs()).max(end.pressure.abs());
    end.status != PointStatus::Open && (end.pressure - elastic).abs() <= ON_THE_LINE * scale
}

fn fric(
    call: &mut FricCall,
    law: &HostNormal,
    sticking: f64,
    situation: &Situation<'_>,
    end: &mut PointState,
    statev: &mut [f64],
) -> Result<Tangent, Setback> {
    let Situation { start, context, .. } = *situation;
    let normal = law.advance(-situation.gap, &NormalState { opening: start.normal.opening, ..end.normal });
    end.pressure = normal.pressure;
    end.normal.opening = normal.opening;
    end.normal_energy = normal.stored_energy;
    end.held = normal.held;
    end.plugin_energies = start.plugin_energies;
    if !normal.closed {
        statev.copy_from_slice(situation.start_statev);
        (end.shear, end.status) = (0.0, PointStatus::Open);
        // surfaces that touch without pressing are not open to FRIC
        end.stick = if situation.gap > 0.0 { FricCall::OPEN } else { start.stick };
        return Ok([[normal.stiffness, 0.0], [0.0, 0.0]]);
    }
    let slip_increment = situation.slip - start.slip;
    call.lm = start.stick;
    call.dgam = [slip_increment, 0.0];
    call.slip = [start.inelastic_slip, 0.0];
    call.pressure = [normal.pressure, normal.pressure - start.pressure];
    call.stress_mut()[0] = start.shear;
    call.statev_mut().copy_from_slice(situation.start_statev);
    call.energies = [start.plugin_energies[0], start.plugin_energies[1]];
    call.time = end_times(context);
    call.dtime = context.dtime();
    call.coords = [situation.kinematics.position[0], situation.kinematics.position[1], 0.0];
    call.rcoord = [situation.kinematics.foot[0], situation.kinematics.foot[1], 0.0];
    call.chrlngth = situation.point.edge_length;
    call.counters = [context.step, context.increment].map(counter);
    call.node = number_of(situation.index);
    let outcome = call.call();
    judge(outcome, call.not_finite().or_else(|| call.moduli_not_finite())).map_err(failed)?;
    statev.copy_from_slice(call.statev());
    end.plugin_energies[..2].copy_from_slice(&call.energies);
    (end.stick, end.inelastic_slip) = (call.next_lm(), start.inelastic_slip);
    let answer = call.answer().map_err(|reason| Setback { reason, fraction: None })?;
    let (by_slip, by_pressure) = match answer {
        FricAnswer::Tractions => {
            end.shear = call.stress()[0];
            end.inelastic_slip = start.inelastic_slip + call.dslip[0];
            (call.tangent(0, 0), call.pressure_tangent[0])
        }
        FricAnswer::Sticks => {
            end.shear = start.shear + sticking * slip_increment;
            (sticking, 0.0)
        }
        FricAnswer::NoShear => {
            end.shear = 0.0;
            (0.0, 0.0)
        }
    };
    end.status = if end.stick == FricCall::STICKING { PointStatus::Sticking } else { PointStatus::Slipping };
    Ok([[normal.stiffness, 0.0], [by_pressure * normal.stiffness, by_slip]])
}
