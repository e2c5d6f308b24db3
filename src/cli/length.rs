//! Quantities as people type them: lengths, sizes in bytes, durations.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use super::words;
use crate::io::Unit;
use crate::pipeline::MAX_RESOLUTION;

/// A length as typed, not yet in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// A plain number: the file's own units.
    Plain(f64),
    /// A number with a unit: `0.4mm`.
    Unit(f64, Unit),
    /// Voxels: `2h`.
    Voxels(f64),
    /// Percent of the diagonal of the bounding box: `1%`.
    Percent(f64),
}

/// How far simplification may go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Simplify {
    /// Not at all.
    Off,
    /// As far as this.
    Within(Length),
}

impl FromStr for Simplify {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        if text == "off" { Ok(Self::Off) } else { text.parse().map(Self::Within) }
    }
}

impl fmt::Display for Simplify {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::Within(length) => length.fmt(f),
        }
    }
}

/// How far from the surface a field reaches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BandChoice {
    /// Over the whole lattice.
    Full,
    /// As far as this.
    Within(Length),
}

impl FromStr for BandChoice {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        if text == "full" { Ok(Self::Full) } else { text.parse().map(Self::Within) }
    }
}

impl fmt::Display for BandChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Full => f.write_str("full"),
            Self::Within(length) => length.fmt(f),
        }
    }
}

/// What a [`Length`] is measured against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The unit of the model, where the file or `--unit` says it.
    pub unit: Option<Unit>,
    /// Diagonal of the bounding box, model units.
    pub diagonal: f64,
    /// Voxel spacing, model units; `None` where the length *is* the voxel.
    pub voxel: Option<f64>,
}

/// Why a length, size or duration cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// Not a number followed by a known suffix.
    #[error("`{text}` is not {wanted}")]
    Malformed {
        /// What was typed.
        text: String,
        /// What would have been understood.
        wanted: &'static str,
    },
    /// Zero, negative or beyond all numbers.
    #[error("`{text}` is not above zero")]
    NotPositive {
        /// What was typed.
        text: String,
    },
    /// A length far beyond all that is measured.
    #[error("`{length}` is a length that cannot be meant in any unit")]
    Absurd {
        /// What was typed.
        length: String,
    },
    /// A length with a unit, for a model without one.
    #[error("`{length}` needs the unit of the model, and the file carries none")]
    UnitUnknown {
        /// What was typed.
        length: String,
    },
    /// The voxel given in voxels.
    #[error("`{length}` is given in voxels, but it is the voxel that is asked for")]
    VoxelItself {
        /// What was typed.
        length: String,
    },
}

const A_LENGTH: &str =
    "a length such as 0.4mm, 1in, 1% (of the bounding box diagonal), 2h (voxels) or 0.4 (in the file's units)";
const A_POINT: &str = "a length: decimals are written with a point, such as 1.5mm";
const A_SIZE: &str = "a size such as 500M, 2G or 1500000";
const A_DURATION: &str = "a duration such as 30s, 5m or 1h";

/// Number and suffix of `text`; the suffix is the trailing run of letters, `%` and quotes.
fn split(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let number = text.trim_end_matches(|c: char| c.is_alphabetic() || matches!(c, '%' | '"'));
    let suffix = &text[number.len()..];
    let value: f64 = number.trim_end().parse().ok()?;
    value.is_finite().then_some((value, suffix))
}

impl FromStr for Length {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let is_a_length =
            |text: &str| split(text).is_some_and(|(_, s)| matches!(s, "" | "h" | "%") || s.parse::<Unit>().is_ok());
        let comma = text.contains(',') && is_a_length(&text.replace(',', "."));
        let wanted = if comma { A_POINT } else { A_LENGTH };
        let malformed = || QuantityError::Malformed { text: text.into(), wanted };
        let (value, suffix) = split(text).ok_or_else(malformed)?;
        if value <= 0.0 {
            return Err(QuantityError::NotPositive { text: text.into() });
        }
        Ok(match suffix {
            "" => Self::Plain(value),
            "h" => Self::Voxels(value),
            "%" => Self::Percent(value),
            unit => Self::Unit(value, unit.parse().map_err(|_| malformed())?),
        })
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.number();
        // Nobody counts three hundred zeros.
        if (1e-9..1e15).contains(&value) {
            write!(f, "{value}")?
        } else {
            write!(f, "{value:e}")?
        }
        match self {
            Self::Plain(_) => Ok(()),
            Self::Unit(_, unit) => write!(f, "{unit}"),
            Self::Voxels(_) => f.write_str("h"),
            Self::Percent(_) => f.write_str("%"),
        }
    }
}

