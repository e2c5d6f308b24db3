//! What slicers say of the parts of an object: some are no material but take material away, or steer the slicer where they
//! are. It stands in files of their own beside the model.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use quick_xml::events::{BytesStart, Event};

use super::super::error::FileProblem;
use super::super::text::{integer, quoted};
use super::package::Package;
use super::xml::{Xml, XmlError, attribute, text};

/// What a piece of an object is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    /// Material.
    Part,
    /// Taken away from the material of its object.
    Negative,
    /// No solid: left out under this name.
    Helper(&'static str),
}

impl Role {
    /// The role of a word that slicers use, in small letters; `None` for others.
    fn of(word: &str) -> Option<Self> {
        let plain: String = word.chars().filter(|c| c.is_ascii_alphanumeric()).collect::<String>().to_ascii_lowercase();
        Some(match plain.as_str() {
            "normalpart" | "modelpart" | "part" => Self::Part,
            "negativepart" | "negativevolume" => Self::Negative,
            "modifierpart" | "parametermodifier" | "modifiermesh" | "modifier" => Self::Helper("modifier"),
            "supportenforcer" => Self::Helper("support enforcer"),
            "supportblocker" => Self::Helper("support blocker"),
            "seamposition" | "seamenforcer" | "seamblocker" => Self::Helper("seam mark"),
            "brim" | "brimpatch" => Self::Helper("brim"),
            _ => return None,
        })
    }

    /// The role of a setting of Cura that is on.
    pub(super) fn of_cura(setting: &[u8]) -> Option<Self> {
        Some(match setting.rsplit(|&byte| byte == b':').next()? {
            b"infill_mesh" | b"cutting_mesh" | b"mold_mesh" => Self::Helper("modifier"),
            b"support_mesh" => Self::Helper("support"),
            b"anti_overhang_mesh" => Self::Helper("support blocker"),
            _ => return None,
        })
    }

    /// The role of an object by the type that the format itself has.
    pub(super) fn of_type(kind: &[u8]) -> Self {
        match kind {
            b"support" | b"solidsupport" => Self::Helper("support object"),
            b"other" => Self::Helper("auxiliary object"),
            // A surface may be open; that is for others to judge.
            _ => Self::Part,
        }
    }
}

/// Some triangles of an object.
#[derive(Debug, Clone)]
pub(super) struct Volume {
    pub(super) name: String,
    pub(super) role: Role,
    /// By number.
    pub(super) triangles: RangeInclusive<usize>,
}

/// The roles in a package.
#[derive(Debug, Default)]
pub(super) struct Roles {
    /// Of a component of an object of the root model.
    components: BTreeMap<(u32, u32), (String, Role)>,
    /// Of ranges of triangles of an object of the root model.
    volumes: BTreeMap<u32, Vec<Volume>>,
    /// Roles that are not known.
    unknown: BTreeSet<String>,
    /// What went wrong.
    pub(super) warnings: Vec<String>,
}

impl Roles {
    /// The settings files of slicers in a package.
    pub(super) fn files(package: &Package<'_>) -> Vec<String> {
        let mut names = package.files(|name| name.starts_with("metadata/") && name.ends_with(".config"));
        // Settings of the print and of layers stand in files of the same ending.
        names.retain(|name| name.to_ascii_lowercase().contains("model"));
        names
    }

    /// Reads them from every settings file of a slicer in the package.
    pub(super) fn read(package: &mut Package<'_>) -> Self {
        let mut roles = Self::default();
        for name in Self::files(package) {
            if let Err(error) = package.read_xml(&name, |xml| roles.parse(xml)) {
                roles.warnings.push(format!("what the slicer says of the parts is not read: {error}"));
            }
        }
        for word in &roles.unknown {
            roles.warnings.push(format!("the role {} is not known here; taken as material", quoted(word.as_bytes())));
        }
        roles
    }

    /// The role and name of `component` of `object`; an object is a component of its own.
    pub(super) fn component(&self, object: u32, component: u32) -> Option<&(String, Role)> {
        self.components.get(&(object, component))
    }

    /// The ranges of triangles of `object`; nothing where one of material is all there is.
    pub(super) fn volumes(&self, object: u32) -> &[Volume] {
        match self.volumes.get(&object).map_or(&[][..], Vec::as_slice) {
            [Volume { role: Role::Part, .. }] => &[],
            volumes => volumes,
        }
    }

    fn parse(&mut self, xml: &mut Xml<'_>) -> Result<(), XmlError> {
        let (mut object, mut piece): (Option<u32>, Option<Piece>) = (None, None);
        loop {
            match xml.event()? {
                Event::Eof => return Ok(()),
                Event::Start(e) => match e.local_name().as_ref() {
                    b"object" => object = number(&e, b"id")?.and_then(|id| u32::try_from(id).ok()),
                    b"part" | b"volume" => piece = Some(Piece::of(&e)?),
                    b"metadata" => {
                        if let Some(piece) = &mut piece {
                            piece.setting(&e);
                        }
                    }
                    _ => {}
                },
                Event::End(e) => match e.local_name().as_ref() {
                    b"object" => object = None,
                    b"part" | b"volume" => {
                        if let (Some(object), Some(piece)) = (object, piece.take()) {
                            self.add(object, piece);
                        }
                    }
                    _ => {}
                },
                _ => {}
            }
        }
    }

    fn add(&mut self, object: u32, piece: Piece) {
        let role = match piece.role.as_deref().map(|word| Role::of(word).ok_or(word)) {
            Some(Ok(role)) => role,
            Some(Err(word)) => {
                self.unknown.insert(word.to_owned());
                Role::Part
            }
            None if piece.modifier => Role::Helper("modifier"),
            None => Role::Part,
        };
        let Piece { id, name, first, last, .. } = piece;
        match (first, last) {
            (Some(first), Some(last)) => {
                let volume = Volume { name, role, triangles: first..=last };
                self.volumes.entry(object).or_default().push(volume);
            }
            (Some(_), _) => {}
            _ => {
                if let Some(id) = id.and_then(|id| u32::try_from(id).ok()) {
                    self.components.insert((object, id), (name, role));
                }
            }
        }
    }
}

/// A part or a volume as the file has it.
#[derive(Default)]
struct Piece {
    id: Option<usize>,
    name: String,
    first: Option<usize>,
    last: Option<usize>,
    role: Option<String>,
    /// The older way to say it.
    modifier: bool,
}

impl Piece {
    fn of(element: &BytesStart<'_>) -> Result<Self, FileProblem> {
        let role = attribute(element, b"subtype").map(|value| text(&value));
        let [id, first, last] = [number(element, b"id")?, number(element, b"firstid")?, number(element, b"lastid")?];
        Ok(Self { id, first, last, role, ..Self::default() })
    }

    fn setting(&mut self, element: &BytesStart<'_>) {
        let value = || attribute(element, b"value").map(|value| text(&value)).unwrap_or_default();
        match attribute(element, b"key").as_deref() {
            Some(b"name") => self.name = value(),
            Some(b"volume_type" | b"part_type" | b"subtype") => self.role = Some(value()),
            Some(b"modifier") => self.modifier = value().trim() == "1",
            _ => {}
        }
    }
}

fn number(element: &BytesStart<'_>, name: &[u8]) -> Result<Option<usize>, FileProblem> {
    let Some(value) = attribute(element, name) else { return Ok(None) };
    let found = integer(value.trim_ascii()).and_then(|number| usize::try_from(number).ok());
    found.map(Some).ok_or_else(|| FileProblem::syntax("a whole number", quoted(&value)))
}
