//! Small specimens, and what is varied of them, one thing at a time.

/// A specimen.
pub(super) struct Base {
    /// Name in tables.
    pub name: &'static str,
    /// The case, as JSON.
    pub case: &'static str,
    /// Overrides that make it small, as texts of `--set`.
    pub set: &'static [&'static str],
    /// Quantities that are varied.
    pub families: Vec<Family>,
}

/// Parameter under variation.
pub(super) struct Family {
    /// Name in tables.
    pub name: &'static str,
    pub variations: Vec<Variation>,
}

/// One value of the parameter under variation.
pub(super) struct Variation {
    /// Label in tables.
    pub label: String,
    /// Changes, as texts of `--set`.
    pub set: Vec<String>,
    /// Reason why it may fail, if that is known.
    pub known_limit: Option<&'static str>,
}

impl Family {
    /// Some of its values may fail, for a known reason.
    fn limited(mut self, labels: &[&str], reason: &'static str) -> Self {
        for variation in self.variations.iter_mut().filter(|variation| labels.contains(&variation.label.as_str())) {
            variation.known_limit = Some(reason);
        }
        self
    }
}

/// `key` at each of the values, and what comes with each.
fn family<V: ToString>(
    name: &'static str,
    values: impl IntoIterator<Item = V>,
    set: impl Fn(&str) -> Vec<String>,
) -> Family {
    let variation = |value: V| {
        let label = value.to_string();
        Variation { set: set(&label), label, known_limit: None }
    };
    Family { name, variations: values.into_iter().map(variation).collect() }
}

/// Returns powers of ten with a mantissa.
fn decades(mantissas: &[&str], exponents: std::ops::RangeInclusive<i32>) -> Vec<String> {
    exponents.flat_map(|k| mantissas.iter().map(move |mantissa| format!("{mantissa}e{k}"))).collect()
}

/// Sets one key.
fn key(name: &'static str) -> impl Fn(&str) -> Vec<String> {
    move |value| vec![format!("{name}={value}")]
}

/// Returns increments of constant size, over this many decades.
fn increments(name: &'static str, count: i32) -> Family {
    family(name, decades(&["1", "3"], -count..=-1).into_iter().chain(["1".into()]), |value| {
        vec![
            format!("steps.0.increments.initial={value}"),
            format!("steps.0.increments.maximum={value}"),
            "steps.0.increments.minimum=1e-9".into(),
        ]
    })
}

/// The factor of the penalty.
fn penalty() -> Family {
    family("penalty", decades(&["1"], -2..=6), key("contact.penalty_factor"))
}

/// The coefficient of friction.
fn friction() -> Family {
    let values = ["0", "0.01", "0.05", "0.1", "0.2", "0.3", "0.4", "0.5", "0.75", "1", "1.25", "1.5", "2"];
    family("friction", values, key("contact.law.props.mu"))
}

/// Returns the variations of a fibre's contact.
fn of_contact(penalty: Family) -> Vec<Family> {
    vec![
        penalty,
        friction(),
        family("p_0 [MPa]", decades(&["1"], -1..=5), key("contact.law.props.p_0")),
        family("elastic bond [MPa/mm]", decades(&["1"], 1..=6), key("contact.law.props.k_e"))
            .limited(&["1e1"], SOFT_BOND),
    ]
}

fn perpendicular(decades_of_increments: i32) -> Vec<Family> {
    let mut families = of_contact(penalty());
    families.push(increments("increment / step", decades_of_increments));
    families.push(family("elements along the fibre", [1, 2, 3, 7, 10, 40, 80], key("mesh.specimen.embedded_elements")));
    // 1.22 mm along the fibre
    families.push(family("size across at the hole [mm]", ["1", "0.5", "0.2", "0.1", "0.05", "0.0122"], |size| {
        vec![
            format!("mesh.specimen.interface_size={size}"),
            "mesh.specimen.exit_size=null".into(),
            "mesh.specimen.equal_sizes=true".into(),
        ]
    }));
    families.push(family(
        "edges of the hole on one of the fibre",
        [1, 2, 3, 5],
        key("mesh.specimen.slave_edges_per_master"),
    ));
    families
}

fn inclined() -> Vec<Family> {
    let mut families = of_contact(penalty());
    families.push(increments("increment / step", 3));
    families.push(family(
        "angle [°]",
        [0, 5, 10, 15, 20, 27, 30, 37, 45, 52, 60, 67, 70, 75, 80],
        key("mesh.specimen.angle_deg"),
    ));
    families.push(family("angle of a straight fibre [°]", [0, 5, 15, 30, 45, 60, 70, 75], |angle| {
        vec![
            format!("mesh.specimen.angle_deg={angle}"),
            "mesh.specimen.shape=straight".into(),
            "mesh.specimen.free_length=0".into(),
        ]
    }));
    families.push(family("factor on sizes", ["4", "3", "2.5", "2", "1.5"], key("mesh.specimen.mesh_size")));
    families
}

