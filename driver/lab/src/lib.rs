//! `pullout lab`: a page in the browser with a law's parameters and its curves, which move while one types; a library of one's
//! own is built again and run again whenever its source is saved.
//!
//! The server listens on the loopback interface alone and answers only who knows its token; cases that a page sends may name shipped
//! laws and what the command line named, nothing else. Cases are read and run by [`pullout_engine`], pictures drawn by
//! [`pullout_report`]: the page only shows them.

mod done;
mod http;
mod subject;
mod watch;
mod work;

pub use watch::{FileStamp, FileWatch};

use http::{Request, Response};
use pullout_run::{PLUGIN_STACK, signals};
use serde_json::{Value, json};
use std::io;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;
use subject::Subject;
pub use work::Examination;
use work::{Wanted, Work};

/// Requests that are answered at the same time; more are refused.
const MOST_REQUESTS: usize = 64;
/// Time between two looks for a signal.
const LOOK: Duration = Duration::from_millis(50);

const PAGE: &str = include_str!("../page/lab.html");
const STYLE: &str = include_str!("../page/lab.css");
const SCRIPT: &str = include_str!("../page/lab.js");

/// What a lab is opened with.
#[derive(Clone, Debug, Default)]
pub struct LabSettings {
    /// A law's name, a case, a library, a source or the result directory of a run; `None`: a law of ours.
    pub subject: Option<String>,
    /// The case to begin with, instead of the subject's.
    pub document: Option<Value>,
    /// Folders that are searched for plugins first.
    pub plugin_paths: Vec<PathBuf>,
    /// Port; 0: any that is free.
    pub port: u16,
}

/// Why there is no lab.
#[derive(Debug, thiserror::Error)]
pub enum LabError {
    /// Nothing to open it with.
    #[error("{0}")]
    Subject(String),
    /// The system gives no port, thread or file.
    #[error(transparent)]
    System(#[from] io::Error),
}

/// A lab that listens.
pub struct Lab {
    listener: TcpListener,
    shared: Arc<Shared>,
}

struct Shared {
    port: u16,
    token: String,
    subject: Subject,
    work: Work,
    requests: AtomicUsize,
}

impl Lab {
    /// Opens a lab: its port is taken, its library built.
    ///
    /// # Errors
    /// [`LabError`].
    pub fn open(settings: &LabSettings) -> Result<Self, LabError> {
        let subject = match &settings.document {
            Some(document) => Subject::of_document(document.clone(), &settings.plugin_paths)?,
            None => Subject::of(settings.subject.as_deref(), &settings.plugin_paths)?,
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, settings.port))
            .map_err(|error| LabError::Subject(format!("--port {}: {error}", settings.port)))?;
        let port = listener.local_addr()?.port();
        let shared =
            Shared { port, token: http::token()?, subject, work: Work::default(), requests: AtomicUsize::new(0) };
        Ok(Self { listener, shared: Arc::new(shared) })
    }

    /// The address that a browser is given, with the token.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.shared.port, self.shared.token)
    }

    /// Answers requests until a signal arrives. Threads end with the process.
    ///
    /// # Errors
    /// The port or a thread is lost.
    pub fn serve(self) -> Result<(), LabError> {
        let shared = self.shared.clone();
        thread::Builder::new().name("pullout watch".into()).spawn(move || shared.subject.watch())?;
        self.listener.set_nonblocking(true)?;
        while signals::received().is_none() {
            match self.listener.accept() {
                Ok((stream, _)) => self.shared.clone().take(stream),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => wait_for_one(&self.listener),
                // a client that has gone again, descriptors that come back
                Err(_) => thread::sleep(LOOK),
            }
        }
        Ok(())
    }
}

/// Waits until somebody connects, for a moment at most.
fn wait_for_one(listener: &TcpListener) {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let moment = Timespec { tv_sec: 0, tv_nsec: LOOK.as_nanos() as _ };
    // a signal ends it early
    let _ = poll(&mut [PollFd::new(listener, PollFlags::IN)], Some(&moment));
}

