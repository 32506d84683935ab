//! Examples of the README and of the book's tutorials work as printed: their files are written, their commands run. pullout
//! drives the UMATs of other languages in `tests/umats/` as well as the plugin of the same law.

use crate::program::{self, Desk, Run, Table};
use end_to_end_tests::{Tool, find, run, workspace, worst};
use serde_json::json;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A page of the tree.
fn page(name: &str) -> String {
    std::fs::read_to_string(workspace(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The fenced blocks of a language, in order.
fn blocks(name: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    page(name).split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap_or_default().to_owned()).collect()
}

/// Pages with blocks: the README's and the book's.
fn pages() -> Vec<String> {
    let root = workspace("");
    let mut found = vec![root.join("README.md"), root.join("CONTRIBUTING.md"), root.join("python/README.md")];
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            if path.is_dir() && !name.starts_with(['_', '.']) {
                folders.push(path);
            } else if name.ends_with(".md") {
                found.push(path);
            }
        }
    }
    let name = |path: PathBuf| path.strip_prefix(&root).expect("below it").to_string_lossy().into_owned();
    found.into_iter().map(name).collect()
}

/// Code block of a page.
struct CodeBlock<'a> {
    /// The line before it.
    before: &'a str,
    language: &'a str,
    content: String,
}

/// All blocks of a page, with fences of any length.
fn fenced(text: &str) -> Vec<CodeBlock<'_>> {
    let (mut found, mut before, mut lines) = (Vec::new(), "", text.lines());
    while let Some(line) = lines.next() {
        let line = line.trim_start();
        let language = line.trim_start_matches('`');
        let fence = &line[..line.len() - language.len()];
        if fence.len() >= 3 {
            let content: Vec<&str> = lines.by_ref().take_while(|line| line.trim() != fence).collect();
            found.push(CodeBlock { before, language, content: content.join("\n") });
        }
        if !line.is_empty() {
            before = line;
        }
    }
    found
}

/// Whether the program knows the options of a line, and the cases that it names are there; what other programs do on other lines,
/// CI does itself.
fn is_known(line: &str) -> bool {
    let line = line.split(" #").next().unwrap_or_default();
    let Some((_, arguments)) = line.split_once("pullout ").or_else(|| line.split_once("--release -- ")) else {
        return true;
    };
    let words: Vec<&str> = arguments.split_whitespace().take_while(|word| *word != ">").collect();
    let is_there = |case: &&str| workspace(case).exists() || case.contains('*');
    let mut asked = program::command();
    // help replaces the command, but errors come first
    let known = asked.args(&words).arg("--help").stdout(Stdio::null()).status();
    words.iter().filter(|word| word.starts_with("cases/")).all(is_there) && known.is_ok_and(|status| status.success())
}

/// Blocks that nothing runs, by page and beginning: dolfinx is no package that CI has, and there is no such law.
const NOT_RUN: [(&str, &str); 2] =
    [("docs/notebooks/dolfinx.md", "from fenics_constitutive"), ("docs/working/adding.md", "umat_abi::export_umat!(")];

/// Cells are run where the book is built.
#[test]
fn no_block_of_the_book_is_left_out() {
    let (here, in_python) = (include_str!("book.rs"), page("python/tests/test_book.py"));
    for name in pages() {
        let is_followed = here.contains(&format!("follow(\"{name}\")"));
        let is_run_by_python = in_python.contains(&format!("{name}\""));
        for CodeBlock { before, language, content } in fenced(&page(&name)) {
            let is_tried = match language {
                "" | "text" | "formula" | "markdown" => true,
                "sh" if before == "<!-- run -->" => is_followed,
                "sh" => content.lines().all(is_known),
                "python" => is_run_by_python,
                _ if language.starts_with('{') => true,
                _ if before.starts_with("<!-- file: ") => is_followed || is_run_by_python,
                _ => false,
            };
            let is_compared = here.contains(&format!("blocks(\"{name}\", \"{language}\")"));
            let is_not_run =
                NOT_RUN.iter().any(|(page, begin)| *page == name && content.trim_start().starts_with(begin));
            assert!(is_tried || is_compared || is_not_run, "{name} ({before}):\n{content}");
        }
    }
}

