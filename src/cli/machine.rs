//! What the machine lets the program have: memory and threads.

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread::{Builder, JoinHandle, available_parallelism};

use super::exit::{Exit, Failure};
use super::words;

/// With less left than this, and more taken, a run is ended before the system ends it.
const RESERVE: u64 = 24 << 20;

/// A run may take this many times its `--max-memory` before it is ended: its estimate may be wrong by as much.
const BEYOND_CAP: f64 = 1.25;

/// A smaller cap is refused with the plan, before the work; the program itself is larger.
const LEAST_CAP: u64 = 64 << 20;

/// What a run may take in all, bytes: what the user allows, or what the process has and what is free.
pub fn memory_cap(asked: Option<u64>) -> Option<u64> {
    asked.or_else(|| Some(resident()? + free_memory()?))
}

/// Why a run must end now, if it must: its memory is more than it may take.
pub fn shortage(max_memory: Option<u64>) -> Option<Failure> {
    let taken = resident()?;
    if let Some(cap) = max_memory.filter(|&cap| is_beyond(taken, cap)) {
        let (taken, cap) = (words::bytes(taken), words::bytes(cap));
        let message =
            format!("the run has taken {taken} of memory, and --max-memory allows {cap}; no output was written");
        return Some(Failure::new(Exit::Memory, message).hint("a lower --resolution, or a larger --max-memory"));
    }
    let left = free_memory().filter(|&left| left < RESERVE && taken > RESERVE)?;
    let (taken, left) = (words::bytes(taken), words::bytes(left));
    let message =
        format!("the memory is used up: the run has taken {taken}, and {left} are left; no output was written");
    Some(Failure::new(Exit::Memory, message).hint("a lower --resolution, a larger voxel, or fewer --threads"))
}

fn is_beyond(taken: u64, cap: u64) -> bool {
    taken as f64 > BEYOND_CAP * cap.max(LEAST_CAP) as f64
}

/// Why there can be no more of something.
pub fn no_threads(why: impl std::fmt::Display) -> Failure {
    Failure::new(Exit::Memory, format!("the system lets the program start no more threads ({why})"))
        .hint("a higher limit of processes (ulimit -u) or of memory (ulimit -v)")
}

/// Starts the threads that stages share, as many as are asked for and as the system allows; none beside the caller's if it must
/// be. No result depends on their number. Returns a line for the user when there are fewer than were wanted.
pub fn start_threads(asked: Option<u16>) -> Result<Option<String>, Failure> {
    let set = || std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok().filter(|&count: &usize| count > 0);
    let wanted =
        asked.map(usize::from).or_else(set).or_else(|| available_parallelism().ok().map(usize::from)).unwrap_or(1);
    let possible = startable(wanted);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(possible.max(1));
    let pool = if possible == 0 { pool.use_current_thread() } else { pool };
    pool.build_global().map_err(no_threads)?;
    Ok((possible < wanted)
        .then(|| format!("the system allows {} of {wanted} threads; the result is the same", possible.max(1))))
}

/// How many threads, up to `wanted`, can be had at the same time.
fn startable(wanted: usize) -> usize {
    let mut waiting: Vec<(JoinHandle<()>, mpsc::Sender<()>)> = Vec::new();
    while waiting.len() < wanted {
        let (release, wait) = mpsc::channel::<()>();
        match Builder::new().spawn(move || wait.recv().unwrap_or_default()) {
            Ok(thread) => waiting.push((thread, release)),
            Err(_) => break,
        }
    }
    let count = waiting.len();
    for (thread, release) in waiting {
        drop(release);
        let _ = thread.join();
    }
    count
}

/// When memory cannot be had, the standard library says how much and aborts. This makes that an exit with the status for
/// memory, unless the program has panicked before, which is a bug and stays an abort. Writing beyond the limit of a file's size
/// becomes an error like others.
#[cfg(unix)]
pub fn tame_signals(no_bug: std::sync::Arc<std::sync::atomic::AtomicBool>) {
    use signal_hook::consts::{SIGABRT, SIGXFSZ};
    // Where a handler cannot be set, the signal does what it always did.
    let _ = signal_hook::flag::register_conditional_shutdown(SIGABRT, Exit::Memory.code().into(), no_bug);
    let _ = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default());
}

