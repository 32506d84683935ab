//! A C and a Fortran program that link a plugin by the shipped header and module compute what our host computes.

use end_to_end_tests::{LAWS, Sample, Tool, difference, find, plugin, plugin_folder, run, strain_path, workspace};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use umat_abi::host::{UmatCall, library_file_name};
use umat_abi::law::{Request, StressState};

/// The numbers pass through text with 17 digits: nothing is lost.
const TEXT: f64 = 1e-14;

/// Returns the input of the programs.
fn input(law: &Sample, stress_state: StressState, path: &[[f64; 6]]) -> String {
    let (ntens, ndi, nshr) = stress_state.counts();
    let mut text = format!("{ntens} {ndi} {nshr} {} {}\n", law.states, law.props.len());
    let line = |values: &[f64]| values.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(" ") + "\n";
    text += &line(law.props);
    let _ = writeln!(text, "{}", path.len());
    for increment in path {
        text += &line(&increment[..ntens as usize]);
    }
    text
}

/// Runs a program on such an input and returns what it printed.
fn feed(command: &mut Command, input: &str) -> std::process::Output {
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let mut stdin = child.stdin.take().expect("a pipe");
    let text = input.to_owned();
    // In a thread: the program prints while it still reads.
    let writer = std::thread::spawn(move || stdin.write_all(text.as_bytes()));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("no panic").expect("the program reads all its input");
    assert!(output.status.success(), "{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr));
    output
}

/// The stresses that our host computes along the path.
fn expected(law: &Sample, stress_state: StressState, path: &[[f64; 6]]) -> Vec<Vec<f64>> {
    let library = end_to_end_tests::open(&plugin(law.name));
    let mut call = UmatCall::new(&library, None, law.name, stress_state, law.states, law.props).expect("umat_");
    let stress = |increment: &[f64; 6]| {
        call.dstran = *increment;
        call.call(Request::StressAndTangent).expect("no overrun");
        for k in 0..6 {
            call.stran[k] += increment[k];
        }
        call.stress().to_vec()
    };
    path.iter().map(stress).collect()
}

/// Links the plugin, found again at run time where Cargo built it.
fn link(compiler: &mut Command, law: &str) {
    let folder = plugin_folder();
    compiler
        .arg("-L")
        .arg(&folder)
        .arg(format!("-l:{}", library_file_name(law)))
        .arg(format!("-Wl,-rpath,{}", folder.display()));
}

fn c_client(law: &str, folder: &Path) -> Option<PathBuf> {
    let mut compiler = find(Tool::C)?;
    let program = folder.join("client");
    compiler
        .args(["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror", &format!("-DLAW={law}"), "-I"])
        .arg(workspace("umat-abi/include"))
        .arg("-o")
        .arg(&program)
        .arg(workspace("tests/clients/client.c"));
    link(&mut compiler, law);
    run(&mut compiler);
    Some(program)
}

fn fortran_client(law: &str, folder: &Path) -> Option<PathBuf> {
    let mut compiler = find(Tool::Fortran)?;
    let program = folder.join("client");
    compiler
        .current_dir(folder)
        .args(["-std=f2008", "-O2", "-Wall", "-cpp", &format!("-DLAW_UMAT={law}_umat"), "-o"])
        .arg(&program)
        .arg(workspace("umat-abi/fortran/pullout_umat.f90"))
        .arg(workspace("tests/clients/client.f90"));
    link(&mut compiler, law);
    run(&mut compiler);
    Some(program)
}

/// The stresses among printed lines: those that consist of numbers.
fn stresses(output: &[u8]) -> Vec<Vec<f64>> {
    let text = String::from_utf8_lossy(output);
    let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>();
    text.lines().filter_map(numbers).collect()
}

fn check_stresses(law: &Sample, client: &Path) {
    for stress_state in Sample::STRESS_STATES {
        let (ntens, _, _) = stress_state.counts();
        let path = strain_path(42, ntens as usize, law.strain, 30);
        let output = feed(&mut Command::new(client), &input(law, stress_state, &path));
        let found = stresses(&output.stdout);
        let expected = expected(law, stress_state, &path);
        assert_eq!(found.len(), expected.len(), "{}: one line an increment", law.name);
        let apart = difference(&found.concat(), &expected.concat());
        assert!(apart <= TEXT, "{}, {stress_state:?}: {apart:e} apart", law.name);
    }
}

#[test]
fn a_c_program_computes_what_our_host_computes() {
    for law in LAWS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let Some(client) = c_client(law.name, folder.path()) else { return };
        check_stresses(law, &client);
    }
}

#[test]
fn a_fortran_program_computes_what_our_host_computes() {
    for law in LAWS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let Some(client) = fortran_client(law.name, folder.path()) else { return };
        check_stresses(law, &client);
    }
}

