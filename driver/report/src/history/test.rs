use super::*;
use std::fs::read_to_string;

fn columns(values: usize) -> Vec<String> {
    let middle = (0..values).map(|k| format!("c{k}"));
    ["step", "increment"].map(String::from).into_iter().chain(middle).chain(["iterations".into()]).collect()
}

#[test]
fn every_double_reads_back_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let special = [0.0, -0.0, 1.0, -1e22, 1e-5, f64::MIN_POSITIVE, 5e-324, f64::MAX, 0.1 + 0.2, 1e16, -123456789.0];
    let mut random = fastrand::Rng::with_seed(1);
    let mut rows: Vec<Vec<f64>> = vec![special.to_vec()];
    for _ in 0..3000 {
        // any bit pattern but the non-finite ones
        let any = (0..special.len()).map(|_| f64::from_bits(random.u64(..)));
        rows.push(any.map(|value| if value.is_finite() { value } else { 0.25 }).collect());
    }
    let mut writer = HistoryWriter::create(&path, &columns(special.len()), false).unwrap();
    for (k, values) in rows.iter().enumerate() {
        writer.write(&Row { step: 1, increment: k as u32, values, iterations: u32::MAX }).unwrap();
    }
    let history = History::read(&path).unwrap();
    assert_eq!(history.rows(), rows.len());
    for (k, values) in rows.iter().enumerate() {
        for (c, value) in values.iter().enumerate() {
            assert_eq!(history.column_at(c + 2).unwrap()[k].to_bits(), value.to_bits(), "{value:e}");
        }
    }
    assert_eq!(history.column("iterations").unwrap()[7], f64::from(u32::MAX));
    assert_eq!(history.column("increment").unwrap()[7], 7.0);
    assert_eq!(history.column("nothing"), None);
}

#[test]
fn text_is_the_shortest() {
    let mut line = Vec::new();
    let values = [0.0, -0.0, 2.0, 0.1, 1e-6, -0.005, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 31800.0];
    for value in values {
        number::push_exact(&mut line, value);
        line.push(b' ');
    }
    assert_eq!(String::from_utf8(line).unwrap(), "0 -0 2 0.1 1e-6 -0.005 nan inf -inf 1e300 31800 ");
}

#[test]
fn a_line_is_in_the_file_when_write_returns() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let mut writer = HistoryWriter::create(&path, &columns(2), false).unwrap();
    assert_eq!(read_to_string(&path).unwrap(), "step,increment,c0,c1,iterations\n");
    writer.write(&Row { step: 0, increment: 0, values: &[0.0, f64::NAN], iterations: 0 }).unwrap();
    assert_eq!(read_to_string(&path).unwrap(), "step,increment,c0,c1,iterations\n0,0,0,nan,0\n");
    writer.write(&Row { step: 1, increment: 10, values: &[0.5, -1e-7], iterations: 3 }).unwrap();
    // what SIGKILL leaves: no destructor runs
    std::mem::forget(writer);
    assert_eq!(read_to_string(&path).unwrap(), "step,increment,c0,c1,iterations\n0,0,0,nan,0\n1,10,0.5,-1e-7,3\n");
}

#[test]
fn no_row_outgrows_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = HistoryWriter::create(&folder.path().join("history.csv"), &columns(40), false).unwrap();
    let before = (writer.line.capacity(), writer.line.as_ptr());
    let longest = [-1.234_567_890_123_456_7e-300; 40];
    writer.write(&Row { step: u32::MAX, increment: u32::MAX, values: &longest, iterations: u32::MAX }).unwrap();
    assert_eq!((writer.line.capacity(), writer.line.as_ptr()), before);
}

#[test]
fn wrong_rows_and_files_are_errors_that_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let mut writer = HistoryWriter::create(&path, &columns(2), false).unwrap();
    let error = writer.write(&Row { step: 0, increment: 0, values: &[0.0], iterations: 0 }).unwrap_err();
    assert!(error.to_string().contains("history.csv: 1 values for 2 columns"), "{error}");
    std::fs::write(&path, "step,increment,time,iterations\n0,0,zero,0\n").unwrap();
    let error = History::read(&path).unwrap_err().to_string();
    assert!(error.contains("history.csv: line 2: `zero` is not a number"), "{error}");
    let missing = folder.path().join("no/history.csv");
    assert!(HistoryWriter::create(&missing, &columns(2), false).unwrap_err().to_string().contains("no/history.csv"));
    assert!(History::read(&missing).unwrap_err().to_string().contains("no/history.csv"));
}

