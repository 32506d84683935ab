//! Requests and answers on the loopback interface: one a connection, with limits of size and time, and checks of who asks.

use std::fmt::Write as _;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Longest head of a request, bytes.
const LONGEST_HEAD: usize = 16 << 10;
/// Longest body of a request, bytes.
const LONGEST_BODY: usize = 4 << 20;
/// Headers of a request at most.
const MOST_HEADERS: usize = 64;
/// Time that a client may take between two bytes.
const PATIENCE: Duration = Duration::from_secs(10);

/// Names under which a page asks for this machine; another one is a foreign page's (DNS rebinding).
const OWN_NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// Content security policy of the page: no loading from other sites, no inline scripts.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'";
/// What a report may do, which is one file with its scripts: nothing but show itself, as a page of nobody's.
const POLICY_OF_A_REPORT: &str = "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; \
                                  style-src 'unsafe-inline'; img-src data: blob:";
/// What keeps it out of another page's frame.
const UNFRAMED: &str = "; frame-ancestors 'none'";

/// A request.
#[derive(Debug, Default)]
pub(crate) struct Request {
    /// GET, POST, …
    pub method: String,
    /// Path without the query.
    pub path: String,
    /// What follows the question mark.
    pub query: String,
    host: String,
    origin: Option<String>,
    cookies: String,
    /// Body.
    pub body: Vec<u8>,
}

/// An answer.
#[derive(Debug)]
pub(crate) struct Response {
    code: u16,
    kind: &'static str,
    more: String,
    policy: &'static str,
    frames: &'static str,
    body: Vec<u8>,
}

impl Response {
    /// An answer with a body of a media type.
    pub fn of(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { code: 200, kind, more: String::new(), policy: POLICY, frames: UNFRAMED, body: body.into() }
    }

    /// Makes the response with the report of a run.
    pub fn report(text: Vec<u8>) -> Self {
        Self { policy: POLICY_OF_A_REPORT, ..Self::of("text/html; charset=utf-8", text) }
    }

    /// An answer as JSON.
    pub fn json(value: &serde_json::Value) -> Self {
        Self::of("application/json", value.to_string())
    }

    /// A refusal.
    pub fn refusal(code: u16, message: &str) -> Self {
        Self { code, ..Self::of("text/plain; charset=utf-8", format!("{message}\n")) }
    }

    /// Sends the browser to `/` with the token as a cookie of this port.
    pub fn signed_in(port: u16, token: &str) -> Self {
        let more =
            format!("Location: /\r\nSet-Cookie: {}={token}; HttpOnly; SameSite=Strict; Path=/\r\n", cookie(port));
        Self { code: 303, more, ..Self::of("text/plain", "") }
    }

    /// Lets a page show the answer in a frame: for who has brought the token, which no other page knows.
    pub fn framed(self) -> Self {
        Self { frames: "", ..self }
    }

    /// Sends the answer. A client that has gone is no error.
    pub fn send(self, stream: &mut TcpStream) {
        let reason = match self.code {
            200 => "OK",
            303 => "See Other",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            413 => "Content Too Large",
            503 => "Service Unavailable",
            _ => "Error",
        };
        let head = format!(
            "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
             Referrer-Policy: no-referrer\r\nContent-Security-Policy: {}{}\r\n{}Connection: close\r\n\r\n",
            self.code,
            self.kind,
            self.body.len(),
            self.policy,
            self.frames,
            self.more
        );
        let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(&self.body));
    }
}

/// The name of the cookie; each port has its own, since cookies know no ports.
fn cookie(port: u16) -> String {
    format!("pullout_lab_{port}")
}

