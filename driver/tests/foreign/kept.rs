//! A library built with the header of version 1 as it first was: `tests/umats/kept_v1`, which is never changed.

use super::{built, close, point, run};
use crate::program::Desk;
use serde_json::json;

#[test]
fn a_library_of_the_first_header_is_read_checked_and_run() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "kept_v1/kept.c", &[]) else { return };
    let path = library.as_str().expect("a path");
    let told = desk.pullout(["plugin", "info", path]).expect(0).stdout;
    for words in ["kept", "1.0", "Isotropic linear elasticity of a kept library.", "Young's modulus", "greatest_strain"]
    {
        assert!(told.contains(words), "'{words}' is not in\n{told}");
    }
    let checked = desk.pullout(["plugin", "check", path, "--states", "60"]);
    assert_eq!(checked.code, 0, "{}{}", checked.stdout, checked.stderr);

    let (young, poisson) = (20e3, 0.25);
    let to = |e11: f64, g12: f64| json!({ "e11": e11, "e22": 0.0, "e33": 0.0, "g12": g12, "g13": 0.0, "g23": 0.0 });
    let steps = json!([{ "increments": 3, "target": to(1e-3, 8e-4) }, { "increments": 2, "target": to(0.0, 0.0) }]);
    let material = json!({ "plugin": library, "props": { "E": young, "nu": poisson } });
    let done = run(&desk, "kept", &point(material, "3d", steps));
    let (shear, lambda) =
        (young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
    close(done.history.column("s11")[3], (2.0 * shear + lambda) * 1e-3);
    close(done.history.column("s22")[3], lambda * 1e-3);
    close(done.history.column("s12")[3], shear * 8e-4);
    close(done.history.last("greatest_strain"), (1e-6_f64 + 2.0 * 4e-4 * 4e-4).sqrt());

    let refused = json!({ "plugin": library, "props": { "E": young, "nu": 0.7 } });
    let case =
        desk.case("refused.json", &point(refused, "3d", json!([{ "increments": 1, "target": { "e11": 1e-3 } }])));
    let outcome = desk.pullout(["check", case.to_str().expect("UTF-8")]).expect(2);
    assert!(outcome.stderr.contains("nu"), "{}", outcome.stderr);
}