impl Shared {
    /// Answers a connection on a thread of its own, on which a law may run.
    fn take(self: Arc<Self>, mut stream: TcpStream) {
        let place = Place::of(&self);
        if self.requests.load(Ordering::Relaxed) > MOST_REQUESTS {
            Response::refusal(503, "too many requests at once").send(&mut stream);
            return;
        }
        let shared = self.clone();
        let answer = move || {
            let _place = place;
            if stream.set_nonblocking(false).is_err() {
                return;
            }
            let response = match Request::read(&mut stream) {
                Ok(request) => shared.answer(&request),
                Err(refusal) => refusal,
            };
            response.send(&mut stream);
        };
        // without a thread the connection is closed
        let _ = thread::Builder::new().name("pullout lab".into()).stack_size(PLUGIN_STACK).spawn(answer);
    }

    fn answer(&self, request: &Request) -> Response {
        if !request.is_from_here() {
            return Response::refusal(403, "asked for by another name than this machine's, or from another page");
        }
        let (port, token) = (self.port, self.token.as_str());
        if request.method == "GET" && request.path == "/" && request.brings(token) {
            return Response::signed_in(port, token);
        }
        if let Some(path) = request.within(token) {
            return self.page(path, request).framed();
        }
        if !request.knows(port, token) {
            return Response::refusal(403, "open the address that `pullout lab` has printed, with its token");
        }
        self.page(&request.path, request)
    }

    /// What a path is to who knows the token.
    fn page(&self, path: &str, request: &Request) -> Response {
        match (request.method.as_str(), path) {
            ("GET", "/") => Response::of("text/html; charset=utf-8", PAGE),
            ("GET", "/lab.css") => Response::of("text/css; charset=utf-8", STYLE),
            ("GET", "/lab.js") => Response::of("text/javascript; charset=utf-8", SCRIPT),
            ("GET", "/report") => match self.subject.report() {
                Some(text) => Response::report(text),
                None => Response::refusal(404, "there is no report"),
            },
            ("GET", "/start") => Response::json(&json!({
                "document": self.subject.document,
                "laws": self.subject.laws,
                "library": self.subject.library(),
                "has_report": self.subject.report().is_some(),
            })),
            ("GET", "/library") => {
                let version = request.query.strip_prefix("after=").and_then(|version| version.parse().ok());
                Response::json(&self.subject.library_after(version.unwrap_or_default()))
            }
            ("POST", path) => self.work_on(path, &request.body),
            _ => Response::refusal(404, "there is nothing here"),
        }
    }

    fn work_on(&self, path: &str, body: &[u8]) -> Response {
        let wanted: Wanted = match serde_json::from_slice(body) {
            Ok(wanted) => wanted,
            Err(error) => return Response::refusal(400, &error.to_string()),
        };
        let text = |written: Result<String, Value>| match written {
            Ok(text) => Response::of("text/plain; charset=utf-8", text),
            Err(refusal) => Response::json(&refusal),
        };
        match path {
            "/run" => Response::json(&self.work.run(&self.subject, &wanted)),
            "/fit" => Response::json(&self.work.fit(&self.subject, &wanted)),
            "/check" => Response::json(&self.work.check(&self.subject, &wanted)),
            "/csv" => text(self.work.csv(&self.subject, &wanted)),
            "/abaqus" => text(self.work.abaqus(&self.subject, &wanted)),
            _ => Response::refusal(404, "there is nothing here"),
        }
    }
}

/// A place among the requests that are answered at the same time.
struct Place(Arc<Shared>);

impl Place {
    fn of(shared: &Arc<Shared>) -> Self {
        shared.requests.fetch_add(1, Ordering::Relaxed);
        Self(shared.clone())
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.requests.fetch_sub(1, Ordering::Relaxed);
    }
}
