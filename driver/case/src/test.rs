//! Cases as users write them: valid ones against the program that they mean, malformed ones against the words,
//! the place and the exit code of each problem.

use super::problem::Place;
use super::validation::{Keyword, Violation, violations};
use super::{Case, CaseErrors, read, schema, structure};
use jsonschema::error::ValidationErrorKind as Kind;
use pullout_run::program::Program;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock, Mutex};
use tempfile::TempDir;
use umat_abi::host::{Found, search_paths};

mod bridging;
mod damaged;
mod malformed;
mod parameters;
mod random;
mod shipped;
mod specimen;
mod untrusted;
mod valid;

/// A folder with the files that the cases below name.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        // cases of libraries of all kinds are read here, as workers do
        pullout_run::isolation::let_all_in();
        let folder = tempfile::tempdir().expect("a temporary folder");
        let files = [
            ("path.csv", "# a comment\ntime, e11, s22\n0.5, 1e-4, 0\n2.0, 2e-4, -1.5\n"),
            ("untimed.csv", "e11\n1e-4\n2e-4\n3e-4\n"),
            ("from_zero.csv", "time,e11\n0,0\n1,1e-4\n"),
            ("contact.csv", "time,slip,slip2,p\n1,0.1,0,2\n2,0.2,0.05,3\n"),
            ("curve.csv", "# source: nowhere\nstrain,stress_MPa,other\n0,0,\n1e-3,10,1\n2e-3,,2\n"),
            ("unknown_column.csv", "time,e12\n1,0\n"),
            ("twice.csv", "e11,e11\n1,0\n"),
            ("both.csv", "e11,s11\n1,0\n"),
            ("text.csv", "time,e11\n1,abc\n2,nan\n"),
            ("backwards.csv", "time,e11\n1,0\n1,0\n"),
            ("negative.csv", "time,e11\n-1,0\n1,0\n"),
            ("ragged.csv", "time,e11\n1,0,3\n"),
            ("only_time.csv", "time\n1\n"),
            ("no_rows.csv", "time,e11\n"),
            ("empty.csv", ""),
            ("fixed.csv", "e33\n1e-4\n"),
            ("falling.csv", "theta_deg,embedded,slip,load\n30,15,0,0\n30,15,0.2,3\n30,15,0.1,2\n"),
            ("bins.csv", "from_deg,to_deg,count\n0,20,3\n30,90,4\n"),
            ("nothing-counted.csv", "from_deg,to_deg,count\n0,90,0\n"),
            ("counted.csv", "from_deg,to_deg,count\n0,20,3\n20,90,4\n"),
            ("short.csv", "theta_deg,embedded,slip,load\n0,5,0.1,10\n0,5,1,5\n"),
            ("pushed.csv", "theta_deg,embedded,slip,load\n0,15,0.1,10\n0,15,1,-5\n"),
            ("to-60.csv", "theta_deg,embedded,slip,load\n0,15,0.1,5\n0,15,2,5\n60,15,0.1,5\n60,15,2,5\n"),
            ("no_library.so", "this is text"),
        ];
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).expect("a file in the temporary folder");
        }
        std::fs::write(folder.path().join("two.msh"), specimen::two_bodies()).expect("a mesh");
        let bench = Self(folder);
        std::fs::write(bench.0.path().join("fibre.json"), Self::base().to_string()).expect("a case of a specimen");
        bench
    }

    /// A case of a specimen with one fibre, which others take curves of.
    fn base() -> Value {
        json!({
            "kind": "pullout", "mesh": { "specimen": { "type": "inclined_fibre" } },
            "parts": {
                "fibre": { "material": { "plugin": "linear_elastic" } },
                "matrix": { "material": { "plugin": "linear_elastic" } }
            },
            "contact": { "law": { "plugin": "bond_slip", "props": { "law": "A", "p_0": 3, "delta_N": 0.004, "k_e": 400, "tau_res": 0, "k_u": 0 } } },
            "steps": [ { "slip": 0.1 } ]
        })
    }

    fn path(&self) -> PathBuf {
        self.0.path().join("case.json")
    }

    fn read_text(&self, text: impl AsRef<[u8]>, overrides: &[&str]) -> Result<Case, CaseErrors> {
        std::fs::write(self.path(), text).expect("the case file");
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        read(&self.path(), &overrides, &[])
    }

    fn read(&self, case: &Value, overrides: &[&str]) -> Result<Case, CaseErrors> {
        self.read_text(case.to_string(), overrides)
    }

    /// Reads a case of a material or contact point.
    fn read_point(&self, case: &Value, overrides: &[&str]) -> Result<Program, CaseErrors> {
        match self.read(case, overrides)? {
            Case::Path(program) => Ok(*program),
            _ => panic!("a case of a point"),
        }
    }
}

fn point_case() -> Value {
    json!({
        "kind": "point",
        "material": { "plugin": "linear_elastic", "props": { "E": 31800.0, "nu": 0.18 } },
        "mode": "3d",
        "steps": [ { "increments": 10, "target": { "e11": -0.001 } } ]
    })
}

/// A library without metadata.
fn plain_library() -> String {
    let found = Found::by_name("undescribed", &search_paths(&[])).expect("a plugin that Cargo built");
    found.path.to_str().expect("UTF-8").to_owned()
}

fn interface_case() -> Value {
    json!({
        "kind": "interface",
        "material": { "plugin": plain_library(), "symbol": "my_uinter_", "nstatv": 2, "props": [1, 2.5] },
        "steps": [ { "increments": 4, "target": { "slip": 0.1 } } ]
    })
}