/// Numbers of a length that may be meant, in whatever unit; coordinates beyond the upper end are refused too.
const MEANT: std::ops::RangeInclusive<f64> = 1e-30..=1e15;

impl Length {
    /// The number that was typed.
    fn number(&self) -> f64 {
        let (Self::Plain(value) | Self::Unit(value, _) | Self::Voxels(value) | Self::Percent(value)) = *self;
        value
    }

    /// The length in model units.
    pub fn resolve(&self, scale: &Scale) -> Result<f64, QuantityError> {
        if !MEANT.contains(&self.number()) {
            return Err(QuantityError::Absurd { length: self.to_string() });
        }
        let length = match *self {
            Self::Plain(value) => value,
            Self::Percent(value) => value / 100.0 * scale.diagonal,
            Self::Unit(value, unit) => {
                let model = scale.unit.ok_or_else(|| QuantityError::UnitUnknown { length: self.to_string() })?;
                value * (unit.metres() / model.metres())
            }
            Self::Voxels(value) => {
                value * scale.voxel.ok_or_else(|| QuantityError::VoxelItself { length: self.to_string() })?
            }
        };
        if length.is_finite() && length > 0.0 {
            Ok(length)
        } else {
            Err(QuantityError::NotPositive { text: self.to_string() })
        }
    }
}

/// The radius of a ball.
pub fn parse_radius(text: &str) -> Result<Length, String> {
    text.parse().map_err(|error| match error {
        QuantityError::NotPositive { text } => {
            format!("`{text}` is not above zero, as a radius must be: `dilate` grows by it, `erode` shrinks by it")
        }
        error => error.to_string(),
    })
}

/// Voxels along the longest side of a box.
pub fn parse_resolution(text: &str) -> Result<u32, String> {
    let most = words::count(MAX_RESOLUTION as usize);
    match text.trim().parse::<i64>() {
        Ok(count) if (2..=i64::from(MAX_RESOLUTION)).contains(&count) => Ok(count as u32),
        Ok(_) => Err(format!("from 2 to {most} voxels are possible along the longest side of the model")),
        Err(_) => Err(format!("a whole number of voxels from 2 to {most} is needed; --voxel takes a length")),
    }
}

/// Bytes: a plain number, `K M G T` or `kB MB GB TB` (powers of 1000), or `KiB MiB GiB TiB` (powers of 1024).
pub fn parse_size(text: &str) -> Result<u64, QuantityError> {
    let malformed = || QuantityError::Malformed { text: text.into(), wanted: A_SIZE };
    let (value, suffix) = split(text).ok_or_else(malformed)?;
    let lower = suffix.to_ascii_lowercase();
    let (letter, base) = match lower.as_bytes() {
        [] | [b'b'] => (b'b', 1),
        [letter] | [letter, b'b'] => (*letter, 1000_u64),
        [letter, b'i', b'b'] => (*letter, 1024),
        _ => return Err(malformed()),
    };
    let power = match letter {
        b'b' => 0,
        b'k' => 1,
        b'm' => 2,
        b'g' => 3,
        b't' => 4,
        _ => return Err(malformed()),
    };
    let bytes = value * base.pow(power) as f64;
    if bytes < 1.0 {
        return Err(QuantityError::NotPositive { text: text.into() });
    }
    Ok(bytes as u64)
}

