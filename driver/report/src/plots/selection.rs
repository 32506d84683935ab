//! Chooses the pictures of a run and their contents.

use super::figure::{Figure, Key, Line, Marks, PALETTE, Style};
use super::quantity::{Quantity, capital, group_of};
use super::{CaseKind, MeasuredCurve, PlottedRun};
use crate::{ROUNDING, extremes};
use pullout_bridging::RESIDUAL_CMOD;
use pullout_run::columns::Group;
use pullout_run::number::significant;
use pullout_run::program::{STRAIN_NAMES, STRESS_NAMES};

#[cfg(test)]
mod test;

/// The pictures of one or several runs. What kind they are of is taken from the first.
pub fn figures(runs: &[PlottedRun<'_>]) -> Vec<Figure> {
    let Some(first) = runs.first() else { return Vec::new() };
    let mut layouts = match &first.spec.subject {
        CaseKind::Point { controlled } => point(first, controlled),
        CaseKind::Interface => interface(first),
        CaseKind::Pullout => pullout(first),
        CaseKind::Bridging => bridging(first),
    };
    place_curves(&mut layouts, runs);
    let names = names(runs);
    let mut figures: Vec<Figure> =
        (layouts.iter().enumerate()).filter_map(|(k, layout)| layout.figure(runs, &names, k == 0)).collect();
    for figure in figures.iter_mut().skip(1).filter(|figure| !figure.title.is_empty()) {
        figure.title = title(&figure.name);
    }
    if let ([run], Some(main)) = (runs, figures.first_mut()) {
        main.marks.extend(peak(main));
        main.marks.extend(strengths(main));
        for figure in &mut figures {
            let given = run.spec.captions.get(&figure.name).and_then(|caption| caption.title.as_ref());
            figure.title = given.unwrap_or(&figure.title).clone();
        }
    }
    figures
}

/// Returns the peak of the first curve, if the curve falls after it. The end of a path is no peak.
fn peak(figure: &Figure) -> Option<Marks> {
    let points = &figure.lines.first()?.points;
    let finite = || points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
    let reach = extremes(finite().map(|(x, _)| x.abs())).1;
    let &(x, y) = finite().reduce(|best, point| if point.1.abs() > best.1.abs() { point } else { best })?;
    let falls = finite().next_back().is_some_and(|(_, end)| end.abs() < FALLEN * y.abs());
    let with_unit = |value: f64, quantity: &Quantity| {
        let text = significant(value, 4);
        if quantity.unit.is_empty() { text } else { format!("{text} {}", quantity.unit) }
    };
    let label = || format!("peak {} at {}", with_unit(y, &figure.y), with_unit(x, &figure.x));
    let is_peak = falls && x.abs() > 0.0 && x.abs() < reach;
    is_peak.then(|| Marks { label: label(), points: vec![(x, y)], line: Some(0) })
}

/// A curve that ends below this part of its greatest value has a peak.
const FALLEN: f64 = 0.95;

/// The loads of which the residual strengths of a notched beam are made.
fn strengths(figure: &Figure) -> Option<Marks> {
    let line = figure.lines.first().filter(|line| line.columns.0 == "cmod")?;
    let at = |cmod: f64| {
        let pair = line.points.windows(2).find(|pair| pair[1].0 >= cmod)?;
        let [(left, low), (right, high)] = [pair[0], pair[1]];
        let part = if right > left { (cmod - left) / (right - left) } else { 1.0 };
        Some((cmod, low + part * (high - low)))
    };
    let points: Vec<(f64, f64)> = RESIDUAL_CMOD.into_iter().filter_map(at).collect();
    (!points.is_empty()).then(|| Marks { label: "f_{R1} to f_{R4}".into(), points, line: Some(0) })
}

/// `load_local_slip` → Load against local slip.
fn title(name: &str) -> String {
    const AGAINST: [(&str, &str); 6] = [
        ("_local_slip", "local slip"),
        ("_slip", "slip"),
        ("_strain", "strain"),
        ("_gap", "gap"),
        ("_cmod", "CMOD"),
        ("_w", "crack opening"),
    ];
    // the strain is its own, not what it is drawn against
    let name = if name == "plastic_strain" { "plastic_strain_strain" } else { name };
    let of = AGAINST.iter().find_map(|&(end, x)| Some((name.strip_suffix(end)?, x)));
    let words = of.map_or_else(|| name.replace('_', " "), |(y, x)| format!("{} against {x}", y.replace('_', " ")));
    capital(&words)
}

/// A picture as a list of column pairs.
struct Layout {
    name: String,
    pairs: Vec<(String, String)>,
    equal_units: bool,
    curves: Vec<MeasuredCurve>,
}

impl Layout {
    fn new<Y: Into<String>>(name: &str, pairs: impl IntoIterator<Item = (&'static str, Y)>) -> Self {
        let pairs = pairs.into_iter().map(|(x, y)| (x.to_owned(), y.into())).collect();
        Self { name: name.into(), pairs, equal_units: false, curves: Vec::new() }
    }

    fn pair(name: &str, x: &str, y: &str) -> Self {
        Self { name: name.into(), pairs: vec![(x.into(), y.into())], equal_units: false, curves: Vec::new() }
    }

    /// Columns over a common one; without any there is no picture.
    fn over<Y: Into<String>>(x: &'static str, name: &str, columns: impl IntoIterator<Item = Y>) -> Self {
        Self::new(name, columns.into_iter().map(|y| (x, y)))
    }

    /// A measured curve fits if its columns are shown, or are of the sorts that are shown.
    fn takes(&self, curve: &MeasuredCurve) -> bool {
        let same = |a: &str, b: &str| a == b || (group_of(a) == group_of(b) && group_of(a) != Group::Other);
        !self.equal_units && self.pairs.iter().any(|(x, y)| same(x, &curve.x) && same(y, &curve.y))
    }

    /// `is_first`: it is shown as long as anything moves; others say something only where y does.
    fn figure(&self, runs: &[PlottedRun<'_>], names: &[String], is_first: bool) -> Option<Figure> {
        let several = runs.len() > 1;
        let is_measured = !self.curves.is_empty();
        let is_still = |run: &PlottedRun<'_>| self.pairs.iter().all(|(_, y)| !moves(run, y));
        let mut lines = Vec::new();
        for (k, run) in runs.iter().enumerate() {
            for (pair, (x, y)) in self.pairs.iter().enumerate() {
                let (Some(xs), Some(ys)) = (run.history.column(x), run.history.column(y)) else { continue };
                let points: Vec<_> = xs.iter().copied().zip(ys.iter().copied()).collect();
                if is_measured || moves(run, y) || (is_first && is_still(run) && moves(run, x)) {
                    let label = self.label(run, names.get(k).filter(|_| several), x, y);
                    // one run: a colour a column, and dashes where colours come again; several: a colour a run, a dash a column
                    let (color, dash) = if several { (k, pair) } else { (pair, pair / PALETTE.len()) };
                    let style = Style { color, dash };
                    lines.push(Line { label, points, columns: (x.clone(), y.clone()), style, marked: false });
                }
            }
        }
        let first = runs.first()?;
        let mark = |curve: &MeasuredCurve| {
            let owner = lines.iter().position(|line| line.columns == (curve.x.clone(), curve.y.clone()));
            Marks { label: curve.label.clone(), points: curve.points.clone(), line: owner }
        };
        let mut marks: Vec<Marks> = self.curves.iter().map(mark).collect();
        // several columns of several runs: a colour a run, a dash a column, instead of a name for each of all
        let columns: Vec<&(String, String)> =
            self.pairs.iter().filter(|pair| lines.iter().any(|line| line.columns == **pair)).collect();
        let key = (several && columns.len() > 1).then(|| {
            for line in &mut lines {
                line.style.dash = columns.iter().position(|pair| line.columns == **pair).unwrap_or(0);
            }
            let dashes = columns.iter().filter_map(|(x, y)| self.name_of_pair(first, x, y)).collect();
            Key { colors: names.to_vec(), dashes, shaded: false }
        });
        // runs keep their colours, alike or not
        if !several {
            let places = merge(&mut lines);
            marks.iter_mut().for_each(|marks| marks.line = marks.line.map(|line| places[line]));
        }
        let (x, y) = (self.axis(first, |pair| &pair.0), self.axis(first, |pair| &pair.1));
        let title = if several { String::new() } else { first.spec.title.clone() };
        let figure = Figure {
            name: self.name.clone(),
            title,
            x,
            y,
            lines,
            marks,
            equal_units: self.equal_units,
            key,
            ..Figure::default()
        };
        (!figure.lines.is_empty()).then_some(figure)
    }

    /// The name of two columns; `None`: there are no others.
    fn name_of_pair(&self, run: &PlottedRun<'_>, x: &str, y: &str) -> Option<String> {
        let one_x = self.pairs.iter().all(|pair| pair.0 == self.pairs[0].0);
        let one_y = self.pairs.iter().all(|pair| pair.1 == self.pairs[0].1);
        let name = |column: &str| Quantity::of(column, &run.spec.units).name;
        match (one_x, one_y) {
            (true, true) => None,
            (true, false) => Some(name(y)),
            (false, true) => Some(name(x)),
            (false, false) => Some(format!("{}, {}", name(x), name(y))),
        }
    }

    /// Returns the name of a line, which distinguishes it from the others. `own`: the name of its run, if there are several.
    fn label(&self, run: &PlottedRun<'_>, own: Option<&String>, x: &str, y: &str) -> String {
        let given = run.spec.captions.get(&self.name).and_then(|caption| caption.legend.get(y));
        match (own, given.cloned().or_else(|| self.name_of_pair(run, x, y))) {
            (None, Some(_)) if given.is_some() => given.cloned().unwrap_or_default(),
            (Some(own), Some(pair)) => format!("{own}: {pair}"),
            (Some(own), None) => own.clone(),
            (None, Some(pair)) if self.curves.is_empty() => pair,
            (None, Some(pair)) => format!("{}, {pair}", run.spec.law.replace('_', " ")),
            (None, None) => run.spec.law.replace('_', " "),
        }
    }

    /// The quantity on an axis: the column's, or what the columns have in common.
    fn axis(&self, run: &PlottedRun<'_>, side: impl Fn(&(String, String)) -> &String) -> Quantity {
        let first = self.pairs.first().map_or("", |pair| side(pair).as_str());
        let single = self.pairs.iter().all(|pair| side(pair) == first);
        let own = Quantity::of(first, &run.spec.units);
        if single { own } else { Quantity::common(group_of(first)).unwrap_or(own) }
    }
}

/// Inputs in the name of a run at most.
const MOST_INPUTS: usize = 2;

/// Names of runs: their titles, or of equal ones the inputs that differ, if these are few, or their folders.
fn names(runs: &[PlottedRun<'_>]) -> Vec<String> {
    let differ =
        |names: &[String]| names.iter().enumerate().all(|(k, name)| !name.is_empty() && !names[..k].contains(name));
    let titles: Vec<String> = runs.iter().map(|run| run.spec.title.clone()).collect();
    if differ(&titles) {
        return titles;
    }
    let mut keys: Vec<&String> = runs.iter().flat_map(|run| run.spec.inputs.keys()).collect();
    keys.sort_unstable();
    keys.dedup();
    keys.retain(|key| runs.iter().any(|run| run.spec.inputs.get(*key) != runs[0].spec.inputs.get(*key)));
    if keys.len() <= MOST_INPUTS {
        let value = |run: &PlottedRun<'_>, key: &String| {
            let value = run.spec.inputs.get(key).map_or("–", String::as_str);
            // a step is a sentence
            if value.contains(": ") { format!("{key}: {value}") } else { format!("{key} = {value}") }
        };
        let named = |run: &PlottedRun<'_>| keys.iter().map(|key| value(run, key)).collect::<Vec<_>>().join(", ");
        let inputs: Vec<String> = runs.iter().map(named).collect();
        if differ(&inputs) {
            return inputs;
        }
    }
    let folders: Vec<String> = runs.iter().map(|run| run.name.to_owned()).collect();
    if differ(&folders) {
        return folders;
    }
    (1..=runs.len()).map(|number| format!("run {number}")).collect()
}

/// Makes one line of those that lie on each other, with all their names, and returns the new place of each.
fn merge(lines: &mut Vec<Line>) -> Vec<usize> {
    let all = || lines.iter().flat_map(|line: &Line| &line.points);
    let size = |values: &mut dyn Iterator<Item = f64>| {
        let (least, greatest) = extremes(values.filter(|value| value.is_finite()));
        SAME_LINE * (greatest - least)
    };
    let near = [size(&mut all().map(|point| point.0)), size(&mut all().map(|point| point.1))];
    let is_near = |a: f64, b: f64, near: f64| (a - b).abs() <= near || (a.is_nan() && b.is_nan());
    let is_same = |a: &Line, b: &Line| {
        let mut points = a.points.iter().zip(&b.points);
        a.points.len() == b.points.len()
            && points.all(|(a, b)| is_near(a.0, b.0, near[0]) && is_near(a.1, b.1, near[1]))
    };
    let mut kept: Vec<Line> = Vec::new();
    let mut places = Vec::new();
    for line in std::mem::take(lines) {
        let place = kept.iter().position(|other| is_same(other, &line));
        match place.and_then(|place| kept.get_mut(place)) {
            Some(other) => {
                if other.label != line.label {
                    other.label = format!("{} = {}", other.label, line.label);
                }
            }
            None => kept.push(line),
        }
        places.push(place.unwrap_or(kept.len() - 1));
    }
    *lines = kept;
    places
}

/// Lines that are nowhere further apart than this part of the axes are one to the eye: a line is 2 px wide, of 370 and 540.
const SAME_LINE: f64 = 5e-3;

/// Every measured curve goes into a picture: the first that fits, or one of its own.
fn place_curves(layouts: &mut Vec<Layout>, runs: &[PlottedRun<'_>]) {
    let mut placed: Vec<&MeasuredCurve> = Vec::new();
    for curve in runs.iter().flat_map(|run| &run.spec.curves) {
        if placed.contains(&curve) {
            continue;
        }
        placed.push(curve);
        let pair = (curve.x.clone(), curve.y.clone());
        match layouts.iter_mut().find(|layout| layout.takes(curve)) {
            Some(layout) => {
                if !layout.pairs.contains(&pair) {
                    layout.pairs.push(pair);
                }
                layout.curves.push(curve.clone());
            }
            None => {
                let mut layout = Layout::pair(&format!("{}_{}", pair.1, pair.0), &pair.0, &pair.1);
                layout.curves.push(curve.clone());
                layouts.push(layout);
            }
        }
    }
}

fn point(run: &PlottedRun<'_>, controlled: &[usize]) -> Vec<Layout> {
    let driven = driven_component(run, controlled);
    let (strain, stress) = (STRAIN_NAMES[driven], STRESS_NAMES[driven]);
    let mut layouts = vec![Layout::pair("stress_strain", strain, stress)];
    let damage = columns(run, |column| group_of(column) == Group::Damage);
    let damage = if damage.is_empty() { columns(run, |column| column == "peeq") } else { damage };
    let name = if damage == ["peeq"] { "plastic_strain" } else { "damage_strain" };
    layouts.push(Layout::over(strain, name, damage));
    let ordinate = if span(run, "s12") > span(run, "s22") { "s12" } else { "s22" };
    // one stress alone has no path to show
    let [along, across] = ["s11", ordinate].map(|column| span(run, column));
    if across.min(along) > NEGLIGIBLE_STRESS * across.max(along) {
        layouts.push(Layout { equal_units: true, ..Layout::pair("stress_path", "s11", ordinate) });
    }
    layouts
}

/// Remainder that mixed control leaves of a stress that should vanish, relative to the one that does not.
const NEGLIGIBLE_STRESS: f64 = 1e-6;

/// The controlled component with the largest range of strain (of all six if none is controlled).
fn driven_component(run: &PlottedRun<'_>, controlled: &[usize]) -> usize {
    let all = [0, 1, 2, 3, 4, 5];
    let candidates = if controlled.is_empty() { &all[..] } else { controlled };
    let widest = candidates.iter().filter(|&&component| component < 6).rev();
    widest
        .max_by(|&&a, &&b| span(run, STRAIN_NAMES[a]).total_cmp(&span(run, STRAIN_NAMES[b])))
        .copied()
        .unwrap_or_default()
}

fn interface(run: &PlottedRun<'_>) -> Vec<Layout> {
    let mut tractions = vec![("slip", "tau")];
    if span(run, "slip2") > 0.0 {
        tractions.push(("slip2", "tau2"));
    }
    let mut layouts = vec![Layout::new("traction_slip", tractions)];
    if span(run, "gap") > 0.0 {
        layouts.push(Layout::pair("pressure_gap", "gap", "p"));
    }
    if span(run, "p") > 0.0 {
        layouts.push(Layout { equal_units: true, ..Layout::pair("traction_path", "p", "tau") });
    }
    layouts.push(Layout::over("slip", "damage_slip", columns(run, |column| group_of(column) == Group::Damage)));
    if run.history.column("kappa").is_some() {
        layouts.push(Layout::pair("kappa_slip", "slip", "kappa"));
    }
    layouts
}

fn pullout(run: &PlottedRun<'_>) -> Vec<Layout> {
    let mut layouts = vec![Layout::pair("load_slip", "slip", "load")];
    let is_other = |column: &&str| span(run, column) > 0.0 && !lies_on(run, column, "slip");
    let others = ["slip_exit", "slip_tail"].into_iter().filter(is_other);
    layouts.push(Layout::new("load_local_slip", others.map(|column| (column, "load"))));
    // components of an inclined fibre's load: along a perpendicular one the axial is the load
    if span(run, "load_shear") > NEGLIGIBLE_SHEAR * span(run, "load") {
        layouts.push(Layout::over("slip", "load_components", ["load_axial", "load_shear"]));
    }
    let lengths_and_volumes = [
        ("separation", "separation_length"),
        ("damaged_volume", "damaged_volume"),
        ("spalled_volume", "spalled_volume"),
        ("spalled_depth", "spalled_depth"),
    ];
    for (name, column) in lengths_and_volumes {
        if span(run, column) > 0.0 {
            layouts.push(Layout::pair(name, "slip", column));
        }
    }
    for (name, group) in [("energies", Group::Energy), ("points", Group::Count)] {
        let moving = columns(run, |column| group_of(column) == group && span(run, column) > 0.0);
        layouts.push(Layout::over("slip", name, moving));
    }
    layouts.push(Layout::pair("iterations", "time", "iterations"));
    layouts
}

/// The beam, if there is one; σ(w) with its band, what fibres of each angle carry of it, and those that broke.
fn bridging(run: &PlottedRun<'_>) -> Vec<Layout> {
    let beam = Layout::over("cmod", "load_cmod", ["load", "load_05", "load_50", "load_95"]);
    let mut layouts: Vec<Layout> = run.history.column("cmod").map(|_| beam).into_iter().collect();
    layouts.extend([
        Layout::over("w", "sigma_w", ["sigma", "sigma_fibre", "sigma_matrix", "sigma_05", "sigma_95"]),
        Layout::over("w", "shares_w", columns(run, |column| group_of(column) == Group::Share)),
    ]);
    if span(run, "ruptured") > 0.0 {
        layouts.push(Layout::pair("ruptured_w", "w", "ruptured"));
    }
    layouts
}

/// Remainder of a shear component from rounding and the lateral reaction of a perpendicular fibre, over the load.
const NEGLIGIBLE_SHEAR: f64 = 1e-2;

fn columns(run: &PlottedRun<'_>, wanted: impl Fn(&str) -> bool) -> Vec<String> {
    run.history.columns().iter().filter(|column| wanted(column)).cloned().collect()
}

/// Returns whether a column changes by more than the rounding of the largest value in its group.
fn moves(run: &PlottedRun<'_>, column: &str) -> bool {
    let group = group_of(column);
    let is_alike = |other: &&String| *other == column || (group != Group::Other && group_of(other) == group);
    let alike = run.history.columns().iter().filter(is_alike);
    let values = alike.flat_map(|column| run.history.column(column).unwrap_or_default());
    let greatest = extremes(values.map(|value| value.abs()).filter(|value| value.is_finite())).1;
    span(run, column) > ROUNDING * greatest.max(0.0)
}

/// Returns whether two columns are one to the eye.
fn lies_on(run: &PlottedRun<'_>, column: &str, other: &str) -> bool {
    let [values, others] = [column, other].map(|name| run.history.column(name).unwrap_or_default());
    let apart = values.iter().zip(others).map(|(a, b)| (a - b).abs()).filter(|apart| apart.is_finite());
    extremes(apart).1 <= SAME_LINE * span(run, other)
}

/// Greatest less least finite value; 0 without any.
fn span(run: &PlottedRun<'_>, column: &str) -> f64 {
    let values = run.history.column(column).unwrap_or_default().iter().copied();
    let (least, greatest) = extremes(values.filter(|value| value.is_finite()));
    (greatest - least).max(0.0)
}