/// There is nothing to tame.
#[cfg(not(unix))]
pub fn tame_signals(_: std::sync::Arc<std::sync::atomic::AtomicBool>) {}

#[cfg(any(test, all(target_os = "linux", feature = "gpu")))]
/// Settings under which graphics drivers print nothing of their own: what Mesa logs goes nowhere, and without a desktop its layer
/// that looks for the desktop's adapter stays off. What the user has set stays.
fn driver_settings(is_set: impl Fn(&str) -> bool, has_desktop: bool) -> Vec<(&'static str, &'static str)> {
    let mut settings = Vec::new();
    if !is_set("MESA_LOG_FILE") {
        settings.push(("MESA_LOG_FILE", "/dev/null"));
    }
    if !has_desktop && !is_set("NODEVICE_SELECT") && !is_set("MESA_VK_DEVICE_SELECT") {
        settings.push(("NODEVICE_SELECT", "1"));
    }
    settings
}

/// Makes graphics drivers print nothing. A process cannot safely change its own environment, so it begins once more with another one;
/// where that cannot be, it goes on as it is.
#[cfg(all(target_os = "linux", feature = "gpu"))]
pub fn quiet_drivers() {
    use std::os::unix::process::CommandExt;
    let has_desktop = std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).is_dir());
    let settings = driver_settings(|name| std::env::var_os(name).is_some(), has_desktop);
    let Ok(program) = std::env::current_exe() else { return };
    if settings.is_empty() {
        return;
    }
    let mut arguments = std::env::args_os();
    let mut command = std::process::Command::new(program);
    if let Some(name) = arguments.next() {
        command.arg0(name);
    }
    // It comes back only when it has failed.
    let _ = command.args(arguments).envs(settings).exec();
}

/// Elsewhere drivers print nothing.
#[cfg(not(all(target_os = "linux", feature = "gpu")))]
pub fn quiet_drivers() {}

/// Bytes of memory that this process holds; Linux only.
pub fn resident() -> Option<u64> {
    of_process("VmRSS:")
}

/// The most that it has held.
pub fn peak_memory() -> Option<u64> {
    of_process("VmHWM:")
}

/// What a process holds.
#[derive(Debug, Clone, Copy)]
pub struct Memory {
    /// Now, bytes.
    pub resident: u64,
    /// At the most, bytes.
    pub peak: u64,
}

/// Of another process; Linux only.
pub fn memory_of(process: u32) -> Option<Memory> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    Some(Memory { resident: kibibytes(&status, "VmRSS:")?, peak: kibibytes(&status, "VmHWM:")? })
}

/// The variable of the environment by which a batch tells the processes of its jobs its number.
pub const PARENT: &str = "MESHWRIGHT_BATCH";

/// Whether this process was started by a batch that is gone.
#[cfg(unix)]
pub fn is_orphan() -> bool {
    let parent = std::env::var(PARENT).ok().and_then(|number| number.parse::<u32>().ok());
    parent.is_some_and(|parent| parent != std::os::unix::process::parent_id())
}

/// It cannot be told.
#[cfg(not(unix))]
pub fn is_orphan() -> bool {
    false
}

fn of_process(field: &str) -> Option<u64> {
    kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, field)
}

/// Bytes that this process may still take: what the machine, its control group and the limits of its resources leave. Linux only.
pub fn free_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let machine = std::fs::read_to_string("/proc/meminfo")
        .ok()
        .and_then(|text| Some(kibibytes(&text, "MemAvailable:")? + kibibytes(&text, "SwapFree:").unwrap_or(0)));
    let limits = std::fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let limited = |name, field| Some(limit(&limits, name)?.saturating_sub(kibibytes(&status, field)?));
    let bounds = [machine, limited("Max address space", "VmSize:"), limited("Max data size", "VmData:")];
    bounds.into_iter().flatten().chain(free_in_groups()).min()
}

