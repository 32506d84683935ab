use super::*;
use crate::directory::{Kind, ResultDirectory};

fn columns() -> Vec<String> {
    ["step", "increment", "time", "e11", "s11", "e33", "iterations"].map(String::from).to_vec()
}

pub(crate) fn summary() -> Summary {
    let mut recorder = PeakRecorder::new(&columns());
    let rows = [[0.0, 0.0, 0.0, f64::NAN], [0.5, 1e-4, 3.5, f64::NAN], [1.0, 2e-4, -1.5, f64::NAN]];
    for (k, values) in rows.iter().enumerate() {
        recorder.observe(&Row { step: k.min(1) as u32, increment: k as u32, values, iterations: 2 });
    }
    Summary {
        failed_at: None,
        reached: None,
        status: Status::Done,
        message: None,
        title: "A <title> & more".into(),
        plugin: PluginFile { path: "plugins/libx.so".into(), version: "0.1.0".into(), sha256: "ab".repeat(32) },
        plugins: vec![],
        peaks: recorder.peaks(),
        increments: 2,
        iterations: 4,
        plugin_calls: 6,
        cutbacks: 0,
        wall_time_s: 0.25,
        cpu_time_s: Some(0.2),
        compare: vec![Comparison {
            file: "measured.csv".into(),
            rms: Some(1.25),
            points: 7,
            outside: 1,
            x: "e11".into(),
            y: "s11".into(),
            warning: None,
        }],
        specimen: None,
        bridging: None,
        warnings: vec!["strains beyond 5 %".into()],
        notes: vec![],
    }
}

#[test]
fn has_the_keys_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let mut directory = ResultDirectory::join(folder.path(), Kind::Run).unwrap();
    directory.write(FILE, summary().text().unwrap()).unwrap();
    let value: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    let contract = "status title plugin peaks increments iterations plugin_calls cutbacks wall_time_s compare warnings";
    let ours = ["cpu_time_s"];
    let of_contract: Vec<&str> = keys.iter().copied().filter(|key| !ours.contains(key)).collect();
    assert_eq!(of_contract, contract.split(' ').collect::<Vec<_>>());
    assert_eq!(value["status"], "done");
    assert_eq!(value["plugin"]["sha256"].as_str().unwrap().len(), 64);
    assert_eq!(value["peaks"]["s11"]["max"], 3.5);
    assert_eq!(value["peaks"]["s11"]["min"], -1.5);
    assert_eq!(value["peaks"]["s11"]["max_at"]["increment"], 1);
    assert_eq!(value["peaks"]["e11"]["max_at"]["time"], 1.0);
    assert_eq!(value["compare"][0]["file"], "measured.csv");
    assert_eq!(value["compare"][0]["rms"], 1.25);
    let order: Vec<&String> = value["peaks"].as_object().unwrap().keys().collect();
    assert_eq!(order, ["e11", "s11", "e33"]);
}

#[test]
fn columns_without_a_number_have_no_peak() {
    let peaks = summary().peaks;
    assert_eq!(peaks["e33"], Peak::default());
    assert!(serde_json::to_string(&peaks).unwrap().contains(r#""e33":{"max":null,"min":null"#));
}

#[test]
fn reads_back_and_says_why_it_failed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    let failed = Summary { status: Status::Failed, message: Some("no convergence".into()), ..summary() };
    let mut directory = ResultDirectory::join(folder.path(), Kind::Run).unwrap();
    directory.write(FILE, failed.text().unwrap()).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().contains("\"status\": \"failed\""));
    assert_eq!(Summary::read(&path).unwrap(), failed);
    let error = Summary::read(&folder.path().join("missing.json")).unwrap_err().to_string();
    assert!(error.contains("missing.json"), "{error}");
}

#[test]
fn hashes_the_plugin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("libx.so");
    std::fs::write(&path, "abc").unwrap();
    // FIPS 180-2, appendix B.1
    let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(PluginFile::identify(&path, "1").unwrap().sha256, expected);
    assert!(PluginFile::identify(&folder.path().join("none"), "").is_err());
}
