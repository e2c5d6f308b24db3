//! Changing a few places of an XML file and leaving all the rest of it as it is, byte for byte.

use std::ops::Range;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// What stands at a place of an XML file.
pub(super) enum Found<'a> {
    /// A start tag, and whether it is an end tag too.
    Start(BytesStart<'a>, bool),
    /// The end tag of this local name.
    End(Vec<u8>),
    /// Text, comments and the like.
    Other,
}

/// Hands out every piece of an XML file and where it stands.
pub(super) fn scan<'a>(
    text: &'a [u8],
    mut visit: impl FnMut(&Found<'a>, Range<usize>),
) -> Result<(), quick_xml::Error> {
    let mut reader = Reader::from_reader(text);
    loop {
        let start = reader.buffer_position() as usize;
        let found = match reader.read_event()? {
            Event::Eof => return Ok(()),
            Event::Start(element) => Found::Start(element, false),
            Event::Empty(element) => Found::Start(element, true),
            Event::End(element) => Found::End(element.local_name().as_ref().to_vec()),
            _ => Found::Other,
        };
        visit(&found, start..reader.buffer_position() as usize);
    }
}

/// A start tag with attributes of other values, or with more of them. Values stand as they are written.
pub(super) fn tag(element: &BytesStart<'_>, is_empty: bool, changes: &[(&str, String)]) -> Vec<u8> {
    let mut written = b"<".to_vec();
    written.extend_from_slice(element.name().as_ref());
    let mut put = |name: &[u8], value: &[u8]| {
        written.push(b' ');
        written.extend_from_slice(name);
        // A value in single quotes may have double ones within.
        let quote = if value.contains(&b'"') { b'\'' } else { b'"' };
        written.extend_from_slice(&[b'=', quote]);
        written.extend_from_slice(value);
        written.push(quote);
    };
    let mut met = vec![false; changes.len()];
    let mut attributes = element.attributes();
    for attribute in attributes.with_checks(false).flatten() {
        let change = changes.iter().position(|(name, _)| name.as_bytes() == attribute.key.as_ref());
        match change {
            Some(n) => {
                met[n] = true;
                put(attribute.key.as_ref(), changes[n].1.as_bytes());
            }
            None => put(attribute.key.as_ref(), &attribute.value),
        }
    }
    for ((name, value), _) in changes.iter().zip(met).filter(|(_, met)| !met) {
        put(name.as_bytes(), value.as_bytes());
    }
    written.extend_from_slice(if is_empty { b"/>" } else { b">" });
    written
}

/// What takes the place of ranges of a file.
#[derive(Default)]
pub(super) struct Splices(Vec<(Range<usize>, Vec<u8>)>);

impl Splices {
    pub(super) fn put(&mut self, range: Range<usize>, bytes: Vec<u8>) {
        self.0.push((range, bytes));
    }

    /// The file with all of them. Where two begin at one place, the one that was put first comes first.
    pub(super) fn applied_to(mut self, text: &[u8]) -> Vec<u8> {
        self.0.sort_by_key(|(range, _)| range.start);
        let mut changed = Vec::with_capacity(text.len());
        let mut at = 0;
        for (range, bytes) in self.0 {
            changed.extend_from_slice(text.get(at..range.start).unwrap_or_default());
            changed.extend_from_slice(&bytes);
            at = at.max(range.end);
        }
        changed.extend_from_slice(text.get(at..).unwrap_or_default());
        changed
    }
}
