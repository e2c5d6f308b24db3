//! Loops alone: their measures, and lids over loops of all lengths and forms.

use std::f64::consts::TAU;

use super::*;

/// A band of triangles outside a loop of points, which goes counter-clockwise seen from the side that `up` points to. The rim of the loop has the vertices from 0 on.
fn band(points: &[DVec3], up: DVec3) -> TriMesh {
    let count = points.len() as u32;
    let outer = points.iter().map(|&p| p * 1.5 - up);
    let positions = points.iter().copied().chain(outer).collect();
    let next = |k: u32| (k + 1) % count;
    let of = |k: u32| [[k + count, next(k), k], [k + count, next(k) + count, next(k)]];
    TriMesh { positions, triangles: (0..count).flat_map(of).collect() }
}

/// The rim that has vertex 0.
fn inner_rim(mesh: &TriMesh) -> Rim {
    let found = rims(mesh).into_iter().find(|rim| rim.vertices.contains(&0)).expect("vertex 0 is open");
    assert!(found.vertices.iter().all(|&v| (v as usize) < mesh.positions.len() / 2));
    found
}

/// A loop of points by their angle.
fn loop_of(count: usize, at: impl Fn(f64) -> DVec3) -> Vec<DVec3> {
    (0..count).map(|k| at(k as f64 / count as f64 * TAU)).collect()
}

fn circle(angle: f64) -> DVec3 {
    DVec3::new(angle.cos(), angle.sin(), 0.0)
}

/// A star with seven rays.
fn star(angle: f64) -> DVec3 {
    circle(angle) * (1.0 + 0.6 * (7.0 * angle).sin())
}

/// A loop far from any plane.
fn saddle(angle: f64) -> DVec3 {
    circle(angle) + DVec3::Z * 0.7 * (3.0 * angle).cos()
}

/// A loop that looks like an eight from above and has a plane of its own nowhere.
fn twisted(angle: f64) -> DVec3 {
    DVec3::new(angle.sin(), (2.0 * angle).sin(), 0.4 * angle.cos())
}

/// Asserts that a lid meets its rim edge by edge and is a manifold disc without flat triangles.
fn assert_disc(mesh: &TriMesh, rim: &Rim, lid: &Lid) {
    let mut edges: FxHashMap<[u32; 2], i32> = FxHashMap::default();
    for t in &lid.triangles {
        (0..3).for_each(|k| *edges.entry([t[k], t[(k + 1) % 3]]).or_default() += 1);
    }
    assert!(edges.values().all(|&count| count == 1));
    let rim_edge = |k: usize| [rim.vertices[k], rim.vertices[(k + 1) % rim.vertices.len()]];
    assert!((0..rim.vertices.len()).all(|k| edges.contains_key(&rim_edge(k))));
    let open = edges.keys().filter(|&&[a, b]| !edges.contains_key(&[b, a])).count();
    assert_eq!(open, rim.vertices.len());
    assert_eq!(lid.triangles.len() + 2, rim.vertices.len() + 2 * lid.positions.len());
    let alone = TriMesh { positions: [&mesh.positions[..], &lid.positions].concat(), triangles: lid.triangles.clone() };
    assert_eq!(crate::mesh::flat_triangles(&alone), [0u32; 0]);
}

#[test]
fn loops_of_every_length_get_a_lid_in_time() {
    let kinds = [("circle", circle as fn(f64) -> DVec3), ("star", star), ("saddle", saddle), ("twisted", twisted)];
    for (name, kind) in kinds {
        for count in [3, 4, 5, 100, 5000] {
            let mesh = band(&loop_of(count, |angle| kind(angle + 0.1)), DVec3::Z);
            let (around, rim) = (Surroundings::new(&mesh), inner_rim(&mesh));
            assert_eq!(rim.vertices.len(), count);
            for style in [Style::Flat, Style::Smooth] {
                let started = Instant::now();
                let made = lid(&around, &rim, &FillOptions { style, ..FillOptions::default() });
                let time = started.elapsed();
                let made = made.unwrap_or_else(|error| panic!("{name} of {count}, {style:?}: {error}"));
                println!("{name} of {count}, {style:?}: {} triangles in {time:?}", made.triangles.len());
                assert!(time.as_secs() < 10, "{name} of {count}, {style:?}: {time:?}");
                assert_disc(&mesh, &rim, &made);
            }
        }
    }
}