/// The specimen that the book shows can be meshed.
#[test]
fn the_specimen_of_several_fibres_is_one() {
    let specimen = &blocks("docs/using/specimens.md", "json")[0];
    let case = workspace("cases/chapter-7/two-fibres.json");
    let checked =
        Desk::new().pullout(["check", &case.to_string_lossy(), "--set", &format!("mesh.specimen={specimen}")]);
    checked.expect(0);
}

/// Action that a tutorial asks of its reader.
enum Action {
    /// A file of this name and content.
    Write(String, String),
    /// A file of the tree, copied next to the others.
    Copy(String),
    /// A script.
    Run(String),
}

/// The actions of a page: comments `file: NAME` and `run` stand before the fence that they speak of, `copy: PATH` alone.
fn actions(name: &str) -> Vec<Action> {
    let text = page(name);
    let mut found = Vec::new();
    for piece in text.split("<!-- ").skip(1) {
        let (what, rest) = piece.split_once(" -->").unwrap_or_else(|| panic!("{name}: a comment without an end"));
        let fence = || {
            let opened =
                rest.trim_start().strip_prefix("```").unwrap_or_else(|| panic!("{name}: no fence after {what}"));
            let (_, content) = opened.split_once('\n').expect("a line");
            content.split("```").next().unwrap_or_default().to_owned()
        };
        match what.split_once(": ") {
            Some(("file", file)) => found.push(Action::Write(file.into(), fence())),
            Some(("copy", path)) => found.push(Action::Copy(path.into())),
            None if what == "run" => found.push(Action::Run(fence())),
            _ => {}
        }
    }
    found
}

/// Does what a page says, with `pullout` on the PATH: every script must end with 0.
fn follow(name: &str) -> Desk {
    let desk = Desk::new();
    let mut folders = vec![PathBuf::from(env!("CARGO_BIN_EXE_pullout")).parent().expect("a folder").to_owned()];
    folders.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
    let path: OsString = std::env::join_paths(folders).expect("a PATH");
    let mut scripts = 0;
    for action in actions(name) {
        match action {
            Action::Write(file, content) => {
                desk.write(&file, &content);
            }
            Action::Copy(file) => {
                let to = desk.path(Path::new(&file).file_name().and_then(|name| name.to_str()).expect("a name"));
                std::fs::copy(workspace(&file), to).unwrap_or_else(|error| panic!("{file}: {error}"));
            }
            Action::Run(script) => {
                scripts += 1;
                let mut shell = Command::new("sh");
                shell.env_remove("PULLOUT_PLUGIN_PATH").env("PATH", &path);
                run(shell.current_dir(desk.path(".")).args(["-ec", &script]));
            }
        }
    }
    assert!(scripts > 0, "{name} has no commands");
    desk
}

/// The columns of a run are those that the book lists, in its order.
fn columns_are_listed(history: &Table, section: &str) {
    let text = page("docs/reference/columns.md");
    let section = text.split("\n## ").find(|part| part.starts_with(section)).expect("a section");
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let listed: Vec<&str> =
        rows.flat_map(|row| row[2..].split('|').next().unwrap_or_default().split('`').skip(1).step_by(2)).collect();
    let written: Vec<&str> = history.columns.iter().map(String::as_str).filter(|name| listed.contains(name)).collect();
    let expected: Vec<&str> = listed.iter().copied().filter(|name| written.contains(name)).collect();
    assert_eq!(written, expected, "docs/reference/columns.md");
    if section.starts_with("Specimens") {
        assert_eq!(written.len(), history.columns.len(), "a column that docs/reference/columns.md does not list");
    }
}

