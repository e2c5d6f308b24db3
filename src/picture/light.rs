//! How a surface looks in the light.

use glam::Vec3;

use super::rgb::Rgb;
use super::scene::Scene;
use super::sight::{Visible, weights};

/// Front sides.
const FRONT: Vec3 = Vec3::new(0.52, 0.60, 0.70);
/// Back sides: none are seen of an intact solid.
const BACK: Vec3 = Vec3::new(0.66, 0.13, 0.05);
/// Triangles that intersect others.
const MARKED: Vec3 = Vec3::new(1.0, 0.50, 0.02);

/// The main light, from above left and the viewer's side (x right, y up, z towards the viewer), and its strength.
const KEY: (Vec3, f32) = (Vec3::new(-0.45, 0.65, 0.62), 0.78);
/// A weaker one from the right, so that no side is black.
const FILL: (Vec3, f32) = (Vec3::new(0.80, 0.10, 0.45), 0.22);
/// Light from the sky above and from the ground.
const AMBIENT: [f32; 2] = [0.34, 0.16];

/// The colour of a visible point at (x, y). `darkness` is the share of the sky that is hidden from it.
pub(super) fn shade(scene: &Scene, hit: Visible, [x, y]: [f32; 2], darkness: f32) -> Rgb {
    let t = hit.triangle as usize;
    let (n, facing) = normal_at(scene, t, x, y);
    let base = match (scene.marked[t], facing) {
        (true, _) => MARKED,
        (_, true) => painted(scene, t, x, y).unwrap_or(FRONT),
        (_, false) => BACK,
    };
    let lit = |(from, strength): (Vec3, f32)| {
        // Wrapped a little around the terminator: soft, as from a large light.
        strength * ((n.dot(from.normalize()) + 0.15) / 1.15).max(0.0)
    };
    let open = 1.0 - darkness;
    let sky = AMBIENT[1] + (AMBIENT[0] - AMBIENT[1]) * (0.5 + 0.5 * n.y);
    let diffuse = (lit(KEY) + lit(FILL)) * (0.45 + 0.55 * open) + sky * open;
    let half = (KEY.0.normalize() + Vec3::Z).normalize();
    let gloss = 0.10 * n.dot(half).max(0.0).powi(40) * open;
    Rgb::of(base * diffuse + Vec3::splat(gloss))
}

/// The front side's own colour at a visible point.
fn painted(scene: &Scene, t: usize, x: f32, y: f32) -> Option<Vec3> {
    let [a, b, c] = *scene.paint.get(t)?;
    let w = weights(&scene.corners[t], x, y);
    Some((a * w[0] + b * w[1] + c * w[2]).clamp(Vec3::ZERO, Vec3::ONE))
}

/// The normal on the viewer's side at a visible point, and whether the triangle faces the viewer.
pub(super) fn normal_at(scene: &Scene, t: usize, x: f32, y: f32) -> (Vec3, bool) {
    let facing = scene.flat[t].z >= 0.0;
    let w = weights(&scene.corners[t], x, y);
    let n = scene.smooth[t];
    let n = (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]).try_normalize().unwrap_or(scene.flat[t]);
    (if facing { n } else { -n }, facing)
}
