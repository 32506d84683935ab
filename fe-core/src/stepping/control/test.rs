//! Which increments may stand.

use super::judgement::repeat;
use super::*;
use crate::model::{PluginLaw, StepControl};
use crate::stepping::test::strip;

/// An increment that the drives lead may unload: a step may ask for it. Under another lead it would run the step backwards.
#[test]
fn a_lead_that_unloads_elastically_is_refused_until_the_run_fails() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-6 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    let end = Committed { drives: vec![0.01], ..Committed::default() };
    let converged = Converged { end, iterations: Vec::new() };
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let unloads = Findings { load: 10.0, gives_back: true, ..Findings::default() };
    let fails = Findings { gives_back: false, ..unloads };
    assert!(run.judge(&converged, load, unloads).is_ok());
    for by in [Leader::PointSlip, Leader::Dissipation] {
        run.lead = Lead::Other(Led::new(by, 0.1));
        run.progress = 0.25;
        assert!(run.judge(&converged, load, fails).is_ok());
        let judgement = run.judge(&converged, load, unloads).expect_err("elastic");
        assert!(judgement.has_failed && judgement.trouble.reason.contains("unloads elastically"));
        // however small
        let attempts = (0..1000).find(|_| run.reject(&judgement.trouble, true) == Advance::Failed);
        assert!(attempts.is_some());
        assert!(run.judge(&converged, load, unloads).is_err());
    }
}

/// Viscosity takes the snap-back of solids, but contact has none: a fibre that leaves its hole snaps.
#[test]
fn with_stabilisation_slip_leads_where_the_drives_fail_again_and_again() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-9 };
    let mut model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    model.controls.relaxation_time = 1e-6;
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    (run.follows_slip, run.usual_slip, run.usual_dissipation) = (true, 0.01, 1.0);
    let trouble = repeat("no equilibrium", 0.25).trouble;
    for _ in 1..FAILURES_BEFORE_CHANGE {
        assert_eq!(run.reject(&trouble, true), Advance::Repeated);
        assert_eq!(run.lead, Lead::Drives);
    }
    assert_eq!(run.reject(&trouble, true), Advance::Repeated);
    assert!(matches!(run.lead, Lead::Other(Led { by: Leader::PointSlip, .. })));
}
