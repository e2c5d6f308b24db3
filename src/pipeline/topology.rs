//! Bodies, voids and tunnels, before and after: what a lattice lost, fused or pierced is told.

use super::LostBody;
use super::Topology;
use super::TopologyReport;

use super::TriangleSource;
use super::apart::Apart;
use crate::ldi::Operands;
use crate::mesh::TriMesh;
use crate::mesh::edges::Union;
use crate::shells::{Fate, Kind, Shell, shells};

/// At most this many lost bodies are listed.
const MOST_LISTED: usize = 20;

/// A piece with less than this part of its body's volume is a crumb.
const CRUMB: f64 = 1e-4;

/// Shells that belong together: they touch, or are pieces of one surface.
struct Groups {
    of: Vec<u32>,
    /// Whether it is a single shell that encloses something by itself.
    single: Vec<bool>,
    /// Whether nobody knows what the group bounds.
    torn: Vec<bool>,
    /// Whether shells of several operands touch in it.
    mixed: Vec<bool>,
}

impl Groups {
    fn new(apart: &Apart) -> Self {
        let list = &apart.shells.list;
        let mut union = Union::new(list.len());
        apart.contacts.pairs.iter().for_each(|&[a, b]| {
            union.join(a, b);
        });
        // Pieces of one operand may be parts of one surface, whether or not they touch.
        let mut pieces: Vec<(usize, u32)> = Vec::new();
        for (n, shell) in (0..).zip(list) {
            if !shell.is_body() && shell.kind != Kind::Torn {
                match pieces.iter().find(|(operand, _)| *operand == shell.operand) {
                    Some(&(_, first)) => {
                        union.join(first, n);
                    }
                    None => pieces.push((shell.operand, n)),
                }
            }
        }
        let of: Vec<u32> = (0..list.len() as u32).map(|n| union.root(n)).collect();
        let mut count = vec![0u32; list.len()];
        let none = vec![false; list.len()];
        let mut groups = Self { single: none.clone(), torn: none.clone(), mixed: none, of };
        let mut operand = vec![usize::MAX; list.len()];
        for (shell, &group) in list.iter().zip(&groups.of) {
            let group = group as usize;
            count[group] += 1;
            groups.torn[group] |= !shell.is_body();
            groups.mixed[group] |= operand[group] != usize::MAX && operand[group] != shell.operand;
            operand[group] = shell.operand;
        }
        let touched = apart.contacts.of_shells(list.len());
        for (n, &group) in groups.of.iter().enumerate() {
            groups.single[group as usize] = count[group as usize] == 1 && !touched[n] && list[n].is_body();
        }
        groups
    }
}

/// Whether a group must be in the result, as far as that is known, and as a void.
fn expected(shell: &Shell, truth: Fate, operands: usize) -> Option<(bool, bool)> {
    match truth {
        Fate::Bounds { turned, reversed } => Some((true, (shell.volume < 0.0) != (turned != reversed))),
        Fate::Inside { .. } => Some((false, false)),
        Fate::Open if operands == 1 && shell.kind == Kind::Open => Some((true, false)),
        Fate::Open => None,
    }
}

