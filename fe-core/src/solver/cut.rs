//! Cuts bodies in two: the order of nodes along some direction, and where few nodes lie between the halves.

use std::f64::consts::PI;

use super::Pattern;
use super::analysis::NONE;

/// How many directions are tried, over half a turn.
const DIRECTIONS: usize = 8;

/// The least part of the nodes that a half may have. The more the halves differ, the longer one thread waits.
const LEAST_SHARE: f64 = 0.45;

/// The equations on both sides of a cut, and on it: ascending each.
pub(super) struct Cut {
    pub(super) halves: [Vec<usize>; 2],
    pub(super) between: Vec<usize>,
}

/// Where the fewest nodes separate two halves of about equal size; `None` if there are not two. `nodes` has the node of
/// each equation, `positions` its place, mm.
pub(super) fn cut(pattern: &Pattern, nodes: &[usize], positions: &[[f64; 2]]) -> Option<Cut> {
    let graph = NodeGraph::new(pattern, nodes);
    let count = graph.equation_of.len();
    let first = (LEAST_SHARE * count as f64).ceil() as usize;
    let choices = first.max(1)..count.saturating_sub(first);
    if choices.is_empty() {
        return None;
    }
    let mut best: Option<([usize; 2], usize, Vec<usize>)> = None;
    for direction in 0..DIRECTIONS {
        let (sine, cosine) = (PI * direction as f64 / DIRECTIONS as f64).sin_cos();
        let ranks = graph.ranks(|equation| cosine * positions[equation][0] + sine * positions[equation][1]);
        let between = graph.between(pattern, &ranks);
        // the fewest nodes between, and of equal cuts the most equal halves
        let cost = |place: usize| [between[place], (2 * place).abs_diff(count + between[place])];
        let place = choices.clone().min_by_key(|&place| cost(place))?;
        if best.as_ref().is_none_or(|(least, ..)| cost(place) < *least) {
            best = Some((cost(place), place, ranks));
        }
    }
    let (_, place, ranks) = best?;
    Some(graph.split(pattern, &ranks, place))
}

/// The nodes, numbered as they come, and their equations.
struct NodeGraph {
    node_of: Vec<usize>,
    /// The first equation of each node: its column has the equations of all neighbours.
    equation_of: Vec<usize>,
}

impl NodeGraph {
    fn new(pattern: &Pattern, nodes: &[usize]) -> Self {
        let mut numbers = vec![NONE; nodes.iter().max().map_or(0, |node| node + 1)];
        let (mut node_of, mut equation_of) = (Vec::with_capacity(pattern.size()), Vec::new());
        for (equation, &node) in nodes.iter().enumerate() {
            if numbers[node] == NONE {
                numbers[node] = equation_of.len();
                equation_of.push(equation);
            }
            node_of.push(numbers[node]);
        }
        Self { node_of, equation_of }
    }

    /// The place of each node in the order of a coordinate.
    fn ranks(&self, coordinate: impl Fn(usize) -> f64) -> Vec<usize> {
        let coordinates: Vec<f64> = self.equation_of.iter().map(|&equation| coordinate(equation)).collect();
        let mut order: Vec<usize> = (0..coordinates.len()).collect();
        order.sort_by(|&a, &b| coordinates[a].total_cmp(&coordinates[b]));
        let mut ranks = vec![0; order.len()];
        order.iter().enumerate().for_each(|(rank, &node)| ranks[node] = rank);
        ranks
    }

    /// The greatest rank of a node and its neighbours.
    fn reach(&self, pattern: &Pattern, ranks: &[usize], node: usize) -> usize {
        let neighbours = pattern.column(self.equation_of[node]).iter().map(|&row| ranks[self.node_of[row]]);
        neighbours.fold(ranks[node], usize::max)
    }

    /// For each number of nodes before a cut: how many of them have a neighbour behind it.
    fn between(&self, pattern: &Pattern, ranks: &[usize]) -> Vec<usize> {
        let mut changes = vec![0_isize; ranks.len() + 2];
        for node in 0..ranks.len() {
            // cut off from its farthest neighbour by cuts with rank + 1 to reach nodes before them
            changes[ranks[node] + 1] += 1;
            changes[self.reach(pattern, ranks, node) + 1] -= 1;
        }
        let mut sum = 0;
        let sums = changes.iter().map(|change| {
            sum += change;
            sum.unsigned_abs()
        });
        sums.collect()
    }

    /// Cuts behind `place` nodes.
    fn split(&self, pattern: &Pattern, ranks: &[usize], place: usize) -> Cut {
        let mut cut = Cut { halves: [Vec::new(), Vec::new()], between: Vec::new() };
        let is_between: Vec<bool> =
            (0..ranks.len()).map(|node| ranks[node] < place && self.reach(pattern, ranks, node) >= place).collect();
        for (equation, &node) in self.node_of.iter().enumerate() {
            if is_between[node] {
                cut.between.push(equation);
            } else {
                cut.halves[usize::from(ranks[node] >= place)].push(equation);
            }
        }
        cut
    }
}