/// The number after `field` in the manner of `/proc`, in bytes.
fn kibibytes(text: &str, field: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(field))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// The soft limit of this name; none where it is unlimited.
fn limit(limits: &str, name: &str) -> Option<u64> {
    limits.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

/// What each of the control groups that this process is in leaves.
fn free_in_groups() -> Vec<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let mut free = Vec::new();
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(kinds), Some(group)) = (parts.next(), parts.next()) else { continue };
        let (root, names) = match kinds {
            "" => ("/sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file "]),
            kinds if kinds.split(',').any(|kind| kind == "memory") => {
                ("/sys/fs/cgroup/memory", ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "])
            }
            _ => continue,
        };
        // A container sees its own group as the root.
        let mut folder: PathBuf = [root, group.trim_start_matches('/')].iter().collect();
        while folder.starts_with(root) {
            free.extend(free_in_group(&folder, names));
            folder.pop();
        }
    }
    free
}

fn free_in_group(folder: &Path, [most, now, files]: [&str; 3]) -> Option<u64> {
    let number = |name| std::fs::read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
    let (most, now) = (number(most)?, number(now)?);
    // Files that nobody reads any more give way.
    let stat = std::fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let idle = stat.lines().find_map(|line| line.strip_prefix(files)?.trim().parse::<u64>().ok());
    Some(most.saturating_sub(now.saturating_sub(idle.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_user_has_set_for_drivers_stays() {
        let names = |set: &[&str], desktop| {
            let settings = driver_settings(|name| set.contains(&name), desktop);
            settings.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        assert_eq!(names(&[], false), ["MESA_LOG_FILE", "NODEVICE_SELECT"]);
        assert_eq!(names(&[], true), ["MESA_LOG_FILE"]);
        assert_eq!(names(&["MESA_VK_DEVICE_SELECT"], false), ["MESA_LOG_FILE"]);
        // Begun once more, there is nothing left to set.
        assert!(names(&["MESA_LOG_FILE", "NODEVICE_SELECT"], false).is_empty());
    }

    #[test]
    fn numbers_of_the_system_are_read() {
        let status = "VmPeak:\t  9000 kB\nVmSize:\t  8000 kB\nVmRSS:\t   100 kB\n";
        assert_eq!(kibibytes(status, "VmSize:"), Some(8_192_000));
        assert_eq!(kibibytes(status, "VmData:"), None);
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
                      Max data size             unlimited            unlimited            bytes     \n\
                      Max address space         512000000            unlimited            bytes     \n";
        assert_eq!(limit(limits, "Max address space"), Some(512_000_000));
        assert_eq!(limit(limits, "Max data size"), None);
    }

    #[test]
    fn a_group_leaves_what_is_not_taken_and_what_files_give_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
        let names = ["memory.max", "memory.current", "inactive_file "];
        write("memory.max", "max\n");
        write("memory.current", "700\n");
        assert_eq!(free_in_group(folder.path(), names), None);
        write("memory.max", "1000\n");
        assert_eq!(free_in_group(folder.path(), names), Some(300));
        write("memory.stat", "anon 500\nactive_file 20\ninactive_file 150\n");
        assert_eq!(free_in_group(folder.path(), names), Some(450));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_usual_cap_is_what_is_there_and_what_is_free() {
        let taken = resident().expect("the system tells");
        assert!(memory_cap(None).is_some_and(|cap| cap > taken));
        assert_eq!(memory_cap(Some(7)), Some(7));
        assert!(shortage(None).is_none() && shortage(Some(1 << 40)).is_none());
        let held = vec![1u8; 100 << 20];
        let failure = shortage(Some(1)).expect("more is taken than the least cap");
        assert_eq!((failure.exit, held[held.len() / 2]), (Exit::Memory, 1));
        assert!(failure.message.contains("--max-memory"), "{failure}");
    }

    #[test]
    fn a_cap_that_is_passed_by_far_ends_the_run() {
        let cap = 1_000_000_000;
        assert!(!is_beyond(cap, cap) && !is_beyond(cap / 5 * 6, cap) && is_beyond(cap / 4 * 5 + 1, cap));
        // Below the program's own size the plan decides.
        assert!(!is_beyond(50_000_000, 1));
    }

    #[test]
    fn as_many_threads_start_as_are_wanted() {
        assert_eq!(startable(3), 3);
    }
}
