//! About how long each stage of a verb takes, compared with the others.

use crate::fit::FitOptions;
use crate::pipeline::Work;
use crate::progress::Stage;

/// The stages of a repair and about what share of its time each takes, percent (the Stanford bunny at 256, file to file).
const SOLID: [(Stage, f64); 16] = [
    (Stage::Read, 2.0),
    (Stage::Examine, 4.0),
    (Stage::Orient, 2.0),
    (Stage::Shells, 2.0),
    (Stage::Zip, 0.5),
    (Stage::Fill, 2.0),
    (Stage::Arrange, 4.0),
    (Stage::Ldi, 6.0),
    (Stage::Spans, 1.0),
    (Stage::Vote, 11.0),
    (Stage::Sdf, 8.0),
    (Stage::Contour, 5.0),
    (Stage::Collapse, 12.0),
    (Stage::Fit, 38.0),
    (Stage::Write, 2.0),
    (Stage::Verify, 7.0),
];

/// What comes after the solid, before it is written.
fn after_the_solid(verb: &str) -> &'static [(Stage, f64)] {
    match verb {
        "dilate" | "erode" => &[(Stage::Offset, 60.0), (Stage::Fit, 60.0)],
        "open" | "close" => &[(Stage::FirstOffset, 90.0), (Stage::SecondOffset, 90.0), (Stage::Fit, 60.0)],
        "canals" => {
            &[(Stage::FirstOffset, 90.0), (Stage::SecondOffset, 90.0), (Stage::Canals, 60.0), (Stage::Fit, 60.0)]
        }
        "thicken" => &[(Stage::ThinWalls, 60.0), (Stage::Fit, 60.0)],
        "hollow" => &[(Stage::Hollow, 5.0), (Stage::Offset, 60.0), (Stage::Fit, 60.0), (Stage::Subtract, 20.0)],
        _ => &[],
    }
}

/// The stages of a verb, in order, with their weights.
pub fn stages_of(verb: &str) -> Vec<(Stage, f64)> {
    match verb {
        "sdf" => {
            let field = [
                (Stage::Orient, 2.0),
                (Stage::Ldi, 10.0),
                (Stage::Spans, 2.0),
                (Stage::Vote, 15.0),
                (Stage::Levels, 5.0),
            ];
            let ends = [(Stage::Distance, 40.0), (Stage::Write, 15.0), (Stage::Verify, 10.0)];
            [(Stage::Read, 3.0), (Stage::Examine, 10.0)].into_iter().chain(field).chain(ends).collect()
        }
        "field" => stages_of_field(1),
        "inspect" => vec![
            (Stage::Read, 20.0),
            (Stage::Examine, 50.0),
            (Stage::Arrange, 20.0),
            (Stage::Orient, 5.0),
            (Stage::Ldi, 50.0),
            (Stage::Spans, 20.0),
        ],
        "compare" => vec![(Stage::Read, 10.0), (Stage::Compare, 60.0), (Stage::Map, 30.0)],
        "decimate" => vec![
            (Stage::Read, 5.0),
            (Stage::Decimate, 70.0),
            (Stage::Compare, 15.0),
            (Stage::Write, 4.0),
            (Stage::Verify, 6.0),
        ],
        "split" => vec![(Stage::Read, 20.0), (Stage::Split, 30.0), (Stage::Write, 25.0), (Stage::Verify, 25.0)],
        "convert" => vec![(Stage::Read, 40.0), (Stage::Write, 30.0), (Stage::Verify, 30.0)],
        "render" => vec![(Stage::Read, 20.0), (Stage::Draw, 80.0)],
        _ => {
            let (made, written) = SOLID.split_at(SOLID.len() - 2);
            made.iter().chain(after_the_solid(verb)).chain(written).copied().collect()
        }
    }
}

/// The stages of `field` for so many results.
pub fn stages_of_field(frames: usize) -> Vec<(Stage, f64)> {
    const FRAME: [(Stage, f64); 5] =
        [(Stage::Field, 40.0), (Stage::Collapse, 10.0), (Stage::Fit, 35.0), (Stage::Write, 3.0), (Stage::Verify, 7.0)];
    let frames = (0..frames.max(1)).flat_map(|_| FRAME);
    // Broken operands are repaired first.
    let (repaired, _) = SOLID.split_at(SOLID.len() - 2);
    repaired.iter().map(|&(name, weight)| (name, 0.4 * weight)).chain(frames).collect()
}

/// Seconds per triangle, to write a file and to check it.
const WRITTEN: [(Stage, f64); 2] = [(Stage::Write, 0.4e-6), (Stage::Verify, 1.4e-6)];

/// Seconds per cell of surface for each percent that [`after_the_solid`] gives.
const PERCENT: f64 = 0.066e-6;

/// The stages of a verb that makes a solid and the seconds that each may take, from the orientation on.
pub fn of_solid(verb: &str, work: &Work, fit: Option<&FitOptions>) -> Vec<(Stage, f64)> {
    let solid = work.stages(fit).into_iter().map(|time| (time.stage, time.seconds));
    let after = after_the_solid(verb).iter().map(|&(stage, percent)| (stage, percent * PERCENT * work.cells));
    let made = if after.len() > 0 { work.made(None) } else { work.made(fit) };
    solid.chain(after).chain(WRITTEN.map(|(stage, seconds)| (stage, seconds * made))).collect()
}

/// The same of `sdf`, from the orientation on: `field` is how long its distances may take, and the file has so many bytes.
pub fn of_distances(triangles: usize, field: f64, bytes: u64) -> Vec<(Stage, f64)> {
    const SECONDS_PER_BYTE: f64 = 4e-9;
    let (triangles, file) = (triangles as f64, SECONDS_PER_BYTE * bytes as f64);
    let share = |share: f64| share * field;
    vec![
        (Stage::Orient, 0.4e-6 * triangles),
        (Stage::Ldi, share(0.15)),
        (Stage::Spans, share(0.03)),
        (Stage::Vote, share(0.2)),
        (Stage::Levels, share(0.05)),
        (Stage::Distance, share(0.57)),
        (Stage::Write, file),
        (Stage::Verify, file),
    ]
}
