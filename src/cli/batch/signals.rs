//! What is done to other processes: signals, and a limit to their memory.

use std::process::{Child, Command};

/// Gives the process that will start a group of its own, so that Ctrl-C reaches it through the batch alone.
#[cfg(unix)]
pub fn set_apart(command: &mut Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
pub fn set_apart(_: &mut Command) {}

/// Asks a process that has not been waited for to stop.
#[cfg(unix)]
pub fn interrupt(child: &mut Child) {
    send(child, rustix::process::Signal::INT);
}

#[cfg(not(unix))]
pub fn interrupt(child: &mut Child) {
    kill(child);
}

/// Ends a process that has not been waited for, and those that it has started.
pub fn kill(child: &mut Child) {
    #[cfg(unix)]
    send(child, rustix::process::Signal::KILL);
    // It may be gone already.
    let _ = child.kill();
}

#[cfg(unix)]
fn send(child: &Child, signal: rustix::process::Signal) {
    let process = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw);
    if let Some(process) = process {
        let _ = rustix::process::kill_process_group(process, signal);
    }
}

/// Lets the system refuse a process more memory than `most`, bytes, for its data; Linux only.
#[cfg(target_os = "linux")]
pub fn limit_memory(child: &Child, most: u64) {
    use rustix::process::{Pid, Resource, Rlimit, prlimit};
    let limit = Rlimit { current: Some(most), maximum: Some(most) };
    if let Some(process) = i32::try_from(child.id()).ok().and_then(Pid::from_raw) {
        // What it holds is watched in any case.
        let _ = prlimit(Some(process), Resource::Data, limit);
    }
}

#[cfg(not(target_os = "linux"))]
pub fn limit_memory(_: &Child, _: u64) {}

/// The signal that has ended a process.
pub fn of_status(status: std::process::ExitStatus) -> Option<i32> {
    #[cfg(unix)]
    return std::os::unix::process::ExitStatusExt::signal(&status);
    #[cfg(not(unix))]
    return {
        let _ = status;
        None
    };
}
