use super::*;
use crate::pullout::recorder::test::record;

#[test]
fn the_peak_is_the_first_of_the_greatest_loads_in_magnitude() {
    let mut keeper = PeakKeeper::default();
    let loads = [0.0, 3.0, 5.0, 5.0, -4.0, f64::NAN, -7.5, 7.0];
    for (load, increment) in loads.into_iter().zip(0..) {
        let record = Record { load, ..record(1, increment, 0.25 * f64::from(increment)) };
        let expected = [false, true, true, false, false, false, true, false][increment as usize];
        assert_eq!(keeper.rises(&record), expected, "{load}");
    }
    let peak = keeper.peak.expect("a load");
    assert_eq!((peak.load, peak.increment, peak.time), (-7.5, 6, 1.5));
    assert!(PeakKeeper::default().peak.is_none());
}
