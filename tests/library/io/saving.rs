//! Files are whole or not there.

use std::fs;
use std::io;

use meshwright::io::{WriteProblem, read, save_bytes, write, write_with};
use meshwright::mesh::TriMesh;

use super::support::{every_form, tetrahedron};

fn names(folder: &std::path::Path) -> Vec<String> {
    fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn every_form_is_saved_and_read() {
    let folder = tempfile::tempdir().unwrap();
    for options in every_form() {
        let path = folder.path().join(format!("mesh.{}", options.format));
        write_with(&path, &tetrahedron(), &options).unwrap();
        let loaded = read(&path).unwrap();
        assert_eq!((loaded.format, loaded.mesh.triangles.len()), (options.format, 4));
    }
    assert_eq!(names(folder.path()).len(), 7);
}

#[test]
fn a_failure_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    fs::write(&path, "old").unwrap();
    let error = write(&path, &TriMesh::default()).unwrap_err();
    assert!(matches!(error.problem, WriteProblem::NoTriangles));
    assert_eq!(error.path.as_deref(), Some(path.as_path()));
    let error = save_bytes(&path, |out| {
        out.write_all(&[b'x'; 100_000])?;
        Err(io::Error::other("no more"))
    });
    assert!(error.unwrap_err().to_string().contains("mesh.obj"));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(folder.path()), ["mesh.obj"]);
}

#[test]
fn a_missing_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("absent/mesh.stl");
    let error = write(&path, &tetrahedron()).unwrap_err();
    assert!(error.to_string().contains("absent"), "{error}");
    assert!(matches!(error.problem, WriteProblem::Io(_)));
}

#[cfg(unix)]
#[test]
fn links_devices_and_permissions_are_respected() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (target, link) = (folder.path().join("target"), folder.path().join("link"));
    fs::write(&target, "old").unwrap();
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("target", &link).unwrap();
    save_bytes(&link, |out| out.write_all(b"new")).unwrap();
    assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640);

    // A new file is as readable as one made in the ordinary way.
    let (ours, theirs) = (folder.path().join("ours"), folder.path().join("theirs"));
    save_bytes(&ours, |out| out.write_all(b"new")).unwrap();
    fs::write(&theirs, "new").unwrap();
    let mode = |path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&theirs));

    save_bytes("/dev/null", |out| out.write_all(b"away")).unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}
