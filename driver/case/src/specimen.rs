//! Kind "pullout": mesh, parts, contact, boundary conditions and steps, put together into a model of the FE core.

use crate::document::pullout as document;
use crate::document::{Plots, PulloutCase};
use crate::problem::{Place, hint};
use crate::reader::{Reader, UsedDefaults};
use crate::{history, increments, plugin};
use bearing::Bearings;
use boundary::{Boundary, Drives};
use fe_core::mesh::{Element, Mesh};
use fe_core::model::{ContactLaw, Controls, Model, PluginLaw, Skipping};
use fe_core::stepping::Analysis;
use mesh::MeshAndSets;
use pullout_run::columns;
use pullout_run::program::About;
use pullout_run::pullout::{PictureAt, PulloutProgram};
use std::path::Path;
use umat_abi::host::{ExternalDatabases, Plugin};

mod bearing;
mod boundary;
mod contact;
mod couplings;
mod fibres;
mod generated;
mod mesh;
mod parts;
mod preflight;
mod scalar_field;
mod steps;
mod uniaxial;

/// Increments between two written fields, unless the case says otherwise.
const FIELDS_EVERY: usize = 10;
/// Elongation over the gauge length beyond which a steel fibre counts as ruptured, unless the case says otherwise (an assumption).
const RUPTURE_STRAIN: f64 = 0.03;

