//! Problems with known solutions (closed forms of `end_to_end_tests::analytical`), each from its case file in
//! `cases/verification` through the reader and the FE core; and one model of the fibre against the other.

mod bar;
mod beam;
mod beyond_the_end;
mod capstan;
mod contact_patch;
mod cook;
mod cylinder;
mod drag_out;
mod grids;
mod hertz;
mod hook;
mod interference;
mod limit_point;
mod plane_and_axisymmetric;
mod pull_out;
mod tied;

use end_to_end_tests::{plugin_folder, workspace};
use fe_core::model::Model;
use fe_core::stepping::{Analysis, Directive, IncrementObserver, Record, RunError, Snapshot};
use pullout_case::Case;
use std::io;

/// The model of a case of `cases/verification`, with the texts of `--set`.
fn model(case: &str, overrides: &[&str]) -> Model {
    model_of("verification", case, overrides)
}

/// The model of a case in a folder of `cases`.
fn model_of(folder: &str, case: &str, overrides: &[&str]) -> Model {
    let file = workspace("cases").join(folder).join(format!("{case}.json"));
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    match pullout_case::read(&file, &overrides, &[plugin_folder()]) {
        Ok(Case::Pullout(program)) => program.model,
        Ok(_) => panic!("{} is of another kind", file.display()),
        Err(errors) => panic!("{errors}"),
    }
}

/// Runs a model; the closure sees the initial state and each increment.
fn run(model: &Model, look: impl FnMut(&Record, &Snapshot<'_>)) -> Result<(), RunError> {
    Analysis::new(model).unwrap_or_else(|error| panic!("{error}")).run(&mut Looking(look))
}

/// Runs a model that must reach its end, as [`run`] does.
fn run_to_end(model: &Model, look: impl FnMut(&Record, &Snapshot<'_>)) {
    run(model, look).unwrap_or_else(|error| panic!("{error}"));
}

struct Looking<F>(F);

impl<F: FnMut(&Record, &Snapshot<'_>)> IncrementObserver for Looking<F> {
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> io::Result<Directive> {
        (self.0)(record, snapshot);
        Ok(Directive::GoOn)
    }
}

/// The node at a position.
fn node_at(model: &Model, [x, y]: [f64; 2]) -> usize {
    let nodes = model.mesh.nodes();
    let there = nodes.iter().position(|node| (node[0] - x).hypot(node[1] - y) < 1e-9);
    there.unwrap_or_else(|| panic!("no node is at ({x}, {y})"))
}

/// Orders of convergence between meshes that are each twice as fine as the one before.
fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

/// Formats errors for messages.
fn scientific(errors: &[f64]) -> String {
    let words: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
    words.join(", ")
}
