//! Work of a crack and its greatest stress, by quadrature of σ(w) itself: the openings of the results do not matter.

use crate::quadrature::{maximum, rule};
use crate::{Composite, Polyline, averages};

/// Panels of a stretch to begin with.
const PANELS: usize = 2;
/// A panel is halved until its halves agree with it to this part of the work, or to that to which the averages agree if it is more.
const AGREEMENT: f64 = 1e-8;
/// A jump is enclosed by so many halvings.
const HALVINGS: usize = 40;
/// Openings after which no panel is halved any more.
const MOST_OPENINGS: usize = 6000;
/// Steps to the greatest stress between two openings.
const STEPS: usize = 16;

/// ∫σ dw from 0 to an opening.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrackWork {
    /// The opening, mm.
    pub to: f64,
    /// The integral, N/mm.
    pub work: f64,
    /// Estimate of its error, N/mm, with that of the averages.
    pub error: f64,
}

/// A stress at an opening.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrackStress {
    /// w, mm.
    pub opening: f64,
    /// Stress, MPa.
    pub stress: f64,
}

/// Numbers of a σ(w) as a whole, up to its last opening.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CrackTotals {
    /// Works up to openings.
    pub work: Vec<CrackWork>,
    /// Greatest σ.
    pub peak: CrackStress,
    /// Greatest σ_f.
    pub fibre_peak: CrackStress,
}

/// A part of a stretch from a to b, where w = a + (b − a) t²: the root with which an elastic fibre begins becomes smooth.
#[derive(Clone, Copy)]
struct Panel {
    stretch: usize,
    from: f64,
    to: f64,
}

/// An integral over stretches, and what it is made of.
struct Integral<'s> {
    stretches: &'s [[f64; 2]],
    /// Integral and its error over each stretch.
    sums: Vec<[f64; 2]>,
    /// Openings and stresses met.
    met: Vec<(f64, f64)>,
}

/// Stresses at openings, each with its error.
type Stresses<'e> = &'e dyn Fn(&[f64]) -> Vec<[f64; 2]>;

impl<'s> Integral<'s> {
    /// Halves panels until none differs from its halves by more than this part of the integral so far.
    fn new(stretches: &'s [[f64; 2]], agreement: f64, stresses: Stresses<'_>) -> Self {
        let mut integral = Self { stretches, sums: vec![[0.0; 2]; stretches.len()], met: Vec::new() };
        let cut = |stretch: usize| {
            let edge = |k: usize| k as f64 / PANELS as f64;
            (0..PANELS).map(move |k| Panel { stretch, from: edge(k), to: edge(k + 1) })
        };
        let mut panels: Vec<Panel> = (0..stretches.len()).flat_map(cut).collect();
        let mut wholes = integral.add(&panels, stresses);
        for _ in 0..HALVINGS {
            let halves: Vec<Panel> = panels.iter().flat_map(Panel::halves).collect();
            let parts = integral.add(&halves, stresses);
            // up to the end of each stretch, by what there is of it
            let mut so_far: Vec<f64> = integral.sums.iter().map(|sum| sum[0]).collect();
            halves.iter().zip(&parts).for_each(|(half, part)| so_far[half.stretch] += part[0]);
            for k in 1..so_far.len() {
                so_far[k] += so_far[k - 1];
            }
            let is_full = integral.met.len() > MOST_OPENINGS;
            let mut open = (Vec::new(), Vec::new());
            for (k, whole) in wholes.iter().enumerate() {
                let stretch = panels[k].stretch;
                let pair = 2 * k..2 * k + 2;
                let [sum, of_stresses] =
                    parts[pair.clone()].iter().fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
                let difference = (sum - whole[0]).abs();
                // what is no number is not halved
                if difference > agreement * so_far[stretch].abs() && !is_full {
                    open.0.extend_from_slice(&halves[pair.clone()]);
                    open.1.extend_from_slice(&parts[pair]);
                } else {
                    integral.sums[stretch][0] += sum;
                    integral.sums[stretch][1] += difference + of_stresses;
                }
            }
            (panels, wholes) = open;
            if panels.is_empty() {
                break;
            }
        }
        // a jump: it lies in what is left
        for (panel, [sum, _]) in panels.iter().zip(&wholes) {
            integral.sums[panel.stretch][0] += sum;
            integral.sums[panel.stretch][1] += sum.abs();
        }
        integral
    }

