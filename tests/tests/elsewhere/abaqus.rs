//! `pullout plugin info --abaqus`: constants and state variables in the order of the metadata.

use super::{Installation, example};
use end_to_end_tests::{run, shipped_laws};
use umat_abi::host::LawDescription;

fn generated(installation: &Installation, law: &str) -> String {
    let output = run(installation.program().args(["plugin", "info", "--abaqus", law]));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The data lines below a keyword line, to the next keyword.
fn data(text: &str, keyword: &str) -> Vec<f64> {
    let lines = text.lines().skip_while(|line| !line.starts_with(keyword)).skip(1);
    let lines = lines.take_while(|line| line.starts_with("**") || !line.starts_with('*'));
    let words = lines.filter(|line| !line.starts_with('*')).flat_map(|line| line.split(','));
    words.map(str::trim).filter(|word| !word.is_empty()).map(|word| word.parse().expect("a number")).collect()
}

/// The number after `name=` in a keyword line.
fn parameter(text: &str, keyword: &str, name: &str) -> usize {
    let line = text.lines().find(|line| line.starts_with(keyword)).expect("the keyword");
    let (_, value) = line.split_once(&format!("{name}=")).expect("the parameter");
    value.split(',').next().expect("a value").parse().expect("a number")
}

/// The defaults in the order of the metadata; a group that may be absent is absent.
fn defaults(law: &LawDescription) -> Vec<f64> {
    let absent = law.group.as_ref().filter(|group| group.minimum == 0).map_or(0, |group| group.size);
    law.parameters[..law.parameters.len() - absent].iter().map(|parameter| parameter.default_value).collect()
}

#[test]
fn constants_are_in_order() {
    let Some(installation) = Installation::find() else { return };
    for name in &shipped_laws() {
        let text = generated(&installation, name);
        let library = end_to_end_tests::open(&installation.library(name));
        let law = &library.laws()[0];
        let expected = defaults(law);
        if name == "bond_slip" {
            // the first value is the out-of-plane thickness
            let keyword = "*SURFACE INTERACTION, NAME=BOND_SLIP, USER";
            assert_eq!(data(&text, keyword), [&[1.0], &expected[..]].concat());
            for keyword in [keyword, "*FRICTION, USER"] {
                assert_eq!(parameter(&text, keyword, "PROPERTIES"), expected.len());
                assert_eq!(parameter(&text, keyword, "DEPVAR"), law.states.len());
            }
            assert_eq!(data(&text, "*FRICTION, USER"), expected);
        } else {
            assert_eq!(data(&text, "*USER MATERIAL"), expected, "{name}");
            assert_eq!(parameter(&text, "*USER MATERIAL", "CONSTANTS"), expected.len(), "{name}");
            assert_eq!(data(&text, "*DEPVAR"), [law.states.len() as f64], "{name}");
            assert!(text.contains(&format!("*MATERIAL, NAME={}\n", name.to_uppercase())));
        }
        for line in text.lines() {
            // ABAQUS: 8 values a line, 256 characters
            assert!(line.len() <= 256 && (line.starts_with('*') || line.split(',').count() <= 9), "{name}: {line}");
        }
    }
}

#[test]
fn the_shipped_input_files_are_current() {
    let Some(installation) = Installation::find() else { return };
    for law in &shipped_laws() {
        let file = example("abaqus").join(format!("{law}.inp"));
        let shipped = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert_eq!(shipped, generated(&installation, law), "pullout plugin info --abaqus {law} > {}", file.display());
    }
}

#[test]
fn a_library_without_metadata_is_refused() {
    let Some(installation) = Installation::find() else { return };
    let plain = installation.library("pullout_utilities");
    let output = installation.program().args(["plugin", "info", "--abaqus"]).arg(plain).output().expect("it starts");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("has no metadata"));
}
