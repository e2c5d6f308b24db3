//! What every fuzz target asks of a reader: no panic, and either an error with a message or a
//! mesh that keeps the promise and can be written and read again.

use meshwright::io::{Carried, Format, WriteOptions, encode_coloured, read_bytes, read_grid_bytes};

/// Reads `data` as `format` and checks what comes out.
pub fn check(data: &[u8], format: Format) {
    let _ = Format::detect(data, None);
    let loaded = match read_bytes(data, Some(format), None) {
        Ok(loaded) => loaded,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let mesh = &loaded.mesh;
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
    assert!(!loaded.parts.is_empty());
    assert!(loaded.parts.iter().all(|p| p.triangles.start < p.triangles.end && p.triangles.end <= mesh.triangles.len()));
    assert!(loaded.texture.as_ref().is_none_or(|texture| texture.fits(mesh)));
    if let Some(negative) = &loaded.negative {
        assert!(!negative.mesh.triangles.is_empty() && negative.mesh.positions.iter().all(|p| p.is_finite()));
        assert!(negative.mesh.triangles.iter().flatten().all(|&v| (v as usize) < negative.mesh.positions.len()));
    }
    // PLY holds doubles and the colours of vertices or faces, so nothing may change on the way.
    if mesh.triangles.len() < 10_000 {
        let mut bytes = Vec::new();
        let colours = loaded.colours.as_ref();
        encode_coloured(mesh, colours, &WriteOptions::new(Format::Ply), &mut bytes).expect("what was read can be written");
        let again = read_bytes(&bytes, None, None).expect("what was written can be read");
        assert_eq!(&again.mesh, mesh);
        match colours {
            Some(colours) if colours.carried_by(Format::Ply, mesh) == Carried::Wholly => assert_eq!(again.colours.as_ref(), Some(colours)),
            Some(_) => assert!(again.colours.is_some()),
            None => assert_eq!(again.colours, None),
        }
    }
}

/// A 3MF package for `data`: itself, or, since a mutated zip rarely gets past its checksums, the
/// data as the model, or as the settings of a slicer beside a model, in a sound package.
pub fn packed(data: &[u8]) -> Vec<u8> {
    if data.starts_with(b"PK") {
        return data.to_vec();
    }
    use std::io::Write;
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    const MODEL: &[u8] = include_bytes!("seeds/three_mf/roles.model");
    let files = match data.starts_with(b"<config") {
        true => vec![("3D/3dmodel.model", MODEL), ("Metadata/model_settings.config", data)],
        false => vec![("3D/3dmodel.model", data)],
    };
    let written = files.into_iter().try_for_each(|(name, content)| {
        zip.start_file(name, options).map_err(std::io::Error::from).and_then(|()| zip.write_all(content))
    });
    written.and_then(|()| Ok(zip.finish()?.into_inner())).unwrap_or_default()
}

/// Reads `data` as a grid of the format that it begins as, and asks for some of its values.
pub fn check_grid(data: &[u8]) {
    let file = match read_grid_bytes(data, None, None) {
        Ok(file) => file,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    assert!(file.spacing > 0.0 && file.origin.is_finite() && !file.dims.contains(&0));
    let last = file.dims.map(|count| i32::try_from(count - 1).unwrap_or(i32::MAX));
    for [x, y, z] in [[0, 0, 0], last, last.map(|k| k / 2)] {
        assert!(file.at([x, y, z].into()).is_some_and(f32::is_finite));
    }
}
