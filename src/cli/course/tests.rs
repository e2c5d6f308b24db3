use super::super::weights::{of_distances, of_solid};
use super::*;
use crate::field::language;
use crate::fit::FitOptions;
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::morphology::Operation;
use crate::pipeline::Work;
use crate::pipeline::{self, MorphologyOptions, Options, VoxelSize};
use crate::progress::{Event, Progress};
use glam::DVec3;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::sync::{Arc, Mutex};

/// Any stages, those that no verb expects among them.
const ANY: [Stage; 12] = [
    Stage::Read,
    Stage::Orient,
    Stage::Ldi,
    Stage::Vote,
    Stage::Fit,
    Stage::Offset,
    Stage::SecondOffset,
    Stage::ThinWalls,
    Stage::Field,
    Stage::Write,
    Stage::Thickness,
    Stage::List,
];

const VERBS: [&str; 12] = [
    "repair", "csg", "dilate", "close", "canals", "thicken", "sdf", "field", "inspect", "compare", "convert", "render",
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
                0 => course.begin(ANY[below(ANY.len())], now),
                1 => course.share(below(150) as f32 / 100.0 - 0.2, now),
                2 => course.expect(&stages_of(VERBS[below(VERBS.len())]), now),
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
    (0..3).for_each(|n| course.begin(Stage::Field, Duration::from_secs(n)));
    assert!(course.position(Duration::from_secs(2)) > 0.6, "the third of three frames has begun");
}

