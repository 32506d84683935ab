use super::*;

#[test]
fn walls_lie_along_a_bent_fibre_in_either_direction() {
    let fibre = FibreGeometry { part: 0, axis: vec![[1.0, 1.0], [1.0, 4.0], [3.0, 4.0]], exit_node: 0, radius: 0.5 };
    for (position, arc) in [([1.2, 1.0], 0.0), ([0.7, 2.5], 1.5), ([2.0, 4.4], 4.0), ([9.0, 4.0], 5.0)] {
        assert!((fibre.arc(position) - arc).abs() < 1e-12, "{position:?}");
    }
    let forward = Wall { start: 0.25, direction: 1.0 };
    let back = Wall { start: 3.0, direction: -1.0 };
    assert_eq!((forward.along_fibre(2.0), back.along_fibre(2.0)), (2.25, 1.0));
}
