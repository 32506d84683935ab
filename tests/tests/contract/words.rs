//! Documents, comments and messages use the words of the glossary; documents have short sentences; captions are short; a claim names no
//! quantity that its test does not look at.

use super::documents::files;
use end_to_end_tests::workspace;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Folders and pages whose words are checked; of generated pages the sources are comments of the code.
const CHECKED: [&str; 14] = [
    "README.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "docs/index.md",
    "docs/using",
    "docs/hosts",
    "docs/notebooks",
    "docs/reference",
    "docs/results",
    "docs/theory",
    "docs/working",
    "fe-core/src",
    "models/src",
    "driver/bridging/src",
];

/// Pages made of comments of the code, and the dictionary itself.
const NOT_CHECKED: [&str; 5] = ["case-format", "laws.md", "arguments.md", "python-api.md", "glossary.md"];

/// Pages of which a sentence has at most [`LONGEST`] words.
const SHORT: [&str; 3] = ["README.md", "docs/using", "docs/hosts"];

const LONGEST: usize = 40;
const MEDIAN: usize = 17;
const CAPTION: usize = 60;
const LINES_OF_README: usize = 120;
const EXCEPTIONS: usize = 30;

/// Quantities that a claim may name, and what then stands in its test.
const QUANTITIES: [(&str, &[&str]); 4] = [
    ("work", &["work", "energy", "dissipation"]),
    ("peak", &["peak"]),
    ("iterations", &["iterations"]),
    ("increments", &["increments"]),
];

/// The pages below some folders and files, by their paths in the tree, with their texts.
fn pages(of: &[&str]) -> Vec<(String, String)> {
    let root = workspace("");
    let mut found = Vec::new();
    for name in of {
        let path = root.join(name);
        if path.is_dir() { files(&path, &mut found) } else { found.push(path) }
    }
    let is_checked = |path: &Path| {
        path.extension().is_some_and(|suffix| suffix == "md")
            && !NOT_CHECKED
                .iter()
                .any(|name| path.ends_with(name) || path.parent().is_some_and(|folder| folder.ends_with(name)))
    };
    found.retain(|path| is_checked(path));
    found.sort();
    let name = |path: &Path| path.strip_prefix(&root).expect("below it").to_string_lossy().into_owned();
    found.iter().map(|path| (name(path), fs::read_to_string(path).expect("text"))).collect()
}

/// The lines of a page that are neither code nor comments, each with its number; code within a line and targets of links are left out.
fn prose(text: &str) -> Vec<(usize, String)> {
    let (mut fence, mut found) = (None, Vec::new());
    for (number, line) in (1..).zip(text.lines()) {
        let ticks = line.trim_start().chars().take_while(|c| *c == '`').count();
        match fence {
            None if ticks >= 3 => fence = Some(ticks),
            Some(open) if ticks >= open => fence = None,
            None if !line.trim_start().starts_with("<!--") && !line.starts_with("    ") => {
                found.push((number, without_links(&without_code(line))));
            }
            _ => {}
        }
    }
    found
}

fn without_code(line: &str) -> String {
    let pieces: Vec<&str> = line.split('`').collect();
    pieces.iter().enumerate().map(|(k, piece)| if k % 2 == 0 { piece } else { "CODE" }).collect()
}

fn without_links(line: &str) -> String {
    let mut pieces = line.split("](");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        text.push_str(piece.split_once(')').map_or("", |(_, rest)| rest));
    }
    text
}

/// The words of a text, in lower case, without the signs around them.
fn words(text: &str) -> Vec<String> {
    let word = |text: &str| text.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase();
    text.split(|c: char| c.is_whitespace() || c == '–').map(word).filter(|word| !word.is_empty()).collect()
}

/// The left column of the glossary's dictionary. A row with a remark in parentheses is for readers to judge.
fn replaced() -> Vec<Vec<String>> {
    let glossary = fs::read_to_string(workspace("docs/working/glossary.md")).expect("the glossary");
    let table = glossary.split("\n## Words to replace\n").nth(1).and_then(|rest| rest.split("\n## ").next());
    let rows = table.expect("the dictionary").lines().filter(|line| line.starts_with("| ")).skip(1);
    let cells = rows.filter_map(|row| row.split('|').nth(1)).filter(|cell| !cell.contains('('));
    cells.flat_map(|cell| cell.split([',', ';']).map(words)).collect()
}

