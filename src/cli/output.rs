//! Writing: to a file or a stream, verified before it appears under its name.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::ScopedJoinHandle;

use sha2::{Digest, Sha256};

use super::entries::OutputEntry;
use super::exit::Failure;
use super::session::{Drafted, Session};
use super::side::write_at_once;
use super::streams::is_direct;
use super::streams::unwritable;
use super::streams::{hex, is_stream, sha256};
use super::target::Target;
use crate::io::{self, DistanceSamples, GridFormat, Loaded, Paint, Unit, WriteError, WriteProblem};
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
    let paint = paint.into();
    let encoded = |beside: Option<&Path>, out: &mut dyn Write| encode(target, mesh, &Paint { beside, ..paint }, out);
    let written = write_judged(target, encoded, session, |bytes| {
        let read = read_back(bytes, target)?;
        let verdict = judge(&read)?;
        super::paint::check_texture(&read, &paint)?;
        Ok(verdict)
    })?;
    if let Some(texture) = paint.texture {
        super::paint::write_beside(target, texture, session)?;
    }
    Ok(written)
}

/// Writes what `encode` makes, reads it back, and lets `judge` look at the bytes; see [`write_verified`]. `encode` is told where the files
/// beside it will lie, if there can be some.
pub fn write_judged<T>(
    target: &Target,
    encode: impl FnOnce(Option<&Path>, &mut dyn Write) -> Result<(), Failure>,
    session: &Session,
    judge: impl FnOnce(&[u8]) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    session.progress.stage(Stage::Write)?;
    if is_direct(&target.path) {
        let mut bytes = Vec::new();
        encode(None, &mut bytes)?;
        session.progress.stage(Stage::Verify)?;
        let verdict = judge(&bytes)?;
        session.progress.check()?;
        write_at_once(&target.path, &bytes)?;
        return Ok((entry(target, &bytes), verdict));
    }
    let failed = |e: &std::io::Error| unwritable(&target.path, e);
    let Drafted { file, path } = session.draft(&target.path)?;
    let mut buffer = std::io::BufWriter::with_capacity(1 << 20, &file);
    encode(Some(&target.path), &mut buffer)?;
    buffer.flush().map_err(|e| failed(&e))?;
    drop(buffer);
    session.progress.stage(Stage::Verify)?;
    synced(&file, &target.path, || {
        let bytes = std::fs::read(path).map_err(|e| failed(&e))?;
        let verdict = judge(&bytes)?;
        Ok((entry(target, &bytes), verdict))
    })
}

/// What `look` finds in a file, while the system puts it on the disk.
fn synced<T>(file: &File, path: &Path, look: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    std::thread::scope(|scope| {
        let sync = std::thread::Builder::new().spawn_scoped(scope, || file.sync_all());
        let found = look()?;
        let synced = match sync.map(ScopedJoinHandle::join) {
            Ok(Ok(synced)) => synced,
            // There was no thread to be had for it.
            _ => file.sync_all(),
        };
        synced.map_err(|e| unwritable(path, &e)).map(|()| found)
    })
}

/// Writes what `encode` makes, in `format`. A regular file is read back and compared by its hash before it appears.
pub fn write_grid(
    path: &Path,
    samples: &DistanceSamples<'_>,
    format: GridFormat,
    session: &Session,
) -> Result<OutputEntry, Failure> {
    if let Some(desk) = session.desk_for(path) {
        desk.lay_grid(samples);
        return Ok(in_memory(samples.unit));
    }
    let mut bytes = 0;
    let mut hashed = |out: &mut dyn Write| -> Result<String, Failure> {
        let written = hash_of(out, session, |out| io::encode_grid(samples, format, out));
        // A run that was stopped shows as a failure to write; what stopped it comes first.
        session.progress.check()?;
        let (sha256, count) = written.map_err(|e| unwritable(path, &e))?;
        bytes = count;
        Ok(sha256)
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
        session.progress.stage(Stage::Verify)?;
        let found = synced(&draft.file, path, || {
            let found = sha256_of_file(&draft.path, session);
            session.progress.check()?;
            found.map_err(|e| failed(&e))
        });
        if found? != sha256 {
            return Err(Failure::internal("the file does not hold what was written to it; it was removed"));
        }
        sha256
    };
    let path = if is_stream(path) { "standard output".into() } else { path.display().to_string() };
    let unit = samples.unit.map(|unit| unit.to_string());
    Ok(OutputEntry { path, format: format.to_string(), bytes, sha256, unit, validity: None })
}

/// The entry of a result that no file holds.
pub fn in_memory(unit: Option<Unit>) -> OutputEntry {
    OutputEntry {
        path: "memory".into(),
        format: "memory".into(),
        bytes: 0,
        sha256: String::new(),
        unit: unit.map(|unit| unit.to_string()),
        validity: None,
    }
}

/// Lets `write` write to `out`. Returns the hash of what went through, made on a thread of its own if there is one to be had, and its bytes.
fn hash_of(
    out: &mut dyn Write,
    session: &Session,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<(String, u64)> {
    std::thread::scope(|scope| {
        let (pieces, received) = sync_channel::<Vec<u8>>(PIECES);
        let all = move || {
            let mut hash = Sha256::new();
            received.iter().for_each(|piece| hash.update(piece));
            hash
        };
        let hash = match std::thread::Builder::new().spawn_scoped(scope, all) {
            Ok(thread) => Hash::Beside(pieces, thread),
            Err(_) => Hash::Here(Box::new(Sha256::new())),
        };
        let mut passing = Passing { out, hash, bytes: 0, session };
        write(&mut passing).and_then(|()| passing.flush())?;
        let Passing { hash, bytes, .. } = passing;
        let hash = match hash {
            Hash::Here(hash) => *hash,
            Hash::Beside(pieces, thread) => {
                drop(pieces);
                thread.join().map_err(|_| std::io::Error::other("no hash could be made"))?
            }
        };
        Ok((hex(&hash.finalize()), bytes))
    })
}

/// So many pieces wait to be hashed, at most.
const PIECES: usize = 4;

/// Where the hash is made.
enum Hash<'scope> {
    /// By another thread, which gets pieces.
    Beside(SyncSender<Vec<u8>>, ScopedJoinHandle<'scope, Sha256>),
    /// By this one.
    Here(Box<Sha256>),
}

/// Counts what goes through it, hashes it, and stops when the run is to stop.
struct Passing<'a, 'scope> {
    out: &'a mut dyn Write,
    hash: Hash<'scope>,
    bytes: u64,
    session: &'a Session,
}

impl Write for Passing<'_, '_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.session.progress.check().map_err(std::io::Error::other)?;
        let written = self.out.write(bytes)?;
        match &mut self.hash {
            Hash::Beside(pieces, _) => pieces.send(bytes[..written].to_vec()).map_err(std::io::Error::other)?,
            Hash::Here(hash) => hash.update(&bytes[..written]),
        }
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

fn sha256_of_file(path: &Path, session: &Session) -> std::io::Result<String> {
    let mut file = std::fs::File::open(path)?;
    let read = |out: &mut dyn Write| {
        let mut piece = vec![0; 1 << 20];
        loop {
            match file.read(&mut piece)? {
                0 => return Ok(()),
                count => out.write_all(&piece[..count])?,
            }
        }
    };
    hash_of(&mut std::io::sink(), session, read).map(|(sha256, _)| sha256)
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
