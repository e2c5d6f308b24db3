//! Writing: to a file or a stream, verified before it appears under its name.

use std::io::Write;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::entries::OutputEntry;
use super::exit::Failure;
use super::session::{Drafted, Session};
use super::side::write_at_once;
use super::streams::is_direct;
use super::streams::unwritable;
use super::streams::{hex, is_stream, sha256};
use super::target::Target;
use crate::io::{self, DistanceSamples, GridFormat, Loaded, Paint, WriteError, WriteProblem};
use crate::mesh::TriMesh;
use crate::progress::Stage;

/// Writes `mesh` with its colours and textures, if it has some, reads it back, and lets `judge` look at what was read. Only when that is content
/// and the run ends well does the file appear under its name, with those that belong beside it; before, it has a temporary name in the same folder,
/// and if anything fails nothing is left. Streams and devices get their bytes after the judgement.
pub fn write_verified<'a, T>(
    target: &Target,
    mesh: &TriMesh,
    paint: impl Into<Paint<'a>>,
    session: &Session,
    judge: impl FnOnce(&Loaded) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    session.progress.stage(Stage::Write)?;
    let paint = paint.into();
    let judge = |read: &Loaded| {
        let verdict = judge(read)?;
        super::paint::check_texture(read, &paint)?;
        Ok(verdict)
    };
    if is_direct(&target.path) {
        return write_direct(target, mesh, &paint, session, judge);
    }
    let written = write_file(target, mesh, &Paint { beside: Some(&target.path), ..paint }, session, judge)?;
    if let Some(texture) = paint.texture {
        super::paint::write_beside(target, texture, session)?;
    }
    Ok(written)
}

fn write_direct<T>(
    target: &Target,
    mesh: &TriMesh,
    paint: &Paint<'_>,
    session: &Session,
    judge: impl FnOnce(&Loaded) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    let mut bytes = Vec::new();
    encode(target, mesh, paint, &mut bytes)?;
    session.progress.stage(Stage::Verify)?;
    let verdict = judge(&read_back(&bytes, target)?)?;
    session.progress.check()?;
    write_at_once(&target.path, &bytes)?;
    Ok((entry(target, &bytes), verdict))
}

fn write_file<T>(
    target: &Target,
    mesh: &TriMesh,
    paint: &Paint<'_>,
    session: &Session,
    judge: impl FnOnce(&Loaded) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    let failed = |e: &std::io::Error| unwritable(&target.path, e);
    let Drafted { file, path } = session.draft(&target.path)?;
    let mut buffer = std::io::BufWriter::with_capacity(1 << 20, &file);
    encode(target, mesh, paint, &mut buffer)?;
    buffer.flush().map_err(|e| failed(&e))?;
    drop(buffer);
    file.sync_all().map_err(|e| failed(&e))?;
    session.progress.stage(Stage::Verify)?;
    let bytes = std::fs::read(path).map_err(|e| failed(&e))?;
    let verdict = judge(&read_back(&bytes, target)?)?;
    Ok((entry(target, &bytes), verdict))
}

/// Writes what `encode` makes, in `format`. A regular file is read back and compared by its hash before it appears.
pub fn write_grid(
    path: &Path,
    samples: &DistanceSamples<'_>,
    format: GridFormat,
    session: &Session,
) -> Result<OutputEntry, Failure> {
    let mut bytes = 0;
    let mut hashed = |out: &mut dyn Write| -> Result<String, Failure> {
        let mut hashing = Hashing { out, hash: Sha256::new(), bytes: 0, session };
        let written = io::encode_grid(samples, format, &mut hashing).and_then(|()| hashing.flush());
        // A run that was stopped shows as a failure to write; what stopped it comes first.
        session.progress.check()?;
        written.map_err(|e| unwritable(path, &e))?;
        bytes = hashing.bytes;
        Ok(hex(&hashing.hash.finalize()))
    };
    let sha256 = if is_stream(path) {
        hashed(&mut std::io::stdout().lock())?
    } else if is_direct(path) {
        let mut file = std::fs::OpenOptions::new().write(true).open(path).map_err(|e| unwritable(path, &e))?;
        hashed(&mut file)?
    } else {
        let failed = |e: &std::io::Error| unwritable(path, e);
        let draft = session.draft(path)?;
        let sha256 = hashed(&mut std::io::BufWriter::with_capacity(1 << 20, &draft.file))?;
        draft.file.sync_all().map_err(|e| failed(&e))?;
        session.progress.stage(Stage::Verify)?;
        let found = sha256_of_file(&draft.path, session);
        session.progress.check()?;
        if found.map_err(|e| failed(&e))? != sha256 {
            return Err(Failure::internal("the file does not hold what was written to it; it was removed"));
        }
        sha256
    };
    let path = if is_stream(path) { "standard output".into() } else { path.display().to_string() };
    let unit = samples.unit.map(|unit| unit.to_string());
    Ok(OutputEntry { path, format: format.to_string(), bytes, sha256, unit, validity: None })
}

/// Counts and hashes what goes through it, and stops when the run is to stop.
struct Hashing<'a> {
    out: &'a mut dyn Write,
    hash: Sha256,
    bytes: u64,
    session: &'a Session,
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.session.progress.check().map_err(std::io::Error::other)?;
        let written = self.out.write(bytes)?;
        self.hash.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

fn sha256_of_file(path: &Path, session: &Session) -> std::io::Result<String> {
    let mut hashing = Hashing { out: &mut std::io::sink(), hash: Sha256::new(), bytes: 0, session };
    std::io::copy(&mut std::fs::File::open(path)?, &mut hashing)?;
    Ok(hex(&hashing.hash.finalize()))
}

/// What it means that a mesh could not be encoded.
pub fn unencoded(path: &Path, error: &WriteError) -> Failure {
    match &error.problem {
        WriteProblem::Io(error) => unwritable(path, error),
        problem => Failure::internal(format!("cannot write {}: {problem}", path.display())),
    }
}

fn encode(target: &Target, mesh: &TriMesh, paint: &Paint<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    io::encode_painted(mesh, paint, &target.options, out).map_err(|error| unencoded(&target.path, &error))
}

fn read_back(bytes: &[u8], target: &Target) -> Result<Loaded, Failure> {
    let name = (!is_stream(&target.path)).then_some(target.path.as_path());
    io::read_bytes(bytes, Some(target.options.format), name)
        .map_err(|e| Failure::internal(format!("the written file does not read back: {e}")))
}

fn entry(target: &Target, bytes: &[u8]) -> OutputEntry {
    OutputEntry {
        path: if is_stream(&target.path) { "standard output".into() } else { target.path.display().to_string() },
        format: target.options.format.to_string(),
        bytes: bytes.len() as u64,
        sha256: sha256(bytes),
        unit: target.options.unit_in_file().map(|unit| unit.to_string()),
        validity: None,
    }
}
