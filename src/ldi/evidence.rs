//! What the rays say of each triangle: whether it bounds the solid.

use super::{Layers, Spans};

/// How often each triangle of the soup was crossed, and how many of these crossings bound the solid.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Evidence {
    /// Crossings of each triangle by any ray.
    pub crossed: Vec<u32>,
    /// Crossings at which the solid begins or ends: where the solid lies against the triangle's normal, and
    /// where it lies along it (an operand that is taken away).
    pub bounding: Vec<[u32; 2]>,
    /// Crossings on silent rays, which say nothing.
    pub silent: Vec<u32>,
    /// Triangles that do not bound the solid, whatever the rays say; empty for none.
    pub changed: Vec<bool>,
}

impl Evidence {
    /// Counts the crossings of `triangles` triangles, before the spans are made.
    pub fn new(layers: &[Layers], triangles: usize) -> Self {
        let mut crossed = vec![0; triangles];
        layers.iter().flat_map(|layers| &layers.hits).for_each(|hit| crossed[hit.triangle() as usize] += 1);
        Self { crossed, bounding: vec![[0; 2]; triangles], silent: vec![0; triangles], changed: Vec::new() }
    }

    /// Evidence from samples of the triangles of a valid solid: how many there are of each triangle, and how many still bound
    /// the solid that is made of it.
    pub fn of_samples(samples: impl Iterator<Item = (u32, u32)>) -> Self {
        let mut evidence = Self::default();
        for (tried, bounding) in samples {
            evidence.crossed.push(tried);
            evidence.bounding.push([bounding, 0]);
            evidence.silent.push(0);
            evidence.changed.push(bounding < tried);
        }
        evidence
    }

    /// Counts which of the crossings are left in the spans made of these layers.
    pub fn add(&mut self, spans: &[Spans]) {
        for spans in spans {
            for ray in 0..spans.layers.ray_count() {
                let is_silent = spans.is_silent(ray);
                for hit in spans.layers.of(ray) {
                    let triangle = hit.triangle() as usize;
                    match is_silent {
                        true => self.silent[triangle] += 1,
                        false => self.bounding[triangle][usize::from(hit.reversed())] += 1,
                    }
                }
            }
        }
    }

    /// Crossings of a triangle that lie inside the solid or outside of it, with both sides alike.
    pub fn dropped(&self, triangle: usize) -> u32 {
        let left = self.bounding[triangle].iter().sum::<u32>() + self.silent[triangle];
        self.crossed[triangle].saturating_sub(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ldi::{Expression, Operands, spans};

    #[test]
    fn crossings_inside_the_solid_are_dropped_and_those_of_silent_rays_are_set_apart() {
        let both = Layers::of_one_ray(&[(1., 0, true), (2., 1, true), (3., 2, false), (4., 3, false)]);
        let open = Layers::of_one_ray(&[(1., 0, true), (2., 1, true), (3., 2, false)]);
        let mut evidence = Evidence::new(&[both.clone(), open.clone()], 4);
        assert_eq!(evidence.crossed, [2, 2, 2, 1]);
        let made = |layers| spans(layers, &Operands::new([4]), &Expression::Operand(0));
        evidence.add(&[made(both), made(open)]);
        assert_eq!(evidence.bounding, [[1, 0], [0, 0], [0, 0], [1, 0]]);
        assert_eq!(evidence.silent, [1, 1, 1, 0]);
        assert_eq!([0, 1, 2, 3].map(|t| evidence.dropped(t)), [0, 1, 1, 0]);
    }

    #[test]
    fn a_triangle_of_what_is_taken_away_bounds_the_solid_the_other_way() {
        let ray = Layers::of_one_ray(&[(1., 0, true), (2., 2, true), (3., 3, false), (4., 1, false)]);
        let mut evidence = Evidence::new(std::slice::from_ref(&ray), 4);
        evidence.add(&[spans(ray, &Operands::new([2, 2]), &Expression::difference(2))]);
        assert_eq!(evidence.bounding, [[1, 0], [1, 0], [0, 1], [0, 1]]);
    }
}
