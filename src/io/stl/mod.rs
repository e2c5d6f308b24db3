//! STL: facets without shared vertices, binary or ASCII. Which of the two is told by the length
//! and the text, never by the word `solid` alone, which many binary files begin with.

mod ascii;
mod binary;

use glam::DVec3;

use super::error::FileError;
use super::{Format, Loaded};
use crate::mesh::TriMesh;

pub(super) use ascii::write as write_ascii;
pub(super) use binary::{is_exact as is_exactly_binary, looks_like as looks_binary, write as write_binary};

/// How far into a file the first `facet` is looked for.
const HEAD: usize = 4096;

/// Whether a text begins with a solid and soon goes on with facets or its end.
pub(super) fn looks_ascii(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let contains = |word: &[u8]| head.windows(word.len()).any(|w| w.eq_ignore_ascii_case(word));
    begins_with_solid(bytes) && !head.contains(&0) && (contains(b"facet") || contains(b"endsolid"))
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && text.get(5).is_none_or(u8::is_ascii_whitespace)
}

/// Reads either kind.
pub(super) fn read(bytes: &[u8]) -> Result<Loaded, FileError> {
    let too_short_for_binary = bytes.len() < binary::PREFIX && begins_with_solid(bytes) && !bytes.contains(&0);
    let ascii = !is_exactly_binary(bytes) && (looks_ascii(bytes) || too_short_for_binary);
    let soup = if ascii { ascii::read(bytes)? } else { binary::read(bytes)? };
    soup.finish(Format::Stl, None)
}

/// The unit normal of a triangle; zero where it has no area.
fn normal(mesh: &TriMesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    // Scaled first, so that the squares of very large or small edges neither overflow nor vanish.
    let (u, v) = (b - a, c - a);
    let scale = u.abs().max(v.abs()).max_element();
    if scale > 0.0 && scale.is_finite() { (u / scale).cross(v / scale).normalize_or_zero() } else { DVec3::ZERO }
}
