//! What a material makes of the colours of vertices.

use gltf::{Document, Material};

use super::super::colour::{Rgba, srgb_from_linear};
use super::checked;

/// The colour of a material.
pub(super) struct Tint {
    /// Linear light, then alpha; the colours of vertices are multiplied by it.
    factor: [f32; 4],
    /// Whether alpha counts.
    transparent: bool,
}

impl Tint {
    /// The tint of a material.
    pub(super) fn of(document: &Document, material: &Material<'_>) -> Self {
        Self {
            factor: material.pbr_metallic_roughness().base_color_factor(),
            transparent: checked::is_transparent(document, material),
        }
    }

    /// Opaque white.
    pub(super) fn plain() -> Self {
        Self { factor: [1.0; 4], transparent: false }
    }

    /// White that lets alpha through: colours of vertices stay what they are in the file.
    pub(super) fn raw() -> Self {
        Self { factor: [1.0; 4], transparent: true }
    }

    /// Whether it leaves colours as they are, and says nothing where there are none.
    pub(super) fn is_plain(&self) -> bool {
        self.factor[..3] == [1.0; 3] && (!self.transparent || self.factor[3] == 1.0)
    }

    /// The colour of a vertex whose own is `vertex`. Channels out of range become the nearest in range, and `odd` counts one more.
    pub(super) fn applied_to(&self, vertex: [f32; 4], odd: &mut usize) -> Rgba {
        let product = |k: usize| f64::from(vertex[k]) * f64::from(self.factor[k]);
        let alpha = if self.transparent { (255.0 * product(3)).round() } else { 255.0 };
        let channels = [0, 1, 2].map(|k| srgb_from_linear(product(k)));
        *odd += usize::from(channels.contains(&None) || !(0.0..=255.0).contains(&alpha));
        // The cast ends at 0 and 255, and makes NaN 0.
        let nearest = |k: usize| channels[k].unwrap_or((255.0 * product(k)) as u8);
        [nearest(0), nearest(1), nearest(2), alpha as u8]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_multiplied_in_linear_light() {
        let tint = Tint { factor: [0.5, 1.0, 0.0, 0.5], transparent: true };
        let mut odd = 0;
        assert_eq!(tint.applied_to([1.0, 0.5, 1.0, 1.0], &mut odd), [188, 188, 0, 128]);
        assert_eq!(odd, 0);
        assert_eq!(tint.applied_to([4.0, -1.0, 0.0, f32::NAN], &mut odd), [255, 0, 0, 0]);
        assert_eq!(odd, 1);
        let opaque = Tint { transparent: false, ..tint };
        assert_eq!(opaque.applied_to([0.0, 0.0, 0.0, 0.0], &mut odd), [0, 0, 0, 255]);
    }
}
