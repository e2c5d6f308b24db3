//! Accessors: typed numbers in a buffer view, with sparse replacements.

use gltf::accessor::{DataType, Dimensions};
use gltf::json::validation::Checked;
use gltf::{Accessor, Document};

use super::super::error::{FileError, FileProblem};
use super::super::soup::Expansion;
use super::buffers::Buffers;
use super::checked::{self, missing};

/// A view of fields that are known to lie within their buffer.
struct Fields<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Fields<'a> {
    /// `count` fields of `size` bytes from byte `offset`, `stride` bytes apart.
    fn new(bytes: &'a [u8], offset: u64, stride: Option<usize>, size: usize, count: u64) -> Result<Self, FileProblem> {
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(FileProblem::syntax(format!("a stride of at least {size} bytes"), stride.to_string()));
        }
        let all =
            count.checked_sub(1).map_or(Some(0), |gaps| gaps.checked_mul(stride as u64)?.checked_add(size as u64));
        let end = all.and_then(|all| all.checked_add(offset));
        match (end, usize::try_from(offset), usize::try_from(count)) {
            (Some(end), Ok(offset), Ok(count)) if end <= bytes.len() as u64 => {
                Ok(Self { bytes: &bytes[offset..], stride, size, count })
            }
            _ => {
                let expected = format!("{count} values of {size} bytes from byte {offset}");
                Err(FileProblem::truncated(expected, format!("the buffer view has {} bytes", bytes.len())))
            }
        }
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |i| &bytes[i * stride..i * stride + size])
    }
}

fn item(accessor: &Accessor<'_>) -> String {
    format!("accessors[{}]", accessor.index())
}

/// The positions behind an accessor: floats, or integers of `KHR_mesh_quantization`.
pub(super) fn positions(
    document: &Document,
    buffers: &Buffers<'_>,
    accessor: &Accessor<'_>,
    allowance: &mut Expansion,
) -> Result<Vec<[f64; 3]>, FileError> {
    let fail = |problem| FileError::item(item(accessor), problem);
    let kind = checked::data_type(document, accessor).map_err(fail)?;
    if checked::dimensions(document, accessor) != Some(Dimensions::Vec3) {
        return Err(fail(FileProblem::syntax("positions of type VEC3", "another type")));
    }
    let normalized = accessor.normalized();
    let decode = |field: &[u8]| {
        let mut p = [0.0; 3];
        for (x, part) in p.iter_mut().zip(field.chunks_exact(kind.size())) {
            *x = component(part, kind, normalized);
        }
        p
    };
    vectors(document, buffers, accessor, ValueForm { size: 3 * kind.size(), zero: [0.0; 3], decode }, allowance)
}

/// The colours behind an accessor: linear light from 0 to 1, then alpha.
pub(super) fn colours(
    document: &Document,
    buffers: &Buffers<'_>,
    accessor: &Accessor<'_>,
    allowance: &mut Expansion,
) -> Result<Vec<[f32; 4]>, FileError> {
    let fail = |problem| FileError::item(item(accessor), problem);
    let kind = checked::data_type(document, accessor).map_err(fail)?;
    let channels = match (checked::dimensions(document, accessor), kind) {
        (Some(Dimensions::Vec3), DataType::F32 | DataType::U8 | DataType::U16) => 3,
        (Some(Dimensions::Vec4), DataType::F32 | DataType::U8 | DataType::U16) => 4,
        _ => {
            let expected = "colours of type VEC3 or VEC4 in floats or unsigned integers of 8 or 16 bits";
            return Err(fail(FileProblem::syntax(expected, "another type")));
        }
    };
    let decode = |field: &[u8]| {
        let mut colour = [1.0; 4];
        for (x, part) in colour.iter_mut().zip(field.chunks_exact(kind.size())) {
            // Integers must be normalised; a file that forgets to say so can mean nothing else.
            *x = component(part, kind, true) as f32;
        }
        colour
    };
    let mut zero = [0.0; 4];
    zero[channels..].fill(1.0);
    vectors(document, buffers, accessor, ValueForm { size: channels * kind.size(), zero, decode }, allowance)
}

/// The texture coordinates behind an accessor.
pub(super) fn coordinates(
    document: &Document,
    buffers: &Buffers<'_>,
    accessor: &Accessor<'_>,
    allowance: &mut Expansion,
) -> Result<Vec<[f32; 2]>, FileError> {
    let fail = |problem| FileError::item(item(accessor), problem);
    let kind = checked::data_type(document, accessor).map_err(fail)?;
    if checked::dimensions(document, accessor) != Some(Dimensions::Vec2) {
        return Err(fail(FileProblem::syntax("coordinates of type VEC2", "another type")));
    }
    let normalized = accessor.normalized();
    let decode = |field: &[u8]| {
        let mut place = [0.0; 2];
        for (x, part) in place.iter_mut().zip(field.chunks_exact(kind.size())) {
            *x = component(part, kind, normalized) as f32;
        }
        place
    };
    vectors(document, buffers, accessor, ValueForm { size: 2 * kind.size(), zero: [0.0; 2], decode }, allowance)
}

