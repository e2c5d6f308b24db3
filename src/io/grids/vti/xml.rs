//! The elements of a VTK file, up to the appended numbers.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

/// What the elements say.
pub(super) struct Document<'a> {
    pub(super) file: Attributes,
    pub(super) image: Attributes,
    pub(super) pieces: Vec<Attributes>,
    pub(super) arrays: Vec<Array<'a>>,
    /// The `Scalars` of point and cell data.
    pub(super) scalars: [Option<String>; 2],
    pub(super) appended: Option<Appended<'a>>,
}

/// The attributes of an element, and where it stands.
#[derive(Default)]
pub(super) struct Attributes {
    pairs: Vec<(String, String)>,
    pub(super) byte: usize,
}

/// Whose data an array is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Field,
    Points,
    Cells,
}

/// A `DataArray` and what stands between its tags.
pub(super) struct Array<'a> {
    pub(super) section: Section,
    pub(super) attributes: Attributes,
    pub(super) text: &'a [u8],
}

/// The numbers after the elements.
#[derive(Clone, Copy)]
pub(super) struct Appended<'a> {
    /// From the byte after the underscore on, to the end of the file.
    pub(super) data: &'a [u8],
    pub(super) base64: bool,
    /// Where that byte is in the file.
    pub(super) byte: usize,
}

impl Attributes {
    fn of(element: &BytesStart<'_>, byte: usize) -> Result<Self, FileError> {
        let wrong = |found: String| FileProblem::syntax("name=\"value\"", found).at_byte(byte);
        let mut pairs = Vec::new();
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|e| wrong(e.to_string()))?;
            let value = attribute.unescape_value().map_err(|e| wrong(e.to_string()))?;
            pairs.push((String::from_utf8_lossy(attribute.key.as_ref()).into_owned(), value.into_owned()));
        }
        Ok(Self { pairs, byte })
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.pairs.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// `N` numbers apart by blanks; `None` where the attribute is not there.
    pub(super) fn numbers<T: std::str::FromStr, const N: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[T; N]>, FileError> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let numbers: Option<Vec<T>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        let wrong = || FileProblem::syntax(format!("{N} numbers as {name}"), quoted(text.as_bytes()));
        numbers.ok_or_else(|| wrong().at_byte(self.byte)).map(Some)
    }
}

/// Reads the elements of `bytes`.
pub(super) fn parse(bytes: &[u8]) -> Result<Document<'_>, FileError> {
    let mut parser = Parser {
        reader: Reader::from_reader(bytes),
        bytes,
        section: None,
        open: None,
        document: Document {
            file: Attributes::default(),
            image: Attributes::default(),
            pieces: Vec::new(),
            arrays: Vec::new(),
            scalars: [None, None],
            appended: None,
        },
        seen: [false; 2],
    };
    parser.reader.config_mut().expand_empty_elements = true;
    while parser.step()? {}
    match parser.seen {
        [true, true] => Ok(parser.document),
        _ => Err(FileProblem::syntax("the elements VTKFile and ImageData", "neither or one").at_byte(bytes.len())),
    }
}

struct Parser<'a> {
    reader: Reader<&'a [u8]>,
    bytes: &'a [u8],
    section: Option<Section>,
    /// An array whose end is still to come, and where its text begins.
    open: Option<(Section, Attributes, usize)>,
    document: Document<'a>,
    /// Whether VTKFile and ImageData have been there.
    seen: [bool; 2],
}

impl Parser<'_> {
    /// Reads one piece of XML; false at the end of what is wanted.
    fn step(&mut self) -> Result<bool, FileError> {
        let before = self.position();
        let event = self.reader.read_event();
        let event = event.map_err(|e| FileProblem::syntax("XML", e.to_string()).at_byte(before))?;
        match event {
            Event::Start(element) => self.start(&element, before),
            Event::End(element) => {
                match element.name().as_ref() {
                    b"DataArray" => self.end_array(before),
                    b"FieldData" | b"PointData" | b"CellData" => self.section = None,
                    b"VTKFile" => return Ok(false),
                    _ => {}
                }
                Ok(true)
            }
            Event::Eof => {
                let found = "the file ends";
                Err(FileProblem::truncated("the end of the element VTKFile", found).at_byte(self.bytes.len()))
            }
            _ => Ok(true),
        }
    }

    fn position(&self) -> usize {
        (self.reader.buffer_position() as usize).min(self.bytes.len())
    }

    fn start(&mut self, element: &BytesStart<'_>, byte: usize) -> Result<bool, FileError> {
        let attributes = Attributes::of(element, byte)?;
        match element.name().as_ref() {
            b"VTKFile" => {
                self.seen[0] = true;
                check_file(&attributes)?;
                self.document.file = attributes;
            }
            b"ImageData" => {
                self.seen[1] = true;
                self.document.image = attributes;
            }
            b"Piece" => self.document.pieces.push(attributes),
            b"FieldData" => self.section = Some(Section::Field),
            b"PointData" => {
                self.section = Some(Section::Points);
                self.document.scalars[0] = attributes.get("Scalars").map(str::to_owned);
            }
            b"CellData" => {
                self.section = Some(Section::Cells);
                self.document.scalars[1] = attributes.get("Scalars").map(str::to_owned);
            }
            b"DataArray" => {
                let start = self.position();
                self.open = self.section.map(|section| (section, attributes, start));
            }
            b"AppendedData" => {
                self.append(&attributes)?;
                return Ok(false);
            }
            _ => {}
        }
        Ok(true)
    }

    fn end_array(&mut self, end: usize) {
        if let Some((section, attributes, start)) = self.open.take() {
            let text = self.bytes.get(start..end).unwrap_or_default();
            self.document.arrays.push(Array { section, attributes, text });
        }
    }

    fn append(&mut self, attributes: &Attributes) -> Result<(), FileError> {
        let base64 = match attributes.get("encoding") {
            Some("raw") => false,
            Some("base64") | None => true,
            Some(other) => {
                let found = quoted(other.as_bytes());
                return Err(FileProblem::syntax("raw or base64 as encoding", found).at_byte(attributes.byte));
            }
        };
        let start = self.position();
        let rest = &self.bytes[start..];
        let blank = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        if rest.get(blank) != Some(&b'_') {
            let found = quoted(&rest[..rest.len().min(20)]);
            return Err(FileProblem::syntax("an underscore before the numbers", found).at_byte(start + blank));
        }
        let byte = start + blank + 1;
        self.document.appended = Some(Appended { data: &self.bytes[byte..], base64, byte });
        Ok(())
    }
}

fn check_file(file: &Attributes) -> Result<(), FileError> {
    match file.get("type") {
        Some("ImageData") => Ok(()),
        Some(other) => {
            let text = format!("it holds {}, not ImageData: resample it to an image", quoted(other.as_bytes()));
            Err(FileProblem::Unsupported(text).at_byte(file.byte))
        }
        None => Err(FileProblem::syntax("the attribute `type` of VTKFile", "none").at_byte(file.byte)),
    }
}
