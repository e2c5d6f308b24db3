//! Volumes as people type them.

use std::fmt;
use std::str::FromStr;

use super::length::{Length, QuantityError, Scale};

/// A volume as typed, not yet in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    value: f64,
    /// What is cubed, with a number of 1; a plain number is in cubic units of the file.
    side: Option<Length>,
}

const A_VOLUME: &str = "a volume such as 0.5mm3, 1e-3in3, 8h3 (cubic voxels) or 0.5 (cubic units of the file)";

impl FromStr for Volume {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let malformed = || QuantityError::Malformed { text: text.into(), wanted: A_VOLUME };
        let trimmed = text.trim();
        let cubed = ["^3", "³", "3"].iter().find_map(|end| {
            let length = trimmed.strip_suffix(end)?;
            length.ends_with(char::is_alphabetic).then_some(length)
        });
        match cubed.unwrap_or(trimmed).parse::<Length>() {
            Ok(Length::Plain(value)) if cubed.is_none() => Ok(Self { value, side: None }),
            Ok(Length::Unit(value, unit)) if cubed.is_some() => Ok(Self { value, side: Some(Length::Unit(1.0, unit)) }),
            Ok(Length::Voxels(value)) if cubed.is_some() => Ok(Self { value, side: Some(Length::Voxels(1.0)) }),
            Err(QuantityError::NotPositive { .. }) => Err(QuantityError::NotPositive { text: text.into() }),
            _ => Err(malformed()),
        }
    }
}

impl fmt::Display for Volume {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.value)?;
        match self.side {
            Some(Length::Unit(_, unit)) => write!(f, "{unit}3"),
            Some(_) => f.write_str("h3"),
            None => Ok(()),
        }
    }
}

impl Volume {
    /// In cubic model units.
    pub fn resolve(&self, scale: &Scale) -> Result<f64, QuantityError> {
        let side = self.side.map_or(Ok(1.0), |side| side.resolve(scale))?;
        Ok(self.value * side.powi(3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Unit;

    #[test]
    fn volumes_are_read_in_every_way() {
        let scale = Scale { unit: Some(Unit::Millimetre), diagonal: 10.0, voxel: Some(0.5) };
        let volume = |text: &str| text.parse::<Volume>().expect(text).resolve(&scale).expect(text);
        for (text, wanted) in [("8h3", 1.0), ("8h^3", 1.0), ("2.5", 2.5), ("3", 3.0), ("1cm3", 1000.0), ("2mm³", 2.0)]
        {
            assert!((volume(text) - wanted).abs() < 1e-9 * wanted, "{text}: {}", volume(text));
        }
        for text in ["", "8h", "1mm", "1%", "1%3", "h3", "8x3"] {
            assert!(matches!(text.parse::<Volume>(), Err(QuantityError::Malformed { .. })), "{text}");
        }
        assert!(matches!("-1h3".parse::<Volume>(), Err(QuantityError::NotPositive { .. })));
        let without = Scale { unit: None, ..scale };
        assert!(matches!(
            "1mm3".parse::<Volume>().expect("a volume").resolve(&without),
            Err(QuantityError::UnitUnknown { .. })
        ));
        assert_eq!("8h^3".parse::<Volume>().expect("a volume").to_string(), "8h3");
    }
}
