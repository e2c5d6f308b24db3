//! Reading versions 1 to 5: raw, gzip and text.

use flate2::read::MultiGzDecoder;
use glam::DVec3;

use super::super::numbers::{self, Cap, Kind};
use super::super::{GridFile, GridFormat, GridValues, all_finite, one_spacing, spacing_of_axes};
use super::header::{Field, Header};
use crate::io::Unit;
use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

pub(in crate::io::grids) fn read(bytes: &[u8], cap: Cap) -> Result<GridFile, FileError> {
    let header = Header::new(bytes)?;
    if let Some(field) = header.field(&["data file", "datafile"]) {
        let text =
            "its numbers are in another file, which is not read here: save it as one file (.nrrd, attached header)";
        return Err(FileProblem::unsupported(text).at_line(field.line));
    }
    let dims = dims(&header)?;
    let mut values = values(bytes, &header, dims, cap)?;
    all_finite(&values, dims)?;
    let mut warnings = Vec::new();
    if header.key("sign").is_some_and(|sign| sign.starts_with("positive inside")) {
        values.iter_mut().for_each(|value| *value = -*value);
        warnings.push("the file is positive inside; the values were turned".to_owned());
    }
    let (origin, spacing) = place(&header, &mut warnings)?;
    Ok(GridFile {
        format: GridFormat::Nrrd,
        origin,
        spacing,
        dims,
        unit: unit(&header, &mut warnings),
        band: header
            .key("band")
            .and_then(|band| band.parse().ok())
            .filter(|band: &f64| *band > 0.0 && band.is_finite()),
        values: GridValues::Dense(values),
        warnings,
    })
}

fn dims(header: &Header) -> Result<[usize; 3], FileError> {
    let dimension = header.needed(&["dimension"])?;
    if dimension.text != "3" {
        let text = format!("it has {} axes; a lattice of numbers has three", quoted(dimension.text.as_bytes()));
        return Err(FileProblem::Unsupported(text).at_line(dimension.line));
    }
    let sizes = header.needed(&["sizes"])?;
    let found: Option<Vec<usize>> = sizes.text.split_whitespace().map(|size| size.parse().ok()).collect();
    let dims: Option<[usize; 3]> = found.and_then(|found| found.try_into().ok());
    dims.filter(|dims| !dims.contains(&0)).ok_or_else(|| sizes.wrong("three sizes above zero"))
}

fn values(bytes: &[u8], header: &Header, dims: [usize; 3], cap: Cap) -> Result<Vec<f32>, FileError> {
    let kind = kind(header.needed(&["type"])?)?;
    let end = |problem: FileProblem| problem.at_byte(bytes.len());
    let length = numbers::count(dims).and_then(|count| count.checked_mul(kind.width()));
    let length = length.ok_or_else(|| end(FileProblem::truncated(format!("{dims:?} numbers"), "there are fewer")))?;
    let data = after_lines(&bytes[header.data..], skip(header, &["line skip", "lineskip"])?);
    let skipped = skip(header, &["byte skip", "byteskip"])?;
    let encoding = header.needed(&["encoding"])?;
    let count = length / kind.width();
    match encoding.text.to_ascii_lowercase().as_str() {
        "raw" => {
            let raw = raw(data, skipped, length).ok_or_else(|| {
                let expected = format!("{length} bytes of numbers");
                end(FileProblem::truncated(expected, format!("{} bytes are there", data.len())))
            })?;
            let big = big(header, kind)?;
            cap.check_values(count, 0).map_err(|e| e.at_byte(header.data))?;
            Ok(kind.decode(raw, big))
        }
        "gz" | "gzip" => {
            let skipped = u64::try_from(skipped).map_err(|_| encoding.wrong("`byte skip` of 0 or more with gzip"))?;
            let big = big(header, kind)?;
            let decode = |bytes: &[u8]| kind.decode(bytes, big);
            let values = cap.check_values(count, 0).and_then(|()| {
                numbers::unpack_numbers(MultiGzDecoder::new(data), skipped, count, decode, kind.width())
            });
            values.map_err(|e| e.at_byte(header.data))
        }
        "txt" | "text" | "ascii" => {
            let values = cap.check_values(count, 0).and_then(|()| numbers::from_text(data, count));
            values.map_err(|e| e.at_byte(header.data))
        }
        other => {
            let text = format!("the encoding {} is not read here: save it raw or as gzip", quoted(other.as_bytes()));
            Err(FileProblem::Unsupported(text).at_line(encoding.line))
        }
    }
}

