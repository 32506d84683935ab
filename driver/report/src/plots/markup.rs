//! Indices and exponents in labels: `ε_{11}`, `10^{−3}`.

use std::fmt::Write as _;

/// Size of an index or exponent relative to the text.
const SMALL: f64 = 0.73;
/// Distances by which they are lowered or raised, in em of the text.
const LOWERED: f64 = 0.22;
const RAISED: f64 = -0.36;

/// Turns the markup inside the text elements of an SVG (their content is a line of its own) into `tspan`s.
pub(super) fn raise_and_lower(svg: &str) -> String {
    let mut result = String::with_capacity(svg.len() + 1024);
    for line in svg.split_inclusive('\n') {
        if line.starts_with('<') || Pieces(line).all(|(level, _)| level == Level::Base) {
            result.push_str(line);
            continue;
        }
        let mut height = 0.0;
        for (level, text) in Pieces(line) {
            let (target, size) = match level {
                Level::Base => (0.0, 1.0),
                Level::Index => (LOWERED, SMALL),
                Level::Exponent => (RAISED, SMALL),
            };
            let shift = (target - height) / size;
            height = target;
            // renderers drop spaces at the start of a tspan, even hard ones: move to the right instead
            let text = text.trim_end_matches('\n');
            let shown = text.trim_start_matches(' ');
            let right = if shown.len() < text.len() && level == Level::Base { " dx=\"0.28em\"" } else { "" };
            let percent = 100.0 * size;
            // a shift of nothing is not written: at the start of the text it would take the place of the text's own
            let down = if shift == 0.0 { String::new() } else { format!(" dy=\"{shift:.3}em\"") };
            // writing to a String cannot fail
            let _ = write!(result, "<tspan{right}{down} font-size=\"{percent}%\">{shown}</tspan>");
        }
        result.push('\n');
    }
    result
}

/// The label without markup.
pub(super) fn plain(label: &str) -> String {
    Pieces(label).map(|(_, text)| text).collect()
}

/// Number of characters that are seen.
pub(super) fn length(label: &str) -> usize {
    Pieces(label).map(|(_, text)| text.chars().count()).sum()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Base,
    Index,
    Exponent,
}

/// The pieces of a label from left to right.
struct Pieces<'a>(&'a str);

impl<'a> Iterator for Pieces<'a> {
    type Item = (Level, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        let text = self.0;
        for (level, opening) in [(Level::Index, "_{"), (Level::Exponent, "^{")] {
            if let Some((inner, rest)) = text.strip_prefix(opening).and_then(|text| text.split_once('}')) {
                self.0 = rest;
                return Some((level, inner));
            }
        }
        let first = text.chars().next()?.len_utf8();
        let opening = ["_{", "^{"].iter().filter_map(|opening| text[first..].find(opening)).min();
        let (piece, rest) = text.split_at(opening.map_or(text.len(), |start| first + start));
        self.0 = rest;
        Some((Level::Base, piece))
    }
}