/// A duration: `ms`, `s`, `m` or `min`, `h`; a plain number is seconds. Zero is allowed.
pub fn parse_duration(text: &str) -> Result<Duration, QuantityError> {
    let malformed = || QuantityError::Malformed { text: text.into(), wanted: A_DURATION };
    let (value, suffix) = split(text).ok_or_else(malformed)?;
    let seconds = match suffix {
        "ms" => value / 1000.0,
        "" | "s" | "sec" => value,
        "m" | "min" => value * 60.0,
        "h" => value * 3600.0,
        _ => return Err(malformed()),
    };
    // Ten years: far beyond any run, and far below what the clock can add.
    Duration::try_from_secs_f64(seconds.min(3.2e8)).map_err(|_| malformed())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALE: Scale = Scale { unit: None, diagonal: 50.0, voxel: Some(0.25) };

    fn length(text: &str) -> Length {
        text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
    }

    #[test]
    fn every_way_of_giving_a_length_resolves_to_model_units() {
        let millimetres = Scale { unit: Some("mm".parse().unwrap()), ..SCALE };
        for (text, scale, expected) in [
            ("0.4", SCALE, 0.4),
            ("1e-3", SCALE, 1e-3),
            ("2h", SCALE, 0.5),
            ("1%", SCALE, 0.5),
            ("0.4mm", millimetres, 0.4),
            ("0.4 mm", millimetres, 0.4),
            ("1in", millimetres, 25.4),
            ("1e1mm", millimetres, 10.0),
        ] {
            let got = length(text).resolve(&scale).unwrap();
            assert!((got - expected).abs() <= 1e-12 * expected, "{text}: {got} instead of {expected}");
        }
    }

    #[test]
    fn a_length_with_a_unit_needs_a_model_with_one() {
        let error = length("0.4mm").resolve(&SCALE).unwrap_err();
        assert_eq!(error, QuantityError::UnitUnknown { length: "0.4mm".into() });
    }

    #[test]
    fn the_voxel_cannot_be_given_in_voxels() {
        let error = length("2h").resolve(&Scale { voxel: None, ..SCALE }).unwrap_err();
        assert_eq!(error, QuantityError::VoxelItself { length: "2h".into() });
    }

    #[test]
    fn nonsense_is_named() {
        for text in ["", "mm", "1e", "1furlong", "nan", "inf", "1mm2", "--", "1..2", "é", "1,5"] {
            assert!(matches!(text.parse::<Length>(), Err(QuantityError::Malformed { .. })), "{text}");
        }
        for text in ["0", "-1", "0%", "-2h"] {
            assert!(matches!(text.parse::<Length>(), Err(QuantityError::NotPositive { .. })), "{text}");
        }
        for text in ["1e300", "1e-300", "1e-300h", "1e300%"] {
            let error = length(text).resolve(&SCALE).unwrap_err();
            assert_eq!(error, QuantityError::Absurd { length: text.into() }, "{text}");
        }
        let wide = Scale { diagonal: f64::MAX, ..SCALE };
        assert!(matches!(length("1000%").resolve(&wide), Err(QuantityError::NotPositive { .. })));
        assert!(length("1%").resolve(&Scale { diagonal: 0.0, ..SCALE }).is_err());
    }

    #[test]
    fn sizes_in_both_bases() {
        for (text, bytes) in [
            ("1500000", 1_500_000),
            ("500M", 500_000_000),
            ("2G", 2_000_000_000),
            ("2GiB", 2 << 30),
            ("1.5KiB", 1536),
            ("3MB", 3_000_000),
            ("7b", 7),
        ] {
            assert_eq!(parse_size(text), Ok(bytes), "{text}");
        }
        for text in ["", "M", "-1M", "0", "2X", "1KKB", "nanG"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn durations() {
        for (text, milliseconds) in
            [("0s", 0), ("0", 0), ("250ms", 250), ("30s", 30_000), ("5m", 300_000), ("1h", 3_600_000)]
        {
            assert_eq!(parse_duration(text), Ok(Duration::from_millis(milliseconds)), "{text}");
        }
        assert!(parse_duration("1e300s").is_ok());
        for text in ["", "s", "-1s", "5 years"] {
            assert!(parse_duration(text).is_err(), "{text}");
        }
    }
}
