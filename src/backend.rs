//! Which processor casts the rays, the same to the last bit by either, and which makes exact fields, the same but for rounding.

use serde::{Deserialize, Serialize};

use crate::lattice::{DistanceField, Lattice};
use crate::ldi::{Layers, ldis};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};
use crate::sdf::exact::{self, ExactError, ExactOptions, Sign};

/// Which processor makes the layered depth images, the same to the last bit, or an exact field, the same but for rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// For layered depth images the graphics processor where there is a real one and the job is large enough to pay, else the main one; for fields always the
    /// main one, so that they are the same bytes on every machine.
    #[default]
    Auto,
    /// The main processor.
    Cpu,
    /// A graphics adapter, a software one if there is no other. An error in a build without the feature `gpu`.
    Gpu,
}

/// Who made the layered depth images, or the field.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BackendReport {
    /// Never [`Backend::Auto`], except where nothing was made.
    pub backend: Backend,
    /// Name of the graphics adapter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapter: Option<String>,
    /// Bytes sent to the graphics adapter.
    pub bytes_up: u64,
    /// Bytes read back from it.
    pub bytes_down: u64,
    /// Voxels of a field that the main processor measured again, since single precision did not tell their side.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubtful: Option<u64>,
    /// Why the main processor did it after all, though a graphics adapter was to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fallback: Option<String>,
}

/// Why a processor did not do its work.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BackendError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The graphics processor was asked for and cannot do it.
    #[error("{reason}")]
    Device {
        /// One sentence: why.
        reason: String,
        /// What to try.
        hint: String,
    },
}

/// The LDIs by the processor that `backend` says. `crossings`: how many there will be, about.
pub(crate) fn layers(
    soup: &TriMesh,
    lattice: &Lattice,
    backend: Backend,
    crossings: f64,
    progress: &Progress,
) -> Result<(Vec<Layers>, BackendReport), BackendError> {
    let fallback = match backend {
        Backend::Cpu => None,
        Backend::Gpu => return gpu::forced(soup, lattice, progress),
        Backend::Auto => match gpu::if_it_pays(soup, lattice, crossings, progress)? {
            Some(Ok(made)) => return Ok(made),
            Some(Err(reason)) => Some(reason),
            None => None,
        },
    };
    let layers = ldis(soup, lattice, 1, progress)?;
    Ok((layers, BackendReport { backend: Backend::Cpu, fallback, ..BackendReport::default() }))
}

/// The field of [`exact::exact`] by the processor that `backend` says.
pub(crate) fn exact(
    mesh: &TriMesh,
    lattice: &Lattice,
    sign: Sign<'_>,
    options: &ExactOptions,
    backend: Backend,
    progress: &Progress,
) -> Result<(DistanceField, BackendReport), FieldError> {
    if backend == Backend::Gpu {
        return gpu::exact(mesh, lattice, sign, options, progress);
    }
    let field = exact::exact(mesh, lattice, sign, options, progress).map_err(FieldError::Field)?;
    Ok((field, BackendReport { backend: Backend::Cpu, ..BackendReport::default() }))
}

/// Why there is no field.
pub(crate) enum FieldError {
    /// Neither processor could.
    Field(ExactError),
    /// The graphics processor could not.
    Gpu { reason: String, hint: String },
}

#[cfg(feature = "gpu")]
mod gpu {
    use super::*;
    use crate::gpu::{self, AdapterKind, Device, FieldOptions, GpuError, GpuOptions, GpuReport, Wanted};

    type Made = (Vec<Layers>, BackendReport);

    pub fn forced(soup: &TriMesh, lattice: &Lattice, progress: &Progress) -> Result<Made, BackendError> {
        let failed = |error: GpuError| match error {
            GpuError::Stopped(stopped) => BackendError::Stopped(stopped),
            _ => BackendError::Device { reason: error.to_string(), hint: error.hint().into() },
        };
        let device = Device::open(&Wanted::Any).map_err(failed)?;
        on(&device, soup, lattice, progress).map_err(failed)
    }

    /// On a real graphics processor, if there is one and it pays; the reason when it failed.
    pub fn if_it_pays(
        soup: &TriMesh,
        lattice: &Lattice,
        crossings: f64,
        progress: &Progress,
    ) -> Result<Option<Result<Made, String>>, Stopped> {
        let job =
            Job { crossings, triangles: soup.triangles.len() as f64, threads: rayon::current_num_threads() as f64 };
        if !job.pays() {
            return Ok(None);
        }
        tried(Device::open(&Wanted::Hardware), soup, lattice, progress)
    }

    fn tried(
        device: Result<Device, GpuError>,
        soup: &TriMesh,
        lattice: &Lattice,
        progress: &Progress,
    ) -> Result<Option<Result<Made, String>>, Stopped> {
        let device = match device {
            Ok(device) => device,
            Err(GpuError::NoAdapter { .. }) => return Ok(None),
            Err(error) => return Ok(Some(Err(error.to_string()))),
        };
        match on(&device, soup, lattice, progress) {
            Ok(made) => Ok(Some(Ok(made))),
            Err(GpuError::Stopped(stopped)) => Err(stopped),
            Err(error) => Ok(Some(Err(format!("{}: {error}", device.entry().name)))),
        }
    }

