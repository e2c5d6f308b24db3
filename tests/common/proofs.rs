//! What must hold of any mesh, made here or real.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use meshwright::compare::{CompareOptions, Comparison, compare};
use meshwright::decimate::{DecimateOptions, Decimated, decimate};
use meshwright::field::filter::{FilterOptions, Sampling, filtered};
use meshwright::field::{MeshField, Shared, scattered};
use meshwright::io::{Colours, Loaded};
use meshwright::ldi::{Balance, Layers, Operands, balance, ldis};
use meshwright::mesh::{Bounds, ClosestTree, Solid, TriMesh, ValidateOptions, Validity, validate};
use meshwright::progress::Progress;
use meshwright::sdf::exact::PointSign;

use super::stages;

/// What is wrong with a mesh, self-intersections included.
pub fn state(mesh: &TriMesh, weld: bool) -> Validity {
    validate(mesh, &ValidateOptions { self_intersections: true, weld }, &Progress::none()).expect("not stopped")
}

/// The mesh with fewer triangles.
pub fn decimated(mesh: &TriMesh, options: &DecimateOptions) -> Decimated {
    let solid = Solid::try_from(mesh.clone()).expect("a valid solid");
    decimate(&solid, &[], options, &Progress::none()).expect("a valid solid")
}

/// The options that ask for a number of triangles.
pub fn number(triangles: usize) -> DecimateOptions {
    DecimateOptions { triangles: Some(triangles), ..DecimateOptions::default() }
}

/// How far two meshes are apart.
pub fn compared(a: &TriMesh, b: &TriMesh) -> Comparison {
    let options = CompareOptions { samples: 20_000, edge_tolerance: None };
    compare(a, b, &options, &Progress::none()).expect("not stopped")
}

/// Decimates a valid solid to a half, a tenth and a sixtieth: it stays valid, with its bodies and tunnels.
pub fn stays_valid_when_decimated(name: &str, mesh: &TriMesh) {
    let before = state(mesh, false);
    assert!(before.is_valid(), "{name}: {:?}", before.problems());
    for share in [2, 10, 60] {
        for single in [false, true] {
            let asked = mesh.triangles.len() / share;
            let round = |p: &DVec3| if single { p.as_vec3().as_dvec3() } else { *p };
            let mesh =
                TriMesh { positions: mesh.positions.iter().map(round).collect(), triangles: mesh.triangles.clone() };
            let made = decimated(&mesh, &DecimateOptions { single, ..number(asked) });
            let after = state(&made.solid, single);
            assert!(after.is_valid(), "{name} to 1/{share}: {:?}", after.problems());
            assert_eq!((after.bodies, after.genus), (before.bodies, before.genus), "{name} to 1/{share}");
            assert_eq!(made.report.reached, after.triangles <= asked, "{name} to 1/{share}");
            assert!(made.report.reached || share == 60, "{name} to 1/{share}: {}", after.triangles);
            let exact = made.solid.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p);
            assert!(exact || !single, "{name}: coordinates are no f32");
        }
    }
}

/// Decimates by three deviations: the surface stays within each, and more room leaves fewer triangles.
pub fn stays_within_the_deviation(name: &str, mesh: &TriMesh) {
    let diagonal = mesh.bounds().expect("triangles").diagonal();
    let mut last = mesh.triangles.len();
    for share in [1e-4, 1e-3, 1e-2] {
        let options = DecimateOptions { max_deviation: Some(share * diagonal), ..DecimateOptions::default() };
        let made = decimated(mesh, &options);
        let moved = compared(mesh, &made.solid).symmetric.expect("areas").max;
        assert!(moved <= share * diagonal, "{name}: moved by {} of {share}", moved / diagonal);
        assert!(made.solid.triangles.len() <= last, "{name}: more triangles for more room");
        assert!(state(&made.solid, false).is_valid(), "{name}");
        last = made.solid.triangles.len();
    }
    assert!(last < mesh.triangles.len() * 9 / 10, "{name}: {last} triangles left");
}

/// How the rays of each direction balance.
pub fn balances(mesh: &TriMesh, resolution: u32, factor: u32) -> Vec<Balance> {
    let layers = ldis(mesh, &stages::lattice_of(mesh, resolution), factor, &Progress::none()).expect("not stopped");
    let operands = Operands::new([mesh.triangles.len()]);
    layers.iter().map(|layers: &Layers| balance(layers, &operands)).collect()
}

/// Every ray that goes in comes out, in all 13 directions.
pub fn assert_balanced(name: &str, mesh: &TriMesh, resolution: u32, factor: u32) {
    for (direction, balance) in balances(mesh, resolution, factor).into_iter().enumerate() {
        assert!(balance.occupied > 0, "{name} at {resolution}: direction {direction} hits nothing");
        assert_eq!(balance.unbalanced, 0, "{name} at {resolution}, factor {factor}, direction {direction}");
    }
}

