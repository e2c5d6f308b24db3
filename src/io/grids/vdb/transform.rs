//! From index to model coordinates.

use glam::DVec3;

use super::super::{one_spacing, spacing_of_axes};
use super::cursor::Cursor;
use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

const WHAT: &str = "the transform";
/// A map of uniform scale and a translation.
pub(super) const SCALE_TRANSLATE: &str = "UniformScaleTranslateMap";

/// Position of index (0, 0, 0), and spacing.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<(DVec3, f64), FileError> {
    let start = cursor.at();
    let name = cursor.text(WHAT)?;
    let (origin, spacing) = match name.as_str() {
        "UniformScaleMap" | "ScaleMap" => (DVec3::ZERO, scale(cursor)?),
        SCALE_TRANSLATE | "ScaleTranslateMap" => (cursor.vector(WHAT)?, scale(cursor)?),
        "TranslationMap" => (cursor.vector(WHAT)?, Ok(1.0)),
        "AffineMap" | "UnitaryMap" => affine(cursor)?,
        other => {
            let text = format!(
                "the transform {} is not read here: resample the grid to a scale and a translation",
                quoted(other.as_bytes())
            );
            return Err(FileProblem::Unsupported(text).at_byte(start));
        }
    };
    let spacing = spacing.map_err(|problem| problem.at_byte(start))?;
    match origin.is_finite() {
        true => Ok((origin, spacing)),
        false => Err(cursor.wrong("a finite translation", origin.to_string())),
    }
}

type Spacing = Result<f64, FileProblem>;

/// The scale, and four vectors that follow from it.
fn scale(cursor: &mut Cursor<'_>) -> Result<Spacing, FileError> {
    let scale = cursor.vector(WHAT)?;
    for _ in 0..4 {
        cursor.vector(WHAT)?;
    }
    Ok(one_spacing(scale.to_array()))
}

/// Four rows: where the axes lead, and the translation.
fn affine(cursor: &mut Cursor<'_>) -> Result<(DVec3, Spacing), FileError> {
    let mut row = || -> Result<DVec3, FileError> {
        let row = cursor.vector(WHAT)?;
        cursor.f64(WHAT)?;
        Ok(row)
    };
    let axes = [row()?.to_array(), row()?.to_array(), row()?.to_array()];
    Ok((row()?, spacing_of_axes(axes)))
}
