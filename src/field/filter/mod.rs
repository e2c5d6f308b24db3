//! The convolution filter that keeps the surface (Sanchez et al. 2015 §4, §5).
//!
//! g(p) = ∫ f(p − s h(p)) w(s) ds with a kernel w whose size h(p) is 0 on the surface and 1 from the distance f_c on: the zero
//! level stays exactly, and elsewhere creases of the distance go. With the bump kernel and b ≤ 8 f_c / 9 no sample lies beyond
//! the surface (7), so that no other zero level can arise.

mod kernel;
mod local;

use std::sync::Arc;

use glam::DVec3;

pub(in crate::field) use kernel::uniform;
use kernel::{Displacement, displacements, near_each_other};
pub use kernel::{Kernel, Sampling};
pub use local::{SmoothOptions, smooth};

use super::{Ball, Extent, Field, Range, Sample, Shared, SourceTriangle};

/// The bump's width over the cap must not be more (7).
pub const WIDEST: f64 = 8.0 / 9.0;

/// Points that are displaced together.
const PACKET: usize = 8;
/// What counts as no displacement at all, over the cap.
const NOTHING: f64 = 1e-12;

/// Options of [`filtered`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterOptions {
    /// The paper's f_c, model units, more than 0: from this distance on the kernel has its full size.
    pub cap: f64,
    /// The kernel.
    pub kernel: Kernel,
    /// Where the field is sampled.
    pub sampling: Sampling,
    /// Whether fewer samples are taken where they are enough, for drawn ones.
    pub adaptive: Option<Adaptive>,
    /// Whether the unsigned distance is filtered and the sign put back (§4.3): it allows any kernel without other zero
    /// levels, but makes creases of its own where the kernel reaches beyond the surface.
    pub sign_safe: bool,
}

impl FilterOptions {
    /// The widest bump that keeps the zero level for this cap (model units), 64 samples, as many everywhere.
    pub fn new(cap: f64) -> Self {
        let sampling = Sampling::Drawn { count: 64, seed: 0, mirrored: true };
        Self { cap, kernel: Kernel::Bump { width: WIDEST * cap }, sampling, adaptive: None, sign_safe: false }
    }
}

/// How the number of samples follows the need (§5.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Samples where neither the surface nor the medial axis is near, at least 2; at most all there are.
    pub least: usize,
}

/// Why a field cannot be filtered.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// A length is not positive.
    #[error("a filter with a cap of {cap} and a kernel {width} wide is none: both must be positive lengths")]
    Size {
        /// The cap, model units.
        cap: f64,
        /// The width, model units.
        width: f64,
    },
    /// The kernel could reach beyond the surface.
    #[error("a kernel {width} wide reaches beyond the surface under a cap of {cap}, and could make surfaces of its own: \
        a width of at most {most}, or a cap of at least {least}", most = WIDEST * cap, least = width / WIDEST)]
    Wide {
        /// The width, model units.
        width: f64,
        /// The cap, model units.
        cap: f64,
    },
    /// The Gaussian has no end.
    #[error(
        "a Gaussian kernel has no end and could make surfaces of its own: the bump kernel, or the sign-safe filter"
    )]
    Endless,
}

/// `field` filtered: the same zero level, smooth elsewhere.
///
/// # Errors
/// See [`FilterError`].
pub fn filtered(field: Shared, options: &FilterOptions) -> Result<Shared, FilterError> {
    let (cap, width) = (options.cap, options.kernel.width());
    if !(cap > 0.0 && width > 0.0 && cap.is_finite() && width.is_finite()) {
        return Err(FilterError::Size { cap, width });
    }
    match options.kernel {
        _ if options.sign_safe => {}
        Kernel::Gaussian { .. } => return Err(FilterError::Endless),
        Kernel::Bump { width } if width > WIDEST * cap * (1.0 + 1e-12) => return Err(FilterError::Wide { width, cap }),
        Kernel::Bump { .. } => {}
    }
    Ok(Arc::new(Filtered { inner: field, around: Around::new(options), cap, sign_safe: options.sign_safe }))
}

/// The samples around a point.
struct Around {
    /// Those that are always taken, in packets; their weights add up to 1.
    first: Vec<Displacement>,
    /// Those that are taken where they are needed, in the order drawn.
    more: Vec<Displacement>,
    /// How many of them are added at a time: opposites together.
    step: usize,
    /// The width of the kernel, model units.
    width: f64,
    /// The farthest displacement, and the greatest mean of the first ones and any of the others, model units.
    farthest: f64,
    mean: f64,
}