#[test]
fn flat_lids_have_the_area_of_the_rim() {
    for (count, kind) in [(4, circle as fn(f64) -> DVec3), (100, circle), (700, star), (5000, star)] {
        let mesh = band(&loop_of(count, kind), DVec3::Z);
        let rim = inner_rim(&mesh);
        let lid = lid(&Surroundings::new(&mesh), &rim, &FillOptions::default()).expect("the rim is simple");
        assert_eq!((lid.style, lid.positions.len()), (Style::Flat, 0));
        assert!((lid.area - rim.area).abs() < 1e-12 * rim.area * count as f64, "{} of {}", lid.area, rim.area);
    }
}

#[test]
fn points_on_the_lines_of_a_square_make_no_flat_triangle() {
    for count in [8, 40, 400, 4000] {
        let side = |angle: f64| {
            let p = circle(angle);
            p / p.abs().max_element()
        };
        // A quarter of the points on each side, exactly on its line.
        let points: Vec<DVec3> = loop_of(count, side).iter().map(|p| (p * 4096.0).round() / 4096.0).collect();
        let mesh = band(&points, DVec3::Z);
        let rim = inner_rim(&mesh);
        for style in [Style::Auto, Style::Flat, Style::Smooth] {
            let options = FillOptions { style, ..FillOptions::default() };
            let lid = lid(&Surroundings::new(&mesh), &rim, &options).expect("the rim is simple");
            assert_disc(&mesh, &rim, &lid);
        }
    }
}

#[test]
fn a_rim_is_measured() {
    let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 5.0));
    let rim = inner_rim(&band(&points, DVec3::Z));
    assert_eq!(rim.vertices, [0, 1, 2, 3]);
    assert_eq!([rim.perimeter, rim.area, rim.flatness], [6.0, 2.0, 0.0]);
    assert_eq!((rim.diameter, rim.centre), (5f64.sqrt(), DVec3::new(1.0, 0.5, 5.0)));
    assert_eq!((rim.plane.normal, rim.plane.offset), (DVec3::Z, 5.0));
    let bent = [[0.0, 0.0, 0.1], [2.0, 0.0, -0.1], [2.0, 2.0, 0.1], [0.0, 2.0, -0.1]].map(DVec3::from);
    let rim = inner_rim(&band(&bent, DVec3::Z));
    assert!((rim.flatness - 0.1).abs() < 1e-12 && rim.plane.normal.z > 0.999);
    // The bound of the diameter of long loops.
    let rim = inner_rim(&band(&loop_of(4000, circle), DVec3::Z));
    assert!(rim.diameter <= 2.0 && rim.diameter > 1.98);
}

