use super::*;
use serde_json::json;

/// Place, displacement, half of the line.
const CRACK: [f32; 6] = [1.0, 1.0, 0.0, 0.5, 0.2, 0.0];

/// Two states of one triangle: at a slip of 1 mm its third node has moved by (0, 2) mm; the middle state halves the slip.
fn scenes() -> Scenes {
    let state = |slip: f64| {
        // the last state has a crack
        let cracks = usize::from(slip == 1.0);
        json!({ "slip": slip, "load": 10.0 * slip, "contacts": 0, "cracks": cracks, "left": [[0, 1], [0, 3]] })
    };
    let head = json!({
        "nodes": 3, "triangles": 1, "edges": 3, "behind": [0, 0], "displacement": [0.0, 2.0],
        "fields": [{ "name": "stress", "unit": "MPa", "ranges": [[-1.0, 3.0]] }], "parts": ["block"],
        "frames": [state(0.0), state(0.25), state(1.0)], "curve": [[0.0, 1.0], [0.0, null]],
    });
    let mut data = Vec::new();
    [0.0_f32, 0.0, 4.0, 0.0, 0.0, 3.0].into_iter().for_each(|value| crate::viewer::push(&mut data, value));
    [0_u32, 1, 2, 0, 1, 1, 2, 2, 0].into_iter().for_each(|node| data.extend_from_slice(&node.to_le_bytes()));
    CRACK.into_iter().for_each(|value| crate::viewer::push(&mut data, value));
    [0_u16; 3].into_iter().for_each(|part| data.extend_from_slice(&part.to_le_bytes()));
    let moved = |y: u16| vec![0, 0, 0, 0, 0, y];
    crate::viewer::push_series(&mut data, [moved(0), moved(32767), moved(65534)].into_iter());
    crate::viewer::push_series(&mut data, [vec![0, NO_VALUE, 0], vec![0, 0, 0], vec![65534, 0, 0]].into_iter());
    Scenes::decode(serde_json::from_value(head).expect("a head"), &data, 0, None).expect("states")
}

#[test]
fn states_are_read_as_the_report_has_them() {
    let scenes = scenes();
    assert_eq!(scenes.position(1, (0, 0.0)), [4.0, 0.0]);
    assert_eq!(scenes.cracks, [vec![], vec![], vec![CRACK]]);
    assert_eq!(scenes.position(2, (2, 0.0)), [0.0, 5.0]);
    assert_eq!([0, 1].map(|node| scenes.share(node, (2, 0.0))), [Some(1.0), Some(0.0)]);
    assert_eq!(scenes.share(1, (0, 0.0)), Some(0.0), "a node without a value takes that of the next state");
    // 0 to 4 and 0 to 5, and 2 % of 5 around
    scenes.view.iter().zip([-0.1, 4.1, -0.1, 5.1]).for_each(|(found, right)| assert!((found - right).abs() < 1e-12));
}

#[test]
fn frames_lie_at_equal_distances_of_slip() {
    let scenes = scenes();
    let slips: Vec<f64> = scenes.moments(5).into_iter().map(|moment| scenes.place(moment)[0]).collect();
    slips.iter().zip([0.0, 0.25, 0.5, 0.75, 1.0]).for_each(|(found, right)| assert!((found - right).abs() < 1e-12));
    // a third of the way from the second state (1 mm up) to the last (2 mm)
    let [_, y] = scenes.position(2, scenes.moments(5)[2]);
    assert!((y - (3.0 + 1.0 + 1.0 / 3.0)).abs() < 1e-4, "{y}");
}

#[test]
fn states_that_are_cut_off_are_refused() {
    let whole = scenes();
    let head = |nodes: usize| {
        json!({ "nodes": nodes, "triangles": 1, "edges": 3, "behind": [0, 0], "displacement": [0.0, 2.0], "fields": [],
            "parts": [], "frames": [], "curve": [[], []] })
    };
    let of = |nodes: usize, data: &[u8]| {
        Scenes::decode(serde_json::from_value(head(nodes)).expect("a head"), data, 0, None).is_none()
    };
    assert!(of(3, &[0; 10]) && of(usize::MAX / 2, &[0; 10]) && of(3, &[0; 1000]));
    assert_eq!(whole.head.frames.len(), 3);
}

#[test]
fn a_gif_has_the_frames_and_the_colours_of_the_field() {
    let file = scenes().gif(5).expect("a font");
    let mut decoder = gif::DecodeOptions::new().read_info(&file[..]).expect("a GIF");
    let palette = decoder.global_palette().expect("colours").to_vec();
    assert_eq!((decoder.width(), decoder.height()), (880, 400));
    let mut frames = 0;
    let mut last = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        frames += 1;
        last = frame.buffer.to_vec();
    }
    assert_eq!(frames, 5);
    assert!(palette.chunks(3).any(|color| color == [0xd5, 0x5e, 0x00]), "the place on the curve");
    assert!(palette.chunks(3).any(|color| color == [0xe4, 0x00, 0x2b]), "the crack");
    assert!(last.iter().filter(|&&place| place != 255).count() > 100, "the specimen has moved");
}
