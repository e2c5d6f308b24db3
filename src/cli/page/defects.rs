//! The table of defects, and what became of each.

use glam::DVec3;

use crate::cli::words::{self, UnitName};
use crate::cli::holes;
use crate::mesh::Bounds;
use crate::page::{Cluster, DefectKind, Place, Row, Table};
use crate::pipeline::{HoleReport, Report};

use super::fates::Fates;
use super::ground::Ground;

/// At most so many rows.
const MOST: usize = 150;

/// What is known of the defects of a run.
pub(super) struct Known<'a> {
    pub ground: &'a Ground,
    pub holes: &'a [HoleReport],
    pub pipeline: Option<&'a Report>,
    /// What became of triangles, where something was made.
    pub fates: Option<&'a Fates>,
    pub unit: UnitName<'a>,
}

impl Known<'_> {
    /// The table: holes first, then what else is wrong, then what is to be looked at.
    pub(super) fn table(&self) -> Table {
        let mut rows: Vec<Row> = self.holes.iter().map(|hole| self.hole(hole)).collect();
        let rest = self.ground.clusters.iter().filter(|(input, cluster)| !self.is_told(*input, cluster));
        rows.extend(rest.map(|(input, cluster)| self.cluster(*input, cluster)));
        rows.extend(self.pipeline.iter().flat_map(|pipeline| self.places(pipeline)));
        let more = rows.len().saturating_sub(MOST);
        rows.truncate(MOST);
        let last = if self.fates.is_some() { "What became of it" } else { "What repair would do" };
        let mut head: Vec<String> = ["Defect", "Of", "Around", "Across"].map(String::from).into();
        match self.fates.is_some() || !self.holes.is_empty() {
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
            match self.fates.is_some() {
                true => format!("closed: {}", holes::closing(hole)).replace("closed: left", "left"),
                false => holes::closing(hole),
            },
        ];
        Row { cells, place: Some(place) }
    }

    fn cluster(&self, input: usize, cluster: &Cluster) -> Row {
        let (word, words) = (cluster.kind.word(), cluster.kind.words());
        let name = if cluster.count == 1 { word } else { words };
        let mut capital = name.to_string();
        capital[..1].make_ascii_uppercase();
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
            format!("{capital}{}", self.input(input)),
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

fn around(at: DVec3) -> String {
    at.to_array().map(words::number).join(" ")
}
