//! Checkpoints with other bytes, numbers or lengths: their hash shows it, and they are refused.

use crate::process::{self, Outcome, outcome, pullout};
use crate::specimen::{DAMAGING, SNAPPING_BACK, Specimen};
use crate::suite::{Form, Tally, each};
use end_to_end_tests::fuzz::WILD_NUMBERS;
use fastrand::Rng;
use std::fs;
use std::path::PathBuf;

const ALL: u64 = 400;
const SHORT: u64 = 30;

/// A finished run.
struct Original {
    specimen: Specimen,
    folder: PathBuf,
    content: Vec<u8>,
}

pub fn run(form: &Form) -> Tally {
    let desk = tempfile::tempdir().expect("a temporary folder");
    let originals = [DAMAGING, SNAPPING_BACK].map(|specimen| {
        let folder = desk.path().join(specimen.name()).with_extension("");
        let made = outcome(pullout(desk.path(), specimen.run(&folder))).and_then(|made| made.judge(&[]));
        assert_eq!(made, Ok(0));
        let content = fs::read(folder.join(process::CHECKPOINT)).expect("a checkpoint");
        Original { specimen, folder, content }
    });
    each(&form.numbers(ALL, SHORT), |number, random| {
        let Original { specimen, folder, content } = &originals[random.usize(..originals.len())];
        let out = desk.path().join(number.to_string());
        process::copy(folder, &out);
        fs::write(out.join(process::CHECKPOINT), forge(content, random)).expect("a checkpoint");
        let ended = outcome(pullout(desk.path(), specimen.restart(&out)));
        let judged = ended.and_then(|ended| judge(&ended, specimen));
        fs::remove_dir_all(&out).expect("its results");
        judged
    })
}

fn judge(ended: &Outcome, specimen: &Specimen) -> Result<(), String> {
    match ended.judge(&[specimen.name(), process::CHECKPOINT])? {
        2 => Ok(()),
        code => Err(format!("not refused: exit {code}")),
    }
}

/// A checkpoint with one to four changes.
fn forge(content: &[u8], random: &mut Rng) -> Vec<u8> {
    let mut forged = content.to_vec();
    for _ in 0..random.usize(1..5) {
        change(&mut forged, random);
    }
    if forged == content {
        forged.push(0);
    }
    forged
}

/// Most of a file are the memories of points; its head and what the rest of the run depends on stand at its ends.
fn change(content: &mut Vec<u8>, random: &mut Rng) {
    const END: usize = 600;
    let length = content.len();
    let place = match random.u8(..3) {
        0 => random.usize(..END.min(length)),
        1 => length - 1 - random.usize(..END.min(length)),
        _ => random.usize(..length),
    };
    match random.u8(..8) {
        0 => content.truncate(place.max(1)),
        1 => content[place] ^= 1 << random.u8(..8),
        2 => content[place] = random.u8(..),
        3 => content.insert(place, random.u8(..)),
        4 => drop(content.remove(place)),
        _ => {
            // over what is a number already, if there is one near
            let is_number = |k: &usize| {
                let bytes: Option<[u8; 8]> = content.get(*k..k + 8).and_then(|bytes| bytes.try_into().ok());
                bytes.map(f64::from_le_bytes).is_some_and(|x| x.is_finite() && (1e-9..1e9).contains(&x.abs()))
            };
            let at = (place..length).take(16).find(is_number).unwrap_or(place);
            let number = WILD_NUMBERS[random.usize(..WILD_NUMBERS.len())].to_le_bytes();
            content.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
        }
    }
}
