//! XML files of a package, event by event.

use std::borrow::Cow;
use std::io::{BufReader, Read};

use quick_xml::events::{BytesStart, Event};

use super::super::error::FileProblem;

/// An XML file being read, event by event.
pub(super) struct Xml<'a> {
    reader: quick_xml::Reader<BufReader<Box<dyn Read + 'a>>>,
    buffer: Vec<u8>,
}

impl<'a> Xml<'a> {
    /// The XML that `bytes` hands out.
    pub(super) fn new(bytes: impl Read + 'a) -> Self {
        let mut reader = quick_xml::Reader::from_reader(BufReader::new(Box::new(bytes) as Box<dyn Read + 'a>));
        reader.config_mut().expand_empty_elements = true;
        Self { reader, buffer: Vec::new() }
    }

    /// How many bytes have been taken apart.
    pub(super) fn position(&self) -> u64 {
        self.reader.buffer_position()
    }

    /// The next event.
    pub(super) fn event(&mut self) -> Result<Event<'_>, XmlError> {
        self.buffer.clear();
        Ok(self.reader.read_event_into(&mut self.buffer)?)
    }
}

/// What goes wrong within an XML file.
pub(super) enum XmlError {
    Problem(FileProblem),
    Xml(quick_xml::Error),
}

impl From<quick_xml::Error> for XmlError {
    fn from(error: quick_xml::Error) -> Self {
        Self::Xml(error)
    }
}

impl From<FileProblem> for XmlError {
    fn from(problem: FileProblem) -> Self {
        Self::Problem(problem)
    }
}

/// The raw value of an attribute, by its name without a prefix.
pub(super) fn attribute<'a>(element: &'a BytesStart<'_>, name: &[u8]) -> Option<Cow<'a, [u8]>> {
    let mut attributes = element.attributes();
    // The check for repeated names takes time that grows with the square of their number.
    let found = attributes.with_checks(false).flatten().find(|a| a.key.local_name().as_ref() == name);
    found.map(|a| a.value)
}

/// An attribute's value with its entities replaced, where it has none that are unknown.
pub(super) fn text(value: &[u8]) -> String {
    let raw = String::from_utf8_lossy(value);
    quick_xml::escape::unescape(&raw).map(Cow::into_owned).unwrap_or_else(|_| raw.clone().into_owned())
}