impl Around {
    fn new(options: &FilterOptions) -> Self {
        let mut first = displacements(&options.kernel, options.sampling);
        let step = if matches!(options.sampling, Sampling::Drawn { mirrored: true, .. }) { 2 } else { 1 };
        let drawn = matches!(options.sampling, Sampling::Drawn { .. });
        let least = options.adaptive.filter(|_| drawn).map(|adaptive| adaptive.least.max(2).next_multiple_of(step));
        let least = least.unwrap_or(first.len());
        let mut more = first.split_off(least.min(first.len()));
        let sum: f64 = first.iter().map(|d| d.weight).sum();
        first.iter_mut().for_each(|d| d.weight /= sum);
        more.iter_mut().for_each(|d| d.weight = 1.0);
        near_each_other(&mut first);
        let farthest = first.iter().chain(&more).map(|d| d.by.length()).fold(0.0, f64::max);
        let mut sum: f64 = first.iter().map(|d| d.by.length() * d.weight).sum();
        let (mut mean, mut count) = (sum, first.len() as f64);
        sum *= count;
        for d in &more {
            (sum, count) = (sum + d.by.length(), count + 1.0);
            mean = mean.max(sum / count);
        }
        Self { width: options.kernel.width(), step, farthest, mean, first, more }
    }
}

struct Filtered {
    inner: Shared,
    around: Around,
    cap: f64,
    sign_safe: bool,
}

/// 3 t² − 2 t³ between 0 and 1 (4), and how it grows.
fn smoothstep(t: f64) -> (f64, f64) {
    let t = t.clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t))
}

impl Filtered {
    /// The kernel's size at a value of the field, and how it grows with the value, per model unit.
    fn size(&self, value: f64) -> (f64, f64) {
        let (size, growth) = smoothstep(value.abs() / self.cap);
        (size, growth * value.signum() / self.cap)
    }

    /// A sampled value as it counts for a point on the side of `sign`.
    fn counted(&self, value: f64, sign: f64) -> f64 {
        if self.sign_safe { value.abs() * sign } else { value }
    }

    /// How many of the further samples are needed where the first ones have this mean (§5.2): all near the surface and
    /// near the medial axis, where the mean is not the value.
    fn wanted(&self, value: f64, size: f64, mean: f64) -> f64 {
        let medial = smoothstep((mean - value).abs() / (MEDIAL * size * self.around.width)).0;
        let near = 1.0 - smoothstep(value.abs() / self.cap).0;
        (medial + near) / 2.0 * self.around.more.len() as f64
    }

    /// Whether the kernel has any size where the field has this value.
    fn spreads(&self, value: f64) -> bool {
        value.is_finite() && self.size(value).0 * self.around.farthest > NOTHING * self.cap
    }

    /// For each of the points, whose values and sizes of the kernel are given, the mean of the sampled values, or as much
    /// of it as the displacements' weights are.
    fn means(&self, points: &[Spread], displacements: &[Displacement], room: &mut Room) -> Vec<f64> {
        room.displace(points, displacements);
        room.values.resize(room.points.len(), 0.0);
        self.inner.values(&room.points, &mut room.values);
        let mut means = vec![0.0; points.len()];
        for (d, values) in displacements.iter().zip(room.values.chunks_exact(points.len().max(1))) {
            for ((mean, &value), at) in means.iter_mut().zip(values).zip(points) {
                *mean += d.weight * self.counted(value, at.own.value.signum());
            }
        }
        means
    }

    /// The further samples that are needed where the first ones have this mean, and the sum of all weights if each of the
    /// first counts 1. The last one, or the last pair of opposites, counts by the fraction, so that nothing jumps where
    /// their number changes.
    fn further(&self, value: f64, size: f64, mean: f64) -> (Vec<Displacement>, f64) {
        let wanted = self.wanted(value, size, mean);
        let step = self.around.step;
        let weight = |k: usize| ((wanted - (k / step * step) as f64) / step as f64).clamp(0.0, 1.0);
        let weighted = self.around.more.iter().zip(0..).map(|(d, k)| Displacement { weight: weight(k), ..*d });
        let further: Vec<Displacement> = weighted.take_while(|d| d.weight > 0.0).collect();
        let sum = further.iter().map(|d| d.weight).sum::<f64>();
        (further, self.around.first.len() as f64 + sum)
    }

    /// The filtered values.
    fn filter(&self, points: &[Spread], room: &mut Room) -> Vec<f64> {
        let mut means = self.means(points, &self.around.first, room);
        if !self.around.more.is_empty() {
            for (mean, at) in means.iter_mut().zip(points) {
                let (further, all) = self.further(at.own.value, at.size, *mean);
                let more = self.means(std::slice::from_ref(at), &further, room)[0];
                *mean = (*mean * self.around.first.len() as f64 + more) / all;
            }
        }
        means
    }

    /// Filtered values with gradients, all by the same displacements: ∇g = Σ w (∇f − (∇f · s) ∇h) at the displaced points.
    fn filter_samples(&self, points: &[Spread], displacements: &[Displacement], room: &mut Room) -> Vec<Sample> {
        room.displace(points, displacements);
        room.samples.resize(room.points.len(), Sample::default());
        self.inner.samples(&room.points, &mut room.samples);
        let mut sums = vec![Sample::default(); points.len()];
        for (d, samples) in displacements.iter().zip(room.samples.chunks_exact(points.len().max(1))) {
            for ((sum, sample), at) in sums.iter_mut().zip(samples).zip(points) {
                let value = self.counted(sample.value, at.own.value.signum());
                let gradient = if value == sample.value { sample.gradient } else { -sample.gradient };
                sum.value += value * d.weight;
                sum.gradient += (gradient - at.own.gradient * (at.growth * gradient.dot(d.by))) * d.weight;
            }
        }
        sums
    }