#[test]
fn rims_that_meet_in_a_vertex_are_told_apart() {
    let plane = |count: usize| {
        let row = |j: usize| (0..=count).map(|i| DVec3::new(i as f64, j as f64, 0.0)).collect();
        welded(&(0..=count).map(row).collect::<Vec<Vec<_>>>())
    };
    // Two squares of a sheet that touch in (3, 3) are missing.
    let gone = |p: DVec3| (2..4).any(|k| p.floor().truncate() == glam::DVec2::splat(f64::from(k)));
    let cut = without(&plane(6), gone);
    let found = rims(&cut);
    assert_eq!(found.iter().map(|rim| rim.vertices.len()).collect::<Vec<_>>(), [24, 4, 4]);
    assert!(found.windows(2).all(|pair| pair[0].perimeter >= pair[1].perimeter));
    // Two sheets that touch in one vertex have a rim each.
    let bow = TriMesh::new(
        [[0.0, 0.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
        vec![[0, 2, 1], [0, 3, 4]],
    );
    assert_eq!(rims(&bow.expect("it has all vertices")).len(), 2);
    assert_eq!(rims(&sphere(1.0, 2)), []);
}

#[test]
fn a_lid_does_not_depend_on_numbers() {
    let at = DVec3::new(0.3, 0.5, 0.8).normalize();
    let cut = without(&sphere(1.0, 4), |p| p.distance(at) < 0.4);
    let count = cut.positions.len();
    let moved = |v: usize| (v * 7 + 3) % count;
    assert!(!count.is_multiple_of(7));
    let mut other = TriMesh { positions: vec![DVec3::ZERO; count], triangles: cut.triangles.clone() };
    cut.positions.iter().enumerate().for_each(|(v, &p)| other.positions[moved(v)] = p);
    other.triangles.iter_mut().flatten().for_each(|v| *v = moved(*v as usize) as u32);
    other.triangles.reverse();
    let places = |mesh: &TriMesh, style: Style| {
        let (whole, lids) = closed(mesh, style);
        assert_eq!(lids.len(), 1);
        let lid = mesh.triangles.len()..whole.triangles.len();
        lid.map(|t| whole.corners(t).map(|p| p.to_array())).collect::<Vec<_>>()
    };
    for style in [Style::Flat, Style::Smooth] {
        assert_eq!(places(&cut, style), places(&other, style));
    }
}

#[test]
fn an_edge_of_the_mesh_is_not_made_again() {
    // Two triangles of a square, bent or flat: the lid over the four edges takes the other diagonal.
    for height in [0.3, 0.0] {
        for diagonal in [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]] {
            let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            let corners = [0, 1, 2, 3].map(|k| DVec3::new(square[k][0], square[k][1], height * (k % 2) as f64));
            let sheet = TriMesh { positions: corners.to_vec(), triangles: diagonal.to_vec() };
            for style in [Style::Auto, Style::Flat, Style::Smooth] {
                let (whole, _) = closed(&sheet, style);
                assert!(HalfEdges::new(&whole.triangles, whole.positions.len()).is_ok());
            }
        }
    }
}

#[test]
fn what_cannot_be_closed_says_why() {
    let none = |mesh: &TriMesh| {
        let around = Surroundings::new(mesh);
        rims(mesh).iter().map(|rim| lid(&around, rim, &FillOptions::default()).err()).collect::<Vec<_>>()
    };
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let single = TriMesh { positions: corners, triangles: vec![[0, 1, 2]] };
    assert_eq!(none(&single), [Some(NoLid::Folded)]);
    // Where one edge was divided on one side only, the gap is a triangle on a line.
    let line = (0..4).map(|k| DVec3::X * f64::from(k)).collect::<Vec<_>>();
    let crack = band(&line, DVec3::Z);
    assert!(none(&crack).contains(&Some(NoLid::NoArea)));
    let whole = sphere(1.0, 2);
    let cut = without(&whole, |p| p.z > 0.8);
    let rim = rims(&cut).remove(0);
    let other = Surroundings::new(&whole);
    assert_eq!(lid(&other, &rim, &FillOptions::default()), Err(NoLid::NoLoop));
    let mut wrong = rim;
    wrong.vertices.reverse();
    let around = Surroundings::new(&cut);
    assert_eq!(lid(&around, &wrong, &FillOptions::default()), Err(NoLid::NoLoop));
    wrong.vertices = vec![0, u32::MAX, 1];
    assert_eq!(lid(&around, &wrong, &FillOptions::default()), Err(NoLid::NoLoop));
}

#[test]
fn loops_that_touch_themselves_or_are_random_get_a_lid_or_a_reason() {
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    let mut random = Xoshiro256PlusPlus::seed_from_u64(17);
    let mut lids = 0;
    for round in 0..300 {
        let count = 3 + round % 40;
        // Few places, so that points coincide and lie on lines and planes.
        let mut next = || (random.next_u64() % 5) as f64;
        let points: Vec<DVec3> = (0..count).map(|_| DVec3::new(next(), next(), next())).collect();
        let mesh = band(&points, DVec3::Z);
        let rim = inner_rim(&mesh);
        for style in [Style::Auto, Style::Flat, Style::Smooth] {
            match lid(&Surroundings::new(&mesh), &rim, &FillOptions { style, ..FillOptions::default() }) {
                Ok(lid) => {
                    lids += 1;
                    assert_disc(&mesh, &rim, &lid);
                }
                Err(error) => assert!(matches!(error, NoLid::NoArea | NoLid::Folded), "{error}"),
            }
        }
    }
    assert!(lids > 600, "{lids}");
}

#[test]
fn far_and_tiny_rims_get_the_same_lid() {
    let at = DVec3::new(0.3, 0.5, 0.8).normalize();
    let cut = without(&sphere(1.0, 3), |p| p.distance(at) < 0.6);
    let of = |scale: f64| {
        let mesh = TriMesh { positions: cut.positions.iter().map(|&p| p * scale).collect(), ..cut.clone() };
        closed(&mesh, Style::Smooth).1.remove(0)
    };
    let one = of(1.0);
    for scale in [2f64.powi(-300), 2f64.powi(300)] {
        let other = of(scale);
        assert_eq!(other.triangles, one.triangles);
        assert!(other.positions.iter().zip(&one.positions).all(|(p, q)| (p / scale).distance(*q) < 1e-9));
    }
}