impl Request {
    /// Reads a request; a refusal if it is none, or too long, or slow.
    pub fn read(stream: &mut TcpStream) -> Result<Self, Response> {
        let malformed = || Response::refusal(400, "not a request");
        stream
            .set_read_timeout(Some(PATIENCE))
            .and_then(|()| stream.set_write_timeout(Some(PATIENCE)))
            .map_err(|_| malformed())?;
        let mut text = Vec::new();
        let (mut request, begin, length) = loop {
            let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
            let mut parsed = httparse::Request::new(&mut headers);
            match parsed.parse(&text) {
                Ok(httparse::Status::Complete(begin)) => {
                    let (request, length) = Self::of(&parsed).ok_or_else(malformed)?;
                    break (request, begin, length);
                }
                Ok(httparse::Status::Partial) if text.len() < LONGEST_HEAD => {}
                Ok(httparse::Status::Partial) => {
                    return Err(Response::refusal(413, "the head of the request is too long"));
                }
                Err(_) => return Err(malformed()),
            }
            if more(stream, &mut text).map_err(|_| malformed())? == 0 {
                return Err(malformed());
            }
        };
        if length > LONGEST_BODY {
            return Err(Response::refusal(413, "the body of the request is too long"));
        }
        while text.len() < begin + length {
            if more(stream, &mut text).map_err(|_| malformed())? == 0 {
                return Err(malformed());
            }
        }
        request.body = text.drain(begin..begin + length).collect();
        Ok(request)
    }

    /// Returns the request without its body, and the length of the body.
    fn of(parsed: &httparse::Request<'_, '_>) -> Option<(Self, usize)> {
        let (path, query) = parsed.path?.split_once('?').unwrap_or((parsed.path?, ""));
        let header = |name: &str| {
            let mut values = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
            values.next().map(|header| String::from_utf8_lossy(header.value).into_owned())
        };
        let length = match header("content-length") {
            Some(length) => length.trim().parse().ok()?,
            None => 0,
        };
        // bodies in pieces are not needed by the page
        if header("transfer-encoding").is_some() {
            return None;
        }
        let request = Self {
            method: parsed.method?.to_owned(),
            path: path.to_owned(),
            query: query.to_owned(),
            host: header("host").unwrap_or_default(),
            origin: header("origin"),
            cookies: header("cookie").unwrap_or_default(),
            body: Vec::new(),
        };
        Some((request, length))
    }

    /// Returns whether the request is for this machine by name, and from a page of this server if it is from one.
    pub fn is_from_here(&self) -> bool {
        let name = self
            .host
            .rsplit_once(':')
            .filter(|(_, port)| port.parse::<u16>().is_ok())
            .map_or(&*self.host, |(name, _)| name);
        let own = self.origin.as_ref().is_none_or(|origin| *origin == format!("http://{}", self.host));
        OWN_NAMES.contains(&name) && own
    }

    /// Returns whether the token is in the query.
    pub fn brings(&self, token: &str) -> bool {
        self.query.split('&').any(|pair| pair.strip_prefix("token=") == Some(token))
    }

    /// Returns what follows the token in a path that begins with it, as of a page in a frame, which gets no cookies.
    pub fn within(&self, token: &str) -> Option<&str> {
        self.path.strip_prefix('/')?.strip_prefix(token).filter(|path| path.starts_with('/'))
    }

    /// Returns whether the token is in the cookie of this port.
    pub fn knows(&self, port: u16, token: &str) -> bool {
        let name = cookie(port);
        self.cookies
            .split(';')
            .filter_map(|pair| pair.trim().split_once('='))
            .any(|(key, value)| key == name && value == token)
    }
}

fn more(stream: &mut TcpStream, text: &mut Vec<u8>) -> io::Result<usize> {
    let mut piece = [0; 8 << 10];
    let count = stream.read(&mut piece)?;
    text.extend_from_slice(piece.get(..count).unwrap_or_default());
    Ok(count)
}

/// A token that nobody guesses: 128 random bits of the system's, in hexadecimal digits.
pub(crate) fn token() -> io::Result<String> {
    let mut bits = [0u8; 16];
    std::fs::File::open("/dev/urandom")?.read_exact(&mut bits)?;
    Ok(bits.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}
