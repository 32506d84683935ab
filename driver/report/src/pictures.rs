//! Draws a specimen's fields at the peak load, at the end of the run, and when the case asks for them.
//!
//! `deformed_mesh`, `principal_stress_max`, `principal_stress_min` and the damages of the laws show the whole specimen;
//! `principal_directions` shows crosses along the principal stresses, `active_zone` which elements are condensed,
//! computed, damaged or yielded.
//! Names with `_exit` show the surroundings of the fibre's exit, with `_peak` the peak load, with `_at_1` the first moment of
//! `output.pictures_at`. `axial_stress`, `interface_shear` and `interface_pressure` show all these moments in one picture.

use crate::directory::ResultDirectory;
use crate::plots::field::{
    Class, FieldPicture, INTERFACE_SHEAR, PictureError, PictureMesh, Window, contour, crosses, deformed_mesh,
    interface_profiles, zones,
};
use crate::plots::figure::{Figure, Line, Style};
use crate::plots::quantity::{Quantity, capital, group_of};
use crate::plots::{Drawings, FOLDER};
use crate::{ROUNDING, extremes, without_rounding};
use fe_core::mesh::Mesh;
use fe_core::model::Model;
use fe_core::output::{Activity, FieldsError, Principal, Recovery, axial_stress};
use plotters::style::RGBColor;
use pullout_run::columns::Group;
use pullout_run::number::significant;
use pullout_run::pullout::fibre::{FibreGeometry, Wall};
use pullout_run::pullout::{PictureAt, PulloutProgram, SavedState, SpecimenOutcome};
use std::collections::BTreeSet;
use std::io;

/// The zoom shows so many diameters of the fibre to each side of its exit.
const ZOOM: f64 = 3.0;
/// Cross-sections along a fibre at most.
const MOST_SECTIONS: usize = 400;
/// A damage that nobody sees.
const LITTLE_DAMAGE: f64 = 0.01;
/// Colours and names of the elements' states, in the order of [`Activity`]; released elements are not drawn.
const ACTIVITIES: [Class<'static>; 4] = [
    (RGBColor(0xf4, 0xf4, 0xf4), "condensed"),
    (RGBColor(0xbf, 0xdd, 0xf0), "elastic"),
    (RGBColor(0xd5, 0x5e, 0x00), "damaged"),
    (RGBColor(0xe6, 0x9f, 0x00), "yielded"),
];
pub(crate) const ALONG_HOLE: &str = "distance along the hole from the fibre's initial end";
const ALONG_FIBRE: &str = "distance from the embedded end along the fibre";

/// Draws everything into the folder of the pictures.
///
/// # Errors
/// A file that cannot be written, or fields that do not fit the mesh.
pub fn draw(
    directory: &mut ResultDirectory,
    program: &PulloutProgram,
    outcome: &SpecimenOutcome,
) -> io::Result<Drawings> {
    let mut album = Album::new(directory, program);
    let moment = |state, suffix: String, words: String| Moment { state, suffix, words, load: state.load };
    let asked = outcome.moments.iter().enumerate().map(|(index, (at, state))| {
        let words = match at {
            PictureAt::Slip(slip) => format!("at {slip} mm"),
            PictureAt::Increment(number) => format!("increment {number}"),
        };
        moment(state, format!("_at_{}", index + 1), words)
    });
    let peak = outcome.peak.iter().map(|state| moment(state, "_peak".into(), "greatest load".into()));
    let end = outcome.end.iter().map(|state| moment(state, String::new(), "end of the run".into()));
    let mut moments: Vec<Moment<'_>> = asked.chain(peak).chain(end).collect();
    let greatest = moments.iter().map(|moment| moment.load.abs()).fold(0.0, f64::max);
    moments.iter_mut().for_each(|moment| moment.load = without_rounding(moment.load, greatest));
    let stresses = moments.iter().flat_map(|moment| &moment.state.fields.stresses);
    album.greatest_stress = stresses.map(|&stress| magnitude(&Principal::new(stress))).fold(0.0, f64::max);
    for moment in &moments {
        album.contours(moment)?;
    }
    album.axial_stress(&moments)?;
    album.interface(&moments)?;
    Ok(album.drawings)
}

