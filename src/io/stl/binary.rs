//! Binary STL: 80 bytes of anything, a count, then 50 bytes a facet.

use std::io::Write;

use glam::Vec3;

use super::super::error::{FileError, FileProblem, WriteError, WriteProblem};
use super::super::pieces::in_pieces;
use super::super::soup::{Soup, too_many_vertices};
use super::super::text::counted;
use super::normal;
use crate::io::Format;
use crate::mesh::TriMesh;
use crate::mesh::weld::first_of_equal_keys;

const HEADER: usize = 80;
/// Header and count.
pub(super) const PREFIX: usize = HEADER + 4;
const FACET: usize = 50;

fn count(bytes: &[u8]) -> Option<usize> {
    let field = bytes.get(HEADER..PREFIX)?;
    Some(u32::from_le_bytes(field.try_into().ok()?) as usize)
}

/// Whether the length is exactly what the count says, for at least one facet.
pub(in crate::io) fn is_exact(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|n| n > 0 && n.checked_mul(FACET).is_some_and(|body| bytes.len() - PREFIX == body))
}

/// Whether the length is that of whole facets, at least as many as the count says.
pub(in crate::io) fn looks_like(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|n| {
        let body = bytes.len() - PREFIX;
        body > 0 && body.is_multiple_of(FACET) && n <= body / FACET
    })
}

/// How many facets to read. A count above what is there means a file cut short. A count below
/// it is believed when the rest is not whole facets, and is otherwise taken as never filled in.
fn facets_to_read(bytes: &[u8], soup: &mut Soup) -> Result<usize, FileError> {
    let truncated = |expected: String| {
        let found = format!("the file ends after {} bytes", bytes.len());
        FileError::byte(bytes.len(), FileProblem::truncated(expected, found))
    };
    let Some(stated) = count(bytes) else {
        return Err(truncated("84 bytes of header and count".into()));
    };
    let body = bytes.len() - PREFIX;
    let (present, left_over) = (body / FACET, body % FACET);
    if stated > present {
        return Err(truncated(format!("{} of 50 bytes (bytes 80 to 83 say so)", counted(stated, "facet"))));
    }
    if stated == present {
        if left_over > 0 {
            soup.warnings.push(format!("{} after the last facet left out", counted(left_over, "byte")));
        }
        return Ok(stated);
    }
    if left_over == 0 {
        soup.warnings
            .push(format!("the header counts {} but {present} are there; all are read", counted(stated, "facet")));
        return Ok(present);
    }
    if stated == 0 {
        return Err(truncated(format!("a whole facet {} of 50 bytes", present + 1)));
    }
    let extra = body - stated * FACET;
    soup.warnings.push(format!("{} after the last of {stated} facets left out", counted(extra, "byte")));
    Ok(stated)
}

pub(super) fn read(bytes: &[u8]) -> Result<Soup, FileError> {
    let mut soup = Soup::new();
    let facets = facets_to_read(bytes, &mut soup)?;
    let facets = &bytes[PREFIX..PREFIX + FACET * facets];
    let count = facets.len() / FACET * 3;
    if count > u32::MAX as usize {
        return Err(too_many_vertices());
    }
    // The normal, 12 bytes, is recomputed by whoever needs it.
    let corner = |n: usize| point(&facets[FACET * (n / 3) + 12 + 12 * (n % 3)..][..12]);
    // Adding zero turns −0 into 0.
    let mut numbers = first_of_equal_keys(count, |n| (corner(n) + 0.0).to_array().map(f32::to_bits));
    for n in 0..count {
        // The first of equal ones comes first, so that it has its number already.
        let first = numbers[n] as usize;
        numbers[n] = match first == n {
            true => {
                soup.positions.push(corner(n).as_dvec3());
                soup.positions.len() as u32 - 1
            }
            false => numbers[first],
        };
    }
    soup.triangles = numbers.as_chunks::<3>().0.to_vec();
    Ok(soup)
}

fn point(bytes: &[u8]) -> Vec3 {
    let mut p = Vec3::ZERO;
    for (k, field) in bytes.chunks_exact(4).take(3).enumerate() {
        p[k] = f32::from_le_bytes([field[0], field[1], field[2], field[3]]);
    }
    p
}

/// Writes the facets with recomputed normals.
pub(in crate::io) fn write(mesh: &TriMesh, out: &mut dyn Write) -> Result<(), WriteError> {
    let count = u32::try_from(mesh.triangles.len()).map_err(|_| WriteProblem::TooLarge { format: Format::Stl })?;
    let mut header = [b' '; HEADER];
    let title = b"binary STL by meshwright";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    Ok(in_pieces(mesh.triangles.len(), out, |rows, bytes| {
        for triangle in rows {
            for p in [normal(mesh, triangle)].into_iter().chain(mesh.corners(triangle)) {
                for x in p.as_vec3().to_array() {
                    bytes.extend_from_slice(&x.to_le_bytes());
                }
            }
            bytes.extend_from_slice(&[0, 0]);
        }
    })?)
}
