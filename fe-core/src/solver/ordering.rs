//! The order of elimination.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::analysis::cholesky_flops;
use super::cut::{Cut, cut};
use super::graph::{Graph, NodeGraph};
use super::{Pattern, SolverError};

/// Smaller systems are ordered by least degree alone, which is as good there and sooner done.
const LEAST_DISSECTED: usize = 5_000;

/// Parts of fewer nodes are not cut any more.
const LEAST_PART: usize = 100;

/// An order of elimination of all equations, that of least fill known for those outside `last`, and then `last` as
/// they are; and whether it follows cuts, rather than least degree. `nodes` has the node of each equation, `positions` its
/// place, mm, or nothing. The graph of the nodes is ordered and expanded: three times faster than that of the equations.
pub(super) fn elimination_order(
    pattern: &Pattern,
    nodes: &[usize],
    positions: &[[f64; 2]],
    last: &[usize],
) -> Result<(Vec<usize>, bool), SolverError> {
    let nodes = NodeGraph::new(pattern, nodes, last);
    let expanded = |order: Vec<usize>| -> Vec<usize> {
        order.iter().flat_map(|&node| nodes.equations(node)).chain(last).copied().collect()
    };
    let by_degree = expanded(least_degree(&nodes.graph)?);
    if positions.is_empty() || pattern.size() < LEAST_DISSECTED {
        return Ok((by_degree, false));
    }
    let mut dissected = Vec::with_capacity(nodes.graph.len());
    let all = (0..nodes.graph.len()).collect();
    dissect(&nodes.graph, &nodes.positions(positions), all, &mut dissected)?;
    let dissected = expanded(dissected);
    let is_better = cholesky_flops(pattern, &dissected)? < cholesky_flops(pattern, &by_degree)?;
    Ok((if is_better { dissected } else { by_degree }, is_better))
}

/// Approximate minimum degree.
fn least_degree(graph: &Graph) -> Result<Vec<usize>, SolverError> {
    let count = graph.len();
    let (starts, neighbours) = graph.raw();
    let matrix = SymbolicSparseColMatRef::new_unsorted_checked(count, count, starts, None, neighbours);
    let (mut order, mut places) = (vec![0; count], vec![0; count]);
    let mut memory = MemBuffer::try_new(amd::order_maybe_unsorted_scratch::<usize>(count, neighbours.len()))?;
    amd::order_maybe_unsorted(&mut order, &mut places, matrix, amd::Control::default(), MemStack::new(&mut memory))?;
    Ok(order)
}

/// Nested dissection (George 1973): what separates two parts is eliminated after both, and so in each part. Fill stays
/// in the parts and among the cuts around them: n^{3/2} operations in the plane. `names` of the nodes are written.
fn dissect(
    graph: &Graph,
    positions: &[[f64; 2]],
    names: Vec<usize>,
    order: &mut Vec<usize>,
) -> Result<(), SolverError> {
    let cut = if graph.len() < LEAST_PART { None } else { cut(graph, positions) };
    let Some(Cut { halves, between }) = cut else {
        order.extend(least_degree(graph)?.into_iter().map(|node| names[node]));
        return Ok(());
    };
    for half in halves {
        let part = graph.restricted_to(&half);
        let part_positions: Vec<_> = half.iter().map(|&node| positions[node]).collect();
        dissect(&part, &part_positions, half.iter().map(|&node| names[node]).collect(), order)?;
    }
    order.extend(between.into_iter().map(|node| names[node]));
    Ok(())
}