#[test]
fn an_unfinished_last_line_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    std::fs::write(&path, "step,increment,time,iterations\n0,0,0,0\n1,1,0.5,2\n1,2,1.").unwrap();
    assert_eq!(History::read(&path).unwrap().column("time").unwrap(), [0.0, 0.5]);
}

/// `cargo test --release -p driver -- --ignored --nocapture formatting_speed`
#[test]
#[ignore = "a measurement"]
fn formatting_speed() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = HistoryWriter::create(&folder.path().join("history.csv"), &columns(32), false).unwrap();
    let mut random = fastrand::Rng::with_seed(2);
    // full-length numbers: the worst case; a third are zeros, as in a typical line
    let rows: Vec<Vec<f64>> = (0..1000)
        .map(|_| {
            let values = (0..32).map(|_| random.f64() - 0.5);
            values.enumerate().map(|(k, value)| if k % 3 == 0 { 0.0 } else { value * 1e-3 }).collect()
        })
        .collect();
    for (name, written) in [("formatting", false), ("with the system call", true)] {
        let start = std::time::Instant::now();
        for repeat in 0..200 {
            for values in &rows {
                let row = Row { step: 1, increment: repeat, values, iterations: 3 };
                if written {
                    writer.write(&row).unwrap()
                } else {
                    writer.format(&row)
                }
                std::hint::black_box(&writer.line);
            }
        }
        let line = start.elapsed().as_secs_f64() / (200.0 * rows.len() as f64);
        println!("{name}: {:.2} µs per line of 35 columns", line * 1e6);
    }
}

#[test]
fn a_long_history_is_thinned_and_keeps_ends_peaks_and_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let mut writer = HistoryWriter::create(&path, &columns(3), false).unwrap();
    let rows = 40_000;
    let value = |k: u32| {
        let wave = (f64::from(k) * 0.01).sin();
        [f64::from(k), if k == 12_345 { 7.0 } else { wave }, if k == 30_001 { f64::NAN } else { -wave }]
    };
    for k in 0..rows {
        writer.write(&Row { step: 1, increment: k, values: &value(k), iterations: 1 }).unwrap();
    }
    let file = HistoryFile::open(&path).unwrap();
    assert_eq!(file.thinned(usize::MAX).unwrap().rows(), rows as usize);
    let thinned = file.thinned(50_000).unwrap();
    assert!(thinned.rows() < 8_000 && thinned.rows() > 1_000, "{}", thinned.rows());
    let at = |column: &str| thinned.column(column).unwrap();
    let numbers = at("c0");
    assert_eq!((numbers[0], numbers[numbers.len() - 1]), (0.0, f64::from(rows - 1)));
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(at("c1").contains(&7.0) && at("c2").iter().any(|value| value.is_nan()));
    for (k, number) in numbers.iter().enumerate() {
        assert_eq!(at("c1")[k].to_bits(), value(*number as u32)[1].to_bits());
    }
}

#[test]
fn the_digest_is_of_the_file_and_goes_on_after_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("history.csv");
    let row = |increment| Row { step: 1, increment, values: &[0.5], iterations: 1 };
    let mut writer = HistoryWriter::create(&path, &columns(1), true).unwrap();
    (0..5).for_each(|k| writer.write(&row(k)).unwrap());
    let (bytes, before) = (writer.bytes(), writer.digest());
    assert_eq!(before, hexadecimal(digest(&path, u64::MAX).unwrap()));
    writer.write(&row(5)).unwrap();
    assert_eq!(before, hexadecimal(digest(&path, bytes).unwrap()));
    let expected = writer.digest();
    let mut again = HistoryWriter::resume(&path, &columns(1), bytes).unwrap();
    assert_eq!(again.digest(), before);
    again.write(&row(5)).unwrap();
    assert_eq!(again.digest(), expected);
}
