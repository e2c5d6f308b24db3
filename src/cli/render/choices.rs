//! From where a picture is seen, and what is taken away in front, as typed.

use glam::DVec3;

use crate::picture::View;

/// `--view`: a name, or the direction to the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewChoice {
    /// One of the names that the library knows.
    Named(&'static str, View),
    /// From the mesh to the viewer.
    From(DVec3),
}

impl ViewChoice {
    /// The view, of a mesh whose z axis points up.
    pub fn view(&self) -> View {
        match *self {
            Self::Named(_, view) => view,
            // Seen along z, up cannot be z.
            Self::From(from) if from.x == 0.0 && from.y == 0.0 => View { from, up: DVec3::Y },
            Self::From(from) => View { from, up: DVec3::Z },
        }
    }
}

impl std::fmt::Display for ViewChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Named(name, _) => f.write_str(name),
            Self::From(from) => write!(f, "{},{},{}", from.x, from.y, from.z),
        }
    }
}

/// Reads `--view`.
pub fn parse_view(text: &str) -> Result<ViewChoice, String> {
    let name = View::NAMES.into_iter().find(|name| *name == text);
    if let Some((name, view)) = name.and_then(|name| Some((name, View::named(name)?))) {
        return Ok(ViewChoice::Named(name, view));
    }
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers.as_slice() {
        &[x, y, z] if text.matches(',').count() == 2 && DVec3::new(x, y, z).is_finite() && [x, y, z] != [0.0; 3] => {
            Ok(ViewChoice::From(DVec3::new(x, y, z)))
        }
        _ => Err(format!("wanted one of {}, or the direction to the viewer, such as 1,-1,0.5", View::NAMES.join(", "))),
    }
}

/// Reads one name of `--views`.
pub fn parse_named(text: &str) -> Result<ViewChoice, String> {
    match parse_view(text) {
        Ok(view @ ViewChoice::Named(..)) => Ok(view),
        _ => Err(format!("wanted names with commas between them, of {}", View::NAMES.join(", "))),
    }
}

/// Reads a share: 0.4 or 40%.
pub fn parse_opacity(text: &str) -> Result<f32, String> {
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f32>().map(|percent| percent / 100.0),
        None => text.trim().parse(),
    };
    let share = share.ok().filter(|share| (0.05..=1.0).contains(share));
    share.ok_or_else(|| "wanted a share from 0.05 to 1, or from 5% to 100%".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_by_name_and_by_direction() {
        for name in View::NAMES {
            assert_eq!(parse_view(name).map(|view| view.to_string()), Ok(name.to_string()));
        }
        assert_eq!(parse_view("1,-2,0.5"), Ok(ViewChoice::From(DVec3::new(1.0, -2.0, 0.5))));
        assert_eq!(parse_view("0,0,2").map(|view| view.view().up), Ok(DVec3::Y));
        for text in ["", "above", "1,2", "1,2,3,4", "0,0,0", "nan,0,1", "1,x,2,3"] {
            assert!(parse_view(text).is_err(), "{text}");
        }
        assert!(parse_named("top").is_ok() && parse_named("0,0,1").is_err());
    }

    #[test]
    fn shares_as_typed() {
        assert_eq!([parse_opacity("0.4"), parse_opacity("40%"), parse_opacity("1")], [Ok(0.4), Ok(0.4), Ok(1.0)]);
        for text in ["", "0", "-1", "2", "400%", "nan", "x%"] {
            assert!(parse_opacity(text).is_err(), "{text}");
        }
    }
}