    /// Integral and its stresses' error over each panel.
    fn add(&mut self, panels: &[Panel], stresses: Stresses<'_>) -> Vec<[f64; 2]> {
        let rule = rule(0);
        let nodes = |panel: &Panel| {
            let [a, b] = self.stretches[panel.stretch];
            let (from, width) = (panel.from, panel.to - panel.from);
            rule.iter().map(move |(node, weight)| {
                let t = from + width * node;
                (a + (b - a) * t * t, 2.0 * (b - a) * t * width * weight)
            })
        };
        let all: Vec<(f64, f64)> = panels.iter().flat_map(nodes).collect();
        let openings: Vec<f64> = all.iter().map(|node| node.0).collect();
        let found = stresses(&openings);
        self.met.extend(openings.iter().zip(&found).map(|(&opening, stress)| (opening, stress[0])));
        let weighted: Vec<[f64; 2]> =
            all.iter().zip(&found).map(|((_, weight), stress)| stress.map(|s| weight * s)).collect();
        let sum = |nodes: &[[f64; 2]]| nodes.iter().fold([0.0; 2], |sum, node| [sum[0] + node[0], sum[1] + node[1]]);
        weighted.chunks(rule.len()).map(sum).collect()
    }
}

impl Panel {
    fn halves(&self) -> [Self; 2] {
        let middle = 0.5 * (self.from + self.to);
        [Self { to: middle, ..*self }, Self { from: middle, ..*self }]
    }
}

/// The greatest stress at and between the neighbours of the opening at which stresses over rising openings are greatest.
fn greatest(stresses: &[(f64, f64)], at: &dyn Fn(f64) -> f64) -> CrackStress {
    let Some(best) = (0..stresses.len()).reduce(|best, k| if stresses[k].1 > stresses[best].1 { k } else { best })
    else {
        return CrackStress::default();
    };
    let opening = stresses[best].0;
    let neighbours = [best.saturating_sub(1), (best + 1).min(stresses.len() - 1)].map(|k| stresses[k].0);
    let [(opening, stress), between] = [(opening, at(opening)), maximum(at, neighbours[0], neighbours[1], STEPS)];
    let (opening, stress) = if between.1 > stress { between } else { (opening, stress) };
    CrackStress { opening, stress }
}

impl Composite {
    /// Returns works up to rising openings above 0, and greatest stresses up to the last of them.
    pub fn totals(&self, ends: &[f64]) -> CrackTotals {
        let last = ends.last().copied().unwrap_or_default();
        let mut edges: Vec<f64> = [0.0, self.activation].into_iter().chain(ends.iter().copied()).collect();
        edges.retain(|edge| *edge <= last);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let stretches: Vec<[f64; 2]> = edges.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        let of_matrix: Stresses<'_> =
            &|openings| openings.iter().map(|&opening| [self.matrix_stress(opening), 0.0]).collect();
        let of_fibres: Stresses<'_> =
            &|openings| averages(self, openings).iter().map(|average| [average.stress, average.error]).collect();
        let agreement = AGREEMENT.max(self.resolution(&self.directions).agreement);
        let matrix = Integral::new(&stretches, AGREEMENT, of_matrix);
        let fibres = Integral::new(&stretches, agreement, of_fibres);
        let work = ends.iter().map(|&to| {
            let within = stretches.iter().take_while(|stretch| stretch[1] <= to).count();
            let sums = matrix.sums[..within].iter().chain(&fibres.sums[..within]);
            let [work, error] = sums.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
            CrackWork { to, work, error }
        });
        // where the quadrature does not look: at the ends
        let mut stresses = fibres.met.clone();
        stresses.extend(averages(self, &edges).iter().map(|average| (average.opening, average.stress)));
        stresses.sort_by(|a, b| a.0.total_cmp(&b.0));
        let fibre = |opening: f64| self.average(opening).stress;
        // the matrix softens between these openings: where the sum is greatest follows from straight lines
        let all = self.with_matrix(&Polyline::new(stresses.iter().copied()));
        let all: Vec<(f64, f64)> = all.points().take_while(|point| point.0 <= last).collect();
        CrackTotals {
            work: work.collect(),
            peak: greatest(&all, &|opening| fibre(opening) + self.matrix_stress(opening)),
            fibre_peak: greatest(&stresses, &fibre),
        }
    }
}
