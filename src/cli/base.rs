//! `--base`: where the base of a block lies.

use std::fmt;
use std::str::FromStr;

use super::exit::Failure;
use super::length::{Length, QuantityError, Scale};
use crate::picture::Axis;
use crate::pipeline::Base;

/// `--base` as typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BaseChoice {
    /// So far below the sheet.
    Below(Length),
    /// In a plane across an axis, at a length along it.
    Plane {
        /// The axis.
        axis: Axis,
        /// Whether the place is below zero.
        negative: bool,
        /// How far from zero the place is; `None` for zero itself.
        at: Option<Length>,
    },
}

impl FromStr for BaseChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((axis, at)) = text.split_once('=') else {
            let below: Result<Length, QuantityError> = text.parse();
            return below.map(Self::Below).map_err(|error| format!("{error}; a plane is given as z=-5mm"));
        };
        let axis = match axis.trim() {
            "x" => Axis::X,
            "y" => Axis::Y,
            "z" => Axis::Z,
            other => return Err(format!("`{other}` is no axis: a plane is given as x=0, y=1.5 or z=-5mm")),
        };
        let at = at.trim();
        let (negative, rest) = at.strip_prefix('-').map_or((false, at), |rest| (true, rest));
        let number = rest.trim_end_matches(char::is_alphabetic);
        if number.trim().parse::<f64>() == Ok(0.0) {
            return Ok(Self::Plane { axis, negative: false, at: None });
        }
        match rest.parse::<Length>().map_err(|error| error.to_string())? {
            Length::Percent(_) | Length::Voxels(_) => {
                Err(format!("`{at}` is no place on an axis, such as 0, 1.5 or -5mm"))
            }
            length => Ok(Self::Plane { axis, negative, at: Some(length) }),
        }
    }
}

impl fmt::Display for BaseChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Below(length) => length.fmt(f),
            Self::Plane { axis, negative, at } => {
                let sign = if *negative { "-" } else { "" };
                let at = at.map_or("0".into(), |at| at.to_string());
                write!(f, "{}={sign}{at}", ["x", "y", "z"][axis.number()])
            }
        }
    }
}

impl BaseChoice {
    /// In model units.
    pub fn resolve(&self, scale: &Scale) -> Result<Base, Failure> {
        Ok(match self {
            Self::Below(length) => Base::Below(length.resolve(scale)?),
            Self::Plane { axis, negative, at } => {
                let far = at.map_or(Ok(0.0), |at| at.resolve(scale))?;
                Base::Plane { axis: *axis, at: if *negative { -far } else { far } }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Unit;

    #[test]
    fn a_base_is_a_length_or_a_plane() {
        let scale = Scale { unit: "mm".parse::<Unit>().ok(), diagonal: 10.0, voxel: Some(0.5) };
        let base = |text: &str| text.parse::<BaseChoice>().expect(text).resolve(&scale).expect(text);
        assert_eq!(base("5"), Base::Below(5.0));
        assert_eq!(base("10%"), Base::Below(1.0));
        assert_eq!(base("z=0"), Base::Plane { axis: Axis::Z, at: 0.0 });
        assert_eq!(base("x = -1cm"), Base::Plane { axis: Axis::X, at: -10.0 });
        assert_eq!(base("y=2.5"), Base::Plane { axis: Axis::Y, at: 2.5 });
        for text in ["", "0", "-5", "w=1", "z=", "z=a", "z=5%", "z=2h", "z=--1", "=3"] {
            assert!(text.parse::<BaseChoice>().is_err(), "{text}");
        }
        for text in ["5mm", "z=0", "x=-1cm"] {
            assert_eq!(text.parse::<BaseChoice>().expect(text).to_string(), text);
        }
    }
}