/// The translations, rotations or scales of instances behind an accessor, each of `width` numbers.
pub(super) fn instance_values(
    document: &Document,
    buffers: &Buffers<'_>,
    accessor: &Accessor<'_>,
    width: usize,
    allowance: &mut Expansion,
) -> Result<Vec<[f64; 4]>, FileError> {
    let fail = |problem| FileError::item(item(accessor), problem);
    let kind = checked::data_type(document, accessor).map_err(fail)?;
    let wanted = if width == 4 { Dimensions::Vec4 } else { Dimensions::Vec3 };
    if checked::dimensions(document, accessor) != Some(wanted) {
        return Err(fail(FileProblem::syntax(format!("values of type VEC{width} for instances"), "another type")));
    }
    // Rotations in integers must be normalised; a file that forgets to say so can mean nothing else.
    let normalized = accessor.normalized() || width == 4;
    let decode = |field: &[u8]| {
        let mut value = [0.0; 4];
        for (x, part) in value.iter_mut().zip(field.chunks_exact(kind.size())) {
            *x = component(part, kind, normalized);
        }
        value
    };
    vectors(document, buffers, accessor, ValueForm { size: width * kind.size(), zero: [0.0; 4], decode }, allowance)
}

/// What the values of an accessor look like.
struct ValueForm<T, F> {
    /// Bytes of a value.
    size: usize,
    /// The value where there are no bytes.
    zero: T,
    /// The value of as many bytes.
    decode: F,
}

/// The values behind an accessor, with sparse ones replaced.
fn vectors<T: Copy>(
    document: &Document,
    buffers: &Buffers<'_>,
    accessor: &Accessor<'_>,
    shape: ValueForm<T, impl Fn(&[u8]) -> T>,
    allowance: &mut Expansion,
) -> Result<Vec<T>, FileError> {
    let fail = |problem| FileError::item(item(accessor), problem);
    let ValueForm { size, zero, decode } = shape;
    let count = accessor.count() as u64;
    allowance.spend(count).map_err(fail)?;
    let mut values: Vec<T> = match checked::view_of(document, accessor) {
        Some(view) => {
            let (bytes, stride) = buffers.view(document, view)?;
            let offset = accessor.offset() as u64;
            Fields::new(bytes, offset, stride, size, count).map_err(fail)?.iter().map(&decode).collect()
        }
        None => vec![zero; accessor.count()],
    };
    if let Some(sparse) = checked::sparse(document, accessor) {
        let (bytes, _) = buffers.view(document, sparse.indices.buffer_view.value())?;
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err(fail(not_unsigned()));
        };
        let places = integers(bytes, sparse.indices.byte_offset.0, None, kind.0, sparse.count.0).map_err(fail)?;
        let (bytes, _) = buffers.view(document, sparse.values.buffer_view.value())?;
        let fields = Fields::new(bytes, sparse.values.byte_offset.0, None, size, sparse.count.0).map_err(fail)?;
        for (place, field) in places.into_iter().zip(fields.iter()) {
            let count = values.len();
            *values.get_mut(place as usize).ok_or_else(|| fail(missing(place as usize, count, "values")))? =
                decode(field);
        }
    }
    Ok(values)
}

/// The indices behind an accessor.
pub(super) fn indices(
    document: &Document,
    buffers: &Buffers<'_>,
    accessor: &Accessor<'_>,
    allowance: &mut Expansion,
) -> Result<Vec<u32>, FileError> {
    let fail = |problem| FileError::item(item(accessor), problem);
    let view = checked::view_of(document, accessor).filter(|_| checked::sparse(document, accessor).is_none());
    let (Some(view), Some(Dimensions::Scalar)) = (view, checked::dimensions(document, accessor)) else {
        return Err(fail(FileProblem::syntax("scalar indices in a buffer view", "another kind of accessor")));
    };
    let kind = checked::data_type(document, accessor).map_err(|_| fail(not_unsigned()))?;
    allowance.spend(accessor.count() as u64).map_err(fail)?;
    let (bytes, stride) = buffers.view(document, view)?;
    integers(bytes, accessor.offset() as u64, stride, kind, accessor.count() as u64).map_err(fail)
}

fn not_unsigned() -> FileProblem {
    FileProblem::syntax("indices of an unsigned integer type", "another type")
}

fn integers(
    bytes: &[u8],
    offset: u64,
    stride: Option<usize>,
    kind: DataType,
    count: u64,
) -> Result<Vec<u32>, FileProblem> {
    if !matches!(kind, DataType::U8 | DataType::U16 | DataType::U32) {
        return Err(not_unsigned());
    }
    let fields = Fields::new(bytes, offset, stride, kind.size(), count)?;
    Ok(fields.iter().map(|field| component(field, kind, false) as u32).collect())
}

/// The number in `field`; the caller sees to its size.
fn component(field: &[u8], kind: DataType, normalized: bool) -> f64 {
    let mut raw = [0; 4];
    raw[..field.len().min(4)].copy_from_slice(&field[..field.len().min(4)]);
    let bits = u32::from_le_bytes(raw);
    let (value, one) = match kind {
        DataType::I8 => (f64::from(bits as i8), 127.0),
        DataType::U8 => (f64::from(bits as u8), 255.0),
        DataType::I16 => (f64::from(bits as i16), 32767.0),
        DataType::U16 => (f64::from(bits as u16), 65535.0),
        DataType::U32 => (f64::from(bits), 1.0),
        DataType::F32 => (f64::from(f32::from_bits(bits)), 1.0),
    };
    if normalized { (value / one).max(-1.0) } else { value }
}
