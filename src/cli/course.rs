//! How far a run is: its stages in words people know, a share that never goes back, and the time that is left.

use std::time::Duration;

use super::words;

/// What each stage is called on the terminal.
const WORDS: [(&str, &str); 31] = [
    ("read", "reading"),
    ("examine", "looking for defects"),
    ("orient", "finding the outer sides"),
    ("shells", "taking the bodies apart"),
    ("ldi", "casting rays through the model"),
    ("spans", "finding the walls along the rays"),
    ("vote", "telling inside from outside"),
    ("sdf", "measuring distances"),
    ("contour", "making the new surface"),
    ("collapse", "joining small triangles"),
    ("fit", "fitting edges, saving triangles"),
    ("offset", "moving the surface"),
    ("first offset", "moving the surface"),
    ("second offset", "moving the surface back"),
    ("thin walls", "looking for thin walls"),
    ("canals", "looking for canals"),
    ("distance", "measuring distances"),
    ("levels", "closing outlines, plane by plane"),
    ("field", "working out the expression"),
    ("compare", "comparing"),
    ("map", "colouring the map"),
    ("draw", "drawing the picture"),
    ("write", "writing"),
    ("verify", "checking the written file"),
    ("write and verify", "writing and checking the file"),
    ("thickness", "measuring walls and gaps"),
    ("hollow", "making the cavity"),
    ("subtract", "cutting"),
    ("decimate", "taking triangles away"),
    ("split", "taking bodies apart"),
    ("list", "looking for graphics adapters"),
];

/// A stage in words.
pub fn in_words(stage: &str) -> &'static str {
    WORDS.iter().find(|(name, _)| *name == stage).map_or("working", |(_, words)| words)
}

/// The stages of a repair and about what share of its time each takes, percent (the Stanford bunny at 256, file to file).
const SOLID: [(&str, f64); 13] = [
    ("read", 2.0),
    ("examine", 4.0),
    ("orient", 2.0),
    ("shells", 2.0),
    ("ldi", 6.0),
    ("spans", 1.0),
    ("vote", 11.0),
    ("sdf", 8.0),
    ("contour", 5.0),
    ("collapse", 12.0),
    ("fit", 38.0),
    ("write", 2.0),
    ("verify", 7.0),
];

/// What comes after the solid, before it is written.
fn after_the_solid(verb: &str) -> &'static [(&'static str, f64)] {
    match verb {
        "dilate" | "erode" => &[("offset", 60.0), ("fit", 60.0)],
        "open" | "close" => &[("first offset", 90.0), ("second offset", 90.0), ("fit", 60.0)],
        "canals" => &[("first offset", 90.0), ("second offset", 90.0), ("canals", 60.0), ("fit", 60.0)],
        "thicken" => &[("thin walls", 60.0), ("fit", 60.0)],
        "hollow" => &[("hollow", 5.0), ("offset", 60.0), ("fit", 60.0), ("subtract", 20.0)],
        _ => &[],
    }
}

/// The stages of a verb, in order, with their weights.
fn stages_of(verb: &str) -> Vec<(&'static str, f64)> {
    match verb {
        "sdf" => {
            let field = [("orient", 2.0), ("ldi", 10.0), ("spans", 2.0), ("vote", 15.0), ("levels", 5.0)];
            let ends = [("distance", 40.0), ("write", 15.0), ("verify", 10.0)];
            [("read", 3.0), ("examine", 10.0)].into_iter().chain(field).chain(ends).collect()
        }
        "field" => stages_of_field(1),
        "inspect" => vec![("read", 20.0), ("examine", 50.0), ("orient", 5.0), ("ldi", 50.0), ("spans", 20.0)],
        "compare" => vec![("read", 10.0), ("compare", 60.0), ("map", 30.0)],
        "decimate" => vec![("read", 5.0), ("decimate", 70.0), ("compare", 15.0), ("write", 4.0), ("verify", 6.0)],
        "split" => vec![("read", 20.0), ("split", 30.0), ("write", 25.0), ("verify", 25.0)],
        "convert" => vec![("read", 40.0), ("write", 30.0), ("verify", 30.0)],
        "render" => vec![("read", 20.0), ("draw", 80.0)],
        _ => {
            let (made, written) = SOLID.split_at(SOLID.len() - 2);
            made.iter().chain(after_the_solid(verb)).chain(written).copied().collect()
        }
    }
}

