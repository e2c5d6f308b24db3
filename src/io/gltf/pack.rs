//! A document and the bytes of its one buffer, as a file.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::super::error::{WriteError, WriteProblem};
use super::{BINARY_CHUNK, JSON_CHUNK, MAGIC};
use crate::io::Format;

/// Writes a document whose views are all of one buffer.
pub(super) fn write(mut document: Value, buffer: &[u8], format: Format, out: &mut dyn Write) -> Result<(), WriteError> {
    if let Some(members) = document.as_object_mut() {
        members.remove("buffers");
        members.retain(|_, list| list.as_array().is_none_or(|list| !list.is_empty()));
    }
    let padded = buffer.len().next_multiple_of(4);
    if !buffer.is_empty() {
        document["buffers"] = json!([{ "byteLength": padded }]);
    }
    let padding = &[0; 3][..padded - buffer.len()];
    if format == Format::Gltf {
        if !buffer.is_empty() {
            let whole = [buffer, padding].concat();
            document["buffers"][0]["uri"] =
                json!(format!("data:application/octet-stream;base64,{}", STANDARD.encode(whole)));
        }
        serde_json::to_writer(&mut *out, &document).map_err(std::io::Error::from)?;
        return Ok(out.write_all(b"\n")?);
    }
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let too_large = |_| WriteProblem::TooLarge { format };
    let length = |bytes: usize| u32::try_from(bytes).map_err(too_large);
    let binary = if buffer.is_empty() { 0 } else { 8 + padded };
    out.write_all(MAGIC)?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&length(12 + 8 + json.len() + binary)?.to_le_bytes())?;
    out.write_all(&length(json.len())?.to_le_bytes())?;
    out.write_all(JSON_CHUNK)?;
    out.write_all(&json)?;
    if !buffer.is_empty() {
        out.write_all(&length(padded)?.to_le_bytes())?;
        out.write_all(BINARY_CHUNK)?;
        out.write_all(buffer)?;
        out.write_all(padding)?;
    }
    Ok(())
}