/// Compares a result with what the shells of its operands describe.
pub(super) fn compared(mesh: &TriMesh, sources: &[TriangleSource], apart: &Apart) -> TopologyReport {
    let found = shells(mesh, &Operands::new([mesh.triangles.len()]));
    let groups = Groups::new(apart);
    let list = &apart.shells.list;
    // The groups that each surface of the result comes from, and back.
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    for (source, &shell) in sources.iter().zip(&found.of) {
        if let TriangleSource::Operand { operand, triangle } = *source
            && let Some(of) = apart.shell_of(operand, triangle)
        {
            pairs.push((shell, groups.of[of as usize]));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let mut report = TopologyReport { after: after(&found.list), ..TopologyReport::default() };
    let known = |group: u32| !groups.torn[group as usize];
    let mut joined = Union::new(list.len());
    for of_shell in pairs.chunk_by(|a, b| a.0 == b.0) {
        let mut known = of_shell.iter().map(|pair| pair.1).filter(|&group| known(group));
        if let Some(first) = known.next() {
            report.fused += known.filter(|&other| joined.join(first, other)).count();
        }
    }
    let mut surfaces: Vec<Vec<u32>> = vec![Vec::new(); list.len()];
    pairs.iter().for_each(|&(shell, group)| surfaces[group as usize].push(shell));
    lost_and_parted(&mut report, apart, &groups, &surfaces, &found.list);
    tunnels(&mut report, apart, &groups, &surfaces);
    report
}

/// What there is to say of an exact result.
pub(super) struct Found {
    pub after: Topology,
    /// Shells that did not stand and of which nothing is in the result.
    pub buried: usize,
}

/// What an exact result has: with winding numbers there is nothing to compare, it is what its operands describe.
pub(super) fn of_exact(mesh: &TriMesh, sources: &[TriangleSource], apart: &Apart) -> Found {
    let found = shells(mesh, &Operands::new([mesh.triangles.len()]));
    let mut seen = vec![false; apart.shells.list.len()];
    for source in sources {
        if let TriangleSource::Operand { operand, triangle } = *source
            && let Some(shell) = apart.shell_of(operand, triangle)
        {
            seen[shell as usize] = true;
        }
    }
    let gone = |n: &usize| apart.truth[*n].is_open() && !seen[*n];
    Found { after: after(&found.list), buried: (0..seen.len()).filter(gone).count() }
}

fn after(list: &[Shell]) -> Topology {
    Topology {
        bodies: list.iter().filter(|shell| shell.volume > 0.0).count(),
        voids: list.iter().filter(|shell| shell.volume < 0.0).count(),
        tunnels: list.iter().filter_map(|shell| shell.genus).sum(),
    }
}

fn lost_and_parted(
    report: &mut TopologyReport,
    apart: &Apart,
    groups: &Groups,
    surfaces: &[Vec<u32>],
    found: &[Shell],
) {
    let (mut bodies, mut voids) = (0, 0);
    let mut all_known = true;
    let (mut volume, mut lost_volume) = (0.0, 0.0);
    for (n, shell) in apart.shells.list.iter().enumerate() {
        let group = groups.of[n] as usize;
        if apart.truth[n].is_open() && apart.buried[n] {
            report.buried += usize::from(surfaces[group].is_empty());
            continue;
        }
        if !groups.single[group] {
            // Whatever touches is one body or more, counted by its first shell.
            all_known &= !(groups.torn[group] || groups.mixed[group] || apart.operands() > 1);
            bodies += usize::from(group == n);
            volume += if group == n { shell.volume.abs() } else { 0.0 };
            continue;
        }
        let Some((present, void)) = expected(shell, apart.truth[n], apart.operands()) else {
            all_known = false;
            continue;
        };
        if !present {
            continue;
        }
        (bodies, voids) = (bodies + usize::from(!void), voids + usize::from(void));
        volume += shell.volume.abs();
        match surfaces[group].as_slice() {
            [] => {
                let middle = (shell.bounds.min + shell.bounds.max) / 2.0;
                let (at, size) = (middle.to_array(), shell.bounds.diagonal());
                report.lost.push(LostBody { void, at, size, volume: shell.volume.abs() });
                lost_volume += shell.volume.abs();
            }
            parts => {
                let small = |&&part: &&u32| found[part as usize].volume.abs() < CRUMB * shell.volume.abs();
                report.parted += parts.len() - 1;
                report.crumbs += parts.iter().filter(small).count().min(parts.len() - 1);
            }
        }
    }
    report.lost_count = report.lost.len();
    report.lost_share = if volume > 0.0 { lost_volume / volume } else { 0.0 };
    report.lost.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    report.lost.truncate(MOST_LISTED);
    report.before = all_known.then_some(Topology { bodies, voids, tunnels: 0 });
}

fn tunnels(report: &mut TopologyReport, apart: &Apart, groups: &Groups, surfaces: &[Vec<u32>]) {
    let mut sum = 0;
    // Rims that face each other may be joined instead of closed one by one.
    let mut joined = 0;
    for (n, shell) in apart.shells.list.iter().enumerate() {
        let group = groups.of[n] as usize;
        joined += shell.rims.saturating_sub(1) as i64;
        match shell.genus.filter(|_| !groups.torn[group]) {
            Some(genus) if !surfaces[group].is_empty() => sum += genus,
            Some(_) => {}
            None => return report.before = None,
        }
    }
    if let Some(before) = &mut report.before {
        before.tunnels = sum;
    }
    report.new_tunnels = Some((report.after.tunnels - sum - joined - apart.crossings() as i64).max(0));
}