/// The replaced words on a line.
fn found<'d>(line: &str, dictionary: &'d [Vec<String>]) -> impl Iterator<Item = &'d Vec<String>> {
    let line = words(line);
    dictionary.iter().filter(move |old| line.windows(old.len()).any(|window| window == old.as_slice()))
}

/// The numbers of words in the sentences of a page, with their texts.
fn sentences(text: &str) -> Vec<(usize, String)> {
    let mut paragraphs = vec![String::new()];
    let (mut last, lines) = (0, prose(text));
    for (number, line) in &lines {
        let line = line.trim();
        let begins = *number != last + 1 || line.is_empty() || line.starts_with(['#', '|', '-', '*', '>']);
        if begins || line.starts_with(|c: char| c.is_ascii_digit()) {
            paragraphs.push(String::new());
        }
        last = *number;
        for (k, cell) in line.split('|').enumerate() {
            if k > 0 {
                paragraphs.push(String::new());
            }
            let paragraph = paragraphs.last_mut().expect("one");
            paragraph.push(' ');
            paragraph.push_str(cell);
        }
    }
    let mut found = Vec::new();
    for paragraph in paragraphs {
        let mut sentence = String::new();
        for piece in paragraph.split_whitespace() {
            if !sentence.is_empty() {
                sentence.push(' ');
            }
            sentence.push_str(piece);
            if piece.trim_end_matches(['"', ')', '*']).ends_with(['.', '!', '?']) {
                found.push(std::mem::take(&mut sentence));
            }
        }
        found.push(sentence);
    }
    found.into_iter().map(|sentence| (words(&sentence).len(), sentence)).filter(|(count, _)| *count > 0).collect()
}

/// Folders whose code is checked: doc comments, and literals of more than one word (help, messages, titles).
const CODE: [&str; 10] =
    ["umat-abi", "models", "fe-core", "driver", "python", "bench", "tests", "examples", "xtask", "cases"];

/// Doc comments and literals of a Rust source, each with the number of its line; code within them is left out.
fn prose_of_code(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let start = line.trim_start();
        if let Some(comment) = start.strip_prefix("///").or_else(|| start.strip_prefix("//!")) {
            found.push((number, without_links(&without_code(comment))));
        } else if !start.starts_with("//") {
            let literals = line.split('"').skip(1).step_by(2).filter(|literal| literal.contains(' '));
            found.extend(literals.map(|literal| (number, without_code(literal))));
        }
    }
    found
}

/// Sources of Rust below [`CODE`] except this one, by their paths in the tree, with their texts.
fn sources() -> Vec<(String, String)> {
    let root = workspace("");
    let mut found = Vec::new();
    for name in CODE {
        files(&root.join(name), &mut found);
    }
    found.retain(|path| path.extension().is_some_and(|suffix| suffix == "rs") && !path.ends_with("contract/words.rs"));
    found.sort();
    let name = |path: &Path| path.strip_prefix(&root).expect("below it").to_string_lossy().into_owned();
    found.iter().map(|path| (name(path), fs::read_to_string(path).expect("text"))).collect()
}

