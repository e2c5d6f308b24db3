//! The filtered field: means over the samples around each point.

use glam::DVec3;

use super::around::Around;
use super::kernel::Displacement;
use super::smoothstep;
use super::stored::{Recent, Stored};
use crate::field::{Ball, Extent, Field, Range, Sample, Shared, SourceTriangle};

/// Points that are displaced together.
const PACKET: usize = 8;
/// What counts as no displacement at all, over the cap.
const NOTHING: f64 = 1e-12;
/// The mean of the first samples is off by this part of the kernel's size on the medial axis of a plate: measured for the
/// bump, 0.23 at its widest.
const MEDIAL: f64 = 0.2;
/// Ranges of larger balls than this, over the cap, ask the field itself: it need not be remembered so far away.
const SMALL: f64 = 0.25;
/// Up to this distance, over the cap, the field is asked for each sample; from the second on values are interpolated; between
/// them one way passes into the other.
const NEAR: f64 = 0.4;
const FAR: f64 = 0.5;
/// More than interpolated means are ever off, over the cap, for ranges to hold.
const MARGIN: f64 = 4e-3;

/// A field under the filter.
pub(super) struct Filtered {
    pub inner: Shared,
    /// The same, interpolated, where the samples are not asked one by one.
    pub stored: Option<Stored>,
    pub around: Around,
    pub cap: f64,
    pub sign_safe: bool,
}

/// A point where the kernel has a size.
#[derive(Clone, Copy)]
struct Spread {
    p: DVec3,
    /// The field before it is filtered.
    own: Sample,
    /// What is interpolated, and nothing where the field is asked.
    far: bool,
    /// The size of the kernel, and how it grows with the field.
    size: f64,
    growth: f64,
}

/// What the samples of one point are kept in.
#[derive(Default)]
struct Room {
    points: Vec<DVec3>,
    values: Vec<f64>,
    samples: Vec<Sample>,
    recent: Recent,
}

impl Room {
    /// All points displaced by the first sample, then by the next: so displaced they stay as near each other as they are.
    fn displace(&mut self, points: &[Spread], displacements: &[Displacement]) {
        self.points.clear();
        self.points.extend(displacements.iter().flat_map(|d| points.iter().map(|at| at.p - d.by * at.size)));
        self.values.resize(self.points.len(), 0.0);
        self.samples.resize(self.points.len(), Sample::default());
    }
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

    /// The same with its gradient.
    fn counted_sample(&self, sample: Sample, sign: f64) -> Sample {
        let value = self.counted(sample.value, sign);
        Sample { value, gradient: if value == sample.value { sample.gradient } else { -sample.gradient } }
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
        self.look_up(points, room);
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
        self.look_up_samples(points, room);
        let mut sums = vec![Sample::default(); points.len()];
        for (d, samples) in displacements.iter().zip(room.samples.chunks_exact(points.len().max(1))) {
            for ((sum, &sample), at) in sums.iter_mut().zip(samples).zip(points) {
                let Sample { value, gradient } = self.counted_sample(sample, at.own.value.signum());
                sum.value += value * d.weight;
                sum.gradient += (gradient - at.own.gradient * (at.growth * gradient.dot(d.by))) * d.weight;
            }
        }
        sums
    }

    /// The values at the displaced points, all by the way of the first.
    fn look_up(&self, points: &[Spread], room: &mut Room) {
        match self.interpolates(points) {
            Some(stored) => room.points.iter().zip(&mut room.values).for_each(|(&p, value)| {
                *value = stored.value(p, &mut room.recent).unwrap_or_else(|| self.inner.value(p));
            }),
            None => self.inner.values(&room.points, &mut room.values),
        }
    }

    fn look_up_samples(&self, points: &[Spread], room: &mut Room) {
        match self.interpolates(points) {
            Some(stored) => room.points.iter().zip(&mut room.samples).for_each(|(&p, sample)| {
                *sample = stored.sample(p, &mut room.recent).unwrap_or_else(|| self.inner.sample(p));
            }),
            None => self.inner.samples(&room.points, &mut room.samples),
        }
    }

    fn interpolates(&self, points: &[Spread]) -> Option<&Stored> {
        self.stored.as_ref().filter(|_| points.first().is_some_and(|at| at.far))
    }

    /// How much of a filtered value is by interpolation, and how that grows with the field.
    fn share(&self, value: f64) -> (f64, f64) {
        if self.stored.is_none() {
            return (0.0, 0.0);
        }
        let (share, growth) = smoothstep((value.abs() / self.cap - NEAR) / (FAR - NEAR));
        (share, growth * value.signum() / (self.cap * (FAR - NEAR)))
    }

