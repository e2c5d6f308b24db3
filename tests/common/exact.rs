//! The exact distance by looking at all triangles, and what must agree with it: points, lattices, characteristics, prisms, levels.

use glam::{DVec3, IVec3};
use meshwright::lattice::{DistanceField, Grid, Lattice, Slot};
use meshwright::ldi::Inside;
use meshwright::mesh::TriMesh;
use meshwright::progress::Progress;
use meshwright::sdf::Levels;
use meshwright::sdf::characteristics::characteristics;
use meshwright::sdf::exact::{Band, ExactDistance, ExactOptions, PointSign, Sign, exact};
use meshwright::sdf::prism::prism;
use rayon::prelude::*;

use super::fields::{apart, voxel};
use super::shapes::{ball, gear, hard, knot, stack, torus, turned};
use super::{read, sample};

/// A lattice of spacing `h` around the mesh and `room` (h) beyond.
pub fn lattice(mesh: &TriMesh, h: f64, room: i32) -> Lattice {
    let mut lattice = Lattice::around(&mesh.bounds().expect("triangles"), h);
    lattice.origin -= DVec3::splat(f64::from(room) * h);
    lattice.dims += 2 * room;
    lattice
}

/// A closed mesh, a lattice around it, and the band in which its distance is looked at.
pub struct Case {
    pub name: &'static str,
    pub mesh: TriMesh,
    pub lattice: Lattice,
    /// In voxels.
    pub band: f64,
}

/// What every way to the exact field is tried on: meshes that are hard in one way or another, and parts.
pub fn cases() -> Vec<Case> {
    let hard = hard().into_iter().map(|(name, mesh)| (name, mesh, 1.0 / 30.0, 4.0));
    let parts = [
        ("saddle", read(&sample("monkey_saddle.off")), 64.0, 6.4),
        ("knot", knot(96, 16), 60.0, 3.0),
        ("gear", turned(gear(24), 0.3), 60.0, 3.0),
        ("stack", stack(0.4), 40.0, 3.0),
    ];
    let along = |(name, mesh, resolution, band): (_, TriMesh, f64, f64)| {
        let h = mesh.bounds().expect("triangles").size().max_element() / resolution;
        (name, mesh, h, band)
    };
    let all = hard.chain(parts.into_iter().map(along));
    all.map(|(name, mesh, h, band)| Case { lattice: lattice(&mesh, h, f64::ceil(band) as i32), name, mesh, band })
        .collect()
}

/// Distance from a triangle, by its plane and its three sides.
pub fn distance_to(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_side = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(if t.is_finite() { a.lerp(b, t) } else { a })
    };
    let normal = (b - a).cross(c - a);
    let over = [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| normal.cross(to - from).dot(p - from) >= 0.0);
    let to_plane = (p - a).dot(normal.normalize_or_zero()).abs();
    let sides = to_side(a, b).min(to_side(b, c)).min(to_side(c, a));
    if over && normal != DVec3::ZERO { to_plane.min(sides) } else { sides }
}

/// How often the surface winds around `p`, by the solid angles of all triangles.
pub fn winding(mesh: &TriMesh, p: DVec3) -> f64 {
    let solid_angle = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|q| q - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    (0..mesh.triangles.len()).map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// The distance by looking at all triangles, and the side by the winding number.
pub fn by_looking(mesh: &TriMesh, p: DVec3) -> f64 {
    let distance = (0..mesh.triangles.len()).map(|t| distance_to(p, mesh.corners(t))).fold(f64::INFINITY, f64::min);
    if winding(mesh, p) > 0.5 { -distance } else { distance }
}

/// Points spread over a box, always the same.
pub fn spread(low: DVec3, high: DVec3, count: usize) -> Vec<DVec3> {
    // The additive sequence of the cube's golden ratio fills space evenly.
    let step = DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3);
    (1..=count).map(|n| low + (high - low) * (step * n as f64 + 0.5).fract()).collect()
}

fn options(band: Band) -> ExactOptions {
    ExactOptions { band, max_memory: None }
}

fn field(mesh: &TriMesh, lattice: &Lattice, sign: Sign<'_>, band: Band) -> DistanceField {
    exact(mesh, lattice, sign, &options(band), &Progress::none()).expect("a field")
}

