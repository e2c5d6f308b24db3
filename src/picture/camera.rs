//! From where a mesh is seen, and the map from model units to pixels.

use glam::{DVec2, DVec3, Vec3};

use crate::mesh::{Bounds, TriMesh};

/// The share of the image's sides that stays free on each side.
const MARGIN: f64 = 0.04;

/// The direction of a view in parallel projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The direction from the mesh to the viewer, of any length but 0.
    pub from: DVec3,
    /// The direction that is up in the image; any but one parallel to `from`.
    pub up: DVec3,
}

impl View {
    /// The view from the front, the right and above: x runs to the right and nearer, y to the right and away, z up.
    pub const ISO: Self = Self { from: DVec3::new(1.0, -1.3, 0.85), up: DVec3::Z };
    /// The view from −y: x to the right, z up.
    pub const FRONT: Self = Self { from: DVec3::NEG_Y, up: DVec3::Z };
    /// The view from +y: x to the left, z up.
    pub const BACK: Self = Self { from: DVec3::Y, up: DVec3::Z };
    /// The view from −x: y to the left, z up.
    pub const LEFT: Self = Self { from: DVec3::NEG_X, up: DVec3::Z };
    /// The view from +x: y to the right, z up.
    pub const RIGHT: Self = Self { from: DVec3::X, up: DVec3::Z };
    /// The view from +z: x to the right, y up.
    pub const TOP: Self = Self { from: DVec3::Z, up: DVec3::Y };
    /// The view from −z: x to the right, y down.
    pub const BOTTOM: Self = Self { from: DVec3::NEG_Z, up: DVec3::NEG_Y };

    /// The names that [`View::named`] knows.
    pub const NAMES: [&str; 7] = ["iso", "front", "back", "left", "right", "top", "bottom"];

    /// The view of a name, if it is one of [`View::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        let views = [Self::ISO, Self::FRONT, Self::BACK, Self::LEFT, Self::RIGHT, Self::TOP, Self::BOTTOM];
        Self::NAMES.iter().position(|&n| n == name).map(|k| views[k])
    }

    /// The same view of a mesh whose y axis points up (and z to the front), as is the custom in
    /// games and film.
    pub fn y_up(self) -> Self {
        let turned = |d: DVec3| DVec3::new(d.x, d.z, -d.y);
        Self { from: turned(self.from), up: turned(self.up) }
    }

    /// Right, up and towards the viewer: orthonormal, right-handed. Directions that say nothing are replaced.
    fn axes(&self) -> [DVec3; 3] {
        let towards = self.from.try_normalize().unwrap_or(DVec3::Z);
        let across = |up: DVec3| up.cross(towards).try_normalize().filter(|r| r.is_finite());
        let right = across(self.up.normalize_or_zero()).unwrap_or_else(|| towards.any_orthonormal_vector());
        [right, towards.cross(right), towards]
    }
}

/// The map from model units to camera space: x pixels to the right, y pixels down, z pixels towards the viewer.
pub(super) struct Camera {
    axes: [DVec3; 3],
    centre: DVec3,
    /// Brings the mesh to about unit size before anything else, so that no size overflows.
    shrink: f64,
    pixels: f64,
    /// Middle of the mesh as seen, shrunken units; middle of the image, pixels.
    middle: [DVec2; 2],
}

impl Camera {
    /// Fits all used vertices of `meshes` into the image; `None` without any.
    pub(super) fn new(view: &View, meshes: &[&TriMesh], [width, height]: [u32; 2]) -> Option<Self> {
        let bounds = meshes.iter().filter_map(|m| m.bounds()).reduce(|a, b| a.union(&b))?;
        let half = (bounds.max / 2.0 - bounds.min / 2.0).max_element();
        let mut camera = Self {
            axes: view.axes(),
            centre: bounds.min / 2.0 + bounds.max / 2.0,
            shrink: if half > 0.0 { (1.0 / half).min(f64::MAX) } else { 1.0 },
            pixels: 1.0,
            middle: [DVec2::ZERO; 2],
        };
        let used = meshes.iter().flat_map(|m| m.triangles.iter().flatten().map(|&v| m.positions[v as usize]));
        let seen = Bounds::of(used.map(|p| camera.turned(p)))?;
        let size = DVec2::new(f64::from(width), f64::from(height));
        let extent = seen.size().truncate().max(DVec2::splat(1e-6));
        camera.pixels = (size * (1.0 - 2.0 * MARGIN) / extent).min_element();
        camera.middle = [(seen.min + seen.max).truncate() / 2.0, size / 2.0];
        Some(camera)
    }

    fn turned(&self, p: DVec3) -> DVec3 {
        let p = (p - self.centre) * self.shrink;
        DVec3::from_array(self.axes.map(|axis| axis.dot(p)))
    }

    /// A position in camera space.
    pub(super) fn project(&self, p: DVec3) -> Vec3 {
        let [seen, image] = self.middle;
        let p = self.turned(p);
        let flat = image + (p.truncate() - seen) * DVec2::new(self.pixels, -self.pixels);
        flat.extend(p.z * self.pixels).as_vec3()
    }
}
