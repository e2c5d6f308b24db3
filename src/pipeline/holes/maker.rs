//! The shapes that the lid over a rim may have.

use super::judge::Judge;
use super::patches::Patches;
use crate::fill::{FillOptions, Lid, NoLid, Rim, Style, Surroundings, flat_lid, level_lid, lid};
use crate::pipeline::{LidShape, NotLidded};
use crate::progress::{Progress, Stopped};

/// A rim whose diameter is more than this part of its patch's diagonal is where the body was cut off, rather than a hole in it: by [`Style::Auto`] it is closed
/// flat. Smooth lids there are domes: over the lion's back one of 15 % of its volume, over the camel's neck one of 7 %.
pub(in crate::pipeline) const WIDE: f64 = 0.25;

/// A wide rim that lies farther from its plane than this part of its diameter has no flat lid: the few triangles over the camel's neck (6 %) are 1.2 % of
/// its volume away from where winding numbers have the lid.
const UNEVEN: f64 = 0.02;

/// Rims of at most so many vertices are flat enough for triangles between these.
const FEW: usize = 5;

/// At most so many ways there are to make a lid over a rim.
pub(super) const WAYS: usize = 3;

/// Makes lids.
pub(super) struct Maker<'a> {
    pub around: &'a Surroundings<'a>,
    pub patches: &'a Patches,
    pub judge: &'a Judge<'a>,
    pub style: Style,
}

/// A lid and its shape.
pub(super) struct Made {
    pub lid: Lid,
    pub shape: LidShape,
}

/// A way to make a lid.
#[derive(Clone, Copy)]
enum Way {
    /// That of a style.
    Of(Style),
    /// In the planes of what is beside, where these close the rim, and else along the level ½ of the winding number.
    Planes,
    /// Along the level ½ of the winding number.
    Level,
}

impl Maker<'_> {
    /// The lid over a rim made in the way that comes first for it, or in the next ones.
    pub(super) fn lid(&self, rim: &Rim, way: usize, progress: &Progress) -> Result<Result<Made, NotLidded>, Stopped> {
        progress.check()?;
        let Some(&way) = self.ways(rim).get(way) else { return Ok(Err(NotLidded::Meets)) };
        let level = || {
            let made = level_lid(self.around, rim, &|at| self.judge.own(rim, at), &FillOptions::default());
            made.map(|lid| Made { lid, shape: LidShape::Level })
        };
        let made = match way {
            Way::Of(style) => lid(self.around, rim, &FillOptions { style, ..FillOptions::default() }).map(Made::from),
            Way::Planes => flat_lid(self.around, rim).map_or_else(level, |lid| Ok(Made::from(lid))),
            Way::Level => level(),
        };
        Ok(made.map_err(|why| match why {
            NoLid::NoArea => NotLidded::NoArea,
            NoLid::NoLoop | NoLid::Folded => NotLidded::Folded,
        }))
    }

    /// The ways to make a lid over a rim, the best first.
    fn ways(&self, rim: &Rim) -> &'static [Way] {
        let is_wide = rim.diameter > WIDE * self.patches.size_beside(rim);
        let is_even = rim.vertices.len() <= FEW || rim.flatness <= UNEVEN * rim.diameter;
        match self.style {
            Style::Smooth => &[Way::Of(Style::Smooth), Way::Level, Way::Of(Style::Flat)],
            Style::Auto if !is_wide => &[Way::Of(Style::Auto), Way::Level, Way::Of(Style::Flat)],
            Style::Auto if !is_even => &[Way::Planes, Way::Level],
            Style::Flat if !is_even => &[Way::Planes, Way::Level, Way::Of(Style::Flat)],
            Style::Auto | Style::Flat => &[Way::Of(Style::Flat), Way::Level],
        }
    }
}

impl From<Lid> for Made {
    fn from(lid: Lid) -> Self {
        Self { shape: LidShape::of(&lid), lid }
    }
}
