//! The properties that hold the colour of a vertex or a face.

use super::super::colour::{LEVELS_OF_WHITE, Levels};
use super::header::{Element, Scalar};
use super::rows::Rows;

/// Where a row has its colour.
pub(super) struct Channels {
    /// Red, green and blue.
    colour: [usize; 3],
    alpha: Option<usize>,
}

impl Channels {
    /// The colour of `element`, if it has one of a single type; `levels` is told what that type counts to.
    pub(super) fn of(element: &Element, levels: &mut Levels, warnings: &mut Vec<String>) -> Option<Self> {
        let named = |name: &str| element.properties.iter().position(|p| p.name == name && p.list.is_none());
        let channel = |name: &str| named(name).or_else(|| named(&format!("diffuse_{name}")));
        let colour = [channel("red")?, channel("green")?, channel("blue")?];
        let alpha = channel("alpha");
        let kind = |property: usize| element.properties[property].scalar;
        let red = kind(colour[0]);
        if colour.into_iter().chain(alpha).any(|property| kind(property) != red) {
            warnings.push(format!("the colours of `{}` left out; their channels differ in type", element.name));
            return None;
        }
        match red {
            Scalar::U16 => levels.count_to(65535.0),
            // Floats count to 1 as a rule, but not always.
            Scalar::F32 | Scalar::F64 => {}
            // Wider integers hold the same numbers as bytes do.
            Scalar::U8 | Scalar::I8 | Scalar::I16 | Scalar::I32 | Scalar::U32 => levels.count_to(255.0),
        }
        Some(Self { colour, alpha })
    }

    /// The colour of the row last read.
    #[inline]
    pub(super) fn levels(&self, rows: &Rows<'_>) -> [f32; 4] {
        let [red, green, blue] = self.colour.map(|property| rows.scalar(property) as f32);
        [red, green, blue, self.alpha.map_or(LEVELS_OF_WHITE[3], |property| rows.scalar(property) as f32)]
    }
}
