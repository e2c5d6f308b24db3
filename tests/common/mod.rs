//! What several test programs share: generated shapes and the real meshes beside the project.

#![allow(dead_code)] // each test program uses its own part

use std::path::{Path, PathBuf};

use meshwright::mesh::TriMesh;

/// The folder of real meshes; a test that needs it fails when it is missing.
pub fn data_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data")
}

/// All meshes of one folder of the real data, by name.
pub fn data(folder: &str) -> Vec<(String, TriMesh)> {
    let folder = data_folder().join(folder);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("readable folder").path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    paths.iter().map(|path| (file_name(path), read(path))).collect()
}

/// A mesh of our own.
pub fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("testdata").join(name)
}

/// One mesh file.
pub fn read(path: &Path) -> TriMesh {
    meshwright::io::read(path).unwrap_or_else(|e| panic!("{e}")).mesh
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Pipelines one after another, as the command line has them: a repair, and what is done to the solid.
pub mod repaired {
    use meshwright::mesh::TriMesh;
    use meshwright::pipeline::{
        BooleanError, CanalError, CanalOptions, CanalReport, Changed, HollowError, HollowOptions, MorphologyError,
        MorphologyOptions, Options, Outcome, SurfaceOptions, ThickenError, ThickenOptions, canals, hollow, morphology,
        repair, thicken,
    };
    use meshwright::progress::Progress;

    fn repaired(mesh: &TriMesh, surface: &SurfaceOptions) -> Outcome {
        repair(mesh, &Options::from(*surface), &Progress::none()).expect("a solid")
    }

    fn followed(outcome: Outcome, changed: Changed, mesh: &TriMesh) -> Outcome {
        outcome.followed_by(changed, [mesh], &Progress::none()).expect("not stopped")
    }

    pub fn morphed(mesh: &TriMesh, options: &MorphologyOptions) -> Result<Outcome, MorphologyError> {
        let outcome = repaired(mesh, &options.surface);
        let changed = morphology(&outcome.solid, options, &Progress::none())?;
        Ok(followed(outcome, changed, mesh))
    }

    pub fn hollowed(mesh: &TriMesh, options: &HollowOptions) -> Result<Outcome, HollowError> {
        let outcome = repaired(mesh, &options.surface);
        let changed = hollow(&outcome.solid, options, &Progress::none())?;
        Ok(followed(outcome, changed, mesh))
    }

    pub fn thickened(mesh: &TriMesh, options: &ThickenOptions) -> Result<Outcome, ThickenError> {
        let made = match repair(mesh, &Options::from(options.surface), &Progress::none()) {
            Ok(outcome) => Some(outcome),
            Err(BooleanError::Nothing(_)) => None,
            Err(error) => panic!("{error}"),
        };
        let solid = made.as_ref().map(|outcome| &outcome.solid);
        let changed = thicken(solid, mesh, options, &Progress::none())?;
        Ok(match made {
            Some(outcome) => followed(outcome, changed, mesh),
            None => changed.into(),
        })
    }

    /// The solid, without the canals that were to be filled, and the list.
    pub fn without_canals(mesh: &TriMesh, options: &CanalOptions) -> Result<(Outcome, CanalReport), CanalError> {
        let outcome = repaired(mesh, &options.surface);
        let found = canals(&outcome.solid, options, &Progress::none())?;
        let outcome = match found.filled {
            Some(changed) => followed(outcome, changed, mesh),
            None => outcome,
        };
        Ok((outcome, found.report))
    }
}

/// Closed shapes made here.
pub mod shapes {
    use glam::DVec3;
    use meshwright::mesh::TriMesh;

    /// Shape number `which` (0 to 3) and its name.
    pub fn closed(which: usize) -> (&'static str, TriMesh) {
        match which {
            0 => ("box", cuboid(DVec3::ZERO, DVec3::new(1.0, 0.7, 0.4))),
            1 => ("torus", torus(64, 32)),
            2 => ("thin torus", torus_of(48, 6, 1.0, 0.02)),
            _ => {
                let mut two = cuboid(DVec3::ZERO, DVec3::ONE);
                two.append(&torus_of(20, 10, 1.1, 0.3));
                ("overlapping shells", two)
            }
        }
    }

    /// An axis-aligned box of 12 triangles.
    pub fn cuboid(min: DVec3, max: DVec3) -> TriMesh {
        let corner = |n: usize| {
            let pick = |bit: usize, low: f64, high: f64| if n >> bit & 1 == 1 { high } else { low };
            DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        TriMesh {
            positions: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect(),
        }
    }

    /// A torus around z of radii 1 and 0.35.
    pub fn torus(around: u32, tube: u32) -> TriMesh {
        torus_of(around, tube, 1.0, 0.35)
    }

    /// A torus around z.
    pub fn torus_of(around: u32, tube: u32, radius: f64, tube_radius: f64) -> TriMesh {
        let turn = std::f64::consts::TAU;
        let vertex = |n: u32| {
            let (a, t) = (turn * (n / tube) as f64 / around as f64, turn * (n % tube) as f64 / tube as f64);
            let r = radius + tube_radius * t.cos();
            DVec3::new(r * a.cos(), r * a.sin(), tube_radius * t.sin())
        };
        let index = |i: u32, j: u32| (i % around) * tube + j % tube;
        let quad = |n: u32| {
            let (i, j) = (n / tube, n % tube);
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        TriMesh {
            positions: (0..around * tube).map(vertex).collect(),
            triangles: (0..around * tube).flat_map(quad).collect(),
        }
    }
}

/// The first stages, for tests of the later ones.
pub mod stages {
    use meshwright::lattice::{Grid, Lattice};
    use meshwright::ldi::{Expression, Operands, Spans, ldis, spans};
    use meshwright::mesh::{Plane, TriMesh};
    use meshwright::progress::Progress;
    use meshwright::vote::{Jury, VoteRule, Votes, Winding, vote_near_surface};

    /// Lattice with `resolution` voxels along the longest side.
    pub fn lattice_of(mesh: &TriMesh, resolution: u32) -> Lattice {
        let bounds = mesh.bounds().expect("triangles");
        Lattice::around(&bounds, bounds.size().max_element() / resolution as f64)
    }

    /// The spans of one operand, in all 13 directions.
    pub fn spans_of(mesh: &TriMesh, lattice: &Lattice) -> Vec<Spans> {
        let operands = Operands::new([mesh.triangles.len()]);
        let layers = ldis(mesh, lattice, 1, &Progress::none()).expect("not stopped");
        layers.into_iter().map(|layers| spans(layers, &operands, &Expression::Operand(0))).collect()
    }

    /// Calls `judge` with the jury of one operand.
    pub fn with_jury<T>(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule, judge: impl FnOnce(&Jury<'_>) -> T) -> T {
        let operands = Operands::new([mesh.triangles.len()]);
        let spans = spans_of(mesh, lattice);
        let winding = Winding::new(mesh, &operands, lattice, &Progress::none());
        let expression = Expression::Operand(0);
        judge(&Jury { spans: &spans, operands: &operands, expression: &expression, rule, winding: &winding })
    }

    /// The votes near the surface of one operand.
    pub fn votes_of(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule) -> Grid<Votes> {
        with_jury(mesh, lattice, rule, |jury| vote_near_surface(jury, &Progress::none()).expect("not stopped"))
    }

    /// The planes of a mesh's triangles, lattice coordinates.
    pub fn planes_of(mesh: &TriMesh, lattice: &Lattice) -> Vec<Plane> {
        (0..mesh.triangles.len()).map(|t| Plane::through(mesh.corners(t).map(|p| lattice.to_lattice(p)))).collect()
    }
}

/// Distances over lattices.
pub mod fields {
    use glam::IVec3;
    use meshwright::lattice::{Grid, voxel_in_brick};

    fn voxel(brick: IVec3, n: usize) -> IVec3 {
        brick * 8 + voxel_in_brick(n)
    }

    /// The largest difference in the band, voxels with other sides, and voxels of the band.
    pub fn apart(truth: &Grid<f32>, found: &Grid<f32>, band: f64) -> (f64, usize, usize) {
        let (mut most, mut wrong, mut count) = (0.0f64, 0, 0);
        for (n, &brick) in truth.bricks.active().iter().enumerate() {
            for k in 0..512 {
                let (a, b) = (f64::from(truth.values[n][k]), f64::from(found.get(voxel(brick, k))));
                if a.abs() < band - 1e-4 {
                    count += 1;
                    most = most.max((a.abs() - b.abs()).abs());
                }
                wrong += usize::from((a < 0.0) != (b < 0.0) && a.abs() > 1e-4);
            }
        }
        for &brick in found.bricks.active() {
            let ends = [voxel(brick, 0), voxel(brick, 511)];
            wrong += ends.iter().filter(|&&v| (truth.get(v) < 0.0) != (found.get(v) < 0.0)).count();
        }
        (most, wrong, count)
    }
}

/// Meshes with textures, made here.
pub mod textured {
    use std::path::Path;
    use std::sync::Arc;

    use glam::DVec3;
    use meshwright::io::{self, Loaded, Material, Paint, TextureImage, TextureMap, WriteOptions};
    use meshwright::mesh::TriMesh;

    /// An image of a single pixel.
    pub fn png(colour: [u8; 3]) -> Arc<[u8]> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(&colour)).expect("memory takes it");
        bytes.into()
    }

    /// What begins as a JPEG; nobody looks further.
    pub fn jpeg() -> Arc<[u8]> {
        Arc::from(*b"\xff\xd8\xff\xe0 not really a picture")
    }

    /// Where a place on a side that faces along `axis` (0 to 5: −x, +x, −y, +y, −z, +z) lies on its image: the sides are pieces of their own.
    pub fn place(p: DVec3, axis: usize) -> [f32; 2] {
        let flat = [[p.y, p.z], [p.x, p.z], [p.x, p.y]][axis / 2];
        flat.map(|x| (x / 64.0 + 0.125 * axis as f64 + 0.0625) as f32)
    }

    /// The side that a triangle faces, 0 to 5.
    pub fn axis([a, b, c]: [DVec3; 3]) -> usize {
        let n = (b - a).cross(c - a);
        let size = n.abs();
        let k = (0..3).max_by(|&i, &j| size[i].total_cmp(&size[j])).unwrap_or(0);
        2 * k + usize::from(n[k] > 0.0)
    }

    /// Textures for a mesh of flat sides along the axes: an image for top and bottom, another for the others.
    pub fn of_sides(mesh: &TriMesh, images: [Arc<[u8]>; 2]) -> TextureMap {
        let axes: Vec<usize> = (0..mesh.triangles.len()).map(|t| axis(mesh.corners(t))).collect();
        let material = |n: u32| Material { name: format!("side_{n}"), colour: None, image: Some(n) };
        let image = |(n, bytes): (usize, Arc<[u8]>)| {
            let ending = if bytes.starts_with(b"\xff\xd8") { "jpg" } else { "png" };
            TextureImage { name: format!("picture {n}.{ending}"), bytes }
        };
        TextureMap {
            coordinates: (axes.iter().enumerate()).map(|(t, &a)| Some(mesh.corners(t).map(|p| place(p, a)))).collect(),
            material_of: axes.iter().map(|&a| Some(u32::from(a < 4))).collect(),
            materials: (0..2).map(material).collect(),
            images: images.into_iter().enumerate().map(image).collect(),
            ..TextureMap::default()
        }
    }

    /// Writes a mesh and what belongs beside it.
    pub fn save(path: &Path, mesh: &TriMesh, texture: &TextureMap, options: &WriteOptions) {
        let paint = Paint { colours: None, texture: Some(texture), beside: Some(path) };
        let mut bytes = Vec::new();
        io::encode_painted(mesh, &paint, options, &mut bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        std::fs::write(path, bytes).expect("written");
        for file in texture.side_files(options.format, path) {
            std::fs::write(path.with_file_name(&file.name), &file.bytes[..]).expect("written");
        }
    }

    /// Reads a mesh, about which there is nothing to say.
    #[track_caller]
    pub fn load(path: &Path) -> Loaded {
        let loaded = io::read(path).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{}", path.display());
        loaded
    }

    /// The bytes of a triangle's image.
    pub fn image(texture: &TextureMap, triangle: usize) -> Option<Arc<[u8]>> {
        texture.image(triangle).map(|n| texture.images[n as usize].bytes.clone())
    }
}
