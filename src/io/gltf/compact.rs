//! Leaving out of a document what nothing names any more: accessors, views and their bytes.

use serde_json::{Value, json};

use super::changed::{Patch, set};
use super::{OF_LOOKS, READ};

/// Extensions that name no accessors and no views.
const HARMLESS: [&str; 3] = ["KHR_lights_punctual", "KHR_node_visibility", "KHR_xmp_json_ld"];

/// Leaves out what nothing names. Of a document with an extension that may name something in ways unknown here, all stays.
pub(super) fn compact(patch: &mut Patch) {
    let extensions = patch.document["extensionsUsed"].as_array().cloned().unwrap_or_default();
    let is_known = |name: &str| {
        READ.contains(&name) || HARMLESS.contains(&name) || OF_LOOKS.iter().any(|start| name.starts_with(start))
    };
    if !extensions.iter().all(|name| name.as_str().is_some_and(is_known)) {
        return;
    }
    drop_unnamed(&mut patch.document, "accessors", accessors);
    drop_unnamed(&mut patch.document, "bufferViews", views);
    let range = |view: &Value| {
        let [start, length] = ["byteOffset", "byteLength"].map(|name| view[name].as_u64().unwrap_or(0) as usize);
        Some(start..start.checked_add(length)?)
    };
    let ranges: Option<Vec<_>> = patch.list("bufferViews").iter().map(range).collect();
    let Some(ranges) = ranges else { return };
    // Views may lie over one another; then the buffer is as small as it gets.
    let total = ranges.iter().fold(0usize, |sum, range| sum.saturating_add(range.len().next_multiple_of(4)));
    if total > patch.buffer.len() || ranges.iter().any(|range| range.end > patch.buffer.len()) {
        return;
    }
    let mut packed = Vec::with_capacity(total);
    for (n, range) in ranges.into_iter().enumerate() {
        if let Some(view) = patch.list("bufferViews").get_mut(n) {
            set(view, "byteOffset", json!(packed.len()));
        }
        packed.extend_from_slice(&patch.buffer[range]);
        packed.resize(packed.len().next_multiple_of(4), 0);
    }
    patch.buffer = packed;
}

/// Hands out every number that a document has.
type Visit = fn(&mut Value, &mut dyn FnMut(&mut Value));

/// Leaves the entries of a list out that no number leads to, and counts the others anew.
fn drop_unnamed(document: &mut Value, list: &str, visit: Visit) {
    let count = document[list].as_array().map_or(0, Vec::len);
    let mut named = vec![false; count];
    visit(document, &mut |number| {
        if let Some(named) = number.as_u64().and_then(|n| named.get_mut(n as usize)) {
            *named = true;
        }
    });
    let mut kept = 0usize;
    let numbers: Vec<usize> = named.iter().map(|&named| (kept, kept += usize::from(named)).0).collect();
    visit(document, &mut |number| {
        if let Some(&new) = number.as_u64().and_then(|n| numbers.get(n as usize)) {
            *number = json!(new);
        }
    });
    if let Some(list) = document.get_mut(list).and_then(Value::as_array_mut) {
        let mut named = named.into_iter();
        list.retain(|_| named.next() == Some(true));
    }
}

/// The entries of a list within a value.
fn each<'a>(value: &'a mut Value, list: &str) -> impl Iterator<Item = &'a mut Value> {
    value.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten()
}

/// The values of an object within a value.
fn members<'a>(value: &'a mut Value, object: &str) -> impl Iterator<Item = &'a mut Value> {
    let object = value.get_mut(object).and_then(Value::as_object_mut);
    object.into_iter().flat_map(|object| object.iter_mut().map(|(_, value)| value))
}

/// Every number of an accessor.
fn accessors(document: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for mesh in each(document, "meshes") {
        for primitive in each(mesh, "primitives") {
            members(primitive, "attributes").for_each(&mut *visit);
            primitive.get_mut("indices").into_iter().for_each(&mut *visit);
            for target in each(primitive, "targets") {
                target.as_object_mut().into_iter().flat_map(|target| target.iter_mut()).for_each(|(_, n)| visit(n));
            }
        }
    }
    for animation in each(document, "animations") {
        for sampler in each(animation, "samplers") {
            ["input", "output"].into_iter().for_each(|name| sampler.get_mut(name).into_iter().for_each(&mut *visit));
        }
    }
    for skin in each(document, "skins") {
        skin.get_mut("inverseBindMatrices").into_iter().for_each(&mut *visit);
    }
    for node in each(document, "nodes") {
        let instances = node.get_mut("extensions").and_then(|all| all.get_mut("EXT_mesh_gpu_instancing"));
        instances.into_iter().for_each(|instances| members(instances, "attributes").for_each(&mut *visit));
    }
}

/// Every number of a view.
fn views(document: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    for accessor in each(document, "accessors") {
        accessor.get_mut("bufferView").into_iter().for_each(&mut *visit);
        for part in ["indices", "values"] {
            let view = accessor.get_mut("sparse").and_then(|sparse| sparse.get_mut(part)?.get_mut("bufferView"));
            view.into_iter().for_each(&mut *visit);
        }
    }
    for image in each(document, "images") {
        image.get_mut("bufferView").into_iter().for_each(&mut *visit);
    }
}