/// The stages of `field` for so many results.
fn stages_of_field(frames: usize) -> Vec<(&'static str, f64)> {
    const FRAME: [(&str, f64); 5] =
        [("field", 40.0), ("collapse", 10.0), ("fit", 35.0), ("write", 3.0), ("verify", 7.0)];
    let frames = (0..frames.max(1)).flat_map(|_| FRAME);
    // Broken operands are repaired first.
    let (repaired, _) = SOLID.split_at(SOLID.len() - 2);
    repaired.iter().map(|&(name, weight)| (name, 0.4 * weight)).chain(frames).collect()
}

/// Stages that are never left out: what is found beyond one that has not begun belongs to something that comes again.
const GATES: [&str; 6] = ["field", "offset", "first offset", "second offset", "thin walls", "distance"];

/// A run whose stages are about these takes so long, seconds, until it has shown how fast it is.
const GUESS: f64 = 20.0;

/// Less than this share says nothing of the whole.
const TELLING: f64 = 0.04;

/// How far a run is. Times count from its start.
#[derive(Debug, Clone)]
pub struct Course {
    /// The stages with where each begins and ends, shares of the whole.
    stages: Vec<(&'static str, f64, f64)>,
    /// The first stage that may still come, or that is on.
    at: usize,
    /// Whether one has begun.
    begun: bool,
    /// Words for the stage that is on.
    words: &'static str,
    /// Where it began and where it will end, shares of the whole.
    from: f64,
    to: f64,
    /// When it began.
    since: Duration,
    /// What it has told of itself.
    share: Option<f64>,
}

impl Course {
    /// Of a verb.
    pub fn of(verb: &str) -> Self {
        Self::along(&stages_of(verb))
    }

    /// Of `field` with so many results.
    pub fn of_frames(frames: usize) -> Self {
        Self::along(&stages_of_field(frames))
    }

