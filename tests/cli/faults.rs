//! Faults of the world: full disks, readers that stop reading, links that lead nowhere, names of one file, too little memory.
//! Each has its own status and sentence, and leaves nothing. `tools/faults.py` tries more of them.

use std::fs;
#[cfg(unix)]
use std::os::unix::fs::symlink;
#[cfg(unix)]
use std::process::{Command, Stdio};
#[cfg(unix)]
use std::time::{Duration, Instant};

use tempfile::TempDir;

#[cfg(unix)]
use super::{Run, program};
use super::{assert_empty, folder, names_in, run_in, sample};

/// A folder with a mesh in it.
fn with_input() -> TempDir {
    let folder = folder();
    fs::copy(sample("open_cube.off"), folder.path().join("in.off")).unwrap();
    folder
}

#[test]
fn outputs_are_compared_as_files_and_not_as_words() {
    let folder = with_input();
    fs::create_dir(folder.path().join("sub")).unwrap();
    for (arguments, words) in [
        ("repair OUT/in.off -o OUT/a.ply --map OUT/./a.ply", "--map"),
        ("repair OUT/in.off -o OUT/a.ply --report OUT/sub/../a.ply", "--report"),
        ("repair OUT/in.off -o OUT/a.stl --map OUT/m.ply --report OUT/./m.ply", "are the same file"),
        ("compare OUT/in.off OUT/in.off --map OUT/m.ply --report OUT/./m.ply", "are the same file"),
        ("repair OUT/in.off -o OUT/sub/../in.off", "is an input"),
        ("render OUT/in.off -o OUT/a.png --report OUT/./a.png", "are the same file"),
        (
            "field morph(a,b,t) a=OUT/in.off b=OUT/in.off --frames 3 -o OUT/f.ply --report OUT/f_1.ply",
            "are the same file",
        ),
        ("repair OUT/in.off -o OUT/a.stl --report OUT/./in.off", "is an input"),
        ("repair OUT/in.off -o OUT/a.stl --map OUT/sub", "is a folder"),
    ] {
        run_in(&folder, arguments).exits(2).says(&[words]);
    }
    assert_eq!(names_in(folder.path()), ["in.off", "sub"]);
    // An earlier output is no input: it is replaced.
    for _ in 0..2 {
        run_in(&folder, "repair OUT/in.off -o OUT/a.stl --map OUT/m.ply --report OUT/r.json --resolution 16").exits(0);
    }
    assert_eq!(names_in(folder.path()), ["a.stl", "in.off", "m.ply", "r.json", "sub"]);
}

#[test]
#[cfg(unix)]
fn links_are_followed_and_those_to_nothing_are_refused() {
    let folder = with_input();
    let at = |name: &str| folder.path().join(name);
    fs::hard_link(at("in.off"), at("second.off")).unwrap();
    symlink("in.off", at("link.off")).unwrap();
    symlink("absent.off", at("nowhere.off")).unwrap();
    symlink("ring.off", at("ring.off")).unwrap();
    let before = names_in(folder.path());
    for name in ["second.off", "link.off"] {
        run_in(&folder, &format!("repair OUT/in.off -o OUT/{name}")).exits(2).says(&["is an input"]);
    }
    for (name, words) in
        [("nowhere.off", "a link that leads nowhere"), ("ring.off", "a link that leads back to itself")]
    {
        run_in(&folder, &format!("repair OUT/in.off -o OUT/{name}")).exits(2).says(&[words]);
        run_in(&folder, &format!("repair OUT/in.off -o OUT/a.stl --map OUT/{name} --plan")).exits(2);
        run_in(&folder, &format!("repair OUT/{name} -o OUT/a.stl")).exits(4).says(&[words]);
    }
    assert_eq!(names_in(folder.path()), before);
}

#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_written_has_its_own_status_and_nothing_of_the_run_is_left() {
    let folder = folder();
    for arguments in [
        "repair testdata/torus.ply -o /dev/full --out-format stl --resolution 24",
        "repair testdata/torus.ply -o OUT/a.stl --map OUT/m.ply --report /dev/full --resolution 24",
        "repair testdata/torus.ply -o OUT/a.stl --map /dev/full --resolution 24",
        "sdf testdata/torus.ply -o /dev/full --out-format nrrd --resolution 24",
        "convert testdata/torus.ply -o /dev/full --out-format obj",
        "render testdata/torus.ply -o /dev/full",
    ] {
        let said = run_in(&folder, arguments).exits(7).says(&["error: cannot write /dev/full: No space left"]).stderr;
        assert!(!said.contains("os error"), "{said}");
        assert_empty(&folder);
    }
    for arguments in [
        "repair testdata/torus.ply -o /sys/a.stl",
        "repair testdata/torus.ply -o OUT/a.stl --report /sys/r.json",
        "repair testdata/torus.ply -o OUT/a.stl --map /sys/m.ply",
    ] {
        run_in(&folder, arguments).exits(7).says(&["error: cannot write into /sys: "]);
        assert_empty(&folder);
    }
}

