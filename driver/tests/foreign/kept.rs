//! The rules of the interface (docs/reference/abi.md), by what was built with the header of version 1 as it first was:
//! `tests/umats/kept_v1`, which is never changed.

use super::{built, close, point, run};
use crate::program::Desk;
use end_to_end_tests::{Tool, find, plugin, run as compile, shipped_laws, workspace};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn a_library_of_the_first_header_is_read_checked_and_run() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "kept_v1/kept.c", &[]) else { return };
    let path = library.as_str().expect("a path");
    let printed = desk.pullout(["plugin", "info", path]).expect(0).stdout;
    for words in ["kept", "1.0", "Isotropic linear elasticity of a kept library.", "Young's modulus", "greatest_strain"]
    {
        assert!(printed.contains(words), "'{words}' is not in\n{printed}");
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

/// Structures that grow at their end are read by their size, and unknown flags are ignored.
#[test]
fn a_library_of_a_later_header_is_read() {
    let desk = Desk::new();
    let Some(mut compiler) = find(Tool::C) else { return };
    let kept = std::fs::read_to_string(workspace("tests/umats/kept_v1/kept.c")).expect("the source");
    let mut later = kept.clone();
    for (now, then) in [
        (
            "static const pullout_parameter parameters[2]",
            "static const struct grown { pullout_parameter kept; double more[3]; } parameters[2]",
        ),
        ("{parameters, 2, sizeof(pullout_parameter)}", "{&parameters[0].kept, 2, sizeof(struct grown)}"),
        (
            "static const pullout_plugin description = {",
            "static const struct { pullout_plugin kept; double more[2]; } description = {{",
        ),
        (".struct_size = sizeof(pullout_plugin)", ".struct_size = sizeof(pullout_plugin) + 16"),
        ("PULLOUT_FLAG_ISOTROPIC,", "PULLOUT_FLAG_ISOTROPIC | 0x40000000u,"),
        (".validate = validate,\n};", ".validate = validate,\n}, {1.0, 2.0}};"),
        ("return &description;", "return &description.kept;"),
    ] {
        assert!(later.contains(now), "{now}");
        later = later.replace(now, then);
    }
    let (source, library) = (desk.write("later.c", &later), desk.path("liblater.so"));
    let include = workspace("tests/umats/kept_v1");
    compile(
        compiler.args(["-shared", "-fPIC", "-O1", "-I"]).arg(include).arg("-o").arg(&library).arg(source).arg("-lm"),
    );
    let path = library.to_str().expect("a path");
    let printed = desk.pullout(["plugin", "info", path]).expect(0).stdout;
    assert!(printed.contains("Young's modulus") && printed.contains("Poisson's ratio"), "{printed}");
    let material = json!({ "plugin": library, "props": { "E": 20e3, "nu": 0.25 } });
    let steps = json!([{ "increments": 1, "target": { "e11": 1e-3, "e22": 0.0, "e33": 0.0 } }]);
    let done = run(&desk, "later", &point(material, "3d", steps));
    close(done.history.last("s11"), 24.0);
}

/// The host of `tests/umats/kept_v1`; `None`, after a notice, without a compiler.
fn host(desk: &Desk) -> Option<PathBuf> {
    let mut compiler = find(Tool::C)?;
    let (source, host) = (workspace("tests/umats/kept_v1/host.c"), desk.path("host"));
    compile(compiler.arg("-O1").arg("-o").arg(&host).arg(source).arg("-ldl"));
    Some(host)
}

fn answer(host: &Path, arguments: &[&str]) -> String {
    let output = Command::new(host).args(arguments).output().expect("the host starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn a_host_of_the_first_header_calls_the_laws_of_today() {
    let desk = Desk::new();
    let Some(host) = host(&desk) else { return };
    let printed = answer(&host, &[plugin("linear_elastic").to_str().expect("a path"), "20000", "0.25"]);
    let numbers = |word: &str| -> Vec<Vec<f64>> {
        let lines = printed.lines().filter_map(|line| line.strip_prefix(word));
        lines.map(|line| line.split_whitespace().map(|number| number.parse().expect("a number")).collect()).collect()
    };
    // λ = μ = 8000: σ11 = 3 λ ε11, σ22 = σ33 = λ ε11, σ12 = μ γ12
    let stresses = numbers("stress ");
    for (stress, expected) in stresses.iter().zip([2.4, 0.8, 0.8, 1.6, 0.0, 0.0]) {
        stress.iter().for_each(|found| close(*found, expected));
        assert_eq!(stress[0], stress[1], "a batch and a call");
    }
    assert_eq!(stresses.len(), 6);
    close(numbers("tangent ")[0][0], 24e3);
    assert_eq!(numbers("status ")[0], [0.0]);
}

/// Parameters with their defaults, and states, of a law.
type Contract = (Vec<(String, f64)>, Vec<String>);

/// Names of parameters, in order, and of states, by law.
fn contracts(printed: &str) -> BTreeMap<String, Contract> {
    let mut contracts: BTreeMap<String, Contract> = BTreeMap::new();
    let mut law = String::new();
    for line in printed.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["law", name] => law = name.to_owned(),
            ["parameter", name, default] => {
                let default = default.parse().expect("a number");
                contracts.entry(law.clone()).or_default().0.push((name.to_owned(), default));
            }
            ["state", name] => contracts.entry(law.clone()).or_default().1.push(name.to_owned()),
            _ => panic!("{line}"),
        }
    }
    contracts
}

/// New parameters come at the end with a default; a law with other states has another name.
#[test]
fn parameters_and_states_of_the_laws_are_those_of_the_first_release() {
    let desk = Desk::new();
    let Some(host) = host(&desk) else { return };
    let kept = std::fs::read_to_string(workspace("tests/umats/kept_v1/laws.txt")).expect("the list");
    let today: String =
        shipped_laws().iter().map(|law| answer(&host, &[plugin(law).to_str().expect("a path")])).collect();
    let today = contracts(&today);
    for (law, (parameters, states)) in contracts(&kept) {
        let (now, states_now) = today.get(&law).unwrap_or_else(|| panic!("{law} is gone"));
        // one after the other, or before the group that repeats
        let same = |now: &[(String, f64)], then: &[(String, f64)]| {
            now.iter().map(|(name, _)| name).eq(then.iter().map(|(name, _)| name))
        };
        let added = now.len().checked_sub(parameters.len()).unwrap_or_else(|| panic!("{law}: {now:?}"));
        let place = (0..=parameters.len()).rev().find(|&place| {
            same(&now[..place], &parameters[..place]) && same(&now[place + added..], &parameters[place..])
        });
        let place = place.unwrap_or_else(|| panic!("{law}: {now:?}"));
        assert!(now[place..place + added].iter().all(|(_, default)| default.is_finite()), "{law}: {now:?}");
        assert_eq!(states_now, &states, "{law}");
    }
}
