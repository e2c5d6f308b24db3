//! `view`: who has the token gets the page, and nobody else gets anything.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::{folder, program, run_in};

/// A viewer that runs, and where its page is.
struct Viewer {
    process: Child,
    port: u16,
    token: String,
}

impl Viewer {
    fn of(files: &[&str]) -> Self {
        let mut command = program();
        command.arg("view").args(files).arg("-q").stdout(Stdio::piped()).stderr(Stdio::null());
        let mut process = command.spawn().expect("the program starts");
        let mut line = String::new();
        let out = process.stdout.take().expect("standard output");
        BufReader::new(out).read_line(&mut line).expect("an address");
        let rest = line.trim().strip_prefix("http://127.0.0.1:").expect("the loopback address").to_string();
        let (port, token) = rest.split_once('/').expect("a token");
        let token = token.trim_end_matches('/').to_string();
        assert!(token.len() == 32 && token.bytes().all(|byte| byte.is_ascii_hexdigit()), "{line}");
        Self { port: port.parse().expect("a port"), token, process }
    }

    /// What a request gets: its status, and the body.
    fn asks(&self, method: &str, path: &str, host: &str) -> (u16, String) {
        self.sends(&format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
        ))
    }

    fn sends(&self, request: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
        stream.write_all(request.as_bytes()).expect("it reads");
        let mut answer = Vec::new();
        // A refused connection is a refusal, too.
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
        (status, answer.split_once("\r\n\r\n").map_or("", |(_, body)| body).to_string())
    }

    fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// How it ends, and after how long.
    fn ends(&mut self) -> (Option<i32>, Duration) {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(20) {
            if let Some(status) = self.process.try_wait().expect("it is ours") {
                return (status.code(), start.elapsed());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        panic!("it does not end");
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn only_who_has_the_token_gets_the_page() {
    let mut viewer = Viewer::of(&["testdata/torus.ply"]);
    let (host, token) = (viewer.host(), viewer.token.clone());
    let page = format!("/{token}/");
    let (status, body) = viewer.asks("GET", &page, &host);
    assert!(status == 200 && body.contains("torus.ply") && body.contains("connect-src 'self'"), "{status}");
    let wrong = "0".repeat(32);
    let longer = format!("/{token}0/");
    let paths = [
        "/",
        "",
        "//",
        "/index.html",
        "/favicon.ico",
        &format!("/{wrong}/"),
        &longer,
        &format!("/{}/", &token[..31]),
        &format!("/{token}"),
        &format!("/{token}/../"),
        &format!("/{token}/../../etc/passwd"),
        &format!("/{token}/torus.ply"),
        &format!("/{token}//"),
        &format!("/{token}/?x"),
        &format!("/./{token}/"),
        &format!("/%2e/{token}/"),
        &format!("//{token}/"),
        "/../../../../etc/passwd",
        "/testdata/torus.ply",
        "http://127.0.0.1/",
        "*",
    ];
    for path in paths {
        let (status, body) = viewer.asks("GET", path, &host);
        assert!(status != 200 && body.len() < 200 && !body.contains("torus"), "{path}: {status} {body}");
    }
    // By another name of the machine: what a page of the web would come with.
    for host in ["localhost", "evil.example", "127.0.0.1", "127.0.0.1:1", "[::1]", ""] {
        let (status, body) = viewer.asks("GET", &page, host);
        assert!(status != 200 && body.is_empty(), "{host}: {status} {body}");
    }
    let two = format!("GET {page} HTTP/1.1\r\nHost: {host}\r\nHost: evil.example\r\nConnection: close\r\n\r\n");
    assert_ne!(viewer.sends(&two).0, 200);
    assert_ne!(viewer.sends(&format!("GET {page} HTTP/1.1\r\nConnection: close\r\n\r\n")).0, 200);
    for method in ["PUT", "DELETE", "OPTIONS", "POST", "TRACE"] {
        assert_ne!(viewer.asks(method, &page, &host).0, 200, "{method}");
    }
    viewer.sends("nonsense\r\n\r\n");
    // All of that has not harmed it; a farewell with a wrong token does not end it, and the right one does.
    assert_eq!(viewer.asks("POST", &format!("/{wrong}/bye"), &host).0, 404);
    assert_eq!(viewer.asks("GET", &page, &host).0, 200);
    assert_eq!(viewer.asks("POST", &format!("/{token}/bye"), &host).0, 204);
    // Two tabs had the page, so that one is left.
    std::thread::sleep(Duration::from_secs(4));
    assert_eq!(viewer.process.try_wait().expect("it is ours"), None);
    assert_eq!(viewer.asks("POST", &format!("/{token}/bye"), &host).0, 204);
    let (status, _) = viewer.ends();
    assert_eq!(status, Some(0));
}

#[cfg(unix)]
#[test]
fn it_ends_within_a_second_of_ctrl_c() {
    let mut viewer = Viewer::of(&["testdata/open_cube.off"]);
    // Also while somebody is connected who says nothing, and somebody who does not read.
    let _silent = TcpStream::connect(("127.0.0.1", viewer.port)).expect("it listens");
    let mut deaf = TcpStream::connect(("127.0.0.1", viewer.port)).expect("it listens");
    let request = format!("GET /{}/ HTTP/1.1\r\nHost: {}\r\n\r\n", viewer.token, viewer.host());
    deaf.write_all(request.as_bytes()).expect("it reads");
    std::thread::sleep(Duration::from_millis(300));
    let killed = Command::new("kill").args(["-INT", &viewer.process.id().to_string()]).status().expect("kill is there");
    assert!(killed.success());
    let (status, took) = viewer.ends();
    assert_eq!(status, Some(130));
    assert!(took < Duration::from_secs(1), "{took:?}");
}

#[test]
fn the_viewer_as_a_file() {
    let folder = folder();
    run_in(&folder, "sdf testdata/torus.ply -o OUT/torus.nrrd --resolution 24 -q").exits(0);
    run_in(
        &folder,
        "repair testdata/broken_mug.obj -o OUT/mug.stl --map OUT/map.ply --resolution 32 --keep-partial -q",
    );
    run_in(&folder, "view testdata/torus.ply OUT/map.ply OUT/torus.nrrd -o OUT/view.html")
        .exits(0)
        .says(&["view.html"]);
    let page = std::fs::read_to_string(folder.path().join("view.html")).expect("a page");
    assert!(
        page.contains("id=\"slices\"") && page.contains("Colours of the file") && page.contains("made up: no surface")
    );
    assert!(!page.contains("sendBeacon") && !page.contains("connect-src"), "a file says farewell to nobody");
    run_in(&folder, "view testdata/torus.ply -o OUT/view.png").exits(2);
    run_in(&folder, "view OUT/none.stl -o OUT/none.html").exits(4);
}
