//! Small meshes in Gmsh's format, and how all their nodes are moved.

use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Quadrilaterals of parts, lines of edge sets; each node is a set `n1`, `n2`, … as well.
pub struct Patch {
    pub nodes: Vec<[f64; 2]>,
    /// Parts with their elements' nodes, from 1.
    pub parts: Vec<(&'static str, Vec<[usize; 4]>)>,
    /// Edge sets.
    pub edges: Vec<(&'static str, [usize; 2])>,
}

impl Patch {
    /// The file, version 2.2.
    pub fn file(&self) -> String {
        let (mut names, mut elements) = (Vec::new(), Vec::new());
        let mut add = |dimension: usize, kind: usize, name: &str, nodes: &[usize]| {
            let named = format!("{dimension} {} \"{name}\"", names.len() + 1);
            let same = names.iter().position(|other: &String| other.ends_with(&format!(" \"{name}\"")));
            let group = same.map_or(names.len() + 1, |place| place + 1);
            if same.is_none() {
                names.push(named);
            }
            let nodes: Vec<_> = nodes.iter().map(ToString::to_string).collect();
            elements.push(format!("{} {kind} 2 {group} {group} {}", elements.len() + 1, nodes.join(" ")));
        };
        for number in 1..=self.nodes.len() {
            add(0, 15, &format!("n{number}"), &[number]);
        }
        for (name, nodes) in &self.edges {
            add(1, 1, name, nodes);
        }
        for (name, quadrilaterals) in &self.parts {
            quadrilaterals.iter().for_each(|nodes| add(2, 3, name, nodes));
        }
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_owned();
        let _ = write!(text, "$PhysicalNames\n{}\n{}\n$EndPhysicalNames\n", names.len(), names.join("\n"));
        let _ = writeln!(text, "$Nodes\n{}", self.nodes.len());
        for (k, [x, y]) in self.nodes.iter().enumerate() {
            let _ = writeln!(text, "{} {x} {y} 0", k + 1);
        }
        let _ = write!(text, "$EndNodes\n$Elements\n{}\n{}\n$EndElements\n", elements.len(), elements.join("\n"));
        text
    }

    /// Supports that move every node of `which`, from 1, by drives of its own: `n1x`, `n1y`, …
    pub fn supports(&self, which: std::ops::RangeInclusive<usize>) -> Map<String, Value> {
        let drives = which.flat_map(|number| ["x", "y"].map(|axis| (number, axis)));
        drives
            .map(|(number, axis)| {
                let drive = format!("n{number}{axis}");
                let support = json!({ "nodes": format!("n{number}"), "direction": axis, "drive": drive });
                (drive, support)
            })
            .collect()
    }

    /// Returns the values of the drives that give each node its displacement.
    pub fn drives(
        &self,
        which: std::ops::RangeInclusive<usize>,
        displacement: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Map<String, Value> {
        let moved = which.flat_map(|number| {
            let [x, y] = displacement(self.nodes[number - 1]);
            [(format!("n{number}x"), json!(x)), (format!("n{number}y"), json!(y))]
        });
        moved.collect()
    }
}
