//! Fibres of any shape in a block, pulled out of one of its faces.

mod check;
mod divisions;
mod outline;
mod path;
mod sets;
#[cfg(test)]
mod test;

use std::collections::BTreeSet;

use super::perpendicular_fibre::fibre_thickness;
use super::thickness::{Exit, GradedThickness, Thickness};
use super::{ContactSurfaces, PulledFibre, Specimen, SpecimenError, SurfaceRole};
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::structured::MeshBlock;
use crate::mesh::{MeshDefinition, Part};
use crate::schema::{count, positive};
use divisions::Divisions;
use outline::Outline;
use path::Path;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use path::Segment;

/// Length of an embedded fibre that is meshed finely at its exit unless one is given, in diameters.
pub const FINE_DIAMETERS: f64 = 5.0;
/// An element turns by no more than this on a curve inside the block, rad: five elements to a right angle.
const TURN: f64 = 0.35;
/// Elements at least between the walls of two fibres.
const BETWEEN: f64 = 3.0;

/// Round fibres in a block, for [`fibres`]. Its defaults are the block of chapter 7 without fibres.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
pub struct Fibres {
    /// Width of the block.
    #[schemars(schema_with = "positive")]
    pub width: f64,
    /// Depth of the block.
    #[schemars(schema_with = "positive")]
    pub depth: f64,
    /// Thickness of the block.
    #[schemars(schema_with = "positive")]
    pub matrix_thickness: f64,
    /// Whether there is concrete on both faces of the fibres, out of plane.
    #[serde(skip)]
    pub cover: bool,
    /// Make the block as thick as the fibres at the exit face, and thicker with the depth below it: min(t, φ + 2 slope ·
    /// depth), as a cone around each fibre would be (default: the same thickness everywhere).
    pub graded_thickness: Option<GradedThickness>,
    /// The fibres: in any order, with different names.
    #[serde(skip)]
    pub fibres: Vec<Fibre>,
    /// Elements of the fibres.
    pub fibre_element: ElementKind,
    /// Elements of the matrix, T6 or T3.
    pub matrix_element: ElementKind,
    /// Sizes.
    #[serde(flatten)]
    pub mesh: FibresMesh,
}

/// A fibre by the line of its axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Fibre {
    /// Name; `None` of a fibre that is alone.
    pub name: Option<String>,
    /// Diameter φ, mm.
    pub diameter: f64,
    /// Diameters that differ from φ, as a line through (distance from the embedded end along the axis, diameter), mm, ascending:
    /// an enlarged end. The thickness is that of φ.
    pub profile: Vec<[f64; 2]>,
    /// Place where its axis crosses the exit face, mm from the middle of the block.
    pub exit: f64,
    /// Angle of the axis from the outward normal of the exit face where it begins, at the embedded end, rad: positive to the
    /// right.
    pub lean: f64,
    /// The axis from the embedded end to the grip.
    pub path: Vec<Segment>,
    /// Length of the axis inside the block, mm.
    pub embedded_length: f64,
    /// Length by which the hole is longer than the fibre, mm.
    pub tail_gap: f64,
    /// Radius of the hole's edges at the exit face, mm; `None`: φ/4.
    pub exit_radius: Option<f64>,
    /// Length over which the fibre separates from the matrix at its exit (6.27), mm; 0: none.
    pub separation_length: f64,
    /// Length of the fibre inside the block that has the size of the exit, mm; `None`: [`FINE_DIAMETERS`] φ.
    pub fine_length: Option<f64>,
    /// Length at the embedded end whose sizes do not follow `fine_length`, mm: that of a hook, so that a longer pull has the same
    /// curve.
    pub hook_length: f64,
}

