//! The table of defects, and what became of each.

use glam::DVec3;

use crate::cli::holes;
use crate::cli::words::{self, UnitName, around};
use crate::mesh::Bounds;
use crate::page::{Cluster, DefectKind, Place, Row, Table};
use crate::pipeline::{HoleReport, Report};

use super::fates::Fates;
use super::ground::Ground;

/// At most so many places of a kind have a row each.
const EACH: usize = 8;

/// At most so many rows.
const MOST: usize = 150;

/// What is known of the defects of a run.
pub(super) struct Known<'a> {
    pub ground: &'a Ground,
    pub holes: &'a [HoleReport],
    pub pipeline: Option<&'a Report>,
    /// What became of triangles, where something was made.
    pub fates: Option<&'a Fates>,
    /// Whether something was made.
    pub made: bool,
    pub unit: UnitName<'a>,
}

impl Known<'_> {
    /// The table: holes first, then what else is wrong, then what is to be looked at.
    pub(super) fn table(&self) -> Table {
        let mut rows: Vec<Row> = self.holes.iter().map(|hole| self.hole(hole)).collect();
        for kind in DefectKind::ALL {
            let all: Vec<&(usize, Cluster)> =
                self.ground.clusters.iter().filter(|(input, c)| c.kind == kind && !self.is_told(*input, c)).collect();
            let (first, rest) = all.split_at(all.len().min(EACH));
            rows.extend(first.iter().map(|(input, cluster)| self.cluster(*input, cluster)));
            rows.extend(self.further(kind, rest));
        }
        rows.extend(self.pipeline.iter().flat_map(|pipeline| self.places(pipeline)));
        let more = rows.len().saturating_sub(MOST);
        rows.truncate(MOST);
        let last = if self.made { "What became of it" } else { "What repair would do" };
        let mut head: Vec<String> = ["Defect", "Of", "Around", "Across"].map(String::from).into();
        match self.made || !self.holes.is_empty() {
            true => head.push(last.into()),
            false => rows.iter_mut().for_each(|row| row.cells.truncate(4)),
        }
        Table { head, rows, more }
    }

    /// Whether a rim is in the table as a hole.
    fn is_told(&self, input: usize, cluster: &Cluster) -> bool {
        let near = |hole: &HoleReport| {
            let off = DVec3::from(hole.centre).distance(cluster.place.at);
            let same = (hole.perimeter - cluster.length).abs() <= 0.02 * cluster.length;
            hole.operand == input && off <= cluster.place.size / 2.0 && same
        };
        cluster.kind == DefectKind::OpenEdges && self.holes.iter().any(near)
    }

    /// Smaller places of a kind as one row.
    fn further(&self, kind: DefectKind, rest: &[&(usize, Cluster)]) -> Option<Row> {
        let count = rest.iter().map(|(_, cluster)| cluster.count).sum();
        let fates = |fates: &Fates| fates.words_of(rest.iter().map(|(input, c)| (*input, c.triangles.as_slice())));
        let cells = vec![
            format!("{}, smaller places", capital(kind.words())),
            format!("{} at {}", words::count(count), words::plural(rest.len(), "place")),
            String::new(),
            String::new(),
            self.fates.map_or(String::new(), fates),
        ];
        (!rest.is_empty()).then_some(Row { cells, place: None })
    }

    fn input(&self, input: usize) -> String {
        if self.ground.inputs.len() > 1 { format!(" of input {}", input + 1) } else { String::new() }
    }

    fn hole(&self, hole: &HoleReport) -> Row {
        let at = DVec3::from(hole.centre);
        // The rim as it lies in the input says from where it is seen best.
        let rim = self.ground.clusters.iter().filter(|(input, cluster)| {
            *input == hole.operand
                && cluster.kind == DefectKind::OpenEdges
                && cluster.place.at.distance(at) <= cluster.place.size / 2.0
        });
        let from = rim.map(|(_, cluster)| cluster.place).min_by(|a, b| a.at.distance(at).total_cmp(&b.at.distance(at)));
        let place = Place { at, size: hole.diameter, from: from.map_or(DVec3::ZERO, |place| place.from) };
        let cells = vec![
            format!("Hole {}{}", hole.number, self.input(hole.operand)),
            format!("{}, {} long", words::plural(hole.edges, "edge"), words::length(hole.perimeter, self.unit)),
            around(at),
            words::length(hole.diameter, self.unit),
            match self.made {
                true => format!("closed: {}", holes::closing(hole)).replace("closed: left", "left"),
                false => holes::closing(hole),
            },
        ];
        Row { cells, place: Some(place) }
    }

    fn cluster(&self, input: usize, cluster: &Cluster) -> Row {
        let (word, words) = (cluster.kind.word(), cluster.kind.words());
        let name = if cluster.count == 1 { word } else { words };
        let length = match cluster.length > 0.0 {
            true => format!(", {} long", words::length(cluster.length, self.unit)),
            false => String::new(),
        };
        let fate = self.fates.map_or(String::new(), |fates| fates.words(input, &cluster.triangles));
        let fate = match cluster.kind {
            DefectKind::OpenEdges if !fate.is_empty() => format!("beside it, {fate}"),
            _ => fate,
        };
        let cells = vec![
            format!("{}{}", capital(name), self.input(input)),
            format!("{}{length}", words::count(cluster.count)),
            around(cluster.place.at),
            words::length(cluster.place.size, self.unit),
            fate,
        ];
        Row { cells, place: Some(cluster.place) }
    }

    /// Thin places, places where the rays disagreed, bodies that were lost, and canals.
    fn places(&self, pipeline: &Report) -> Vec<Row> {
        let boxed = |min: [f64; 3], max: [f64; 3]| Bounds { min: min.into(), max: max.into() };
        let row = |name: &str, of: String, bounds: Bounds, text: String| {
            let place = Place { at: (bounds.min + bounds.max) / 2.0, size: bounds.diagonal(), from: DVec3::ZERO };
            let across = words::length(place.size, self.unit);
            Row { cells: vec![name.into(), of, around(place.at), across, text], place: Some(place) }
        };
        let mut rows = Vec::new();
        for region in &pipeline.thin.regions {
            let (name, thinnest) =
                (if region.gap { "Thin gap" } else { "Thin wall" }, words::length(region.thinnest, self.unit));
            let text = "thinner than two voxels, and made from voxels: look there";
            rows.push(row(name, format!("down to {thinnest}"), boxed(region.min, region.max), text.into()));
        }
        for region in &pipeline.vote.doubtful_regions {
            let text = "the rays disagreed, and the others decided";
            rows.push(row(
                "Doubtful region",
                words::plural(region.voxels, "voxel"),
                boxed(region.min, region.max),
                text.into(),
            ));
        }
        for lost in pipeline.topology.iter().flat_map(|topology| &topology.lost) {
            let half = DVec3::splat(lost.size / 2.0);
            let at = DVec3::from(lost.at);
            let name = if lost.void { "Lost void" } else { "Lost body" };
            rows.push(row(
                name,
                String::new(),
                Bounds { min: at - half, max: at + half },
                "too small for the voxels".into(),
            ));
        }
        for canal in pipeline.canals.iter().flat_map(|canals| &canals.canals) {
            let half = DVec3::splat(canal.diameter.max(canal.length) / 2.0);
            let at = DVec3::from(canal.position);
            let filled = pipeline.canals.as_ref().is_some_and(|canals| canals.removed.contains(&canal.number));
            let text = if filled { "filled" } else { "left as it is" };
            let of = format!(
                "{} wide, {} long",
                words::length(canal.diameter, self.unit),
                words::length(canal.length, self.unit)
            );
            rows.push(row(
                &format!("Canal {}", canal.number),
                of,
                Bounds { min: at - half, max: at + half },
                text.into(),
            ));
        }
        rows
    }
}

fn capital(name: &str) -> String {
    let mut name = name.to_string();
    if let Some(first) = name.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    name
}
