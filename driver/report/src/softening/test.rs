use super::*;

const MODULUS: f64 = 32_000.0;

/// Numbers of lines that begin with one.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    let of_line = |line: &str| line.split(',').map(|number| number.trim().parse().ok()).collect::<Option<Vec<f64>>>();
    text.lines().filter_map(of_line).collect()
}

/// Falls, rises and is below 0 at its end.
fn law() -> Polyline {
    Polyline::new([(0.0, 2.885), (0.05, 1.2), (0.2, 1.4), (1.0, 0.8), (3.0, -1e-17), (4.0, 0.0)])
}

#[test]
fn abaqus_gets_the_law_itself() {
    let text = SofteningTable::new(&law(), 0.0, MODULUS, 3.5).abaqus();
    assert!(text.contains("\n*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT\n"), "{text}");
    assert!(text.is_ascii());
    let rows = numbers(&text);
    assert_eq!(rows[0], [2.885, 0.0], "the failure stress at no displacement");
    assert!(rows.windows(2).all(|pair| pair[1][1] > pair[0][1]), "{rows:?}");
    assert!(rows.iter().all(|row| row[0] >= 0.0));
    let read = Polyline::new(rows.iter().map(|row| (row[1], row[0])));
    for k in 1..=300 {
        let opening = 0.01 * f64::from(k);
        assert!((read.at(opening) - law().at(opening)).abs() < 1e-15, "at {opening} mm");
    }
    assert_eq!(rows.last().map(|row| row[1]), Some(3.0), "nothing beyond the last opening");
}

/// Without softening the matrix loses f_t at once: the work differs by less than 1e-4 N/mm from that of the fibres.
#[test]
fn a_brittle_matrix_falls_to_the_fibres() {
    let law = Polyline::new([(0.0, 0.0), (0.05, 1.2), (4.0, 0.8)]);
    let table = SofteningTable::new(&law, 2.9, MODULUS, 4.0);
    assert_eq!(table.rows[..2], [[0.0, 2.9], [5e-5, 0.0]]);
    let work = |rows: &[[f64; 2]]| -> f64 {
        rows.windows(2).map(|ends| 0.5 * (ends[1][0] - ends[0][0]) * (ends[0][1] + ends[1][1])).sum()
    };
    let fibres: Vec<[f64; 2]> = law.points().map(|(x, y)| [x, y]).collect();
    assert!((work(&table.rows) - work(&fibres)).abs() < 1e-4);
}

/// The elongation of an element of the crack's width is its elastic one and the opening.
#[test]
fn a_crack_band_has_the_same_opening() {
    let table = SofteningTable::new(&law(), 0.0, MODULUS, 4.0);
    let text = table.crack_band(20.0).expect("strains that rise");
    let rows = numbers(std::str::from_utf8(&text).expect("text"));
    assert_eq!(rows.len(), table.rows.len());
    assert!(rows.windows(2).all(|pair| pair[1][0] > pair[0][0] && pair[1][1] > pair[0][1]), "{rows:?}");
    for (row, [opening, stress]) in rows.iter().zip(&table.rows) {
        assert!((20.0 * row[0] - opening).abs() < 1e-14);
        assert!((20.0 * (row[1] - row[2] / MODULUS) - opening).abs() < 1e-12);
        assert_eq!(row[2], *stress);
    }
}

/// The steepest fall is 1.6 MPa in 0.05 mm: elements wider than 32000 · 0.05/1.6 = 1000 mm snap back.
#[test]
fn too_wide_a_band_is_refused_with_the_widest() {
    let law = Polyline::new([(0.0, 2.9), (0.05, 1.3), (4.0, 0.8)]);
    let table = SofteningTable::new(&law, 2.9, MODULUS, 4.0);
    let warning = table.crack_band(1001.0).expect_err("a warning");
    assert!(warning.contains("give less than 1000 mm"), "{warning}");
    assert!(table.crack_band(999.0).is_ok());
}
