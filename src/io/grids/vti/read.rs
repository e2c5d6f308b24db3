//! Reading: one piece, one number for each point or cell.

use glam::DVec3;

use super::super::numbers::{Cap, count};
use super::super::{GridFile, GridFormat, GridValues, all_finite, one_spacing, spacing_of_axes};
use super::arrays::Storage;
use super::xml::{Array, Document, Section, parse};
use crate::io::Unit;
use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

/// Where the points of the image are.
struct Frame {
    origin: DVec3,
    spacing: f64,
    /// Points along x, y, z.
    points: [usize; 3],
}

pub(in crate::io::grids) fn read(bytes: &[u8], cap: Cap) -> Result<GridFile, FileError> {
    let document = parse(bytes)?;
    let mut frame = frame(&document)?;
    let array = chosen(&document)?;
    let mut warnings = left_out(&document, array);
    if array.section == Section::Cells {
        // A value of a cell stands for its middle; a side without cells is one cell thick.
        frame.origin += frame.spacing / 2.0;
        frame.points = frame.points.map(|points| (points - 1).max(1));
    }
    let dims = frame.points;
    let many = || FileProblem::truncated(format!("{dims:?} numbers"), "there are fewer").at_byte(array.attributes.byte);
    let storage = Storage::new(&document.file, cap)?;
    let mut values = storage.numbers(array, count(dims).ok_or_else(many)?, document.appended)?;
    all_finite(&values, dims)?;
    if remark(&document, "sign").is_some_and(|sign| sign.starts_with("positive inside")) {
        values.iter_mut().for_each(|value| *value = -*value);
        warnings.push("the file is positive inside; the values were turned".to_owned());
    }
    Ok(GridFile {
        format: GridFormat::Vti,
        origin: frame.origin,
        spacing: frame.spacing,
        dims,
        unit: remark(&document, "unit").and_then(|unit| unit.parse::<Unit>().ok()),
        band: band(&document),
        values: GridValues::Dense(values),
        warnings,
    })
}

fn frame(document: &Document<'_>) -> Result<Frame, FileError> {
    let image = &document.image;
    let wrong = |problem: FileProblem| problem.at_byte(image.byte);
    let extent = image.numbers::<i64, 6>("WholeExtent")?;
    let extent = extent.ok_or_else(|| wrong(FileProblem::syntax("the attribute WholeExtent", "none")))?;
    let points = [0, 1, 2].map(|k| {
        let cells = extent[2 * k + 1].checked_sub(extent[2 * k])?;
        usize::try_from(cells).ok()?.checked_add(1)
    });
    let [Some(x), Some(y), Some(z)] = points else {
        let found = quoted(image.get("WholeExtent").unwrap_or_default().as_bytes());
        return Err(wrong(FileProblem::syntax("a first and a last point along x, y and z", found)));
    };
    one_piece(document, extent)?;
    let spacing = image.numbers("Spacing")?.unwrap_or([1.0; 3]);
    let spacing = one_spacing(spacing).map_err(wrong)?;
    if let Some(d) = image.numbers::<f64, 9>("Direction")? {
        // Column k of the matrix is axis k.
        let axis = |k: usize| [d[k], d[k + 3], d[k + 6]];
        spacing_of_axes([axis(0), axis(1), axis(2)]).map_err(wrong)?;
    }
    let first = DVec3::new(extent[0] as f64, extent[2] as f64, extent[4] as f64);
    let origin = DVec3::from(image.numbers("Origin")?.unwrap_or([0.0; 3])) + first * spacing;
    match origin.is_finite() {
        true => Ok(Frame { origin, spacing, points: [x, y, z] }),
        false => Err(wrong(FileProblem::syntax("finite numbers as Origin", origin.to_string()))),
    }
}

fn one_piece(document: &Document<'_>, extent: [i64; 6]) -> Result<(), FileError> {
    let [piece] = document.pieces.as_slice() else {
        let text = format!("it has {} pieces; save it as one", document.pieces.len());
        return Err(FileProblem::Unsupported(text).at_byte(document.image.byte));
    };
    match piece.numbers::<i64, 6>("Extent")? {
        Some(part) if part != extent => {
            let text = "its piece does not cover the whole extent; save the whole as one piece";
            Err(FileProblem::unsupported(text).at_byte(piece.byte))
        }
        _ => Ok(()),
    }
}

/// The array of points, else of cells, that the file names as its scalars, else the first of single numbers.
fn chosen<'a, 'b>(document: &'b Document<'a>) -> Result<&'b Array<'a>, FileError> {
    let single = |array: &&Array<'_>| matches!(array.attributes.get("NumberOfComponents"), None | Some("0" | "1"));
    for (section, scalars) in [(Section::Points, &document.scalars[0]), (Section::Cells, &document.scalars[1])] {
        let arrays = || document.arrays.iter().filter(|array| array.section == section).filter(single);
        let named = arrays().find(|array| scalars.is_some() && array.attributes.get("Name") == scalars.as_deref());
        if let Some(array) = named.or_else(|| arrays().next()) {
            return Ok(array);
        }
    }
    let problem = FileProblem::syntax("an array of single numbers for points or cells", "none");
    Err(problem.at_byte(document.image.byte))
}

fn left_out(document: &Document<'_>, chosen: &Array<'_>) -> Vec<String> {
    let others = document.arrays.iter().filter(|array| array.section != Section::Field).count() - 1;
    let name = chosen.attributes.get("Name").unwrap_or_default();
    match others {
        0 => Vec::new(),
        _ => vec![format!("the array {} was read; {others} more were left out", quoted(name.as_bytes()))],
    }
}

fn field<'a>(document: &'a Document<'_>, name: &str) -> Option<&'a [u8]> {
    let mut fields = document.arrays.iter().filter(|array| array.section == Section::Field);
    let found = fields.find(|array| array.attributes.get("Name") == Some(name))?;
    matches!(found.attributes.get("format"), Some("ascii") | None).then_some(found.text)
}

fn band(document: &Document<'_>) -> Option<f64> {
    let text = std::str::from_utf8(field(document, "band")?).ok()?;
    text.trim().parse().ok().filter(|band: &f64| *band > 0.0 && band.is_finite())
}

/// A text among the field data: the codes of its characters and a zero.
fn remark(document: &Document<'_>, name: &str) -> Option<String> {
    let text = std::str::from_utf8(field(document, name)?).ok()?;
    let codes: Option<Vec<u8>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    Some(String::from_utf8_lossy(&codes?).trim_end_matches('\0').to_owned())
}
