//! Cuts bodies in two: the order of nodes along some direction, and where few nodes lie between the halves.

use std::f64::consts::PI;

use super::graph::Graph;

/// Number of directions that are tried, over half a turn.
const DIRECTIONS: usize = 8;

/// The least part of the nodes that a half may have. The more the halves differ, the longer one thread waits.
const LEAST_SHARE: f64 = 0.45;

/// The nodes on both sides of a cut, and on it: ascending each.
pub(super) struct Cut {
    pub(super) halves: [Vec<usize>; 2],
    pub(super) between: Vec<usize>,
}

/// Returns where the fewest nodes separate two halves of about equal size; `None` if there are no two halves.
/// `positions`: those of the nodes, mm.
pub(super) fn cut(graph: &Graph, positions: &[[f64; 2]]) -> Option<Cut> {
    let count = graph.len();
    let first = (LEAST_SHARE * count as f64).ceil() as usize;
    let choices = first.max(1)..count.saturating_sub(first);
    if choices.is_empty() {
        return None;
    }
    let mut best: Option<([usize; 2], usize, Vec<usize>)> = None;
    for direction in 0..DIRECTIONS {
        let (sine, cosine) = (PI * direction as f64 / DIRECTIONS as f64).sin_cos();
        let ranks = ranks(positions.iter().map(|[x, y]| cosine * x + sine * y).collect());
        let between = between(graph, &ranks);
        // the fewest nodes between, and of equal cuts the most equal halves
        let cost = |place: usize| [between[place], (2 * place).abs_diff(count + between[place])];
        let place = choices.clone().min_by_key(|&place| cost(place))?;
        if best.as_ref().is_none_or(|(least, ..)| cost(place) < *least) {
            best = Some((cost(place), place, ranks));
        }
    }
    let (_, place, ranks) = best?;
    Some(split(graph, &ranks, place))
}

/// The place of each node in the order of a coordinate.
fn ranks(coordinates: Vec<f64>) -> Vec<usize> {
    let mut order: Vec<usize> = (0..coordinates.len()).collect();
    order.sort_by(|&a, &b| coordinates[a].total_cmp(&coordinates[b]));
    let mut ranks = vec![0; order.len()];
    order.iter().enumerate().for_each(|(rank, &node)| ranks[node] = rank);
    ranks
}

/// The greatest rank of a node and its neighbours.
fn reach(graph: &Graph, ranks: &[usize], node: usize) -> usize {
    graph.neighbours(node).iter().map(|&other| ranks[other]).fold(ranks[node], usize::max)
}

/// Counts, for each number of nodes before a cut, how many of them have a neighbour after it.
fn between(graph: &Graph, ranks: &[usize]) -> Vec<usize> {
    let mut changes = vec![0_isize; ranks.len() + 2];
    for node in 0..ranks.len() {
        // cut off from its farthest neighbour by cuts with rank + 1 to reach nodes before them
        changes[ranks[node] + 1] += 1;
        changes[reach(graph, ranks, node) + 1] -= 1;
    }
    let mut sum = 0;
    let sums = changes.iter().map(|change| {
        sum += change;
        sum.unsigned_abs()
    });
    sums.collect()
}

/// Cuts after `place` nodes.
fn split(graph: &Graph, ranks: &[usize], place: usize) -> Cut {
    let mut cut = Cut { halves: [Vec::new(), Vec::new()], between: Vec::new() };
    for node in 0..ranks.len() {
        if ranks[node] < place && reach(graph, ranks, node) >= place {
            cut.between.push(node);
        } else {
            cut.halves[usize::from(ranks[node] >= place)].push(node);
        }
    }
    cut
}
