//! Reading of study files into a [`Study`], with everything that is wrong with them and with the cases of their runs at
//! once.

use super::{Abscissa, Claim, Columns, Demand, Member, Quantity, RunSeries, Study, StudyRun};
use pullout_case::study::{
    ClaimOfFile, Expectation, MemberName, MemberOfFile, NamedQuantity, OneOrMany, SeriesOfFile, StudyFile,
};
use pullout_case::{CaseErrors, CaseProblem, JsonPlace, Reader, hint, read_study};
use pullout_engine::CaseSource;
use pullout_report::plots::quantity::Quantity as Shown;
use pullout_run::input::is_stream;
use pullout_run::number;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Name of the only series of a study without series.
const ONLY_SERIES: &str = "runs";
/// Names in the study's directory that are no series.
const RESERVED: [&str; 8] = [
    "plots",
    "study.csv",
    "study.json",
    "report.html",
    "manifest.json",
    "previous",
    // of the runs below them
    "summary.json",
    "history.csv",
];
/// Bytes of a name: file systems take 255.
const LONGEST_NAME: usize = 200;

/// Reads a study file and checks the cases of all its runs.
///
/// The overrides of `of` apply to all runs, after their own. Cases for which `isolated` returns true are not read here, because
/// their plugins must not be loaded.
///
/// # Errors
/// Everything that is wrong with the file and with the cases.
pub fn read(of: &CaseSource, isolated: &mut dyn FnMut(&CaseSource) -> bool) -> Result<Study, CaseErrors> {
    let file = &of.file;
    let mut reader = of.reader();
    let study = read_study(&mut reader, file, |reader, document: StudyFile| {
        Resolver { reader, of, demands: Vec::new() }.study(&document, isolated)
    });
    let problems = reader.into_problems();
    match study {
        Some(study) if problems.is_empty() => Ok(study),
        _ => Err(CaseErrors { file: file.into(), problems }),
    }
}

struct Resolver<'r, 'p> {
    reader: &'r mut Reader<'p>,
    /// The study's file.
    of: &'r CaseSource,
    /// The history columns that are named.
    demands: Vec<Demand>,
}

/// A list's entry with its place in the file.
type Placed<'d, T> = (JsonPlace, &'d T);

/// The entries of a list with their places.
fn placed<'d, T>(list: &'d [T], place: &JsonPlace) -> Vec<Placed<'d, T>> {
    list.iter().enumerate().map(|(k, entry)| (place.index(k), entry)).collect()
}

impl Resolver<'_, '_> {
    fn problem(&mut self, place: &JsonPlace, message: impl Into<String>) {
        self.reader.problem(place, message);
    }

    fn study(mut self, document: &StudyFile, isolated: &mut dyn FnMut(&CaseSource) -> bool) -> Option<Study> {
        let root = JsonPlace::root();
        let x = document.x.clone();
        let set = document.set.clone().unwrap_or_default();
        let members_of_file = placed(&document.members, &root.key("members"));
        let series_of_file = placed(document.series.as_deref().unwrap_or_default(), &root.key("series"));
        let members = self.members(&members_of_file, x.as_ref());
        let series = self.series(&series_of_file);
        if document.work_to == Some(0.0) {
            self.problem(&root.key("work_to"), "must not be 0");
        }
        let given = document.curve.clone();
        let overlays = placed(document.overlays.as_deref().unwrap_or_default(), &root.key("overlays"));
        let claims = placed(document.claims.as_deref().unwrap_or_default(), &root.key("claims"));
        let base_file = self.reader.file(&document.base, &root.key("base"))?;
        let runs = Runs { base: &document.base, set: &set, members: &members_of_file, series: &series_of_file };
        let (runs, columns) = self.runs(&runs, &members, &series, isolated);
        let curve = given
            .clone()
            .unwrap_or_else(|| default_curve(&pullout_case::document(&base_file, &[]).unwrap_or_default()));
        if given.is_some() {
            self.demands.extend(Demand::of_curve(&curve, &root.key("curve")));
        }
        let overlays = overlays.into_iter().map(|(place, pair)| {
            self.demands.extend(Demand::of_curve(pair, &place));
            pair.clone()
        });
        let overlays = overlays.collect();
        let cast = ClaimScope { members: &members, series: &series, curve: &curve };
        let claims: Vec<Claim> =
            claims.into_iter().filter_map(|(place, claim)| self.claim(claim, &cast, &place)).collect();
        if let Some(columns) = &columns {
            Demand::unmet(&self.demands, columns).into_iter().for_each(|problem| self.reader.push(problem));
        }
        let unit = |column: &str| Shown::of(column, &Default::default()).unit;
        Some(Study {
            file: self.of.file.clone(),
            title: document.head.title.clone().unwrap_or_else(|| stem(&self.of.file)),
            description: document.head.description.clone().unwrap_or_default(),
            x: x.filter(|_| members.iter().all(|member| member.x.is_some())),
            units: [unit(&curve.x), unit(&curve.y)],
            members,
            series,
            runs: runs?,
            curve,
            work_to: document.work_to,
            overlays,
            claims,
            demands: self.demands,
        })
    }

