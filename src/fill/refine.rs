//! The density of a lid made that of its rim.
//!
//! Liepa (Filling holes in meshes, 2003): every point has a scale, the mean length of the edges of the rim at it. A triangle whose centre
//! is farther from all its corners than their scales allow is divided into three around that centre, which gets the mean of their scales. In between
//! edges are turned until the lid is Delaunay. That ends by itself, since every division makes triangles smaller.

use super::sheet::Sheet;

/// How much nearer than its scale a corner may be to the centre of a triangle that is divided: Liepa's √2.
const DENSITY: f64 = std::f64::consts::SQRT_2;

/// Rounds of division; each makes triangles at least a third smaller.
const ROUNDS: usize = 40;

/// Divides triangles until the lid is as dense as its rim, or, with `grows` above 1, so much sparser with every triangle on the way from it. At most `most` vertices
/// are added: where the rim asks for more, the whole lid is coarser.
pub(super) fn refine(sheet: &mut Sheet<'_>, most: usize, grows: f64) {
    sheet.turn_edges();
    let rim = sheet.below() as usize;
    let length = |k: usize| sheet.points[k].distance(sheet.points[(k + 1) % rim]);
    let mut scale: Vec<f64> = (0..rim).map(|k| (length(k) + length((k + rim - 1) % rim)) / 2.0).collect();
    let mean = scale.iter().sum::<f64>() / rim as f64;
    scale.push(0.0);
    scale.resize(sheet.points.len(), mean);
    let density = DENSITY.min(allowed(sheet, mean, most));
    for _ in 0..ROUNDS {
        let mut coarse: Vec<(f64, u32)> = Vec::new();
        for t in 0..sheet.triangle_ids() {
            let Some(corners) = sheet.triangle(t) else { continue };
            let places = sheet.corners(corners);
            let centre = (places[0] + places[1] + places[2]) / 3.0;
            let mean = mean_of(&scale, corners);
            let far = corners.iter().zip(places).all(|(&v, p)| {
                let away = density * p.distance(centre);
                away > mean && away > scale[v as usize]
            });
            if far {
                coarse.push((area(places) / (mean * mean), t));
            }
        }
        // The coarsest first, so that the vertices are spread evenly where they do not suffice.
        coarse.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        coarse.truncate((most + rim + 1).saturating_sub(sheet.points.len()));
        if coarse.is_empty() {
            return;
        }
        for (_, t) in coarse {
            // A division gives only the triangle beside it other corners in another order.
            let Some(corners) = sheet.triangle(t) else { continue };
            let places = sheet.corners(corners);
            scale.push(grows * mean_of(&scale, corners));
            sheet.divide(t, (places[0] + places[1] + places[2]) / 3.0);
        }
        sheet.turn_edges();
    }
}

fn mean_of(scale: &[f64], corners: [u32; 3]) -> f64 {
    corners.iter().map(|&v| scale[v as usize]).sum::<f64>() / 3.0
}

/// The density at which the lid gets about `most` vertices, from its area and the mean scale of its rim.
fn allowed(sheet: &Sheet<'_>, mean: f64, most: usize) -> f64 {
    let area: f64 = sheet.triangles().iter().map(|&t| area(sheet.corners(t))).sum();
    // A lid of equilateral triangles with edges as long as the scale has one vertex for each of its rhombs.
    let wanted = area / (mean * mean * 0.75f64.sqrt()).max(f64::MIN_POSITIVE);
    DENSITY * (most as f64 / wanted.max(1.0)).sqrt()
}

/// The area of a triangle.
pub(super) fn area([a, b, c]: [glam::DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}