/// Points for each mesh: 300, or what the environment says. The project's promise is tested with
/// `MESHWRIGHT_POINTS=20000 cargo test --release --test library exact::points`.
fn count() -> usize {
    std::env::var("MESHWRIGHT_POINTS").ok().and_then(|count| count.parse().ok()).unwrap_or(300)
}

/// Checks points around the mesh against looking at all triangles.
pub fn check_points(name: &str, mesh: &TriMesh) {
    let bounds = mesh.bounds().expect("triangles");
    let (diagonal, room) = (bounds.diagonal(), bounds.size() * 0.3);
    let exact = ExactDistance::of(mesh, PointSign::Pseudonormal);
    let points = spread(bounds.min - room, bounds.max + room, count());
    let asked = exact.at_all(&points);
    points.par_iter().zip(asked).for_each(|(&p, nearest)| {
        let nearest = nearest.expect("triangles");
        let truth = by_looking(mesh, p);
        let error = (nearest.signed.abs() - truth.abs()).abs();
        assert!(error <= 1e-9 * diagonal, "{name}: {} instead of {truth} at {p}", nearest.signed);
        if truth.abs() > 1e-9 * diagonal {
            assert_eq!(nearest.signed < 0.0, truth < 0.0, "{name}: {} instead of {truth} at {p}", nearest.signed);
        }
        assert_eq!(Some(nearest), exact.at(p), "{name}: a packet and a single point differ at {p}");
        // The nearest point is where it says, and the gradient points away from it.
        let on = distance_to(nearest.point, mesh.corners(nearest.triangle as usize));
        assert!(on <= 1e-9 * diagonal, "{name}: {on} off the triangle");
        let step = nearest.point + nearest.gradient * nearest.signed;
        assert!((step - p).length() <= 1e-9 * diagonal, "{name}: {step} is not {p}");
    });
}

/// Checks every voxel of every brick of the lattice against the point query; returns how many are in the band.
pub fn check_lattice(name: &str, mesh: &TriMesh, lattice: &Lattice, band: Band) -> usize {
    let grid = field(mesh, lattice, Sign::Pseudonormal, band).grid;
    let point = ExactDistance::of(mesh, PointSign::Pseudonormal);
    let width = if let Band::Within(width) = band { width.max(1.0) } else { f64::INFINITY };
    let counts = (lattice.dims + 7) / 8;
    let bricks = (0..counts.element_product()).into_par_iter();
    bricks
        .map(|n| {
            let brick = IVec3::new(n % counts.x, n / counts.x % counts.y, n / (counts.x * counts.y));
            let slot = grid.bricks.slot(brick);
            let mut within = 0;
            for n in 0..512 {
                let v = voxel(brick, n);
                let nearest = point.at(lattice.to_model(v.as_dvec3())).expect("triangles");
                let truth = nearest.signed / lattice.h;
                if truth.abs() < width - 1e-4 {
                    let Slot::Active(n_brick) = slot else { panic!("{name}: brick of {v} is not stored") };
                    let got = f64::from(grid.values[n_brick as usize][n]);
                    assert!((got.abs() - truth.abs()).abs() <= 1e-4, "{name}: {got} instead of {truth} at {v}");
                    within += 1;
                }
                let got = grid.get(v);
                if truth.abs() > width + 1e-4 {
                    assert_eq!(f64::from(got.abs()), f64::from(width as f32), "{name}: {truth} at {v}");
                }
                assert!((got < 0.0) == (truth < 0.0) || truth.abs() < 1e-6, "{name}: {got} instead of {truth} at {v}");
            }
            within
        })
        .sum()
}

