//! The holes of an operand, and how each was closed.

use serde::{Deserialize, Serialize};

use crate::fill::{Lid, Rim, Style};

/// A hole, and what closes it. Model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HoleReport {
    /// The operand that it is in, from 0.
    pub operand: usize,
    /// Its number among the holes of its operand, from 1; the longest rim comes first.
    pub number: usize,
    /// The middle of the rim.
    pub centre: [f64; 3],
    /// Edges of the rim.
    pub edges: usize,
    /// The length of the rim.
    pub perimeter: f64,
    /// The largest distance between two vertices of the rim.
    pub diameter: f64,
    /// The largest distance of a vertex of the rim from its plane.
    pub flatness: f64,
    /// What closes it.
    pub closed_by: HoleClosing,
    /// The number of the hole that it is joined with, where a band closes both.
    pub joined_with: Option<usize>,
    /// Triangles of the lid; 0 where there is none.
    pub triangles: usize,
    /// Area of the lid, square model units; 0 where there is none.
    pub area: f64,
}

/// What closes a hole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum HoleClosing {
    /// A lid made from the rim alone.
    Lid(LidShape),
    /// Surface made from voxels, since there is no lid.
    Voxels(NotLidded),
    /// Nothing: it is left open, as is asked for.
    LeftOpen,
    /// Nothing: it is the rim of a sheet beside a body, which encloses nothing and is left out.
    LeftOut,
}

/// The shape of a lid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LidShape {
    /// In one plane or a few, with no more vertices than needed.
    Flat,
    /// It continues the curvature of what is around.
    Smooth,
    /// Along the level ½ of the winding number.
    Level,
    /// Its part of a band that joins the rim with another one, which faces it. The triangles over the edges of this rim are counted here.
    Band,
}

impl LidShape {
    /// That of a lid made in one of the styles.
    pub(crate) fn of(lid: &Lid) -> Self {
        if lid.style == Style::Smooth { Self::Smooth } else { Self::Flat }
    }
}

/// Why a rim has no lid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NotLidded {
    /// Rays are to settle what is inside, not winding numbers.
    Rays,
    /// There are more than 5,000 rims.
    TooMany,
    /// The vertices of the rim lie on a line.
    NoArea,
    /// Every lid would repeat an edge or a triangle of the mesh.
    Folded,
    /// The lids would be more than half as large as the surface that they close.
    Sheet,
    /// The surface beside would face inwards.
    FacesInwards,
    /// Of another part of the mesh it is not known which side is outside.
    Beside,
    /// Winding numbers do not part inside and outside there, as between rims that face each other.
    NoHole,
    /// Every lid would run into other surface.
    Meets,
}

impl std::fmt::Display for NotLidded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rays => "rays are to settle what is inside",
            Self::TooMany => "there are too many rims",
            Self::NoArea => "its rim lies on a line",
            Self::Folded => "every lid would repeat an edge",
            Self::Sheet => "lids would be larger than half of the surface beside",
            Self::FacesInwards => "the surface beside would face inwards",
            Self::Beside => "of another part it is not known which side is outside",
            Self::NoHole => "inside and outside are not parted there",
            Self::Meets => "every lid would run into other surface",
        })
    }
}

impl HoleReport {
    /// What there is to say of a rim and its lid.
    pub(crate) fn of(number: usize, rim: &Rim, lid: Result<(&Lid, LidShape), NotLidded>) -> Self {
        Self {
            operand: 0,
            number,
            centre: rim.centre.to_array(),
            edges: rim.vertices.len(),
            perimeter: rim.perimeter,
            diameter: rim.diameter,
            flatness: rim.flatness,
            closed_by: match lid {
                Ok((_, shape)) => HoleClosing::Lid(shape),
                Err(why) => HoleClosing::Voxels(why),
            },
            joined_with: None,
            triangles: lid.map_or(0, |(lid, _)| lid.triangles.len()),
            area: lid.map_or(0.0, |(lid, _)| lid.area),
        }
    }

    /// Whether a lid made from the rim alone closes it.
    pub fn has_lid(&self) -> bool {
        matches!(self.closed_by, HoleClosing::Lid(_))
    }
}
