//! The program: `devices`, and `--backend`.

use std::path::Path;
use std::process::{Command, Output};

use crate::common::data_folder;

fn program(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshwright"));
    // Without it a layer of some drivers prints where there is no desktop.
    command.env("NODEVICE_SELECT", "1").args(arguments).output().expect("the program starts")
}

#[track_caller]
fn json(output: &Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn repaired(input: &Path, backend: &str, folder: &Path) -> (Vec<u8>, serde_json::Value) {
    let out = folder.join(format!("{backend}.stl"));
    let arguments = ["repair", input.to_str().expect("a plain path"), "-o", out.to_str().expect("a plain path")];
    let rest = ["--backend", backend, "--rebuild", "--resolution", "48", "--json"];
    let report = json(&program(&[&arguments[..], &rest].concat()));
    (std::fs::read(out).expect("an output"), report)
}

#[test]
fn the_repaired_file_is_the_same_by_either_processor() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["clean/fandisk.off", "broken/wallhole.obj", "broken/octagonal_pocket.stl"] {
        let input = data_folder().join(name);
        let (cpu, cpu_report) = repaired(&input, "cpu", folder.path());
        let (gpu, gpu_report) = repaired(&input, "gpu", folder.path());
        assert!(cpu == gpu, "{name} differs");
        let by = |report: &serde_json::Value| report["pipeline"]["ldi"]["made_by"].clone();
        assert_eq!(by(&cpu_report)["backend"], "cpu");
        assert_eq!(by(&gpu_report)["backend"], "gpu");
        assert_eq!(gpu_report["options"]["backend"], "gpu");
        assert!(by(&gpu_report)["bytes_down"].as_u64() > Some(10_000), "{gpu_report}");
        assert_eq!(by(&gpu_report)["adapter"].as_str().map(str::is_empty), Some(false));
    }
}

#[test]
fn small_jobs_stay_on_the_main_processor_by_default() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, report) = repaired(&data_folder().join("clean/fandisk.off"), "auto", folder.path());
    assert_eq!(report["pipeline"]["ldi"]["made_by"]["backend"], "cpu");
    assert_eq!(report["pipeline"]["ldi"]["made_by"]["fallback"], serde_json::Value::Null);
}

#[test]
fn devices_lists_the_adapters_in_words_and_as_json() {
    let report = json(&program(&["devices", "--json"]));
    assert_eq!(report["verb"], "devices");
    let adapters = report["devices"]["adapters"].as_array().expect("a list");
    let taken = report["devices"]["gpu"].as_str().expect("an adapter is taken");
    assert!(adapters.iter().any(|adapter| adapter["name"] == taken && adapter["scatter"] == true));
    let words = program(&["devices"]);
    assert_eq!(words.status.code(), Some(0));
    let words = String::from_utf8_lossy(&words.stdout).into_owned();
    for word in [taken, "--backend auto", "--backend gpu", "pixels a side"] {
        assert!(words.contains(word), "`{word}` is missing in:\n{words}");
    }
}

/// The loader of Vulkan drivers looks nowhere else than where these variables say.
fn without_drivers(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshwright"));
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(name, "/nonexistent.json");
    }
    command.env("NODEVICE_SELECT", "1").args(arguments).output().expect("the program starts")
}

#[test]
fn without_an_adapter_the_program_says_what_to_install() {
    let devices = without_drivers(&["devices"]);
    assert_eq!(devices.status.code(), Some(0));
    let words = String::from_utf8_lossy(&devices.stdout).into_owned();
    assert!(words.contains("no adapter found") && words.contains("mesa-vulkan-drivers"), "{words}");

    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.stl");
    let input = data_folder().join("clean/fandisk.off");
    let arguments = [
        "repair",
        input.to_str().expect("plain"),
        "-o",
        out.to_str().expect("plain"),
        "--resolution",
        "16",
        "--rebuild",
    ];
    let forced = without_drivers(&[&arguments[..], &["--backend", "gpu"]].concat());
    let words = String::from_utf8_lossy(&forced.stderr).into_owned();
    assert_eq!(forced.status.code(), Some(1), "{words}");
    assert!(words.contains("no graphics adapter") && words.contains("mesa-vulkan-drivers"), "{words}");
    assert!(!out.exists());
    assert_eq!(without_drivers(&arguments).status.code(), Some(0));
}