    fn members(&mut self, of_file: &[Placed<'_, MemberOfFile>], x: Option<&Abscissa>) -> Vec<Member> {
        let mut labels = BTreeSet::new();
        let with_x = of_file.iter().filter(|(_, member)| member.x.is_some()).count();
        let mut members = Vec::new();
        for (place, member) in of_file {
            self.directory_name(&member.label, &mut labels, &place.key("label"));
            if member.x.is_none() && with_x > 0 {
                self.problem(&place.key("x"), "is missing: other members have one");
            }
            if x.is_some_and(|x| x.logarithmic) && member.x.is_some_and(|x| x <= 0.0) {
                self.problem(&place.key("x"), "must be > 0 on a logarithmic axis");
            }
            let of_x = member.x.zip(x).map(|(value, x)| titled(value, &x.unit));
            members.push(Member {
                label: member.label.clone(),
                title: member.title.clone().or(of_x).unwrap_or_else(|| member.label.clone()),
                x: member.x,
            });
        }
        if with_x > 0 && x.is_none() {
            self.problem(&JsonPlace::root().key("x"), "is missing: members have an x, and this is its name");
        }
        if with_x == 0 && x.is_some() && !of_file.is_empty() {
            self.problem(&JsonPlace::root().key("x"), "no member has an x");
        }
        members
    }

    fn series(&mut self, of_file: &[Placed<'_, SeriesOfFile>]) -> Vec<RunSeries> {
        if of_file.is_empty() {
            return vec![RunSeries { name: ONLY_SERIES.into(), title: String::new() }];
        }
        let mut names = BTreeSet::new();
        let mut all = Vec::new();
        for (place, series) in of_file {
            self.directory_name(&series.name, &mut names, &place.key("name"));
            if RESERVED.contains(&series.name.to_lowercase().as_str()) {
                self.problem(&place.key("name"), "is a name in the study's own directory; choose another");
            }
            let title = series.title.clone().unwrap_or_else(|| series.name.clone());
            all.push(RunSeries { name: series.name.clone(), title });
        }
        all
    }

    /// A name that becomes a directory.
    fn directory_name(&mut self, name: &str, taken: &mut BTreeSet<String>, place: &JsonPlace) {
        let is_allowed = |c: char| c.is_alphanumeric() || "_-+.,=".contains(c);
        if !name.chars().all(is_allowed) || name.starts_with('.') {
            let message = format!(
                "'{name}' names a directory: letters, digits and _ - + . , = without a leading dot; \"title\" is free"
            );
            self.problem(place, message);
        }
        if name.is_empty() || name.len() > LONGEST_NAME {
            let message =
                format!("names a directory: 1 to {LONGEST_NAME} bytes, not {}; \"title\" is free", name.len());
            self.problem(place, message);
        }
        // some file systems do not distinguish capitals from small letters
        if !taken.insert(name.to_lowercase()) {
            self.problem(place, format!("'{name}' is given twice"));
        }
    }

    /// All runs with their cases checked, and the history columns that they have in common.
    fn runs(
        &mut self,
        plan: &Runs<'_>,
        members: &[Member],
        series: &[RunSeries],
        isolated: &mut dyn FnMut(&CaseSource) -> bool,
    ) -> (Option<Vec<StudyRun>>, Option<Vec<String>>) {
        let mut runs = Vec::new();
        let mut complaints: Vec<Complaint> = Vec::new();
        let mut columns: Option<Vec<String>> = None;
        for (s, one_series) in series.iter().enumerate() {
            let given = plan.series.get(s).map(|(_, series)| *series);
            let base = given.and_then(|series| series.base.as_deref()).unwrap_or(plan.base);
            let place = JsonPlace::root();
            let place = given
                .filter(|series| series.base.is_some())
                .map_or(place.key("base"), |_| place.key("series").index(s).key("base"));
            let Some(base) = self.reader.file(base, &place) else { return (None, None) };
            if is_stream(&base) {
                self.problem(
                    &place,
                    format!("{}: is a pipe or a device: each run reads its case from a file", base.display()),
                );
                return (None, None);
            }
            for (m, member) in members.iter().enumerate() {
                let of_series = given.and_then(|series| series.set.as_ref());
                let own = plan.members[m].1.set.as_ref();
                let sets = [Some(plan.set), of_series, own].into_iter().flatten();
                let mut overrides: Vec<String> = sets.flat_map(texts).collect();
                overrides.extend_from_slice(&self.of.overrides);
                let mut run = StudyRun {
                    series: s,
                    member: m,
                    folder: Path::new(&one_series.name).join(&member.label),
                    case: CaseSource { file: base.clone(), overrides, ..self.of.clone() },
                    ..StudyRun::default()
                };
                if isolated(&run.case) {
                    run.fingerprint = run.case.key(None);
                } else {
                    match run.case.case() {
                        Ok(case) => {
                            run.fingerprint = run.case.key(Some(case.libraries()));
                            run.warnings = case.about().warnings.to_vec();
                            let own = case.columns_of_numbers();
                            let common = columns.take();
                            columns = Some(common.map_or(own.clone(), |common| {
                                common.into_iter().filter(|column| own.contains(column)).collect()
                            }));
                        }
                        Err(errors) => complaints.extend(errors.problems.into_iter().map(|problem| Complaint {
                            problem,
                            base: errors.file.clone(),
                            runs: vec![(s, m)],
                        })),
                    }
                }
                runs.push(run);
            }
        }
        let is_fine = complaints.is_empty();
        self.complain(complaints, runs.len(), members, series);
        (is_fine.then_some(runs), columns)
    }

    /// Reports the problems of cases, each once.
    fn complain(&mut self, complaints: Vec<Complaint>, count: usize, members: &[Member], series: &[RunSeries]) {
        let mut gathered: Vec<Complaint> = Vec::new();
        for complaint in complaints {
            let is_same = |other: &&mut Complaint| other.problem == complaint.problem && other.base == complaint.base;
            match gathered.iter_mut().find(is_same) {
                Some(other) => other.runs.extend(complaint.runs),
                None => gathered.push(complaint),
            }
        }
        for Complaint { problem, base, runs } in gathered {
            let root = JsonPlace::root();
            let first_member = runs[0].1;
            let place = if runs.len() == count {
                root.key("base")
            } else if runs.iter().all(|&(_, member)| member == first_member) {
                root.key("members").index(first_member)
            } else {
                root.key("series").index(runs[0].0)
            };
            let names: Vec<String> =
                runs.iter().take(3).map(|&(s, m)| format!("{}/{}", series[s].name, members[m].label)).collect();
            let names = match runs.len() {
                all if all == count => "all runs".to_owned(),
                more if more > 3 => format!("{} and {} more", names.join(", "), more - 3),
                _ => names.join(", "),
            };
            let message = format!("{names}: {}: {problem}", base.display());
            self.reader.push(CaseProblem { place: Some(place), message, kind: problem.kind });
        }
    }

    fn claim(&mut self, claim: &ClaimOfFile, cast: &ClaimScope<'_>, place: &JsonPlace) -> Option<Claim> {
        let series = match &claim.series {
            None => (0..cast.series.len()).map(Some).collect(),
            Some(OneOrMany::One(name)) => vec![self.series_named(name, cast, &place.key("series"))],
            Some(OneOrMany::Many(names)) => {
                let place = place.key("series");
                names.iter().enumerate().map(|(k, name)| self.series_named(name, cast, &place.index(k))).collect()
            }
        };
        let series: Option<Vec<usize>> = series.into_iter().collect();
        let members: Option<Vec<usize>> = match &claim.members {
            None => Some((0..cast.members.len()).collect()),
            Some(names) => {
                let place = place.key("members");
                let found = names.iter().enumerate().map(|(k, name)| self.member(name, cast, &place.index(k)));
                found.collect::<Vec<_>>().into_iter().collect()
            }
        };
        let quantity = claim.quantity.clone().unwrap_or(Quantity::Named(NamedQuantity::Peak));
        self.demands.extend(Demand::of_quantity(&quantity, cast.curve, &place.key("quantity")));
        let expectation = self.expectation(&claim.expect, cast, &place.key("expect"));
        let mut members = members?;
        let x = |member: &usize| cast.members[*member].x.unwrap_or(0.0);
        members.sort_by(|a, b| x(a).total_cmp(&x(b)));
        if matches!(expectation, Some(Expectation::Trend { .. })) && members.len() < 2 {
            self.problem(&place.key("expect"), "a trend needs two members");
        }
        if let Some(Expectation::MaximumBetween { maximum_between }) = expectation {
            let inside = members.iter().filter(|&&member| cast.members[member].is_between(maximum_between)).count();
            let place = place.key("expect").key("maximum_between");
            let [lower, upper] = maximum_between;
            if inside == 0 {
                self.problem(&place, format!("no member has an x strictly between {lower} and {upper}"));
            } else if inside == members.len() {
                self.problem(&place, format!("every member has an x strictly between {lower} and {upper}"));
            }
        }
        Some(Claim { claim: claim.claim.clone(), series: series?, members, quantity, expectation: expectation? })
    }

    fn expectation(
        &mut self,
        given: &Expectation<MemberName, String>,
        cast: &ClaimScope<'_>,
        place: &JsonPlace,
    ) -> Option<Expectation> {
        let mut member = |name: &MemberName, key: &str| self.member(name, cast, &place.key(key));
        Some(match *given {
            Expectation::Trend { trend, tolerance } => Expectation::Trend { trend, tolerance },
            Expectation::Maximum { ref maximum_at } => {
                Expectation::Maximum { maximum_at: member(maximum_at, "maximum_at")? }
            }
            Expectation::MaximumBetween { maximum_between } => Expectation::MaximumBetween { maximum_between },
            Expectation::Minimum { ref minimum_at } => {
                Expectation::Minimum { minimum_at: member(minimum_at, "minimum_at")? }
            }
            Expectation::Within { within, ref of } => Expectation::Within { within, of: member(of, "of")? },
            Expectation::Curve { curve_within, ref of } => Expectation::Curve { curve_within, of: member(of, "of")? },
            Expectation::Above { ref above } => {
                Expectation::Above { above: self.series_named(above, cast, &place.key("above"))? }
            }
            Expectation::Below { ref below } => {
                Expectation::Below { below: self.series_named(below, cast, &place.key("below"))? }
            }
            Expectation::Ratio { ref ratio_of, ref to, greater_than, less_than } => {
                self.bounds(greater_than, less_than, place)?;
                let ratio_of = self.member(ratio_of, cast, &place.key("ratio_of"))?;
                Expectation::Ratio { ratio_of, to: self.member(to, cast, &place.key("to"))?, greater_than, less_than }
            }
            Expectation::OverSeries { ref over_series, greater_than, less_than } => {
                self.bounds(greater_than, less_than, place)?;
                let over_series = self.series_named(over_series, cast, &place.key("over_series"))?;
                Expectation::OverSeries { over_series, greater_than, less_than }
            }
            Expectation::Bounds { greater_than, less_than } => {
                self.bounds(greater_than, less_than, place)?;
                Expectation::Bounds { greater_than, less_than }
            }
            Expectation::Done { done } => Expectation::Done { done },
        })
    }

    fn bounds(&mut self, lower: Option<f64>, upper: Option<f64>, place: &JsonPlace) -> Option<()> {
        match (lower, upper) {
            (None, None) => {
                self.problem(place, "give greater_than, less_than or both");
                None
            }
            (Some(lower), Some(upper)) if lower >= upper => {
                self.problem(place, format!("nothing is greater than {lower} and less than {upper}"));
                None
            }
            _ => Some(()),
        }
    }

    fn series_named(&mut self, name: &str, cast: &ClaimScope<'_>, place: &JsonPlace) -> Option<usize> {
        let found = cast.series.iter().position(|series| series.name == name);
        if found.is_none() {
            let names = cast.series.iter().map(|series| series.name.as_str());
            self.problem(place, format!("there is no series '{name}'{}", hint(name, names)));
        }
        found
    }

    fn member(&mut self, name: &MemberName, cast: &ClaimScope<'_>, place: &JsonPlace) -> Option<usize> {
        let found = match name {
            MemberName::X(x) => cast.members.iter().position(|member| member.x == Some(*x)),
            MemberName::Label(label) => cast.members.iter().position(|member| member.label == *label),
        };
        if found.is_none() {
            let message = match name {
                MemberName::X(x) => {
                    let all: Vec<String> = cast.members.iter().filter_map(|m| m.x).map(|x| x.to_string()).collect();
                    format!("no member has x = {x}; valid are {}", all.join(", "))
                }
                MemberName::Label(label) => {
                    let labels = cast.members.iter().map(|member| member.label.as_str());
                    format!("there is no member '{label}'{}", hint(label, labels))
                }
            };
            self.problem(place, message);
        }
        found
    }
}

/// Base case and overrides of the runs.
struct Runs<'d> {
    base: &'d str,
    set: &'d Map<String, Value>,
    members: &'d [Placed<'d, MemberOfFile>],
    series: &'d [Placed<'d, SeriesOfFile>],
}

