//! Units of length that a file can state.

use std::fmt;
use std::str::FromStr;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unit {
    /// 10⁻⁶ m.
    Micrometre,
    /// 10⁻³ m.
    Millimetre,
    /// 10⁻² m.
    Centimetre,
    /// 0.0254 m.
    Inch,
    /// 0.3048 m.
    Foot,
    /// 1 m.
    Metre,
}

impl Unit {
    /// Every unit, the smallest first.
    pub const ALL: [Self; 6] =
        [Self::Micrometre, Self::Millimetre, Self::Centimetre, Self::Inch, Self::Foot, Self::Metre];

    /// Length of one unit in metres.
    pub fn metres(self) -> f64 {
        match self {
            Self::Micrometre => 1e-6,
            Self::Millimetre => 1e-3,
            Self::Centimetre => 1e-2,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
            Self::Metre => 1.0,
        }
    }

    /// The short sign: `um`, `mm`, `cm`, `in`, `ft`, `m`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Micrometre => "um",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
            Self::Foot => "ft",
            Self::Metre => "m",
        }
    }

    /// The word that the 3MF specification uses.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Micrometre => "micron",
            Self::Millimetre => "millimeter",
            Self::Centimetre => "centimeter",
            Self::Inch => "inch",
            Self::Foot => "foot",
            Self::Metre => "meter",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.symbol())
    }
}

/// A word that names no unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no unit of length known here; use um, mm, cm, in, ft or m")]
pub struct UnknownUnit(pub String);

impl FromStr for Unit {
    type Err = UnknownUnit;

    /// Symbols (`mm`) and words (`millimeter`, `millimetres`), in any case, one or several.
    fn from_str(text: &str) -> Result<Self, UnknownUnit> {
        let word = text.trim().trim_end_matches('.').to_ascii_lowercase();
        let word = match word.as_str() {
            "inches" => "inch",
            "feet" => "foot",
            word => word.strip_suffix('s').filter(|one| one.len() > 2).unwrap_or(word),
        };
        match word.strip_suffix("re").map(|stem| format!("{stem}er")).as_deref().unwrap_or(word) {
            "um" | "µm" | "μm" | "micron" | "micrometer" => Ok(Self::Micrometre),
            "mm" | "millimeter" => Ok(Self::Millimetre),
            "cm" | "centimeter" => Ok(Self::Centimetre),
            "in" | "inch" | "\"" => Ok(Self::Inch),
            "ft" | "foot" | "'" => Ok(Self::Foot),
            "m" | "meter" => Ok(Self::Metre),
            _ => Err(UnknownUnit(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_reads_its_own_names() {
        for unit in Unit::ALL {
            assert_eq!(unit.symbol().parse(), Ok(unit));
            assert_eq!(unit.word().to_uppercase().parse(), Ok(unit));
        }
        for (text, unit) in [
            ("millimetre", Unit::Millimetre),
            ("Millimeters", Unit::Millimetre),
            ("millimetres", Unit::Millimetre),
            ("microns", Unit::Micrometre),
            ("inches", Unit::Inch),
            ("in.", Unit::Inch),
            ("feet", Unit::Foot),
            (" metres ", Unit::Metre),
        ] {
            assert_eq!(text.parse(), Ok(unit), "{text}");
        }
        assert!("s".parse::<Unit>().is_err() && "ms".parse::<Unit>().is_err());
        assert_eq!("furlong".parse::<Unit>(), Err(UnknownUnit("furlong".into())));
    }
}