/// Largest difference of two runs' stresses and free strains, relative to the largest entry of each column.
fn difference(a: &Run, b: &Run) -> f64 {
    let mut greatest = 0.0;
    for name in ["e11", "e22", "e33", "g12", "s11", "s22", "s33", "s12"] {
        let (a, b) = (a.history.column(name), b.history.column(name));
        assert_eq!(a.len(), b.len());
        let scale = a.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
        // a component that is free of stress everywhere holds what the iteration left
        if scale > 1e-7 || name.starts_with(['e', 'g']) {
            greatest = worst(a.iter().zip(&b).map(|(a, b)| (a - b).abs() / scale).chain([greatest]));
        }
    }
    greatest
}

/// A library that the tutorial of UMATs built, with its case, against `linear_elastic`.
fn follows_linear_elasticity(desk: &Desk, theirs: &str) {
    let theirs = Run::read(&desk.path(theirs), desk.pullout(["check", "umat.json"]).expect(0));
    let case = desk.path("umat.json");
    let ours = desk.run(&case, &["material={\"plugin\": \"linear_elastic\", \"props\": [31800.0, 0.18]}"], "ours", 0);
    assert!((theirs.history.last("s11") - 31.8).abs() < 1e-10);
    assert!(difference(&ours, &theirs) < 1e-12);
}

/// In Fortran and in C: built, run, and checked by the tutorial's own commands.
#[test]
fn the_umat_of_the_tutorial_runs_and_passes_the_check() {
    if find(Tool::Fortran).is_none() || find(Tool::C).is_none() {
        return;
    }
    let desk = follow("docs/using/umat.md");
    follows_linear_elasticity(&desk, "out/umat");
    follows_linear_elasticity(&desk, "out/in-c");
    let verdict =
        desk.pullout(["plugin", "check", "./libmy_umat.so", "--case", "umat.json", "--states", "20"]).expect(0);
    assert!(verdict.stdout.contains("consistent"), "{}", verdict.stdout);
    // the broken one fails, as is shown
    let page = page("docs/using/umat.md");
    let command = page.lines().find(|line| line.starts_with("pullout plugin check broken_umat.f")).expect("a command");
    let shown = page.lines().find(|line| line.starts_with("FAIL  consistent tangent")).expect("a row");
    let mut check = program::command();
    check.current_dir(desk.path("")).env("XDG_CACHE_HOME", desk.path("cache")).args(command.split(' ').skip(1));
    let output = check.output().expect("it starts");
    let report = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{report}");
    assert!(report.lines().any(|row| row.starts_with(shown)), "{report}");
}

/// The case of the README and of the first page is one; it unloads, and inelastic strain stays.
#[test]
fn the_first_case_runs_and_unloads() {
    assert_eq!(blocks("README.md", "json")[0], blocks("docs/using/first-run.md", "json")[0]);
    let desk = follow("README.md");
    assert!(desk.path("case.schema.json").is_file());
    let desk = follow("docs/using/first-run.md");
    let run = Run::read(&desk.path("out/case"), desk.pullout(["check", "case.json"]).expect(0));
    assert!(run.peak("s11", "min") < -27.0);
    assert!(run.history.last("s11").abs() < 1e-7, "unloaded");
    assert!(run.history.last("e11") < -1e-4, "inelastic strain stays");
    columns_are_listed(&run.history, "Points");
}

#[test]
fn the_rust_law_builds_and_passes_the_check() {
    let desk = Desk::new();
    let contract = workspace("umat-abi");
    let manifest = blocks("docs/using/law.md", "toml")[0].replace("../pullout/umat-abi", &contract.to_string_lossy());
    desk.write("Cargo.toml", &format!("{manifest}\n[workspace]\n"));
    desk.write("src/lib.rs", &blocks("docs/using/law.md", "rust")[0]);
    let cargo = option_env!("CARGO").unwrap_or("cargo");
    let target = desk.path("target");
    // the versions that this workspace uses, so that nothing has to be looked up
    std::fs::copy(workspace("Cargo.lock"), desk.path("Cargo.lock")).expect("Cargo.lock");
    run(Command::new(cargo).current_dir(desk.path(".")).env("CARGO_TARGET_DIR", &target).args([
        "build",
        "--release",
        "--offline",
        "--quiet",
    ]));
    let library = target.join("release").join("libhyperbolic.so");
    let check = desk.pullout(["plugin", "check", &library.to_string_lossy()]);
    let verdict = check.expect(0).stdout;
    assert!(verdict.contains("none failed"), "{verdict}");
    assert!(desk.pullout(["plugin", "info", &library.to_string_lossy()]).expect(0).stdout.contains("gamma_r"));
}

