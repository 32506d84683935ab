//! Warnings of data in units that are hardly meant, and of fits that miss their data.

use pullout_case::outside_usual;
use pullout_run::number::significant;

/// RMS difference, relative to the greatest measured value, above which a misfit is not explained by scatter.
const POOR: f64 = 0.2;

/// A number of the data: what it is, its value, its unit, and its usual range.
pub(crate) type Usual<'a> = (&'a str, f64, &'a str, [f64; 2]);

/// Warns of data outside their usual range, and of fits (a name and its RMS, relative to the greatest measured value) that miss
/// the data.
pub(crate) fn doubts<'a>(data: &[Usual<'_>], fits: impl IntoIterator<Item = (&'a str, f64)>) -> Vec<String> {
    let is_outside = |(_, value, _, [lower, upper]): &&Usual<'_>| value < lower || value > upper;
    let units =
        data.iter().filter(is_outside).map(|&(what, value, unit, range)| outside_usual(what, value, unit, range));
    let poor = fits.into_iter().filter(|(_, rms)| rms.is_nan() || *rms > POOR).map(|(name, rms)| {
        let of = if name.is_empty() { String::new() } else { format!("{name}: ") };
        let rms = significant(100.0 * rms, 2);
        format!("{of}the fit misses the data by {rms} % of their greatest value (RMS): do not rely on its parameters")
    });
    units.chain(poor).collect()
}
