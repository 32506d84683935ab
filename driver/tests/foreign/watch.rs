//! `pullout run --watch`: a saved file is built and run again, a failure is waited out, and Ctrl-C leaves no process or file.

use super::{close, point};
use crate::program::{Desk, command, send};
use end_to_end_tests::{Tool, find};
use rustix::process::Signal;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Longest time from a save to what follows.
const PATIENCE: Duration = Duration::from_secs(60);

/// σ = E ε, component by component; E stands in a header.
const SOURCE: &str = "\
#include \"modulus.h\"
void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
           double *drplde, double *drpldt, double *stran, double *dstran, double *time, double *dtime, double *temp, double *dtemp,
           double *predef, double *dpred, char *cmname, int *ndi, int *nshr, int *ntens)
{
  for (int i = 0; i < *ntens; i++) {
    for (int k = 0; k < *ntens; k++) ddsdde[i + k * *ntens] = i == k ? MODULUS : 0.0;
    stress[i] = MODULUS * (stran[i] + dstran[i]);
  }
}
";

/// The program, with what it prints.
struct Watching {
    child: Child,
    lines: Receiver<String>,
    complaints: Receiver<String>,
}

/// Lines of a stream as they come.
fn lines(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (give, take) = channel();
    thread::spawn(move || BufReader::new(stream).lines().map_while(Result::ok).try_for_each(|line| give.send(line)));
    take
}

impl Watching {
    fn start(desk: &Desk, arguments: &[&str]) -> Self {
        let mut started = command();
        started.current_dir(desk.path("")).args(["run", "case.json", "--watch"]).args(arguments);
        started.env("XDG_CACHE_HOME", desk.path("cache")).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = started.spawn().expect("the program starts");
        let complaints = lines(child.stderr.take().expect("piped"));
        Self { lines: lines(child.stdout.take().expect("piped")), complaints, child }
    }

    /// The next summary.
    fn summary(&self) -> Value {
        let line = self.lines.recv_timeout(PATIENCE).expect("a line in time");
        serde_json::from_str(&line).expect("JSON")
    }

    /// Waits for a line on the standard error.
    fn hear(&self, words: &str) {
        let end = Instant::now() + PATIENCE;
        while !self.complaints.recv_timeout(end - Instant::now()).expect("a line in time").contains(words) {}
    }

    /// Ends it as Ctrl-C does, which processes in the background ignore; the exit code.
    fn end(&mut self) -> Option<i32> {
        send(Signal::TERM, self.child.id());
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            if let Some(status) = self.child.try_wait().expect("a child") {
                return status.code();
            }
            thread::sleep(Duration::from_millis(20));
        }
        panic!("it goes on after the signal");
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}

#[test]
fn a_source_its_header_and_the_data_that_are_saved_are_run_again() {
    if find(Tool::C).is_none() {
        return;
    }
    let desk = Desk::new();
    let source = desk.write("law.c", SOURCE);
    let header = desk.write("modulus.h", "#define MODULUS 100.0\n");
    let table = desk.write("path.csv", "time,e11\n0.5,0.005\n1,0.01\n");
    let case = point(json!({ "plugin": "law.c", "props": [], "nstatv": 0 }), "3d", json!([{ "table": "path.csv" }]));
    desk.case("case.json", &case);
    let mut watching = Watching::start(&desk, &["--json"]);
    // E ε at the end of the path
    let greatest = |summary: &Value| summary["peaks"]["s11"]["max"].as_f64().expect("a number");
    let first = watching.summary();
    assert_eq!(
        (&first["status"], &first["case"], &first["folder"]),
        (&json!("done"), &json!("case.json"), &json!("out/case"))
    );
    close(greatest(&first), 1.0);
    watching.hear("watching");
    fs::write(&header, "#define MODULUS 300.0\n").expect("a file");
    close(greatest(&watching.summary()), 3.0);
    assert!(desk.path("out/case/report.html").is_file());
    // what is wrong is said, and the next save is waited for
    fs::write(&source, SOURCE.replace("stress[i] =", "stress[i] = =")).expect("a file");
    watching.hear("law.c:8");
    fs::write(&source, SOURCE.replace("MODULUS * (", "2.0 * MODULUS * (")).expect("a file");
    close(greatest(&watching.summary()), 6.0);
    fs::write(desk.path("case.json"), "{").expect("a file");
    watching.hear("case.json:");
    // a run that fails has a summary as well
    fs::write(&source, SOURCE.replace("MODULUS * (", "0.0 / (*stran - *stran) + (")).expect("a file");
    desk.case("case.json", &case);
    assert_eq!(watching.summary()["status"], "failed");
    fs::write(&source, SOURCE).expect("a file");
    close(greatest(&watching.summary()), 3.0);
    fs::write(&table, "time,e11\n0.5,0.005\n1,0.02\n").expect("a file");
    close(greatest(&watching.summary()), 6.0);
    assert_eq!(watching.end(), Some(0));
    let folder = desk.path("").canonicalize().expect("a folder");
    let is_there = |entry: &fs::DirEntry| fs::read_link(entry.path().join("cwd")).is_ok_and(|place| place == folder);
    let left: Vec<_> = fs::read_dir("/proc").expect("processes").flatten().filter(is_there).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_signal_ends_a_call_that_does_not_come_back() {
    if find(Tool::C).is_none() {
        return;
    }
    let desk = Desk::new();
    desk.write("modulus.h", "#define MODULUS 100.0\n");
    desk.write("law.c", &SOURCE.replace("  for (int i = 0; i", "  for (;;) ;\n  for (int i = 0; i"));
    let steps = json!([{ "increments": 2, "target": { "e11": 0.01 } }]);
    desk.case("case.json", &point(json!({ "plugin": "law.c", "props": [], "nstatv": 0 }), "3d", steps));
    let mut watching = Watching::start(&desk, &[]);
    watching.hear("built as");
    thread::sleep(Duration::from_millis(300));
    assert_eq!(watching.end(), Some(143));
}
