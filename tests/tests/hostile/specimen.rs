//! Coarse specimens that are done within seconds.

use end_to_end_tests::workspace;
use std::ffi::OsString;
use std::path::Path;

/// A shipped case with overrides.
pub struct Specimen {
    /// The file, in the folder of the cases.
    case: &'static str,
    overrides: &'static [&'static str],
    /// Increments between checkpoints.
    every: &'static str,
}

/// Damage, a bond that slides, written fields.
pub const DAMAGING: Specimen = Specimen {
    case: "chapter-6/6.14-plane.json",
    overrides: &["mesh.specimen.embedded_elements=6", "steps.0.slip=0.03", "output={\"plots\": false, \"vtu\": 9}"],
    every: "7",
};
/// The drives turn back in increments 47 to 49: at the last checkpoint, after increment 48, something else leads.
pub const SNAPPING_BACK: Specimen = Specimen {
    case: "verification/fibre-dropping-bond.json",
    overrides: &[
        "mesh.specimen.embedded_elements=16",
        "until={\"quantity\": \"increment\", \"greater_than\": 60}",
        "output={\"plots\": true, \"vtu\": false}",
    ],
    every: "16",
};

impl Specimen {
    /// Returns the name that its messages have.
    pub fn name(&self) -> &'static str {
        self.case.rsplit('/').next().unwrap_or_default()
    }

    fn arguments(&self, option: &str, out: &Path) -> Vec<OsString> {
        let case = workspace("cases").join(self.case);
        let mut arguments: Vec<OsString> = ["run", "--quiet", "--threads", "1"].map(OsString::from).to_vec();
        arguments.extend(self.overrides.iter().flat_map(|text| ["--set", text]).map(OsString::from));
        arguments.extend([case.into(), option.into(), out.into()]);
        arguments
    }

    /// A run from the start.
    pub fn run(&self, out: &Path) -> Vec<OsString> {
        let mut arguments = self.arguments("--out", out);
        arguments.extend(["--checkpoint-every", self.every].map(OsString::from));
        arguments
    }

    /// A run that goes on.
    pub fn restart(&self, out: &Path) -> Vec<OsString> {
        self.arguments("--restart", out)
    }
}
