//! Many files at once: which jobs there are, where their outputs go, and how they end.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use meshwright::io::{Format, WriteOptions, encode};
use serde_json::Value;
use tempfile::TempDir;

use super::common::shapes::torus;
use super::{folder, names_in, program, run, run_in, sample};

/// The lines of a log.
#[track_caller]
pub fn log(path: &Path) -> Vec<Value> {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

/// The jobs of a log with their classes, in the order of their names.
pub fn classes(path: &Path) -> Vec<(String, String)> {
    let word = |entry: &Value, field: &str| entry[field].as_str().expect(field).to_owned();
    let mut classes: Vec<_> = log(path).iter().map(|entry| (word(entry, "job"), word(entry, "class"))).collect();
    classes.sort();
    classes
}

/// `(a.stl, done)` and so on.
pub fn pairs(list: &[(&str, &str)]) -> Vec<(String, String)> {
    list.iter().map(|&(job, class)| (job.to_owned(), class.to_owned())).collect()
}

/// Copies of a sample under other names, in `in/`, with their folders.
pub fn copies(folder: &TempDir, from: &str, names: &[&str]) {
    for name in names {
        let path = folder.path().join("in").join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::copy(sample(from), path).expect("copied");
    }
}

#[test]
fn outputs_keep_the_folders_of_their_inputs() {
    let folder = folder();
    copies(&folder, "open_cube.off", &["a.off", "sub/b.OFF", "sub/deep/c.off"]);
    copies(&folder, "torus.ply", &["sub/d.ply"]);
    fs::write(folder.path().join("in/readme.txt"), "no mesh").expect("written");
    run_in(&folder, "batch repair OUT/in --out OUT/out").exits(0).says(&["4 jobs: 4 done", "batch.jsonl"]);
    assert_eq!(names_in(&folder.path().join("out")), ["a.off", "batch.jsonl", "batch.reports", "sub"]);
    assert_eq!(names_in(&folder.path().join("out/sub")), ["b.OFF", "d.ply", "deep"]);
    // What a run alone makes, and what the log says of it.
    run_in(&folder, "repair OUT/in/sub/b.OFF -o OUT/alone.off --report OUT/alone.json").exits(0);
    let alone = fs::read(folder.path().join("alone.off")).expect("there");
    assert_eq!(fs::read(folder.path().join("out/sub/b.OFF")).expect("there"), alone);
    let report: Value =
        serde_json::from_slice(&fs::read(folder.path().join("alone.json")).expect("there")).expect("JSON");
    let entries = log(&folder.path().join("out/batch.jsonl"));
    let entry = entries.iter().find(|entry| entry["job"] == "sub/b.OFF").expect("logged");
    assert_eq!(entry["input_sha256"][0], report["inputs"][0]["sha256"]);
    assert_eq!(entry["output_sha256"], report["result"]["output"]["sha256"]);
    assert_eq!((&entry["class"], &entry["status"], &entry["verb"]), (&"done".into(), &0.into(), &"repair".into()));
    assert!(entry["seconds"].as_f64().is_some_and(|s| s > 0.0) && entry["peak_memory_bytes"].as_u64() > Some(1 << 20));
    let written: Value =
        serde_json::from_slice(&fs::read(entry["report"].as_str().expect("a path")).expect("there")).expect("JSON");
    assert_eq!(written["verb"], "repair");
}

#[test]
fn formats_patterns_and_other_verbs() {
    let folder = folder();
    copies(&folder, "open_cube.off", &["a.off", "sub/b.off"]);
    copies(&folder, "torus.ply", &["sub/d.ply"]);
    for (arguments, names) in [
        ("convert OUT/in/**/*.off --out-format ply", &["a.ply", "sub/b.ply"] as &[&str]),
        ("sdf OUT/in/sub/d.ply --resolution 16", &["d.vdb"]),
        ("dilate OUT/in/a.off --resolution 24 -r 0.1", &["a.off"]),
        ("decimate --ratio 50% OUT/in/sub/d.ply", &["d.ply"]),
        ("render OUT/in/a.off --width 64 --height 64", &["a.png"]),
        ("inspect OUT/in", &["a.off.json", "sub/b.off.json", "sub/d.ply.json"]),
        ("fix OUT/in/a.off -- --resolution 24", &["a.off"]),
    ] {
        let out = folder.path().join("out");
        run_in(&folder, &format!("batch {arguments} --out OUT/out")).exits(0);
        let made: Vec<String> = classes(&out.join("batch.jsonl")).into_iter().map(|(job, _)| job).collect();
        assert_eq!(made, names, "{arguments}");
        assert!(names.iter().all(|name| out.join(name).is_file()), "{arguments}");
        fs::remove_dir_all(out).expect("removed");
    }
}

#[test]
fn wrong_usage_is_told_before_the_first_job() {
    let folder = folder();
    copies(&folder, "open_cube.off", &["a.off", "a/x.off", "b/x.off"]);
    fs::create_dir(folder.path().join("none")).expect("made");
    for (arguments, words) in [
        ("batch repair OUT/in --out OUT/out --resolutoin 64", "'--resolutoin'"),
        ("batch repair OUT/in --out OUT/out --resolution 1", "--resolution"),
        ("batch repair OUT/in --out OUT/out -- --resolution 64 --voxel 1", "cannot be used with"),
        ("batch repair OUT/in --out OUT/out --method exact --rebuild", "--method exact cannot be used with --rebuild"),
        ("batch dilate OUT/in --out OUT/out", "--radius"),
        ("batch repair OUT/in --out OUT/out --map OUT/m.ply", "--map cannot be used in a batch"),
        ("batch repair OUT/in --out OUT/out -o OUT/x.off", "--output cannot be used in a batch"),
        ("batch repair OUT/in --out OUT/out --out-format vdb", "cannot write vdb"),
        ("batch repair OUT/in", "--out"),
        ("batch repair --out OUT/out", "no input is given"),
        ("batch --out OUT/out", "VERB"),
        ("batch mend OUT/in --out OUT/out", "`mend` is no verb"),
        ("batch split OUT/in --out OUT/out", "`split` cannot be run in a batch"),
        ("batch union OUT/in --out OUT/out", "--manifest"),
        ("batch repair OUT/nothing.off --out OUT/out", "cannot read"),
        ("batch repair OUT/none --out OUT/out", "there is no mesh in the folder"),
        ("batch repair OUT/in/*.stl --out OUT/out", "no file matches"),
        ("batch repair - --out OUT/out", "standard input"),
        ("batch repair OUT/in --out OUT/in/a.off", "is no folder"),
        ("batch repair OUT/in --out OUT/in", "is an input and would be overwritten"),
        ("batch repair OUT/in --out OUT/out --shard 3/2", "such as 1/4"),
        ("batch repair OUT/in --out OUT/out --shard slurm", "SLURM_ARRAY_TASK_ID is not set"),
        ("batch repair OUT/in/a/x.off OUT/in/b/x.off --out OUT/out", "in/b/x.off would both be written to"),
        ("batch render OUT/in/a OUT/in/b --out OUT/out", "in/a/x.off and "),
    ] {
        run_in(&folder, arguments).exits(2).says(&["error: ", words]);
        assert!(!folder.path().join("out").exists(), "{arguments}");
    }
}

#[test]
fn a_manifest_has_jobs_with_options_of_their_own() {
    let folder = folder();
    copies(&folder, "open_cube.off", &["a.off"]);
    let (cube, torus) = (folder.path().join("in/a.off"), sample("torus.ply"));
    let manifest = folder.path().join("jobs.jsonl");
    let lines = [
        serde_json::json!({"input": cube}),
        serde_json::json!({"input": cube, "output": "fine/a.ply", "options": ["--resolution", 32, "--rebuild"]}),
        serde_json::json!({"verb": "union", "inputs": [cube, torus], "output": "both.stl"}),
        serde_json::json!({"verb": "compare", "inputs": [cube, torus], "output": "difference.json", "options": ["--samples", "100"]}),
        serde_json::json!({"input": folder.path().join("nothing.stl")}),
    ];
    fs::write(&manifest, lines.map(|line| line.to_string()).join("\n\n")).expect("written");
    run_in(&folder, "batch repair --manifest OUT/jobs.jsonl --out OUT/out --resolution 24").exits(3);
    let path = folder.path().join("out/batch.jsonl");
    let expected = [
        ("a.off", "done"),
        ("both.stl", "done"),
        ("difference.json", "done"),
        ("fine/a.ply", "done"),
        ("nothing.stl", "input"),
    ];
    assert_eq!(classes(&path), pairs(&expected));
    let options =
        |job: &str| log(&path).into_iter().find(|entry| entry["job"] == job).expect("logged")["options"].clone();
    assert_eq!(options("a.off"), serde_json::json!(["--resolution", "24"]));
    assert_eq!(options("fine/a.ply"), serde_json::json!(["--resolution", "32", "--rebuild"]));
    assert_eq!(options("both.stl"), serde_json::json!([]));

    let lines = [
        serde_json::json!({"input": cube, "output": "thick.off", "options": ["-r", "0.2"]}),
        serde_json::json!({"input": cube, "output": "thin.off"}),
    ];
    fs::write(&manifest, lines.map(|line| line.to_string()).join("\n")).expect("written");
    run_in(&folder, "batch dilate --manifest OUT/jobs.jsonl --out OUT/grown --radius 0.1 --resolution 24").exits(0);
    run_in(&folder, "batch dilate --manifest OUT/jobs.jsonl --out OUT/none").exits(2).says(&["line 2", "--radius"]);
    run_in(&folder, "batch --manifest OUT/jobs.jsonl --out OUT/none --rebuild").exits(2).says(&["belongs to no verb"]);

    for (line, words) in [
        (r#"{"input": "a.stl", "colour": 1}"#, "unknown field `colour`"),
        (r#"{"input": "a.stl"}"#, "there is no verb"),
        (r#"{"verb": "repair", "input": "a.stl", "output": "../a.stl"}"#, "is not in the folder of the outputs"),
        (r#"{"verb": "repair", "input": "a.stl", "options": ["--wrong"]}"#, "'--wrong'"),
        (r#"{"verb": "repair", "input": "a.stl", "options": ["--timeout", "soon"]}"#, "is not a duration"),
        (r#"{"verb": "union", "inputs": ["a.stl"]}"#, "`union` cannot be given 1 input"),
    ] {
        fs::write(&manifest, format!("\n{line}\n")).expect("written");
        run_in(&folder, "batch --manifest OUT/jobs.jsonl --out OUT/none").exits(2).says(&["jobs.jsonl, line 2", words]);
        assert!(!folder.path().join("none").exists(), "{line}");
    }
}

#[test]
fn shards_do_every_job_once_in_logs_of_their_own() {
    let folder = folder();
    let names: Vec<String> = (0..12).map(|n| format!("{n}.off")).collect();
    copies(&folder, "open_cube.off", &names.iter().map(String::as_str).collect::<Vec<_>>());
    let mut done = BTreeSet::new();
    let mut add = |log: &str| {
        for (job, class) in classes(&folder.path().join("out").join(log)) {
            assert!(class == "done" && done.insert(job.clone()), "{job}: {class}");
        }
    };
    for shard in 1..=2 {
        run_in(&folder, &format!("batch convert OUT/in --out OUT/out --shard {shard}/3")).exits(0);
        add(&format!("batch.{shard}-of-3.jsonl"));
    }
    let at = |name: &str| folder.path().join(name).display().to_string();
    let mut slurm = program();
    slurm.args(["batch", "convert", &at("in"), "--out", &at("out"), "--shard", "slurm"]);
    let array = [("ID", "12"), ("MIN", "10"), ("MAX", "12"), ("COUNT", "3"), ("STEP", "1")];
    slurm.envs(array.map(|(name, value)| (format!("SLURM_ARRAY_TASK_{name}"), value)));
    super::Run::from(slurm.output().expect("it starts")).exits(0);
    add("batch.3-of-3.jsonl");
    assert_eq!(done, names.into_iter().collect());
}

#[test]
fn every_failure_has_its_class_and_the_others_are_done() {
    let folder = folder();
    copies(&folder, "open_cube.off", &["a.off", "b.off"]);
    fs::write(folder.path().join("in/garbage.stl"), "no mesh at all").expect("written");
    fs::write(folder.path().join("in/empty.obj"), "").expect("written");
    let large = fs::File::create(folder.path().join("in/large.ply")).expect("made");
    encode(&torus(700, 400), &WriteOptions::new(Format::Ply), &mut std::io::BufWriter::new(large)).expect("written");
    let lines = [
        // The plan says that it needs too much; the watch sees that it takes too much.
        serde_json::json!({"input": sample("torus.ply"), "output": "eater.ply", "options": ["--rebuild", "--max-memory", "70M", "--resolution", 900]}),
        serde_json::json!({"verb": "decimate", "input": folder.path().join("in/large.ply"), "output": "hog.ply", "options": ["--ratio", "50%", "--max-memory", "64M"]}),
        serde_json::json!({"input": sample("torus.ply"), "output": "usage.ply", "options": ["--voxel", "1mm"]}),
    ];
    fs::write(folder.path().join("jobs.jsonl"), lines.map(|line| line.to_string()).join("\n")).expect("written");
    let mut arguments = "batch repair OUT/in/a.off OUT/in/b.off OUT/in/garbage.stl OUT/in/empty.obj ".to_owned();
    if cfg!(unix) {
        let made = std::process::Command::new("mkfifo").arg(folder.path().join("in/pipe.stl")).status();
        assert!(made.expect("it starts").success());
        arguments += "OUT/in/pipe.stl ";
    }
    arguments += "--manifest OUT/jobs.jsonl --out OUT/out --timeout 6s";
    if cfg!(unix) {
        run_in(&folder, &arguments.replace("--timeout 6s", ""))
            .exits(2)
            .says(&["pipe.stl is no regular file", "--timeout"]);
    }
    // Of the pipe nothing ever comes.
    let said = run_in(&folder, &arguments).exits(3);
    said.says(&["2 done", "garbage.stl", "eater.ply", "hog.ply", "pipe.stl", "usage.ply"]);
    let expected = [
        ("a.off", "done"),
        ("b.off", "done"),
        ("eater.ply", "memory"),
        ("empty.obj", "input"),
        ("garbage.stl", "input"),
        ("hog.ply", "memory"),
        ("pipe.stl", "timeout"),
        ("usage.ply", "usage"),
    ];
    assert_eq!(classes(&folder.path().join("out/batch.jsonl")), pairs(&expected));
    let outputs = [".", "a.off", "b.off", "batch.jsonl", "batch.reports"];
    assert_eq!(names_in(&folder.path().join("out")), outputs[1..]);
    for entry in log(&folder.path().join("out/batch.jsonl")) {
        assert_eq!(entry["message"].is_string(), entry["class"] != "done", "{entry}");
        assert_eq!(entry["output_sha256"].is_string(), entry["class"] == "done", "{entry}");
        assert_eq!(entry["input_sha256"][0].is_string(), entry["job"] != "pipe.stl", "{entry}");
    }
}

#[test]
fn help_says_what_a_batch_is() {
    let help = run(&["batch", "repair", "--help"]).exits(0).text();
    for word in ["--out <DIR>", "--manifest", "--resume", "--shard", "130"] {
        assert!(help.contains(word), "`{word}` is missing in:\n{help}");
    }
}