/// Whether the highest byte comes first.
fn big(header: &Header, kind: Kind) -> Result<bool, FileError> {
    match header.field(&["endian"]) {
        Some(Field { text: "big", .. }) => Ok(true),
        Some(Field { text: "little", .. }) => Ok(false),
        None if kind.width() == 1 => Ok(false),
        Some(field) => Err(field.wrong("`little` or `big`")),
        None => Err(FileProblem::syntax("the field `endian`", "none").at_item("header")),
    }
}

/// The numbers of raw data; a skip of -1 means that they end the file.
fn raw(data: &[u8], skipped: i64, length: usize) -> Option<&[u8]> {
    let start = match usize::try_from(skipped) {
        Ok(skipped) => skipped,
        Err(_) => data.len().checked_sub(length)?,
    };
    data.get(start..start.checked_add(length)?)
}

fn skip(header: &Header, names: &[&str]) -> Result<i64, FileError> {
    let Some(field) = header.field(names) else { return Ok(0) };
    let least = if names[0].starts_with("byte") { -1 } else { 0 };
    field.text.parse().ok().filter(|&skip: &i64| skip >= least).ok_or_else(|| field.wrong("how many to skip"))
}

fn after_lines(mut data: &[u8], lines: i64) -> &[u8] {
    for _ in 0..lines {
        let Some(end) = data.iter().position(|&byte| byte == b'\n') else { return &[] };
        data = &data[end + 1..];
    }
    data
}

fn kind(field: Field<'_>) -> Result<Kind, FileError> {
    Ok(match field.text.to_ascii_lowercase().as_str() {
        "signed char" | "int8" | "int8_t" => Kind::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Kind::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => Kind::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => Kind::U16,
        "int" | "signed int" | "int32" | "int32_t" => Kind::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => Kind::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => Kind::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => Kind::U64,
        "float" => Kind::F32,
        "double" => Kind::F64,
        _ => return Err(field.wrong("a type of numbers, such as float,")),
    })
}

/// Position of the first voxel, and spacing.
fn place(header: &Header, warnings: &mut Vec<String>) -> Result<(DVec3, f64), FileError> {
    let at_line = |field: Field<'_>| move |problem: FileProblem| problem.at_line(field.line);
    let mut origin = DVec3::ZERO;
    let spacing = if let Some(field) = header.field(&["space directions"]) {
        spacing_of_axes(field.vectors()?).map_err(at_line(field))?
    } else if let Some(field) = header.field(&["spacings"]) {
        one_spacing(field.three()?).map_err(at_line(field))?
    } else {
        warnings.push("the file states no spacing; it was taken as 1".to_owned());
        1.0
    };
    if let Some(field) = header.field(&["space origin"]) {
        let [found]: [[f64; 3]; 1] = field.vectors()?;
        origin = DVec3::from(found);
        finite(origin, field)?;
    } else if let Some(field) = header.field(&["axis mins", "axismins"]) {
        let cells = header.field(&["centers", "centerings"]).is_some_and(|centers| centers.text.starts_with("cell"));
        origin = DVec3::from(field.three()?) + if cells { spacing / 2.0 } else { 0.0 };
        finite(origin, field)?;
    }
    Ok((origin, spacing))
}

fn finite(origin: DVec3, field: Field<'_>) -> Result<(), FileError> {
    if origin.is_finite() { Ok(()) } else { Err(field.wrong("finite numbers")) }
}

/// The unit, if it is one length for all axes.
fn unit(header: &Header, warnings: &mut Vec<String>) -> Option<Unit> {
    let field = header.field(&["space units"]).or_else(|| header.field(&["units"]))?;
    let mut words = field.text.split('"').map(str::trim).filter(|word| !word.is_empty());
    let first = words.next()?;
    let unit = first.parse().ok().filter(|_| words.all(|word| word == first));
    if unit.is_none() {
        warnings.push(format!("the units {} are not one unit of length known here", quoted(field.text.as_bytes())));
    }
    unit
}