/// Sizes of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
pub struct FibresMesh {
    /// Factor on all sizes.
    #[serde(rename = "mesh_size")]
    #[schemars(schema_with = "positive")]
    pub size: f64,
    /// Elements across each fibre.
    #[schemars(schema_with = "count")]
    pub elements_across: usize,
    /// Size along the fibres where they cross the exit (default a quarter of the diameter).
    #[schemars(schema_with = "positive")]
    pub exit_size: Option<f64>,
    /// Largest size along the fibres.
    #[schemars(schema_with = "positive")]
    pub largest_fibre_size: f64,
    /// Growth of the elements' size per length.
    #[schemars(schema_with = "positive")]
    pub growth_rate: f64,
    /// Largest size.
    #[schemars(schema_with = "positive")]
    pub largest_size: f64,
}

impl Default for FibresMesh {
    fn default() -> Self {
        Self {
            size: 1.0,
            elements_across: 2,
            exit_size: None,
            largest_fibre_size: 0.5,
            growth_rate: 0.3,
            largest_size: 2.0,
        }
    }
}

impl Default for Fibres {
    fn default() -> Self {
        Self {
            width: 25.4,
            depth: 12.7,
            matrix_thickness: 3.26,
            cover: false,
            graded_thickness: None,
            fibres: Vec::new(),
            fibre_element: ElementKind::Q8,
            matrix_element: ElementKind::T6,
            mesh: FibresMesh::default(),
        }
    }
}

impl Fibre {
    /// A fibre of chapter 7 without a name that crosses the middle of the face: diameter 0.406 mm, embedded over 12.2 mm.
    pub fn new(lean: f64, path: Vec<Segment>) -> Self {
        Self {
            name: None,
            diameter: 0.406,
            profile: Vec::new(),
            exit: 0.0,
            lean,
            path,
            embedded_length: 12.2,
            tail_gap: 0.0,
            exit_radius: None,
            separation_length: 0.0,
            fine_length: None,
            hook_length: 0.0,
        }
    }

    /// Makes an initially bent fibre that leans by an angle inside the block. From the face on its axis curves to the
    /// outward normal with a radius (`None`: 1.5 φ), and continues along the normal for a length, mm.
    pub fn bent(angle: f64, radius: Option<f64>, length: f64) -> Self {
        let fibre = Self::new(angle, Vec::new());
        let bend = Segment::Arc { radius: radius.unwrap_or(1.5 * fibre.diameter), to: 0.0 };
        let path = vec![Segment::Straight { length: fibre.embedded_length }, bend, Segment::Straight { length }];
        Self { path, ..fibre }
    }

    /// [`Self::new`] that leans by an angle and goes on outside for a length, mm (initially straight): 0 is loading at the exit
    /// (A), more is loading outside (B).
    pub fn straight(angle: f64, length: f64) -> Self {
        let fibre = Self::new(angle, Vec::new());
        let path = vec![Segment::Straight { length: fibre.embedded_length }, Segment::Straight { length }];
        Self { path, ..fibre }
    }

    /// The name of a set or part: `base_rest` of a fibre that is alone, `base.NAME.rest` of one with a name.
    fn set(&self, base: &str, rest: &str) -> String {
        let named = match &self.name {
            Some(name) => format!("{base}.{name}"),
            None => base.to_owned(),
        };
        let between = if self.name.is_some() { '.' } else { '_' };
        if rest.is_empty() { named } else { format!("{named}{between}{rest}") }
    }

    /// The name of a contact pair: `base_side` of a fibre that is alone; `NAME.side` of the interface of one with a name,
    /// `NAME.base.side` of its other surfaces.
    fn pair(&self, base: &str, side: &str) -> String {
        match (&self.name, base) {
            (None, _) => format!("{base}_{side}"),
            (Some(name), "interface") => format!("{name}.{side}"),
            (Some(name), _) => format!("{name}.{base}.{side}"),
        }
    }

    fn exit_radius(&self) -> f64 {
        self.exit_radius.unwrap_or(0.25 * self.diameter)
    }

    fn fine_length(&self) -> f64 {
        self.fine_length.unwrap_or_else(|| self.usual_fine_length())
    }

