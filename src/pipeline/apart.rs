//! What stands as it is, beside what rays and voxels have to decide.

use std::borrow::Cow;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::{Options, Precision, StandingReport, TriangleSource};
use crate::fit::{FitOptions, SimpleSource, rounded, simplified_source};
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::mesh::edges::Union;
use crate::progress::{Progress, Stopped};
use crate::shells::{Contacts, Fate, Shell, Shells, StandingOptions, buried, contacts, shells, standing};
use crate::survey::Soup;

/// The shells of a soup, and what becomes of them.
pub(super) struct Apart {
    pub shells: Shells,
    pub contacts: Contacts,
    /// What exact arithmetic says of each shell.
    pub truth: Vec<Fate>,
    /// Whether a shell of which it says nothing lies inside of the result, or outside, all the same.
    pub buried: Vec<bool>,
    /// Whether shells of which it says anything stand in this run; else all go through voxels.
    stand: bool,
    /// For each operand and each of its triangles its number in the soup; nothing for triangles that were dropped.
    in_soup: Vec<Vec<Option<u32>>>,
    /// Whether contacts have been looked for.
    looked: bool,
    /// Places, connected through vertices, where triangles touch others.
    crossings: usize,
}

impl Precision {
    /// A coordinate as the result may have it.
    fn of(self, p: DVec3) -> DVec3 {
        match self {
            Self::Single => rounded(p),
            Self::Double => p,
        }
    }

    /// The mesh with coordinates as the result may have them.
    pub(super) fn of_mesh(self, mesh: &TriMesh) -> Cow<'_, TriMesh> {
        match self {
            Self::Double => Cow::Borrowed(mesh),
            Self::Single => {
                let positions = mesh.positions.iter().map(|&p| self.of(p)).collect();
                Cow::Owned(TriMesh { positions, triangles: mesh.triangles.clone() })
            }
        }
    }
}

impl Apart {
    /// Finds the shells, what they touch, and which of them stand. Where all of the surface is to be built anew, none does.
    pub(super) fn find(
        soup: &Soup,
        expression: &Expression,
        options: &Options,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        let shells = shells(&soup.mesh, &soup.operands);
        let mesh = options.precision.of_mesh(&soup.mesh);
        let bodies = shells.list.iter().filter(|shell| shell.is_body()).count();
        // A single open shell touches nothing but itself, which the fit looks at.
        let worth_looking = bodies > 0 && (shells.list.len() > 1 || shells.list[0].rims == 0);
        let contacts = match worth_looking {
            true => contacts(&mesh, &shells, progress)?,
            false => Contacts { touched: vec![false; soup.mesh.triangles.len()], pairs: Vec::new() },
        };
        let (operands, inside) = (soup.operands.count(), soup.operands.inside);
        let asked = StandingOptions { expression, operands, orient: options.orient, inside };
        let truth = match worth_looking {
            true => standing(&mesh, &shells, &contacts, &asked, progress)?,
            false => vec![Fate::Open; shells.list.len()],
        };
        // Only shells that nothing is known of are asked about.
        let buried = match worth_looking && truth.iter().any(|fate| fate.is_open()) {
            true => buried(&mesh, &shells, &contacts, &asked, progress)?,
            false => vec![false; shells.list.len()],
        };
        let in_soup = in_soup(soup);
        let crossings = places(&soup.mesh, &contacts.touched);
        Ok(Self { shells, contacts, truth, buried, stand: options.keeps(), in_soup, looked: worth_looking, crossings })
    }

    /// What becomes of a shell in this run.
    fn fate(&self, shell: usize) -> Fate {
        if self.stand { self.truth[shell] } else { Fate::Open }
    }

    /// All shells with what becomes of them.
    fn fates(&self) -> impl Iterator<Item = (Fate, &Shell)> {
        self.shells.list.iter().enumerate().map(|(n, shell)| (self.fate(n), shell))
    }

    /// For each shell whether the result has it the other way round than the soup; `None` unless all of them are the result's surface.
    pub(super) fn all_bound(&self) -> Option<Vec<bool>> {
        let over = |(fate, _)| match fate {
            Fate::Bounds { turned, reversed } => Some(turned != reversed),
            Fate::Open | Fate::Inside { .. } => None,
        };
        self.fates().map(over).collect()
    }

    /// The number of operands.
    pub(super) fn operands(&self) -> usize {
        self.in_soup.len()
    }

    /// The shell of a triangle of an operand.
    pub(super) fn shell_of(&self, operand: u32, triangle: u32) -> Option<u32> {
        self.in_soup(operand, triangle).map(|t| self.shells.of[t as usize])
    }

    fn in_soup(&self, operand: u32, triangle: u32) -> Option<u32> {
        self.in_soup[operand as usize].get(triangle as usize).copied().flatten()
    }

