//! Sharp edges back: the contour's surface is fitted to the facets of its source.
//!
//! The vertices of the contour lie on source triangles already; what a lattice rounds off is what
//! lies between them. Where two neighbours lie on different smooth pieces, the crease between them is known
//! exactly: it is where the planes of their facets meet.

mod crease;
mod cut;
mod facets;
mod fitting;
mod mend;
mod quadric;
mod safeguard;
mod simplify;
mod snap;

pub use facets::{Facets, Side, Sides};

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};
use crease::{Place, SMOOTH};

/// A surface whose vertices know the facets they lie on.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// The surface, model units; every coordinate is an `f32`.
    pub mesh: TriMesh,
    /// One for each vertex.
    pub sides: Vec<Sides>,
}

impl Surface {
    fn at(&self, vertex: u32) -> DVec3 {
        self.mesh.positions[vertex as usize]
    }

    fn put(&mut self, vertex: u32, place: Place) {
        self.mesh.positions[vertex as usize] = place.at;
        self.sides[vertex as usize] = place.sides;
    }

    fn place(&self, vertex: u32) -> Place {
        Place { at: self.at(vertex), sides: self.sides[vertex as usize] }
    }

    /// Whether the corners of a triangle have facets of one smooth piece, or one of them none.
    fn is_smooth(&self, facets: &Facets<'_>, t: u32) -> bool {
        let [a, b, c] = self.mesh.triangles[t as usize].map(|v| self.sides[v as usize]);
        let near = |p: Side, q: Side| facets.plane(p).normal.dot(facets.plane(q).normal) > SMOOTH;
        let any = a.is_empty() || b.is_empty() || c.is_empty();
        if any || a.iter().any(|p| b.iter().any(|q| p == q) && c.iter().any(|r| p == r)) {
            return true;
        }
        a.iter().any(|p| b.iter().any(|q| near(p, q) && c.iter().any(|r| near(q, r) && near(p, r))))
    }

    /// The facet that a triangle lies on; `None` where nothing is known.
    pub fn facet(&self, facets: &Facets<'_>, t: u32) -> Option<u32> {
        let corners = self.places(t);
        let centre = corners.iter().map(|c| c.at).sum::<DVec3>() / 3.0;
        let normal = snap::shape(corners.map(|c| c.at)).0.normalize_or_zero();
        let known = corners.iter().filter(|c| !c.sides.is_empty()).count();
        // A facet that all corners with any share is it; else the one that faces the same way.
        let votes = |side: Side| corners.iter().filter(|c| c.sides.iter().any(|s| s == side)).count() == known;
        let off = |side: Side| {
            let plane = facets.plane(side);
            (!votes(side), 1.0 - plane.normal.dot(normal))
        };
        let all = corners.iter().flat_map(|c| c.sides.iter());
        let best = all.min_by(|p, q| {
            let (p, q) = (off(*p), off(*q));
            p.0.cmp(&q.0).then(p.1.total_cmp(&q.1))
        })?;
        Some(facets.walk(best, centre).0.facet())
    }

    /// The corners of a triangle.
    fn places(&self, t: u32) -> [Place; 3] {
        self.mesh.triangles[t as usize].map(|v| self.place(v))
    }
}

/// How well a triangle agrees with its facets: the cosine between its normal and that of the facet,
/// of those its corners lie on, whose smooth piece all corners share and that agrees best; `None` where there
/// is no such piece.
fn agreement(facets: &Facets<'_>, corners: &[Place; 3]) -> Option<f64> {
    let normal = snap::shape(corners.map(|c| c.at)).0.normalize_or_zero();
    let has = |corner: &Place, p: Side| {
        corner.sides.iter().any(|q| p == q || facets.plane(p).normal.dot(facets.plane(q).normal) > SMOOTH)
    };
    let all = corners.iter().flat_map(|c| c.sides.iter());
    all.filter(|&p| corners.iter().all(|c| has(c, p))).map(|p| facets.plane(p).normal.dot(normal)).max_by(f64::total_cmp)
}

/// A point whose coordinates any format holds unchanged.
fn rounded(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}

/// The triangles around each vertex.
pub(crate) struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn new(mesh: &TriMesh) -> Self {
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut triangles = vec![0; sum as usize];
        for (id, triangle) in mesh.triangles.iter().enumerate().rev() {
            for &v in triangle {
                starts[v as usize] -= 1;
                triangles[starts[v as usize] as usize] = id as u32;
            }
        }
        Self { starts, triangles }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        &self.triangles[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}

/// Rounds of undoing after which the surface stays as it was. Real meshes take up to 10.
const MOST_ROUNDS: usize = 24;

/// Rounds after which all that was done at a bad place is taken back at once.
const PATIENT_ROUNDS: usize = 6;

/// Options of [`fit`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// A crease that lies nearer to the surface than this, h, is left out.
    pub sag: f64,
    /// How far simplification may take the surface away, h; 0 keeps all triangles.
    pub tolerance: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { sag: 0.02, tolerance: 0.002 }
    }
}

