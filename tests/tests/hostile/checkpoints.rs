//! Checkpoints with other bytes, numbers, lengths: with the hash that tells it they are refused; with the hash of the
//! changed state they are refused or go on, to an end or a failure in words.

use crate::process::{self, Outcome, outcome, pullout};
use crate::specimen::{DAMAGING, SNAPPING_BACK, Specimen};
use crate::suite::{Form, Tally, each};
use end_to_end_tests::fuzz::WILD_NUMBERS;
use fastrand::Rng;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

const ALL: u64 = 400;
const SHORT: u64 = 30;
/// One in so many keeps the old hash.
const UNHASHED: u64 = 10;
/// Hexadecimal digits of a hash.
const DIGITS: usize = 64;

/// A finished run.
struct Original {
    specimen: Specimen,
    folder: PathBuf,
    content: Vec<u8>,
    /// Place at which its state begins.
    state: usize,
}

pub fn run(form: &Form) -> Tally {
    let desk = tempfile::tempdir().expect("a temporary folder");
    let originals = [DAMAGING, SNAPPING_BACK].map(|specimen| {
        let folder = desk.path().join(specimen.name()).with_extension("");
        let made = outcome(pullout(desk.path(), specimen.run(&folder))).and_then(|made| made.judge(&[]));
        assert_eq!(made, Ok(0));
        let content = fs::read(folder.join(process::CHECKPOINT)).expect("a checkpoint");
        let state = start_of_state(&content);
        assert_eq!(content[state - DIGITS..state], *sha256(&content[state..]).as_bytes());
        Original { specimen, folder, content, state }
    });
    each(&form.numbers(ALL, SHORT), |number, random| {
        let Original { specimen, folder, content, state } = &originals[random.usize(..originals.len())];
        let out = desk.path().join(number.to_string());
        process::copy(folder, &out);
        let is_unhashed = number.is_multiple_of(UNHASHED);
        let forged = forge(content, *state, !is_unhashed, random);
        fs::write(out.join(process::CHECKPOINT), &forged).expect("a checkpoint");
        let ended = outcome(pullout(desk.path(), specimen.restart(&out)));
        let judged = ended.and_then(|ended| judge(&ended, specimen, is_unhashed, &out));
        fs::remove_dir_all(&out).expect("its results");
        judged
    })
}

fn judge(ended: &Outcome, specimen: &Specimen, is_refused: bool, out: &Path) -> Result<(), String> {
    let code = ended.judge(&[specimen.name(), process::CHECKPOINT])?;
    if is_refused && code != 2 {
        return Err(format!("not refused: exit {code}"));
    }
    if matches!(code, 0 | 1) && !out.join("summary.json").exists() {
        return Err(format!("exit {code} without a summary"));
    }
    Ok(())
}

/// Returns the position after the second hash: that of the case comes first.
fn start_of_state(content: &[u8]) -> usize {
    let is_hash = |start: &usize| {
        content[*start] as usize == DIGITS && content[start + 1..][..DIGITS].iter().all(u8::is_ascii_hexdigit)
    };
    let mut hashes = (0..content.len() - DIGITS).filter(is_hash);
    hashes.nth(1).expect("two hashes") + 1 + DIGITS
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A checkpoint with one to four changes of its state.
fn forge(content: &[u8], start: usize, is_hashed: bool, random: &mut Rng) -> Vec<u8> {
    let mut state = content[start..].to_vec();
    for _ in 0..random.usize(1..5) {
        change(&mut state, random);
    }
    if state == content[start..] {
        state.push(0);
    }
    let hash = if is_hashed { sha256(&state).into_bytes() } else { content[start - DIGITS..start].to_vec() };
    [&content[..start - DIGITS], &hash, &state].concat()
}

/// Most of a state are the memories of points; what the rest of the run depends on stands at its ends.
fn change(state: &mut Vec<u8>, random: &mut Rng) {
    const END: usize = 600;
    let length = state.len();
    let place = match random.u8(..3) {
        0 => random.usize(..END.min(length)),
        1 => length - 1 - random.usize(..END.min(length)),
        _ => random.usize(..length),
    };
    match random.u8(..8) {
        0 => state.truncate(place),
        1 => state[place] ^= 1 << random.u8(..8),
        2 => state[place] = random.u8(..),
        3 => state.insert(place, random.u8(..)),
        4 => drop(state.remove(place)),
        _ => {
            // over what is a number already, if there is one near
            let is_number = |k: &usize| {
                let bytes: Option<[u8; 8]> = state.get(*k..k + 8).and_then(|bytes| bytes.try_into().ok());
                bytes.map(f64::from_le_bytes).is_some_and(|x| x.is_finite() && (1e-9..1e9).contains(&x.abs()))
            };
            let at = (place..length).take(16).find(is_number).unwrap_or(place);
            let number = WILD_NUMBERS[random.usize(..WILD_NUMBERS.len())].to_le_bytes();
            state.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
        }
    }
}
