use super::loading_factor;

#[test]
fn a_factor_on_loading_is_found_where_it_is_the_error() {
    let (derivative, unloading) = ([7.0, 2.0, 2.0, 9.0], [10.0, 3.0, 3.0, 10.0]);
    for factor in [0.5, 1.0004] {
        let tangent: Vec<f64> = unloading.iter().zip(derivative).map(|(u, d)| u + factor * (d - u)).collect();
        let found = loading_factor(&tangent, &unloading, &derivative).expect("a factor");
        assert!((found - factor).abs() < 1e-12, "{found}");
    }
    // one entry is off by a little, which no factor mends
    assert_eq!(loading_factor(&[7.0, 2.0, 2.0, 9.001], &unloading, &derivative), None);
}
