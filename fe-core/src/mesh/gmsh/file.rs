//! The sections of a Gmsh file, of either version, as they stand there.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::element_type::ElementType;
use super::source::{Encoding, FileFault, MeshReader, shown, unexpected};

/// Most physical groups of an entity. All its elements are in all of them: without a limit a file of a megabyte
/// makes sets of gigabytes.
const MOST_GROUPS: u64 = 1000;

/// A node of the file.
pub(super) struct FileNode {
    pub(super) tag: u64,
    pub(super) position: [f64; 3],
    /// The byte where it stands.
    pub(super) place: usize,
}

/// An element of the file.
pub(super) struct FileElement {
    pub(super) tag: u64,
    pub(super) element_type: ElementType,
    /// Index into [`File::groups`].
    pub(super) groups: usize,
    /// Indices into [`File::nodes`].
    pub(super) nodes: Vec<usize>,
    /// The byte where it stands.
    pub(super) place: usize,
}

/// Contents of a Gmsh file.
#[derive(Default)]
pub(super) struct File {
    version: Version,
    /// Names of physical groups by dimension and tag.
    pub(super) names: BTreeMap<(usize, i64), String>,
    pub(super) nodes: Vec<FileNode>,
    pub(super) elements: Vec<FileElement>,
    /// Lists of tags of physical groups, to which elements refer.
    pub(super) groups: Vec<Vec<i64>>,
    /// Index into `nodes` by tag.
    node_of_tag: HashMap<u64, usize>,
    /// Index into `groups` by dimension and tag of an entity (4.1).
    groups_of_entity: HashMap<(usize, i64), usize>,
}

/// The versions that are read.
#[derive(Clone, Copy, Default)]
enum Version {
    V2,
    #[default]
    V4,
}

impl File {
    /// Reads all sections.
    pub(super) fn read(source: &mut MeshReader<'_>) -> Result<Self, FileFault> {
        let version = read_format(source)?;
        let mut file = Self { version, ..Self::default() };
        let mut seen = HashSet::new();
        while !source.is_at_end() {
            let (start, section) = section_start(source)?;
            if !seen.insert(section.clone()) && matches!(&*section, "PhysicalNames" | "Entities" | "Nodes" | "Elements")
            {
                return Err((start, format!("section ${section} comes a second time; a file holds one mesh")));
            }
            match (&*section, version) {
                ("PhysicalNames", _) => file.read_names(source)?,
                ("Entities", Version::V4) => file.read_entities(source)?,
                ("Nodes", Version::V4) => file.read_nodes_4(source)?,
                ("Nodes", Version::V2) => file.read_nodes_2(source)?,
                ("Elements", Version::V4) => file.read_elements_4(source)?,
                ("Elements", Version::V2) => file.read_elements_2(source)?,
                ("PartitionedEntities", _) => {
                    let fault =
                        "the mesh is partitioned; save it with Mesh.PartitionSplitMeshFiles = 0 and without partitions";
                    return Err((start, fault.to_owned()));
                }
                _ => {
                    source.skip_section(&section)?;
                    continue;
                }
            }
            source.section_end(&section)?;
        }
        for section in ["Nodes", "Elements"] {
            if !seen.contains(section) {
                let fault = format!("there is no section ${section}; mesh the model (Mesh > 2D) before saving it");
                return Err((source.position(), fault));
            }
        }
        Ok(file)
    }

    /// $PhysicalNames: always text.
    fn read_names(&mut self, source: &mut MeshReader<'_>) -> Result<(), FileFault> {
        for _ in 0..source.number::<u64>("the number of physical names")? {
            let dimension = source.number("the dimension of a physical group")?;
            let tag = source.number("the tag of a physical group")?;
            let name = source.quoted("the name of a physical group in quotes")?;
            self.names.insert((dimension, tag), name);
        }
        Ok(())
    }