/// Returns the variations of a strip that cracks by a phase field.
fn cracking() -> Vec<Family> {
    let of_law = |name: &str| {
        let name = name.to_owned();
        move |value: &str| vec![format!("parts.beam.material.props.{name}={value}")]
    };
    vec![
        increments("increment / step", 3),
        family("length of the field [mm]", ["0.5", "1", "2", "4"], of_law("l")),
        family("G_f [N/mm]", ["0.01", "0.03", "0.3", "3"], of_law("G_f")),
        family("f_t [MPa]", ["0.3", "1", "6"], of_law("f_t")),
        family("ν", ["0", "0.4", "0.49"], of_law("nu")),
        family("element", ["T3", "Q4", "T6"], key("mesh.specimen.element")),
        family("elements along and across", ["[5,1]", "[20,2]", "[41,3]"], key("mesh.specimen.cells")),
        family("plane model", ["plane_stress"], key("parts.beam.model")),
        family("tolerance", ["1e-1", "1e-2", "1e-5", "1e-8"], key("field.tolerance")),
        family("coupling", ["one_pass", "full"], key("field.coupling")),
    ]
}

const SOFT_BOND: &str = "its elastic slip, 0.29 mm, is larger than that of the peak, 0.02 mm";

const ON_THE_CURVED_CHANNEL: &str = "positions of 10 mm are rounded to 1.8e-15 mm, of which a penalty of 4.3e11 N/mm³ makes 7.7e-4 MPa, 79 % of the \
pressure in the first increment: points open and close at random";

const OF_THE_STRIP: &str = "positions of 10 mm are rounded to 1.8e-15 mm, of which a penalty of 8.4e11 N/mm³ makes 1.5e-3 MPa; only increments of some \
1e-6 of the step converge";

/// Returns all base specimens.
pub(super) fn bases() -> Vec<Base> {
    const COARSE: &[&str] = &[
        "output.vtu=false",
        "output.plots=false",
        "steps.0.slip=0.05",
        "mesh.specimen.embedded_elements=10",
        "mesh.specimen.exit_size=0.6",
        "mesh.specimen.interface_size=0.4",
        "mesh.specimen.largest_size=4",
    ];
    vec![
        Base {
            name: "perpendicular fibre, plane",
            case: include_str!("../../../cases/chapter-6/6.14-plane.json"),
            set: COARSE,
            families: perpendicular(4),
        },
        Base {
            name: "perpendicular fibre, axisymmetric",
            case: include_str!("../../../cases/chapter-6/6.14-axisymmetric.json"),
            set: COARSE,
            families: perpendicular(3),
        },
        Base {
            name: "fibre at 45°",
            case: include_str!("../../../cases/chapter-7/inclined-fibre.json"),
            set: &["output.vtu=false", "output.plots=false", "steps.0.slip=0.03", "mesh.specimen.mesh_size=3"],
            families: inclined(),
        },
        Base {
            name: "cylinder on a plane",
            case: include_str!("../../../cases/verification/hertz.json"),
            set: &["output.plots=false"],
            families: vec![
                penalty(),
                family("increments", [1, 2, 4, 10, 100, 1000], key("steps.0.increments")),
                // with 20 the middle of an edge, with others a node or nothing lies at the end of the contact
                family("edges in contact", [3, 4, 5, 7, 10, 20, 33], key("mesh.specimen.contact_edges")),
                family("points on an edge", [1, 2, 3], key("contact.quadrature.gauss")),
            ],
        },
        Base {
            name: "fibre on a curved channel",
            case: include_str!("../../../cases/verification/capstan-bond.json"),
            set: &["output.plots=false"],
            families: vec![
                penalty().limited(&["1e6"], ON_THE_CURVED_CHANNEL),
                friction(),
                family("increments", [1, 2, 5, 10, 100, 1000], key("steps.1.increments")),
            ],
        },
        Base {
            name: "strip dragged out",
            case: include_str!("../../../cases/verification/drag-out-strip.json"),
            set: &["output.plots=false"],
            families: vec![
                penalty().limited(&["1e6"], OF_THE_STRIP),
                friction(),
                // edges of strip and block meet, or their nodes lie on each other's edges
                family("edges of the strip", [6, 12, 24, 47, 48, 49], key("mesh.specimen.strip_edges")),
                family("increments", [1, 2, 5, 20, 200], key("steps.1.increments")),
            ],
        },
        Base {
            name: "strip with a phase field",
            case: include_str!("strip-phase-field.json"),
            set: &[],
            families: cracking(),
        },
    ]
}
