//! Writing: to a file or a stream, verified before it appears under its name.

use std::io::Write;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::args::OutputArgs;
use super::exit::Failure;
use super::input::{hex, is_stream, plain_reason, sha256};
use super::report::OutputEntry;
use super::session::Session;
use crate::io::{self, Colours, DistanceSamples, Format, GridFormat, Loaded, Unit, WriteOptions};
use crate::mesh::TriMesh;

/// Where a mesh goes, and how it is encoded.
pub struct Target {
    /// The path as given.
    pub path: PathBuf,
    /// Encoding.
    pub options: WriteOptions,
}

impl Target {
    /// Checks everything about the output that can be known before the work begins.
    pub fn new(path: &Path, args: &OutputArgs, inputs: &[&Path]) -> Result<Self, Failure> {
        let format = match (args.out_format, Format::from_path(path)) {
            (Some(format), _) | (None, Some(format)) => format,
            (None, None) if is_stream(path) => {
                return Err(Failure::usage("standard output has no name that tells its format")
                    .hint("--out-format says it, for example --out-format stl"));
            }
            (None, None) => {
                return Err(Failure::usage(format!("the name {} does not tell its format", path.display()))
                    .hint("end it in .stl, .obj, .ply, .off, .glb, .gltf or .3mf, or give --out-format"));
            }
        };
        check_overwrite(path, args.force, inputs)?;
        Ok(Self { path: path.to_path_buf(), options: WriteOptions { format, ascii: args.ascii, unit: None } })
    }

    /// The unit of the mesh that will be written.
    pub fn set_unit(&mut self, unit: Option<Unit>) {
        self.options.unit = unit;
    }
}

/// Refuses to write over an input without `--force`, into a folder that is not there, or over a folder.
pub fn check_overwrite(output: &Path, force: bool, inputs: &[&Path]) -> Result<(), Failure> {
    if is_stream(output) {
        return Ok(());
    }
    if !force && inputs.iter().any(|input| same_file(input, output)) {
        return Err(Failure::usage(format!("{} is an input and would be overwritten", output.display()))
            .hint("another name after -o, or --force"));
    }
    check_folder(output)
}