/// Resolves a case; what is wrong with it goes to the reader.
pub fn resolve(reader: &mut Reader<'_>, path: &Path, case: &PulloutCase) -> Option<PulloutProgram> {
    let root = Place::root();
    let nlgeom = case.nlgeom.unwrap_or(false);
    let ground = mesh::resolve(reader, case);
    let checked = ground.as_ref().and_then(|ground| mesh::checked(reader, ground));
    let scene = KnownMesh { ground: ground.as_ref(), mesh: checked.as_ref(), loose: &[] };
    let has_field = scalar_field::parts(reader, case, scene);
    let parts = parts::resolve(reader, case, scene, has_field.as_deref());
    let mut drives = Drives::default();
    let bearings = Bearings::new(case, scene, parts.as_ref().map(|parts| &parts.laws[..]));
    let contacts = contact::resolve(reader, case, scene, &bearings, &mut drives);
    let couplings = couplings::resolve(reader, case, scene);
    let mut loose = checked.as_ref().map(Mesh::free_nodes).unwrap_or_default();
    loose.retain(|&node| !couplings.iter().any(|coupling| coupling.nodes().any(|coupled| coupled == node)));
    let mut boundary = boundary::resolve(reader, case, KnownMesh { loose: &loose, ..scene }, drives);
    let mut field = scalar_field::resolve(reader, case, scene, has_field, &mut boundary.drives);
    let initial_drives = initial_drives(reader, case, &mut boundary);
    let steps = steps::resolve(reader, case, &mut boundary);
    let fields = steps::fields(reader, case, &steps);
    let columns = columns::of_specimen(&boundary.measured.fibres);
    let about = history::about(reader, path, &case.head, case.course.until.as_ref(), Some(&columns));
    if scene.mesh.is_some() {
        let place = root.key("until");
        steps::refuse_unmeasured(reader, about.until.as_ref(), &columns, &boundary.measured, &place);
    }
    let output = case.output.clone().unwrap_or_default();
    let (plots, captions) = Plots::of(output.plots.as_ref());
    if output.pictures_at.is_some() && !plots {
        reader.warn_no_effect(&root.key("output").key("pictures_at"), "the case has \"plots\": false");
    }
    let controls = controls(reader, case);
    let skipping = skipping(reader, case);
    let Boundary { drives, supports, loads, mut measured } = boundary;
    let (mesh, parts, mut contacts) = (checked?, parts?, contacts?);
    let ground = ground?;
    let lines = contact::interface_lines(&contacts, &ground.specimen.contact_pairs);
    let part_at =
        |node: usize| mesh.elements().iter().find(|element| element.nodes().contains(&node)).map(Element::part);
    measured.part = measured.tail_node.and_then(part_at);
    for fibre in &mut measured.fibres {
        let prefix = format!("fibre.{}.", fibre.name);
        let own = lines.keys().enumerate().filter(|(_, master)| master.starts_with(&prefix));
        fibre.lines = own.map(|(line, _)| line).collect();
    }
    measured.interface_lines = lines.into_values().collect();
    measured.wires = parts::wires(reader, case, &mesh, &ground.specimen.fibres, &parts.laws);
    measured.bearing_factor = contact::bearing_factor(&contacts, ground.diameter());
    let place = root.key("output");
    let is_open = measured.wires.iter().any(|wire| !wire.has_limits());
    match (is_open, output.rupture_strain) {
        (false, Some(_)) => {
            let reason = "no fibre of a specimen is without a strength and an elongation of its own";
            reader.warn_no_effect(&place.key("rupture_strain"), reason);
        }
        (true, None) => reader.note_defaults(&place, &[format!("rupture_strain = {RUPTURE_STRAIN}")]),
        _ => {}
    }
    let stabilises = controls.relaxation_time > 0.0 || parts.laws.iter().any(|law| law.overstress_work().is_some());
    if controls.max_stabilisation_share.is_some() && !stabilises {
        let reason = "nothing is stabilised: there is no relaxation_time, and no law extrapolates";
        reader.warn_no_effect(&root.key("controls").key("max_stabilisation_share"), reason);
    }
    if controls.relaxation_time > 0.0 && !parts.laws.iter().any(PluginLaw::may_lose_stability) {
        let reason = "no law of a part may soften, and all tangents are symmetric";
        reader.warn_no_effect(&root.key("controls").key("relaxation_time"), reason);
    }
    if controls.spalling.is_some() && !parts.laws.iter().any(PluginLaw::damages) {
        reader.warn_no_effect(&root.key("spalling"), "no law of a part has damage");
    }
    let nlgeom: Vec<bool> = parts.nlgeom.into_iter().map(|of_part| of_part.unwrap_or(nlgeom)).collect();
    for pair in &mut contacts {
        pair.master_bends = pair.master.iter().any(|edge| nlgeom[mesh.elements()[edge.element].part()]);
    }
    let of_parts: Vec<&Plugin> = parts.laws.iter().map(|law| &law.plugin).collect();
    let of_contact: Vec<&Plugin> = contacts
        .iter()
        .map(|pair| match &pair.law {
            ContactLaw::Uinter(law) | ContactLaw::Fric { law, .. } => &law.plugin,
        })
        .collect();
    scalar_field::report_temperature(reader, case, &fields, field.as_ref(), [&of_parts, &of_contact]);
    if field.is_none() {
        let reason = Some("the case has no \"field\"");
        let mut reported = Vec::new();
        for law in &parts.laws {
            if !reported.contains(&law.library.path()) {
                plugin::report_heat_routines(reader, &law.library, [("hetval", reason), ("umatht", reason)]);
                reported.push(law.library.path());
            }
        }
    }
    if let Some(field) = &mut field {
        let least = |part: usize| {
            let of_part = (0..mesh.elements().len()).filter(|&element| mesh.elements()[element].part() == part);
            of_part.map(|element| mesh.element_area(element).sqrt()).fold(f64::INFINITY, f64::min)
        };
        scalar_field::with_cracks_of(reader, field, &parts.laws, least);
        scalar_field::with_routines(reader, case, field, &parts.laws);
    }
    let model = Model {
        mesh,
        laws: parts.laws,
        average_dilatation: parts.average_dilatation,
        nlgeom,
        contacts,
        drives: drives.names(),
        initial_drives,
        supports,
        couplings,
        loads,
        measured,
        fields,
        field,
        steps: steps.iter().map(|step| step.step.clone()).collect(),
        controls,
        skipping,
    };
    let steps_of_run = vec![None; model.steps.len()];
    let recorded = increments::recorded(reader, case.course.increments.as_ref(), &steps_of_run, about.until.is_some());
    if reader.problems.is_empty() {
        let is_given = matches!(case.supports, Some(document::Supports::Given(_)));
        preflight::check(reader, &model, ground.supports.first().filter(|_| is_given));
    }
    if reader.problems.is_empty() {
        // what UEXTERNALDB prepares is there within an analysis, and that begins once
        let checked = match ExternalDatabases::is_in(model.libraries()) {
            true => Analysis::check(&model),
            false => Analysis::check(&model).and_then(|()| Analysis::check_laws(&model)),
        };
        if let Err(error) = checked {
            reader.problem(&root, error.to_string());
        }
    }
    Some(PulloutProgram {
        about: About {
            every: output.every.map_or(1, |every| every.0),
            plots,
            captions,
            recorded,
            warnings: std::mem::take(&mut reader.warnings),
            notes: std::mem::take(&mut reader.notes),
            highlights: std::mem::take(&mut reader.highlights),
            defaults: std::mem::take(&mut reader.defaults),
            ..about
        },
        fields_every: match output.vtu {
            None | Some(document::Vtu::Switch(true)) => Some(FIELDS_EVERY),
            Some(document::Vtu::Switch(false)) => None,
            Some(document::Vtu::Every(n)) => Some(n.0),
        },
        pictures_at: match &output.pictures_at {
            None => Vec::new(),
            Some(document::PicturesAt::Slips(slips)) => slips.iter().map(|slip| PictureAt::Slip(slip.0)).collect(),
            Some(document::PicturesAt::Increments(numbers)) => {
                numbers.increments.iter().map(|number| PictureAt::Increment(number.0 as u64)).collect()
            }
        },
        rupture_strain: output.rupture_strain.map_or(RUPTURE_STRAIN, |strain| strain.0),
        fibre_diameter: ground.diameter(),
        fibre_axis: ground.axis(),
        mesh: ground.words,
        model,
        step_untils: steps.into_iter().map(|step| step.until).collect(),
    })
}

