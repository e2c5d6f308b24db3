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

#[test]
fn print_all() {
    let sphere = sphere(1.0, 5);
    let at = DVec3::new(0.3, 0.5, 0.8).normalize();
    for radius in [0.1, 0.2, 0.4, 0.8] {
        for style in [Style::Auto, Style::Flat, Style::Smooth] {
            measured(&sphere, at, radius, style, to_sphere);
        }
    }
    println!("torus");
    let torus = torus(2.0, 0.8, 120, 48);
    for at in [DVec3::new(2.8, 0.0, 0.01), DVec3::new(0.0, 1.2, 0.01), DVec3::new(0.0, 2.0, 0.8)] {
        for radius in [0.2, 0.4, 0.6] {
            for style in [Style::Auto, Style::Smooth] {
                measured(&torus, at, radius, style, to_torus);
            }
        }
    }
    println!("cylinder");
    let cylinder = cylinder(96, 30);
    for at in [DVec3::new(1.0, 0.0, 0.01), DVec3::new(0.0, 1.0, 1.0), DVec3::new(0.5, 0.1, 1.0)] {
        for radius in [0.2, 0.4] {
            for style in [Style::Auto, Style::Smooth] {
                measured(&cylinder, at, radius, style, to_cylinder);
            }
        }
    }
    println!("cube");
    let cube = cube(20);
    for at in [DVec3::new(0.12, 0.03, 1.0), DVec3::new(1.0, 0.03, 1.0), DVec3::new(1.0, 1.0, 1.0)] {
        for radius in [0.2, 0.4] {
            for style in [Style::Auto, Style::Smooth] {
                measured(&cube, at, radius, style, to_cube);
            }
        }
    }
}
