//! `--map`: what became of the surface, as a PLY file with a colour and a number for each triangle.

use std::path::Path;

use super::exit::Failure;
use super::session::Session;
use super::{output, side};
use crate::io::{self, Colours, FaceMap, LegendEntry};
use crate::mesh::TriMesh;
use crate::pipeline::{Opened, TriangleKind};

/// The colours of the kinds, by their numbers: blue-grey, orange, magenta, blue. Eyes that lack a kind of cones tell them apart, too (see the tests).
pub(super) const KINDS: [[u8; 3]; 4] = [[176, 190, 205], [230, 150, 20], [165, 15, 105], [45, 15, 180]];

/// Walls of canals, by their numbers; none looks like a kind.
pub(super) const CANALS: [[u8; 3]; 6] =
    [[0, 114, 178], [0, 158, 115], [240, 228, 66], [86, 180, 233], [60, 60, 60], [120, 70, 40]];

/// What a kind is, in a legend.
pub(super) fn meaning(kind: TriangleKind) -> String {
    let what = match kind {
        TriangleKind::Kept => "as it was in the input",
        TriangleKind::Cut => "pieces of the input's triangles",
        TriangleKind::Rebuilt => "surface of the input, made anew",
        TriangleKind::MadeUp => "no surface of the input there",
    };
    format!("{}: {what}", kind.word())
}

/// The colour of each triangle by its kind.
pub(super) fn colours(kinds: &[TriangleKind]) -> Colours {
    let colour = |&kind: &TriangleKind| {
        let [r, g, b] = KINDS[kind as usize];
        [r, g, b, 255]
    };
    Colours::Faces(kinds.iter().map(colour).collect())
}

/// What is drawn.
pub struct Map<'a> {
    pub mesh: &'a TriMesh,
    /// What each triangle is.
    pub kinds: Vec<TriangleKind>,
    /// The canal that each triangle bounds, from 1; 0, or nothing at all, where it bounds none.
    pub canal_of: &'a [u32],
}

impl<'a> Map<'a> {
    /// The same with holes open again, of a result without canals.
    pub fn opened(self, opened: Option<&'a Opened>) -> Self {
        let Some(Opened { mesh, triangles }) = opened else { return self };
        let kinds = triangles.iter().map(|&t| self.kinds[t as usize]).collect();
        Self { mesh, kinds, ..self }
    }
}

/// Writes the result coloured by what its triangles are, and by the canals that they bound.
pub fn write(path: &Path, map: &Map<'_>, session: &Session) -> Result<(), Failure> {
    let Map { mesh, kinds, canal_of } = map;
    session.progress.check()?;
    let numbers: Vec<u32> = kinds.iter().map(|&kind| kind as u32).collect();
    let canal = |t: usize| canal_of.get(t).copied().filter(|&canal| canal > 0);
    let colour = |(t, &kind): (usize, &u32)| match canal(t) {
        Some(canal) => CANALS[(canal as usize - 1) % CANALS.len()],
        None => KINDS[kind as usize],
    };
    let colours: Vec<[u8; 3]> = numbers.iter().enumerate().map(colour).collect();
    let canals: Vec<u32> = (0..numbers.len()).map(|t| canal(t).unwrap_or(0)).collect();
    let most = canals.iter().copied().max().unwrap_or(0);
    let mut properties: Vec<(&str, &[u32])> = vec![("kind", &numbers)];
    if most > 0 {
        properties.push(("canal", &canals));
    }
    let words = TriangleKind::ALL.map(|kind| format!("{} {}", kind as u32, kind.word()));
    let comments = [format!("kind of a face: {}", words.join(", "))];
    let map = FaceMap { colours: &colours, numbers: &properties, legend: &legend(most), comments: &comments };
    let mut bytes = Vec::new();
    io::encode_face_map(mesh, &map, &mut bytes).map_err(|error| output::unencoded(path, &error))?;
    side::write_side(path, &bytes, session)
}

/// What the colours mean; there are as many canals.
fn legend(canals: u32) -> Vec<LegendEntry> {
    let of_kinds = TriangleKind::BY_CHANGE.iter().map(|&kind| (KINDS[kind as usize], meaning(kind)));
    let of_canals = (0..CANALS.len() as u32).take(canals as usize).map(|n| {
        let same: Vec<String> = (n..canals).step_by(CANALS.len()).take(4).map(|c| (c + 1).to_string()).collect();
        (CANALS[n as usize], format!("{} {}", if same.len() > 1 { "canals" } else { "canal" }, same.join(", ")))
    });
    of_kinds.chain(of_canals).map(|(colour, text)| LegendEntry { colour, text }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::eyes::{EYES, apart};

    #[test]
    fn every_eye_tells_the_kinds_apart() {
        for eye in &EYES {
            for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
                let apart = apart(KINDS[i], KINDS[j], eye);
                assert!(apart > 25.0, "{i} and {j} are {apart} apart for {eye:?}");
            }
            for canal in CANALS {
                let nearest = KINDS.map(|kind| apart(kind, canal, eye));
                assert!(
                    nearest.iter().all(|apart| *apart > 8.0),
                    "{canal:?} is {nearest:?} from the kinds for {eye:?}"
                );
            }
        }
    }

    #[test]
    fn canals_of_one_colour_share_an_entry() {
        let texts = |canals| legend(canals).into_iter().map(|entry| entry.text).skip(4).collect::<Vec<_>>();
        assert_eq!(texts(0), Vec::<String>::new());
        assert_eq!(texts(2), ["canal 1", "canal 2"]);
        assert_eq!(texts(7)[..2], ["canals 1, 7", "canal 2"]);
        assert_eq!(texts(100).len(), CANALS.len());
    }
}
