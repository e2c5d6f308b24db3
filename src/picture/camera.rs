//! From where a mesh is seen, and the map from model units to pixels.

use glam::{DVec2, DVec3, Mat3, Vec3};

use crate::mesh::{Bounds, TriMesh};

/// The share of the frame's sides that stays free on each side.
const MARGIN: f64 = 0.04;

/// In perspective the eye is so many times the radius of the mesh away from its middle: it fills an angle of 36 degrees.
const DISTANCE: f64 = 3.2;

/// How depth shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Projection {
    /// Lengths across the view look alike near and far, and can be measured.
    #[default]
    Orthographic,
    /// What is farther away looks smaller.
    Perspective,
}

/// The direction of a view.
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

    /// The view after a turn about its own upward direction, radians: to the right of the mesh for positive ones.
    #[must_use]
    pub fn turned(self, angle: f64) -> Self {
        let Some(axis) = self.up.try_normalize() else { return self };
        Self { from: glam::DQuat::from_axis_angle(axis, angle) * self.from, up: self.up }
    }

    /// Right, up and towards the viewer: orthonormal, right-handed. Directions that say nothing are replaced.
    pub(super) fn axes(&self) -> [DVec3; 3] {
        let towards = self.from.try_normalize().unwrap_or(DVec3::Z);
        let across = |up: DVec3| up.cross(towards).try_normalize().filter(|r| r.is_finite());
        let right = across(self.up.normalize_or_zero()).unwrap_or_else(|| towards.any_orthonormal_vector());
        [right, towards.cross(right), towards]
    }
}

/// Where on the image the mesh is drawn, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    /// The left upper corner.
    pub(super) corner: DVec2,
    pub(super) size: DVec2,
}

impl Frame {
    /// All of an image.
    pub(super) fn whole([width, height]: [u32; 2]) -> Self {
        Self { corner: DVec2::ZERO, size: DVec2::new(f64::from(width), f64::from(height)) }
    }
}

/// The map from model units to the image: x pixels to the right, y pixels down, z pixels towards the viewer. Straight lines stay straight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Camera {
    axes: [DVec3; 3],
    centre: DVec3,
    /// Brings the mesh to about unit size before anything else, so that no size overflows.
    shrink: f64,
    /// Pixels a shrunken unit.
    pixels: f64,
    /// Middle of the mesh as seen, shrunken units; middle of the frame, pixels.
    middle: [DVec2; 2],
    /// In perspective, how far the eye is from the centre, shrunken units.
    eye: Option<f64>,
}

impl Camera {
    /// One for each view, all of the same scale: all used vertices of `meshes`, or `focus` instead, fit into the frame in each. `None` without vertices.
    pub(super) fn for_views(
        views: &[View],
        meshes: &[&TriMesh],
        focus: Option<&Bounds>,
        projection: Projection,
        frame: &Frame,
    ) -> Option<Vec<Self>> {
        let bounds = meshes.iter().filter_map(|m| m.bounds()).reduce(|a, b| a.union(&b))?;
        let half = (bounds.max / 2.0 - bounds.min / 2.0).max_element();
        let shrink = if half > 0.0 { (1.0 / half).min(f64::MAX) } else { 1.0 };
        let radius = ((bounds.max / 2.0 - bounds.min / 2.0) * shrink).length();
        let new = |view: &View| Self {
            axes: view.axes(),
            centre: bounds.min / 2.0 + bounds.max / 2.0,
            shrink,
            pixels: 1.0,
            middle: [DVec2::ZERO, frame.corner + frame.size / 2.0],
            eye: (projection == Projection::Perspective).then(|| DISTANCE * radius.max(1e-6)),
        };
        let mut cameras: Vec<Self> = views.iter().map(new).collect();
        let mut scale = f64::INFINITY;
        for camera in &mut cameras {
            let seen = match focus {
                Some(focus) => Bounds::of(corners(focus).map(|p| camera.flattened(p))),
                None => {
                    let used =
                        meshes.iter().flat_map(|m| m.triangles.iter().flatten().map(|&v| m.positions[v as usize]));
                    Bounds::of(used.map(|p| camera.flattened(p)))
                }
            }?;
            let extent = seen.size().truncate().max(DVec2::splat(1e-6));
            scale = scale.min((frame.size * (1.0 - 2.0 * MARGIN) / extent).min_element());
            camera.middle[0] = (seen.min + seen.max).truncate() / 2.0;
        }
        cameras.iter_mut().for_each(|camera| camera.pixels = scale);
        Some(cameras)
    }

    /// A position seen from the viewer's place, shrunken units: to the right, up, towards the viewer.
    fn turned(&self, p: DVec3) -> DVec3 {
        let p = (p - self.centre) * self.shrink;
        DVec3::from_array(self.axes.map(|axis| axis.dot(p)))
    }

    /// The same in perspective, if there is one.
    fn flattened(&self, p: DVec3) -> DVec3 {
        let p = self.turned(p);
        match self.eye {
            // All three coordinates alike: so planes stay planes.
            Some(eye) => p * (eye / (eye - p.z)),
            None => p,
        }
    }