    fn on(device: &Device, soup: &TriMesh, lattice: &Lattice, progress: &Progress) -> Result<Made, GpuError> {
        let (layers, report) = gpu::ldis(device, soup, lattice, 1, &GpuOptions::default(), progress)?;
        let report = made_by(device, &report);
        Ok((layers, report))
    }

    pub fn exact(
        mesh: &TriMesh,
        lattice: &Lattice,
        sign: Sign<'_>,
        options: &ExactOptions,
        progress: &Progress,
    ) -> Result<(DistanceField, BackendReport), FieldError> {
        let device = Device::open(&Wanted::Any).map_err(refused)?;
        let of_device = (options, &FieldOptions::default());
        let made = gpu::distances(&device, mesh, lattice, sign, of_device, progress).map_err(refused)?;
        let report = BackendReport { doubtful: Some(made.doubtful), ..made_by(&device, &made.report) };
        Ok((made.field, report))
    }

    fn refused(error: GpuError) -> FieldError {
        match error {
            GpuError::Stopped(stopped) => FieldError::Field(stopped.into()),
            GpuError::Field(error) => FieldError::Field(error),
            error => FieldError::Gpu { reason: error.to_string(), hint: error.hint().into() },
        }
    }

    fn made_by(device: &Device, report: &GpuReport) -> BackendReport {
        let entry = device.entry();
        let software = if entry.kind == AdapterKind::Software { " (software)" } else { "" };
        BackendReport {
            backend: Backend::Gpu,
            adapter: Some(format!("{}{software}", entry.name)),
            bytes_up: report.bytes_up,
            bytes_down: report.bytes_down,
            doubtful: None,
            fallback: None,
        }
    }

    /// What decides whether a graphics processor pays.
    struct Job {
        crossings: f64,
        triangles: f64,
        threads: f64,
    }

    /// Seconds of one thread of the main processor for a crossing, all in: measured on the bunny at 512.
    const CPU_SECONDS: f64 = 42e-9;
    /// Of these, what stays with the main processor: depths and sorting. Measured, too.
    const HOST_SECONDS: f64 = 33e-9;
    /// Seconds to open a device and compile the shaders: an estimate for ordinary drivers.
    const OPEN_SECONDS: f64 = 0.3;
    /// Bytes a second between the processors: an estimate for half a PCI Express 3 slot.
    const BANDWIDTH: f64 = 6e9;
    /// Bytes of a triangle, and of a crossing with its share of rays.
    const TRIANGLE_BYTES: f64 = 36.0;
    const CROSSING_BYTES: f64 = 9.0;

    impl Job {
        fn pays(&self) -> bool {
            let saved = self.crossings * (CPU_SECONDS - HOST_SECONDS) / self.threads;
            let moved = self.triangles * TRIANGLE_BYTES + self.crossings * CROSSING_BYTES;
            saved > OPEN_SECONDS + moved / BANDWIDTH
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn a_missing_card_is_passed_over_and_a_failing_one_is_a_reason() {
            let lattice = Lattice { origin: glam::DVec3::ZERO, h: 1.0, dims: glam::IVec3::splat(4) };
            let try_with = |error| tried(Err(error), &TriMesh::default(), &lattice, &Progress::none());
            let missing = GpuError::NoAdapter { wanted: "that is real".into(), present: Vec::new() };
            assert!(matches!(try_with(missing), Ok(None)));
            assert!(
                matches!(try_with(GpuError::OutOfMemory), Ok(Some(Err(reason))) if reason.contains("too little memory"))
            );
        }

        #[test]
        fn only_large_jobs_on_few_threads_pay() {
            let job = |crossings, threads| Job { crossings, triangles: 1e5, threads }.pays();
            assert!(!job(1e6, 1.0) && !job(1e7, 2.0));
            assert!(job(1e8, 1.0) && job(1e9, 2.0));
            assert!(!job(1e9, 8.0));
        }
    }
}

#[cfg(not(feature = "gpu"))]
mod gpu {
    use super::*;

    type Made = (Vec<Layers>, BackendReport);

    pub fn forced(_: &TriMesh, _: &Lattice, _: &Progress) -> Result<Made, BackendError> {
        Err(BackendError::Device { reason: "this build has no graphics backend".into(), hint: "--backend cpu".into() })
    }

    pub fn if_it_pays(_: &TriMesh, _: &Lattice, _: f64, _: &Progress) -> Result<Option<Result<Made, String>>, Stopped> {
        Ok(None)
    }

    pub fn exact(
        _: &TriMesh,
        _: &Lattice,
        _: Sign<'_>,
        _: &ExactOptions,
        _: &Progress,
    ) -> Result<(DistanceField, BackendReport), FieldError> {
        Err(FieldError::Gpu { reason: "this build has no graphics backend".into(), hint: "--backend cpu".into() })
    }
}
