//! How a surface looks in the light.

use glam::Vec3;

use super::rgb::Rgb;
use super::scene::Scene;
use super::sight::{On, Visible, weights};

/// Front sides.
const FRONT: Vec3 = Vec3::new(0.52, 0.60, 0.70);
/// Back sides: none are seen of an intact solid.
const BACK: Vec3 = Vec3::new(0.66, 0.13, 0.05);
/// Triangles that intersect others.
const MARKED: Vec3 = Vec3::new(1.0, 0.66, 0.0);
/// The inside of a mesh where it is cut, and the lines over it.
const CUT: [Vec3; 2] = [Vec3::new(0.86, 0.76, 0.58), Vec3::new(0.50, 0.40, 0.25)];
/// From one line of the hatching to the next, and how wide they are, pixels.
const HATCHING: [f32; 2] = [9.0, 1.4];

/// The main light, from above left and the viewer's side (x right, y up, z towards the viewer), and its strength.
const KEY: (Vec3, f32) = (Vec3::new(-0.45, 0.65, 0.62), 0.78);
/// A weaker one from the right, so that no side is black.
const FILL: (Vec3, f32) = (Vec3::new(0.80, 0.10, 0.45), 0.22);
/// Light from the sky above and from the ground.
const AMBIENT: [f32; 2] = [0.34, 0.16];

/// What colours that mean something keep of their light in the deepest shade: yellow stays yellow.
const MAP_LIGHT: f32 = 0.55;

/// From which brightness on light is compressed, so that nothing is white but a gloss on white.
const SHOULDER: f32 = 0.72;

/// The colour of a visible point at (x, y). `darkness` is the share of the sky that is hidden from it.
pub(super) fn shade(scene: &Scene, hit: Visible, [x, y]: [f32; 2], darkness: f32) -> Rgb {
    let On::Triangle(t) = hit.on() else { return hatched(scene, x, y) };
    let n = normal_at(scene, hit, x, y);
    let painted = painted(scene, t, x, y);
    let (base, means) = match (scene.marked[t], scene.facing[t] || scene.two_sided) {
        (true, _) => (MARKED, true),
        (_, true) => (painted.unwrap_or(FRONT), scene.paint_is_a_map && painted.is_some()),
        (_, false) => (BACK, false),
    };
    let open = 1.0 - darkness;
    let diffuse = diffuse(n, open);
    let diffuse = if means { MAP_LIGHT + (1.0 - MAP_LIGHT) * diffuse } else { diffuse };
    let half = (KEY.0.normalize() + Vec3::Z).normalize();
    let gloss = if means { 0.0 } else { 0.10 * n.dot(half).max(0.0).powi(40) * open };
    Rgb::of(toned(base * diffuse + Vec3::splat(gloss)))
}

/// How much light falls on a surface, of which `open` of the sky is free.
fn diffuse(n: Vec3, open: f32) -> f32 {
    let lit = |(from, strength): (Vec3, f32)| {
        // Wrapped a little around the terminator: soft, as from a large light.
        strength * ((n.dot(from.normalize()) + 0.15) / 1.15).max(0.0)
    };
    let sky = AMBIENT[1] + (AMBIENT[0] - AMBIENT[1]) * (0.5 + 0.5 * n.y);
    (lit(KEY) + lit(FILL)) * (0.45 + 0.55 * open) + sky * open
}

/// Light as an image can show it: the bright end is compressed, all channels alike, so that hues stay.
fn toned(light: Vec3) -> Vec3 {
    let most = light.max_element();
    if most <= SHOULDER {
        return light;
    }
    let room = 1.0 - SHOULDER;
    light * ((SHOULDER + room * (1.0 - (-(most - SHOULDER) / room).exp())) / most)
}

/// The inside of a mesh, cut.
fn hatched(scene: &Scene, x: f32, y: f32) -> Rgb {
    let normal = scene.cut.map_or(Vec3::Z, |cut| cut.normal());
    let [apart, width] = HATCHING;
    let from = ((x + y) / std::f32::consts::SQRT_2).rem_euclid(apart) - apart / 2.0;
    let share = (width / 2.0 + 0.5 - from.abs()).clamp(0.0, 1.0);
    let base = CUT[0].lerp(CUT[1], share);
    Rgb::of(toned(base * (0.5 + 0.5 * diffuse(normal, 1.0))))
}

/// The front side's own colour at a visible point.
fn painted(scene: &Scene, t: usize, x: f32, y: f32) -> Option<Vec3> {
    let [a, b, c] = *scene.paint.get(t)?;
    let w = weights(&scene.corners[t], x, y);
    Some((a * w[0] + b * w[1] + c * w[2]).clamp(Vec3::ZERO, Vec3::ONE))
}

/// The normal on the viewer's side at a visible point.
pub(super) fn normal_at(scene: &Scene, hit: Visible, x: f32, y: f32) -> Vec3 {
    let On::Triangle(t) = hit.on() else { return scene.cut.map_or(Vec3::Z, |cut| cut.normal()) };
    let w = weights(&scene.corners[t], x, y);
    let n = scene.smooth[t];
    let n = (n[0] * w[0] + n[1] * w[1] + n[2] * w[2]).try_normalize().unwrap_or(scene.flat[t]);
    if scene.facing[t] { n } else { -n }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bright_light_keeps_its_hue_and_its_order() {
        assert_eq!(toned(Vec3::new(0.2, 0.5, 0.7)), Vec3::new(0.2, 0.5, 0.7));
        let mut before = 0.0;
        for k in 1..40 {
            let light = Vec3::new(0.1, 0.06, 0.04) * k as f32;
            let shown = toned(light);
            assert!(shown.x > before && shown.x < 1.0, "{k}: {shown}");
            assert!((shown.y / shown.x - 0.6).abs() < 1e-5);
            before = shown.x;
        }
    }
}
