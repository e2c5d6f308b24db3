//! Reading versions 1 to 3.

use glam::DVec3;

use super::super::numbers::{Cap, Kind, count};
use super::super::{GridFile, GridFormat, GridValues, all_finite};
use crate::io::error::{FileError, FileProblem};
use crate::io::text::{counted, quoted};

/// What the header says.
struct Header {
    kind: Kind,
    big: bool,
    fortran: bool,
    dims: [usize; 3],
    /// Where the numbers begin.
    data: usize,
}

pub(in crate::io::grids) fn read(bytes: &[u8], cap: Cap) -> Result<GridFile, FileError> {
    let header = header(bytes)?;
    let dims = header.dims;
    let width = header.kind.width();
    let there = bytes.len() - header.data;
    let wanted = count(dims).and_then(|count| count.checked_mul(width)).filter(|&wanted| wanted <= there);
    let Some(wanted) = wanted else {
        let expected = format!("{} x {} x {} numbers of {width} bytes", dims[0], dims[1], dims[2]);
        return Err(FileProblem::truncated(expected, format!("{there} bytes are there")).at_byte(bytes.len()));
    };
    let mut warnings = Vec::new();
    if there > wanted {
        warnings.push(format!("{} after the array left out", counted(there - wanted, "byte")));
    }
    // Turned, the values are there twice for a while.
    let turned_too = if header.fortran { 0 } else { size_of::<f32>() * (wanted / width) };
    cap.check_values(wanted / width, turned_too).map_err(|e| e.at_byte(header.data))?;
    let values = header.kind.decode(&bytes[header.data..header.data + wanted], header.big);
    let values = if header.fortran { values } else { turned(&values, dims) };
    all_finite(&values, dims)?;
    Ok(GridFile {
        format: GridFormat::Npy,
        origin: DVec3::ZERO,
        spacing: 1.0,
        dims,
        unit: None,
        band: None,
        values: GridValues::Dense(values),
        warnings,
    })
}

/// From z fastest to x fastest.
fn turned(values: &[f32], [width, height, depth]: [usize; 3]) -> Vec<f32> {
    let mut out = Vec::with_capacity(values.len());
    for z in 0..depth {
        for y in 0..height {
            out.extend((0..width).map(|x| values[z + depth * (y + height * x)]));
        }
    }
    out
}

fn header(bytes: &[u8]) -> Result<Header, FileError> {
    let short = || FileProblem::truncated("a NumPy header", "the file ends in it").at_byte(bytes.len());
    let version = *bytes.get(6).ok_or_else(short)?;
    let (start, length) = match version {
        1 => (10, bytes.get(8..10).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])))),
        2 | 3 => (12, bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)),
        _ => {
            let text =
                format!("version {version} of the format is not read here, 1 to 3 are: save it with NumPy again");
            return Err(FileProblem::unsupported(text).at_byte(6));
        }
    };
    let data = length.and_then(|length| length.checked_add(start)).filter(|&end| end <= bytes.len());
    let data = data.ok_or_else(short)?;
    let text = String::from_utf8_lossy(&bytes[start..data]);
    let field = |key: &str, expected: &str| {
        let after =
            [format!("'{key}'"), format!("\"{key}\"")].into_iter().find_map(|key| text.split_once(key.as_str()));
        let value = after.and_then(|(_, rest)| rest.trim_start().strip_prefix(':')).map(str::trim_start);
        value.ok_or_else(|| FileProblem::syntax(expected, quoted(text.as_bytes())).at_byte(start))
    };
    let (kind, big) = kind(field("descr", "`descr`, the type of the numbers,")?).map_err(|e| e.at_byte(start))?;
    let order = field("fortran_order", "`fortran_order`")?;
    let fortran = match (order.starts_with("True"), order.starts_with("False")) {
        (true, _) => true,
        (_, true) => false,
        _ => {
            let problem = FileProblem::syntax("True or False as `fortran_order`", quoted(order.as_bytes()));
            return Err(problem.at_byte(start));
        }
    };
    let dims = shape(field("shape", "`shape`")?).map_err(|e| e.at_byte(start))?;
    Ok(Header { kind, big, fortran, dims, data })
}

/// `'<f4'` and the like.
fn kind(text: &str) -> Result<(Kind, bool), FileProblem> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'));
    let name = quote.and_then(|quote| text[1..].split(quote).next()).unwrap_or("");
    let (big, code) = match name.as_bytes().first() {
        Some(b'>') => (true, &name[1..]),
        Some(b'<' | b'|' | b'=') => (false, &name[1..]),
        _ => (false, name),
    };
    let kind = match code {
        "f2" => Kind::F16,
        "f4" => Kind::F32,
        "f8" => Kind::F64,
        "i1" => Kind::I8,
        "i2" => Kind::I16,
        "i4" => Kind::I32,
        "i8" => Kind::I64,
        "u1" => Kind::U8,
        "u2" => Kind::U16,
        "u4" => Kind::U32,
        "u8" => Kind::U64,
        _ => {
            let text =
                format!("numbers of type {} are not read here: convert the array to float32", quoted(text.as_bytes()));
            return Err(FileProblem::Unsupported(text));
        }
    };
    Ok((kind, big))
}

/// `(10, 20, 30)`.
fn shape(text: &str) -> Result<[usize; 3], FileProblem> {
    let wrong = || FileProblem::syntax("a shape of three sizes above zero, x, y and z,", quoted(text.as_bytes()));
    let inner = text.strip_prefix('(').and_then(|rest| rest.split(')').next()).ok_or_else(wrong)?;
    let sizes = inner.split(',').map(str::trim).filter(|size| !size.is_empty());
    let sizes: Vec<usize> = sizes.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    sizes.try_into().ok().filter(|dims: &[usize; 3]| !dims.contains(&0)).ok_or_else(wrong)
}