/// Points on the triangles, spread by their areas.
fn on_surface(mesh: &TriMesh, count: usize) -> Vec<DVec3> {
    let area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length()
    };
    let sums: Vec<f64> = (0..mesh.triangles.len())
        .scan(0.0, |sum, t| {
            *sum += area(t);
            Some(*sum)
        })
        .collect();
    let unit = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
    let place = |p: DVec3| {
        let t = sums.partition_point(|&sum| sum < p.z * sums[sums.len() - 1]).min(sums.len() - 1);
        let [a, b, c] = mesh.corners(t);
        let (u, v) = if p.x + p.y > 1.0 { (1.0 - p.x, 1.0 - p.y) } else { (p.x, p.y) };
        a + (b - a) * u + (c - a) * v
    };
    scattered(count, 9, &unit).into_iter().map(place).collect()
}

/// The filtered distance of a mesh is 0 on its surface and has the distance's sign elsewhere.
pub fn keeps_its_zero_level_when_filtered(name: &str, mesh: &TriMesh) {
    let bounds = mesh.bounds().unwrap();
    let diagonal = bounds.diagonal();
    let plain: Shared = Arc::new(MeshField::new(mesh, PointSign::Pseudonormal, 0));
    let few = Sampling::Drawn { count: 8, seed: 0, mirrored: true };
    let options = FilterOptions { sampling: few, ..FilterOptions::new(0.05 * diagonal) };
    let smooth = filtered(plain.clone(), &options).unwrap();
    let points = on_surface(mesh, 10_000);
    let mut values = vec![0.0; points.len()];
    smooth.values(&points, &mut values);
    let worst = values.iter().fold(0.0, |worst: f64, value| worst.max(value.abs()));
    assert!(worst <= 1e-6 * diagonal, "{name}: {} of the diagonal", worst / diagonal);
    let grown = Bounds { min: bounds.min - 0.1 * diagonal, max: bounds.max + 0.1 * diagonal };
    for p in scattered(1500, 3, &grown) {
        let (before, after) = (plain.value(p), smooth.value(p));
        assert!(before * after > 0.0 || before == 0.0, "{name}: {before} becomes {after} at {p}");
    }
}

/// The nearest triangles to many points, asked for together and one by one; points as far away as `far` sizes of the mesh.
pub fn packets_find_what_single_searches_find(mesh: &TriMesh, far: f64) {
    let bounds = mesh.bounds().unwrap();
    let grown = Bounds { min: bounds.min - bounds.size() * far, max: bounds.max + bounds.size() * far };
    let tree = ClosestTree::of_mesh(mesh);
    let mut points = scattered(300, 1, &grown);
    points.extend(scattered(2000, 2, &bounds));
    points.extend(mesh.positions.iter().take(500));
    let mut found = Vec::new();
    tree.nearest_all(&points, &mut found);
    assert_eq!(found.len(), points.len());
    for (p, found) in points.iter().zip(&found) {
        assert_eq!(tree.nearest(*p).as_ref(), Some(found), "{p}");
    }
}

/// What every reader promises.
pub fn assert_sound(loaded: &Loaded) {
    let mesh = &loaded.mesh;
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
    assert_eq!(loaded.parts.first().map(|p| p.triangles.start), Some(0));
    assert_eq!(loaded.parts.last().map(|p| p.triangles.end), Some(mesh.triangles.len()));
    assert!(loaded.parts.windows(2).all(|pair| pair[0].triangles.end == pair[1].triangles.start));
    assert!(loaded.parts.iter().all(|p| !p.triangles.is_empty()));
    if let Some(negative) = &loaded.negative {
        let mesh = &negative.mesh;
        assert!(!mesh.triangles.is_empty() && mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
        let counted: usize = negative.parts.iter().map(|part| part.triangles.len()).sum();
        assert_eq!(counted, mesh.triangles.len());
    }
    assert!(loaded.texture.as_ref().is_none_or(|texture| texture.fits(mesh)));
    assert!(loaded.texture.iter().flat_map(|t| &t.coordinates).flatten().flatten().flatten().all(|x| x.is_finite()));
    match &loaded.colours {
        None => {}
        Some(Colours::Faces(colours)) => assert_eq!(colours.len(), mesh.triangles.len()),
        Some(Colours::Vertices(colours)) => assert_eq!(colours.len(), mesh.positions.len()),
        Some(Colours::Corners(colours)) => assert_eq!(colours.len(), mesh.triangles.len()),
    }
}

/// How many triangles of an OBJ file are the same by this reader and by an independent one, and how many each has; nothing where the other
/// one does not take the file.
pub fn against_another_reader(path: &Path) -> Option<(usize, usize, usize)> {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj(path, &options).ok()?;
    let theirs = models.iter().flat_map(|model| {
        let point = |v: u32| DVec3::from_array(std::array::from_fn(|k| model.mesh.positions[3 * v as usize + k]));
        model.mesh.indices.chunks_exact(3).map(move |t| [point(t[0]), point(t[1]), point(t[2])])
    });
    let (theirs, mesh) = (theirs.collect::<Vec<_>>(), super::read(path));
    let same =
        theirs.iter().enumerate().filter(|&(t, corners)| t < mesh.triangles.len() && mesh.corners(t) == *corners);
    Some((same.count(), mesh.triangles.len(), theirs.len()))
}
