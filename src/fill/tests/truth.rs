//! Holes cut into shapes: the distance of the lid from what was there.

use super::*;

fn to_sphere(p: DVec3) -> f64 {
    p.length() - 1.0
}

fn to_torus(p: DVec3) -> f64 {
    (p.truncate().length() - 2.0).hypot(p.z) - 0.8
}

fn to_cylinder(p: DVec3) -> f64 {
    let [out, up] = [p.truncate().length() - 1.0, p.z.abs() - 1.0];
    if out <= 0.0 && up <= 0.0 { out.max(up) } else { out.max(0.0).hypot(up.max(0.0)) }
}

fn to_cube(p: DVec3) -> f64 {
    let q = p.abs() - 1.0;
    if q.max_element() <= 0.0 { q.max_element() } else { q.max(DVec3::ZERO).length() }
}

/// Closes a hole of a radius around a point, in each style, and gives the distances from the truth.
fn measured(mesh: &TriMesh, at: DVec3, radius: f64, style: Style, truth: fn(DVec3) -> f64) -> ([f64; 2], Lid) {
    let cut = without(mesh, |p| p.distance(at) < radius);
    let started = Instant::now();
    let (whole, mut lids) = closed(&cut, style);
    let time = started.elapsed();
    assert_eq!(lids.len(), 1);
    assert_solid(&whole);
    let lid = lids.remove(0);
    let found = distances(&cut, &lid, truth);
    println!(
        "radius {radius}: {style:?} → {:?}, {} vertices, {} triangles, largest {:.6}, mean {:.6}, {time:?}",
        lid.style,
        lid.positions.len(),
        lid.triangles.len(),
        found[0],
        found[1]
    );
    (found, lid)
}

/// Asserts the style that the rule comes to, and bounds for the largest and the mean distance.
fn assert_near(mesh: &TriMesh, truth: fn(DVec3) -> f64, cases: &[(DVec3, f64, Style, f64, f64)]) {
    for &(at, radius, style, largest, mean) in cases {
        let (found, lid) = measured(mesh, at, radius, Style::Auto, truth);
        assert_eq!(lid.style, style, "at {at}, radius {radius}");
        assert!(found[0] <= largest && found[1] <= mean, "at {at}, radius {radius}: {found:?}");
    }
}

#[test]
fn holes_of_a_sphere_are_closed_as_the_sphere() {
    // The triangles of the sphere itself are up to 0.0012 inside of it.
    let sphere = sphere(1.0, 5);
    let at = DVec3::new(0.3, 0.5, 0.8).normalize();
    let cases = [(0.1, 0.0013, 0.0006), (0.2, 0.0018, 0.0007), (0.4, 0.0016, 0.0006), (0.8, 0.0023, 0.0007)];
    assert_near(&sphere, to_sphere, &cases.map(|(radius, most, mean)| (at, radius, Style::Smooth, most, mean)));
    // A flat lid is as far off as the cap is high: this is what the smooth one saves.
    let (flat, _) = measured(&sphere, at, 0.4, Style::Flat, to_sphere);
    assert!(flat[0] > 0.06);
}

#[test]
fn holes_of_a_torus_are_closed_as_the_torus() {
    // The triangles of the torus itself are up to 0.0024 off.
    let [outside, inside, above] = [DVec3::new(2.8, 0.0, 0.01), DVec3::new(0.0, 1.2, 0.01), DVec3::new(0.0, 2.0, 0.8)];
    let cases = [
        (outside, 0.2, Style::Smooth, 0.005, 0.0018),
        (outside, 0.4, Style::Smooth, 0.010, 0.0028),
        (outside, 0.6, Style::Smooth, 0.015, 0.0030),
        (inside, 0.2, Style::Smooth, 0.0035, 0.0012),
        (inside, 0.4, Style::Smooth, 0.0055, 0.0015),
        (inside, 0.6, Style::Smooth, 0.0080, 0.0035),
        (above, 0.2, Style::Smooth, 0.0045, 0.0013),
        (above, 0.4, Style::Smooth, 0.0085, 0.0020),
        (above, 0.6, Style::Smooth, 0.0080, 0.0020),
    ];
    assert_near(&torus(2.0, 0.8, 120, 48), to_torus, &cases);
}

