use super::*;

#[test]
fn energies_are_listed_with_their_shares_and_what_is_missing() {
    let interface = [("interface_energy", 5.0), ("interface_stored_energy", 1.0), ("interface_dissipation", 4.0)];
    let others = [("external_work", 8.0), ("elastic_energy", 2.0), ("field_energy", 3.0), ("plastic_energy", 0.0)];
    let energies = others.into_iter().chain(interface);
    let mut found = Findings { energy_error_max: Some(0.125), ..Findings::default() };
    found.energies = energies.into_iter().map(|(name, energy)| (name.to_owned(), energy)).collect();
    found.statistics.insert("umat_calls".into(), 1234);
    found.penalties.insert("left".into(), 51_724_137.931);
    let page = super::energies(&found).into_string() + &work(&found).into_string();
    let row = |key: &str, cells: &str| format!("<td class=\"key\">{key}</td>{cells}");
    let number = |text: &str| format!("<td class=\"number\">{text}</td>");
    for expected in [
        row("Interface energy", &[number("5"), number("62.5 %")].concat()),
        row("Interface dissipation", &[number("4"), number("50 %")].concat()),
        row("External work minus energies", &[number("1"), number("12.5 %")].concat()),
        row("Umat calls", &number("1234")),
        "0.125".into(),
    ] {
        assert!(page.contains(&expected), "{expected}\n{page}");
    }
    assert!(page.contains("Field energy") && !page.contains("Plastic energy"), "what is nothing has no row: {page}");
    assert!(load(&found).into_string().contains("No load was measured"));
    found.peak_load = Some(PeakLoad { load: 31.25, slip: 0.0625, step: 1, increment: 7, time: 0.1 });
    let page = load(&found).into_string();
    assert!(page.contains("Greatest load 31.25 N at a slip of 0.0625 mm (step 1, increment 7)"), "{page}");
    assert!(!work(&found).into_string().contains("Overlap"));
    let (part, inside) = ("fibre".to_owned(), "matrix".to_owned());
    found.overlaps.insert("end".into(), Overlap { depth: 0.0703125, position: [0.25, -0.5], part, inside });
    let page = work(&found).into_string();
    let expected = "Overlap of deformed bodies at the end: 0.0703 mm, fibre in matrix, at (0.25, −0.5).";
    assert!(page.contains(expected), "{page}");
}