    /// What was asked and what was interpolated, by their shares.
    fn mixed(&self, asked: Sample, interpolated: Sample, own: &Sample) -> Sample {
        let (share, growth) = self.share(own.value);
        if share == 1.0 {
            return interpolated;
        }
        let off = interpolated.value - asked.value;
        let gradient = asked.gradient.lerp(interpolated.gradient, share) + own.gradient * (growth * off);
        Sample { value: asked.value + off * share, gradient }
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

    /// The points where the kernel spreads and the field is asked, or those where it is interpolated.
    fn spread(&self, points: &[DVec3], own: &[Sample], far: bool) -> (Vec<usize>, Vec<Spread>) {
        let counts = |value: f64| if far { self.share(value).0 > 0.0 } else { self.share(value).0 < 1.0 };
        let spread = (0..points.len()).filter(|&k| self.spreads(own[k].value) && counts(own[k].value)).map(|k| {
            let (size, growth) = self.size(own[k].value);
            (k, Spread { p: points[k], own: own[k], far, size, growth })
        });
        spread.unzip()
    }

    /// The field at `points`: where it is surely beyond the cap, what is interpolated stands for it, since the kernel has its
    /// full size all over there.
    fn own(&self, points: &[DVec3], recent: &mut Recent, ask: impl Fn(&[DVec3]) -> Vec<Sample>) -> Vec<Sample> {
        let Some(stored) = self.stored.as_ref().filter(|_| self.inner.lipschitz() <= 1.0) else { return ask(points) };
        let surely = self.cap + stored.off();
        let known: Vec<Option<Sample>> = points
            .iter()
            .map(|&p| stored.sample(p, recent).filter(|sample| sample.value.abs() > surely && sample.value.is_finite()))
            .collect();
        let asked: Vec<DVec3> =
            points.iter().zip(&known).filter(|(_, known)| known.is_none()).map(|(&p, _)| p).collect();
        let mut found = ask(&asked).into_iter();
        known.into_iter().map(|known| known.or_else(|| found.next()).unwrap_or_default()).collect()
    }

    /// The range of the field before it is filtered.
    fn own_range(&self, ball: &Ball) -> Range {
        let steep = self.inner.lipschitz();
        let small = ball.radius < SMALL * self.cap && steep.is_finite();
        let stored = self.stored.as_ref().filter(|_| small);
        let known = stored.and_then(|stored| {
            let value = stored.value(ball.centre, &mut Recent::default()).filter(|value| value.is_finite())?;
            Some(Range::around(value, steep * (ball.radius + stored.off())))
        });
        known.unwrap_or_else(|| self.inner.range(ball))
    }

    /// More than a filtered value may be off, model units.
    fn margin(&self) -> f64 {
        if self.stored.is_some() { MARGIN * self.cap } else { 0.0 }
    }

    /// The range by the filtered value in the middle, where that says more than how far the mean can be `off`.
    fn range_by_middle(&self, ball: &Ball, own: Range, off: f64) -> Range {
        let least = own.abs().min;
        let one_side = least > 0.0;
        if !self.around.more.is_empty() || (self.sign_safe && !one_side) {
            return Range::ALL;
        }
        let inner = self.inner.lipschitz();
        // From the cap on the kernel does not grow.
        let growth = if least >= self.cap { 0.0 } else { STEEPEST / self.cap };
        let steep = inner * (1.0 + self.around.mean * inner * growth);
        let by = steep * ball.radius + 2.0 * self.margin();
        if by < off / 2.0 { Range::around(self.value(ball.centre), by) } else { Range::ALL }
    }
}

/// How much the kernel's size grows at most while the field grows by the cap.
const STEEPEST: f64 = 1.5;

impl Field for Filtered {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        let room = &mut Room::default();
        let own = self.own(points, &mut room.recent, |points| {
            let mut values = vec![0.0; points.len()];
            self.inner.values(points, &mut values);
            values.into_iter().map(|value| Sample { value, gradient: DVec3::ZERO }).collect()
        });
        values.iter_mut().zip(&own).for_each(|(value, own)| *value = own.value);
        for far in [false, true] {
            let (places, spread) = self.spread(points, &own, far);
            let filtered = self.near(&spread).flat_map(|near| self.filter(near, room));
            for (k, value) in places.into_iter().zip(filtered) {
                let share = self.share(own[k].value).0;
                values[k] = if far { values[k] + (value - values[k]) * share } else { value };
            }
        }
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        let room = &mut Room::default();
        let own = self.own(points, &mut room.recent, |points| {
            let mut samples = vec![Sample::default(); points.len()];
            self.inner.samples(points, &mut samples);
            samples
        });
        samples.copy_from_slice(&own);
        for far in [false, true] {
            let (places, spread) = self.spread(points, &own, far);
            let filtered: Vec<Sample> = if self.around.more.is_empty() {
                self.near(&spread).flat_map(|near| self.filter_samples(near, &self.around.first, room)).collect()
            } else {
                let mut one = |at: &Spread| {
                    let all = self.all_at(at, room);
                    self.filter_samples(std::slice::from_ref(at), &all, room)[0]
                };
                spread.iter().map(&mut one).collect()
            };
            for (k, found) in places.into_iter().zip(filtered) {
                samples[k] = if far { self.mixed(samples[k], found, &own[k]) } else { found };
            }
        }
    }

    fn range(&self, ball: &Ball) -> Range {
        let own = self.own_range(ball);
        let most = own.abs().max;
        let size = if most.is_finite() { self.size(most).0 } else { 1.0 };
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
        let range = if off.is_finite() {
            // What is remembered may be off besides.
            own.plus(Range::around(0.0, off + self.margin()))
        } else {
            let reached = self.inner.range(&Ball { radius: ball.radius + size * self.around.farthest, ..*ball });
            // Unsigned samples with the sign of the point.
            let most = reached.abs().max;
            if self.sign_safe { Range { min: -most, max: most } } else { reached }
        };
        range.and(side).and(self.range_by_middle(ball, own, off))
    }

    fn lipschitz(&self) -> f64 {
        let steep = self.inner.lipschitz();
        steep * (1.0 + self.around.mean * steep * STEEPEST / self.cap)
    }

    fn extent(&self) -> Extent {
        self.inner.extent()
    }

    fn source_triangle(&self, p: DVec3, within: f64) -> Option<SourceTriangle> {
        self.inner.source_triangle(p, within)
    }
}
