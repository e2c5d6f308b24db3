//! Accessors: typed numbers in a buffer view, with sparse replacements.

use gltf_json::accessor::{Accessor, ComponentType, IndexComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

use super::super::error::{FileError, FileProblem};
use super::super::soup::Expansion;
use super::buffers::{Buffers, missing};

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

fn accessor(root: &Root, index: Index<Accessor>) -> Result<&Accessor, FileError> {
    let count = root.accessors.len();
    root.get(index).ok_or_else(|| FileError::new(missing(index.value(), count, "accessors")))
}

fn item(index: Index<Accessor>) -> String {
    format!("accessors[{}]", index.value())
}

/// The positions behind accessor `index`: floats, or integers of `KHR_mesh_quantization`.
pub(super) fn positions(
    root: &Root,
    buffers: &Buffers<'_>,
    index: Index<Accessor>,
    allowance: &mut Expansion,
) -> Result<Vec<[f64; 3]>, FileError> {
    let fail = |problem| FileError::item(item(index), problem);
    let accessor = accessor(root, index)?;
    let kind = component_type(accessor).map_err(fail)?;
    if !matches!(accessor.type_, Checked::Valid(Type::Vec3)) {
        return Err(fail(FileProblem::syntax("positions of type VEC3", "another type")));
    }
    let normalized = accessor.normalized;
    let decode = |field: &[u8]| {
        let mut p = [0.0; 3];
        for (x, part) in p.iter_mut().zip(field.chunks_exact(kind.size())) {
            *x = component(part, kind, normalized);
        }
        p
    };
    vectors(root, buffers, index, Shape { size: 3 * kind.size(), zero: [0.0; 3], decode }, allowance)
}

/// The colours behind accessor `index`: linear light from 0 to 1, then alpha.
pub(super) fn colours(
    root: &Root,
    buffers: &Buffers<'_>,
    index: Index<Accessor>,
    allowance: &mut Expansion,
) -> Result<Vec<[f32; 4]>, FileError> {
    let fail = |problem| FileError::item(item(index), problem);
    let accessor = accessor(root, index)?;
    let kind = component_type(accessor).map_err(fail)?;
    let channels = match (&accessor.type_, kind) {
        (Checked::Valid(Type::Vec3), ComponentType::F32 | ComponentType::U8 | ComponentType::U16) => 3,
        (Checked::Valid(Type::Vec4), ComponentType::F32 | ComponentType::U8 | ComponentType::U16) => 4,
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
    vectors(root, buffers, index, Shape { size: channels * kind.size(), zero, decode }, allowance)
}

/// The texture coordinates behind accessor `index`.
pub(super) fn coordinates(
    root: &Root,
    buffers: &Buffers<'_>,
    index: Index<Accessor>,
    allowance: &mut Expansion,
) -> Result<Vec<[f32; 2]>, FileError> {
    let fail = |problem| FileError::item(item(index), problem);
    let accessor = accessor(root, index)?;
    let kind = component_type(accessor).map_err(fail)?;
    if !matches!(accessor.type_, Checked::Valid(Type::Vec2)) {
        return Err(fail(FileProblem::syntax("coordinates of type VEC2", "another type")));
    }
    let normalized = accessor.normalized;
    let decode = |field: &[u8]| {
        let mut place = [0.0; 2];
        for (x, part) in place.iter_mut().zip(field.chunks_exact(kind.size())) {
            *x = component(part, kind, normalized) as f32;
        }
        place
    };
    vectors(root, buffers, index, Shape { size: 2 * kind.size(), zero: [0.0; 2], decode }, allowance)
}

/// The translations, rotations or scales of instances behind accessor `index`, each of `width` numbers.
pub(super) fn instance_values(
    root: &Root,
    buffers: &Buffers<'_>,
    index: Index<Accessor>,
    width: usize,
    allowance: &mut Expansion,
) -> Result<Vec<[f64; 4]>, FileError> {
    let fail = |problem| FileError::item(item(index), problem);
    let accessor = accessor(root, index)?;
    let kind = component_type(accessor).map_err(fail)?;
    let wanted = if width == 4 { Type::Vec4 } else { Type::Vec3 };
    if !matches!(&accessor.type_, Checked::Valid(found) if *found == wanted) {
        return Err(fail(FileProblem::syntax(format!("values of type VEC{width} for instances"), "another type")));
    }
    // Rotations in integers must be normalised; a file that forgets to say so can mean nothing else.
    let normalized = accessor.normalized || width == 4;
    let decode = |field: &[u8]| {
        let mut value = [0.0; 4];
        for (x, part) in value.iter_mut().zip(field.chunks_exact(kind.size())) {
            *x = component(part, kind, normalized);
        }
        value
    };
    vectors(root, buffers, index, Shape { size: width * kind.size(), zero: [0.0; 4], decode }, allowance)
}

/// How many values accessor `index` has, where it is there.
pub(super) fn count(root: &Root, index: Index<Accessor>) -> usize {
    root.get(index).map_or(0, |accessor| usize::try_from(accessor.count.0).unwrap_or(usize::MAX))
}

fn component_type(accessor: &Accessor) -> Result<ComponentType, FileProblem> {
    match &accessor.component_type {
        Checked::Valid(kind) => Ok(kind.0),
        Checked::Invalid => Err(FileProblem::syntax("a component type", "another value")),
    }
}

/// What the values of an accessor look like.
struct Shape<T, F> {
    /// Bytes of a value.
    size: usize,
    /// The value where there are no bytes.
    zero: T,
    /// The value of as many bytes.
    decode: F,
}

/// The values behind accessor `index`, with sparse ones replaced.
fn vectors<T: Copy>(
    root: &Root,
    buffers: &Buffers<'_>,
    index: Index<Accessor>,
    shape: Shape<T, impl Fn(&[u8]) -> T>,
    allowance: &mut Expansion,
) -> Result<Vec<T>, FileError> {
    let fail = |problem| FileError::item(item(index), problem);
    let accessor = accessor(root, index)?;
    let Shape { size, zero, decode } = shape;
    let count = accessor.count.0;
    allowance.spend(count).map_err(fail)?;
    let mut values: Vec<T> = match accessor.buffer_view {
        Some(view) => {
            let (bytes, stride) = buffers.view(root, view)?;
            let offset = accessor.byte_offset.unwrap_or_default().0;
            Fields::new(bytes, offset, stride, size, count).map_err(fail)?.iter().map(&decode).collect()
        }
        None => vec![zero; usize::try_from(count).unwrap_or_default()],
    };
    if let Some(sparse) = &accessor.sparse {
        let (bytes, _) = buffers.view(root, sparse.indices.buffer_view)?;
        let places =
            integers(bytes, sparse.indices.byte_offset.0, None, &sparse.indices.component_type, sparse.count.0)
                .map_err(fail)?;
        let (bytes, _) = buffers.view(root, sparse.values.buffer_view)?;
        let fields = Fields::new(bytes, sparse.values.byte_offset.0, None, size, sparse.count.0).map_err(fail)?;
        for (place, field) in places.into_iter().zip(fields.iter()) {
            let count = values.len();
            *values.get_mut(place as usize).ok_or_else(|| fail(missing(place as usize, count, "values")))? =
                decode(field);
        }
    }
    Ok(values)
}

/// The indices behind accessor `index`.
pub(super) fn indices(
    root: &Root,
    buffers: &Buffers<'_>,
    index: Index<Accessor>,
    allowance: &mut Expansion,
) -> Result<Vec<u32>, FileError> {
    let fail = |problem| FileError::item(item(index), problem);
    let accessor = accessor(root, index)?;
    let (Some(view), None, Checked::Valid(Type::Scalar)) = (accessor.buffer_view, &accessor.sparse, &accessor.type_)
    else {
        return Err(fail(FileProblem::syntax("scalar indices in a buffer view", "another kind of accessor")));
    };
    let kind = match &accessor.component_type {
        Checked::Valid(kind) => Checked::Valid(IndexComponentType(kind.0)),
        Checked::Invalid => Checked::Invalid,
    };
    allowance.spend(accessor.count.0).map_err(fail)?;
    let (bytes, stride) = buffers.view(root, view)?;
    integers(bytes, accessor.byte_offset.unwrap_or_default().0, stride, &kind, accessor.count.0).map_err(fail)
}

fn integers(
    bytes: &[u8],
    offset: u64,
    stride: Option<usize>,
    kind: &Checked<IndexComponentType>,
    count: u64,
) -> Result<Vec<u32>, FileProblem> {
    use ComponentType::{U8, U16, U32};
    let Checked::Valid(IndexComponentType(kind @ (U8 | U16 | U32))) = *kind else {
        return Err(FileProblem::syntax("indices of an unsigned integer type", "another type"));
    };
    let fields = Fields::new(bytes, offset, stride, kind.size(), count)?;
    Ok(fields.iter().map(|field| component(field, kind, false) as u32).collect())
}

/// The number in `field`; the caller sees to its size.
fn component(field: &[u8], kind: ComponentType, normalized: bool) -> f64 {
    let mut raw = [0; 4];
    raw[..field.len().min(4)].copy_from_slice(&field[..field.len().min(4)]);
    let bits = u32::from_le_bytes(raw);
    let (value, one) = match kind {
        ComponentType::I8 => (f64::from(bits as i8), 127.0),
        ComponentType::U8 => (f64::from(bits as u8), 255.0),
        ComponentType::I16 => (f64::from(bits as i16), 32767.0),
        ComponentType::U16 => (f64::from(bits as u16), 65535.0),
        ComponentType::U32 => (f64::from(bits), 1.0),
        ComponentType::F32 => (f64::from(f32::from_bits(bits)), 1.0),
    };
    if normalized { (value / one).max(-1.0) } else { value }
}
