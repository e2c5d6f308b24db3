//! Batches that are stopped, and that go on.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::batch::{classes, copies, log, pairs};
use super::{Run, folder, names_in, program, run_in, sample};

/// Options that make a repair of a small mesh take a moment.
const SLOW: &str = "--rebuild --resolution 72";

/// Options that make it take far longer than any test; should nobody end it, it ends.
const ENDLESS: [&str; 6] = ["--resolution", "2048", "--max-memory", "200G", "--timeout", "120s"];

fn spawn(folder: &TempDir, arguments: &str) -> Child {
    let folder = folder.path().to_str().expect("a plain name");
    let arguments = arguments.split_whitespace().map(|word| word.replace("OUT", folder));
    program().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
}

fn finished(child: Child) -> Run {
    child.wait_with_output().expect("it ends").into()
}

fn send(signal: &str, process: u32) {
    let sent = Command::new("kill").args([signal, &process.to_string()]).status().expect("it starts");
    assert!(sent.success());
}

/// The processes whose arguments begin with a verb and name a file below `folder`; batches are not among them.
fn jobs_of(folder: &Path, word: &str) -> Vec<u32> {
    let folder = folder.to_str().expect("a plain name");
    let processes = fs::read_dir("/proc").expect("there").flatten();
    let numbers = processes.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    let is_job = |process: &u32| {
        let words = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        let words: Vec<String> = words.split(|&byte| byte == 0).map(|w| String::from_utf8_lossy(w).into()).collect();
        words.get(1).is_some_and(|verb| verb == "repair")
            && words.iter().any(|other| other.starts_with(folder) && other.contains(word))
    };
    numbers.filter(is_job).collect()
}