    /// Whether a triangle of an operand touches another one, as far as that is known.
    pub(super) fn may_touch(&self, operand: u32, triangle: u32) -> bool {
        let is_touched = |t: u32| self.contacts.touched[t as usize];
        !self.looked || self.in_soup(operand, triangle).is_none_or(is_touched)
    }

    /// Whether a triangle of an operand is not decided: its shell does not stand, or it is of none.
    pub(super) fn is_open(&self, operand: u32, triangle: u32) -> bool {
        self.shell_of(operand, triangle).is_none_or(|shell| self.fate(shell as usize).is_open())
    }

    /// Whether each shell that is not decided runs along each of its edges one way as often as the other.
    pub(super) fn open_balances(&self) -> bool {
        (0..self.operands()).all(|operand| self.balances(operand))
    }

    /// Whether each shell of an operand that is not decided runs along each of its edges one way as often as the other.
    pub(super) fn balances(&self, operand: usize) -> bool {
        self.fates().all(|(fate, shell)| shell.operand != operand || !fate.is_open() || shell.balanced)
    }

    /// How many triangles touch others.
    pub(super) fn touching(&self) -> usize {
        self.contacts.touched.iter().filter(|touched| **touched).count()
    }

    /// How many places there are where triangles touch others: each can make a tunnel.
    pub(super) fn crossings(&self) -> usize {
        self.crossings
    }

    /// The same with no shell standing.
    pub(super) fn none_standing(mut self) -> Self {
        self.stand = false;
        self
    }

    pub(super) fn report(&self) -> StandingReport {
        let mut report = StandingReport::default();
        for (fate, shell) in self.fates() {
            let (bounds, turned) = match fate {
                Fate::Open => continue,
                Fate::Bounds { turned, .. } => (true, turned),
                Fate::Inside { turned } => (false, turned),
            };
            report.turned += usize::from(turned);
            report.shells += usize::from(bounds);
            report.triangles += if bounds { shell.triangles.len() } else { 0 };
            report.left_out += usize::from(!bounds);
        }
        report
    }

    /// The soup without what stands or is left out, and the whole one, where that is another; what was turned over is counted in the reports of
    /// the first.
    pub(super) fn split(&self, soup: Soup) -> (Soup, Option<Soup>) {
        if self.fates().all(|(fate, _)| fate.is_open()) {
            return (soup, None);
        }
        (self.rest(&soup), Some(soup))
    }

    /// The soup without what stands or is left out.
    pub(super) fn rest(&self, soup: &Soup) -> Soup {
        let mut rest = soup.only(|t| self.fate(self.shells.of[t] as usize).is_open());
        for (fate, shell) in self.fates() {
            if matches!(fate, Fate::Bounds { turned: true, .. } | Fate::Inside { turned: true }) {
                rest.reports[shell.operand].flipped_patches += 1;
                rest.reports[shell.operand].flipped_by_rays += shell.triangles.len();
            }
        }
        rest
    }

    /// The surface that stands, with where its triangles come from: vertices and triangles as the operands have them, in their order.
    pub(super) fn surface(
        &self,
        soup: &Soup,
        operands: &[&TriMesh],
        (options, classes): (&Options, &[Vec<u32>]),
        h: f64,
        progress: &Progress,
    ) -> Result<Standing, Stopped> {
        let kept: Vec<(u32, bool)> = (0..soup.mesh.triangles.len() as u32)
            .filter_map(|t| match self.fate(self.shells.of[t as usize] as usize) {
                Fate::Bounds { turned, reversed } => Some((t, turned != reversed)),
                _ => None,
            })
            .collect();
        let mut standing = Standing::default();
        for (operand, input) in operands.iter().enumerate() {
            let own: Vec<(u32, bool)> = kept.iter().copied().filter(|&(t, _)| soup.operands.of(t) == operand).collect();
            standing.add(operand, input, soup, &own, options.precision);
        }
        let Some(fit) = options.fit.filter(|fit| fit.simplify_kept > 0.0) else { return Ok(standing) };
        let of_soup = soup.classes(classes);
        let classes = if of_soup.is_empty() { of_soup } else { kept.iter().map(|k| of_soup[k.0 as usize]).collect() };
        standing.simplified(classes, &fit, h, progress)
    }
}

fn in_soup(soup: &Soup) -> Vec<Vec<Option<u32>>> {
    let mut of: Vec<Vec<Option<u32>>> = vec![Vec::new(); soup.operands.count()];
    for (t, &source) in (0u32..).zip(&soup.source) {
        let list = &mut of[soup.operands.of(t)];
        list.resize(list.len().max(source as usize + 1), None);
        list[source as usize] = Some(t);
    }
    of
}