    fn along(weights: &[(&'static str, f64)]) -> Self {
        let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
        let mut end = 0.0;
        let stages = weights.iter().map(|&(name, weight)| {
            let begin = end;
            end += weight / total;
            (name, begin, end)
        });
        let stages = stages.collect();
        let (words, since) = ("starting", Duration::ZERO);
        Self { stages, at: 0, begun: false, words, from: 0.0, to: 0.0, since, share: None }
    }

    /// A stage begins. One that is not expected any more (voxels are halved, and all comes again) goes on where the run is.
    pub fn begin(&mut self, stage: &str, now: Duration) {
        let here = self.position(now);
        self.words = in_words(stage);
        let next = if self.begun { self.at + 1 } else { self.at };
        let ahead = self.stages.iter().skip(next);
        let wall = ahead.clone().position(|(name, ..)| GATES.contains(name)).unwrap_or(usize::MAX);
        let coming = ahead.clone().position(|(name, ..)| *name == stage).filter(|&n| n <= wall).map(|n| next + n);
        if let Some((_, begin, end)) = coming.map(|n| self.stages[n]) {
            (self.at, self.begun) = (coming.unwrap_or(self.at), true);
            (self.from, self.to) = (here.max(begin), end.max(here));
        } else {
            self.from = here;
        }
        (self.since, self.share) = (now, None);
    }

    /// The stage tells how much of it is done.
    pub fn share(&mut self, share: f32, now: Duration) {
        let done = self.within(now).max(f64::from(share).clamp(0.0, 1.0));
        self.share = Some(done);
    }

    /// The share of the whole that is done; it never falls as `now` and the events go on.
    pub fn position(&self, now: Duration) -> f64 {
        self.from + (self.to - self.from) * self.within(now)
    }

    /// The share of the stage that is done: as it says, or else by the speed of the run so far, and slower when it takes longer.
    fn within(&self, now: Duration) -> f64 {
        if let Some(share) = self.share {
            return share;
        }
        let spent = now.saturating_sub(self.since).as_secs_f64();
        let whole = if self.from > TELLING { self.since.as_secs_f64() / self.from } else { GUESS };
        let expected = (whole * (self.to - self.from)).max(1e-3);
        match spent / expected {
            early if early < 1.0 => 0.8 * early,
            late => 1.0 - 0.2 / late,
        }
    }

    /// Whole percents, below 100 as long as the run goes on.
    pub fn percent(&self, now: Duration) -> u32 {
        (100.0 * self.position(now)).floor().clamp(0.0, 99.0) as u32
    }

    /// The time that is left, as soon as anything can be said of it.
    pub fn left(&self, now: Duration) -> Option<Duration> {
        let done = self.position(now);
        let known = done > TELLING && now >= Duration::from_secs(2);
        known.then(|| now.mul_f64((1.0 - done) / done))
    }

    /// What is done now.
    pub fn words(&self) -> &'static str {
        self.words
    }

    /// `45 %, about 40 s left`.
    pub fn figures(&self, now: Duration) -> String {
        let left = self.left(now).map_or(String::new(), |left| format!(", about {} left", about(left)));
        format!("{} %{left}", self.percent(now))
    }

    /// A line for a log: `30 s: telling inside from outside, 45 %, about 40 s left`.
    pub fn line(&self, now: Duration) -> String {
        format!("{}: {}, {}", about(now), self.words, self.figures(now))
    }
}

/// A time as one says it.
fn about(time: Duration) -> String {
    let seconds = time.as_secs_f64().ceil() as usize;
    match seconds {
        0..100 => format!("{seconds} s"),
        100..6000 => format!("{} min", seconds.div_ceil(60)),
        _ => words::plural(seconds.div_ceil(3600), "hour"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::language;
    use crate::ldi::Expression;
    use crate::mesh::TriMesh;
    use crate::morphology::Operation;
    use crate::pipeline::{self, MorphologyOptions, Options, VoxelSize};
    use crate::progress::{Event, Progress};
    use glam::DVec3;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    use std::sync::{Arc, Mutex};

    const VERBS: [&str; 12] = [
        "repair", "csg", "dilate", "close", "canals", "thicken", "sdf", "field", "inspect", "compare", "convert",
        "render",
    ];

    #[test]
    fn whatever_is_announced_the_share_never_falls_and_stays_below_one() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(9);
        let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
        for round in 0..200 {
            let mut course = Course::of(VERBS[round % VERBS.len()]);
            let (mut now, mut most, mut percent) = (Duration::ZERO, 0.0, 0);
            for _ in 0..200 {
                now += Duration::from_millis(below(3000) as u64);
                match below(4) {
                    0 => course.begin(WORDS[below(WORDS.len())].0, now),
                    1 => course.share(below(150) as f32 / 100.0 - 0.2, now),
                    2 => course.begin("unheard of", now),
                    _ => {}
                }
                let position = course.position(now);
                assert!(position >= most && position <= 1.0 + 1e-12, "round {round}: {position} after {most}");
                assert!(course.percent(now) >= percent && course.percent(now) < 100, "round {round}");
                (most, percent) = (position, course.percent(now));
            }
        }
    }

    #[test]
    fn stages_in_their_order_lead_through_the_whole() {
        for verb in VERBS {
            let mut course = Course::of(verb);
            for (n, (stage, _)) in stages_of(verb).into_iter().enumerate() {
                let now = Duration::from_secs(n as u64);
                course.begin(stage, now);
                assert_eq!(course.words(), in_words(stage));
                course.share(1.0, now);
            }
            assert!((course.position(Duration::from_secs(60)) - 1.0).abs() < 1e-9, "{verb}");
        }
        let mut course = Course::of_frames(3);
        (0..3).for_each(|n| course.begin("field", Duration::from_secs(n)));
        assert!(course.position(Duration::from_secs(2)) > 0.6, "the third of three frames has begun");
    }

    #[test]
    fn what_comes_again_does_not_skip_what_is_to_come() {
        let again = ["orient", "shells", "ldi", "spans", "vote", "sdf", "contour", "collapse", "fit"];
        for (verb, gate) in [("field", "field"), ("close", "first offset"), ("thicken", "thin walls")] {
            let mut course = Course::of(verb);
            // Two operands are repaired, or voxels are halved.
            let stages = again.iter().chain(&again).enumerate();
            stages.for_each(|(n, stage)| course.begin(stage, Duration::from_secs(n as u64)));
            let before = course.position(Duration::from_secs(18));
            course.begin(gate, Duration::from_secs(18));
            course.share(1.0, Duration::from_secs(18));
            assert!(course.position(Duration::from_secs(18)) > before + 0.1, "{verb}");
        }
    }

    /// What a listener hears of real runs, as a course shows it.
    #[test]
    fn real_runs_go_forwards_in_words() {
        let corner = |n: usize| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) * 10.0;
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2]];
        let open_cube = TriMesh {
            positions: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        };
        let options = Options::new(VoxelSize::Along(24));
        let watched = |verb: &str, run: &dyn Fn(&Progress)| {
            let seen = Arc::new(Mutex::new((Course::of(verb), Vec::new())));
            let (hearing, start) = (seen.clone(), std::time::Instant::now());
            let progress = Progress::none().with_listener(move |event| {
                let (course, shown) = &mut *hearing.lock().expect("nobody panics");
                let now = start.elapsed();
                match event {
                    Event::Stage(stage) => course.begin(stage, now),
                    Event::Share(share) => course.share(share, now),
                }
                shown.push((course.position(now), course.words()));
            });
            run(&progress);
            let (_, shown) = seen.lock().expect("nobody panics").clone();
            assert!(shown.len() > 3, "{verb}: {shown:?}");
            assert!(shown.is_sorted_by(|a, b| a.0 <= b.0), "{verb}: {shown:?}");
            assert!(shown.iter().all(|(_, words)| *words != "working"), "{verb}: {shown:?}");
            assert!(shown[shown.len() - 1].0 > 0.1, "{verb}: {shown:?}");
        };
        watched("repair", &|progress| {
            pipeline::boolean(std::slice::from_ref(&open_cube), &Expression::Operand(0), &options, progress)
                .expect("a solid");
        });
        watched("close", &|progress| {
            let outcome = pipeline::repair(&open_cube, &options, progress).expect("a solid");
            let surface = options.surface();
            let options = MorphologyOptions { operation: Operation::Close, radius: 2.0, sharp: None, surface };
            pipeline::morphology(&outcome.solid, &options, progress).expect("a solid");
        });
        watched("field", &|progress| {
            let operands = [pipeline::FieldOperand::Mesh((&open_cube).into())];
            let node = language::parse("offset(a, 1)", &["a"]).expect("it can be read");
            let node = node.resolve(|value, _| Ok(value)).expect("lengths are numbers");
            let built = pipeline::FieldBuilder::new(&operands, &options, progress).build(&node).expect("a field");
            pipeline::field_surface(&built, &options, progress).expect("a surface");
        });
    }