#[track_caller]
fn wait_until(what: &str, mut is: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is() {
        assert!(start.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn lines(path: &Path) -> usize {
    fs::read_to_string(path).map_or(0, |text| text.lines().count())
}

fn many(folder: &TempDir) -> Vec<String> {
    let names: Vec<String> = (0..10).map(|n| format!("sub/{n}.off")).collect();
    copies(folder, "open_cube.off", &names.iter().map(String::as_str).collect::<Vec<_>>());
    names
}

#[test]
fn a_killed_batch_goes_on_and_does_nothing_twice() {
    let folder = folder();
    let names = many(&folder);
    let path = folder.path().join("out/batch.jsonl");
    let arguments = format!("batch repair OUT/in --out OUT/out --threads 2 {SLOW}");
    let mut batch = spawn(&folder, &arguments);
    wait_until("no job ends", || lines(&path) >= 3);
    batch.kill().expect("it runs");
    batch.wait().expect("it ends");
    // Nobody waits for them any more, and they notice.
    wait_until("jobs outlive their batch", || jobs_of(folder.path(), "off").is_empty());
    let before = log(&path);
    assert!(before.len() < names.len());
    let times = |jobs: &[serde_json::Value]| -> BTreeMap<PathBuf, std::time::SystemTime> {
        let outputs = jobs.iter().map(|entry| PathBuf::from(entry["output"].as_str().expect("a path")));
        outputs
            .map(|path| (path.clone(), fs::metadata(path).and_then(|data| data.modified()).expect("there")))
            .collect()
    };
    let done = times(&before);
    // As if it had been killed while it wrote a line.
    let mut text = fs::read_to_string(&path).expect("there");
    text.push_str("{\"job\": \"sub/");
    fs::write(&path, text).expect("written");

    run_in(&folder, &arguments).exits(2).says(&["log of an earlier batch", "--resume"]);
    run_in(&folder, &format!("{arguments} --resume")).exits(0).says(&["10 jobs: 10 done", "by an earlier batch"]);
    let after = log(&path);
    assert_eq!(after[..before.len()], before);
    assert_eq!(classes(&path), names.iter().map(|name| (name.clone(), "done".into())).collect::<Vec<_>>());
    assert_eq!(times(&before), done, "a job was done twice");
    run_in(&folder, &format!("repair testdata/open_cube.off -o OUT/alone.off {SLOW}")).exits(0);
    let alone = fs::read(folder.path().join("alone.off")).expect("there");
    for name in &names {
        assert_eq!(fs::read(folder.path().join("out").join(name)).expect("there"), alone, "{name}");
    }
    assert_eq!(names_in(&folder.path().join("out/sub")).len(), names.len(), "something was left behind");

    // Another input, other options, an output that is gone: these jobs alone are done again.
    let again = |arguments: &str, count: usize| {
        let before = lines(&path);
        run_in(&folder, arguments).exits(0);
        assert_eq!(lines(&path) - before, count);
    };
    let resumed = format!("{arguments} --resume");
    again(&resumed, 0);
    fs::copy(sample("noisy_cube.off"), folder.path().join("in/sub/3.off")).expect("copied");
    again(&resumed, 1);
    fs::remove_file(folder.path().join("out/sub/4.off")).expect("removed");
    fs::write(folder.path().join("out/sub/5.off"), "changed").expect("written");
    again(&resumed, 2);
    again(&resumed.replace("72", "24"), names.len());
}

#[test]
fn a_job_that_somebody_kills_takes_no_other_with_it() {
    let folder = folder();
    copies(&folder, "open_cube.off", &["a.off", "b.off"]);
    let line = serde_json::json!({"input": sample("broken_mug.obj"), "output": "victim.obj", "options": ENDLESS});
    fs::write(folder.path().join("jobs.jsonl"), line.to_string()).expect("written");
    let batch = spawn(&folder, "batch repair OUT/in --manifest OUT/jobs.jsonl --out OUT/out --threads 2");
    wait_until("the job does not begin", || !jobs_of(folder.path(), "victim.obj").is_empty());
    std::thread::sleep(Duration::from_millis(200));
    jobs_of(folder.path(), "victim.obj").into_iter().for_each(|process| send("-KILL", process));
    finished(batch).exits(3).says(&["killed      victim.obj: signal 9"]);
    let path = folder.path().join("out/batch.jsonl");
    assert_eq!(classes(&path), pairs(&[("a.off", "done"), ("b.off", "done"), ("victim.obj", "killed")]));
    let entries = log(&path);
    let victim = entries.iter().find(|entry| entry["class"] == "killed").expect("logged");
    assert_eq!((&victim["signal"], &victim["status"]), (&9.into(), &serde_json::Value::Null));
}

#[test]
fn an_interrupted_batch_stops_its_jobs_and_has_a_whole_log() {
    let folder = folder();
    let names = many(&folder);
    let line = serde_json::json!({"input": sample("broken_mug.obj"), "output": "sub/long.obj", "options": ENDLESS});
    fs::write(folder.path().join("jobs.jsonl"), line.to_string()).expect("written");
    let path = folder.path().join("out/batch.jsonl");
    let arguments = format!("batch repair OUT/in --manifest OUT/jobs.jsonl --out OUT/out --threads 2 {SLOW}");
    let batch = spawn(&folder, &arguments);
    wait_until("nothing ends", || lines(&path) >= 2);
    let start = Instant::now();
    send("-INT", batch.id());
    finished(batch).exits(130).says(&["interrupted sub/long.obj"]);
    assert!(start.elapsed() < Duration::from_secs(4), "it took {:?}", start.elapsed());
    assert!(jobs_of(folder.path(), "obj").is_empty());
    let ended = classes(&path);
    let done: Vec<_> = ended.iter().filter(|(_, class)| class == "done").map(|(job, _)| job.clone()).collect();
    assert!(ended.contains(&("sub/long.obj".into(), "interrupted".into())), "{ended:?}");
    assert!(!done.is_empty() && done.len() <= names.len());
    let outputs: Vec<String> =
        names_in(&folder.path().join("out/sub")).into_iter().map(|name| format!("sub/{name}")).collect();
    assert_eq!(outputs, done);
}
