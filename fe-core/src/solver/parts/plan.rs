//! Plan of the cuts of a matrix.

use super::Substructure;
use super::front::Front;
use super::leaf::Leaf;
use crate::solver::cut::{Cut, cut};
use crate::solver::graph::{Graph, NodeGraph};
use crate::solver::{Pattern, SolverError};
use crate::threads::Threads;

/// Parts of fewer nodes are not cut. Smaller leaves stay more often but solve more slowly: half as many or twice as many
/// nodes make no difference that can be measured.
const LEAST_NODES: usize = 1_500;

/// The most of a part's nodes that a cut may have. In a compact part of that size a line of nodes is 3 % of them.
const LARGEST_CUT: f64 = 0.1;

/// Cuts in two until parts are small; `None` if there is nothing to cut.
pub(super) fn plan(
    pattern: &Pattern,
    nodes: &[usize],
    positions: &[[f64; 2]],
    threads: &Threads,
) -> Result<Option<Box<dyn Substructure>>, SolverError> {
    let graph = NodeGraph::new(pattern, nodes, &[]);
    let planner = Planner { pattern, nodes, positions, graph: &graph, threads };
    let all = (0..graph.graph.len()).collect();
    let (whole, mut leaves) = (planner.part(&graph.graph, &graph.positions(positions), all)?, 0);
    whole.each_leaf(&mut |_| leaves += 1);
    Ok((leaves > 1).then_some(whole))
}

struct Planner<'p> {
    pattern: &'p Pattern,
    nodes: &'p [usize],
    positions: &'p [[f64; 2]],
    graph: &'p NodeGraph,
    threads: &'p Threads,
}

impl Planner<'_> {
    /// The part of these nodes; `names` has them in the whole.
    fn part(
        &self,
        graph: &Graph,
        positions: &[[f64; 2]],
        names: Vec<usize>,
    ) -> Result<Box<dyn Substructure>, SolverError> {
        let is_short = |cut: &Cut| cut.between.len() as f64 <= LARGEST_CUT * graph.len() as f64;
        let cut = if graph.len() < LEAST_NODES { None } else { cut(graph, positions).filter(is_short) };
        let Some(Cut { halves: [first, second], between }) = cut else {
            let inside = self.graph.all_equations(&names);
            return Ok(Box::new(Leaf::new(self.pattern, self.nodes, self.positions, &inside)?));
        };
        let half = |half: &[usize]| {
            let positions: Vec<[f64; 2]> = half.iter().map(|&node| positions[node]).collect();
            self.part(&graph.restricted_to(half), &positions, half.iter().map(|&node| names[node]).collect())
        };
        let (first, second) = self.threads.join(|| half(&first), || half(&second));
        let between: Vec<usize> = between.into_iter().map(|node| names[node]).collect();
        let between = self.graph.all_equations(&between);
        let mut is_inside = vec![false; self.pattern.size()];
        names.iter().flat_map(|&node| self.graph.equations(node)).for_each(|&equation| is_inside[equation] = true);
        Ok(Box::new(Front::new(self.pattern, [first?, second?], &between, |equation| is_inside[equation])?))
    }
}