    /// All displacements for one point, with the weights that they have there.
    fn all_at(&self, at: &Spread, room: &mut Room) -> Vec<Displacement> {
        let first = self.means(std::slice::from_ref(at), &self.around.first, room)[0];
        let (further, count) = self.further(at.own.value, at.size, first);
        let part = self.around.first.len() as f64 / count;
        let scaled = self.around.first.iter().map(|d| Displacement { weight: d.weight * part, ..*d });
        scaled.chain(further.into_iter().map(|d| Displacement { weight: d.weight / count, ..d })).collect()
    }

    /// The points by packets: eight together where the kernel reaches from one to the other, each alone elsewhere.
    fn near<'s>(&self, points: &'s [Spread]) -> impl Iterator<Item = &'s [Spread]> {
        let width = self.around.width;
        points.chunks(PACKET).flat_map(move |packet| {
            let reach = packet[0].size * width;
            let together = packet.iter().all(|at| at.p.distance(packet[0].p) < reach);
            packet.chunks(if together { PACKET } else { 1 })
        })
    }

    /// The points where the kernel spreads.
    fn spread(&self, points: &[DVec3], own: &[Sample]) -> (Vec<usize>, Vec<Spread>) {
        let spread = (0..points.len()).filter(|&k| self.spreads(own[k].value)).map(|k| {
            let (size, growth) = self.size(own[k].value);
            (k, Spread { p: points[k], own: own[k], size, growth })
        });
        spread.unzip()
    }
}

/// A point where the kernel has a size.
struct Spread {
    p: DVec3,
    /// The field before it is filtered.
    own: Sample,
    /// The size of the kernel, and how it grows with the field.
    size: f64,
    growth: f64,
}

/// The mean of the first samples is off by this part of the kernel's size on the medial axis of a plate: measured for the
/// bump, 0.23 at its widest.
const MEDIAL: f64 = 0.2;

/// What the samples of one point are kept in.
#[derive(Default)]
struct Room {
    points: Vec<DVec3>,
    values: Vec<f64>,
    samples: Vec<Sample>,
}

impl Room {
    /// All points displaced by the first sample, then by the next: so displaced they stay as near each other as they are.
    fn displace(&mut self, points: &[Spread], displacements: &[Displacement]) {
        self.points.clear();
        self.points.extend(displacements.iter().flat_map(|d| points.iter().map(|at| at.p - d.by * at.size)));
    }
}

impl Field for Filtered {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        self.inner.values(points, values);
        let own: Vec<Sample> = values.iter().map(|&value| Sample { value, gradient: DVec3::ZERO }).collect();
        let (places, spread) = self.spread(points, &own);
        let mut room = Room::default();
        let filtered = self.near(&spread).flat_map(|near| self.filter(near, &mut room));
        places.into_iter().zip(filtered).for_each(|(k, value)| values[k] = value);
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        self.inner.samples(points, samples);
        let (places, spread) = self.spread(points, samples);
        let room = &mut Room::default();
        let filtered: Vec<Sample> = if self.around.more.is_empty() {
            self.near(&spread).flat_map(|near| self.filter_samples(near, &self.around.first, room)).collect()
        } else {
            let mut one = |at: &Spread| {
                let all = self.all_at(at, room);
                self.filter_samples(std::slice::from_ref(at), &all, room)[0]
            };
            spread.iter().map(&mut one).collect()
        };
        places.into_iter().zip(filtered).for_each(|(k, sample)| samples[k] = sample);
    }

    fn range(&self, ball: &Ball) -> Range {
        let own = self.inner.range(ball);
        let most = own.abs().max;
        let size = if most.is_finite() { self.size(most).0 } else { 1.0 };
        let reached = self.inner.range(&Ball { radius: ball.radius + size * self.around.farthest, ..*ball });
        // Unsigned samples with the sign of the point.
        let most = reached.abs().max;
        let reached = if self.sign_safe { Range { min: -most, max: most } } else { reached };
        // On one side of the surface no sample is on the other, where the field is nowhere steeper than a distance.
        let held = self.sign_safe || self.inner.lipschitz() <= 1.0;
        let side = if !held {
            Range::ALL
        } else if own.min > 0.0 {
            Range { min: 0.0, max: f64::INFINITY }
        } else if own.max < 0.0 {
            Range { min: f64::NEG_INFINITY, max: 0.0 }
        } else {
            Range::ALL
        };
        // The mean of the values is as far from the value as the mean displacement at most.
        let off = self.inner.lipschitz() * size * self.around.mean;
        reached.and(side).and(own.plus(Range::around(0.0, off)))
    }

    fn lipschitz(&self) -> f64 {
        let steep = self.inner.lipschitz();
        steep * (1.0 + self.around.mean * steep * 1.5 / self.cap)
    }

    fn extent(&self) -> Extent {
        self.inner.extent()
    }

    fn source_triangle(&self, p: DVec3, within: f64) -> Option<SourceTriangle> {
        self.inner.source_triangle(p, within)
    }
}
