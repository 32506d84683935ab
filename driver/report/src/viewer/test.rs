use super::*;

/// Sums a series up as the script does.
fn summed(data: &[u8], width: usize) -> Vec<Vec<u16>> {
    let numbers: Vec<u16> = data.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    let mut states: Vec<Vec<u16>> = Vec::new();
    for state in numbers.chunks_exact(width) {
        let before = states.last().cloned().unwrap_or(vec![0; width]);
        states.push(state.iter().zip(before).map(|(difference, value)| difference.wrapping_add(value)).collect());
    }
    states
}

#[test]
fn differences_add_up_to_the_states() {
    let states = vec![vec![0, 65535, 7], vec![65535, 3, 7], vec![1, 65534, 0]];
    let mut data = Vec::new();
    push_series(&mut data, states.clone().into_iter());
    assert_eq!(summed(&data, 3), states);
}

#[test]
fn steps_resolve_values_to_a_hundred_thousandth_of_their_range() {
    let ends = range([2.5_f32, f32::NAN, -1.0, 0.3].into_iter());
    assert_eq!(ends, [-1.0, 2.5]);
    for value in [-1.0_f32, -0.2, 0.3, 1.7, 2.5] {
        let decoded = -1.0 + 3.5 * f64::from(step(value, ends)) / STEPS;
        assert!((decoded - f64::from(value)).abs() < 1e-5 * 3.5, "{value}: {decoded}");
    }
    assert_eq!((step(9.0, ends), step(-9.0, ends), step(f32::NAN, ends)), (65534, 0, NO_VALUE));
}

#[test]
fn what_is_left_of_the_shapes_is_their_beginning() {
    let mut shapes = Shapes::default();
    for (node, is_behind, gone) in [(0, false, 3), (1, true, 3), (2, false, 1), (3, true, 2), (4, false, 2)] {
        shapes.push(vec![node], is_behind, gone);
    }
    let shapes = shapes.ordered();
    let nodes: Vec<u32> = shapes.items.iter().map(|shape| shape.nodes[0]).collect();
    assert_eq!((nodes, shapes.behind()), (vec![1, 3, 0, 4, 2], 2));
    assert_eq!([0, 1, 2].map(|state| shapes.left(state)), [[2, 3], [2, 2], [1, 1]]);
}

#[test]
fn a_long_curve_keeps_its_last_point() {
    let [x, y] = thinned([(0..5000).map(f64::from).collect(), (0..5000).map(|k| f64::from(2 * k)).collect()]);
    assert!(x.len() <= MOST_POINTS + 1 && x.len() == y.len());
    assert_eq!((x.first(), x.last(), y.last()), (Some(&0.0), Some(&4999.0), Some(&9998.0)));
}