/// Whether two paths lead to the same existing file.
pub fn same_file(a: &Path, b: &Path) -> bool {
    if is_stream(a) || is_stream(b) {
        return false;
    }
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// Whether a file can be made at `path`, as far as can be told beforehand.
pub fn check_folder(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::usage(format!("{} is a folder", path.display())));
    }
    let folder = folder_of(path);
    match folder.metadata() {
        Ok(metadata) if metadata.is_dir() => Ok(()),
        Ok(_) => Err(Failure::usage(format!("{} is not a folder", folder.display()))),
        Err(e) => Err(Failure::usage(format!("cannot write into {}: {}", folder.display(), plain_reason(&e)))),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes `mesh` with its colours, if it has some, reads it back, and lets `judge` look at what was read. Only when that is content
/// does the file appear under its name; before, it has a temporary name in the same folder, and if
/// anything fails nothing is left. Streams and devices get their bytes after the judgement.
pub fn write_verified<T>(
    target: &Target,
    mesh: &TriMesh,
    colours: Option<&Colours>,
    session: &Session,
    judge: impl FnOnce(&Loaded) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    session.progress.stage("write")?;
    let direct = is_stream(&target.path) || target.path.metadata().is_ok_and(|metadata| !metadata.is_file());
    if direct {
        write_direct(target, mesh, colours, session, judge)
    } else {
        write_file(target, mesh, colours, session, judge)
    }
}

fn write_direct<T>(
    target: &Target,
    mesh: &TriMesh,
    colours: Option<&Colours>,
    session: &Session,
    judge: impl FnOnce(&Loaded) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    let mut bytes = Vec::new();
    encode(target, mesh, colours, &mut bytes)?;
    session.progress.stage("verify")?;
    let verdict = judge(&read_back(&bytes, target)?)?;
    session.finish(|| match is_stream(&target.path) {
        true => write_stream(&bytes),
        false => std::fs::write(&target.path, &bytes).map_err(|e| unwritable(&target.path, &e)),
    })?;
    Ok((entry(target, &bytes), verdict))
}

fn write_file<T>(
    target: &Target,
    mesh: &TriMesh,
    colours: Option<&Colours>,
    session: &Session,
    judge: impl FnOnce(&Loaded) -> Result<T, Failure>,
) -> Result<(OutputEntry, T), Failure> {
    // A link stays a link: the file it leads to is replaced.
    let path = target.path.canonicalize().unwrap_or_else(|_| target.path.clone());
    let failed = |e: &std::io::Error| unwritable(&target.path, e);
    let file = temporary_file(&path).map_err(|e| cannot_write_into(&path, &e))?;
    session.temporary(file.path());
    let mut buffer = std::io::BufWriter::with_capacity(1 << 20, file.as_file());
    encode(target, mesh, colours, &mut buffer)?;
    buffer.flush().map_err(|e| failed(&e))?;
    drop(buffer);
    file.as_file().sync_all().map_err(|e| failed(&e))?;
    session.progress.stage("verify")?;
    let bytes = std::fs::read(file.path()).map_err(|e| failed(&e))?;
    let verdict = judge(&read_back(&bytes, target)?)?;
    session.finish(|| file.persist(&path).map_err(|e| failed(&e.error)))?;
    Ok((entry(target, &bytes), verdict))
}

/// Writes what `encode` makes, in `format`. A regular file is read back and compared by its hash before it appears.
pub fn write_grid(
    path: &Path,
    samples: &DistanceSamples<'_>,
    format: GridFormat,
    session: &Session,
) -> Result<OutputEntry, Failure> {
    let direct = is_stream(path) || path.metadata().is_ok_and(|metadata| !metadata.is_file());
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
    } else if direct {
        let mut file = std::fs::OpenOptions::new().write(true).open(path).map_err(|e| unwritable(path, &e))?;
        hashed(&mut file)?
    } else {
        let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let failed = |e: &std::io::Error| unwritable(path, e);
        let file = temporary_file(&target).map_err(|e| cannot_write_into(&target, &e))?;
        session.temporary(file.path());
        let sha256 = hashed(&mut std::io::BufWriter::with_capacity(1 << 20, file.as_file()))?;
        file.as_file().sync_all().map_err(|e| failed(&e))?;
        session.progress.stage("verify")?;
        let found = sha256_of_file(file.path(), session);
        session.progress.check()?;
        if found.map_err(|e| failed(&e))? != sha256 {
            return Err(Failure::internal("the file does not hold what was written to it; it was removed"));
        }
        session.finish(|| file.persist(&target).map_err(|e| failed(&e.error)))?;
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

fn cannot_write_into(path: &Path, error: &std::io::Error) -> Failure {
    Failure::usage(format!("cannot write into {}: {}", folder_of(path).display(), plain_reason(error)))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::internal(format!("cannot write {}: {}", path.display(), plain_reason(error)))
}

fn temporary_file(path: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".meshwright-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Like any new file: the umask takes its share. An existing file keeps its mode.
        let mode = path.metadata().map_or(0o666, |metadata| metadata.permissions().mode() & 0o777);
        builder.permissions(std::fs::Permissions::from_mode(mode));
    }
    builder.tempfile_in(folder_of(path))
}

fn encode(target: &Target, mesh: &TriMesh, colours: Option<&Colours>, out: &mut dyn Write) -> Result<(), Failure> {
    io::encode_coloured(mesh, colours, &target.options, out)
        .map_err(|e| Failure::internal(format!("cannot write {}: {e}", target.path.display())))
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
        unit: target.options.unit.map(|unit| unit.to_string()),
        validity: None,
    }
}

/// Writes `bytes` to standard output.
pub fn write_stream(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes)
        .and_then(|()| out.flush())
        .map_err(|e| Failure::internal(format!("cannot write to standard output: {}", plain_reason(&e))))
}