/// A state with its name.
struct Moment<'a> {
    state: &'a SavedState,
    /// Ending of a file's stem.
    suffix: String,
    words: String,
    /// Load, N: 0 where only rounding is left of the greatest one, NaN where none is measured.
    load: f64,
}

impl Moment<'_> {
    fn title(&self, what: &str) -> String {
        let words = &self.words;
        let load = if self.load.is_nan() { String::new() } else { format!(", load {} N", significant(self.load, 4)) };
        format!("{what}, {words}: slip {} mm{load}", significant(self.state.slip, 4))
    }
}

/// Pictures of one run.
struct Album<'a> {
    directory: &'a mut ResultDirectory,
    mesh: &'a Mesh,
    recovery: Recovery,
    fibre: Option<FibreGeometry>,
    /// Position of each pair's slave surface along the fibre.
    walls: Vec<Option<Wall>>,
    matrix: BTreeSet<usize>,
    /// The greatest principal stress of all moments, MPa.
    greatest_stress: f64,
    drawings: Drawings,
}

impl<'a> Album<'a> {
    fn new(directory: &'a mut ResultDirectory, program: &'a PulloutProgram) -> Self {
        let mesh = &program.model.mesh;
        let (fibre, walls) = walls(&program.model);
        Self {
            walls,
            directory,
            mesh,
            recovery: Recovery::new(mesh),
            fibre,
            matrix: matrix(&program.model),
            greatest_stress: 0.0,
            drawings: Drawings::default(),
        }
    }

    /// All pictures of the whole specimen and of the exit at one moment.
    fn contours(&mut self, moment: &Moment<'_>) -> io::Result<()> {
        let fields = &moment.state.fields;
        let mesh = PictureMesh::new(self.mesh, fields, &self.recovery);
        let stresses = self.recovery.recover(&fields.stresses).map_err(unfit)?;
        let greatest = self.greatest_stress;
        // directions of what rounding leaves say nothing
        let is_nothing = |stress: &[f64; 4]| magnitude(&Principal::new(*stress)) < ROUNDING * greatest;
        let stresses: Vec<[f64; 4]> =
            stresses.into_iter().map(|stress| if is_nothing(&stress) { [0.0; 4] } else { stress }).collect();
        let principal: Vec<Principal> = stresses.iter().copied().map(Principal::new).collect();
        let stress = |name: &str, what: &str, symbol: &str, value: fn(&Principal) -> f64| Contour {
            name: name.into(),
            what: what.into(),
            values: principal.iter().map(|stress| without_rounding(value(stress), greatest)).collect(),
            quantity: Quantity { name: symbol.into(), unit: "MPa".into() },
            follows_matrix: true,
            negligible: ROUNDING * greatest,
        };
        let mut contours = vec![
            stress("principal_stress_max", "Maximum principal stress", "σ_{max}", |stress| stress.maximum),
            stress("principal_stress_min", "Minimum principal stress", "σ_{min}", |stress| stress.minimum),
        ];
        for name in damages(&fields.distinct_state_names()) {
            let values = self.recovery.recover_limited(self.mesh, &fields.state(self.mesh, name)).map_err(unfit)?;
            let quantity = Quantity::of(name, &Default::default());
            let file = if is_total(name) { "damage".to_owned() } else { format!("damage_{name}") };
            let what = if is_total(name) { "Damage".to_owned() } else { format!("Damage {name}") };
            contours.push(Contour {
                name: file,
                what,
                values,
                quantity,
                follows_matrix: false,
                negligible: LITTLE_DAMAGE,
            });
        }
        for (place, window) in self.windows(&mesh) {
            let name = |stem: &str| format!("{stem}{place}{}", moment.suffix);
            let picture =
                |what: &str| FieldPicture { window: window.clone(), ..FieldPicture::new(moment.title(what), &mesh) };
            let magnification = mesh.suggested_magnification();
            let deformed = FieldPicture { magnification, ..picture("Deformed mesh") };
            self.keep(&name("deformed_mesh"), deformed_mesh(&deformed))?;
            let shown = fields.activities.iter().filter(|activity| **activity != Activity::Spalled);
            let classes: Vec<usize> = shown.map(|activity| *activity as usize).collect();
            if classes.iter().any(|class| *class != classes[0]) {
                self.keep(&name("active_zone"), zones(&picture("Active zone"), &classes, &ACTIVITIES))?;
            }
            if stresses.iter().flatten().any(|stress| *stress != 0.0) {
                let in_scale = |part: usize| self.matrix.is_empty() || self.matrix.contains(&part);
                let drawn = crosses(&picture("Principal stresses"), &stresses, in_scale);
                self.keep(&name("principal_directions"), drawn)?;
            }
            for shown in contours.iter().filter(|shown| !shown.is_constant(&mesh, window.as_ref())) {
                let range = shown.range(&self.recovery, &mesh, &self.matrix, window.as_ref());
                let drawn = contour(&picture(&shown.what), &shown.values, &shown.quantity, range);
                self.keep(&name(&shown.name), drawn)?;
            }
        }
        Ok(())
    }

