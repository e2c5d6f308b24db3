//! `devices`: the graphics adapters of this machine.

#[cfg(not(feature = "gpu"))]
use super::entries::DeviceReport;
use super::exit::{Exit, Failure};
use super::report::RunReport;
use super::result::RunResult;
use super::shared_args::CommonArgs;
use crate::progress::Stage;
use clap::Args;

/// `devices`.
#[derive(Debug, Args)]
pub struct DevicesArgs {
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Lists the adapters.
pub fn run(args: &DevicesArgs, report: &mut RunReport) -> Result<Exit, Failure> {
    report.options = serde_json::json!({});
    let found = report.timed(Stage::List, |_| find());
    if !args.common.json {
        super::streams::write_stream(text(&found).as_bytes())?;
    }
    report.result = Some(RunResult::Devices { devices: found });
    Ok(Exit::Done)
}

#[cfg(not(feature = "gpu"))]
fn find() -> DeviceReport {
    DeviceReport { why: "this program was built without the feature `gpu`".into(), ..DeviceReport::default() }
}

#[cfg(not(feature = "gpu"))]
fn text(found: &DeviceReport) -> String {
    format!("no adapter: {}\n", found.why)
}

#[cfg(feature = "gpu")]
pub use with_gpu::*;

#[cfg(feature = "gpu")]
mod with_gpu {
    use crate::cli::entries::DeviceReport;
    use crate::cli::table::{self, Row};
    use crate::cli::words;
    use crate::gpu::{AdapterEntry, AdapterKind, INSTALL, Wanted, adapters};

    pub fn find() -> DeviceReport {
        let adapters = adapters();
        let name = |wanted: &Wanted| wanted.choose(&adapters).map(|n| adapters[n].name.clone());
        let (auto, gpu) = (name(&Wanted::Hardware), name(&Wanted::Any));
        let why = match (&auto, &gpu) {
            (Some(name), _) => {
                format!("{name} is a graphics processor: large jobs go to it, small ones are done sooner here")
            }
            (None, Some(name)) => format!("{name} is not known to be faster than the main processor"),
            (None, None) if adapters.is_empty() => format!("no adapter found; {INSTALL}"),
            (None, None) => "none of the adapters can find the crossings of rays".into(),
        };
        DeviceReport { built: true, adapters, auto, gpu, why }
    }

    pub fn text(found: &DeviceReport) -> String {
        if found.adapters.is_empty() {
            return format!("{}\n", found.why);
        }
        let mut text = String::new();
        for adapter in &found.adapters {
            text.push_str(&table::table(&rows(adapter)));
            text.push('\n');
        }
        let or_cpu = |name: &Option<String>| name.clone().unwrap_or_else(|| "the main processor".into());
        let choices = [
            ("--backend auto", format!("{}: {}", or_cpu(&found.auto), found.why)),
            ("--backend gpu", found.gpu.clone().unwrap_or_else(|| "none".into())),
        ];
        text.push_str(&table::table(&choices));
        text
    }

    fn rows(adapter: &AdapterEntry) -> Vec<Row> {
        let kind = match adapter.kind {
            AdapterKind::Discrete => "discrete graphics processor",
            AdapterKind::Integrated => "integrated graphics processor",
            AdapterKind::Virtual => "virtual graphics processor",
            AdapterKind::Software => "software, on the main processor",
            AdapterKind::Other => "unknown",
        };
        let can: Vec<String> = [
            (adapter.scatter, "find all crossings of the rays at once"),
            (adapter.peel, "find them layer by layer"),
            (adapter.timestamps, "measure its own time"),
        ]
        .iter()
        .filter(|(can, _)| *can)
        .map(|(_, what)| what.to_string())
        .collect();
        vec![
            ("adapter", adapter.name.clone()),
            ("kind", kind.into()),
            ("driver", format!("{}, {}", adapter.interface, adapter.driver)),
            (
                "limits",
                format!(
                    "textures of {} pixels a side, {} reachable at once, buffers of {}",
                    words::count(adapter.texture_side as usize),
                    words::bytes(adapter.binding_bytes),
                    words::bytes(adapter.buffer_bytes)
                ),
            ),
            ("can", if can.is_empty() { "nothing that is needed".into() } else { words::list(&can) }),
        ]
    }
}