/// A J2 UMAT in another language along strain cycles, against `j2_plasticity`.
fn plasticity_in(tool: Tool, file: &str) {
    let Some(mut compiler) = find(tool) else { return };
    let desk = Desk::new();
    let library = desk.path("libforeign.so");
    let source = workspace("tests/umats").join(file);
    let include = workspace("umat-abi/include");
    run(compiler.args(["-shared", "-fPIC", "-O2", "-o"]).arg(&library).arg(source).arg("-I").arg(include).arg("-lm"));
    // all strains given: both libraries see the same path to the last bit
    let steps = [0.01, -0.01, 0.02].map(|e| {
        let target =
            json!({ "e11": e, "e22": -0.4 * e, "e33": -0.3 * e, "g12": 0.5 * e, "g13": 0.2 * e, "g23": "hold" });
        json!({ "increments": 50, "target": target })
    });
    let case = |material: serde_json::Value| json!({ "kind": "point", "title": file, "material": material, "mode": "3d", "steps": steps });
    let props = [210_000.0, 0.3, 347.0, 2100.0];
    let theirs = case(json!({ "plugin": library, "props": props, "nstatv": STATES_OF_THE_FOREIGN_UMAT }));
    let table = [[347.0, 0.0], [347.0 + 2100.0 * 10.0, 10.0]];
    let ours = case(json!({ "plugin": "j2_plasticity", "props": { "E": 210_000.0, "nu": 0.3, "hardening": table } }));
    let theirs = desk.run(&desk.case("theirs.json", &theirs), &[], "theirs", 0);
    let ours = desk.run(&desk.case("ours.json", &ours), &[], "ours", 0);
    assert!(ours.peak("s11", "max") > 347.0);
    assert!(difference(&ours, &theirs) < 1e-12, "{file}: {:e}", difference(&ours, &theirs));
    assert!(Path::new(&theirs.folder).join("report.html").is_file());
}

/// Equivalent plastic strain and six plastic strains.
const STATES_OF_THE_FOREIGN_UMAT: usize = 7;

#[test]
fn plasticity_in_fortran_follows_the_plugin() {
    plasticity_in(Tool::Fortran, "j2.f90");
}

#[test]
fn plasticity_in_c_follows_the_plugin() {
    plasticity_in(Tool::C, "j2.c");
}

/// The fibre of the tutorial leaves nothing in the block.
#[test]
fn the_fibre_of_the_tutorial_is_pulled_out() {
    let desk = follow("docs/using/fibre.md");
    let run = Run::read(&desk.path("out/fibre"), desk.pullout(["check", "fibre.json"]).expect(0));
    let (load, slip) = (run.history.column("load"), run.history.column("slip"));
    let peak = load.iter().fold(0.0_f64, |peak, load| peak.max(*load));
    // πφL times the greatest bond, and what friction adds
    assert!((29.0..33.0).contains(&peak), "{peak}");
    assert!(load.last().unwrap().abs() < 1e-6 * peak && *slip.last().unwrap() == 12.5);
    assert!(run.history.column("energy_error").iter().all(|error| error.abs() < 1e-3));
    columns_are_listed(&run.history, "Specimens");
}

/// The hooked fibre of the tutorial has the load that its page prints: the increments of other machines may move it a little.
#[test]
fn the_hooked_fibre_of_the_tutorial_crushes_the_concrete() {
    let desk = follow("docs/using/hooked-fibre.md");
    let run = Run::read(&desk.path("out/hooked"), desk.pullout(["check", "hooked.json"]).expect(0));
    let peak = run.history.column("load").iter().fold(0.0_f64, |peak, load| peak.max(*load));
    assert!((peak / 380.4 - 1.0).abs() < 0.01, "{peak}");
    assert!(run.history.column("energy_error").iter().all(|error| error.abs() < 1e-3));
}