    /// Returns what pictures show, by what is added to their names: everything, and around the exit of a fibre.
    fn windows(&self, mesh: &PictureMesh) -> Vec<(&'static str, Option<Window>)> {
        let around_exit = self.fibre.as_ref().and_then(|fibre| {
            let whole = Window::around(&mesh.nodes)?;
            let [x, y] = self.mesh.nodes()[fibre.exit_node];
            let reach = 2.0 * ZOOM * fibre.radius;
            let within =
                |at: f64, range: &std::ops::Range<f64>| (at - reach).max(range.start)..(at + reach).min(range.end);
            Some(Window { x: within(x, &whole.x), y: within(y, &whole.y) })
        });
        let zoom = around_exit.map(|window| ("_exit", Some(window)));
        std::iter::once(("", None)).chain(zoom).collect()
    }

    /// The fibre's axial stress along its axis.
    fn axial_stress(&mut self, moments: &[Moment<'_>]) -> io::Result<()> {
        let Some(fibre) = &self.fibre else { return Ok(()) };
        let elements = self.mesh.elements().iter().filter(|element| element.part() == fibre.part).count();
        let mut lines = Vec::new();
        for (k, moment) in moments.iter().enumerate() {
            let sections = elements.min(MOST_SECTIONS);
            let points =
                axial_stress(self.mesh, &moment.state.fields, fibre.part, &fibre.axis, sections).map_err(unfit)?;
            let columns = ("arc".to_owned(), moment.suffix.clone());
            lines.push(Line {
                label: moment.title("").trim_start_matches(", ").into(),
                points,
                columns,
                style: Style { color: k, dash: k },
                ..Line::default()
            });
        }
        self.keep_figure(&Figure {
            name: "axial_stress".into(),
            title: "Axial stress of the fibre".into(),
            x: Quantity { name: ALONG_FIBRE.into(), unit: "mm".into() },
            y: Quantity { name: "axial stress".into(), unit: "MPa".into() },
            lines,
            ..Figure::default()
        })
    }

    /// Shear and pressure along the interface: a colour for each moment, a dash for each pair. Along a fibre the walls of
    /// the hole have a common coordinate, and shear that resists the pull is positive.
    fn interface(&mut self, moments: &[Moment<'_>]) -> io::Result<()> {
        let mut figures: Vec<Figure> = Vec::new();
        for (color, moment) in moments.iter().enumerate() {
            for mut figure in interface_profiles(&moment.state.fields) {
                for (dash, line) in figure.lines.iter_mut().enumerate() {
                    if let Some(Some(wall)) = self.walls.get(dash) {
                        let sign = if figure.name == INTERFACE_SHEAR { wall.direction } else { 1.0 };
                        line.points.iter_mut().for_each(|(x, y)| (*x, *y) = (wall.along_fibre(*x), sign * *y));
                        figure.x.name = ALONG_HOLE.into();
                    }
                    line.label = format!("{}, {}", line.label, moment.words);
                    line.style = Style { color, dash };
                }
                match figures.iter_mut().find(|other| other.name == figure.name) {
                    Some(other) => other.lines.append(&mut figure.lines),
                    None => figures.push(figure),
                }
            }
        }
        for mut figure in figures {
            figure.lines.retain(|line| line.points.iter().any(|(_, value)| value.is_finite()));
            figure.title = format!("{} along the interface", capital(&figure.y.name));
            self.keep_figure(&figure)?;
        }
        Ok(())
    }

    fn keep_figure(&mut self, figure: &Figure) -> io::Result<()> {
        if figure.lines.is_empty() {
            return Ok(());
        }
        self.drawings.keep(self.directory, FOLDER, &figure.name, figure.svg())
    }

    /// Keeps a picture of a field, unless there was nothing to draw.
    fn keep(&mut self, name: &str, drawn: Result<String, PictureError>) -> io::Result<()> {
        match drawn {
            Err(PictureError::Nothing) => Ok(()),
            drawn => {
                let before = self.drawings.pictures.len();
                self.drawings.keep(self.directory, FOLDER, name, drawn)?;
                self.drawings.pictures.iter_mut().skip(before).for_each(|picture| picture.is_field = true);
                Ok(())
            }
        }
    }
}

/// Values at nodes, and how they are shown.
struct Contour {
    name: String,
    what: String,
    values: Vec<f64>,
    quantity: Quantity,
    /// Whether the range of the colours is that of the matrix where it is shown, instead of that of all that is shown.
    follows_matrix: bool,
    /// Differences that say nothing.
    negligible: f64,
}

impl Contour {
    /// Returns whether all that is shown has one colour, apart from differences too small to matter.
    fn is_constant(&self, mesh: &PictureMesh, window: Option<&Window>) -> bool {
        let places = mesh.nodes.iter().zip(&self.values).filter(|(node, _)| is_shown(**node, window));
        let (least, greatest) = extremes(places.map(|(_, value)| *value).filter(|value| value.is_finite()));
        greatest - least <= self.negligible || least > greatest
    }

    fn range(
        &self,
        recovery: &Recovery,
        mesh: &PictureMesh,
        matrix: &BTreeSet<usize>,
        window: Option<&Window>,
    ) -> Option<(f64, f64)> {
        if !self.follows_matrix {
            return None;
        }
        let parts = recovery.parts();
        let values = (0..self.values.len()).filter(|&k| matrix.contains(&parts[k]) && is_shown(mesh.nodes[k], window));
        let (least, greatest) = extremes(values.map(|k| self.values[k]).filter(|value| value.is_finite()));
        (least < greatest).then_some((least, greatest))
    }
}

/// Returns whether a place is within what a picture shows.
fn is_shown([x, y]: [f64; 2], window: Option<&Window>) -> bool {
    window.is_none_or(|window| window.x.contains(&x) && window.y.contains(&y))
}

/// The greatest principal stress in magnitude.
fn magnitude(principal: &Principal) -> f64 {
    principal.maximum.abs().max(principal.minimum.abs())
}

/// Returns the damages to draw: the total damage if the law reports it, otherwise all.
fn damages<'n>(names: &[&'n str]) -> Vec<&'n str> {
    let damages: Vec<&str> = names.iter().copied().filter(|name| group_of(name) == Group::Damage).collect();
    let total: Vec<&str> = damages.iter().copied().filter(|name| is_total(name)).collect();
    if total.is_empty() { damages } else { total }
}

/// Returns whether a state is the damage as a whole, not that of one direction or cause.
pub(crate) fn is_total(name: &str) -> bool {
    matches!(name, "D" | "d" | "damage")
}

/// Returns the fibre, and how the slave surface of each pair lies along it.
pub(crate) fn walls(model: &Model) -> (Option<FibreGeometry>, Vec<Option<Wall>>) {
    let fibre = FibreGeometry::of(model);
    let walls = model.contacts.iter().map(|pair| Wall::of(fibre.as_ref()?, &model.mesh, &pair.slave)).collect();
    (fibre, walls)
}

/// Returns the parts that carry contact points: fibres are stressed so much more that colours follow these parts.
pub(crate) fn matrix(model: &Model) -> BTreeSet<usize> {
    let slaves = model.contacts.iter().flat_map(|pair| &pair.slave);
    slaves.map(|edge| model.mesh.elements()[edge.element].part()).chain(model.parts_behind()).collect()
}

fn unfit(error: FieldsError) -> io::Error {
    io::Error::other(error)
}

#[cfg(test)]
mod test;