    /// A position on the image.
    pub(super) fn project(&self, p: DVec3) -> Vec3 {
        let [seen, image] = self.middle;
        let p = self.flattened(p);
        let flat = image + (p.truncate() - seen) * DVec2::new(self.pixels, -self.pixels);
        flat.extend(p.z * self.pixels).as_vec3()
    }

    /// From the image back to the viewer's space, shrunken units.
    fn back(&self, p: Vec3) -> DVec3 {
        let [seen, image] = self.middle;
        let p = p.as_dvec3();
        let flat = seen + (p.truncate() - image) / DVec2::new(self.pixels, -self.pixels);
        let q = flat.extend(p.z / self.pixels);
        match self.eye {
            Some(eye) => q * (eye / (eye + q.z)),
            None => q,
        }
    }

    /// From the image to a space without perspective: x right, y up, z towards the viewer, in pixels as they are at the mesh's middle.
    pub(super) fn space(&self, p: Vec3) -> Vec3 {
        (self.back(p) * self.pixels).as_vec3()
    }

    /// Turns directions of the model into those of the viewer: x right, y up, z towards the viewer.
    pub(super) fn turn(&self) -> Mat3 {
        Mat3::from_cols_array_2d(&self.axes.map(|axis| axis.as_vec3().to_array())).transpose()
    }

    /// Pixels that a length, model units, takes across the view; `None` in perspective.
    pub(super) fn pixels_of(&self, length: f64) -> Option<f64> {
        self.eye.is_none().then_some(length * self.shrink * self.pixels)
    }

    /// The model's axes in the view: x right, y up.
    pub(super) fn shown_axes(&self) -> [DVec3; 3] {
        [0, 1, 2].map(|k| DVec3::from_array(self.axes.map(|axis| axis[k])))
    }

    /// The plane of a cut as the viewer has it.
    pub(super) fn cut(&self, axis: usize, at: f64) -> Cut {
        let normal = DVec3::from_array(self.axes.map(|row| row[axis]));
        let at = (at - self.centre[axis]) * self.shrink;
        let side = if normal.z < -1e-9 { -1.0 } else { 1.0 };
        Cut { camera: *self, normal: normal * side, at: at * side }
    }
}

/// The corners of a box.
fn corners(bounds: &Bounds) -> impl Iterator<Item = DVec3> + use<> {
    let (min, max) = (bounds.min, bounds.max);
    let pick = |k: usize, bit: usize, low: f64, high: f64| if k & bit == 0 { low } else { high };
    (0..8).map(move |k| DVec3::new(pick(k, 1, min.x, max.x), pick(k, 2, min.y, max.y), pick(k, 4, min.z, max.z)))
}

/// A plane on whose far side, seen from the viewer, all is drawn, and nothing on this side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    camera: Camera,
    /// Towards what is taken away, in the viewer's space.
    normal: DVec3,
    /// Shrunken units.
    at: f64,
}

impl Cut {
    /// Whether a place of the image is drawn.
    pub(super) fn keeps(&self, p: Vec3) -> bool {
        self.normal.dot(self.camera.back(p)) <= self.at
    }

    /// The depth of the plane at a place of the image, pixels; `None` where it is seen from its edge.
    pub(super) fn depth(&self, x: f32, y: f32) -> Option<f32> {
        let [seen, image] = self.camera.middle;
        let pixels = self.camera.pixels;
        let flat = seen + (DVec2::new(f64::from(x), f64::from(y)) - image) / DVec2::new(pixels, -pixels);
        let across = self.normal.truncate().dot(flat);
        let z = match self.camera.eye {
            Some(eye) => eye * (self.at - across) / (self.normal.z * eye - self.at),
            None => (self.at - across) / self.normal.z,
        };
        let z = (z * pixels) as f32;
        (z.is_finite() && self.normal.z > 1e-6).then_some(z)
    }

    /// The direction towards what is taken away: x right, y up, z towards the viewer.
    pub(super) fn normal(&self) -> Vec3 {
        self.normal.as_vec3()
    }

    /// The same direction, and where the plane lies along it, in the space of [`Camera::space`].
    pub(super) fn in_space(&self) -> (Vec3, f32) {
        (self.normal(), (self.at * self.camera.pixels) as f32)
    }

    /// The part of a line that is drawn.
    pub(super) fn clipped(&self, [a, b]: [Vec3; 2]) -> Option<[Vec3; 2]> {
        match [self.keeps(a), self.keeps(b)] {
            [true, true] => Some([a, b]),
            [false, false] => None,
            [first, _] => {
                let [mut inside, mut outside] = if first { [a, b] } else { [b, a] };
                // To a hundredth of a pixel, for lines of up to 16,384.
                for _ in 0..21 {
                    let middle = (inside + outside) / 2.0;
                    if self.keeps(middle) { inside = middle } else { outside = middle }
                }
                Some(if first { [a, inside] } else { [inside, b] })
            }
        }
    }
}
