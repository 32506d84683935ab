//! Meshes of rectangles for cases, written as Gmsh files.

use end_to_end_tests::plugin_folder;
use fe_core::model::Model;
use pullout_case::Case;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fmt::Write;

/// Elements of eight nodes on straight lines, as a Gmsh file.
#[derive(Default)]
pub struct Grids {
    pub nodes: Vec<[f64; 2]>,
    /// Groups of points (dimension 0), lines (1) and elements (2) by name.
    pub groups: Vec<(usize, String, Vec<Vec<usize>>)>,
}

/// Nodes of a grid by their places, so that its cells share them.
pub type Places = HashMap<[u64; 2], usize>;

impl Grids {
    fn node(&mut self, places: &mut Places, at: [f64; 2]) -> usize {
        *places.entry(at.map(f64::to_bits)).or_insert_with(|| {
            self.nodes.push(at);
            self.nodes.len()
        })
    }

    fn group(&mut self, dimension: usize, name: &str) -> &mut Vec<Vec<usize>> {
        let place = self.groups.iter().position(|(_, other, _)| other == name).unwrap_or_else(|| {
            self.groups.push((dimension, name.to_owned(), Vec::new()));
            self.groups.len() - 1
        });
        &mut self.groups[place].2
    }

    /// The cells between these lines whose middle is wanted, as a part.
    pub fn cells(
        &mut self,
        places: &mut Places,
        part: &str,
        xs: &[f64],
        ys: &[f64],
        wanted: impl Fn(f64, f64) -> bool,
    ) {
        for x in xs.windows(2) {
            for y in ys.windows(2) {
                let middle = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
                if wanted(middle[0], middle[1]) {
                    let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
                    let middles = [[middle[0], y[0]], [x[1], middle[1]], [middle[0], y[1]], [x[0], middle[1]]];
                    let nodes = corners.into_iter().chain(middles).map(|at| self.node(places, at)).collect();
                    self.group(2, part).push(nodes);
                }
            }
        }
    }

    /// Names the edges between neighbours among these places on a straight line.
    pub fn line(&mut self, places: &mut Places, name: &str, at: impl Fn(f64) -> [f64; 2], values: &[f64]) {
        for ends in values.windows(2) {
            let nodes = [ends[0], ends[1], 0.5 * (ends[0] + ends[1])].map(|value| self.node(places, at(value)));
            self.group(1, name).push(nodes.to_vec());
        }
    }

    /// Names nodes at these places.
    pub fn points(&mut self, places: &mut Places, name: &str, at: impl Fn(f64) -> [f64; 2], values: &[f64]) {
        for &value in values {
            let node = self.node(places, at(value));
            self.group(0, name).push(vec![node]);
        }
    }

    fn file(&self) -> String {
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", self.groups.len());
        for (tag, (dimension, name, _)) in self.groups.iter().enumerate() {
            writeln!(text, "{dimension} {} \"{name}\"", tag + 1).expect("text");
        }
        write!(text, "$EndPhysicalNames\n$Nodes\n{}\n", self.nodes.len()).expect("text");
        for (node, [x, y]) in self.nodes.iter().enumerate() {
            writeln!(text, "{} {x} {y} 0", node + 1).expect("text");
        }
        let elements = self.groups.iter().map(|(.., elements)| elements.len()).sum::<usize>();
        write!(text, "$EndNodes\n$Elements\n{elements}\n").expect("text");
        let mut number = 0;
        for (tag, (dimension, _, elements)) in self.groups.iter().enumerate() {
            let (kind, tag) = ([15, 8, 16][*dimension], tag + 1);
            for nodes in elements {
                number += 1;
                let nodes: Vec<String> = nodes.iter().map(ToString::to_string).collect();
                writeln!(text, "{number} {kind} 2 {tag} {tag} {}", nodes.join(" ")).expect("text");
            }
        }
        text + "$EndElements\n"
    }
}

/// Equal steps.
pub fn steps(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
}

/// A linear elastic material.
pub fn elastic(modulus: f64, ratio: f64) -> Value {
    json!({ "plugin": "linear_elastic", "props": { "E": modulus, "nu": ratio } })
}

/// Reads a case whose mesh these grids are, as mesh.msh.
pub fn model(case: &Value, grids: &Grids) -> Model {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("mesh.msh"), grids.file()).expect("a file");
    let file = folder.path().join("case.json");
    std::fs::write(&file, case.to_string()).expect("a file");
    match pullout_case::read(&file, &[], &[plugin_folder()]) {
        Ok(Case::Pullout(program)) => program.model,
        Ok(_) => panic!("it is of another kind"),
        Err(errors) => panic!("{errors}"),
    }
}
