//! `--drain`: a hole into the cavity.

use std::str::FromStr;

use super::exit::Failure;
use super::length::{Length, Scale};
use super::transform::Shift;
use crate::pipeline::Drain;

/// One `--drain`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrainChoice {
    diameter: Length,
    at: Shift,
}

impl FromStr for DrainChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || "a diameter and a place are needed, such as 3mm@10,0,-5".to_string();
        let (diameter, at) = text.split_once('@').ok_or_else(wanted)?;
        let diameter = diameter.parse().map_err(|error: super::length::QuantityError| error.to_string())?;
        Ok(Self { diameter, at: at.parse()? })
    }
}

impl DrainChoice {
    /// In model units.
    pub fn resolve(&self, scale: &Scale) -> Result<Drain, Failure> {
        Ok(Drain { diameter: self.diameter.resolve(scale)?, at: self.at.resolve(scale)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drains_are_a_diameter_at_a_place() {
        let scale = Scale { unit: None, diagonal: 10.0, voxel: Some(0.5) };
        let drain: DrainChoice = "4h@1,-2.5,0".parse().expect("a drain");
        let expected = Drain { diameter: 2.0, at: glam::DVec3::new(1.0, -2.5, 0.0) };
        assert_eq!(drain.resolve(&scale).expect("lengths"), expected);
        for text in ["", "3", "3@", "3@1,2", "@1,2,3", "0@1,2,3", "-1@1,2,3", "3@a,b,c"] {
            assert!(text.parse::<DrainChoice>().is_err(), "{text}");
        }
    }
}
