//! Writing: to a file or a stream, verified before it appears under its name.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::args::OutputArgs;
use super::choices::AnyFormat;
use super::exit::{Exit, Failure};
use super::input::{hex, is_stream, plain_reason, sha256};
use super::report::OutputEntry;
use super::session::{Drafted, Session};
use super::words;
use crate::io::{
    self, DistanceSamples, Format, GridFormat, Loaded, Paint, Unit, WriteError, WriteOptions, WriteProblem,
};
use crate::mesh::TriMesh;
use crate::progress::Stage;

/// Where a mesh goes, and how it is encoded.
pub struct Target {
    /// The path as given.
    pub path: PathBuf,
    /// Encoding.
    pub options: WriteOptions,
}

impl Target {
    /// What can be known of the encoding before the work begins.
    pub fn new(path: &Path, args: &OutputArgs) -> Result<Self, Failure> {
        let format = match args.out_format.or_else(|| AnyFormat::from_path(path)) {
            Some(AnyFormat::Mesh(format)) => {
                check_extension(path, format.name())?;
                format
            }
            Some(AnyFormat::Grid(format)) => {
                return Err(Failure::usage(format!("{format} holds values over a lattice, and the result is a mesh"))
                    .hint("stl, obj, ply, off, glb, gltf and 3mf hold meshes; `sdf` and `field` make lattices"));
            }
            None if is_stream(path) => {
                return Err(Failure::usage("standard output has no name that tells its format")
                    .hint("--out-format says it, for example --out-format stl"));
            }
            None => {
                return Err(Failure::usage(format!("the name {} does not tell its format", path.display()))
                    .hint("end it in .stl, .obj, .ply, .off, .glb, .gltf or .3mf, or give --out-format"));
            }
        };
        Ok(Self { path: path.to_path_buf(), options: WriteOptions { format, ascii: args.ascii, unit: None } })
    }

    /// The unit of the mesh that will be written.
    pub fn set_unit(&mut self, unit: Option<Unit>) {
        self.options.unit = unit;
    }

    /// What a user should know of the unit in the file.
    pub fn unit_note(&self) -> Option<String> {
        let format = self.options.format;
        match (format, self.options.unit) {
            (Format::Glb | Format::Gltf, None) => Some(format!(
                "{format} is in metres, and the unit of the model is not known: its numbers were written as they are, so 1 reads \
                 as 1 m; --unit mm, for example, says what they are"
            )),
            (Format::Glb | Format::Gltf, Some(unit)) if unit != Unit::Metre => {
                let factor = words::factor(self.options.factor());
                Some(format!("{format} is in metres: lengths in {} were written times {factor}", words::several(unit)))
            }
            (Format::ThreeMf, None) => Some(
                "3MF states a unit, and that of the model is not known: its numbers were written as they are and read as millimetres; \
                 --unit says otherwise"
                    .into(),
            ),
            (Format::Stl | Format::Obj | Format::Ply | Format::Off, Some(unit)) if unit != Unit::Millimetre => Some(format!(
                "{format} has no place for a unit: its numbers are {}, and most programs will take them for millimetres",
                words::several(unit)
            )),
            _ => None,
        }
    }
}

/// Extensions that say what is in a file, beside those of the formats for meshes and lattices.
const KNOWN: [&str; 28] = [
    "png", "jpg", "jpeg", "gif", "bmp", "tif", "tiff", "webp", "svg", "pdf", "json", "html", "xml", "zip", "step",
    "stp", "iges", "igs", "dxf", "dwg", "fbx", "dae", "3ds", "blend", "amf", "x3d", "wrl", "usd",
];

/// Refuses a name that says something else than what is written to it.
pub fn check_extension(path: &Path, format: &str) -> Result<(), Failure> {
    let extension = path.extension().map_or(String::new(), |extension| extension.to_string_lossy().to_lowercase());
    let says_something = AnyFormat::from_path(path).is_some() || KNOWN.contains(&extension.as_str());
    if is_direct(path) || extension == format || !says_something {
        return Ok(());
    }
    let name = path.display();
    Err(Failure::usage(format!("{name} is named as {extension}, and {format} would be written to it"))
        .hint(format!("a name that ends in .{format}, such as {}", path.with_extension(format).display())))
}

/// Whether what is written to `path` goes there at once: a stream, a pipe, a device.
pub fn is_direct(path: &Path) -> bool {
    is_stream(path) || path.metadata().is_ok_and(|metadata| !metadata.is_file())
}

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

/// Writes a file that is not read back: a map, a report, a picture.
pub fn write_side(path: &Path, bytes: &[u8], session: &Session) -> Result<(), Failure> {
    if is_direct(path) {
        return write_at_once(path, bytes);
    }
    let mut file = session.draft(path)?.file;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(|error| unwritable(path, &error))
}

fn write_at_once(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    match is_stream(path) {
        true => write_stream(bytes),
        false => std::fs::write(path, bytes).map_err(|error| unwritable(path, &error)),
    }
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

/// Why there is no file at `path`.
pub fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let name = if is_stream(path) { "to standard output".into() } else { path.display().to_string() };
    let reason = match error.kind() {
        ErrorKind::BrokenPipe => "whoever read it has stopped reading".into(),
        _ => plain_reason(error),
    };
    let failure = Failure::new(Exit::Write, format!("cannot write {name}: {reason}"));
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            failure.hint("room for it, or another folder; what was there before is as it was")
        }
        _ => failure,
    }
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

/// Writes `bytes` to standard output.
pub fn write_stream(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|error| unwritable(Path::new("-"), &error))
}
