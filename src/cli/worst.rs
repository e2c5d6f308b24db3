//! The defects of a mesh in groups that hang together, the worst first, and what `repair` would do about each.

use rustc_hash::FxHashSet;

use super::entries::{DetailEntry, FurtherEntry, WayEntry, WorstEntry};
use super::exit::Failure;
use super::holes::closing;
use super::input::Input;
use super::words;
use crate::mesh::weld::first_of_equal;
use crate::mesh::{Defects, ValidateOptions, Validity, defects};
use crate::page::{Cluster, DefectKind, clusters};
use crate::pipeline::{Foresight, HoleClosing, HoleReport, LidShape};
use crate::progress::Progress;

/// As many groups are in a report one by one.
const LISTED: usize = 100;

/// Defects that hang together.
pub(super) struct Group {
    cluster: Cluster,
    /// Whether they are gone when vertices at the same place are joined: open edges, and vertices where surfaces meet.
    joined: bool,
}

impl Group {
    /// What it does to a solid, the worst first: nothing is enclosed where it is open, or what is inside is not clear where it crosses; then what no solid
    /// has at an edge, what faces the wrong way, and what is only left out.
    fn rank(&self) -> u8 {
        match self.cluster.kind {
            DefectKind::OpenEdges if self.joined => 3,
            DefectKind::OpenEdges | DefectKind::Crossing => 0,
            DefectKind::NonManifoldEdges => 1,
            DefectKind::Inconsistent => 2,
            DefectKind::NonManifoldVertices => 4,
            DefectKind::Repeated => 5,
            DefectKind::NoArea => 6,
        }
    }
}

/// The word for a kind in reports, as `--fail-on` has it where it has one.
fn word(kind: DefectKind) -> &'static str {
    match kind {
        DefectKind::OpenEdges => "open",
        DefectKind::Crossing => "self",
        DefectKind::NonManifoldEdges => "nonmanifold",
        DefectKind::Inconsistent => "inconsistent",
        DefectKind::NonManifoldVertices => "nonmanifold-vertex",
        DefectKind::Repeated => "duplicate",
        DefectKind::NoArea => "degenerate",
    }
}

/// What so many of a kind are called.
pub(super) fn called(kind: &str, count: usize) -> String {
    let kind = DefectKind::ALL.into_iter().find(|other| word(*other) == kind);
    let name = kind.map_or("defects", |kind| if count == 1 { kind.word() } else { kind.words() });
    format!("{} {name}", words::count(count))
}

/// The groups, the worst first; of those that are as bad the largest.
pub(super) fn groups(input: &Input, validity: &Validity, progress: &Progress) -> Result<Vec<Group>, Failure> {
    let mesh = &input.loaded.mesh;
    let crossing = validity.self_intersecting_triangles.is_some_and(|count| count > 0);
    let options = ValidateOptions { self_intersections: crossing, ..input.loaded.validate_options() };
    let mut found = defects(mesh, &options, progress)?;
    let mut groups = Vec::new();
    let mut parted: FxHashSet<u32> = found.nonmanifold_vertices.iter().copied().collect();
    if !options.weld && !found.open_edges.is_empty() {
        // Rims go on from one patch to the next, whether their vertices are shared or only lie at the same place.
        let open = std::mem::take(&mut found.open_edges);
        let welded = defects(mesh, &ValidateOptions { self_intersections: false, weld: true }, progress)?;
        let still: FxHashSet<[u32; 2]> = welded.open_edges.into_iter().collect();
        let first = first_of_equal(&mesh.positions);
        let ends = |edge: &[u32; 2]| {
            let [a, b] = edge.map(|v| first[v as usize]);
            [a.min(b), a.max(b)]
        };
        let (rims, joined): (Vec<_>, Vec<_>) = open.iter().map(ends).partition(|edge| still.contains(edge));
        let of = |open_edges| clusters(mesh, &Defects { open_edges, ..Defects::default() }, true);
        groups.extend(of(rims).into_iter().map(|cluster| Group { cluster, joined: false }));
        groups.extend(of(joined).into_iter().map(|cluster| Group { cluster, joined: true }));
        let touching: FxHashSet<u32> = welded.nonmanifold_vertices.into_iter().collect();
        parted.retain(|&v| touching.contains(&first[v as usize]));
    }
    groups.extend(clusters(mesh, &found, options.weld).into_iter().map(|cluster| {
        let of_vertices = cluster.kind == DefectKind::NonManifoldVertices;
        Group { joined: of_vertices && !cluster.vertices.iter().any(|v| parted.contains(v)), cluster }
    }));
    let place = |group: &Group| group.cluster.place.at.to_array();
    groups.sort_by(|a, b| {
        let by_rank = a.rank().cmp(&b.rank());
        let by_size = b.cluster.place.size.total_cmp(&a.cluster.place.size);
        let by_count = b.cluster.count.cmp(&a.cluster.count);
        let by_place = place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal);
        by_rank.then(by_size).then(by_count).then(by_place)
    });
    Ok(groups)
}

