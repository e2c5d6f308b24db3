//! The zip package: finding the models in it, and unpacking no more than the file justifies.

use std::io::{self, Cursor, Read};

use quick_xml::events::Event;
use zip::ZipArchive;
use zip::result::ZipError;

use super::super::error::{FileError, FileProblem, Location};
use super::super::text::quoted;
use super::xml::{Xml, XmlError, attribute, text};

/// Unpacked bytes that any package may have.
const ALWAYS_ALLOWED: u64 = 64 << 20;
/// Beyond that, unpacked bytes for each byte of the package. Model files of real meshes shrink to
/// a sixth, very regular ones to a thirtieth; deflate can do a thousandth.
const LARGEST_RATIO: u64 = 50;

pub(super) struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    left: u64,
    limit: u64,
}

impl<'a> Package<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, FileError> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| zip_problem(e, "a zip package"))?;
        let limit = ALWAYS_ALLOWED.max((bytes.len() as u64).saturating_mul(LARGEST_RATIO));
        Ok(Self { archive, left: limit, limit })
    }

    /// Bytes unpacked so far.
    pub(super) fn bytes_read(&self) -> u64 {
        self.limit - self.left
    }

    /// The name of the model where the build is: the one that the package's relationships name,
    /// else the usual one, else any.
    pub(super) fn root_model(&mut self) -> Result<String, FileError> {
        let named = match self.find("_rels/.rels") {
            Some(index) => self.unpack(index, "_rels/.rels", root_target)?,
            None => None,
        };
        let usual = || self.find("3D/3dmodel.model").and_then(|i| self.archive.name_for_index(i));
        let any = || self.archive.file_names().filter(|name| name.ends_with(".model")).min();
        named
            .filter(|name| self.find(name).is_some())
            .or_else(|| usual().or_else(any).map(str::to_owned))
            .ok_or_else(|| FileError::item("package", self.no_model()))
    }

    /// What the package holds in place of a model.
    fn no_model(&self) -> FileProblem {
        const SHOWN: usize = 3;
        let has = |start: &str| self.archive.file_names().any(|name| name.starts_with(start));
        if ["word/", "xl/", "ppt/"].into_iter().any(has) {
            return FileProblem::Unsupported(
                "an Office document, not a 3MF package; give the file of the model".into(),
            );
        }
        let mut names: Vec<&str> = self.archive.file_names().filter(|name| !name.ends_with('/')).collect();
        names.sort_unstable();
        let more = if names.len() > SHOWN { ", …" } else { "" };
        let shown: Vec<String> = names.iter().take(SHOWN).map(|name| quoted(name.as_bytes())).collect();
        let held = if names.is_empty() { "nothing".to_owned() } else { shown.join(", ") + more };
        FileProblem::Unsupported(format!(
            "a ZIP archive without a 3D model (3D/3dmodel.model), so no 3MF package; it holds {held}: unpack it and give the mesh in it"
        ))
    }

    /// The files whose name, in small letters, is `wanted`, in order.
    pub(super) fn files(&self, wanted: impl Fn(&str) -> bool) -> Vec<String> {
        let names = self.archive.file_names().filter(|name| wanted(&name.to_ascii_lowercase()));
        let mut names: Vec<String> = names.map(str::to_owned).collect();
        names.sort_unstable();
        names
    }

    /// What `parse` makes of the file `name`.
    pub(super) fn read_xml<T>(
        &mut self,
        name: &str,
        parse: impl FnOnce(&mut Xml<'_>) -> Result<T, XmlError>,
    ) -> Result<T, FileError> {
        let none = || FileError::item("package", FileProblem::syntax(format!("the file {name}"), "none"));
        let index = self.find(name).ok_or_else(none)?;
        self.unpack(index, name, parse)
    }

    /// The bytes of the file `name`, or why there are none. They count as unpacked.
    pub(super) fn read_bytes(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let index = self.find(name).ok_or("the package has no such file")?;
        let file = self.archive.by_index(index).map_err(|error| error.to_string())?;
        let mut bytes = Vec::new();
        Capped { inner: file, left: &mut self.left }.read_to_end(&mut bytes).map_err(|error| error.to_string())?;
        Ok(bytes)
    }

    /// Names of a package start with a slash in references and without in the archive, and do not
    /// differ by case alone.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        let name = name.trim_start_matches('/');
        self.archive.index_for_name(name).or_else(|| {
            (0..self.archive.len())
                .find(|&i| self.archive.name_for_index(i).is_some_and(|n| n.eq_ignore_ascii_case(name)))
        })
    }

    fn unpack<T>(
        &mut self,
        index: usize,
        name: &str,
        parse: impl FnOnce(&mut Xml<'_>) -> Result<T, XmlError>,
    ) -> Result<T, FileError> {
        let limit = self.limit;
        let file = self.archive.by_index(index).map_err(|e| zip_problem(e, name))?;
        let capped = Capped { inner: file, left: &mut self.left };
        let mut xml = Xml::new(capped);
        parse(&mut xml).map_err(|error| {
            let byte = xml.position();
            let problem = match error {
                XmlError::Problem(problem) => problem,
                XmlError::Xml(error) => xml_problem(error, limit),
            };
            FileError::at(Location::Part { name: name.to_owned(), byte }, problem)
        })
    }
}

/// Ends with an error instead of handing out more than `left` bytes.
struct Capped<'a, R> {
    inner: R,
    left: &'a mut u64,
}

#[derive(Debug, thiserror::Error)]
#[error("unpacks to too much")]
struct Burst;

impl<R: Read> Read for Capped<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        *self.left = self.left.checked_sub(count as u64).ok_or_else(|| io::Error::other(Burst))?;
        Ok(count)
    }
}

fn xml_problem(error: quick_xml::Error, limit: u64) -> FileProblem {
    match &error {
        quick_xml::Error::Io(io) if io.get_ref().is_some_and(|inner| inner.is::<Burst>()) => {
            FileProblem::TooLarge { what: "unpacked bytes", limit }
        }
        _ => FileProblem::syntax("sound XML", error.to_string()),
    }
}

fn zip_problem(error: ZipError, what: &str) -> FileError {
    let problem = match error {
        ZipError::UnsupportedArchive(why) => FileProblem::Unsupported(format!("the zip package cannot be read: {why}")),
        other => FileProblem::syntax("a sound zip package", other.to_string()),
    };
    FileError::item(what, problem)
}

/// The target of the first relationship to a 3D model.
fn root_target(xml: &mut Xml<'_>) -> Result<Option<String>, XmlError> {
    loop {
        match xml.event()? {
            Event::Eof => return Ok(None),
            Event::Start(element) if element.local_name().as_ref() == b"Relationship" => {
                let kind = attribute(&element, b"Type").unwrap_or_default();
                if kind.trim_ascii_end().ends_with(b"/3dmodel")
                    && let Some(target) = attribute(&element, b"Target")
                {
                    return Ok(Some(text(&target)));
                }
            }
            _ => {}
        }
    }
}