    fn usual_fine_length(&self) -> f64 {
        (FINE_DIAMETERS * self.diameter).min(self.embedded_length)
    }

    /// Half of the width at an arc length of the axis from the exit, mm.
    fn half_width(&self, s: f64) -> f64 {
        let from_tail = s + self.embedded_length;
        let after = self.profile.partition_point(|[at, _]| *at <= from_tail);
        let diameter = match (after.checked_sub(1).map(|before| self.profile[before]), self.profile.get(after)) {
            (Some([a, at_a]), Some([b, at_b])) => at_a + (at_b - at_a) * (from_tail - a) / (b - a),
            (None, Some([_, first])) => *first,
            _ => self.diameter,
        };
        0.5 * diameter
    }

    /// Half of the greatest width, mm.
    fn largest_half_width(&self) -> f64 {
        0.5 * self.profile.iter().map(|[_, width]| *width).fold(self.diameter, f64::max)
    }
}

/// A fibre with the line of its axis.
#[derive(Debug)]
struct Laid<'a> {
    fibre: &'a Fibre,
    path: Path,
    /// Distances to the nearest wall of another fibre at arc lengths of the embedded axis, mm; empty for a single
    /// fibre.
    gaps: Vec<[f64; 2]>,
}

impl Laid<'_> {
    /// Returns whether the fibre ends at the exit face, where its end may turn.
    fn hangs(&self) -> bool {
        self.path.end() <= check::SHORTEST * self.fibre.diameter
    }

    /// Arc lengths of its ends.
    fn ends(&self) -> [f64; 2] {
        [-self.fibre.embedded_length, self.path.end()]
    }

    /// Arc lengths at about equal distances of a quarter of the diameter.
    fn samples(&self, [from, to]: [f64; 2]) -> Vec<f64> {
        let count = ((to - from) / (0.25 * self.fibre.diameter)).ceil().clamp(1.0, 1e4);
        (0..=count as usize).map(|k| from + (to - from) * k as f64 / count).collect()
    }

    /// The distance to the nearest wall of another fibre, mm.
    fn gap(&self, s: f64) -> f64 {
        let after = self.gaps.partition_point(|[at, _]| *at < s).min(self.gaps.len().saturating_sub(1));
        self.gaps.get(after).map_or(f64::INFINITY, |[_, gap]| *gap)
    }
}

