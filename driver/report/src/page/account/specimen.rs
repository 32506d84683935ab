//! Describes a specimen in text and tables.

use super::{Account, LawAccount, bound, called, count, described, parameters, until_and_every};
use fe_core::kinematics::PlaneModel;
use fe_core::model::{
    ContactPair, Controls, Enforcement, Interference, Model, Quadrature, Skipping, Step, StepControl, Support, Width,
};
use pullout_run::number::rounded;
use pullout_run::program::Until;
use pullout_run::pullout::PulloutProgram;

/// Returns the account of a specimen.
pub(super) fn account(program: &PulloutProgram) -> Account {
    let columns = program.columns();
    let model = &program.model;
    let laws: Vec<LawAccount> = program
        .laws()
        .into_iter()
        .map(|(subject, law)| LawAccount {
            subject,
            law: law.name.clone(),
            description: law.law.as_ref().map(|law| law.description.clone()).unwrap_or_default(),
            parameters: parameters(law.law.as_ref(), &law.props),
        })
        .collect();
    let pairs: Vec<(&Step, Option<&Until>)> =
        model.steps.iter().zip(program.step_untils.iter().map(Option::as_ref)).collect();
    let (steps, steps_left_out) = described(&pairs, |(step, until)| one_step(step, *until, model, &columns));
    Account {
        law: laws.first().map(|law| law.law.clone()).unwrap_or_default(),
        mode: format!(
            "{}, {}",
            program.mesh,
            if model.has_large_displacements() { "large displacements" } else { "small displacements" }
        ),
        settings: settings(program, &columns),
        laws,
        steps,
        steps_left_out,
        ..Account::default()
    }
}

fn settings(program: &PulloutProgram, columns: &[String]) -> Vec<(String, String)> {
    let model = &program.model;
    let mesh = &model.mesh;
    let size = format!("{} nodes, {}", mesh.nodes().len(), count(mesh.elements().len(), "element"));
    let mut settings = vec![("Mesh".to_owned(), size)];
    for (index, part) in mesh.parts().iter().enumerate() {
        let elements = mesh.elements().iter().filter(|element| element.part() == index).count();
        let model = match part.model {
            PlaneModel::PlaneStress => format!("plane stress, thickness {} mm", rounded(part.thickness)),
            PlaneModel::PlaneStrain => format!("plane strain, thickness {} mm", rounded(part.thickness)),
            PlaneModel::Axisymmetric => "axisymmetric".to_owned(),
        };
        let how = called(program.model.laws[index].manner).map_or(String::new(), |how| format!(", UMAT {how}"));
        settings.push((format!("Part {}", part.name), format!("{}, {model}{how}", count(elements, "element"))));
    }
    settings.extend(model.contacts.iter().map(|pair| (format!("Contact {}", pair.name), contact(pair, model))));
    settings.extend(model.supports.iter().map(|held| (format!("Support {}", held.name), support(held, model))));
    settings.extend(model.loads.iter().map(|load| (format!("Load {}", load.name), model.drives[load.drive].clone())));
    if !model.couplings.is_empty() {
        settings.push(("Couplings".to_owned(), count(model.couplings.len(), "constraint")));
    }
    settings.push(("Controls".to_owned(), controls(&model.controls)));
    settings.push(("Skipping".to_owned(), skipping(model.skipping)));
    settings.extend(until_and_every(&program.about, columns));
    settings
}

fn contact(pair: &ContactPair, model: &Model) -> String {
    let points = match pair.quadrature {
        Quadrature::Gauss(points) => format!("{} on each slave edge", count(points, "Gauss point")),
        Quadrature::Segments(points) => format!("{} on each segment", count(points, "Gauss point")),
        Quadrature::Nodes => "points at the slave nodes".to_owned(),
    };
    let width = match pair.width {
        Width::Given(width) => format!("width {} mm", rounded(width)),
        Width::OfPart => "width of the slave's part".to_owned(),
    };
    let enforcement = match pair.enforcement {
        Enforcement::Penalty => "penalty".to_owned(),
        Enforcement::Uzawa { tolerance, max_updates } => {
            format!("penalty with at most {max_updates} updates to {} mm", rounded(tolerance))
        }
        Enforcement::PerturbedLagrangian { ratio } => format!("perturbed Lagrangian, ratio {}", rounded(ratio)),
    };
    let mut text = format!("{points}, {width}, {enforcement}, penalty factor {}", rounded(pair.penalty_factor));
    match pair.fit.closes_within {
        0.0 => {}
        f64::INFINITY => text.push_str(", initial gaps closed"),
        within => text.push_str(&format!(", initial gaps up to {} mm closed", rounded(within))),
    }
    if let Some(Interference { drive, depth }) = pair.fit.interference {
        let depth = depth.map_or("the overlap of the mesh".to_owned(), |depth| format!("{} mm", rounded(depth)));
        text.push_str(&format!(", interference of {depth} times '{}'", model.drives[drive]));
    }
    text
}

fn controls(controls: &Controls) -> String {
    let mut text = format!(
        "force tolerance {}, displacement tolerance {}, at most {} iterations and {} cutbacks",
        rounded(controls.force_tolerance),
        rounded(controls.displacement_tolerance),
        controls.max_iterations,
        controls.max_cutbacks
    );
    let switches = [(controls.line_search, "line search"), (controls.locate_peak, "peak located")];
    switches.into_iter().filter(|(on, _)| *on).for_each(|(_, name)| text.push_str(&format!(", {name}")));
    if controls.relaxation_time > 0.0 {
        text.push_str(&format!(", relaxation time {} s", rounded(controls.relaxation_time)));
    }
    text
}

fn skipping(skipping: Skipping) -> String {
    let items = [
        (skipping.unchanged_elements, "unchanged elements"),
        (skipping.elastic_far_field, "elastic far field"),
        (skipping.factor_reuse, "reused factorisations"),
        (skipping.contact_search, "contact search"),
    ];
    let names: Vec<&str> = items.into_iter().filter(|(on, _)| *on).map(|(_, name)| name).collect();
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}

fn support(support: &Support, model: &Model) -> String {
    let [x, y] = support.direction.map(rounded);
    let moved = support.drive.map_or("held".to_owned(), |drive| format!("moved by '{}'", model.drives[drive]));
    format!("{} along ({x}, {y}), {moved}", count(support.nodes.len(), "node"))
}

fn one_step(step: &Step, until: Option<&Until>, model: &Model, columns: &[String]) -> String {
    let control = match step.control {
        StepControl::Fixed { increments } => count(increments, "increment"),
        StepControl::Automatic { initial, maximum, minimum } => format!(
            "automatic increments from {} to {} of the step, not below {}",
            rounded(initial),
            rounded(maximum),
            rounded(minimum)
        ),
    };
    let targets = model.drives.iter().zip(&step.targets);
    let targets: Vec<String> =
        targets.filter_map(|(name, target)| Some(format!("{name} → {}", rounded((*target)?)))).collect();
    let targets = if targets.is_empty() { "nothing moves".to_owned() } else { targets.join(", ") };
    let until = until.map_or(String::new(), |until| format!("; until {}", bound(until, columns)));
    format!("{control}, time {}: {targets}{until}", rounded(step.time))
}
