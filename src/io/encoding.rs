//! Texts in UTF-16 and byte order marks: readers get UTF-8 without a mark.

use std::borrow::Cow;

/// How far into a file UTF-16 is looked for where no mark tells it.
const HEAD: usize = 256;

/// The bytes as the readers take them. What is no text comes back as it is.
pub(super) fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] if is_text(rest, u16::from_le_bytes) => Cow::Owned(decoded(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] if is_text(rest, u16::from_be_bytes) => Cow::Owned(decoded(rest, u16::from_be_bytes)),
        _ if looks_like(bytes, u16::from_le_bytes) => Cow::Owned(decoded(bytes, u16::from_le_bytes)),
        _ if looks_like(bytes, u16::from_be_bytes) => Cow::Owned(decoded(bytes, u16::from_be_bytes)),
        _ => Cow::Borrowed(bytes),
    }
}

fn units(bytes: &[u8], order: fn([u8; 2]) -> u16) -> impl Iterator<Item = u16> {
    bytes.as_chunks::<2>().0.iter().map(move |pair| order(*pair))
}

/// Whether the beginning is text: after a byte order mark that is likely, but any two bytes may begin a binary file.
fn is_text(bytes: &[u8], order: fn([u8; 2]) -> u16) -> bool {
    let blank = |unit: u16| matches!(unit, 9..=13);
    units(&bytes[..bytes.len().min(HEAD)], order).all(|unit| unit >= 32 || blank(unit))
}

/// Whether a file without a mark begins with letters, blanks and the like of 16 bits each.
fn looks_like(bytes: &[u8], order: fn([u8; 2]) -> u16) -> bool {
    const LEAST: usize = 8;
    let head = &bytes[..bytes.len().min(HEAD)];
    let plain = |unit: u16| (32..127).contains(&unit) || matches!(unit, 9..=13);
    head.len() >= 2 * LEAST && head.len().is_multiple_of(2) && units(head, order).all(plain)
}

fn decoded(bytes: &[u8], order: fn([u8; 2]) -> u16) -> Vec<u8> {
    let characters = char::decode_utf16(units(bytes, order)).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    let mut text = String::with_capacity(bytes.len() / 2);
    text.extend(characters);
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_write_a_text_reads_alike() {
        let text = "v 0 0 0\r\n# Größe 😀\nv 1 0 0\n";
        let sixteen = |order: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(order).collect::<Vec<u8>>();
        let marked = |mark: &[u8], body: Vec<u8>| [mark, &body].concat();
        let (little, big) = (sixteen(u16::to_le_bytes), sixteen(u16::to_be_bytes));
        for bytes in [
            text.as_bytes().to_vec(),
            marked(b"\xef\xbb\xbf", text.as_bytes().to_vec()),
            marked(b"\xff\xfe", little.clone()),
            marked(b"\xfe\xff", big.clone()),
        ] {
            assert_eq!(String::from_utf8_lossy(&plain(&bytes)), text);
        }
        let ascii = |order: fn(u16) -> [u8; 2]| "OFF\n8 6 0\n0 0".encode_utf16().flat_map(order).collect::<Vec<u8>>();
        for bytes in [ascii(u16::to_le_bytes), ascii(u16::to_be_bytes)] {
            assert_eq!(plain(&bytes).as_ref(), b"OFF\n8 6 0\n0 0");
        }
        // Numbers that happen to begin as a mark does, and zeros.
        for bytes in [b"\xff\xfe\0\0\x01\0\0\0".as_slice(), &[0; 300], b"\xfe\xff\0\x01", b"v\0 \0"] {
            assert_eq!(plain(bytes).as_ref(), bytes);
        }
    }
}