#[doc = include_str!("doc.md")]
///
/// # Errors
///
/// All parameters that cannot be, or what keeps the block from being meshed.
pub fn fibres(parameters: &Fibres) -> Result<Specimen, SpecimenError> {
    let laid = parameters.laid()?;
    let divisions = laid.iter().map(|laid| Divisions::new(parameters, laid)).collect::<Result<Vec<_>, _>>()?;
    let mut definition = MeshDefinition::default();
    let mut grids = Vec::new();
    let mut pulled = Vec::new();
    for (laid, divisions) in std::iter::zip(&laid, &divisions) {
        let Laid { fibre, path, .. } = laid;
        let thickness = fibre_thickness(fibre.diameter);
        // in plane strain its axial stiffness would be 1/(1 − ν²) of the true one
        let part = definition.add_part(Part::new(fibre.set("fibre", ""), PlaneModel::PlaneStress, thickness));
        let map = |[s, share]: [f64; 2]| path.point(s, 2.0 * share * fibre.half_width(s));
        let block = MeshBlock::new(part, parameters.fibre_element, &divisions.along, &divisions.across);
        let grid = definition.block(&block.mapped(&map))?;
        // the middle between the fibre's sides: `check` has ruled out kinds without a node there
        let at = |station: usize, share| grid.node(2 * station, share).expect("the fibre has nodes on sides and axis");
        let on_axis = |station: usize| at(station, grid.rows);
        let across = |station: usize| [0, grid.rows, 2 * grid.rows].map(|share| at(station, share));
        let (exit_node, tail_node) = (on_axis(divisions.exit_station), on_axis(0));
        definition.node_set(&fibre.set("exit", ""), [exit_node]);
        definition.node_set(&fibre.set("tail", ""), [tail_node]);
        definition.node_set(&fibre.set("fibre", "axis"), (0..divisions.along.len()).map(on_axis));
        sets::name_fibre_sets(&mut definition, fibre, &grid);
        let direction = path.lean(0.0).sin_cos().into();
        pulled.push(PulledFibre {
            name: fibre.name.clone(),
            part,
            diameter: fibre.diameter,
            direction,
            exit_node,
            tail_node,
            stations: (0..divisions.along.len()).map(across).collect(),
            end: ContactSurfaces {
                name: fibre.pair("end", "tail"),
                slave: fibre.set("hole", "end"),
                master: fibre.set("fibre", "tail"),
                role: SurfaceRole::End,
                width: Some(thickness),
            },
        });
        grids.push(grid);
    }
    let matrix = Part::new("matrix", PlaneModel::PlaneStrain, parameters.matrix_thickness);
    let matrix_part = definition.add_part(matrix.clone());
    let outline = Outline::new(parameters, &laid, &divisions)?;
    let (kind, largest_area) = (parameters.matrix_element, parameters.largest_area());
    // each piece of the outline is an edge of a triangle
    let outer = outline.fill(&mut definition, matrix_part, kind, largest_area, &|_| true)?;
    let outer: Vec<_> = outer.into_iter().flatten().collect();
    let edges = outline.surfaces(&outer);
    let contact_pairs = sets::name_surfaces(&mut definition, &parameters.fibres, &edges);
    let thickness = parameters.thickness(&laid);
    let mut covers = Vec::new();
    if parameters.cover {
        let part = definition.add_part(thickness.cover(matrix));
        for (index, laid) in laid.iter().enumerate() {
            let (first, diameter) = (definition.elements.len(), laid.fibre.diameter);
            let channel = outline.channel(parameters, laid, index, &definition, &outer)?;
            let is_there =
                |corners: &[[f64; 2]]| !thickness.is_bare(thickness.mean(ElementKind::T3, corners), diameter);
            channel.fill(&mut definition, part, kind, largest_area, &is_there)?;
            covers.push((first..definition.elements.len(), diameter));
        }
    }
    thickness.assign(&mut definition, matrix_part, &covers);
    let mut notes = thickness.notes(parameters.cover);
    notes.extend(sets::name_supports(&mut definition, parameters, &laid, &edges));
    // fibres that are alike have the same notes
    let mut printed = BTreeSet::new();
    notes.retain(|note| printed.insert(note.clone()));
    // nothing holds the end of a fibre at the face but its own section: it may turn
    let hanging = std::iter::zip(&laid, &grids).filter(|(laid, _)| laid.hangs());
    let couplings = hanging.map(|(laid, grid)| sets::hang_on_a_node(&mut definition, laid.fibre, grid)).collect();
    sets::join_grips(&mut definition, &parameters.fibres);
    Ok(Specimen { definition, pull_direction: [0.0, 1.0], fibres: pulled, contact_pairs, couplings, notes })
}

