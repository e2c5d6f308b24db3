//! One page for one reader: served on the loopback address, to whoever has the token, until the tab is shut.

use std::net::Ipv4Addr;
use std::time::{Duration, Instant};

use tiny_http::{Header, Method, Request, Response, Server};

use super::exit::{Exit, Failure};
use super::streams;
use crate::progress::{Progress, Stopped};

/// How often it is looked whether the run was to stop.
const LOOK: Duration = Duration::from_millis(100);

/// After the last tab was shut, this long it may come back.
const BACK: Duration = Duration::from_secs(3);

/// Where a tab says that it is shut.
const FAREWELL: &str = "bye";

/// A page that is served.
pub struct Served {
    server: Server,
    port: u16,
    token: String,
}

impl Served {
    /// Opens a port that the system chooses, with a token that nobody can guess.
    pub fn open() -> Result<Self, Failure> {
        let failed = |why: String| {
            Failure::new(Exit::Write, format!("the page cannot be served: {why}"))
                .hint("-o OUT.html writes it to a file instead")
        };
        let mut token = [0u8; 16];
        getrandom::fill(&mut token).map_err(|error| failed(error.to_string()))?;
        let server = Server::http((Ipv4Addr::LOCALHOST, 0)).map_err(|error| failed(error.to_string()))?;
        let port = server.server_addr().to_ip().map(|address| address.port());
        let port = port.ok_or_else(|| failed("it has no port".into()))?;
        Ok(Self { server, port, token: streams::hex(&token) })
    }

    /// Where the page is.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Serves the page until its tab is shut, or the run is to stop.
    pub fn run(&self, page: &str, progress: &Progress) -> Result<(), Stopped> {
        // A tab that loads the page anew may ask for it before it says farewell, or after.
        let mut tabs = 0usize;
        let mut shut: Option<Instant> = None;
        loop {
            progress.check()?;
            if shut.is_some_and(|since| since.elapsed() > BACK) {
                return Ok(());
            }
            // What cannot be read is no request.
            let Ok(Some(request)) = self.server.recv_timeout(LOOK) else { continue };
            match self.wanted(&request) {
                Wanted::Page => {
                    shut = None;
                    let head = *request.method() == Method::Head;
                    tabs += usize::from(!head);
                    answer(request, Response::from_string(if head { "" } else { page }));
                }
                Wanted::Farewell => {
                    tabs = tabs.saturating_sub(1);
                    shut = (tabs == 0).then(Instant::now);
                    answer(request, Response::from_string("").with_status_code(204));
                }
                Wanted::Nothing => answer(request, Response::from_string("").with_status_code(404)),
            }
        }
    }

    /// What a request may have: nothing without the token, under another name of the machine, or from elsewhere.
    fn wanted(&self, request: &Request) -> Wanted {
        let header = |name: &'static str| {
            let mut all = request.headers().iter().filter(move |header| header.field.equiv(name));
            all.next().map(|header| header.value.as_str()).filter(|_| all.next().is_none())
        };
        let near = request.remote_addr().is_some_and(|address| address.ip().is_loopback());
        let host = format!("127.0.0.1:{}", self.port);
        if !near || header("Host") != Some(host.as_str()) {
            return Wanted::Nothing;
        }
        let Some(rest) = request.url().strip_prefix('/').and_then(|path| path.split_once('/')) else {
            return Wanted::Nothing;
        };
        let (token, rest) = rest;
        match (request.method(), rest) {
            _ if !same(token, &self.token) => Wanted::Nothing,
            (Method::Get | Method::Head, "") => Wanted::Page,
            (Method::Post, FAREWELL) => Wanted::Farewell,
            _ => Wanted::Nothing,
        }
    }
}

enum Wanted {
    Page,
    Farewell,
    Nothing,
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(given: &str, token: &str) -> bool {
    given.len() == token.len() && given.bytes().zip(token.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

/// Answers on a thread of its own: a reader that does not read keeps nobody waiting.
fn answer(request: Request, response: Response<std::io::Cursor<Vec<u8>>>) {
    let headers = [
        ("Content-Type", "text/html; charset=utf-8"),
        ("Cache-Control", "no-store"),
        ("Referrer-Policy", "no-referrer"),
        ("X-Content-Type-Options", "nosniff"),
        ("X-Frame-Options", "DENY"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
    ];
    let headers = headers.iter().filter_map(|(name, value)| Header::from_bytes(name.as_bytes(), value.as_bytes()).ok());
    let response = headers.fold(response, Response::with_header);
    // A reader that has gone needs no answer.
    std::thread::spawn(move || drop(request.respond(response)));
}
