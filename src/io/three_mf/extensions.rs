//! Extensions of the format: which a model uses, and which of these are not read.

use std::collections::{BTreeMap, BTreeSet};

use quick_xml::events::BytesStart;

use super::super::error::FileProblem;
use super::super::text::quoted;
use super::xml::text;

/// Name spaces whose elements are read, or change nothing about the shape.
const READ: [&str; 6] = [
    "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    "http://schemas.slic3r.org/3mf/2017/06",
    "http://schemas.bambulab.com/package/2021",
];

/// A piece of the address of an extension, and what it is for.
const KNOWN: [(&str, &str); 8] = [
    ("booleanoperations", "boolean operations"),
    ("beamlattice", "beam lattices"),
    ("volumetric", "volumetric data"),
    ("implicit", "implicit shapes"),
    ("displacement", "displaced surfaces"),
    ("securecontent", "encrypted content"),
    ("slice", "slices"),
    ("trianglesets", "sets of triangles"),
];

/// The extensions of one model.
#[derive(Default)]
pub(super) struct Extensions {
    /// Addresses by prefix.
    declared: BTreeMap<Vec<u8>, String>,
    /// Prefixes of elements.
    used: BTreeSet<Vec<u8>>,
    /// Prefixes that the model says are required.
    required: Vec<Vec<u8>>,
}

impl Extensions {
    /// Takes note of an element's name and of what it declares.
    pub(super) fn meet(&mut self, element: &BytesStart<'_>) {
        if let Some(prefix) = element.name().prefix() {
            self.used.insert(prefix.as_ref().to_vec());
        }
        let mut attributes = element.attributes();
        for attribute in attributes.with_checks(false).flatten() {
            match attribute.key.as_ref() {
                b"requiredextensions" => {
                    self.required = attribute.value.split(u8::is_ascii_whitespace).map(<[u8]>::to_vec).collect();
                    self.required.retain(|prefix| !prefix.is_empty());
                }
                // A name space without a prefix is that of the element itself.
                b"xmlns" => {
                    self.declared.insert(attribute.value.to_vec(), text(&attribute.value));
                    self.used.insert(attribute.value.to_vec());
                }
                key => {
                    if let Some(prefix) = key.strip_prefix(b"xmlns:") {
                        self.declared.insert(prefix.to_vec(), text(&attribute.value));
                    }
                }
            }
        }
    }

    fn unread<'a>(&'a self, prefixes: impl Iterator<Item = &'a Vec<u8>>) -> BTreeSet<String> {
        let addresses = prefixes.filter_map(|prefix| self.declared.get(prefix));
        addresses.filter(|address| !READ.contains(&address.as_str())).map(|address| described(address)).collect()
    }

    /// The extensions that are used and not read, in words.
    pub(super) fn unread_used(&self) -> BTreeSet<String> {
        self.unread(self.used.iter())
    }

    /// Refuses a model that requires what is not read.
    pub(super) fn check(&self) -> Result<(), FileProblem> {
        let undeclared =
            self.required.iter().find(|prefix| !self.declared.contains_key(*prefix)).map(|prefix| quoted(prefix));
        match self.unread(self.required.iter()).into_iter().next().or(undeclared) {
            Some(extension) => Err(FileProblem::Unsupported(format!(
                "it requires the extension {extension}, which is not read here; export it as plain meshes"
            ))),
            None => Ok(()),
        }
    }
}

fn described(address: &str) -> String {
    let known = KNOWN.iter().find(|(piece, _)| address.contains(piece));
    known.map_or_else(|| quoted(address.as_bytes()), |(_, purpose)| format!("for {purpose}"))
}
