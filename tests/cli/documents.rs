//! The commands of the documents, run as they stand there, with meshes of our own in the place of the files that they name.

use std::path::Path;

use glam::DVec3;
use meshwright::io::{self, Format, WriteOptions};
use meshwright::mesh::TriMesh;

use super::common::shapes::{cuboid, torus};
use super::{Run, folder, program, sample};

/// The lines that a user would type, without what stands before the program's name, and what the document shows after them.
fn commands(text: &str) -> Vec<(String, Vec<String>)> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    let mut shown = false;
    for line in text.lines() {
        let begins = ["meshwright ", "$ meshwright ", "cargo run --release -- "];
        let typed = begins.iter().find_map(|begin| line.strip_prefix(begin)).filter(|typed| !typed.starts_with("VERB"));
        match typed {
            Some(typed) => {
                let typed = typed.split("  #").next().unwrap_or(typed).trim();
                shown = line.starts_with('$');
                found.push((typed.to_owned(), Vec::new()));
            }
            None if line.starts_with("```") || line.is_empty() => shown = false,
            None if shown => found.last_mut().into_iter().for_each(|last| last.1.push(line.trim().to_owned())),
            None => {}
        }
    }
    found
}

/// The words of a line, quotes taken off.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().into_iter().for_each(|word| word.push(c)),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// What stands in for a file that a document names.
fn stand_in(name: &str) -> TriMesh {
    match name {
        "dense.ply" => torus(48, 24),
        "terrain.obj" => sheet(),
        "statue.stl" => cuboid(DVec3::new(-20.0, -20.0, -50.0), DVec3::new(20.0, 20.0, 50.0)),
        "rib.obj" => cuboid(DVec3::new(0.0, -2.0, -2.0), DVec3::new(30.0, 2.0, 2.0)),
        "bore.ply" => cuboid(DVec3::new(-4.0, -4.0, -60.0), DVec3::new(4.0, 4.0, 60.0)),
        _ => cuboid(DVec3::splat(-15.0), DVec3::splat(15.0)),
    }
}

/// A height map.
fn sheet() -> TriMesh {
    let at = |n: u32| DVec3::new(f64::from(n % 9), f64::from(n / 9), 0.25 * f64::from(n % 5));
    let corners = (0..72).filter(|n| n % 9 != 8);
    let triangles = corners.flat_map(|n| [[n, n + 1, n + 10], [n, n + 10, n + 9]]).collect();
    TriMesh { positions: (0..81).map(at).collect(), triangles }
}

/// Makes the inputs that are not there; what comes after `-o` is an output.
fn make_inputs(folder: &Path, words: &[String]) {
    for (n, word) in words.iter().enumerate().skip(1) {
        let name = word.split_once('=').map_or(word.as_str(), |(_, name)| name);
        let path = folder.join(name);
        let Some(format) = Format::from_path(Path::new(name)) else { continue };
        if words[n - 1] == "-o" || path.exists() {
            continue;
        }
        match name.strip_prefix("testdata/") {
            Some(sample_name) => {
                std::fs::create_dir_all(folder.join("testdata")).expect("a folder");
                std::fs::copy(sample(sample_name), &path).expect("copied");
            }
            None => {
                let file = std::fs::File::create(&path).expect("a file");
                let mut file = std::io::BufWriter::new(file);
                io::encode(&stand_in(name), &WriteOptions::new(format), &mut file).expect("written");
            }
        }
    }
}

#[test]
fn the_documents_commands_work_and_show_what_they_say() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scratch = folder();
    let mut count = 0;
    for page in ["README.md", "docs/cli.md", "docs/field.md", "docs/formats.md"] {
        let text = std::fs::read_to_string(root.join(page)).expect(page);
        for (line, shown) in commands(&text) {
            let mut words = words(&line);
            make_inputs(scratch.path(), &words);
            let coarser = matches!(words[0].as_str(), "repair" | "hollow" | "field" | "sdf");
            if coarser && !line.contains("--resolution") && !line.contains("--voxel") {
                words.extend(["--resolution".into(), "64".into()]);
            }
            let run: Run = program().current_dir(scratch.path()).args(&words).output().expect("it starts").into();
            assert_eq!(run.status, 0, "{page}: {line}\n{}", run.stderr);
            let told = run.text();
            for row in shown {
                let same = |other: &str| other.split_whitespace().eq(row.split_whitespace());
                assert!(told.lines().any(same), "{page}: {line}\nshows {row}\nnot in\n{told}");
            }
            count += 1;
        }
    }
    assert!(count >= 7, "{count} commands");
}

/// The verbs that `--help` lists.
fn verbs() -> Vec<String> {
    let help = super::run(&["--help"]).exits(0).text();
    let listed = help.split_once("Commands:\n").map_or("", |(_, after)| after);
    let lines = listed.lines().take_while(|line| !line.is_empty());
    // Lines that go on are indented further.
    let named = lines.filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
    named.filter_map(|line| line.split(' ').next()).filter(|verb| *verb != "help").map(str::to_owned).collect()
}

#[test]
fn the_examples_of_every_help_work() {
    let scratch = folder();
    let at = |name: &str| scratch.path().join(name);
    let mut work = |line: &str| {
        let mut words = words(line.split(" > ").next().unwrap_or_default());
        make_inputs(scratch.path(), &words);
        // Batches into one folder are refused, but for those that go on.
        if words[0] == "batch" && !line.contains("--resume") {
            let _none_yet = std::fs::remove_dir_all(at("repaired"));
        }
        let coarser = !matches!(words[0].as_str(), "decimate" | "split" | "compare" | "convert" | "inspect" | "view");
        let makes = coarser && words.iter().any(|word| word == "-o") && words[0] != "render" && words[0] != "report";
        if makes && !line.contains("--resolution") && !line.contains("--voxel") {
            words.extend(["--resolution".into(), "64".into()]);
        }
        let run: Run = program().current_dir(scratch.path()).args(&words).output().expect("it starts").into();
        assert_eq!(run.status, 0, "{line}\n{}", run.stderr);
    };
    // What some of them begin with.
    std::fs::create_dir(at("scans")).expect("a folder");
    work("convert one.stl -o scans/one.stl");
    work("convert two.stl -o scans/two.stl");
    work("repair part.stl -o part_repaired.stl --report run.json");
    let job = r#"{"verb": "convert", "input": "scans/one.stl", "output": "one.ply"}"#;
    std::fs::write(at("jobs.jsonl"), job).expect("written");
    let verbs = verbs();
    assert!(verbs.len() > 20, "{verbs:?}");
    for verb in verbs {
        let help = super::run(&[&verb, "--help"]).exits(0).text();
        let examples = help.split_once("\nExamples:\n").map_or("", |(_, after)| after);
        let lines = examples.lines().filter_map(|line| line.strip_prefix("  meshwright "));
        // A page that is served ends when somebody ends it.
        let mut lines = lines.filter(|line| !line.starts_with("view") || line.contains(" -o ")).peekable();
        assert!(lines.peek().is_some(), "{verb}");
        lines.for_each(&mut work);
    }
}