/// Runs the program in a shell that has set a limit.
#[cfg(unix)]
fn limited(folder: &TempDir, limit: &str, arguments: &str) -> Run {
    let arguments = arguments.replace("OUT", folder.path().to_str().unwrap());
    let script = format!("{limit}; exec {} {arguments}", env!("CARGO_BIN_EXE_meshwright"));
    let mut shell = Command::new("sh");
    shell.args(["-c", &script]).current_dir(env!("CARGO_MANIFEST_DIR")).stdin(Stdio::null());
    shell.output().expect("there is a shell").into()
}

#[test]
#[cfg(target_os = "linux")]
fn a_file_that_grows_beyond_its_limit_is_no_file() {
    let folder = folder();
    fs::write(folder.path().join("a.stl"), "before").unwrap();
    limited(&folder, "ulimit -f 8", "convert testdata/torus.ply -o OUT/a.stl --report OUT/r.json").exits(7).says(&[
        "cannot write",
        "a.stl: File too large",
        "hint: ",
    ]);
    assert_eq!(names_in(folder.path()), ["a.stl", "r.json"]);
    assert_eq!(fs::read_to_string(folder.path().join("a.stl")).unwrap(), "before");
    let report = fs::read_to_string(folder.path().join("r.json")).unwrap();
    assert!(report.contains("\"exit\": 7"), "{report}");
}

#[test]
#[cfg(target_os = "linux")]
fn too_little_memory_is_told_before_the_work() {
    let folder = folder();
    let said =
        limited(&folder, "ulimit -v 700000", "repair testdata/broken_mug.obj -o OUT/a.stl --resolution 2000").exits(5);
    said.says(&["error: about", "can be had", "--max-memory SIZE", "hint: --voxel"]);
    assert_empty(&folder);
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_told() {
    for arguments in [
        &["convert", "testdata/torus.ply", "-o", "-", "--out-format", "stl"][..],
        &["inspect", "testdata/torus.ply"],
        &["sdf", "testdata/torus.ply", "-o", "-", "--out-format", "npy", "--resolution", "24"],
    ] {
        let mut child = program().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let run: Run = child.wait_with_output().unwrap().into();
        run.exits(7).says(&["error: cannot write to standard output: whoever read it has stopped reading"]);
    }
}

#[test]
#[cfg(unix)]
fn a_reader_that_does_not_read_holds_nothing_up() {
    // More than a pipe holds.
    let streams = [
        &["convert", "testdata/torus.ply", "-o", "-", "--out-format", "stl"][..],
        &["sdf", "testdata/torus.ply", "-o", "-", "--out-format", "nrrd", "--resolution", "64"],
    ];
    for arguments in streams {
        for (signal, status) in [(None, 6), (Some("-TERM"), 130), (Some("-INT"), 130)] {
            let mut command = program();
            command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
            if signal.is_none() {
                command.args(["--timeout", "1s"]);
            }
            let mut child = command.spawn().unwrap();
            let unread = child.stdout.take();
            std::thread::sleep(Duration::from_millis(1000));
            if let Some(signal) = signal {
                assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
            }
            let start = Instant::now();
            let run: Run = child.wait_with_output().unwrap().into();
            assert!(start.elapsed() < Duration::from_millis(2500), "it took {:?}", start.elapsed());
            let run = run.exits(status);
            assert!(run.stderr.contains("no output was written"), "{}", run.stderr);
            drop(unread);
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn what_a_killed_run_leaves_the_next_one_clears() {
    let folder = folder();
    let out = folder.path().join("a.stl");
    let mut left = Vec::new();
    // Killed while it verifies: the fit of a large result takes a while to be looked at.
    for _ in 0..40 {
        let mut child = program()
            .args(["convert", "testdata/broken_mug.obj", "-q", "-o"])
            .arg(&out)
            .args(["--report"])
            .arg(folder.path().join("r.json"))
            .spawn()
            .unwrap();
        while child.try_wait().unwrap().is_none() && names_in(folder.path()).iter().all(|name| !name.starts_with('.')) {
        }
        child.kill().unwrap();
        child.wait().unwrap();
        left = names_in(folder.path()).into_iter().filter(|name| name.starts_with('.')).collect();
        if !left.is_empty() {
            break;
        }
    }
    assert!(!left.is_empty(), "no run was killed in time");
    assert!(left.iter().all(|name| name.contains(".meshwright-") && name.ends_with(".tmp")), "{left:?}");
    run_in(&folder, "convert testdata/broken_mug.obj -o OUT/a.stl --report OUT/r.json").exits(0);
    assert_eq!(names_in(folder.path()), ["a.stl", "r.json"]);
}
