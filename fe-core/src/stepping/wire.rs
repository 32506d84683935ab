//! What the wires of fibres carry along their axes.

use super::{Snapshot, WireRecord};
use crate::model::{Model, Wire, WireSection};
use serde::{Deserialize, Serialize};

/// How far the sections of the wires are stretched as a whole.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Stretches {
    /// Those of each wire's sections.
    wires: Vec<Vec<Stretch>>,
}

/// Stress 11, 22, 33, 12 of a point of an element, MPa.
type PointStress<'a> = dyn Fn(usize, usize) -> [f64; 4] + 'a;

/// A section between two stations of a wire.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Stretch {
    /// Lengths of its left side, its axis and its right side, mm.
    lengths: [f64; 3],
    /// Logarithmic strain that all three have in common, increment by increment. Where a wire is bent under tension the neutral axis is not
    /// that of the wire, which is stretched, too, while one of the sides gets shorter: that does not count.
    common: f64,
}

impl Stretches {
    /// Adds what an increment did that led to these displacements.
    pub(super) fn advance(&mut self, model: &Model, displacements: &[f64]) {
        let wires = &model.measured.wires;
        if self.wires.len() != wires.len() {
            let virgin = |section| Stretch { lengths: Shape::new(model, section, None).lengths(), common: 0.0 };
            self.wires = wires.iter().map(|wire| wire.sections.iter().map(virgin).collect()).collect();
        }
        for (wire, stretches) in wires.iter().zip(&mut self.wires) {
            for (section, stretch) in wire.sections.iter().zip(stretches) {
                let end = Shape::new(model, section, Some(displacements)).lengths();
                let [left, axis, right] = std::array::from_fn(|side| (end[side] / stretch.lengths[side]).ln());
                stretch.common += common(common(left, right), axis);
                stretch.lengths = end;
            }
        }
    }

    /// Returns the greatest strain and stress among the sections of each wire.
    pub(super) fn records(&self, snapshot: &Snapshot<'_>) -> Vec<WireRecord> {
        let solids = snapshot.solids();
        let stress = |element, point| solids.point(element, point).stress;
        self.with_stresses(snapshot, &stress).map(|(_, record)| record).collect()
    }

    /// Returns how much of what breaks it the wire carries that is nearest to breaking, at the committed state and at the end of an
    /// increment that converged: 1 where it breaks.
    pub(super) fn utilisations(&self, committed: &Snapshot<'_>, trial: &Snapshot<'_>) -> [f64; 2] {
        if !committed.model().measured.wires.iter().any(Wire::has_limits) {
            return [0.0; 2];
        }
        let mut end = self.clone();
        end.advance(committed.model(), trial.displacements());
        let solids = committed.solids();
        let before = self.greatest_utilisation(committed, &|element, point| solids.point(element, point).stress);
        [before, end.greatest_utilisation(trial, &|element, point| solids.trial_stress(element, point))]
    }

    fn greatest_utilisation(&self, snapshot: &Snapshot<'_>, stress: &PointStress<'_>) -> f64 {
        let wires = self.with_stresses(snapshot, stress);
        wires.map(|(wire, WireRecord { strain, stress })| wire.utilisation(strain, stress)).fold(0.0, f64::max)
    }

    /// Each wire with its greatest strain and stress.
    fn with_stresses<'a>(
        &'a self,
        snapshot: &'a Snapshot<'a>,
        stress: &'a PointStress<'a>,
    ) -> impl Iterator<Item = (&'a Wire, WireRecord)> {
        let of = |index: usize| self.wires.get(index).map_or(&[][..], Vec::as_slice);
        let wires = snapshot.model().measured.wires.iter().enumerate();
        wires.map(move |(index, wire)| (wire, record(wire, of(index), snapshot, stress)))
    }
}

/// What two changes of length have in common: the smaller one, nothing if one grows and the other shrinks.
fn common(a: f64, b: f64) -> f64 {
    if a * b <= 0.0 {
        0.0
    } else if a.abs() < b.abs() {
        a
    } else {
        b
    }
}

fn position(model: &Model, node: usize, displacements: Option<&[f64]>) -> [f64; 2] {
    let [x, y] = model.mesh.nodes()[node];
    displacements.map_or([x, y], |u| [x + u[2 * node], y + u[2 * node + 1]])
}

/// Where the stations of a section are.
struct Shape {
    /// From the first station to the second, mm: on the left side, on the axis and on the right side.
    chords: [[f64; 2]; 3],
    /// The middle of the section.
    middle: [f64; 2],
    /// From the left side to the right side, mean of both stations, mm.
    across: [f64; 2],
}

impl Shape {
    fn new(model: &Model, section: &WireSection, displacements: Option<&[f64]>) -> Self {
        let [from, to] = section.ends.map(|station| station.map(|node| position(model, node, displacements)));
        let half_of_both = |f: &dyn Fn([[f64; 2]; 3], usize) -> f64| [0, 1].map(|k| 0.5 * (f(from, k) + f(to, k)));
        Self {
            chords: std::array::from_fn(|side| [to[side][0] - from[side][0], to[side][1] - from[side][1]]),
            middle: half_of_both(&|station, k| station[1][k]),
            across: half_of_both(&|station, k| station[2][k] - station[0][k]),
        }
    }

