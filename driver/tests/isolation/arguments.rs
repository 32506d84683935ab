//! A replay calls the plugin with what it was called with.

use super::program::Desk;
use super::{Fault, MODULUS, compiled, material, point};
use end_to_end_tests::Random;
use serde_json::{Value, json};

/// The arguments that the plugin printed last, by name.
fn printed(stdout: &str) -> Vec<(String, String)> {
    arguments(stdout.rsplit("CALL\n").next().expect("a call"))
}

/// The arguments of a call as they are printed, by name.
fn arguments(block: &str) -> Vec<(String, String)> {
    let lines = block.lines().filter_map(|line| line.split_once(' '));
    lines.map(|(name, values)| (name.to_owned(), values.trim().to_owned())).collect()
}

/// Checks that both calls got the same arguments: 17 digits show every bit.
fn compare(log: &str, replayed: &str) {
    let (first, second) = (printed(log), printed(replayed));
    assert!(first.len() > 20, "{first:?}");
    assert_eq!(first, second);
}

pub fn replays(desk: &Desk, case: &Value) -> Vec<(String, String)> {
    let run = desk.run(&desk.case("case.json", case), &[], "out", 1);
    let again = desk.run(&run.folder.join("replay.json"), &[], "again", 1);
    compare(&run.log(), &again.log());
    printed(&run.log())
}

pub fn value<'p>(printed: &'p [(String, String)], name: &str) -> &'p str {
    printed.iter().find(|(other, _)| other == name).map(|(_, values)| values.as_str()).expect(name)
}

/// Runs a case whose plugin returns NaN from a time on, and its replay: the first call of the replay is one of those that
/// failed, to the last bit of each argument.
fn repeats_the_call(desk: &Desk, case: &Value, seed: u64) {
    let run = desk.run(&desk.case("case.json", case), &[], "out", 1);
    let again = desk.run(&run.folder.join("replay.json"), &[], "again", 1);
    let calls = |log: &str| log.split("CALL\n").skip(1).map(arguments).collect::<Vec<_>>();
    let (first, second) = (calls(&run.log()), calls(&again.log()));
    let replayed = second.first().expect("a call");
    if !first.contains(replayed) {
        let differs = |call: &Vec<(String, String)>| call.iter().zip(replayed).filter(|(a, b)| a != b).count();
        let nearest = first.iter().min_by_key(|call| differs(call)).expect("a call");
        let pairs = nearest.iter().zip(replayed).filter(|(a, b)| a != b).collect::<Vec<_>>();
        panic!("seed {seed}: {case}\nof {} calls none is the replayed one: {pairs:?}", first.len());
    }
}

/// Steps of a random case end at these times, s.
const STEPS: usize = 3;

/// The steps of a random case, and a time within, s: `targets` makes the end values.
fn steps(random: &mut Random, mut target: impl FnMut(&mut Random) -> Value) -> (Value, f64) {
    let mut total = 0.0;
    let steps: Vec<Value> = (0..STEPS)
        .map(|_| {
            let time = 0.1 + random.unit();
            total += time;
            let increments = random.0.u32(1..6);
            let mut step = json!({ "increments": increments, "time": time, "temperature": 50.0 * random.signed() });
            step["predef"] = json!([3.0 * random.signed(), 1e-3 * random.signed()]);
            step["target"] = target(random);
            step
        })
        .collect();
    let fails_at = total * (0.2 + 0.7 * random.unit());
    (json!(steps), fails_at)
}

#[test]
fn of_a_umat_that_returns_nan_on_random_paths() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mode = random.0.choice(["3d", "axisymmetric", "plane_strain", "plane_stress"]).expect("one of them");
        let components: &[&str] = match mode {
            "3d" => &["11", "22", "33", "12", "13", "23"],
            "axisymmetric" => &["11", "22", "33", "12"],
            _ => &["11", "22", "12"],
        };
        let nlgeom = random.0.bool();
        let strains_only = nlgeom || random.0.bool();
        let (steps, fails_at) = steps(&mut random, |random| {
            let mut target = json!({});
            for component in components {
                let shear = component.as_bytes()[0] != component.as_bytes()[1];
                match if strains_only { 0 } else { random.0.u32(..3) } {
                    0 if shear => target[format!("g{component}")] = json!(0.02 * random.signed()),
                    0 => target[format!("e{component}")] = json!(0.02 * random.signed()),
                    1 => target[format!("s{component}")] = json!(5.0 * random.signed()),
                    _ => {}
                }
            }
            target
        });
        let mut material = material("misbehaving", Fault::None as u32);
        material["props"] = json!([MODULUS, 0, 0, 0, fails_at]);
        let case = json!({ "kind": "point", "material": material, "mode": mode, "nlgeom": nlgeom, "steps": steps,
            "temperature": 20.0 * random.signed(), "predef": [2.0 * random.signed(), random.signed()],
            "characteristic_length": 2.5 });
        repeats_the_call(&desk, &case, seed);
    }
}

