//! `EXT_mesh_gpu_instancing`: a node that places its mesh many times, by accessors of translations, rotations and scales.

use std::collections::BTreeMap;

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::Document;
use serde::Deserialize;

use super::super::error::{FileError, FileProblem};
use super::super::soup::Expansion;
use super::accessor;
use super::buffers::Buffers;
use super::checked;

/// The name of the extension.
pub(super) const NAME: &str = "EXT_mesh_gpu_instancing";

/// What the document says of instances: for the number of each node that has them, the accessors.
#[derive(Default)]
pub(super) struct Instancing(BTreeMap<usize, Attributes>);

/// The accessors of a node; other attributes are those of the program that wrote them.
#[derive(Deserialize)]
struct Attributes {
    #[serde(rename = "TRANSLATION")]
    translation: Option<u32>,
    #[serde(rename = "ROTATION")]
    rotation: Option<u32>,
    #[serde(rename = "SCALE")]
    scale: Option<u32>,
}

#[derive(Deserialize)]
struct Extended {
    #[serde(default)]
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    extensions: Option<Extensions>,
}

#[derive(Deserialize)]
struct Extensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    instancing: Option<Extension>,
}

#[derive(Deserialize)]
struct Extension {
    attributes: Attributes,
}

impl Instancing {
    /// Reads them from the document, if it uses the extension.
    pub(super) fn read(document: &Document, json: &[u8]) -> Result<Self, serde_json::Error> {
        if !document.extensions_used().chain(document.extensions_required()).any(|name| name == NAME) {
            return Ok(Self::default());
        }
        let document: Extended = serde_json::from_slice(json)?;
        let attributes = document.nodes.into_iter().enumerate().filter_map(|(node, content)| {
            let instancing = content.extensions?.instancing?;
            Some((node, instancing.attributes))
        });
        Ok(Self(attributes.collect()))
    }

    /// The copies of the mesh of `node`; `None` where it places its mesh once.
    pub(super) fn of(
        &self,
        node: usize,
        document: &Document,
        buffers: &Buffers<'_>,
        allowance: &mut Expansion,
    ) -> Result<Option<Copies>, FileError> {
        let Some(attributes) = self.0.get(&node) else { return Ok(None) };
        let mut values = |index: Option<u32>, width: usize| -> Result<_, FileError> {
            let Some(index) = index else { return Ok(None) };
            let values = checked::accessor(document, index as usize)?;
            accessor::instance_values(document, buffers, &values, width, allowance).map(Some)
        };
        let translations = values(attributes.translation, 3)?;
        let rotations = values(attributes.rotation, 4)?;
        let scales = values(attributes.scale, 3)?;
        let counts: Vec<usize> = [&translations, &rotations, &scales].into_iter().flatten().map(Vec::len).collect();
        let count = counts.first().copied().unwrap_or_default();
        if let Some(other) = counts.iter().find(|other| **other != count) {
            let problem = FileProblem::syntax(format!("{count} values of each kind for {NAME}"), other.to_string());
            return Err(FileError::item(format!("nodes[{node}]"), problem));
        }
        Ok(Some(Copies { translations, rotations, scales, count }))
    }
}

/// Copies of a mesh: the lists that are there have as many values as there are copies.
pub(super) struct Copies {
    translations: Option<Vec<[f64; 4]>>,
    rotations: Option<Vec<[f64; 4]>>,
    scales: Option<Vec<[f64; 4]>>,
    count: usize,
}

impl Copies {
    /// The transforms of the copies, relative to the node.
    pub(super) fn places(&self) -> impl Iterator<Item = DMat4> {
        let at = |list: &Option<Vec<[f64; 4]>>, n: usize| list.as_ref().map(|list| DVec4::from(list[n]));
        (0..self.count).map(move |n| {
            let rotation = at(&self.rotations, n).filter(|q| q.length_squared() > 0.0 && q.is_finite());
            DMat4::from_scale_rotation_translation(
                at(&self.scales, n).map_or(DVec3::ONE, DVec4::truncate),
                rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_vec4(q.normalize())),
                at(&self.translations, n).map_or(DVec3::ZERO, DVec4::truncate),
            )
        })
    }
}