#[test]
fn holes_of_a_cylinder_are_closed_round_and_flat() {
    let (side, end) = (DVec3::new(1.0, 0.0, 0.01), DVec3::new(0.5, 0.1, 1.0));
    let cases = [
        (side, 0.2, Style::Smooth, 0.0015, 0.0005),
        (side, 0.4, Style::Smooth, 0.0020, 0.0005),
        (end, 0.2, Style::Flat, 0.0, 0.0),
        (end, 0.4, Style::Flat, 0.0, 0.0),
    ];
    let cylinder = cylinder(96, 30);
    assert_near(&cylinder, to_cylinder, &cases);
    // Its end is missing: the rim is sharp, and the lid is the end.
    let cut = without(&cylinder, |p| p.z > 0.999);
    let (whole, lids) = closed(&cut, Style::Auto);
    assert_solid(&whole);
    assert_eq!((lids[0].style, lids[0].positions.len(), lids[0].triangles.len()), (Style::Flat, 0, 94));
    assert!(distances(&cut, &lids[0], |p| p.z - 1.0)[0] < 1e-15);
}

#[test]
fn a_sharp_edge_goes_on_through_a_hole() {
    let cylinder = cylinder(96, 30);
    let rim = DVec3::new(0.0, 1.0, 1.0);
    assert_near(&cylinder, to_cylinder, &[0.2, 0.4, 0.6].map(|radius| (rim, radius, Style::Smooth, 0.004, 0.002)));
}

#[test]
fn holes_of_a_cube_are_closed_exactly() {
    let [face, edge, corner] = [DVec3::new(0.12, 0.03, 1.0), DVec3::new(1.0, 0.03, 1.0), DVec3::ONE];
    let exact = |at: DVec3, radius: f64| (at, radius, Style::Flat, 1e-15, 1e-15);
    let cases = [face, edge, corner].into_iter().flat_map(|at| [0.2, 0.4, 0.7].map(|radius| exact(at, radius)));
    let cube = cube(20);
    assert_near(&cube, to_cube, &cases.collect::<Vec<_>>());
    // Turned, nothing is exact any more.
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, 0.7);
    let turned = TriMesh { positions: cube.positions.iter().map(|&p| turn * p).collect(), ..cube.clone() };
    for at in [face, edge, corner] {
        let cut = without(&turned, |p| p.distance(turn * at) < 0.4);
        let (whole, lids) = closed(&cut, Style::Auto);
        assert_solid(&whole);
        assert_eq!(lids[0].style, Style::Flat);
        assert!(distances(&cut, &lids[0], |p| to_cube(turn.inverse() * p))[0] < 1e-12);
    }
}

#[test]
fn missing_triangles_and_faces_of_a_box_come_back() {
    let cube = crate::mesh::shapes::cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    for gone in [&[0][..], &[0, 1], &[0, 3, 5], &[2, 3, 10, 11], &[0, 4], &[0, 1, 4]] {
        let mut cut = cube.clone();
        let mut number = 0;
        cut.triangles.retain(|_| {
            number += 1;
            !gone.contains(&(number - 1))
        });
        let (whole, _) = closed(&cut, Style::Auto);
        assert_solid(&whole);
        let volume =
            validate(&whole, &ValidateOptions::default(), &Progress::default()).expect("nothing stops it").volume;
        assert!((volume - 6.0).abs() < 1e-12, "{gone:?}: {volume}");
        assert_eq!(whole.triangles.len(), 12, "{gone:?}");
    }
}

#[test]
fn a_lid_on_a_noisy_sphere_is_no_rougher_than_the_sphere() {
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut noisy = sphere(1.0, 5);
    for p in &mut noisy.positions {
        *p *= 1.0 + 0.006 * ((random.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
    }
    for radius in [0.2, 0.4, 0.8] {
        let at = DVec3::new(-0.2, 0.6, 0.7).normalize();
        let (found, lid) = measured(&noisy, at, radius, Style::Auto, to_sphere);
        assert_eq!(lid.style, Style::Smooth);
        assert!(found[0] < 0.05 * radius && found[1] < 0.02 * radius, "radius {radius}: {found:?}");
    }
}