    #[test]
    fn every_stage_that_the_program_announces_has_words() {
        fn announced(folder: &std::path::Path, found: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
                if entry.is_dir() {
                    announced(&entry, found);
                    continue;
                }
                let text = std::fs::read_to_string(&entry).expect("a source file");
                for call in [concat!(".beg", "in(\""), concat!(".sta", "ge(\"")] {
                    found.extend(text.split(call).skip(1).filter_map(|rest| Some(rest.split_once('"')?.0.to_string())));
                }
            }
        }
        let mut found = Vec::new();
        announced(std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")), &mut found);
        assert!(found.len() > 20, "{found:?}");
        found.retain(|stage| !["unheard of", "field"].contains(&stage.as_str()));
        let unnamed: Vec<&String> = found.iter().filter(|stage| in_words(stage) == "working").collect();
        assert!(unnamed.is_empty(), "{unnamed:?}");
    }

    #[test]
    fn the_time_that_is_left_is_told_when_it_can_be() {
        let mut course = Course::of("compare");
        course.begin("read", Duration::ZERO);
        assert_eq!(course.left(Duration::from_secs(1)), None);
        course.begin("compare", Duration::from_secs(10));
        course.share(0.5, Duration::from_secs(40));
        assert_eq!(course.line(Duration::from_secs(40)), "40 s: comparing, 40 %, about 60 s left");
        assert_eq!(
            [99, 100, 5999, 6000, 9000].map(|s| about(Duration::from_secs(s))),
            ["99 s", "2 min", "100 min", "2 hours", "3 hours"]
        );
    }
}