/// Members, series and curve that claims refer to.
struct ClaimScope<'a> {
    members: &'a [Member],
    series: &'a [RunSeries],
    curve: &'a Columns,
}

/// A problem with the case of runs, by series and member.
struct Complaint {
    problem: CaseProblem,
    base: PathBuf,
    runs: Vec<(usize, usize)>,
}

/// Returns the texts as `--set` has them.
fn texts(set: &Map<String, Value>) -> impl Iterator<Item = String> + '_ {
    set.iter().map(|(path, value)| format!("{path}={value}"))
}

/// Returns the default curve for the kind of a case: load against slip, τ against slip, σ11 against ε11, or σ against w.
pub fn default_curve(case: &Value) -> Columns {
    let kind = &case["kind"];
    let (x, y) = match kind.as_str() {
        Some("point") => ("e11", "s11"),
        Some("interface") => ("slip", "tau"),
        Some("bridging") => ("w", "sigma"),
        _ => ("slip", "load"),
    };
    Columns { x: x.into(), y: y.into() }
}

/// "45°", "1000 MPa".
fn titled(value: f64, unit: &str) -> String {
    let value = number::significant(value, 6);
    match unit {
        "" => value,
        "°" => format!("{value}°"),
        unit => format!("{value} {unit}"),
    }
}

fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into())
}
