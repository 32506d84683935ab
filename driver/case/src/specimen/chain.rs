//! Edges in a row.

use fe_core::mesh::{ElementEdge, Mesh};
use std::collections::HashMap;

/// The edges in the order in which they follow each other: each starts at the node where the one before it ends.
///
/// # Errors
/// In words, why they are no chain.
pub fn in_order(mesh: &Mesh, edges: &[ElementEdge]) -> Result<Vec<ElementEdge>, String> {
    let ends = |edge: ElementEdge| {
        let nodes = mesh.edge_nodes(edge);
        (nodes.nodes()[0], nodes.nodes()[1])
    };
    let mut starting_at: HashMap<usize, ElementEdge> = HashMap::new();
    let mut ending_at: HashMap<usize, ElementEdge> = HashMap::new();
    for &edge in edges {
        let (start, end) = ends(edge);
        if starting_at.insert(start, edge).is_some() || ending_at.insert(end, edge).is_some() {
            let [x, y] = mesh.nodes()[start];
            return Err(format!("its edges branch near ({x:.6}, {y:.6}): they must be one chain"));
        }
    }
    let firsts: Vec<ElementEdge> =
        edges.iter().copied().filter(|&edge| !ending_at.contains_key(&ends(edge).0)).collect();
    let mut current = match firsts[..] {
        [first] => Some(first),
        [] => return Err("its edges are a closed ring: they must be one chain with two ends".into()),
        _ => {
            let starts: Vec<String> = firsts
                .iter()
                .map(|&edge| mesh.nodes()[ends(edge).0])
                .map(|[x, y]| format!("({x:.6}, {y:.6})"))
                .collect();
            return Err(format!(
                "its edges are {} pieces, starting at {}: they must be one chain",
                firsts.len(),
                starts.join(", ")
            ));
        }
    };
    let mut chain = Vec::with_capacity(edges.len());
    while let Some(edge) = current {
        chain.push(edge);
        current = starting_at.get(&ends(edge).1).copied();
    }
    if chain.len() < edges.len() {
        return Err("its edges are a chain and a closed ring: they must be one chain".into());
    }
    Ok(chain)
}
