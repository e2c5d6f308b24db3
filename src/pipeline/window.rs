//! Holes without a lid, closed from voxels of a lattice around them alone, so that nothing else is looked at.

use glam::DVec3;

use super::apart::{Standing, touch};
use super::holes::Plan;
use super::part::{CLEAR, Part};
use super::rebuild::{Job, joined};
use super::stages::Stages;
use super::{BooleanError, Draft, Method, sizing};
use crate::fill::Rim;
use crate::lattice::Lattice;
use crate::mesh::{Bounds, ValidateOptions, validate};
use crate::survey::Soup;
use crate::vote::VoteRule;

/// The lattice reaches so many voxels beyond the rims, and this part of the diagonal of their box.
const AROUND: (f64, f64) = (10.0, 0.25);
/// Voxels across the smallest rim, at least, while the lattice has no more than so many along a side.
const ACROSS: f64 = 24.0;
const MOST_ALONG: f64 = 256.0;
/// A lattice of more than this part of the box of all is none around holes.
const MOST: f64 = 0.25;

impl Job<'_> {
    /// The holes of the one operand closed by the lids of a plan, and those that have none from voxels around them. `None` where there is no such hole, where not all of the
    /// surface beyond the lattice stays as it is, or where that makes no solid.
    pub(super) fn within_window(
        &self,
        rest: &Soup,
        plan: &Plan,
        standing: &Standing,
        stages: &mut Stages<'_>,
    ) -> Result<Option<Draft>, BooleanError> {
        if !self.options.keeps() || self.options.method != Method::Auto || self.options.vote != VoteRule::Winding {
            return Ok(None);
        }
        let rims = plan.bare();
        if rims.is_empty() {
            return Ok(None);
        }
        let soup = plan.over(rest);
        let Some(whole) = soup.mesh.bounds() else { return Ok(None) };
        let Some(lattice) = window(&soup, &rims, &whole, self.h) else { return Ok(None) };
        let [min, max] = [DVec3::splat(CLEAR), (lattice.dims - 1).as_dvec3() - CLEAR].map(|p| lattice.to_model(p));
        let part = Part::Box(Bounds { min, max });
        let mut surveyed = match self.surveyed(soup.into_owned(), &lattice, stages) {
            Ok(surveyed) => surveyed,
            Err(BooleanError::Stopped(stopped)) => return Err(stopped.into()),
            Err(_) => return Ok(None),
        };
        let Some(made) = self.within(&part, &mut surveyed, sizing::finest(&whole), stages)? else { return Ok(None) };
        if touch(&made.mesh, &standing.mesh, self.progress)? {
            return Ok(None);
        }
        let check = ValidateOptions { self_intersections: true, weld: true };
        let is_valid = validate(&made.mesh, &check, self.progress)?.is_valid();
        Ok(is_valid.then(|| joined(standing.clone(), made)))
    }
}

/// A lattice around rims of a soup, of voxels of size `h` or finer; `None` where there are none, or where it would hold much of the soup.
fn window(soup: &Soup, rims: &[&Rim], whole: &Bounds, h: f64) -> Option<Lattice> {
    let at = |v: &u32| soup.mesh.positions[*v as usize];
    let box_of_rims = Bounds::of(rims.iter().flat_map(|rim| &rim.vertices).map(at))?;
    let around = |h: f64| {
        let reach = DVec3::splat(AROUND.0 * h + AROUND.1 * box_of_rims.diagonal());
        let room = DVec3::splat((CLEAR + 2.0) * h);
        Bounds {
            min: (box_of_rims.min - reach).max(whole.min - room),
            max: (box_of_rims.max + reach).min(whole.max + room),
        }
    };
    let smallest = rims.iter().map(|rim| rim.diameter).fold(f64::INFINITY, f64::min);
    let wanted = h.min(smallest / ACROSS).max(sizing::finest(whole));
    let is_small = |h: f64| around(h).size().max_element() <= MOST_ALONG * h;
    let h = if is_small(wanted) { wanted } else { h };
    let window = around(h);
    let volume = |min: DVec3, max: DVec3| (max - min).max(DVec3::splat(h)).element_product();
    let held = volume(window.min.max(whole.min), window.max.min(whole.max));
    (held <= MOST * volume(whole.min, whole.max)).then(|| Lattice::around(&window, h))
}