/// The number of parts, connected through vertices, of the triangles that are touched.
fn places(mesh: &TriMesh, touched: &[bool]) -> usize {
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().zip(touched).filter(|t| *t.1).map(|t| *t.0).collect();
    let vertices = if triangles.is_empty() { 0 } else { mesh.positions.len() };
    let mut union = Union::of_triangles(vertices, triangles.iter().copied());
    let mut roots: Vec<u32> = triangles.iter().map(|t| union.root(t[0])).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.len()
}

/// A surface made of operands' triangles.
#[derive(Debug, Clone, Default)]
pub(super) struct Standing {
    pub mesh: TriMesh,
    pub sources: Vec<TriangleSource>,
}

impl Standing {
    /// Adds triangles of the soup, turned over or not, with the vertices of `input`.
    fn add(&mut self, operand: usize, input: &TriMesh, soup: &Soup, own: &[(u32, bool)], precision: Precision) {
        let corners = |t: u32, over: bool| {
            let [a, b, c] = soup.mesh.triangles[t as usize];
            if over { [a, c, b] } else { [a, b, c] }
        };
        // Numbers of the input, corner by corner as the soup has them.
        let at = |v: u32| soup.mesh.positions[v as usize] + 0.0;
        let numbered = |t: u32| {
            let given = input.triangles[soup.source[t as usize] as usize];
            soup.mesh.triangles[t as usize]
                .map(|v| given.into_iter().find(|&g| input.positions[g as usize] + 0.0 == at(v)).unwrap_or(given[0]))
        };
        let mut number: FxHashMap<u32, u32> = FxHashMap::default();
        let mut one_each = true;
        for &(t, _) in own {
            for (v, given) in soup.mesh.triangles[t as usize].into_iter().zip(numbered(t)) {
                one_each &= *number.entry(v).or_insert(given) == given;
            }
        }
        let place = |v: u32| {
            precision.of(if one_each { input.positions[number[&v] as usize] } else { soup.mesh.positions[v as usize] })
        };
        let first = self.mesh.positions.len() as u32;
        if one_each && own.len() == input.triangles.len() {
            self.mesh.positions.extend(input.positions.iter().map(|&p| precision.of(p)));
            self.mesh.triangles.extend(own.iter().map(|&(t, over)| corners(t, over).map(|v| first + number[&v])));
        } else {
            let mut new: FxHashMap<u32, u32> = FxHashMap::default();
            for &(t, over) in own {
                let triangle = corners(t, over).map(|v| {
                    *new.entry(v).or_insert_with(|| {
                        self.mesh.positions.push(place(v));
                        self.mesh.positions.len() as u32 - 1
                    })
                });
                self.mesh.triangles.push(triangle);
            }
        }
        let source = |&(t, _): &(u32, bool)| TriangleSource::Operand {
            operand: operand as u32,
            triangle: soup.source[t as usize],
        };
        self.sources.extend(own.iter().map(source));
    }

    /// The same with flat parts simplified, where that leaves a valid solid. `classes`: a number for each triangle, or none at all.
    pub(super) fn simplified(
        self,
        classes: Vec<u32>,
        fit: &FitOptions,
        h: f64,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        match simplified_source(&self.mesh, classes, h, fit, progress)? {
            None => Ok(self),
            Some(SimpleSource { mesh, of }) => {
                let source = |t: Option<u32>| t.map_or(TriangleSource::Closed, |t| self.sources[t as usize]);
                Ok(Self { mesh, sources: of.into_iter().map(source).collect() })
            }
        }
    }
}

/// Whether two surfaces, each free of contacts, touch each other.
pub(super) fn touch(a: &TriMesh, b: &TriMesh, progress: &Progress) -> Result<bool, Stopped> {
    let (Some(box_a), Some(box_b)) = (a.bounds(), b.bounds()) else { return Ok(false) };
    let near = |mesh: &TriMesh, other: &crate::mesh::Bounds| {
        let is_near = |t: &usize| {
            let [p, q, r] = mesh.corners(*t);
            let (low, high) = (p.min(q).min(r), p.max(q).max(r));
            low.cmple(other.max).all() && high.cmpge(other.min).all()
        };
        let triangles = (0..mesh.triangles.len()).filter(is_near).map(|t| mesh.triangles[t]).collect();
        TriMesh { positions: mesh.positions.clone(), triangles }
    };
    let (mut both, b) = (near(a, &box_b), near(b, &box_a));
    let split = both.triangles.len();
    both.append(&b);
    let of = (0..both.triangles.len()).map(|t| u32::from(t >= split)).collect();
    let met = contacts(&both, &Shells { of, list: Vec::new() }, progress)?;
    Ok(met.pairs.contains(&[0, 1]))
}