#[test]
fn a_c_program_reads_the_description() {
    for law in LAWS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let Some(client) = c_client(law.name, folder.path()) else { return };
        let output = feed(&mut Command::new(&client), &input(law, StressState::ThreeD, &[]));
        let library = end_to_end_tests::open(&plugin(law.name));
        let described = &library.laws()[0];
        let names: Vec<_> = described.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let expected = format!("{} {} {}", law.name, described.states.len(), names.join(" "));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[..2], [expected.as_str(), "valid 0"]);
        let given = law.props.len() - 1;
        let message = format!("one fewer 1 {given} properties given, ");
        assert!(lines[2].starts_with(&message), "{}", lines[2]);
    }
}

/// The stresses of linear_elastic and j2_plasticity that `two_laws.c` and `batch.f90` ask for.
fn stresses_of_two_laws() -> [Vec<f64>; 2] {
    let strain = [4e-3, -1e-3, -5e-4, 1e-3, 2e-3, 3e-3];
    let stress = |name: &str, states: usize, props: &[f64]| {
        let library = end_to_end_tests::open(&plugin(name));
        let mut call = UmatCall::new(&library, None, name, StressState::ThreeD, states, props).expect("umat_");
        call.dstran = strain;
        call.call(Request::StressAndTangent).expect("no overrun");
        call.stress().to_vec()
    };
    [stress("linear_elastic", 2, &[210e3, 0.3]), stress("j2_plasticity", 9, &[210e3, 0.3, 347.0, 0.0, 400.0, 0.1])]
}

/// The numbers of each line of an output; other lines are left out.
fn lines_of_numbers(output: &std::process::Output) -> Vec<Vec<f64>> {
    let line = |line: &str| line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>();
    String::from_utf8_lossy(&output.stdout).lines().filter_map(line).collect()
}

#[test]
fn two_laws_in_one_c_program_are_distinguished_by_name() {
    for library in [&["linear_elastic", "j2_plasticity"][..], &["pullout_laws"]] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let program = folder.path().join("two_laws");
        let Some(mut compiler) = find(Tool::C) else { return };
        compiler.args(["-std=c89", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I"]);
        compiler.arg(workspace("umat-abi/include")).arg("-o").arg(&program).arg(workspace("tests/clients/two_laws.c"));
        library.iter().for_each(|library| link(&mut compiler, library));
        run(&mut compiler);
        let output = run(&mut Command::new(&program));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(text.lines().next(), Some("linear_elastic j2_plasticity"));
        let found = lines_of_numbers(&output);
        for (law, expected) in stresses_of_two_laws().iter().enumerate() {
            let [batch, single, kratos] = &found[3 * law..3 * law + 3] else { panic!("{text}") };
            assert_eq!(batch[6..], [0.0, 0.0], "{text}");
            assert!(difference(&batch[..6], expected) <= TEXT && difference(single, expected) <= TEXT, "{text}");
            assert!(difference(kratos, expected) <= TEXT, "{text}");
        }
    }
}

#[test]
fn a_fortran_program_calls_batches_of_two_laws() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("batch");
    let Some(mut compiler) = find(Tool::Fortran) else { return };
    compiler.current_dir(folder.path()).args(["-std=f2008", "-Wall", "-Wextra", "-pedantic", "-Werror", "-o"]);
    compiler
        .arg(&program)
        .arg(workspace("umat-abi/fortran/pullout_umat.f90"))
        .arg(workspace("tests/clients/batch.f90"));
    for law in ["linear_elastic", "j2_plasticity"] {
        link(&mut compiler, law);
    }
    run(&mut compiler);
    let found = lines_of_numbers(&run(&mut Command::new(&program)));
    for (found, expected) in found.iter().zip(stresses_of_two_laws()) {
        assert!(difference(&found[..6], &expected) <= TEXT && found[6..] == [0.0, 0.0], "{found:?}");
    }
    assert_eq!(found.len(), 2);
}

/// A thousand increments allocate no more often than ten, in the plugin or anywhere else, and touch no memory that is
/// not theirs.
#[test]
fn calls_from_c_allocate_nothing() {
    for law in LAWS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let Some(client) = c_client(law.name, folder.path()) else { return };
        let allocations = |increments| {
            let path = strain_path(42, 6, law.strain, increments);
            let mut valgrind = find(Tool::Valgrind)?;
            let command = valgrind.args(["--error-exitcode=9", "--leak-check=no"]).arg(&client);
            let output = feed(command, &input(law, StressState::ThreeD, &path));
            assert_eq!(stresses(&output.stdout).len(), increments);
            Some(total_allocations(&String::from_utf8_lossy(&output.stderr)))
        };
        let Some(few) = allocations(10) else { return };
        assert_eq!(allocations(1000), Some(few), "{}", law.name);
    }
}

/// The number in valgrind's `total heap usage: 12 allocs, …`.
fn total_allocations(report: &str) -> u64 {
    let (_, rest) = report.split_once("total heap usage: ").unwrap_or_else(|| panic!("no heap summary:\n{report}"));
    let (count, _) = rest.split_once(" allocs").expect("the form of valgrind's summary");
    count.replace(',', "").parse().expect("a number")
}
