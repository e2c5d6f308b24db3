//! Runs that must stop: interrupted, out of time, out of memory. They leave nothing behind.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::{assert_empty, folder, program, run_in};

#[test]
fn a_deadline_that_has_passed_exits_with_6() {
    let folder = folder();
    for arguments in [
        "repair testdata/torus.ply -o OUT/a.stl --timeout 0s",
        "difference testdata/torus.ply testdata/noisy_cube.off -o OUT/a.stl --timeout 0",
        "inspect testdata/torus.ply --timeout 0s",
        "convert testdata/torus.ply -o OUT/a.obj --timeout 0s",
        "render testdata/torus.ply -o OUT/a.png --timeout 0s",
    ] {
        run_in(&folder, arguments).exits(6).says(&["error: ", "--timeout"]);
        assert_empty(&folder);
    }
}

#[test]
fn a_deadline_within_the_work_stops_it() {
    let folder = folder();
    let start = Instant::now();
    run_in(&folder, "repair testdata/broken_mug.obj -o OUT/a.stl --resolution 2048 --max-memory 200G --timeout 500ms")
        .exits(6);
    assert!(start.elapsed() < Duration::from_secs(3), "it took {:?}", start.elapsed());
    assert_empty(&folder);
}

#[test]
fn a_memory_cap_refuses_before_the_work() {
    let folder = folder();
    run_in(&folder, "repair testdata/torus.ply -o OUT/a.stl --max-memory 1M")
        .exits(5)
        .says(&["error: ", "--max-memory"]);
    run_in(&folder, "repair testdata/torus.ply -o OUT/a.stl --max-memory 50M --unit cm --rebuild")
        .exits(5)
        .says(&["hint: --voxel 0."]);
    run_in(&folder, "repair testdata/torus.ply --plan --max-memory 1M").exits(5);
    assert_empty(&folder);
}

/// Sends `signals` interrupts, 100 ms apart, to a long run and returns its exit status and how
/// long it took to stop.
#[cfg(unix)]
fn interrupt(folder: &tempfile::TempDir, signals: usize) -> (i32, String, Duration) {
    let out = folder.path().join("a.stl");
    let child = program()
        .args(["repair", "testdata/broken_mug.obj", "--resolution", "2048", "--max-memory", "200G", "-o"])
        .arg(&out)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(600));
    let start = Instant::now();
    for _ in 0..signals {
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        std::thread::sleep(Duration::from_millis(if signals > 1 { 100 } else { 0 }));
    }
    let output = child.wait_with_output().unwrap();
    let status = output.status.code().unwrap_or(-1);
    (status, String::from_utf8_lossy(&output.stderr).into_owned(), start.elapsed())
}

#[test]
#[cfg(unix)]
fn ctrl_c_stops_within_a_second_and_leaves_nothing() {
    for signals in [1, 2] {
        let folder = folder();
        let (status, said, took) = interrupt(&folder, signals);
        assert_eq!(status, 130, "{said}");
        assert!(said.contains("interrupted"), "{said}");
        // A second, and half a one for a busy machine.
        assert!(took < Duration::from_millis(1500), "it took {took:?}");
        assert_empty(&folder);
    }
}
