use super::*;

#[test]
fn what_is_no_part_of_an_increment_is_no_success() {
    for pnewdt in [0.0, -1.0, f64::NAN] {
        let failure = judge(Ok(CallOutcome::of(pnewdt)), None).expect_err("no success");
        assert_eq!(failure.fraction(0.25), Some(0.25));
        assert!(failure.to_string().contains("no part"), "{failure}");
    }
    assert_eq!(judge(Ok(CallOutcome::of(0.5)), None).map_err(|failure| failure.fraction(0.25)), Err(Some(0.5)));
    assert_eq!(judge(Ok(CallOutcome::of(1.0)), None), Ok(()));
}
