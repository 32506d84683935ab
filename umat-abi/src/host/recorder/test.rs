use super::*;
use crate::host::exchange::{from_noted, noted};
use crate::host::interface_call::FricInputs;
use std::io::{Seek, Write};
use std::path::PathBuf;

fn prepared() -> (File, Recording) {
    let file = tempfile::tempfile().expect("a file");
    let recording = Recording::create(&file).expect("room");
    (file, recording)
}

/// Returns a worker's side of the file, in addition to that of the process.
fn recorder(file: &File) -> &'static Recorder {
    Box::leak(Box::new(Recorder { map: Map::open(file).expect("a mapping"), fences_arrays: AtomicBool::new(false) }))
}

fn slot(recorder: &'static Recorder) -> Slot {
    Slot::of(recorder, "law", &PathBuf::from("/somewhere/liblaw.so"), Some("umat_"), "LAW-1")
}

fn fric(dgam: f64, statev: usize) -> impl Fn(&mut slot::Writer) {
    const WORDS: usize = size_of::<FricInputs>() / size_of::<f64>();
    let mut inputs: FricInputs = from_noted(&[0.0; WORDS]).expect("as many words");
    (inputs.dgam[0], inputs.counters) = (dgam, [2, 5]);
    move |to| {
        to.put_integers([RecordedArguments::FRIC, 1]);
        to.put_integers([1]);
        to.put(&[0.5]);
        to.put(&vec![7.0; statev]);
        // energies, temperature, fields, their increments, PROPS
        (0..5).for_each(|k| to.put(&[f64::from(k); 2]));
        to.put(noted(&inputs));
    }
}

#[test]
fn what_is_noted_is_read() {
    let (file, recording) = prepared();
    let mut slot = slot(recorder(&file));
    assert_eq!((recording.calls(), recording.last_call()), (0, None));
    slot.enter(fric(0.25, 3));
    assert_eq!(recording.pending().count(), 1);
    let call = recording.unfinished_call().expect("a call");
    assert_eq!((call.name.as_str(), call.cmname.as_str()), ("law", "LAW-1"));
    assert_eq!((call.symbol.as_deref(), call.wants_tangent), (Some("umat_"), true));
    assert_eq!(call.library, PathBuf::from("/somewhere/liblaw.so"));
    assert_eq!(call.arguments.place(), [2, 5]);
    let RecordedArguments::Fric(arguments) = &call.arguments else { panic!("{call:?}") };
    assert_eq!((arguments.dgam == [0.25, 0.0], arguments.statev[..] == [7.0; 3]), (true, true));
    slot.leave();
    assert_eq!((recording.pending().count(), recording.unfinished_call()), (0, None));
    assert_eq!((recording.calls(), recording.last_call()), (1, Some(call)));
}

#[test]
fn arguments_that_grow_take_another_slot() {
    let (file, recording) = prepared();
    let mut slot = slot(recorder(&file));
    for states in [1, 1000, 30_000] {
        slot.enter(fric(0.25, states));
        let Some(RecordedArguments::Fric(call)) = recording.unfinished_call().map(|call| call.arguments) else {
            panic!()
        };
        assert_eq!(call.statev, vec![7.0; states]);
        slot.leave();
    }
    assert_eq!(recording.calls(), 3);
}

#[test]
fn a_full_file_is_no_error() {
    let (file, recording) = prepared();
    let mut slot = slot(recorder(&file));
    slot.enter(fric(0.25, 1));
    slot.leave();
    let beyond = vec![0.0; map::CAPACITY / 8];
    slot.enter(|to| to.put(&beyond));
    slot.leave();
    assert!(recording.pending().next().is_none());
}

#[test]
fn each_object_has_its_slot() {
    let (file, recording) = prepared();
    let recorder = recorder(&file);
    let [mut first, mut second] = [slot(recorder), slot(recorder)];
    first.enter(fric(1.0, 1));
    second.enter(fric(2.0, 1));
    assert_eq!(recording.pending().count(), 2);
    let dgam = |call: Option<CallRecord>| match call.map(|call| call.arguments) {
        Some(RecordedArguments::Fric(fric)) => fric.dgam[0],
        other => panic!("{other:?}"),
    };
    assert_eq!(dgam(recording.unfinished_call()), 2.0);
    let beats: Vec<f64> = recording.pending().map(|beat| dgam(recording.call(beat))).collect();
    assert_eq!(beats, [1.0, 2.0]);
    second.leave();
    assert_eq!((dgam(recording.unfinished_call()), dgam(recording.last_call())), (1.0, 2.0));
}

#[test]
fn done_and_notes() {
    let (file, recording) = prepared();
    let recorder = recorder(&file);
    assert_eq!((recording.done(), recording.note(0)), (None, 0));
    recorder.note(NOTES - 1, u64::MAX);
    recorder.note(NOTES, 1);
    assert_eq!((recording.note(NOTES - 1), recording.note(NOTES), recording.loading()), (u64::MAX, 0, None));
    recorder.done(0);
    assert_eq!(recording.done(), Some(0));
}

/// Whatever a wild plugin leaves, reading ends without a panic.
#[test]
fn a_destroyed_file_is_read_in_vain() {
    let (mut file, recording) = prepared();
    let mut slot = slot(recorder(&file));
    slot.enter(fric(0.25, 3));
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..2000 {
        let state = random.u64(..);
        let offset = if state & 1 == 0 { (state >> 8) % 200 } else { map::HEADER as u64 + (state >> 8) % 400 };
        file.seek(io::SeekFrom::Start(offset)).expect("an offset");
        let value = if state & 2 == 0 { state } else { (state >> 40) % 64 };
        file.write_all(&value.to_ne_bytes()).expect("room");
        let _ = (recording.done(), recording.calls(), recording.pending().count(), recording.loading());
        let _ = (recording.unfinished_call(), recording.last_call());
    }
}