/// Values of the drives at the start; none: all are 0.
fn initial_drives(reader: &mut Reader<'_>, case: &PulloutCase, boundary: &mut Boundary) -> Vec<f64> {
    let place = Place::root().key("initial");
    let Some(given) = case.initial.as_ref() else { return Vec::new() };
    let mut values = vec![0.0; boundary.drives.len()];
    for (name, value) in &given.drives {
        let place = place.key("drives").key(name);
        match boundary.drives.moved(name) {
            Some(index) if boundary.supports.iter().any(|support| support.drive == Some(index)) => {
                reader.problem(
                    &place,
                    "is the displacement of a support, which starts at 0; only the drives of loads may start elsewhere",
                );
            }
            Some(index) => values[index] = *value,
            None => boundary.drives.report_unknown(reader, name, &place),
        }
    }
    values
}

/// The mesh that names of the case refer to, as far as it is known.
#[derive(Clone, Copy)]
struct KnownMesh<'a> {
    ground: Option<&'a MeshAndSets>,
    mesh: Option<&'a Mesh>,
    /// Nodes without an element that may not be named: nothing is there to load, to hold or to measure.
    loose: &'a [usize],
}

impl<'a> KnownMesh<'a> {
    /// A node set; `None` with a problem if there is none, without one if the mesh is not known.
    fn node_set(self, reader: &mut Reader<'_>, name: &str, place: &Place) -> Option<&'a [usize]> {
        let mesh = self.mesh?;
        let Some(found) = mesh.node_set(name) else {
            return no_set(reader, "node", name, mesh.node_set_names(), place);
        };
        let part = mesh.parts().iter().position(|part| part.name == name);
        let mut of_part = mesh.elements().iter().filter(|element| Some(element.part()) == part);
        if !of_part.all(|element| element.nodes().iter().all(|node| found.contains(node))) {
            reader.problem(
                place,
                format!("'{name}' is a part and a node set of the mesh: which nodes are meant? Give one another name"),
            );
        }
        for &node in found.iter().filter(|node| self.loose.contains(node)).take(1) {
            self.report_loose_node(reader, node, &format!(" of '{name}'"), place);
        }
        Some(found)
    }

    /// Says that a node belongs to nothing.
    fn report_loose_node(self, reader: &mut Reader<'_>, node: usize, of: &str, place: &Place) {
        let [x, y] = self.mesh.map_or([f64::NAN; 2], |mesh| mesh.nodes()[node]);
        let message = format!(
            "node {}{of} at ({x}, {y}) belongs to no element and to no coupling: nothing is there; make it a node of the \
             mesh (in Gmsh: Point{{...}} In Surface{{...}}) or couple it",
            node + 1
        );
        reader.problem(place, message);
    }

    /// An edge set, likewise.
    fn edge_set(self, reader: &mut Reader<'_>, name: &str, place: &Place) -> Option<&'a [fe_core::mesh::ElementEdge]> {
        let mesh = self.mesh?;
        let found = mesh.edge_set(name);
        let known = mesh.edge_set_names();
        found.or_else(|| no_set(reader, "edge", name, known, place))
    }
}

/// Says that the mesh has no set of a name.
fn no_set<'n, T>(
    reader: &mut Reader<'_>,
    of: &str,
    name: &str,
    known: impl Iterator<Item = &'n str>,
    place: &Place,
) -> Option<T> {
    reader.problem(place, format!("the mesh has no {of} set '{name}'{}", hint(name, known)));
    None
}

fn controls(reader: &mut Reader<'_>, case: &PulloutCase) -> Controls {
    let given = case.controls.clone().unwrap_or_default();
    let mut taken = UsedDefaults::default();
    given.note(&mut taken, &[]);
    let spalling = case.spalling.as_ref().map(|given| {
        let mut taken = UsedDefaults::default();
        given.note(&mut taken, &[]);
        reader.note_defaults(&Place::root().key("spalling"), &taken.0);
        **given
    });
    reader.note_defaults(&Place::root().key("controls"), &taken.0);
    Controls { spalling, ..*given }
}

fn skipping(reader: &mut Reader<'_>, case: &PulloutCase) -> Skipping {
    match &case.skip {
        None | Some(document::Skip::Word(document::SkipWord::All)) => Skipping::ALL,
        Some(document::Skip::Word(document::SkipWord::None)) => Skipping::NONE,
        Some(document::Skip::Items(given)) => {
            let gone = [("unused_tangents", given.unused_tangents), ("symmetric_solver", given.symmetric_solver)];
            for (name, _) in gone.iter().filter(|(_, given)| given.is_some()) {
                reader.warn(format!("{}: has no effect any more", Place::root().key("skip").key(name)));
            }
            *given.items
        }
    }
}
