//! OOFEM, simcoon and Kratos run our libraries: their results are ours.

use super::{Installation, example, history, numbers};
use end_to_end_tests::{named_by, run};
use std::path::Path;
use std::process::Command;

/// Stresses of two programs, relative to the largest; strains relative to the largest strain.
const STRESSES: f64 = 1e-8;
/// Displacements of two programs on one mesh, relative to the largest: both are in equilibrium to 1e-10 or better, and
/// 0.3 % of a damage threshold moves nodes by 1.6e-6.
const DISPLACEMENTS: f64 = 1e-8;

/// A law with parameters and what is done to it.
struct Job {
    law: &'static str,
    props: &'static [f64],
    nstatv: usize,
    /// Increments, and the strain at their end.
    targets: &'static [(usize, f64)],
}

/// Damage in both senses, set out so that OOFEM converges: crushed almost to the peak, released, then cracked until a
/// tenth of the tensile strength is left. (One brick of eight points that soften in compression has more than one
/// solution.)
const CONCRETE: Job = Job {
    law: "concrete_damage",
    props: &[31800.0, 0.18, 5000.0, 1.3, 0.000_190_507_7, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0],
    nstatv: 13,
    targets: &[(12, -1.1e-3), (11, 0.0), (20, 4e-4)],
};
/// The law of [`CONCRETE`] crushed beyond the peak, after it cracked.
const CRUSHED: Job = Job { targets: &[(10, 4e-4), (40, -3e-3), (10, -1e-3)], ..CONCRETE };
/// Plasticity that turns round twice.
const STEEL: Job = Job {
    law: "j2_plasticity",
    props: &[210_000.0, 0.3, 347.0, 0.0, 400.0, 0.02, 450.0, 0.1],
    nstatv: 9,
    targets: &[(20, 0.02), (40, -0.02), (40, 0.03)],
};

impl Job {
    /// Returns its arguments for the Python programs.
    fn arguments(&self, installation: &Installation) -> Vec<String> {
        self.arguments_with(&installation.library(self.law))
    }

    /// Returns the arguments with another library.
    fn arguments_with(&self, library: &Path) -> Vec<String> {
        let mut words = vec![library.display().to_string(), self.law.to_owned()];
        words.extend([self.nstatv.to_string(), "--props".to_owned()]);
        words.extend(self.props.iter().map(|value| format!("{value:?}")));
        words.push("--targets".to_owned());
        // a leading minus sign comes after the colon
        words.extend(self.targets.iter().map(|(count, value)| format!("{count}:{value:?}")));
        words
    }

    fn increments(&self) -> usize {
        self.targets.iter().map(|(count, _)| count).sum()
    }

    /// Our driver's rows, after the initial one: a component to the targets, no stress elsewhere.
    fn expected(&self, installation: &Installation, component: &str, folder: &Path, columns: &[&str]) -> Vec<Vec<f64>> {
        self.expected_along(installation, &[(component, 1.0)], folder, columns)
    }

