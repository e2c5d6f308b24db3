//! Numbers, quantities and names in words.

use glam::DVec3;

pub(crate) use crate::digits::{count, factor, number, rounded_down, rounded_up};
use crate::io::Unit;

/// The name of a file without its folders.
pub fn file_name(path: &str) -> &str {
    std::path::Path::new(path).file_name().and_then(|name| name.to_str()).unwrap_or(path)
}

/// The name of the model's unit, where it has one.
pub type UnitName<'a> = Option<&'a str>;

/// `1 triangle`, `2,000 triangles`; the word is given in the singular.
pub fn plural(n: usize, word: &str) -> String {
    let plural = match word {
        "body" => "bodies".to_string(),
        "cavity" => "cavities".to_string(),
        "vertex" => "vertices".to_string(),
        "patch" => "patches".to_string(),
        word => format!("{word}s"),
    };
    format!("{} {}", count(n), if n == 1 { word } else { &plural })
}

/// A number with the unit behind it, where there is one.
pub fn with_unit(number: &str, unit: UnitName<'_>) -> String {
    match unit {
        Some(unit) => format!("{number} {unit}"),
        None => number.to_string(),
    }
}

/// Several of a unit: `inches`.
pub fn several(unit: Unit) -> &'static str {
    match unit {
        Unit::Micrometre => "micrometres",
        Unit::Millimetre => "millimetres",
        Unit::Centimetre => "centimetres",
        Unit::Inch => "inches",
        Unit::Foot => "feet",
        Unit::Metre => "metres",
    }
}

/// A length.
pub fn length(x: f64, unit: UnitName<'_>) -> String {
    with_unit(&number(x), unit)
}

/// `97 x 80 x 104 mm`.
pub fn size(size: [f64; 3], unit: UnitName<'_>) -> String {
    with_unit(&size.map(number).join(" x "), unit)
}

/// A place; what is beside the rest nothing is 0.
pub fn around(at: DVec3) -> String {
    let least = 1e-9 * at.abs().max_element();
    at.to_array().map(|x| number(if x.abs() < least { 0.0 } else { x })).join(" ")
}

/// An area.
pub fn area(x: f64, unit: UnitName<'_>) -> String {
    match unit {
        Some(unit) => format!("{} {unit}²", number(x)),
        None => number(x),
    }
}

/// A volume.
pub fn volume(x: f64, unit: UnitName<'_>) -> String {
    match unit {
        Some(unit) => format!("{} {unit}³", number(x)),
        None => number(x),
    }
}

/// Bytes, in powers of 1000: `1.4 GB`.
pub fn bytes(n: u64) -> String {
    let mut value = n as f64;
    for unit in ["bytes", "kB", "MB", "GB"] {
        if value < 1000.0 {
            return if unit == "bytes" { format!("{n} bytes") } else { format!("{value:.1} {unit}") };
        }
        value /= 1000.0;
    }
    format!("{value:.1} TB")
}

/// Seconds.
pub fn seconds(s: f64) -> String {
    if s < 100.0 { format!("{s:.2} s") } else { format!("{}:{:02} min", (s / 60.0) as u64, (s % 60.0) as u64) }
}

/// By how much something changed, in percent.
pub fn percent_change(before: f64, after: f64) -> String {
    match before != 0.0 {
        true => match 100.0 * (after / before - 1.0) {
            change if change.abs() < 1000.0 => format!("{change:+.3} %"),
            change if change > 0.0 => format!("+{} %", number(change)),
            change => format!("{} %", number(change)),
        },
        false => "from nothing".into(),
    }
}

/// A share of a whole, in percent.
pub fn percent(part: usize, whole: usize) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    if part > 0 && share < 0.01 {
        "under 0.01 %".into()
    } else {
        format!("{} %", number((share * 100.0).round() / 100.0))
    }
}

/// `a, b and c`.
pub fn list(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_people_write_them() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (0.41309, "0.4131"),
            (12.0, "12"),
            (1234.6, "1,235"),
            (-86412.3, "-86,412"),
            (0.00012346, "0.0001235"),
            (1e38, "1e38"),
            (2.5e-9, "2.5e-9"),
        ] {
            assert_eq!(number(x), text);
        }
        assert_eq!([0, 7, 999, 1000, 1234567].map(count), ["0", "7", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn suggestions_are_rounded_to_the_safe_side() {
        assert_eq!(rounded_up(0.4131), "0.42");
        assert_eq!(rounded_up(0.3), "0.3");
        assert_eq!(rounded_up(1234.0), "1300");
        assert_eq!(rounded_down(0.0999), "0.099");
        assert_eq!(rounded_down(0.3), "0.3");
        assert_eq!(rounded_up(1.234e-12), "1.3e-12");
        assert_eq!([25.4, 1.0 / 25.4, 1e-3].map(factor), ["25.4", "0.0393701", "0.001"]);
    }

    #[test]
    fn small_words() {
        assert_eq!(plural(1, "body"), "1 body");
        assert_eq!(plural(2000, "triangle"), "2,000 triangles");
        assert_eq!(bytes(999), "999 bytes");
        assert_eq!(bytes(1_400_000_000), "1.4 GB");
        assert_eq!(percent(1, 1_000_000), "under 0.01 %");
        assert_eq!(percent(1, 3), "33.33 %");
        assert_eq!(list(&["a".into(), "b".into(), "c".into()]), "a, b and c");
        assert_eq!(seconds(0.5), "0.50 s");
        assert_eq!(seconds(125.0), "2:05 min");
        assert_eq!([1.5, 475.0].map(|after| percent_change(1.0, after)), ["+50.000 %", "+47,400 %"]);
    }
}