impl Fibres {
    /// The checked fibres with their axes and the distances between them.
    fn laid(&self) -> Result<Vec<Laid<'_>>, SpecimenError> {
        self.check()?;
        let mut laid: Vec<Laid<'_>> = self.fibres.iter().map(Laid::new).collect();
        self.check_room(&laid)?;
        for index in 0..laid.len() {
            let (own, mut gaps) = (&laid[index], Vec::new());
            let others = || laid.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, other)| other);
            for s in own.samples([own.ends()[0], 0.0]) {
                let gap =
                    others().fold(f64::INFINITY, |least, other| own.gap_within(s, other, 0.0, least).unwrap_or(least));
                if gap.is_finite() {
                    gaps.push([s, gap]);
                }
            }
            laid[index].gaps = gaps;
        }
        Ok(laid)
    }

    fn exit_size(&self, fibre: &Fibre) -> f64 {
        self.mesh.size * self.mesh.exit_size.unwrap_or(0.25 * fibre.diameter)
    }

    /// Returns twice the area of an equilateral triangle of the largest size. Refinement is requested where the sizes
    /// of the outline do not enforce it.
    fn largest_area(&self) -> f64 {
        let size = self.mesh.size * self.mesh.largest_size;
        0.866 * size * size
    }

    /// Size along a fibre at an arc length, mm.
    fn size_along(&self, laid: &Laid<'_>, s: f64) -> f64 {
        let Laid { fibre, path, .. } = laid;
        let growth = self.mesh.growth_rate;
        // past the exit, the curve ends where the rest of the fibre is straight
        let curved_end = path.curves().map(|([_, to], _)| to).fold(0.0, f64::max);
        let fine_end = curved_end + 2.0 * fibre.diameter;
        let largest = self.mesh.size * self.mesh.largest_fibre_size;
        let grown = |fine_length: f64, s: f64| {
            let beyond = (-fine_length - s).max(s - fine_end).max(0.0);
            (self.exit_size(fibre) + growth * beyond).min(largest)
        };
        let usual = |s: f64| grown(fibre.usual_fine_length(), s);
        let hook_end = fibre.hook_length - fibre.embedded_length;
        // in a hook, and from there on as fast as sizes may change
        let kept = if s > hook_end { usual(hook_end) - growth * (s - hook_end) } else { usual(s) };
        let mut size = grown(fibre.fine_length(), s);
        if fibre.hook_length > 0.0 {
            size = size.max(kept);
        }
        for ([from, to], radius) in path.curves().filter(|([from, _], _)| *from < -0.5 * fibre.diameter) {
            let away = (from - s).max(s - to).max(0.0);
            size = size.min(self.mesh.size * TURN * radius + growth * away);
        }
        size.min(laid.gap(s) / BETWEEN).min(largest)
    }

    /// Size in the block at a point, mm.
    fn size_at(&self, laid: &[Laid<'_>], point: [f64; 2]) -> f64 {
        let sizes = laid.iter().map(|laid| {
            let (s, distance) = laid.path.nearest(point, [-laid.fibre.embedded_length, 0.0]);
            let distance = (distance - 0.5 * laid.fibre.diameter).max(0.0);
            self.size_along(laid, s) + self.mesh.growth_rate * distance
        });
        sizes.fold(self.mesh.size * self.mesh.largest_size, f64::min)
    }

    fn thickness(&self, laid: &[Laid<'_>]) -> Thickness {
        let exits = laid.iter().map(|Laid { fibre, path, .. }| Exit {
            position: fibre.exit,
            diameter: fibre.diameter,
            angle: path.lean(0.0).abs(),
        });
        Thickness { full: self.matrix_thickness, exits: exits.collect(), graded: self.graded_thickness }
    }
}

impl<'a> Laid<'a> {
    fn new(fibre: &'a Fibre) -> Self {
        let path = Path::new(fibre.lean, &fibre.path, fibre.embedded_length, fibre.exit);
        Self { fibre, path, gaps: Vec::new() }
    }

    /// The distance between the walls of two fibres at an arc length of this one, of the other's axis up to another, mm, if
    /// it is less than a limit.
    fn gap_within(&self, s: f64, other: &Self, end: f64, limit: f64) -> Option<f64> {
        let (point, own) = (self.path.point(s, 0.0), self.fibre.half_width(s));
        let start = other.ends()[0];
        let farthest = limit + own + other.fibre.largest_half_width();
        let (at, distance) = other.path.nearest_within(point, [start, end], farthest)?;
        let gap = distance - own - other.fibre.half_width(at);
        (gap < limit).then_some(gap)
    }
}
