//! Comparison with the 40-digit responses of `tests/reference/` (see its README).

use super::Point;
use umat_abi::law::{Law, StressState};

/// Columns of one reference file by name.
pub struct Table {
    header: Vec<String>,
    /// Numbers, row by row.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a file of `tests/reference/`.
    pub fn read(file: &str) -> Self {
        let path = format!("{}/../reference/{file}", env!("CARGO_MANIFEST_DIR"));
        let mut reader = csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let header = reader.headers().expect("header").iter().map(String::from).collect();
        let rows = reader
            .records()
            .map(|record| record.expect("record").iter().map(|x| x.parse().expect("number")).collect())
            .collect();
        Self { header, rows }
    }

    /// Returns the place of a column.
    pub fn column(&self, name: &str) -> usize {
        self.header.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"))
    }
}

/// Runs the strains of a reference file through law `L`; stresses must agree to 1e-13 · max|σ|,
/// each `(column, state index)` as D = η/(1+η) to 1e-12. Returns the worst relative stress error and
/// the number of rows compared (all, except for `nroots` > 1).
pub fn check<L: Law>(
    file: &str,
    stress_state: StressState,
    props: &[f64],
    damage_columns: &[(&str, usize)],
) -> (f64, usize) {
    let table = Table::read(file);
    let (strain, stress, roots) = (table.column("eps11"), table.column("sig11"), table.column("nroots"));
    let largest = table.rows.iter().flat_map(|row| &row[stress..stress + 6]).fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut point = Point::<L>::virgin(props, stress_state);
    let mut worst = 0.0_f64;
    let mut compared = 0;
    for row in table.rows.iter().take_while(|row| row[roots] <= 1.0) {
        let mut end: [f64; 6] = row[strain..strain + 6].try_into().expect("six strains");
        if stress_state == StressState::PlaneStress {
            end[2] = 0.0; // output there
        }
        let response = point.advance(&end);
        for i in 0..6 {
            let error = (response.stress[i] - row[stress + i]).abs() / largest;
            assert!(
                error <= 1e-13,
                "{file} row {}: stress {i}: {} against {} (error {error:e} of the largest)",
                compared + 1,
                response.stress[i],
                row[stress + i]
            );
            worst = worst.max(error);
        }
        for &(name, state) in damage_columns {
            let damage = models::damage_law::damage(point.state[state]);
            let expected = row[table.column(name)];
            assert!(
                (damage - expected).abs() <= 1e-12,
                "{file} row {}: {name} {damage} against {expected}",
                compared + 1
            );
        }
        compared += 1;
    }
    assert!(compared > 0, "{file}: nothing compared");
    (worst, compared)
}