    /// Unit vector along the section, at right angles to its stations: it turns with them, and shear does not change lengths along it.
    fn along(&self) -> [f64; 2] {
        let [x, y] = self.across;
        let width = x.hypot(y);
        let [x, y] = [-y / width, x / width];
        let [_, [u, v], _] = self.chords;
        // from the first station to the second
        let sense = (x * u + y * v).signum();
        [sense * x, sense * y]
    }

    /// Lengths of the left side, the axis and the right side, mm.
    fn lengths(&self) -> [f64; 3] {
        let [x, y] = self.along();
        self.chords.map(|[u, v]| x * u + y * v)
    }

    /// Length of the section at a point, mm.
    fn length_at(&self, [x, y]: [f64; 2]) -> f64 {
        let ([u, v], [left, axis, right]) = (self.across, self.lengths());
        let share = 2.0 * ((x - self.middle[0]) * u + (y - self.middle[1]) * v) / (u * u + v * v);
        axis + share.abs().min(1.0) * (if share < 0.0 { left } else { right } - axis)
    }
}

fn record(wire: &Wire, stretches: &[Stretch], snapshot: &Snapshot<'_>, stress: &PointStress<'_>) -> WireRecord {
    let stresses = wire.sections.iter().map(|section| nominal_stress(section, snapshot, stress));
    let initial = |section| Shape::new(snapshot.model(), section, None).lengths()[1];
    let lengths = wire.sections.iter().zip(stretches).map(|(section, stretch)| {
        let length = initial(section);
        [length, length * stretch.common.exp_m1()]
    });
    WireRecord { strain: elongation(&lengths.collect::<Vec<_>>(), wire.gauge), stress: stresses.fold(0.0, f64::max) }
}

/// Returns the greatest mean strain of neighbouring sections over at least a gauge length, of all if they are shorter; each has a
/// length and what it has become longer by.
fn elongation(sections: &[[f64; 2]], gauge: f64) -> f64 {
    let mut greatest: f64 = 0.0;
    let (mut first, mut sum) = (0, [0.0; 2]);
    for (last, [length, growth]) in sections.iter().enumerate() {
        sum = [sum[0] + length, sum[1] + growth];
        while first < last && sum[0] - sections[first][0] >= gauge {
            sum = [sum[0] - sections[first][0], sum[1] - sections[first][1]];
            first += 1;
        }
        if sum[0] >= gauge || last + 1 == sections.len() {
            greatest = greatest.max(sum[1] / sum[0]);
        }
    }
    greatest
}

/// Mean stress of a section along its axis, on its initial area, MPa.
fn nominal_stress(section: &WireSection, snapshot: &Snapshot<'_>, stress: &PointStress<'_>) -> f64 {
    let (model, solids) = (snapshot.model(), snapshot.solids());
    let is_large = section.elements.iter().any(|&element| model.nlgeom[model.mesh.elements()[element].part()]);
    let moved = is_large.then(|| snapshot.displacements());
    let [before, after] = [None, moved].map(|displacements| Shape::new(model, section, displacements));
    let [a, b] = after.along();
    // areas, not volumes: in a bend the outer side is longer, and its stress would count for more
    let (mut force, mut area) = (0.0, 0.0);
    for &element in &section.elements {
        let nodes = model.mesh.elements()[element].nodes();
        let at = nodes.iter().fold([0.0; 2], |[x, y], &node| {
            let [u, v] = position(model, node, moved);
            [x + u, y + v]
        });
        let length = after.length_at(at.map(|sum| sum / nodes.len() as f64));
        for point in 0..solids.point_count(element) {
            let [s11, s22, _, s12] = stress(element, point);
            let part = solids.point(element, point).volume / length;
            force += part * (s11 * a * a + s22 * b * b + 2.0 * s12 * a * b);
            area += part;
        }
    }
    // metal keeps its volume where it yields: its area shrinks as it gets longer
    if area == 0.0 { 0.0 } else { force / area * before.lengths()[1] / after.lengths()[1] }
}

#[cfg(test)]
mod test {
    use super::{common, elongation};

    #[test]
    fn bending_has_no_stretch_in_common() {
        assert_eq!([common(0.1, -0.2), common(0.1, 0.3), common(-0.2, -0.1), common(0.0, 1.0)], [0.0, 0.1, -0.1, 0.0]);
    }

    /// Sections of 1, 1, 2 and 1 mm, of which the second is twice as long: over 2 mm that is 1/2, over 3 mm 1/3, over all of them 1/5.
    #[test]
    fn an_elongation_is_the_greatest_mean_over_a_gauge_length() {
        let sections = [[1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [1.0, 0.0]];
        assert_eq!([1.0, 2.0, 3.0, 9.0].map(|gauge| elongation(&sections, gauge)), [1.0, 0.5, 1.0 / 3.0, 0.2]);
        assert_eq!(elongation(&[], 1.0), 0.0);
    }
}