/// Returns whether the printed schema accepts a document.
fn schema_accepts(document: &Value) -> bool {
    static VALIDATOR: LazyLock<jsonschema::Validator> =
        LazyLock::new(|| jsonschema::draft202012::new(&schema()).expect("a valid schema"));
    let accepts = VALIDATOR.is_valid(document);
    if let Some(kind) = document["kind"].as_str().filter(|kind| structure::schema_of_kind(kind).is_some()) {
        assert_eq!(ours(kind, document), theirs(kind, document), "{document}");
        assert_eq!(ours(kind, document).is_empty(), accepts, "{document}");
    }
    accepts
}

/// Places, and the keywords that are broken there, branches of unions as well, in the order of the alphabet.
type Findings = Vec<(String, String)>;

/// What our own check of a document finds.
fn ours(kind: &str, document: &Value) -> Findings {
    fn list(found: &[Violation<'_>], all: &mut Findings) {
        for violation in found {
            let name = match &violation.keyword {
                Keyword::Type(_) => "type",
                Keyword::Constant(_) => "const",
                Keyword::Union(branches) => {
                    branches.iter().for_each(|branch| list(branch, all));
                    "union"
                }
                Keyword::Ambiguous => "ambiguous",
                Keyword::UnknownKeys(_) => "additionalProperties",
                Keyword::Missing(_) => "required",
                Keyword::Limit(relation, _) => relation,
                Keyword::MinItems(_) => "minItems",
                Keyword::MaxItems(_) => "maxItems",
                Keyword::MinLength => "minLength",
                Keyword::MaxLength(_) => "maxLength",
                Keyword::Pattern => "pattern",
                Keyword::Format(..) => "format",
            };
            all.push((violation.place.to_string(), name.to_owned()));
        }
    }
    let mut all = Vec::new();
    // formats are comments for jsonschema
    list(&violations(structure::schema_of_kind(kind).expect("a kind"), document, false), &mut all);
    all.sort();
    all
}

/// The place in a document that a JSON pointer leads to.
fn place_of(pointer: &str, document: &Value) -> String {
    let (mut place, mut value) = (Place::root(), document);
    for part in pointer.split('/').skip(1).map(|part| part.replace("~1", "/").replace("~0", "~")) {
        (place, value) = match value {
            Value::Array(entries) => {
                let index = part.parse().expect("an index");
                (place.index(index), &entries[index])
            }
            other => (place.key(&part), &other[&part]),
        };
    }
    place.to_string()
}

/// What the crate `jsonschema` finds.
fn theirs(kind: &str, document: &Value) -> Findings {
    fn list<'e>(
        found: impl Iterator<Item = &'e jsonschema::ValidationError<'e>>,
        document: &Value,
        all: &mut Findings,
    ) {
        for error in found {
            let name = match error.kind() {
                Kind::Type { .. } => "type",
                Kind::Constant { .. } => "const",
                Kind::AnyOf { context } | Kind::OneOfNotValid { context } => {
                    context.iter().for_each(|branch| list(branch.iter(), document, all));
                    "union"
                }
                Kind::OneOfMultipleValid { .. } => "ambiguous",
                Kind::AdditionalProperties { .. } => "additionalProperties",
                Kind::Required { .. } => "required",
                Kind::Minimum { .. } => ">=",
                Kind::ExclusiveMinimum { .. } => ">",
                Kind::Maximum { .. } => "<=",
                Kind::ExclusiveMaximum { .. } => "<",
                Kind::MinItems { .. } => "minItems",
                Kind::MaxItems { .. } => "maxItems",
                Kind::MinLength { .. } => "minLength",
                Kind::MaxLength { .. } => "maxLength",
                Kind::Pattern { .. } => "pattern",
                other => panic!("a keyword that our own check does not know: {other:?}"),
            };
            all.push((place_of(error.instance_path().as_str(), document), name.to_owned()));
        }
    }
    static VALIDATORS: Mutex<BTreeMap<String, Arc<jsonschema::Validator>>> = Mutex::new(BTreeMap::new());
    let validator = {
        let mut validators = VALIDATORS.lock().expect("no panic while it is locked");
        let of_kind = || {
            let schema = structure::schema_of_kind(kind).expect("a kind");
            Arc::new(jsonschema::draft202012::new(schema).expect("a valid schema"))
        };
        validators.entry(kind.to_owned()).or_insert_with(of_kind).clone()
    };
    let found: Vec<_> = validator.iter_errors(document).collect();
    let mut all = Vec::new();
    list(found.iter(), document, &mut all);
    all.sort();
    all
}

#[test]
fn paths_have_one_meaning_with_dots_and_with_brackets() {
    for (path, dotted) in [
        ("steps.0.target.slip", "steps.0.target.slip"),
        ("steps[0].target.slip", "steps.0.target.slip"),
        ("$.a[0][12]", "a.0.12"),
        // no index: a key of this name is not there
        ("a[-1]", "a[-1]"),
        ("a['b']", "a['b']"),
        ("a[0", "a[0"),
    ] {
        assert_eq!(crate::dotted(path), dotted);
    }
    let case = json!({ "a": [{ "b": 1 }] });
    assert_eq!(overridden(&case, &["a[0].b=2"]), json!({ "a": [{ "b": 2 }] }));
}

/// A document after `--set`.
fn overridden(case: &Value, overrides: &[&str]) -> Value {
    let mut document = case.clone();
    for text in overrides {
        let _ = super::json::set(&mut document, text);
    }
    document
}