/// What [`fit`] did.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct FitReport {
    /// Vertices moved onto a crease or corner.
    pub moved: usize,
    /// Points inserted on creases.
    pub inserted: usize,
    /// Places where a crease was left rounded, because the surface would have met itself.
    pub given_up: usize,
}

/// Places given up are tried again when they are fewer than one in so many: on parts that brings back
/// all but a few, on scans it costs a third of the time for nothing measurable.
const WORTH_RETRYING: usize = 100;

/// Fits a surface to its facets: creases and corners come back, and what is flat gets few triangles.
pub fn fit(
    home: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<(Surface, FitReport), Stopped> {
    let (sharp, mut report) = sharpen(home, facets, h, options, progress)?;
    let mut surface = simplified(sharp, facets, h, options.tolerance, progress)?;
    if report.given_up > 0 && report.given_up * WORTH_RETRYING < report.inserted + report.moved {
        // Simplification has cleared away what was in the way.
        let again = FitOptions { sag: f64::INFINITY, ..*options };
        let (sharper, more) = sharpen(&surface, facets, h, &again, progress)?;
        if more.inserted + more.moved > 0 {
            surface = simplified(sharper, facets, h, options.tolerance, progress)?;
        }
        report = FitReport {
            moved: report.moved + more.moved,
            inserted: report.inserted + more.inserted,
            given_up: more.given_up,
        };
    }
    Ok((surface, report))
}

/// Brings back creases and corners.
fn sharpen(
    home: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<(Surface, FitReport), Stopped> {
    let mut fitting = fitting::Fitting::new(home, facets, h, options);
    for round in 0..MOST_ROUNDS {
        progress.check()?;
        let mut cut = cut::cut(&fitting.surface, facets, h, &fitting.points, &fitting.spared, |c| options.wants(c, h));
        let away = fitting.changed(&cut.origin);
        let mended = mend::mend(&mut cut, facets, h, &away);
        let sorted = |mut list: Vec<u32>| {
            list.extend(&mended);
            list.sort_unstable();
            list.dedup();
            list
        };
        let dirty = |t: &u32| fitting.is_dirty(cut.origin[*t as usize]);
        // A triangle that is back at home is right by itself, but what was near it may not be.
        let other = sorted(fitting.changed(&cut.origin).into_iter().filter(dirty).collect());
        let near = sorted((0..cut.origin.len() as u32).filter(|t| fitting.was_dirtied(cut.origin[*t as usize])).chain(other.iter().copied()).collect());
        let before = |t: u32| snap::shape(home.mesh.corners(cut.origin[t as usize] as usize)).0;
        let mut bad = safeguard::misshapen(&cut.surface, facets, h, &other, before);
        bad.extend(safeguard::meeting(&cut.surface.mesh, h, &near, progress)?);
        if bad.is_empty() {
            return Ok((cut.surface, fitting.report()));
        }
        let mut bad: Vec<u32> = bad.into_iter().map(|t| cut.origin[t as usize]).collect();
        bad.sort_unstable();
        bad.dedup();
        fitting.undo(&bad, &cut.centred, round >= PATIENT_ROUNDS);
    }
    Ok((home.clone(), FitReport::default()))
}

/// Fewer triangles, by collapse within `tolerance` (h).
fn simplified(
    surface: Surface,
    facets: &Facets<'_>,
    h: f64,
    tolerance: f64,
    progress: &Progress,
) -> Result<Surface, Stopped> {
    if tolerance <= 0.0 {
        return Ok(surface);
    }
    let mut frozen = class_borders(&surface, facets);
    for round in 0..6 {
        let simple = simplify::simplify(&surface, facets, h, tolerance, &frozen, progress)?;
        let bad = crate::mesh::intersecting_triangles(&simple.mesh, progress)?;
        if bad.is_empty() {
            return Ok(simple);
        }
        let reach = 2.0 * h * f64::from(1 << round);
        let boxes: Vec<(DVec3, DVec3)> = bad
            .iter()
            .map(|&t| {
                let [a, b, c] = simple.mesh.corners(t as usize);
                (a.min(b).min(c) - reach, a.max(b).max(c) + reach)
            })
            .collect();
        frozen.par_iter_mut().zip(&surface.mesh.positions).for_each(|(frozen, p)| {
            *frozen |= boxes.iter().any(|(low, high)| p.cmpge(*low).all() && p.cmple(*high).all());
        });
    }
    Ok(surface)
}

/// The vertices between triangles of different classes.
fn class_borders(surface: &Surface, facets: &Facets<'_>) -> Vec<bool> {
    let mut border = vec![false; surface.mesh.positions.len()];
    if facets.has_classes() {
        for t in &surface.mesh.triangles {
            let mut classes = t.iter().flat_map(|&v| surface.sides[v as usize].iter()).map(|s| facets.class(s));
            let first = classes.next();
            if classes.any(|class| Some(class) != first) {
                t.iter().for_each(|&v| border[v as usize] = true);
            }
        }
    }
    border
}
