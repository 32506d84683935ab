//! Verdicts of `pullout plugin check` on them.

use super::{PublishedLaw, cases};
use crate::check::row;
use crate::program::{Desk, Outcome};
use serde_json::{Value, json};

/// A check, the word its row begins with, and words of it.
type Row = (&'static str, &'static str, &'static str);

const CONSISTENT: Row = ("consistent tangent", "pass", "consistent");

/// The report on a library along its case.
fn checked(desk: &Desk, library: &Value, case: &Value, code: i32) -> Outcome {
    let case = desk.case("case.json", case);
    let outcome =
        desk.pullout(["plugin", "check", library.as_str().expect("a path"), "--case", case.to_str().expect("UTF-8")]);
    println!("{}", outcome.stdout);
    outcome.expect(code)
}

#[track_caller]
fn assert_row(outcome: &Outcome, (check, verdict, words): Row) {
    let row = row(outcome, check);
    assert!(row.starts_with(verdict) && row.contains(words), "{verdict} … {words} expected: {row}");
}

/// The sound variant passes, with this row; the planted error fails, in that one.
fn judged(law: &PublishedLaw, sound: Row, planted: Row) {
    let desk = Desk::new();
    let Some(library) = law.built(&desk, &[]) else { return };
    assert_row(&checked(&desk, &library, &(law.case)(library.clone()), 0), sound);
    let Some(library) = law.built(&desk, &["--flag=-DPLANTED"]) else { return };
    assert_row(&checked(&desk, &library, &(law.case)(library.clone()), 1), planted);
}

#[test]
fn a_shear_strain_taken_for_the_tensors_is_reported() {
    let desk = Desk::new();
    let Some(library) = cases::MAZARS.built(&desk, &["--flag=-DTENSOR_SHEAR"]) else { return };
    let outcome = checked(&desk, &library, &(cases::MAZARS.case)(library.clone()), 0);
    assert_row(&outcome, ("isotropy", "warn", "isotropic while it is elastic and not beyond"));
}

/// Along these steps nothing happens that could be judged.
fn untested(law: &PublishedLaw, steps: Value) {
    let desk = Desk::new();
    let Some(library) = law.built(&desk, &[]) else { return };
    let mut case = (law.case)(library.clone());
    case["steps"] = steps;
    let outcome = checked(&desk, &library, &case, 4);
    assert!(outcome.stdout.contains("not tested"), "{}", outcome.stdout);
}

/// Steps with one target.
fn towards(target: Value) -> Value {
    json!([{ "increments": 5, "target": target }])
}

/// Name of a test, law, row of the sound variant, row of the planted one.
macro_rules! verdicts {
    ($($name:ident: $law:ident, $sound:expr, $planted:expr;)*) => {
        $(#[test]
        fn $name() {
            judged(&cases::$law, $sound, $planted);
        })*
    };
}

verdicts! {
    the_rate_of_an_arterys_tangent: HGO, CONSISTENT, ("consistent tangent", "FAIL", "");
    a_crystals_time_increment: CRYSTAL, CONSISTENT, ("consistent tangent", "FAIL", "");
    a_maxwell_bodys_time_increment: PRONY, CONSISTENT, ("consistent tangent", "FAIL", "");
    a_modulus_of_the_wrong_temperature: THERMAL, CONSISTENT, ("consistent tangent", "FAIL", "");
    a_clay_that_remembers_its_last_call: CAM_CLAY, CONSISTENT, ("order of calls", "FAIL", "hidden memory");
    the_interval_of_a_table: READ_TABLE, CONSISTENT, ("consistent tangent", "FAIL", "");
    shears_of_a_secant: MAZARS, ("consistent tangent", "warn", "secant-like"), ("consistent tangent", "FAIL", "");
    a_plys_denominator: HASHIN, CONSISTENT, ("consistent tangent", "FAIL", "");
    an_iteration_that_starts_from_the_last: ARMSTRONG_FREDERICK,
        ("data between calls", "warn", "COMMON /KRETRN/"), ("order of calls", "FAIL", "hidden memory");
    frictions_answer_to_pressure: FRICTION, CONSISTENT, ("consistent tangent", "FAIL", "");
    slip_and_opening_uncoupled: COHESIVE, CONSISTENT, ("consistent tangent", "FAIL", "");
}

#[test]
fn what_stays_elastic_is_not_tested() {
    // below the yield surface clay is nonlinear, and comes back
    untested(&cases::CAM_CLAY, towards(json!({ "e11": -1e-4, "e22": 0.0, "e33": 0.0 })));
    untested(&cases::READ_TABLE, towards(json!({ "e11": 1e-4 })));
    untested(&cases::MAZARS, towards(json!({ "e11": 1e-5 })));
    untested(&cases::HASHIN, towards(json!({ "e11": 0.0, "e22": 1e-4, "g12": 0.0 })));
    untested(&cases::ARMSTRONG_FREDERICK, towards(json!({ "e11": 1e-4 })));
    // far from sliding, also where the pressure of a sampled state is small
    untested(&cases::FRICTION, towards(json!({ "slip": 1e-4, "p": 10.0 })));
    untested(&cases::COHESIVE, towards(json!({ "slip": 1e-3, "gap": 1e-3 })));
}
