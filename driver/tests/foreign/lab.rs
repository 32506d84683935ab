//! `pullout lab` as its page meets it: requests over a socket, a source that is saved, libraries that hang and crash, strangers.

use super::point;
use crate::program::{Desk, Table, command, send};
use end_to_end_tests::{Tool, find, workspace};
use rustix::process::Signal;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Time in which it must answer or end, on a busy machine too.
const PATIENCE: Duration = Duration::from_secs(60);

/// Names of E, nu, yield stress, hardening modulus in `j2.f90`.
const J2: [f64; 4] = [2e5, 0.3, 300.0, 2e3];

/// The answer that comes out of a stream.
fn heard(mut stream: TcpStream) -> String {
    let mut answer = String::new();
    let _ = stream.read_to_string(&mut answer);
    answer
}

/// Code and body of an answer.
fn parts(answer: &str) -> (u16, String) {
    let code = answer.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
    (code, answer.split_once("\r\n\r\n").map_or(String::new(), |(_, body)| body.to_owned()))
}

/// A lab, and a client that knows its token.
struct Lab {
    child: Child,
    port: u16,
    cookie: String,
}

impl Lab {
    fn open(folder: &Path, subject: &[&str]) -> Self {
        let mut started = command();
        started
            .current_dir(folder)
            .args(["lab", "--no-open"])
            .args(subject)
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut child = started.spawn().expect("the program starts");
        let mut address = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut address).expect("UTF-8");
        let (port, token) =
            address.trim().trim_start_matches("http://127.0.0.1:").split_once("/?token=").expect("an address");
        let cookie = format!("Cookie: pullout_lab_{port}={token}\r\n");
        Self { child, port: port.parse().expect("a port"), cookie }
    }

    /// Code and body of the answer to bytes.
    fn send(&self, request: &[u8]) -> (u16, String) {
        parts(&heard(self.ask(request)))
    }

    /// The answer to bytes.
    fn answer(&self, request: &[u8]) -> String {
        heard(self.ask(request))
    }

    /// Sends bytes; the answer will come out of the stream.
    fn ask(&self, request: &[u8]) -> TcpStream {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a time");
        // one that is refused early may be reset before it was read whole
        let _ = stream.write_all(request);
        stream
    }

    fn message(&self, line: &str, headers: &str, body: &str) -> Vec<u8> {
        let (port, length) = (self.port, body.len());
        let head = format!("{line} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{headers}Content-Length: {length}\r\n\r\n");
        [head.as_bytes(), body.as_bytes()].concat()
    }

    fn request(&self, line: &str, headers: &str, body: &str) -> (u16, String) {
        self.send(&self.message(line, headers, body))
    }

    /// A document for the lab.
    fn letter(&self, what: &str, document: &Value) -> Vec<u8> {
        let body = json!({ "page": "test", "document": document }).to_string();
        self.message(&format!("POST {what}"), &self.cookie, &body)
    }

    fn post(&self, what: &str, document: &Value) -> String {
        let (code, answer) = self.send(&self.letter(what, document));
        assert_eq!(code, 200, "{answer}");
        answer
    }

    fn run(&self, document: &Value) -> Value {
        serde_json::from_str(&self.post("/run", document)).expect("JSON")
    }

    fn verdict(&self, document: &Value) -> Value {
        serde_json::from_str(&self.post("/check", document)).expect("JSON")
    }

    fn library(&self, after: u64) -> Value {
        let (code, answer) = self.request(&format!("GET /library?after={after}"), &self.cookie, "");
        assert_eq!(code, 200, "{answer}");
        serde_json::from_str(&answer).expect("JSON")
    }

    /// Waits until a place is free after more connections than it holds.
    fn answers_again(&self, headers: &str) {
        let start = Instant::now();
        while self.request("GET /", headers, "").0 != 200 {
            assert!(start.elapsed() < PATIENCE, "it answers after a thousand connections");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn end(mut self) {
        send(Signal::TERM, self.child.id());
        let start = Instant::now();
        while self.child.try_wait().expect("a child").is_none() {
            assert!(start.elapsed() < PATIENCE, "a signal ends it");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}

fn tension(plugin: &Value, props: &Value) -> Value {
    let material = json!({ "plugin": plugin, "props": props, "nstatv": 7 });
    point(material, "3d", json!([{ "increments": 20, "target": { "e11": 0.004 } }]))
}

#[test]
fn what_is_seen_is_the_run_of_the_case_that_is_kept() {
    let desk = Desk::new();
    let lab = Lab::open(&desk.path(""), &["j2_plasticity"]);
    let case = json!({
        "kind": "point", "material": { "plugin": "j2_plasticity", "props": { "E": 1.9e5, "hardening": [[280.0, 0.0], [320.0, 0.01]] } },
        "steps": [{ "increments": 30, "target": { "e11": 0.01 } }, { "increments": 30, "target": { "s11": -100.0 } }],
    });
    let seen = lab.run(&case);
    assert_eq!(seen["status"], "done", "{seen}");
    assert_eq!(seen["figures"][0]["name"], "stress_strain");
    assert!(seen["figures"][0]["drawing"]["svg"].as_str().expect("a picture").starts_with("<svg"));
    fs::write(desk.path("seen.csv"), lab.post("/csv", &case)).expect("a file");
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    let (seen, rows) = (Table::read(&desk.path("seen.csv")), run.history);
    for column in ["e11", "s11", "e22", "peeq"] {
        assert_eq!(seen.column(column), rows.column(column), "{column}: to the last bit");
    }
    let input = lab.post("/abaqus", &case);
    assert!(
        input.contains("*USER MATERIAL, CONSTANTS=") && input.contains("190000.0") && input.contains("320.0, 0.01"),
        "{input}"
    );
    let verdict = lab.verdict(&case);
    assert_eq!(verdict["verdict"], "pass", "{verdict}");
    // what a case names lies in the lab's folder, for its verdict as for its run
    desk.write("path.csv", "time,e11\n1,0.001\n2,0.004\n");
    let mut tabulated = case.clone();
    tabulated["steps"] = json!([{ "table": "path.csv" }]);
    assert_eq!(lab.run(&tabulated)["status"], "done");
    let verdict = lab.verdict(&tabulated);
    assert_eq!(verdict["verdict"], "pass", "{verdict}");
    tabulated["steps"] = json!([{ "table": "nowhere.csv" }]);
    let refused = lab.verdict(&tabulated);
    assert_eq!((&refused["status"], &refused["problems"]), (&json!("refused"), &lab.run(&tabulated)["problems"]));
    let wrong = lab
        .run(&json!({ "kind": "point", "material": { "plugin": "j2_plasticity", "props": { "Em": 1 } }, "steps": [] }));
    assert!(wrong["status"] == "refused" && wrong["problems"].as_array().is_some_and(|all| !all.is_empty()), "{wrong}");
    lab.end();
}

#[test]
fn strangers_are_refused_and_no_other_library_is_called() {
    let desk = Desk::new();
    let lab = Lab::open(&desk.path(""), &[]);
    let own = lab.cookie.clone();
    for (line, headers, code) in [
        ("GET /", "", 403),
        ("GET /?token=00000000000000000000000000000000", "", 403),
        ("GET /start", "Cookie: pullout_lab_1=2\r\n", 403),
        ("GET /", own.as_str(), 200),
        ("GET /../../etc/passwd", own.as_str(), 404),
        ("POST /run", own.as_str(), 400),
    ] {
        assert_eq!(lab.request(line, headers, "").0, code, "{line} {headers}");
    }
    // a frame gets no cookies: there the path begins with the token, and who does not know it cannot show the page
    let token = own.trim().split_once('=').expect("a cookie").1;
    let other = "0".repeat(token.len());
    for (path, code) in [
        (format!("/{token}/"), 200),
        (format!("/{token}/lab.js"), 200),
        (format!("/{token}/start"), 200),
        (format!("/{token}/etc"), 404),
        (format!("/{token}"), 403),
        (format!("/{other}/"), 403),
        (format!("/{token}0/"), 403),
    ] {
        assert_eq!(lab.request(&format!("GET {path}"), "", "").0, code, "{path}");
    }
    let policy = |path: &str, headers: &str| {
        let head = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{headers}\r\n", lab.port);
        let answer = lab.answer(head.as_bytes());
        answer.lines().find(|line| line.starts_with("Content-Security-Policy")).expect("a policy").to_owned()
    };
    assert!(policy("/", &own).contains("frame-ancestors 'none'"));
    assert!(policy("/", "").contains("frame-ancestors 'none'"));
    assert!(!policy(&format!("/{token}/"), "").contains("frame-ancestors"));
    let body = json!({ "page": "test", "document": {} }).to_string();
    let foreign_page = format!("{own}Origin: http://example.org\r\n");
    assert_eq!(lab.request("POST /run", &foreign_page, &body).0, 403);
    // a name of a foreign page's that leads here
    let head = format!("GET / HTTP/1.1\r\nHost: example.org:{}\r\n{own}\r\n", lab.port);
    assert_eq!(lab.send(head.as_bytes()).0, 403);
    assert_eq!(lab.send(b"\0\0\0\r\n\r\n").0, 400);
    assert_eq!(lab.request("POST /run", &own, &"x".repeat(10 << 20)).0 % 413, 0, "refused, or reset");
    assert_eq!(lab.send(format!("GET / HTTP/1.1\r\nX: {}\r\n\r\n", "x".repeat(64 << 10)).as_bytes()).0 % 413, 0);
    let outside = desk.write("table.csv", "time,e11\n1,1e-3\n");
    for case in [
        tension(&json!("/lib/libnothing.so"), &json!([])),
        tension(&json!("halved_tangent"), &json!({})),
        point(json!({ "plugin": "linear_elastic" }), "3d", json!([{ "table": format!("../{}", outside.display()) }])),
    ] {
        assert_eq!(lab.run(&case)["status"], "refused", "{case}");
    }
    // connections that say nothing keep nobody out for long
    let idle: Vec<TcpStream> = (0..40).filter_map(|_| TcpStream::connect(("127.0.0.1", lab.port)).ok()).collect();
    assert_eq!(lab.request("GET /", &own, "").0, 200);
    drop(idle);
    for _ in 0..1000 {
        drop(TcpStream::connect(("127.0.0.1", lab.port)));
    }
    lab.answers_again(&own);
    lab.end();
}

#[test]
fn a_source_that_is_saved_is_built_and_run_again() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    let good = fs::read_to_string(workspace("tests/umats/j2.f90")).expect("a source");
    let source = desk.write("j2.f90", &good);
    let lab = Lab::open(&desk.path(""), &["j2.f90"]);
    let first = lab.library(0);
    assert_eq!(first["refusal"], Value::Null, "{first}");
    // it opens with as many constants and states as the source uses
    let start: Value = serde_json::from_str(&lab.request("GET /start", &lab.cookie, "").1).expect("JSON");
    assert_eq!(start["document"]["material"], json!({ "props": [2e5, 0.3, 1.0, 1.0], "nstatv": 7 }));
    let case = tension(&first["library"], &json!(J2));
    let seen = lab.run(&case);
    assert_eq!(seen["status"], "done", "{seen}");
    // E ε = 800 MPa > 300: the stress is (σ_y + H ε E / …) of uniaxial hardening
    let hardened = (300.0 + 2e3 * 0.004) / (1.0 + 2e3 / 2e5);
    let last = seen["figures"][0]["lines"][0]["points"].as_array().and_then(|points| points.last()).expect("a curve")
        [1]
    .as_f64();
    approx::assert_relative_eq!(last.expect("a number"), hardened, max_relative = 1e-6);
    assert_eq!(lab.verdict(&case)["verdict"], "pass");
    // the tangent alone
    let spoilt = good.replace("factor = 9 * mu**2", "factor = 4 * mu**2");
    assert_ne!(spoilt, good);
    fs::write(&source, spoilt).expect("a file");
    let second = lab.library(first["version"].as_u64().expect("a number"));
    assert_ne!(second["library"], first["library"], "{second}");
    let case = tension(&second["library"], &json!(J2));
    assert_eq!(lab.verdict(&case)["verdict"], "fail");
    // what the compiler refuses leaves the last good library
    fs::write(&source, good.replace("hardening = props(4)", "hardening = = props(4)")).expect("a file");
    let third = lab.library(second["version"].as_u64().expect("a number"));
    assert!(third["refusal"].as_str().is_some_and(|words| words.contains("j2.f90:21")), "{third}");
    assert_eq!(third["library"], second["library"]);
    assert_eq!(lab.run(&case)["status"], "done");
    lab.end();
}

/// A measured curve that is edited is read again: the RMS of the same case is that of the new points.
#[test]
fn data_that_are_saved_are_compared_again() {
    let desk = Desk::new();
    let data = desk.write("data.csv", "e11,s11\n0.001,30\n0.002,60\n");
    let steps = json!([{ "increments": 4, "target": { "e11": 2e-3 } }]);
    let mut case = point(json!({ "plugin": "linear_elastic", "props": { "E": 3e4 } }), "3d", steps);
    case["compare"] = json!([{ "file": "data.csv", "file_x": "e11", "file_y": "s11", "x": "e11", "y": "s11" }]);
    desk.case("case.json", &case);
    let lab = Lab::open(&desk.path(""), &["case.json"]);
    let first = lab.library(0);
    let rms = |seen: &Value| seen["compare"][0]["rms"].as_f64().expect("a number");
    let seen = lab.run(&case);
    assert!(rms(&seen) < 1e-9, "{seen}");
    fs::write(&data, "e11,s11\n0.001,33\n0.002,63\n").expect("a file");
    let second = lab.library(first["version"].as_u64().expect("a number"));
    assert_ne!(second["version"], first["version"], "{second}");
    let seen = lab.run(&case);
    approx::assert_relative_eq!(rms(&seen), 3.0, max_relative = 1e-9);
    lab.end();
}

/// A thousand at once, each with the beginning of a request: those over the limit are refused, and nobody is kept out for long.
#[test]
fn a_thousand_connections_at_once_end() {
    let desk = Desk::new();
    let lab = Lab::open(&desk.path(""), &[]);
    let own = lab.cookie.clone();
    let mut held: Vec<TcpStream> = Vec::new();
    for _ in 0..1000 {
        let Ok(mut stream) = TcpStream::connect(("127.0.0.1", lab.port)) else { continue };
        let _ = stream.write_all(b"POST /run HTTP/1.1\r\nContent-Length: 10");
        held.push(stream);
    }
    assert!(held.len() > 900, "{}", held.len());
    // all places are taken: the others were sent away, one of them by its answer
    let refused = held.iter_mut().rev().any(|stream| {
        let mut answer = [0; 12];
        let answered =
            stream.set_read_timeout(Some(Duration::from_secs(2))).and_then(|()| stream.read_exact(&mut answer));
        answered.is_ok() && answer == *b"HTTP/1.1 503"
    });
    assert!(refused, "requests over the limit get an error");
    drop(held);
    lab.answers_again(&own);
    lab.end();
}

#[test]
fn a_library_that_ends_its_process_or_hangs_ends_no_lab() {
    if find(Tool::C).is_none() {
        return;
    }
    let desk = Desk::new();
    desk.write(
        "bad.c",
        "#include <stdlib.h>\nvoid umat_(double *stress, double *statev, double *ddsdde, double *a, double *b, double *c, double *d, double *e, double \
         *f, double *g, double *h, double *i, double *j, double *k, double *l, double *m, double *n, double *o, char *p, int *q, int *r, int *ntens, \
         int *s, double *props)\n{ if (props[0] > 1) for (;;) ; abort(); }\n",
    );
    let lab = Lab::open(&desk.path(""), &["bad.c"]);
    let library = lab.library(0);
    for (what, words) in [(1.0, "SIGABRT"), (2.0, "")] {
        let start = Instant::now();
        let seen = lab.run(&tension(&library["library"], &json!([what])));
        assert!(seen["status"] == "failed" || seen["status"] == "refused", "{seen}");
        assert!(seen.to_string().contains(words), "{seen}");
        assert!(start.elapsed() < PATIENCE);
    }
    // calls that end a process that the lab did not start itself
    let verdict = lab.verdict(&tension(&library["library"], &json!([1.0])));
    let law = &verdict["laws"][0];
    assert!(verdict["verdict"] == "fail" && law["rows"].to_string().contains("SIGABRT"), "{verdict}");
    assert!(law["replays"].as_array().is_some_and(|all| !all.is_empty()), "{verdict}");
    assert_eq!(
        lab.run(&point(
            json!({ "plugin": "linear_elastic" }),
            "3d",
            json!([{ "increments": 2, "target": { "e11": 1e-3 } }])
        ))["status"],
        "done"
    );
    lab.end();
}

#[test]
fn a_finished_run_is_shown_with_its_report() {
    let desk = Desk::new();
    let steps = json!([{ "increments": 4, "target": { "e11": 1e-3 } }]);
    let run =
        desk.run(&desk.case("case.json", &point(json!({ "plugin": "linear_elastic" }), "3d", steps)), &[], "out", 0);
    let lab = Lab::open(&desk.path(""), &["out"]);
    let (code, start) = lab.request("GET /start", &lab.cookie, "");
    let start: Value = serde_json::from_str(&start).expect("JSON");
    assert_eq!((code, &start["document"]["kind"], &start["has_report"]), (200, &json!("results"), &json!(true)));
    let seen = lab.run(&start["document"]);
    assert_eq!((&seen["status"], &seen["increments"]), (&json!("done"), &json!(4)));
    let points = seen["figures"][0]["lines"][0]["points"].as_array().expect("points");
    assert_eq!(points.last().map(|point| point[1].as_f64()), Some(Some(run.history.last("s11"))));
    // the table as the folder has it, whole numbers without a point
    let kept = fs::read_to_string(desk.path("out/history.csv")).expect("rows");
    assert_eq!(lab.post("/csv", &start["document"]), kept);
    let head = format!("GET /report HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}\r\n", lab.port, lab.cookie);
    let report = lab.answer(head.as_bytes());
    assert!(report.contains("Content-Security-Policy: sandbox") && report.contains("<h1>"), "a page of nobody's");
    lab.end();
}

/// σ(w), and the strengths of the beam, as `pullout run` has them.
#[test]
fn a_mix_of_fibres_has_its_strengths() {
    let desk = Desk::new();
    let lab = Lab::open(&desk.path(""), &["bridging"]);
    let start: Value = serde_json::from_str(&lab.request("GET /start", &lab.cookie, "").1).expect("JSON");
    let document = &start["document"];
    let seen = lab.run(document);
    let names: Vec<&Value> =
        seen["figures"].as_array().expect("figures").iter().map(|figure| &figure["name"]).collect();
    assert_eq!(names[..2], [&json!("load_cmod"), &json!("sigma_w")], "{seen}");
    desk.pullout(["run", "--quiet", desk.case("mix.json", document).to_str().expect("UTF-8")]).expect(0);
    let summary = crate::program::json(&desk.path("out/mix/summary.json"));
    assert_eq!(seen["findings"], summary["bridging"]);
    let mut more = document.clone();
    more["volume_fraction"] = json!(0.01);
    assert!(lab.run(&more)["findings"]["beam"]["f_R"][2].as_f64() > seen["findings"]["beam"]["f_R"][2].as_f64());
    lab.end();
}

#[test]
fn of_checks_that_wait_only_the_newest_is_made() {
    let desk = Desk::new();
    let lab = Lab::open(&desk.path(""), &["j2_plasticity"]);
    let case = |strain: f64| {
        point(
            json!({ "plugin": "j2_plasticity", "props": { "hardening": [[300.0, 0.0], [400.0, 0.1]] } }),
            "3d",
            json!([{ "increments": 20, "target": { "e11": strain } }]),
        )
    };
    let strains = [0.01, 0.011, 0.012, 0.013];
    // one after the other, and none waits for the answer to an earlier one
    let asked = strains.map(|strain| {
        let stream = lab.ask(&lab.letter("/check", &case(strain)));
        std::thread::sleep(Duration::from_millis(30));
        stream
    });
    let answers = asked.map(|stream| serde_json::from_str::<Value>(&parts(&heard(stream)).1).expect("JSON"));
    assert_eq!(answers[3]["verdict"], "pass", "{answers:?}");
    assert!(answers[1]["status"] == "superseded" && answers[2]["status"] == "superseded", "{answers:?}");
    lab.end();
}
