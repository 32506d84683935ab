//! The graph of the nodes that equations belong to: a quarter of the couplings of the equations themselves.

use super::Pattern;

/// Marks a place where there is no index.
pub(super) const NONE: usize = usize::MAX;

/// Graph of coupled nodes. Each has its neighbours without itself, in any order.
pub(super) struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<usize>,
}

impl Graph {
    /// Returns how many nodes it has.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn neighbours(&self, node: usize) -> &[usize] {
        &self.neighbours[self.starts[node]..self.starts[node + 1]]
    }

    /// Returns where the neighbours of each node start, and one past the last; all neighbours.
    pub(super) fn raw(&self) -> (&[usize], &[usize]) {
        (&self.starts, &self.neighbours)
    }

    /// The graph between some nodes, in their numbering.
    pub(super) fn restricted_to(&self, nodes: &[usize]) -> Self {
        let mut numbers = vec![NONE; self.len()];
        nodes.iter().enumerate().for_each(|(number, &node)| numbers[node] = number);
        let (mut starts, mut neighbours) = (vec![0], Vec::new());
        for &node in nodes {
            neighbours.extend(self.neighbours(node).iter().map(|&other| numbers[other]).filter(|&other| other != NONE));
            starts.push(neighbours.len());
        }
        Self { starts, neighbours }
    }
}

/// Nodes with their equations.
pub(super) struct NodeGraph {
    pub(super) graph: Graph,
    /// Equations, those of a node together.
    equations: Vec<usize>,
    starts: Vec<usize>,
}

impl NodeGraph {
    /// Makes a node graph of the equations outside `last`. `nodes` has the node of each equation, by any numbering.
    pub(super) fn new(pattern: &Pattern, nodes: &[usize], last: &[usize]) -> Self {
        let mut is_last = vec![false; pattern.size()];
        last.iter().for_each(|&equation| is_last[equation] = true);
        let mut equations: Vec<usize> = (0..pattern.size()).filter(|&equation| !is_last[equation]).collect();
        equations.sort_by_key(|&equation| nodes[equation]);
        let mut starts = Vec::new();
        let mut node_of = vec![NONE; pattern.size()];
        for (place, &equation) in equations.iter().enumerate() {
            if place == 0 || nodes[equation] != nodes[equations[place - 1]] {
                starts.push(place);
            }
            node_of[equation] = starts.len() - 1;
        }
        let count = starts.len();
        starts.push(equations.len());
        let (mut graph_starts, mut neighbours, mut seen) = (vec![0], Vec::new(), vec![NONE; count]);
        for node in 0..count {
            seen[node] = node;
            for &equation in &equations[starts[node]..starts[node + 1]] {
                for &row in pattern.column(equation) {
                    let other = node_of[row];
                    if other != NONE && seen[other] != node {
                        seen[other] = node;
                        neighbours.push(other);
                    }
                }
            }
            graph_starts.push(neighbours.len());
        }
        Self { graph: Graph { starts: graph_starts, neighbours }, equations, starts }
    }

    /// The equations of a node.
    pub(super) fn equations(&self, node: usize) -> &[usize] {
        &self.equations[self.starts[node]..self.starts[node + 1]]
    }

    /// The equations of some nodes, ascending.
    pub(super) fn all_equations(&self, nodes: &[usize]) -> Vec<usize> {
        let mut equations: Vec<usize> = nodes.iter().flat_map(|&node| self.equations(node)).copied().collect();
        equations.sort_unstable();
        equations
    }

    /// The positions of the nodes from those of the equations.
    pub(super) fn positions(&self, of_equations: &[[f64; 2]]) -> Vec<[f64; 2]> {
        (0..self.graph.len()).map(|node| of_equations[self.equations(node)[0]]).collect()
    }
}