#[test]
fn documents_and_code_use_the_words_of_the_glossary() {
    let dictionary = replaced();
    assert!(dictionary.len() > 20, "{dictionary:?}");
    let list = fs::read_to_string(workspace("tests/tests/contract/words.txt")).expect("the exceptions");
    let exceptions: Vec<_> =
        list.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(": ")).collect();
    assert!(exceptions.len() <= EXCEPTIONS, "{} exceptions", exceptions.len());
    let (mut wrong, mut used) = (Vec::new(), vec![false; exceptions.len()]);
    let documents = pages(&CHECKED).into_iter().map(|(name, text)| (name, prose(&text)));
    let code = sources().into_iter().map(|(name, text)| (name, prose_of_code(&text)));
    for (name, lines) in documents.chain(code) {
        for (number, line) in lines {
            for old in found(&line, &dictionary) {
                match exceptions.iter().position(|(page, part)| *page == name && line.contains(part)) {
                    Some(k) => used[k] = true,
                    None => wrong.push(format!("{name}:{number}: {}", old.join(" "))),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "docs/working/glossary.md has better words for:\n{}", wrong.join("\n"));
    let unused: Vec<_> =
        exceptions.iter().zip(used).filter(|(_, used)| !used).map(|(exception, _)| exception).collect();
    assert!(unused.is_empty(), "exceptions without an occurrence: {unused:?}");
}

#[test]
fn sentences_of_tutorials_are_short() {
    let mut counts = Vec::new();
    for (name, text) in pages(&SHORT) {
        for (count, sentence) in sentences(&text) {
            assert!(count <= LONGEST, "{name}: {count} words: {sentence}");
            if count > 3 {
                counts.push(count);
            }
        }
    }
    counts.sort_unstable();
    assert!(counts[counts.len() / 2] <= MEDIAN);
    let readme = fs::read_to_string(workspace("README.md")).expect("README.md");
    assert!(readme.lines().count() <= LINES_OF_README);
}

/// The studies of the tree and of its documents, with where each is.
fn cases() -> Vec<(String, Value)> {
    let mut found = Vec::new();
    files(&workspace("cases"), &mut found);
    let of_the_tree = found.iter().filter(|path| path.extension().is_some_and(|suffix| suffix == "json")).map(|path| {
        let text = fs::read_to_string(path).expect("text");
        (path.display().to_string(), serde_json::from_str(&text).expect("JSON"))
    });
    let mut cases: Vec<_> = of_the_tree.collect();
    for (name, text) in pages(&["README.md", "docs/using"]) {
        let blocks = text.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next());
        cases.extend(blocks.filter_map(|block| serde_json::from_str(block).ok()).map(|case| (name.clone(), case)));
    }
    cases
}

#[test]
fn captions_are_short() {
    for (place, case) in cases() {
        let caption = case["description"].as_str().unwrap_or_default().split("\n\n").next().unwrap_or_default();
        let count = caption.split_whitespace().count();
        assert!(
            count <= CAPTION,
            "{place}: the first paragraph of the description has {count} words, {CAPTION} are a caption"
        );
    }
}

/// The quantities that a claim names and its test does not look at.
fn untested(claim: &Value) -> Vec<&'static str> {
    let named = words(claim["claim"].as_str().unwrap_or_default());
    let tested = claim.get("quantity").map_or("peak".into(), Value::to_string) + &claim["expect"].to_string();
    let is_untested = |(word, tests): &(&str, &[&str])| {
        named.iter().any(|name| name == word) && !tests.iter().any(|test| tested.contains(test))
    };
    QUANTITIES.iter().copied().filter(is_untested).map(|(word, _)| word).collect()
}

#[test]
fn a_claim_names_what_its_test_looks_at() {
    for (place, case) in cases() {
        for claim in case["claims"].as_array().into_iter().flatten() {
            let untested = untested(claim);
            assert!(untested.is_empty(), "{place}: {claim} is not a test of {untested:?}");
        }
    }
}

#[test]
fn what_the_checks_look_for_is_found() {
    let dictionary = replaced();
    let hits = |text: &str| -> usize { prose(text).iter().map(|(_, line)| found(line, &dictionary).count()).sum() };
    assert_eq!(hits("A worker is told of it, and the concrete gives way beside it."), 3);
    assert_eq!(hits("`told` [it](beside.md) is code, and the next a path"), 0);
    assert_eq!(hits("```text\ntold\n```\nThe law reports it."), 0);
    let in_code =
        |text: &str| -> usize { prose_of_code(text).iter().map(|(_, line)| found(line, &dictionary).count()).sum() };
    let of_each = "/// Is told.\nlet told = warn(\"{told} is told\", \"beside\", \"stands for it\");\n// told";
    assert_eq!(in_code(of_each), 3);
    let long = format!("It {} ends. This is short. | a cell | another |", "very ".repeat(50));
    let counts: Vec<usize> = sentences(&long).into_iter().map(|(count, _)| count).collect();
    assert_eq!(counts, [52, 3, 2, 1]);
    let claim =
        serde_json::json!({ "claim": "peak and work grow", "quantity": "peak", "expect": { "trend": "increasing" } });
    assert_eq!(untested(&claim), ["work"]);
    let claim = serde_json::json!({ "claim": "the peak grows", "expect": { "trend": "increasing" } });
    assert!(untested(&claim).is_empty());
}
