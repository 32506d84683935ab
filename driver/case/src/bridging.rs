//! Kind "bridging": fibres across a crack.

use crate::concrete;
use crate::document::Plots;
use crate::document::Positive;
use crate::document::bridging::{
    BridgingCase, FeFibre, FibreOfFile, MatrixOfFile, Openings, ShearLagFibre, Spacing, TableFibre,
};
use crate::history;
use crate::problem::{Place, Problem};
use crate::reader::{Reader, USUAL_STRENGTH_OF_WIRES, UsedDefaults};
use crate::table::CsvFile;
use pullout_bridging::{
    Bond, BondLaw, Closed, Curve, Fibre, Inclination, Invalid, Matrix, NotchedBeam, Orientation, Scatter, ShearLag,
    Softening,
};
use pullout_run::bridging::{
    BridgingProgram, Curves, FibreSimulation, ForeignTables, LoadSource, OPENINGS, Simulations,
};
use pullout_run::columns::{self, LEADING};
use pullout_run::input::is_stream;
use pullout_run::number::significant;
use pullout_run::path::{self, Observer, Row, Statistics, Stop};
use pullout_run::program::{self, About};
use pullout_run::pullout::{self, FibreAxis};
use serde_json::{Value, json};
use std::array::from_fn;
use std::io;
use std::path::Path;

/// Beyond this angle fibres of tables carry nothing, degrees.
const USUAL_CUT: f64 = 80.0;
/// The first slip at which a plugin's law is asked at first, mm, and how many follow in each decade,
const FIRST_SLIP: f64 = 1e-4;
const SLIPS_PER_DECADE: f64 = 25.0;
/// between which it is asked again where it is off the straight line by more than this part of its greatest traction,
/// or, from slip 0 on, of the traction there,
const LARGEST_DEVIATION: f64 = 1e-4;
const LARGEST_DEVIATION_OF_SLOPE: f64 = 1e-2;
/// unless slips are as close as this part of the fibre's length, or as many as this.
const LEAST_INTERVAL: f64 = 1e-9;
const MOST_SLIPS: usize = 5000;
/// Slips that differ by less than this part are the same.
const ROUNDING: f64 = 1e-12;
/// Angles of runs of a specimen unless the case says otherwise, degrees,
const ANGLES_DEG: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];
/// and lengths, as parts of half the fibre's.
const LENGTHS: [f64; 5] = [0.125, 0.25, 0.5, 0.75, 1.0];
/// Fibres that reach less deep are not run, in diameters.
const LEAST_DEPTH: f64 = 2.0;
/// A load below minus this part of the greatest is no scatter about 0: the signs are wrong.
const LARGEST_COMPRESSION: f64 = 0.2;
/// Diameters that differ by this part are the same,
const SAME_DIAMETER: f64 = 1e-6;
/// lengths that differ by this part (the chords of bends are shorter than their arcs), and angles, degrees.
const SAME_LENGTH: f64 = 0.02;
const SAME_ANGLE: f64 = 0.01;
/// Keys of a specimen for angle and embedded length, and those for a fibre with a path.
const KEYS: [&str; 2] = ["mesh.specimen.angle_deg", "mesh.specimen.embedded_length"];
const KEYS_OF_PATH: [&str; 2] = ["mesh.specimen.fibres.0.rotate_deg", "mesh.specimen.fibres.0.embedded"];

/// A hook that reaches this part of the load of all its hinges has them full at once.
const ALL_FULL: f64 = 0.999;

/// Usual ranges of some numbers; values outside are probably mistakes.
const USUAL_SNUBBING: [f64; 2] = [0.0, 2.0];
const USUAL_TENSILE_STRENGTH: [f64; 2] = [0.1, 30.0];