#[test]
fn of_a_uinter_or_fric_that_returns_nan_on_random_paths() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let entry = random.0.choice(["uinter", "fric"]).expect("one of them");
        let normal = if entry == "fric" { "p" } else { random.0.choice(["gap", "p"]).expect("one of them") };
        let second = random.0.bool();
        let (steps, fails_at) = steps(&mut random, |random| {
            let mut target = json!({ "slip": 0.1 * random.signed() });
            target[normal] = json!(random.unit());
            if second {
                target["slip2"] = json!(0.1 * random.signed());
            }
            target
        });
        let mut material = material("misbehaving", Fault::None as u32);
        material["props"] = json!([MODULUS, 0, 0, 0, fails_at]);
        material["entry"] = json!(entry);
        let case = json!({ "kind": "interface", "material": material, "steps": steps,
            "temperature": 20.0 * random.signed(), "predef": [2.0 * random.signed(), random.signed()],
            "initial": { "slip": 0.1 * random.signed() } });
        repeats_the_call(&desk, &case, seed);
    }
}

#[test]
fn of_umat_at_a_point() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut case = point(material("misbehaving", Fault::Print as u32));
    case["characteristic_length"] = json!(2.5);
    case["temperature"] = json!(20.0);
    case["predef"] = json!([3.0]);
    case["material"]["cmname"] = json!("STEEL-7");
    case["steps"][1]["temperature"] = json!(40.0);
    case["steps"][1]["predef"] = json!([5.0]);
    case["steps"][1]["time"] = json!(4.0);
    for (mode, ntens) in [("3d", "6"), ("axisymmetric", "4"), ("plane_strain", "4"), ("plane_stress", "3")] {
        case["mode"] = json!(mode);
        let printed = replays(&desk, &case);
        assert_eq!((value(&printed, "ntens"), value(&printed, "kinc")), (ntens, "3"));
        assert_eq!(value(&printed, "jstep"), "2 1 0 0");
        // step time and total time at the start of the third of five increments in 4 s, after a step of 1 s
        assert_eq!(value(&printed, "time"), "1.6000000000000001 2.6000000000000001");
        assert_eq!((value(&printed, "celent"), value(&printed, "temp")), ("2.5", "28"));
        assert!(value(&printed, "cmname").starts_with("STEEL-7"));
    }
}

#[test]
fn of_umat_under_large_rotations() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut case = point(material("misbehaving", Fault::Print as u32));
    case["nlgeom"] = json!(true);
    case["steps"] = json!([
        { "increments": 2, "F": [[1.1, 0.2, 0], [0, 1, 0], [0, 0, 1]] },
        { "increments": 4, "F": [[0.9, -0.5, 0], [0.5, 1, 0.1], [0, 0, 1]] },
    ]);
    let printed = replays(&desk, &case);
    assert_eq!(value(&printed, "jstep"), "2 1 1 0");
    let drot: Vec<f64> = value(&printed, "drot").split(' ').map(|word| word.parse().expect("a number")).collect();
    assert!(drot[1].abs() > 0.01 && (drot[1] + drot[3]).abs() < 0.1, "{drot:?}");
}

#[test]
fn of_uinter_and_fric_at_a_point() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for (entry, second) in [("uinter", false), ("uinter", true), ("fric", false), ("fric", true)] {
        let mut material = material("misbehaving", Fault::Print as u32);
        material["entry"] = json!(entry);
        let normal = if entry == "fric" { "p" } else { "gap" };
        let mut steps = json!([
            { "increments": 5, "target": { "slip": 0.1, normal: 0.3 } },
            { "increments": 5, "target": { "slip": -0.2, normal: -0.1 } },
        ]);
        if second {
            steps[1]["target"]["slip2"] = json!(0.7);
        }
        let case = json!({ "kind": "interface", "title": entry, "material": material, "steps": steps,
            "characteristic_length": 4.0, "initial": { "statev": [1.0, 2.0], "time": 3.0 } });
        let printed = replays(&desk, &case);
        let directions = if second { "2" } else { "1" };
        if entry == "fric" {
            assert_eq!((value(&printed, "nfdir"), value(&printed, "kinc")), (directions, "3"));
        } else {
            assert_eq!((value(&printed, "kstep"), value(&printed, "chrlngth")), ("2", "4"));
        }
        assert_eq!(value(&printed, "props").split(' ').next(), Some(MODULUS.to_string().as_str()));
    }
}