#[test]
fn what_comes_again_does_not_skip_what_is_to_come() {
    let again = [
        Stage::Orient,
        Stage::Shells,
        Stage::Ldi,
        Stage::Spans,
        Stage::Vote,
        Stage::Sdf,
        Stage::Contour,
        Stage::Collapse,
        Stage::Fit,
    ];
    for (verb, gate) in [("field", Stage::Field), ("close", Stage::FirstOffset), ("thicken", Stage::ThinWalls)] {
        let mut course = Course::of(verb);
        // Two operands are repaired, or voxels are halved.
        let stages = again.iter().chain(&again).enumerate();
        stages.for_each(|(n, stage)| course.begin(*stage, Duration::from_secs(n as u64)));
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
fn the_time_that_is_left_is_told_when_it_can_be() {
    let mut course = Course::of("compare");
    course.begin(Stage::Read, Duration::ZERO);
    assert_eq!(course.left(Duration::from_secs(1)), None);
    course.begin(Stage::Compare, Duration::from_secs(10));
    course.share(0.5, Duration::from_secs(40));
    assert_eq!(course.line(Duration::from_secs(40)), "40 s: comparing, 40 %, about 60 s left");
    assert_eq!(
        [99, 100, 5999, 6000, 9000].map(|s| about(Duration::from_secs(s))),
        ["99 s", "2 min", "100 min", "2 hours", "3 hours"]
    );
}

/// Milliseconds of the stages of runs on `testdata/broken_mug.obj` at 96 voxels, as their reports tell them.
const RECORDED: [(&str, &[(Stage, u64)]); 21] = [
    (
        "repair",
        &[
            (Stage::Read, 1),
            (Stage::Examine, 74),
            (Stage::Orient, 31),
            (Stage::Shells, 40),
            (Stage::Ldi, 176),
            (Stage::Spans, 39),
            (Stage::Vote, 544),
            (Stage::Sdf, 271),
            (Stage::Contour, 227),
            (Stage::Collapse, 724),
            (Stage::Fit, 3491),
            (Stage::WriteAndVerify, 228),
        ],
    ),
    (
        "dilate",
        &[
            (Stage::Read, 1),
            (Stage::Examine, 58),
            (Stage::Orient, 44),
            (Stage::Shells, 16),
            (Stage::Ldi, 129),
            (Stage::Spans, 41),
            (Stage::Vote, 820),
            (Stage::Sdf, 278),
            (Stage::Contour, 225),
            (Stage::Collapse, 989),
            (Stage::Fit, 3731),
            (Stage::Offset, 3197),
            (Stage::Fit, 14801),
            (Stage::WriteAndVerify, 702),
        ],
    ),
    (
        "union",
        &[
            (Stage::Read, 80),
            (Stage::Examine, 248),
            (Stage::Orient, 50),
            (Stage::Shells, 277),
            (Stage::Ldi, 393),
            (Stage::Spans, 110),
            (Stage::Vote, 1106),
            (Stage::Sdf, 235),
            (Stage::Contour, 316),
            (Stage::Collapse, 1190),
            (Stage::Fit, 11812),
            (Stage::WriteAndVerify, 417),
        ],
    ),
    (
        "intersection",
        &[
            (Stage::Read, 4),
            (Stage::Examine, 309),
            (Stage::Orient, 23),
            (Stage::Shells, 298),
            (Stage::Ldi, 480),
            (Stage::Spans, 129),
            (Stage::Vote, 1195),
            (Stage::Sdf, 383),
            (Stage::Contour, 156),
            (Stage::Collapse, 1273),
            (Stage::Fit, 15720),
            (Stage::WriteAndVerify, 468),
        ],
    ),
    ("difference", &[(Stage::Read, 79), (Stage::Examine, 560)]),
    (
        "csg",
        &[
            (Stage::Read, 41),
            (Stage::Examine, 207),
            (Stage::Orient, 32),
            (Stage::Shells, 209),
            (Stage::Ldi, 448),
            (Stage::Spans, 108),
            (Stage::Vote, 1167),
            (Stage::Sdf, 383),
            (Stage::Contour, 252),
            (Stage::Collapse, 1162),
            (Stage::Fit, 9164),
            (Stage::WriteAndVerify, 1096),
        ],
    ),
    (
        "erode",
        &[
            (Stage::Read, 2),
            (Stage::Examine, 106),
            (Stage::Orient, 33),
            (Stage::Shells, 31),
            (Stage::Ldi, 124),
            (Stage::Spans, 54),
            (Stage::Vote, 727),
            (Stage::Sdf, 440),
            (Stage::Contour, 316),
            (Stage::Collapse, 995),
            (Stage::Fit, 4840),
            (Stage::Offset, 1917),
            (Stage::Fit, 12260),
            (Stage::WriteAndVerify, 409),
        ],
    ),
    (
        "open",
        &[
            (Stage::Read, 22),
            (Stage::Examine, 75),
            (Stage::Orient, 29),
            (Stage::Shells, 67),
            (Stage::Ldi, 196),
            (Stage::Spans, 38),
            (Stage::Vote, 724),
            (Stage::Sdf, 340),
            (Stage::Contour, 275),
            (Stage::Collapse, 949),
            (Stage::Fit, 4412),
            (Stage::FirstOffset, 28952),
            (Stage::SecondOffset, 22293),
            (Stage::Fit, 18084),
            (Stage::WriteAndVerify, 286),
        ],
    ),
    (
        "close",
        &[
            (Stage::Read, 1),
            (Stage::Examine, 59),
            (Stage::Orient, 3),
            (Stage::Shells, 64),
            (Stage::Ldi, 140),
            (Stage::Spans, 33),
            (Stage::Vote, 624),
            (Stage::Sdf, 264),
            (Stage::Contour, 251),
            (Stage::Collapse, 818),
            (Stage::Fit, 4518),
            (Stage::FirstOffset, 10971),
            (Stage::SecondOffset, 7251),
            (Stage::Fit, 9660),
            (Stage::WriteAndVerify, 261),
        ],
    ),
    (
        "canals",
        &[
            (Stage::Read, 2),
            (Stage::Examine, 82),
            (Stage::Orient, 2),
            (Stage::Shells, 18),
            (Stage::Ldi, 124),
            (Stage::Spans, 47),
            (Stage::Vote, 686),
            (Stage::Sdf, 275),
            (Stage::Contour, 231),
            (Stage::Collapse, 925),
            (Stage::Fit, 3637),
            (Stage::FirstOffset, 9842),
            (Stage::Canals, 1717),
        ],
    ),
    (
        "thicken",
        &[
            (Stage::Read, 1),
            (Stage::Examine, 26),
            (Stage::Orient, 201),
            (Stage::Shells, 773),
            (Stage::Ldi, 441),
            (Stage::Spans, 81),
            (Stage::Vote, 180),
            (Stage::Sdf, 274),
            (Stage::Contour, 81),
            (Stage::Collapse, 689),
            (Stage::Fit, 14022),
            (Stage::ThinWalls, 8175),
            (Stage::Offset, 12013),
            (Stage::Fit, 31308),
            (Stage::WriteAndVerify, 364),
        ],
    ),
    (
        "hollow",
        &[
            (Stage::Read, 2),
            (Stage::Examine, 22),
            (Stage::Orient, 4),
            (Stage::Shells, 24),
            (Stage::Ldi, 87),
            (Stage::Spans, 14),
            (Stage::Vote, 473),
            (Stage::Sdf, 187),
            (Stage::Contour, 195),
            (Stage::Collapse, 548),
            (Stage::Fit, 3067),
            (Stage::Hollow, 7304),
            (Stage::Subtract, 267),
            (Stage::WriteAndVerify, 181),
        ],
    ),
    (
        "sdf",
        &[
            (Stage::Read, 2),
            (Stage::Examine, 46),
            (Stage::Orient, 17),
            (Stage::Ldi, 115),
            (Stage::Spans, 28),
            (Stage::Vote, 470),
            (Stage::Distance, 116),
            (Stage::WriteAndVerify, 26),
        ],
    ),
    (
        "field",
        &[
            (Stage::Read, 9),
            (Stage::Examine, 171),
            (Stage::Field, 2417),
            (Stage::Collapse, 143),
            (Stage::Fit, 4335),
            (Stage::WriteAndVerify, 116),
        ],
    ),
    ("inspect", &[(Stage::Read, 2), (Stage::Examine, 53), (Stage::Thickness, 332)]),
    ("compare", &[(Stage::Read, 9), (Stage::Compare, 543), (Stage::Map, 27)]),
    ("decimate", &[(Stage::Read, 3), (Stage::Decimate, 282), (Stage::Compare, 102), (Stage::WriteAndVerify, 15)]),
    ("split", &[(Stage::Read, 3), (Stage::Split, 13), (Stage::WriteAndVerify, 27)]),
    ("convert", &[(Stage::Read, 2), (Stage::WriteAndVerify, 4)]),
    ("render", &[(Stage::Read, 1), (Stage::Draw, 1321)]),
    ("devices", &[(Stage::List, 75)]),
];

/// Of runs that are on record, every bar goes forwards, whatever stages tell of themselves, and is full at the end.
#[test]
fn recorded_runs_of_every_verb_go_forwards_to_the_end() {
    let work = Work { triangles: 2_000, cells: 40_000.0 };
    for (verb, stages) in RECORDED {
        for telling in [false, true] {
            let mut course = Course::of(verb);
            let (mut now, mut most) = (Duration::ZERO, 0.0);
            let mut look = |course: &Course, now: Duration| {
                let position = course.position(now);
                assert!(position >= most && position <= 1.0, "{verb}: {position} after {most} at {now:?}");
                most = position;
            };
            for &(stage, milliseconds) in stages {
                match (stage, verb) {
                    (Stage::Orient, "sdf") => course.expect(&of_distances(work.triangles, 0.4, 4_000_000), now),
                    (Stage::Orient, _) => course.expect(&of_solid(verb, &work, Some(&FitOptions::default())), now),
                    _ => {}
                }
                look(&course, now);
                // A file is written and checked in one time of the report, and announced twice.
                let announced: &[Stage] = match stage {
                    Stage::WriteAndVerify => &[Stage::Write, Stage::Verify],
                    ref alone => std::slice::from_ref(alone),
                };
                for &stage in announced {
                    course.begin(stage, now);
                    for n in 1..=10_u32 {
                        now += Duration::from_millis(milliseconds) / 10 / announced.len() as u32;
                        if telling {
                            course.share(n as f32 / 10.0, now);
                        }
                        look(&course, now);
                    }
                }
            }
            assert!(course.percent(now) < 100, "{verb}");
            course.finish();
            look(&course, now);
            assert_eq!((course.position(now), course.percent(now)), (1.0, 100), "{verb}");
        }
    }
}

/// What is left is shared out by the plan: a run that is mostly fit is not nearly done when the fit begins.
#[test]
fn stages_are_weighed_by_the_plan() {
    let begun = |fit: &FitOptions, stage: Stage| {
        let work = Work { triangles: 1_000, cells: 200_000.0 };
        let mut course = Course::of("repair");
        course.begin(Stage::Read, Duration::ZERO);
        course.expect(&of_solid("repair", &work, Some(fit)), Duration::ZERO);
        course.begin(stage, Duration::ZERO);
        course.position(Duration::ZERO)
    };
    let (keeping, rebuilding) = (FitOptions::default(), FitOptions { rebuild: true, ..FitOptions::default() });
    assert!(begun(&rebuilding, Stage::Fit) < 0.3 && begun(&keeping, Stage::Fit) > 0.4);
    assert!(begun(&keeping, Stage::Write) > 0.95, "few triangles are written");
}
