//! The first half of every pipeline: operands are cleaned and oriented, rays are cast, and what they meet becomes spans. What
//! is asked of that (evidence, votes, widths, winding numbers) are methods of [`Survey`].
//!
//! ```text
//! operands ─► Soup::of ─► Cast::of ─► Survey::of ─► evidence, widths, votes, winding
//!               clean       rays        spans
//!               orient      sides
//! ```

mod cast;
mod soup;

pub use cast::{Cast, CastOptions, RayCount};
pub use soup::{Soup, SoupError};

use rayon::prelude::*;

use crate::lattice::{Domain, Grid, Lattice};
use crate::ldi::{Evidence, Expression, Lengths, Spans, spans, widths};
use crate::mesh::{Plane, TriMesh};
use crate::orient::OrientMode;
use crate::progress::{Progress, Stopped};
use crate::vote::{Jury, VoteRule, Votes, Winding, vote_near_surface};

/// What the rays of all 13 directions know about an expression over oriented operands.
#[derive(Debug)]
pub struct Survey {
    /// The operands, oriented.
    pub soup: Soup,
    /// The lattice whose rays were cast.
    pub lattice: Lattice,
    /// The result in terms of the operands.
    pub expression: Expression,
    /// The pieces of each ray that lie inside the result.
    pub spans: Vec<Spans>,
    /// What of each triangle the rays say bounds the result.
    pub evidence: Evidence,
    /// Rays and crossings before the spans were made of them.
    pub count: RayCount,
    /// Where voxels are voted on.
    pub domain: Domain,
}

impl Survey {
    /// Walks all rays: where is the expression inside?
    pub fn of(cast: Cast, expression: &Expression, progress: &Progress) -> Result<Self, Stopped> {
        let Cast { soup, lattice, layers, count, .. } = cast;
        let mut evidence = Evidence::new(&layers, soup.mesh.triangles.len());
        let walk = |layers| progress.check().map(|()| spans(layers, &soup.operands, expression));
        let spans: Vec<Spans> = layers.into_par_iter().map(walk).collect::<Result<_, Stopped>>()?;
        evidence.add(&spans);
        let domain = Domain::of(&lattice);
        Ok(Self { soup, lattice, expression: expression.clone(), spans, evidence, count, domain })
    }

    /// Of one mesh that is taken as it is, on the main processor: for looking at the stages by themselves.
    pub fn of_mesh(mesh: &TriMesh, lattice: &Lattice, progress: &Progress) -> Result<Self, Stopped> {
        let cast = Cast::on_cpu(Soup::as_it_is(mesh.clone()), lattice, OrientMode::Keep, progress)?;
        Self::of(cast, &Expression::Operand(0), progress)
    }

    /// The generalised winding numbers of the operands; its trees are made when they are first needed.
    pub fn winding(&self, progress: &Progress) -> Winding<'_> {
        Winding::new(&self.soup.mesh, &self.soup.operands, &self.lattice, progress)
    }

    /// Whether each voxel near the surface is inside, by the votes of the directions.
    pub fn votes(&self, rule: VoteRule, winding: &Winding<'_>, progress: &Progress) -> Result<Grid<Votes>, Stopped> {
        vote_near_surface(&self.jury(rule, winding), progress)
    }

    /// Those who vote.
    pub fn jury<'a>(&'a self, rule: VoteRule, winding: &'a Winding<'a>) -> Jury<'a> {
        let Self { spans, soup, expression, domain, .. } = self;
        Jury { spans, operands: &soup.operands, expression, rule, winding, domain }
    }

    /// The planes of the operands' triangles, lattice coordinates.
    pub fn planes(&self) -> Vec<Plane> {
        self.soup.planes(&self.lattice)
    }

    /// How thick walls are and how wide gaps, h, where both ends of a piece look along its ray.
    pub fn widths(&self) -> Lengths {
        widths(&self.spans, &self.planes())
    }

    /// Rays that abstain, because the crossings of an operand on them do not balance.
    pub fn silent_rays(&self) -> usize {
        self.spans.iter().map(|spans| spans.silent_rays).sum()
    }

    /// Their share of the rays that meet something, 0 to 1.
    pub fn silent_share(&self) -> f64 {
        self.silent_rays() as f64 / self.count.rays.max(1) as f64
    }
}