    /// $Entities (4.1): of each point, curve, surface and volume its tag, its box, its groups and what bounds it.
    fn read_entities(&mut self, source: &mut MeshReader<'_>) -> Result<(), FileFault> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = source.size("the number of entities of a dimension")?;
        }
        for (dimension, &count) in counts.iter().enumerate() {
            for _ in 0..count {
                let tag = source.integer("the tag of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    source.real("a coordinate of an entity")?;
                }
                let place = source.position();
                let group_count = source.size("the number of an entity's physical groups")?;
                if group_count > MOST_GROUPS {
                    let expected = format!("at most {MOST_GROUPS} physical groups of an entity");
                    return Err((place, unexpected(&expected, &group_count.to_string())));
                }
                let mut groups = Vec::new();
                for _ in 0..group_count {
                    groups.push(source.integer("the tag of a physical group")?);
                }
                if dimension > 0 {
                    for _ in 0..source.size("the number of an entity's boundaries")? {
                        source.integer("the tag of an entity's boundary")?;
                    }
                }
                self.groups.push(groups);
                self.groups_of_entity.insert((dimension, tag), self.groups.len() - 1);
            }
        }
        Ok(())
    }

    /// $Nodes (4.1): blocks, each with all tags before all positions.
    fn read_nodes_4(&mut self, source: &mut MeshReader<'_>) -> Result<(), FileFault> {
        let header = source.position();
        let block_count = source.size("the number of node blocks")?;
        let node_count = source.size("the number of nodes")?;
        source.size("the smallest node tag")?;
        source.size("the largest node tag")?;
        for _ in 0..block_count {
            let dimension = source.integer("the dimension of a node block's entity")?;
            source.integer("the tag of a node block's entity")?;
            let parametric = source.integer("whether a node block is parametric")? != 0;
            let count = source.size("the number of nodes of a block")?;
            let mut tags = Vec::with_capacity((count as usize).min(source.remaining()));
            for _ in 0..count {
                tags.push((source.position(), source.size("a node tag")?));
            }
            for (place, tag) in tags {
                let position = read_position(source)?;
                for _ in 0..if parametric { dimension } else { 0 } {
                    source.real("a parametric coordinate")?;
                }
                self.add_node(FileNode { tag, position, place })?;
            }
        }
        check_count(header, "the number of nodes of the header", node_count, self.nodes.len())
    }

    /// $Elements (4.1): blocks of one type and entity.
    fn read_elements_4(&mut self, source: &mut MeshReader<'_>) -> Result<(), FileFault> {
        let header = source.position();
        let block_count = source.size("the number of element blocks")?;
        let element_count = source.size("the number of elements")?;
        source.size("the smallest element tag")?;
        source.size("the largest element tag")?;
        for _ in 0..block_count {
            let start = source.position();
            let dimension = source.integer("the dimension of an element block's entity")?;
            let entity = source.integer("the tag of an element block's entity")?;
            let element_type = read_type(source, start)?;
            if dimension != element_type.dimension() as i64 {
                let expected = format!("a block of dimension {}, as its type of element", element_type.dimension());
                return Err((start, unexpected(&expected, &dimension.to_string())));
            }
            let dimension = element_type.dimension();
            let &groups = self.groups_of_entity.get(&(dimension, entity)).ok_or_else(|| {
                let what = format!("elements of the entity of dimension {dimension} and tag {entity}");
                (start, format!("{what}, which is not in $Entities; save the mesh from Gmsh again"))
            })?;
            for _ in 0..source.size("the number of elements of a block")? {
                let place = source.position();
                let tag = source.size("an element tag")?;
                self.add_element(source, tag, element_type, groups, place)?;
            }
        }
        check_count(header, "the number of elements of the header", element_count, self.elements.len())
    }

    /// $Nodes (2.2).
    fn read_nodes_2(&mut self, source: &mut MeshReader<'_>) -> Result<(), FileFault> {
        let count = source.number::<u64>("the number of nodes")?;
        if source.encoding == Encoding::Binary {
            source.line_end()?;
        }
        for _ in 0..count {
            let place = source.position();
            let tag = read_tag(source, "a node tag")?;
            let position = read_position(source)?;
            self.add_node(FileNode { tag, position, place })?;
        }
        Ok(())
    }

    /// $Elements (2.2): in text one by one, in binary in blocks of one type and number of tags.
    fn read_elements_2(&mut self, source: &mut MeshReader<'_>) -> Result<(), FileFault> {
        let count = source.number::<u64>("the number of elements")?;
        if source.encoding == Encoding::Binary {
            source.line_end()?;
        }
        while (self.elements.len() as u64) < count {
            let place = source.position();
            match source.encoding {
                Encoding::Text => {
                    let tag = read_tag(source, "an element tag")?;
                    let element_type = read_type(source, place)?;
                    let tag_count = source.integer("the number of an element's tags")?;
                    self.read_element_2(source, tag, element_type, tag_count, place)?;
                }
                Encoding::Binary => {
                    let element_type = read_type(source, place)?;
                    let block_count = source.integer("the number of elements of a block")?;
                    let tag_count = source.integer("the number of an element's tags")?;
                    if block_count < 1 {
                        let expected = "a positive number of elements of a block";
                        return Err((place, unexpected(expected, &block_count.to_string())));
                    }
                    for _ in 0..block_count {
                        let place = source.position();
                        let tag = read_tag(source, "an element tag")?;
                        self.read_element_2(source, tag, element_type, tag_count, place)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The tags and nodes of an element (2.2): the first tag is its physical group, 0 for none.
    fn read_element_2(
        &mut self,
        source: &mut MeshReader<'_>,
        tag: u64,
        element_type: ElementType,
        tag_count: i64,
        place: usize,
    ) -> Result<(), FileFault> {
        let mut group = 0;
        for index in 0..tag_count {
            let value = source.integer("a tag of an element")?;
            if index == 0 {
                group = value;
            }
        }
        let groups = if group == 0 { vec![] } else { vec![group] };
        // Elements of one group follow each other.
        if self.groups.last() != Some(&groups) {
            self.groups.push(groups);
        }
        self.add_element(source, tag, element_type, self.groups.len() - 1, place)
    }

    fn add_node(&mut self, node: FileNode) -> Result<(), FileFault> {
        if !node.position.iter().all(|x| x.is_finite()) {
            return Err((node.place, format!("node {}: its position is not finite", node.tag)));
        }
        if self.node_of_tag.insert(node.tag, self.nodes.len()).is_some() {
            return Err((node.place, format!("node {} is defined twice", node.tag)));
        }
        self.nodes.push(node);
        Ok(())
    }

    /// Reads the nodes of an element and adds it.
    fn add_element(
        &mut self,
        source: &mut MeshReader<'_>,
        tag: u64,
        element_type: ElementType,
        groups: usize,
        place: usize,
    ) -> Result<(), FileFault> {
        let mut nodes = Vec::with_capacity(element_type.node_count());
        for _ in 0..element_type.node_count() {
            let expected = "a node of an element";
            let node = match self.version {
                Version::V2 => read_tag(source, expected)?,
                Version::V4 => source.size(expected)?,
            };
            let unknown = || (place, format!("element {tag} has node {node}, which is not in $Nodes"));
            nodes.push(*self.node_of_tag.get(&node).ok_or_else(unknown)?);
        }
        self.elements.push(FileElement { tag, element_type, groups, nodes, place });
        Ok(())
    }
}

/// $MeshFormat: version, text or binary, bytes of a size_t; in binary a 1 that shows the byte order.
fn read_format(source: &mut MeshReader<'_>) -> Result<Version, FileFault> {
    let start = source.position();
    let first = source.word("$MeshFormat")?;
    if first != "$MeshFormat" {
        let found = shown(&first);
        return Err((start, format!("this is no Gmsh mesh: it must start with $MeshFormat, found '{found}'")));
    }
    let place = source.position();
    let version = match source.word("the format version")? {
        version if version == "2.2" => Version::V2,
        version if version == "4.1" => Version::V4,
        version => {
            let version = version.escape_debug();
            let fault = format!("format version {version} is not read; save with Mesh.MshFileVersion = 4.1 (or 2.2)");
            return Err((place, fault));
        }
    };
    let place = source.position();
    let file_type: i64 = source.number("0 (text) or 1 (binary)")?;
    if !(0..=1).contains(&file_type) {
        return Err((place, unexpected("0 (text) or 1 (binary)", &file_type.to_string())));
    }
    let data_size: i64 = source.number("the size of a number in bytes")?;
    if file_type == 1 {
        if data_size != 8 {
            return Err((place, unread_binary(&format!("numbers of {data_size} bytes"))));
        }
        source.line_end()?;
        source.encoding = Encoding::Binary;
        let place = source.position();
        if source.integer("the 1 that shows the byte order")? != 1 {
            return Err((place, unread_binary("its highest byte first")));
        }
    }
    source.section_end("MeshFormat")?;
    Ok(version)
}

/// Binary in a form that this reader does not have.
fn unread_binary(what: &str) -> String {
    format!("binary data with {what} is not read; save as text with Mesh.Binary = 0")
}

/// The line that opens a section: where, and its name.
fn section_start(source: &mut MeshReader<'_>) -> Result<(usize, String), FileFault> {
    source.skip_blanks();
    let start = source.position();
    let word = source.word("a section")?;
    let Some(section) = word.strip_prefix('$') else {
        return Err((start, unexpected("a section, such as $Nodes", &shown(&word))));
    };
    source.line_end()?;
    Ok((start, section.to_owned()))
}

/// A tag that is an int in version 2.2; it is positive.
fn read_tag(source: &mut MeshReader<'_>, expected: &str) -> Result<u64, FileFault> {
    let place = source.position();
    let tag = source.integer(expected)?;
    u64::try_from(tag).map_err(|_| (place, unexpected(expected, &tag.to_string())))
}

fn read_type(source: &mut MeshReader<'_>, place: usize) -> Result<ElementType, FileFault> {
    ElementType::new(source.integer("a type of element")?).map_err(|fault| (place, fault))
}

fn read_position(source: &mut MeshReader<'_>) -> Result<[f64; 3], FileFault> {
    let mut position = [0.0; 3];
    for coordinate in &mut position {
        *coordinate = source.real("a coordinate of a node")?;
    }
    Ok(position)
}

/// Compares the number in a header with the number found.
fn check_count(place: usize, what: &str, stated: u64, found: usize) -> Result<(), FileFault> {
    if stated == found as u64 {
        return Ok(());
    }
    Err((place, unexpected(&format!("{stated} entries ({what})"), &found.to_string())))
}