    /// Returns our driver's rows with several components, each to its share of the targets.
    fn expected_along(
        &self,
        installation: &Installation,
        shares: &[(&str, f64)],
        folder: &Path,
        columns: &[&str],
    ) -> Vec<Vec<f64>> {
        let steps = self.targets.iter().map(|(count, value)| {
            let target: Vec<_> =
                shares.iter().map(|(name, share)| format!(r#""{name}": {:?}"#, share * value)).collect();
            format!(r#"{{"increments": {count}, "target": {{{}}}}}"#, target.join(", "))
        });
        self.history(installation, &steps.collect::<Vec<_>>().join(", "), folder, columns)
    }

    /// Returns our driver's rows along given strains.
    fn expected_at(
        &self,
        installation: &Installation,
        strains: &[Vec<f64>],
        folder: &Path,
        columns: &[&str],
    ) -> Vec<Vec<f64>> {
        let mut table = "e11,e22,e33,g12,g13,g23\n".to_owned();
        for row in strains {
            table += &row[..6].iter().map(|value| format!("{value:e}")).collect::<Vec<_>>().join(",");
            table.push('\n');
        }
        std::fs::write(folder.join("strains.csv"), table).expect("a file");
        self.history(installation, r#"{"table": "strains.csv"}"#, folder, columns)
    }

    /// Our driver's rows of such steps, after the initial one.
    fn history(&self, installation: &Installation, steps: &str, folder: &Path, columns: &[&str]) -> Vec<Vec<f64>> {
        let case = format!(
            r#"{{"kind": "point", "title": "{0}", "mode": "3d", "material": {{"plugin": "{0}", "props": {1:?}}}, "steps": [{2}]}}"#,
            self.law, self.props, steps
        );
        let file = folder.join("case.json");
        std::fs::write(&file, case).expect("a file");
        let out = folder.join("result");
        installation.run_case(&file, &[], &out);
        let rows = history(&out, columns);
        assert_eq!(rows.len(), self.increments() + 1, "{}: as many rows as increments", self.law);
        rows[1..].to_vec()
    }
}

/// A script by the Python with the clients.
fn script_command(script: &str, arguments: &[String]) -> Option<Command> {
    let mut command = Command::new(named_by("PULLOUT_PYTHON")?);
    command.arg("-B").arg(example(script)).args(arguments);
    Some(command)
}

/// Returns the numbers that a script prints as its result.
fn python(script: &str, arguments: &[String]) -> Option<Vec<Vec<f64>>> {
    let output = run(&mut script_command(script, arguments)?);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let (_, result) = text.rsplit_once("RESULT\n").unwrap_or_else(|| panic!("{script}: no result:\n{text}"));
    Some(numbers(result.as_bytes()))
}

/// The largest difference of a column over its largest value.
fn apart(found: &[Vec<f64>], expected: &[Vec<f64>], columns: std::ops::Range<usize>) -> f64 {
    let largest =
        |rows: &mut dyn Iterator<Item = f64>| rows.fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
    let pairs = || found.iter().zip(expected).flat_map(|(a, b)| columns.clone().map(move |k| (a[k], b[k])));
    let scale = largest(&mut pairs().map(|(_, b)| b.abs()));
    assert!(scale > 0.0);
    let difference = pairs().map(|(a, b)| (a - b).abs()).collect::<Vec<_>>();
    assert!(difference.iter().all(|d| d.is_finite()), "not finite");
    largest(&mut difference.into_iter()) / scale
}

#[test]
fn one_element_in_oofem_has_our_stresses() {
    const POINTS: usize = 8;
    for job in [CONCRETE, STEEL] {
        let Some(installation) = Installation::find() else { return };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let Some(found) = python("oofem/one_element.py", &job.arguments(&installation)) else { return };
        let expected = job.expected(&installation, "e11", folder.path(), &["e11", "e22", "s11"]);
        assert_eq!(found.len(), POINTS * expected.len(), "{}", job.law);
        let expected: Vec<_> = expected.into_iter().flat_map(|row| vec![row; POINTS]).collect();
        let [strains, stresses] = [0..2, 2..3].map(|columns| apart(&found, &expected, columns));
        println!("OOFEM, one element, {}: strains {strains:.1e}, stresses {stresses:.1e} apart", job.law);
        assert!(strains <= STRESSES && stresses <= STRESSES, "{}: {strains:e}, {stresses:e}", job.law);
    }
}

/// 5000 triangles, for our quadrilaterals have B-bar, and OOFEM's have not.
#[test]
fn a_plane_strain_job_in_oofem_has_our_displacements() {
    let concrete = Job {
        props: &[31800.0, 0.18, 5000.0, 1.3, 0.000_190_507_7, 32.25788, 1.2, 3e-4, 0.10988, 0.0, 0.0, 0.0, 0.0, 0.0],
        targets: &[(6, -0.03)],
        ..CONCRETE
    };
    let steel = Job { targets: &[(6, -0.6)], ..STEEL };
    for job in [concrete, steel] {
        let Some(installation) = Installation::find() else { return };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().join("block");
        let (increments, press) = job.targets[0];
        let overrides = [
            format!(r#"parts.beam.material={{"plugin": "{}", "props": {:?}}}"#, job.law, job.props),
            format!("steps.0.increments={increments}"),
            format!("steps.0.drives.press={press:?}"),
        ];
        installation.run_case(&example("oofem/block.json"), &overrides, &out);
        let rows = history(&out, &["damaged_points", "yielding_points", "cutbacks"]);
        assert_eq!(rows.len(), increments + 1);
        // not an elastic job, and the same increments in both programs
        let last = &rows[increments];
        assert!(last[0] + last[1] > 1000.0 && last[2] == 0.0, "{}: {last:?}", job.law);

        let mut arguments = vec![out.join("fields/000001.vtu").display().to_string()];
        arguments.extend(job.arguments(&installation));
        if job.law == STEEL.law {
            arguments.push("--full-newton".to_owned());
        }
        let Some(found) = python("oofem/block.py", &arguments) else { return };
        let [nodes, elements, largest, difference] = found[0][..] else { panic!("{found:?}") };
        assert_eq!([nodes, elements], [2601.0, 5000.0]);
        assert!(largest >= press.abs(), "{largest}");
        println!("OOFEM, 5000 elements, {}: displacements {:.1e} apart", job.law, difference / largest);
        assert!(difference <= DISPLACEMENTS * largest, "{}: {difference:e} of {largest}", job.law);
    }
}

#[test]
fn a_point_in_simcoon_has_our_stresses() {
    const COLUMNS: [&str; 12] = ["e11", "e22", "e33", "g12", "g13", "g23", "s11", "s22", "s33", "s12", "s13", "s23"];
    let sheared = Job { targets: &[(10, 2e-4), (20, -4e-4)], ..CONCRETE };
    for (job, component, direction) in [
        (CONCRETE, "e11", "1 0 0 0 0 0"),
        (CRUSHED, "e11", "1 0 0 0 0 0"),
        (sheared, "g12", "0 0 0 1 0 0"),
        (STEEL, "e11", "1 0 0 0 0 0"),
        (STEEL, "g13", "0 0 0 0 1 0"),
    ] {
        let Some(installation) = Installation::find() else { return };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut arguments = job.arguments(&installation);
        arguments.push("--direction".to_owned());
        arguments.extend(direction.split(' ').map(str::to_owned));
        let Some(found) = python("simcoon/material_point.py", &arguments) else { return };
        let expected = job.expected(&installation, component, folder.path(), &COLUMNS);
        assert_eq!(found.len(), expected.len(), "{} {component}", job.law);
        let [strains, stresses] = [0..6, 6..12].map(|columns| apart(&found, &expected, columns));
        println!("simcoon, {} {component}: strains {strains:.1e}, stresses {stresses:.1e} apart", job.law);
        assert!(strains <= STRESSES && stresses <= STRESSES, "{} {component}: {strains:e} {stresses:e}", job.law);
    }
}

/// OOFEM itself warns and goes on, with exit code 0; NaN passes for converged.
#[test]
fn an_oofem_job_without_equilibrium_fails() {
    let without_length = Job {
        props: &[31800.0, 0.18, 5000.0, 1.3, 0.000_190_507_7, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.1, 0.0],
        ..CONCRETE
    };
    for (job, iterations) in [(CONCRETE, "2"), (without_length, "50")] {
        let Some(installation) = Installation::find() else { return };
        let mut arguments = job.arguments(&installation);
        arguments.extend(["--iterations", iterations].map(str::to_owned));
        let Some(mut command) = script_command("oofem/one_element.py", &arguments) else { return };
        let output = command.output().expect("Python starts");
        let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.code(), Some(1), "{text}{errors}");
        assert!(errors.contains("OOFEM finds no equilibrium") && !text.contains("RESULT"), "{errors}");
    }
}

/// Tension and crushing with shear, free in one direction: the shear is one of the two that Kratos orders otherwise.
#[test]
fn one_element_in_kratos_has_our_stresses() {
    const COLUMNS: [&str; 12] = ["e11", "e22", "e33", "g12", "g13", "g23", "s11", "s22", "s33", "s12", "s13", "s23"];
    const POINTS: usize = 8;
    const SAME: f64 = 1e-10;
    const SHEAR: f64 = 0.8;
    let sheared = Job { targets: &[(8, 3e-4), (12, -1e-3)], ..CONCRETE };
    let yielding = Job { targets: &[(10, 0.01), (20, -0.01)], ..STEEL };
    for job in [sheared, yielding] {
        let Some(installation) = Installation::find() else { return };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file_name = umat_abi::host::library_file_name(job.law);
        let library = installation.prefix.join("lib/pullout/kratos").join(file_name);
        let mut arguments = job.arguments_with(&library);
        arguments.extend(["--shear".to_owned(), SHEAR.to_string()]);
        let Some(found) = python("kratos/one_element.py", &arguments) else { return };
        let shares = [("e11", 1.0), ("g13", SHEAR), ("e33", 0.0)];
        let expected = job.expected_along(&installation, &shares, folder.path(), &COLUMNS);
        let expected: Vec<_> = expected.into_iter().flat_map(|row| vec![row; POINTS]).collect();
        assert_eq!(found.len(), expected.len(), "{}", job.law);
        let [strains, stresses] = [0..6, 6..12].map(|columns| apart(&found, &expected, columns));
        // both are in equilibrium as well as each of them asks for; along the same strains there is no such question
        let first: Vec<_> = found.iter().step_by(POINTS).cloned().collect();
        let along = job.expected_at(&installation, &first, folder.path(), &COLUMNS);
        let same_strains = apart(&first, &along, 6..12);
        println!(
            "Kratos, {}: strains {strains:.1e}, stresses {stresses:.1e}, along the same strains {same_strains:.1e} apart",
            job.law
        );
        assert!(strains <= STRESSES && stresses <= STRESSES, "{}: {strains:e} {stresses:e}", job.law);
        assert!(same_strains <= SAME, "{}: {same_strains:e}", job.law);
    }
}