/// Compares all voxels of all bricks of the lattice with the exact field; returns how many are in the band.
pub fn check_characteristics(name: &str, mesh: &TriMesh, lattice: &Lattice, band: Band) -> usize {
    let grid = characteristics(mesh, lattice, &options(band), &Progress::none()).expect("a field").grid;
    let truth = field(mesh, lattice, Sign::Pseudonormal, band).grid;
    assert_eq!((grid.inside, grid.outside), (truth.inside, truth.outside), "{name}");
    let (end, width) = ((lattice.dims + 7) / 8 * 8, truth.outside);
    let mut within = 0;
    for n in 0..end.element_product() {
        let v = IVec3::new(n % end.x, n / end.x % end.y, n / (end.x * end.y));
        let (got, wanted) = (grid.get(v), truth.get(v));
        assert!((got - wanted).abs() <= 1e-4, "{name}: {got} instead of {wanted} at {v}");
        assert!((got < 0.0) == (wanted < 0.0) || wanted.abs() < 1e-6, "{name}: {got} instead of {wanted} at {v}");
        within += usize::from(wanted.abs() < width);
    }
    // A brick may be stored by one of them only for a voxel at the very end of the band.
    for (a, b) in [(&grid, &truth), (&truth, &grid)] {
        for (&brick, values) in a.bricks.active().iter().zip(&a.values) {
            let near = values.iter().map(|value| value.abs()).fold(f32::INFINITY, f32::min);
            let both = b.bricks.active().binary_search_by_key(&(brick.z, brick.y, brick.x), |b| (b.z, b.y, b.x));
            assert!(both.is_ok() || near > width - 1e-4, "{name}: brick {brick}, {near}");
        }
    }
    within
}

/// How far the prisms' field is from the exact one, h, and how many voxels of the band have another side.
pub fn from_prisms(mesh: &TriMesh, lattice: &Lattice, band: f64) -> (f64, usize, usize) {
    let band_options = options(Band::Within(band));
    let truth = field(mesh, lattice, Sign::Pseudonormal, Band::Within(band));
    let found = prism(mesh, lattice, &band_options, &Progress::none()).expect("a field");
    apart(&truth, &found, band)
}

/// All voxels, x first.
pub fn voxels(lattice: &Lattice) -> impl Iterator<Item = IVec3> + use<> {
    let dims = lattice.dims;
    (0..dims.element_product()).map(move |n| IVec3::new(n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y)))
}

/// Compares the sides by levels with those by normals for all voxels that are off the surface; returns how many are inside.
pub fn same_sides(name: &str, mesh: &TriMesh, around: &Lattice, band: Band) -> usize {
    let by_normals = field(mesh, around, Sign::Pseudonormal, band).grid;
    let levels = Levels::of(mesh, around, Inside::Positive, &Progress::none()).expect("levels");
    let by_levels = field(mesh, around, Sign::Levels(&levels), band).grid;
    let mut inside = 0;
    for v in voxels(around) {
        let (truth, got) = (by_normals.get(v), by_levels.get(v));
        assert!(truth.abs() < 1e-6 || truth == got, "{name}: {got} instead of {truth} at {v}");
        inside += usize::from(got < 0.0);
    }
    inside
}

/// Levels of an open mesh with more holes than it has: the same for any number of threads.
pub fn threads_leave_levels_alone(mut mesh: TriMesh) {
    mesh.triangles.retain(|t| t[0] % 7 != 0);
    let size = mesh.bounds().expect("triangles").size().max_element();
    let around = lattice(&mesh, size / 100.0, 2);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Levels::of(&mesh, &around, Inside::Positive, &Progress::none()).expect("levels"))
    };
    assert!(with(1) == with(3));
}

/// Lattices that hold part of a body, lie in it, or miss it: `check` compares a field with the truth, `field` makes it.
pub fn check_cut_lattices(
    check: impl Fn(&str, &TriMesh, &Lattice, Band) -> usize,
    field: impl Fn(&TriMesh, &Lattice, Band) -> Grid<f32>,
) {
    let mesh = turned(torus(24, 12), 0.4);
    let low = DVec3::new(0.4, -0.3, -0.2);
    for (low, band) in
        [(low, 3.0), (DVec3::new(0.95, -0.05, -0.1), 1.0), (DVec3::splat(2.0), 8.0), (DVec3::splat(9.0), 2.0)]
    {
        let small = Lattice { origin: low, h: 1.0 / 60.0, dims: IVec3::new(41, 33, 20) };
        check("torus", &mesh, &small, Band::Within(band));
    }
    let inside = Lattice { origin: DVec3::splat(-0.2), h: 0.01, dims: IVec3::splat(40) };
    let grid = field(&ball(2, |_| 1.0), &inside, Band::Within(2.0));
    assert_eq!(grid.bricks.len(), 0);
    assert_eq!((grid.get(IVec3::ZERO), grid.get(IVec3::new(39, 20, 3))), (-2.0, -2.0));
}