/// The study of the tutorial: friction adds to the peak, and twice the length is twice the peak.
#[test]
fn the_study_of_the_tutorial_finds_its_claims() {
    let shown = blocks("docs/using/study.md", "json");
    assert_eq!(shown.len(), 2, "the fibre and the study");
    assert_eq!(shown[0], blocks("docs/using/fibre.md", "json")[0]);
    let desk = follow("docs/using/study.md");
    let study = program::json(&desk.path("out/friction/study.json"));
    let claims = study["claims"].as_array().expect("claims");
    assert!(claims.len() == 3 && claims.iter().all(|claim| claim["verdict"] == "found"), "{claims:?}");
    assert!(desk.path("out/friction/plots/work_normalised.png").is_file());
}

/// The sweep of the tutorial: a row for each combination, and the stiffer bond is as stiff.
#[test]
fn the_sweep_of_the_tutorial_has_its_rows() {
    let desk = follow("docs/using/sweeps.md");
    let text = std::fs::read_to_string(desk.path("bonds.csv")).expect("a table");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let at = |name: &str| header.iter().position(|column| *column == name).unwrap_or_else(|| panic!("no {name}"));
    assert!(header.starts_with(&["run", "key", "status", "message"]), "{header:?}");
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 16);
    for row in rows {
        assert_eq!(row[at("status")], "done");
        let number = |name: &str| row[at(name)].parse::<f64>().expect("a number");
        assert!(number("q.peak") >= number("q.tau_01") && number("q.work") > 0.0, "{row:?}");
    }
}

/// The curve of the tutorial gives its law back, and the case that is written runs.
#[test]
fn the_bond_law_of_the_tutorial_is_found() {
    let desk = follow("docs/using/bond-law.md");
    let found = program::json(&desk.path("fit/fit.json"));
    let number = |name: &str, key: &str| found["forms"]["powers"]["parameters"][name][key].as_f64().expect("a number");
    // the law in the head of the file; its joints are intersections
    for (name, value) in [
        ("k_e", 400.0),
        ("a_2", 1.0),
        ("b_2", -0.1772),
        ("g_crit", 0.003_999_6),
        ("tau_crit", 1.59985),
        ("g_peak", 0.020_008_9),
        ("tau_peak", 1.99997),
    ] {
        assert!((number(name, "value") / value - 1.0).abs() < 0.05, "{name}: {}", number(name, "value"));
    }
    for (name, value) in [("a_1", 3.44), ("b_1", 0.13865)] {
        assert!((number(name, "value") - value).abs() < 3.0 * number(name, "standard_error"), "{name}");
    }
    let run = desk.run(&desk.path("fit/powers-case.json"), &["output.plots=false", "output.vtu=false"], "again", 0);
    // the noise is what is left
    let rms = run.summary["compare"][0]["rms"].as_f64().expect("a comparison");
    assert!((0.015..0.025).contains(&(rms / run.peak("load", "max"))), "{rms}");
}

/// The dosage of the tutorial does what is claimed of it, and the case that leads back has the strengths of the tests.
#[test]
fn the_beam_of_the_tutorial_leads_back() {
    let desk = follow("docs/using/bridging.md");
    let study = program::json(&desk.path("out/dosage/study.json"));
    let claims = study["claims"].as_array().expect("claims");
    assert!(claims.len() == 2 && claims.iter().all(|claim| claim["verdict"] == "found"), "{claims:?}");
    let strength = |summary: &str, k: usize| {
        program::json(&desk.path(summary))["bridging"]["beam"]["f_R"][k].as_f64().expect("a strength")
    };
    assert!(strength("out/beam/summary.json", 2) < strength("out/bond-case/summary.json", 2));
    for (k, tested) in [4.133, 4.0, 3.867, 3.667].into_iter().enumerate() {
        let found = strength("out/bond-case/summary.json", k);
        assert!((found / tested - 1.0).abs() < 0.1, "f_R{}: {found} for {tested}", k + 1);
    }
}
