//! Documents cite what is in the tree: pages (`*.md`), and in backticks files and folders below those at the top.

use end_to_end_tests::workspace;
use std::fs;
use std::path::{Path, PathBuf};

/// Results and environments, which are no part of the tree, and what is of others.
const PASSED_OVER: [&str; 7] = ["target", "out", "_build", ".venv", ".git", "_static", "__pycache__"];

/// Name of the page in the folder of each law and module: a citation of one needs no path.
const PAGE_OF_A_MODULE: &str = "doc.md";

/// Files whose lines may cite, by their suffixes.
const KINDS: [&str; 7] = ["md", "toml", "h", "cff", "rs", "f90", "yml"];

/// Returns the text after `//` outside a string: strings name files of their own.
fn comment(line: &str) -> &str {
    let is_code = |at: usize| line[..at].matches('"').count().is_multiple_of(2);
    line.match_indices("//").find(|(at, _)| is_code(*at)).map_or("", |(at, _)| &line[at + 2..])
}

/// All files below a folder but those passed over.
pub(super) fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if PASSED_OVER.iter().any(|name| path.ends_with(name)) {
            continue;
        }
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// Words of the signs that a path has, without those of URLs.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_ascii_alphanumeric() || "_./-".contains(c))).filter(|word| !word.starts_with("//"))
}

/// The pages that a line cites.
fn pages(line: &str) -> impl Iterator<Item = &str> {
    words(line).map(|word| word.trim_end_matches('.')).filter(|word| word.ends_with(".md") && word.len() > 3)
}

/// The paths in backticks on a line that begin with a folder at the top of the tree.
fn paths<'a>(line: &'a str, top: &[String]) -> Vec<&'a str> {
    let quoted = line.split('`').skip(1).step_by(2);
    let is_path = |text: &&str| {
        let mut parts = text.split('/');
        let first = parts.next().unwrap_or_default();
        parts.next().is_some() && top.iter().any(|name| name == first) && words(text).eq([*text])
    };
    quoted.filter(is_path).collect()
}

/// Returns whether a page is where a file cites it: relative to its folder or to one above it, up to the tree's.
fn is_there(root: &Path, file: &Path, cited: &str) -> bool {
    let above = file.ancestors().skip(1).take_while(|folder| folder.starts_with(root));
    above.into_iter().any(|folder| folder.join(cited).exists())
}

/// Returns the cited pages and files that are not there, with their lines; of sources only comments count.
fn lost(root: &Path, top: &[String], file: &Path, text: &str) -> Vec<String> {
    let is_source = file.extension().is_some_and(|suffix| suffix == "rs");
    let mut lost = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = if is_source { comment(line) } else { line };
        let cited = pages(line).filter(|page| *page != PAGE_OF_A_MODULE && !is_there(root, file, page));
        // what is made later is not there
        let is_made = |path: &str| path.split('/').any(|part| PASSED_OVER.contains(&part));
        let named = paths(line, top).into_iter().filter(|path| !is_made(path) && !root.join(path).exists());
        lost.extend(
            cited
                .chain(named)
                .map(|what| format!("{}:{number}: {what}", file.strip_prefix(root).unwrap_or(file).display())),
        );
    }
    lost
}

fn top_of(root: &Path) -> Vec<String> {
    let entries = fs::read_dir(root).expect("the tree").flatten().filter(|entry| entry.path().is_dir());
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| !PASSED_OVER.contains(&name.as_str())).collect()
}

#[test]
fn every_document_that_is_cited_is_in_the_tree() {
    let root = workspace("");
    let top = top_of(&root);
    let mut found = Vec::new();
    files(&root, &mut found);
    let mut missing = Vec::new();
    for file in found {
        let suffix = file.extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
        if KINDS.contains(&suffix) {
            let text = fs::read_to_string(&file).expect("text");
            missing.extend(lost(&root, &top, &file, &text));
        }
    }
    assert!(missing.is_empty(), "not in the tree:\n{}", missing.join("\n"));
}

#[test]
fn a_citation_of_what_is_not_there_is_found() {
    let root = workspace("");
    let file = root.join("models/src/lib.rs");
    let count = |line: &str| lost(&root, &top_of(&root), &file, line).len();
    assert_eq!(count("//! as nowhere.md §3 has it, and docs/nowhere.md"), 2);
    assert_eq!(count("//! the law in `models/src/nowhere/`"), 1);
    assert_eq!(count("//! (doc.md, docs/index.md, `models/src/lib.rs`), https://example.org/nowhere.md"), 0);
    assert_eq!(count("let page = \"nowhere.md\";"), 0);
}
