//! `devices`, and `--backend`.

use std::path::Path;

use super::{Run, folder, program, sample};
use crate::common::gpu::device;

fn run(arguments: &[&str]) -> Run {
    // Without it a layer of some drivers prints where there is no desktop.
    program().env("NODEVICE_SELECT", "1").args(arguments).output().expect("the program starts").into()
}

fn repaired(input: &Path, backend: &str, folder: &Path) -> (Vec<u8>, serde_json::Value) {
    let out = folder.join(format!("{backend}.stl"));
    let arguments = ["repair", input.to_str().expect("a plain path"), "-o", out.to_str().expect("a plain path")];
    let rest = ["--backend", backend, "--rebuild", "--resolution", "48", "--json"];
    let report = run(&[&arguments[..], &rest].concat()).exits(0).json();
    (std::fs::read(out).expect("an output"), report)
}

#[test]
fn the_repaired_file_is_the_same_by_either_processor() {
    if device().is_none() {
        return;
    }
    let folder = folder();
    for name in ["broken_mug.obj", "bored_block.off", "cracked_ball.stl"] {
        let input = sample(name);
        let (cpu, cpu_report) = repaired(&input, "cpu", folder.path());
        let (gpu, gpu_report) = repaired(&input, "gpu", folder.path());
        assert!(cpu == gpu, "{name} differs");
        let by = |report: &serde_json::Value| report["result"]["pipeline"]["ldi"]["made_by"].clone();
        assert_eq!(by(&cpu_report)["backend"], "cpu");
        assert_eq!(by(&gpu_report)["backend"], "gpu");
        assert_eq!(gpu_report["options"]["backend"], "gpu");
        assert!(by(&gpu_report)["bytes_down"].as_u64() > Some(10_000), "{gpu_report}");
        assert_eq!(by(&gpu_report)["adapter"].as_str().map(str::is_empty), Some(false));
    }
}

#[test]
fn the_field_of_a_graphics_adapter_is_the_exact_one() {
    if device().is_none() {
        return;
    }
    let folder = folder();
    let field = |backend: &str| {
        let out = folder.path().join(format!("{backend}.npy"));
        let input = sample("torus.ply");
        let [input, path] = [&input, &out].map(|path| path.to_str().expect("a plain path"));
        let arguments =
            ["sdf", input, "-o", path, "--resolution", "48", "--band", "3h", "--backend", backend, "--json"];
        let report = run(&arguments).exits(0).json();
        (std::fs::read(out).expect("an output"), report["result"]["distance"]["made_by"].clone(), report)
    };
    let ((cpu, by_cpu, _), (gpu, by_gpu, report)) = (field("cpu"), field("gpu"));
    assert_eq!((&by_cpu["backend"], &by_gpu["backend"]), (&"cpu".into(), &"gpu".into()));
    assert_eq!(field("auto").0, cpu, "auto is the main processor, on every machine");
    assert!(by_gpu["bytes_down"].as_u64() > Some(10_000) && by_gpu["doubtful"].is_u64(), "{by_gpu}");
    let voxel = report["result"]["distance"]["voxel"].as_f64().expect("a size");
    // The header of these files takes a multiple of 64 bytes, the same in both.
    assert_eq!(cpu.len(), gpu.len());
    let numbers = |bytes: &[u8]| -> Vec<f32> {
        let header = 10 + usize::from(bytes[8]) + 256 * usize::from(bytes[9]);
        bytes[header..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    };
    let apart = numbers(&cpu).iter().zip(numbers(&gpu)).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
    assert!(apart < 1e-4 * voxel, "{apart} of {voxel}");
    let out = folder.path().join("words.npy");
    let [input, out] = [sample("torus.ply"), out].map(|path| path.to_str().expect("a plain path").to_string());
    let words = run(&["sdf", &input, "-o", &out, "--resolution", "24", "--backend", "gpu"]).exits(0);
    words.says(&["measured by", "again by the main processor"]);
    let other = ["sdf", &input, "-o", &out, "--method", "prism", "--backend", "gpu", "--force"];
    run(&other).exits(2).says(&["--method exact only"]);
}

#[test]
fn small_jobs_stay_on_the_main_processor_by_default() {
    let folder = folder();
    let (_, report) = repaired(&sample("monkey_saddle.off"), "auto", folder.path());
    assert_eq!(report["result"]["pipeline"]["ldi"]["made_by"]["backend"], "cpu");
    assert_eq!(report["result"]["pipeline"]["ldi"]["made_by"]["fallback"], serde_json::Value::Null);
}

#[test]
fn devices_lists_the_adapters_in_words_and_as_json() {
    if device().is_none() {
        return;
    }
    let report = run(&["devices", "--json"]).exits(0).json();
    assert_eq!(report["verb"], "devices");
    let adapters = report["result"]["devices"]["adapters"].as_array().expect("a list");
    let taken = report["result"]["devices"]["gpu"].as_str().expect("an adapter is taken");
    assert!(adapters.iter().any(|adapter| adapter["name"] == taken && adapter["scatter"] == true));
    let words = run(&["devices"]).exits(0).text();
    for word in [taken, "--backend auto", "--backend gpu", "pixels a side"] {
        assert!(words.contains(word), "`{word}` is missing in:\n{words}");
    }
}

/// The loader of Vulkan drivers looks nowhere else than where these variables say.
fn without_drivers(arguments: &[&str]) -> Run {
    let mut command = program();
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(name, "/nonexistent.json");
    }
    command.env("NODEVICE_SELECT", "1").args(arguments).output().expect("the program starts").into()
}

#[test]
fn without_an_adapter_the_program_says_what_to_install() {
    let words = without_drivers(&["devices"]).exits(0).text();
    assert!(words.contains("no adapter found") && words.contains("mesa-vulkan-drivers"), "{words}");

    let folder = folder();
    let (input, out) = (sample("monkey_saddle.off"), folder.path().join("out.stl"));
    let [input, out] = [&input, &out].map(|path| path.to_str().expect("a plain path"));
    let arguments = ["repair", input, "-o", out, "--resolution", "16", "--rebuild"];
    let forced = without_drivers(&[&arguments[..], &["--backend", "gpu"]].concat());
    forced.exits(1).says(&["no graphics adapter", "mesa-vulkan-drivers"]);
    assert!(!Path::new(out).exists());
    without_drivers(&arguments).exits(0);
}
