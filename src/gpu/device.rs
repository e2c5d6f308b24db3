//! An open adapter, and the errors that it reports.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::adapters::{AdapterEntry, Wanted, wanted};
use super::programs::{Field, Peel, Scatter, Setup};
use super::{GpuError, GpuMethod};

/// An open graphics adapter with the programs of this crate. Opening takes tens of milliseconds, hundreds on some
/// drivers: keep it for several jobs.
#[derive(Debug)]
pub struct Device {
    pub(super) raw: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    entry: AdapterEntry,
    faults: Faults,
    setup: OnceLock<Setup>,
    peel: OnceLock<Peel>,
    scatter: OnceLock<Scatter>,
    field: OnceLock<Field>,
}

impl Device {
    /// Opens the best adapter of those that are wanted.
    pub fn open(which: &Wanted) -> Result<Self, GpuError> {
        let (adapter, entry) = wanted(which)?;
        let optional = wgpu::Features::TIMESTAMP_QUERY;
        let descriptor = wgpu::DeviceDescriptor {
            required_features: adapter.features() & optional,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (raw, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| GpuError::NoDevice { adapter: entry.name.clone(), reason: e.to_string() })?;
        let faults = Faults::default();
        let (refused, lost) = (faults.clone(), faults.clone());
        raw.on_uncaptured_error(Arc::new(move |error| refused.note(GpuError::from(error))));
        raw.set_device_lost_callback(move |_, reason| lost.note(GpuError::Lost { reason }));
        Ok(Self {
            raw,
            queue,
            entry,
            faults,
            setup: OnceLock::new(),
            peel: OnceLock::new(),
            scatter: OnceLock::new(),
            field: OnceLock::new(),
        })
    }

    /// What is open.
    pub fn entry(&self) -> &AdapterEntry {
        &self.entry
    }

    /// An error when the adapter cannot do `method`.
    pub(super) fn check_can(&self, method: GpuMethod) -> Result<(), GpuError> {
        let (can, lacks) = match method {
            GpuMethod::Peel => (self.entry.peel, "targets of 32-bit integers and depths"),
            GpuMethod::Scatter => (self.entry.scatter, "compute shaders"),
        };
        if can { Ok(()) } else { Err(GpuError::Incapable { adapter: self.entry.name.clone(), lacks: lacks.into() }) }
    }

    pub(super) fn setup(&self) -> &Setup {
        self.setup.get_or_init(|| Setup::new(&self.raw))
    }

    pub(super) fn peel(&self) -> &Peel {
        self.peel.get_or_init(|| Peel::new(&self.raw))
    }

    pub(super) fn scatter(&self) -> &Scatter {
        self.scatter.get_or_init(|| Scatter::new(&self.raw))
    }

    pub(super) fn field(&self) -> &Field {
        self.field.get_or_init(|| Field::new(&self.raw))
    }

    /// The first thing that has gone wrong since the last look.
    pub(super) fn check(&self) -> Result<(), GpuError> {
        self.faults.take().map_or(Ok(()), Err)
    }

    /// Waits until everything submitted is done.
    pub(super) fn wait(&self) -> Result<(), GpuError> {
        // wgpu 30 panics when the device is lost during the wait.
        WAITING.set(true);
        let waited = catch_unwind(AssertUnwindSafe(|| self.raw.poll(wgpu::PollType::wait_indefinitely())));
        WAITING.set(false);
        self.check()?;
        match waited {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => Err(GpuError::Lost { reason: error.to_string() }),
            Err(_) => Err(GpuError::Lost { reason: "it stopped answering".into() }),
        }
    }
}

thread_local! {
    static WAITING: Cell<bool> = const { Cell::new(false) };
}

/// Whether this thread waits for a graphics processor, whose loss wgpu tells by a panic; it becomes a [`GpuError::Lost`],
/// and a panic hook need say nothing.
pub fn is_waiting() -> bool {
    WAITING.get()
}

/// The first error since the last look. All of wgpu's errors come here: with error scopes instead, those of calls outside of
/// any scope would end the process.
#[derive(Debug, Clone, Default)]
struct Faults(Arc<Mutex<Option<GpuError>>>);

impl Faults {
    fn note(&self, error: GpuError) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // That the device is lost explains whatever came before.
        if first.is_none() || matches!(error, GpuError::Lost { .. }) {
            *first = Some(error);
        }
    }

    fn take(&self) -> Option<GpuError> {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*first {
            Some(GpuError::Lost { .. }) => first.clone(),
            _ => first.take(),
        }
    }
}

impl From<wgpu::Error> for GpuError {
    fn from(error: wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory,
            wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
                Self::Validation { reason: description.split_whitespace().collect::<Vec<_>>().join(" ") }
            }
        }
    }
}