/// Reads other cases that one of bridging takes curves of, or says what is wrong with them.
pub struct ReferencedCases {
    /// Reads a specimen with overrides: `None` if that is not to be done here.
    pub specimen: fn(&Reader<'_>, &Path, &[String]) -> ReadSpecimen,
    /// A case's document as it stands, if it is one.
    pub document: fn(&Path) -> Option<Value>,
    /// Reads a law of contact and the steps along which it is called.
    pub law: fn(&Reader<'_>, &Value, &[Value]) -> ReadLaw,
}

/// A specimen, or what is wrong.
pub type ReadSpecimen = Result<Option<Box<pullout::PulloutProgram>>, WrongSpecimen>;

/// Reason why a specimen gives no curve, and the place in its case.
pub struct WrongSpecimen {
    /// Where, if it is one place.
    pub place: Option<Place>,
    /// What.
    pub message: String,
}
/// A law of contact, or what is wrong with it, at its place in the case of bridging.
pub type ReadLaw = Result<Box<program::Program>, Problem>;

/// Resolves a case; what is wrong with it goes to the reader.
pub fn resolve(
    reader: &mut Reader<'_>,
    path: &Path,
    case: &BridgingCase,
    others: &ReferencedCases,
) -> Option<BridgingProgram> {
    let root = Place::root();
    let fibre = fibre(reader, others, &case.fibre);
    let orientation = counted(reader, case.orientation.clone().unwrap_or(Orientation::Random3d));
    let BridgingCase { volume_fraction: Positive(volume_fraction), beam, scatter, .. } = *case;
    let matrix = matrix(reader, &case.matrix, beam.is_some());
    if scatter.is_some() && beam.is_none() {
        reader.problem(&root.key("scatter"), "is of beams: give \"beam\" too ({} is that of EN 14651)");
    }
    // each on its own, so that all problems are reported at once
    let length = fibre.as_ref().map(|(fibre, _)| fibre.length);
    let checks = [
        matrix.map(|matrix| matrix.check()),
        beam.map(|beam| beam.check()),
        scatter.map(|scatter| scatter.check()),
        orientation.as_ref().zip(length).map(|(orientation, length)| orientation.directions(length, &[]).map(drop)),
    ];
    checks.into_iter().flatten().for_each(|checked| report_invalid(reader, checked));
    let matrix = matrix?;
    if reader.problems.is_empty() {
        warn_of_effect(reader, fibre.as_ref(), &matrix, scatter, beam.is_some());
        if matrix.softening == Softening::None && case.matrix.fracture_energy.is_some() {
            let why = "without \"softening\" the matrix carries nothing once it has cracked";
            reader.warn_no_effect(&root.key("matrix").key("Gf"), why);
        }
        warn_of_units(reader, fibre.as_ref(), &matrix, beam.as_ref());
        note_hook(reader, fibre.as_ref());
    }
    let output = case.output.clone().unwrap_or_default();
    let program = fibre.zip(orientation).map(|((fibre, source), orientation)| {
        let composite = fibre.modulus * volume_fraction / (matrix.modulus * (1.0 - volume_fraction));
        BridgingProgram {
            about: About::default(),
            fibre,
            source,
            sides: case.sides.unwrap_or_default(),
            volume_fraction,
            modular_ratio: case.modular_ratio.unwrap_or(composite),
            matrix,
            orientation,
            activation: case.activation.unwrap_or(0.0),
            openings: openings(case.openings.unwrap_or_default()),
            beam,
            scatter,
            tables: ForeignTables {
                abaqus: output.abaqus.unwrap_or(false),
                crack_band: output.crack_band.map(|width| width.0),
            },
        }
    });
    let columns = program.as_ref().map(BridgingProgram::columns);
    let about = history::about(reader, path, &case.head, None, columns.as_deref());
    check_tables(reader, &about, columns.as_deref().unwrap_or_default());
    let (plots, captions) = Plots::of(output.plots.as_ref());
    let about = About {
        every: 1,
        plots,
        captions,
        warnings: std::mem::take(&mut reader.warnings),
        notes: std::mem::take(&mut reader.notes),
        highlights: std::mem::take(&mut reader.highlights),
        defaults: std::mem::take(&mut reader.defaults),
        ..about
    };
    let program = BridgingProgram { about, ..program? };
    if reader.problems.is_empty() {
        let checked = match &program.source {
            // without its curves: by those of a bond
            LoadSource::Simulated(_) => BridgingProgram { source: stand_in(), ..program.clone() }.composite(&[]),
            _ => program.composite(&[]),
        };
        report_invalid(reader, checked.map(drop));
    }
    Some(program)
}

/// The matrix: its own numbers, and for those that it leaves out the class's; a beam is crushed at the class's strength.
fn matrix(reader: &mut Reader<'_>, given: &MatrixOfFile, has_beam: bool) -> Option<Matrix> {
    let place = Place::root().key("matrix");
    let concrete = match &given.concrete {
        Some(class) => Some(concrete::resolve(reader, class, &place.key("concrete"))?),
        None => None,
    };
    let mut required = |key: &str, value: Option<f64>, of_class: Option<f64>| {
        let value = value.or(of_class);
        if value.is_none() {
            reader.push(Problem::structure(place.key(key), "is missing: give it, or the class of the \"concrete\""));
        }
        value
    };
    let modulus = required("E", given.modulus, concrete.map(|concrete| concrete.modulus));
    let ft = required("ft", given.ft, concrete.map(|concrete| concrete.tensile_strength));
    Some(Matrix {
        modulus: modulus?,
        ft: ft?,
        softening: given.softening.unwrap_or(if concrete.is_some() { Softening::Bilinear } else { Softening::None }),
        fracture_energy: given.fracture_energy.or(concrete.map(|concrete| concrete.fracture_energy)).unwrap_or(0.0),
        fc: given.fc.or(concrete.filter(|_| has_beam).map(|concrete| concrete.compressive_strength)),
    })
}

/// Warns of numbers that nothing asks for.
fn warn_of_effect(
    reader: &mut Reader<'_>,
    fibre: Option<&(Fibre, LoadSource)>,
    matrix: &Matrix,
    scatter: Option<Scatter>,
    has_beam: bool,
) {
    let unbroken = fibre.is_some_and(|(fibre, _)| fibre.strength.is_none());
    let rupture = fibre.is_some_and(|(fibre, _)| fibre.rupture_f != 0.0);
    let varied = scatter.is_some_and(|scatter| scatter.strength_cv != 0.0);
    let crushed = matrix.fc.is_some();
    for (is_idle, [of, key], why) in [
        (unbroken && rupture, ["fibre", "rupture_f"], "without \"strength\" the fibre does not break"),
        (unbroken && varied, ["scatter", "strength_cv"], "without \"strength\" the fibre does not break"),
        (crushed && !has_beam, ["matrix", "fc"], "it is the compressive strength of a beam, and there is no \"beam\""),
    ] {
        if is_idle {
            reader.warn_no_effect(&Place::root().key(of).key(key), why);
        }
    }
}

/// Notes a hook whose hinges are never all full at once.
fn note_hook(reader: &mut Reader<'_>, fibre: Option<&(Fibre, LoadSource)>) {
    let Some((fibre, LoadSource::Bond(Bond::Closed(Closed { hook: Some(hook), .. }), _))) = fibre else { return };
    let [greatest, full] = hook.greatest_loads(fibre);
    if greatest < ALL_FULL * full {
        reader.highlight(format!(
            "hook: at most {} N of the {} N of all hinges: each comes and goes over {} mm of slip, the arc of radius {} mm, and the \
             first bend is straight before the others carry fully",
            significant(greatest, 3),
            significant(full, 3),
            significant(hook.arc(), 3),
            significant(hook.radius, 3),
        ));
    }
}

/// Warns of numbers beyond what is usual.
fn warn_of_units(
    reader: &mut Reader<'_>,
    fibre: Option<&(Fibre, LoadSource)>,
    matrix: &Matrix,
    beam: Option<&NotchedBeam>,
) {
    let mut given = Vec::new();
    given.extend(beam.map(|beam| ("beam.height", beam.height, "mm", [10.0, 3000.0])));
    if let Some((fibre, source)) = fibre {
        given.extend([
            ("fibre.diameter", fibre.diameter, "mm", [0.002, 5.0]),
            ("fibre.length", fibre.length, "mm", [0.5, 200.0]),
            ("fibre.E", fibre.modulus, "MPa", [1e3, 1e6]),
        ]);
        given.extend(fibre.strength.map(|strength| ("fibre.strength", strength, "MPa", USUAL_STRENGTH_OF_WIRES)));
        if let LoadSource::Bond(bond, inclination) = source {
            if let Bond::Closed(closed) = bond {
                given.push(("fibre.tau", closed.tau, "MPa", [1e-3, 100.0]));
                let yield_stress = closed.hook.as_ref().and_then(|hook| hook.yield_stress);
                given.extend(
                    yield_stress.map(|stress| ("fibre.hook.yield_stress", stress, "MPa", USUAL_STRENGTH_OF_WIRES)),
                );
            }
            match *inclination {
                Inclination::Exp { f } | Inclination::ExpCos { f, .. } | Inclination::Hinge { f, .. } => {
                    given.push(("fibre.inclination.f", f, "", USUAL_SNUBBING));
                }
                Inclination::Spalling { k, ft, .. } => {
                    given.push(("fibre.inclination.k", k, "", USUAL_SNUBBING));
                    given.push(("fibre.inclination.ft", ft, "MPa", USUAL_TENSILE_STRENGTH));
                }
            }
        }
    }
    given.push(("matrix.E", matrix.modulus, "MPa", [1e3, 1e5]));
    given.push(("matrix.ft", matrix.ft, "MPa", USUAL_TENSILE_STRENGTH));
    if matrix.softening != Softening::None {
        given.push(("matrix.Gf", matrix.fracture_energy, "N/mm", [1e-3, 20.0]));
    }
    given.extend(matrix.fc.map(|fc| ("matrix.fc", fc, "MPa", [1.0, 400.0])));
    if let Some(fc) = matrix.fc.filter(|&fc| fc < matrix.ft && matrix.ft <= USUAL_TENSILE_STRENGTH[1]) {
        reader.warn(format!(
            "matrix.ft = {} MPa is greater than matrix.fc = {} MPa: are they interchanged?",
            matrix.ft, fc
        ));
    }
    for (what, value, unit, usual) in given {
        if !(usual[0]..=usual[1]).contains(&value) {
            reader.warn_unusual(what, value, unit, usual);
        }
    }
}

fn openings(given: Openings) -> Vec<f64> {
    let end = given.to.map_or(OPENINGS.0, |end| end.0);
    let intervals = given.points.map_or(OPENINGS.1, |count| count.0) - 1;
    let place = |k: usize| {
        let part = k as f64 / intervals as f64;
        end * match given.spacing.unwrap_or_default() {
            Spacing::Power2 => part * part,
            Spacing::Even => part,
        }
    };
    (0..=intervals).map(place).collect()
}

/// Reports a problem of the numbers themselves.
fn report_invalid(reader: &mut Reader<'_>, checked: Result<(), Invalid>) {
    if let Err(Invalid { place, rule }) = checked {
        reader.problem(&Place::path(&place), rule);
    }
}

/// Both columns of a comparison are of one file.
fn check_tables(reader: &mut Reader<'_>, about: &About, columns: &[String]) {
    for (k, compare) in about.compare.iter().enumerate() {
        let (x, y) = (&columns[compare.x], &columns[compare.y]);
        if columns::are_of_two_files(columns, x, y) {
            let message = format!("'{y}' and '{x}' are columns of two files: bridging.csv and beam.csv");
            reader.problem(&Place::root().key("compare").index(k).key("y"), message);
        }
    }
}

/// A histogram with what its file says.
fn counted(reader: &mut Reader<'_>, orientation: Orientation) -> Option<Orientation> {
    let Orientation::Histogram { edges_deg, counts, file: Some(file) } = &orientation else { return Some(orientation) };
    let place = Place::root().key("orientation").key("file");
    if !edges_deg.is_empty() || !counts.is_empty() {
        reader.problem(&place, "is given together with edges_deg or counts: the file has both");
        return None;
    }
    let path = reader.file(file, &place)?;
    let bins = read_columns(reader, &path, &place, ["from_deg", "to_deg", "count"])?;
    if let Some(gap) = bins.windows(2).position(|pair| pair[1][0] != pair[0][1]) {
        let (end, next) = (bins[gap][1], bins[gap + 1][0]);
        let message = format!("{}: the bin to {end}° is followed by one from {next}°", path.display());
        reader.problem(&place, message);
        return None;
    }
    let edges = [bins[0][0]].into_iter().chain(bins.iter().map(|bin| bin[1]));
    let histogram = Orientation::Histogram {
        edges_deg: edges.collect(),
        counts: bins.iter().map(|bin| bin[2]).collect(),
        file: None,
    };
    // what is wrong with its numbers is wrong with the file
    let checked = histogram.directions(f64::MAX, &[]);
    checked.map_err(|Invalid { rule, .. }| reader.problem(&place, format!("{}: {rule}", path.display()))).ok()?;
    Some(histogram)
}

/// The fibre, and where its load comes from.
fn fibre(reader: &mut Reader<'_>, others: &ReferencedCases, given: &FibreOfFile) -> Option<(Fibre, LoadSource)> {
    let before = reader.problems.len();
    let mut taken = UsedDefaults::default();
    let (fibre, source) = match given {
        FibreOfFile::Closed(closed) => {
            let bond = Closed::clone(&closed.bond);
            closed.bond.note(&mut taken, &[]);
            let inclination = closed.inclination.unwrap_or_default();
            [bond.check(), inclination.check()].into_iter().for_each(|checked| report_invalid(reader, checked));
            (&closed.fibre, Some(LoadSource::Bond(Bond::Closed(bond), inclination)))
        }
        FibreOfFile::ShearLag(lag) => {
            let law = if lag.law.0.is_array() { points(reader, &lag.law.0) } else { sampled(reader, others, lag) };
            let bond = ShearLag { law: law? };
            let inclination = lag.inclination.unwrap_or_default();
            [bond.check(), inclination.check()].into_iter().for_each(|checked| report_invalid(reader, checked));
            (&lag.fibre, Some(LoadSource::Bond(Bond::ShearLag(bond), inclination)))
        }
        FibreOfFile::Table(table) => (&table.fibre, curves(reader, table)),
        FibreOfFile::Fe(fe) => (&fe.fibre, simulations(reader, others, fe)),
    };
    fibre.note(&mut taken, if fibre.strength.is_none() { &["rupture_f"] } else { &[] });
    reader.note_defaults(&Place::root().key("fibre"), &taken.0);
    report_invalid(reader, fibre.check());
    (reader.problems.len() == before).then_some((**fibre, source?))
}

/// Points of a law.
fn points(reader: &mut Reader<'_>, law: &Value) -> Option<BondLaw> {
    serde_json::from_value(law.clone()).map_err(|error| reader.problem(&law_place(), error.to_string())).ok()
}

/// The place of a bond law.
pub fn law_place() -> Place {
    Place::root().key("fibre").key("law")
}

/// Points of a plugin's law: the traction under a slip that grows, at no gap. Slips are added where the law turns, and all
/// of them asked again, until straight lines between them are the law.
fn sampled(reader: &mut Reader<'_>, others: &ReferencedCases, lag: &ShearLagFibre) -> Option<BondLaw> {
    let half = (0.5 * lag.fibre.length).max(2.0 * FIRST_SLIP);
    let count = ((half / FIRST_SLIP).log10() * SLIPS_PER_DECADE).ceil().max(1.0) as i32;
    let ratio = (half / FIRST_SLIP).powf(1.0 / f64::from(count));
    let mut slips: Vec<f64> = (0..=count).map(|k| FIRST_SLIP * ratio.powi(k)).collect();
    let mut points = traction_at(reader, others, lag, &slips)?;
    // ends of the lines that may not be the law
    let mut open = slips.clone();
    loop {
        let middles: Vec<f64> = points
            .windows(2)
            .filter(|ends| is_among(&open, ends[1][0]) && ends[1][0] - ends[0][0] > LEAST_INTERVAL * lag.fibre.length)
            .map(|ends| 0.5 * (ends[0][0] + ends[1][0]))
            .collect();
        if middles.is_empty() {
            return Some(BondLaw { points });
        }
        if points.len() + middles.len() > MOST_SLIPS {
            reader.warn(format!(
                "{}: the law changes slope more often than {MOST_SLIPS} slips can follow: straight lines between {} replace it",
                law_place().in_words(),
                points.len(),
            ));
            return Some(BondLaw { points });
        }
        slips.extend(&middles);
        slips.sort_by(f64::total_cmp);
        points = traction_at(reader, others, lag, &slips)?;
        let greatest = points.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
        open = points
            .windows(3)
            .filter(|three| is_among(&middles, three[1][0]))
            .filter(|three| {
                let [[from, low], [middle, traction], [to, high]] = [three[0], three[1], three[2]];
                let deviation = (traction - low - (middle - from) / (to - from) * (high - low)).abs();
                let of_slope = from == 0.0 && deviation > LARGEST_DEVIATION_OF_SLOPE * high.abs();
                of_slope || deviation > LARGEST_DEVIATION * greatest
            })
            .flat_map(|three| [three[1][0], three[2][0]])
            .collect();
    }
}

/// Returns whether a slip is, up to rounding, one of those that rise.
fn is_among(slips: &[f64], slip: f64) -> bool {
    let first = slips.partition_point(|one| *one < slip * (1.0 - ROUNDING));
    slips.get(first).is_some_and(|one| *one <= slip * (1.0 + ROUNDING))
}

/// Slips and tractions of a plugin's law along slips that rise.
fn traction_at(
    reader: &mut Reader<'_>,
    others: &ReferencedCases,
    lag: &ShearLagFibre,
    slips: &[f64],
) -> Option<Vec<[f64; 2]>> {
    let steps: Vec<Value> = slips.iter().map(|slip| json!({ "increments": 1, "target": { "slip": slip } })).collect();
    let program = match (others.law)(reader, &lag.law.0, &steps) {
        Ok(program) => program,
        Err(problem) => {
            reader.push(problem);
            return None;
        }
    };
    let columns = program.columns();
    let column = |name: &str| columns.iter().position(|column| column == name).map(|place| place - LEADING.len());
    let mut curve = Curved { columns: [column("slip")?, column("tau")?], points: Vec::new() };
    if let (_, Err(stop)) = path::run(&program, &mut curve) {
        let message = if let Stop::Failed(failure) = stop { failure.message } else { "it cannot be run".into() };
        reader.problem(&law_place(), message);
        return None;
    }
    Some(curve.points)
}

/// Notes slip and traction.
struct Curved {
    columns: [usize; 2],
    points: Vec<[f64; 2]>,
}

impl Observer for Curved {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        self.points.push(self.columns.map(|column| row.values[column]));
        Ok(())
    }

    fn increment_done(&mut self, _: Row<'_>, _: Statistics) {}
}

/// Any bond.
fn stand_in() -> LoadSource {
    let closed = Closed {
        tau: 1.0,
        beta: 0.0,
        debonding_energy: 0.0,
        debonding: Default::default(),
        sliding: Default::default(),
        hook: None,
    };
    LoadSource::Bond(Bond::Closed(closed), Default::default())
}

/// Returns the runs of a specimen at all pairs of angles and lengths. Those at the corners are read, so that problems
/// of the base case are reported here.
fn simulations(reader: &mut Reader<'_>, others: &ReferencedCases, fe: &FeFibre) -> Option<LoadSource> {
    let place = Place::root().key("fibre");
    let angles = fe.angles_deg.clone().unwrap_or(ANGLES_DEG.into());
    let parts = fe.lengths.clone().unwrap_or(LENGTHS.into());
    let rises = |values: &[f64]| !values.is_empty() && values.windows(2).all(|pair| pair[1] > pair[0]);
    let before = reader.problems.len();
    if !rises(&angles) || angles[0] < 0.0 || angles[angles.len() - 1] >= 90.0 {
        reader.problem(&place.key("angles_deg"), "must rise, from 0 or more to less than 90 degrees");
    }
    if !rises(&parts) || parts[0] <= 0.0 || parts[parts.len() - 1] != 1.0 {
        reader.problem(&place.key("lengths"), "must rise, from above 0 to 1: parts of half the fibre's length");
    }
    if reader.problems.len() > before {
        return None;
    }
    let cache = reader.folder_to_write(fe.cache.as_deref().unwrap_or("out/fibres"), &place.key("cache"))?;
    let base = reader.file(&fe.base, &place.key("base"))?;
    if is_stream(&base) {
        reader.problem(&place.key("base"), "is a pipe or a device: each run reads its case from a file");
        return None;
    }
    let lengths: Vec<f64> = parts.iter().map(|part| 0.5 * part * fe.fibre.length).collect();
    let of_several = (others.document)(&base).is_some_and(|base| base["mesh"]["specimen"]["type"] == "fibres");
    let [usual_angle, usual_length] = if of_several { KEYS_OF_PATH } else { KEYS };
    let keys = [fe.angle_key.as_deref().unwrap_or(usual_angle), fe.length_key.as_deref().unwrap_or(usual_length)];
    let [angle_key, length_key] = keys;
    let always = fe.set.iter().flatten().map(|(path, value)| format!("{path}={value}")).collect::<Vec<_>>();
    let mut runs = Vec::new();
    for &angle_deg in &angles {
        // a fibre that is embedded by less than that is all corner
        let is_run = |length: &f64| length * angle_deg.to_radians().cos() >= LEAST_DEPTH * fe.fibre.diameter;
        for &embedded in lengths.iter().filter(|length| is_run(length)) {
            let mut overrides = always.clone();
            // a specimen without an angle is at 0
            overrides.extend((angles.len() > 1 || angle_deg > 0.0).then(|| format!("{angle_key}={angle_deg}")));
            overrides.push(format!("{length_key}={embedded}"));
            runs.push(FibreSimulation { angle_deg, embedded, overrides });
        }
        if runs.last().is_none_or(|run| run.angle_deg != angle_deg) {
            let message = format!("{angle_deg}: no length reaches {LEAST_DEPTH} diameters deep at this angle");
            reader.problem(&place.key("angles_deg"), message);
            return None;
        }
    }
    let mut axes = Vec::new();
    for run in [&runs[0], &runs[runs.len() - 1]] {
        match check_simulation(others, reader, &base, run, fe, keys) {
            Ok(axis) => axes.extend(axis.map(|axis| (run.angle_deg, axis))),
            Err(problem) => {
                reader.push(problem);
                return None;
            }
        }
    }
    if let [(first, a), (last, b)] = axes[..] {
        let cosine = a.direction[0] * b.direction[0] + a.direction[1] * b.direction[1];
        let turned = cosine.clamp(-1.0, 1.0).acos().to_degrees();
        if (turned - (last - first)).abs() > SAME_ANGLE {
            let message = format!("{angle_key} from {first} to {last} turns the fibre by {}°", significant(turned, 3));
            reader.problem(&place.key("angle_key"), message);
            return None;
        }
    }
    let widest = angles.last().copied().unwrap_or_default();
    Some(LoadSource::Simulated(Simulations {
        base,
        runs,
        lengths,
        cut_deg: fe.cut_deg.unwrap_or(USUAL_CUT.max(widest)),
        cache,
    }))
}

/// A run's case is one of a specimen with one fibre, that this one, and embedded as deep as its key says: its axis, if it
/// is known here.
fn check_simulation(
    others: &ReferencedCases,
    reader: &Reader<'_>,
    base: &Path,
    run: &FibreSimulation,
    fe: &FeFibre,
    [angle_key, length_key]: [&str; 2],
) -> Result<Option<FibreAxis>, Problem> {
    let place = Place::root().key("fibre");
    let (diameter, embedded) = (fe.fibre.diameter, run.embedded);
    let program =
        (others.specimen)(reader, base, &run.overrides).map_err(|WrongSpecimen { place: wrong, message }| {
            let of = |key: &str| Place::of_setting(key);
            let named = match wrong {
                Some(wrong) if wrong == of(length_key) => place.key("length_key"),
                Some(wrong) if wrong == of(angle_key) => place.key("angle_key"),
                Some(wrong) => match fe.set.iter().flatten().find(|(path, _)| wrong == of(path)) {
                    Some((path, _)) => place.key("set").key(path),
                    None => place.key("base"),
                },
                None => place.key("base"),
            };
            Problem::new(named, format!("at {}°, {embedded} mm: {message}", run.angle_deg))
        })?;
    let Some(program) = program else { return Ok(None) };
    let (problem, key) = match (program.fibre_diameter, program.fibre_axis) {
        (Some(_), _) if !program.model.measured.fibres.is_empty() => {
            ("has several fibres: give a case with one".to_owned(), "base")
        }
        (Some(own), _) if (own - diameter).abs() > SAME_DIAMETER * diameter => {
            (format!("has a fibre of {own} mm, this one is {diameter} mm thick"), "base")
        }
        (Some(_), Some(axis)) if (axis.embedded - embedded).abs() > SAME_LENGTH * embedded => {
            let own = significant(axis.embedded, 4);
            (
                format!("{length_key} {embedded} embeds the fibre by {own} mm: it is not the embedded length"),
                "length_key",
            )
        }
        (Some(_), axis) => return Ok(axis),
        (None, _) => ("has no fibre".to_owned(), "base"),
    };
    Err(Problem::new(place.key(key), problem))
}

/// Measured curves.
fn curves(reader: &mut Reader<'_>, table: &TableFibre) -> Option<LoadSource> {
    let place = Place::root().key("fibre").key("file");
    let path = reader.file(&table.file, &place)?;
    let rows = read_columns(reader, &path, &place, ["theta_deg", "embedded", "slip", "load"])?;
    let highest = rows.iter().map(|[.., load]| *load).fold(0.0, f64::max);
    let is_compressed = |[.., load]: &&[f64; 4]| *load < -LARGEST_COMPRESSION * highest;
    if let Some([angle_deg, embedded, slip, load]) = rows.iter().find(is_compressed) {
        let message = format!(
            "{}: at {angle_deg}°, {embedded} mm and a slip of {slip} mm the load {load} N pushes the fibre in: pull-out has \
             positive loads",
            path.display()
        );
        reader.problem(&place, message);
        return None;
    }
    let mut curves: Vec<Curve> = Vec::new();
    for [angle_deg, embedded, slip, load] in rows {
        match curves.iter_mut().find(|curve| curve.angle_deg == angle_deg && curve.embedded == embedded) {
            Some(curve) => {
                curve.slip.push(slip);
                curve.load.push(load);
            }
            None => curves.push(Curve { angle_deg, embedded, slip: vec![slip], load: vec![load] }),
        }
    }
    for curve in &curves {
        if let Some([before, after]) = curve.slip.windows(2).map(|pair| [pair[0], pair[1]]).find(|[a, b]| b <= a) {
            let message = format!(
                "{}: at {}°, {} mm the slip {after} mm follows {before} mm: slips of a curve must rise",
                path.display(),
                curve.angle_deg,
                curve.embedded
            );
            reader.problem(&place, message);
            return None;
        }
    }
    let widest = curves.iter().map(|curve| curve.angle_deg).fold(0.0, f64::max);
    if let (Some(inclination), true) = (&table.inclination, widest > 0.0) {
        report_invalid(reader, inclination.check());
        let message = format!("goes with curves at 0° alone: {} has one at {widest}°", path.display());
        reader.problem(&Place::root().key("fibre").key("inclination"), message);
        return None;
    }
    report_invalid(reader, table.inclination.map_or(Ok(()), |inclination| inclination.check()));
    let usual_cut = if table.inclination.is_some() { 90.0 } else { USUAL_CUT.max(widest) };
    let cut_deg = table.cut_deg.unwrap_or(usual_cut);
    let scale = table.scale.as_ref().map_or(1.0, |scale| scale.0);
    Some(LoadSource::Curves(Curves { curves, cut_deg, inclination: table.inclination, scale }))
}

/// The rows of a table with these columns.
fn read_columns<const N: usize>(
    reader: &mut Reader<'_>,
    path: &Path,
    place: &Place,
    names: [&str; N],
) -> Option<Vec<[f64; N]>> {
    let rows = CsvFile::read(path).and_then(|csv| {
        let found: Result<Vec<usize>, Vec<String>> = names.into_iter().map(|name| csv.column(name)).collect();
        csv.numbers(&found?, false)
    });
    let rows = reader.without_problems(rows, place)?;
    Some(rows.into_iter().map(|row| from_fn(|k| row[k])).collect())
}