/// What reports have of the groups: one by one, and the rest by kind.
pub(super) fn entries(groups: &[Group], known: &Known<'_>) -> (Vec<WorstEntry>, Vec<FurtherEntry>) {
    let (first, rest) = groups.split_at(groups.len().min(LISTED));
    let entry = |group: &Group| {
        let Cluster { kind, count, place, length, .. } = &group.cluster;
        let (kind, at) = (word(*kind).to_string(), place.at.to_array());
        WorstEntry { kind, count: *count, at, size: place.size, length: *length, repair: known.fate(group) }
    };
    let further = DefectKind::ALL.into_iter().filter_map(|kind| {
        let of_kind: Vec<usize> = rest.iter().map(|g| &g.cluster).filter(|c| c.kind == kind).map(|c| c.count).collect();
        let entry = || FurtherEntry { kind: word(kind).into(), groups: of_kind.len(), count: of_kind.iter().sum() };
        (!of_kind.is_empty()).then(entry)
    });
    (first.iter().map(entry).collect(), further.collect())
}

/// What is known of a repair.
pub(super) struct Known<'a> {
    pub validity: &'a Validity,
    pub foresight: &'a Foresight,
    pub detail: &'a DetailEntry,
    pub unit: words::UnitName<'a>,
}

impl Known<'_> {
    /// What `repair` would do about a group.
    fn fate(&self, group: &Group) -> String {
        let way = self.detail.way;
        let touches = self.foresight.plan.touching > 0;
        let repeats = self.validity.duplicate_triangles > 0;
        let text = match (group.cluster.kind, way) {
            (DefectKind::OpenEdges, _) if group.joined => "joined: the vertices are at the same place",
            _ if group.joined => "gone once vertices at the same place are joined",
            (DefectKind::OpenEdges, _) => return self.rim(&group.cluster),
            (DefectKind::Inconsistent, _) => "triangles are turned over, so that neighbours agree",
            (DefectKind::Repeated, _) => "left out: they repeat others",
            (DefectKind::NoArea, _) => "left out",
            (_, WayEntry::AsItIs) => self.gone(),
            (DefectKind::Crossing, WayEntry::Exact) if !touches => self.gone(),
            (DefectKind::Crossing, WayEntry::Exact) if repeats => {
                "cut where they still cross once repeated triangles are left out"
            }
            (DefectKind::Crossing, WayEntry::Exact) => "cut where they cross; pieces inside are left out",
            (DefectKind::NonManifoldEdges, WayEntry::Exact) => {
                "what lies inside is left out, and what only touches is parted"
            }
            (DefectKind::NonManifoldVertices, WayEntry::Exact) => "parted: each surface gets a vertex of its own",
            (_, WayEntry::Voxels) if self.detail.sheet => "no solid is made: nothing is enclosed",
            (DefectKind::Crossing, WayEntry::Voxels) => "cut, or made anew from voxels: the rays decide",
            (_, WayEntry::Voxels) => "parted, or made anew from voxels: the rays decide",
        };
        text.into()
    }

    /// What takes defects away that are not of the surface itself.
    fn gone(&self) -> &'static str {
        let cracks = self.foresight.zip.is_some();
        let idle = self.validity.duplicate_triangles + self.validity.degenerate_triangles > 0;
        match (cracks, idle) {
            (true, true) => "gone once cracks are closed, and repeated triangles and those without area are left out",
            (true, false) => "gone once cracks are closed",
            (false, true) => "gone once repeated triangles and those without area are left out",
            (false, false) => "gone once vertices at the same place are joined, and what repeats then is left out",
        }
    }

    /// What becomes of open edges that stay open when vertices are joined.
    fn rim(&self, cluster: &Cluster) -> String {
        if self.detail.sheet {
            return "not closed: the surface encloses nothing".into();
        }
        let Foresight { holes, rims, zip, .. } = self.foresight;
        let is_here = |rim: &&Vec<u32>| {
            let here = rim.iter().filter(|v| cluster.vertices.binary_search(v).is_ok()).count();
            here > 1
        };
        let here: Vec<usize> = (0..holes.len()).filter(|&n| is_here(&&rims[n])).collect();
        match here.as_slice() {
            [] => match zip {
                Some(zip) => {
                    format!(
                        "closed as a crack: no vertex moves farther than {}",
                        words::length(zip.farthest, self.unit)
                    )
                }
                None if self.validity.degenerate_triangles + self.validity.duplicate_triangles > 0 => {
                    self.gone().into()
                }
                None => "no hole: it closes once what touches there is cut".into(),
            },
            &[n] => told(&holes[n]),
            several => {
                let closed = |is: fn(HoleClosing) -> bool| several.iter().filter(|&&n| is(holes[n].closed_by)).count();
                let parts = [
                    (closed(|by| matches!(by, HoleClosing::Lid(_))), "closed by lids over their rims"),
                    (closed(|by| matches!(by, HoleClosing::Voxels(_))), "closed from voxels"),
                    (closed(|by| by == HoleClosing::LeftOut), "left out with their sheets"),
                ];
                let parts: Vec<String> = parts
                    .iter()
                    .filter(|(n, _)| *n > 0)
                    .map(|(n, what)| format!("{} {what}", words::count(*n)))
                    .collect();
                format!("{}: {}", words::plural(several.len(), "hole"), parts.join(", "))
            }
        }
    }
}

/// What closes a hole, as the end of a sentence.
fn told(hole: &HoleReport) -> String {
    match hole.closed_by {
        // The numbers of holes are those of another list.
        HoleClosing::Lid(LidShape::Band) => {
            format!("closed: joined with a rim that faces it, {}", words::plural(hole.triangles, "triangle"))
        }
        HoleClosing::LeftOpen | HoleClosing::LeftOut => closing(hole),
        HoleClosing::Lid(_) | HoleClosing::Voxels(_) => format!("closed: {}", closing(hole)),
    }
}
