//! How much of the sky each pixel's surface sees: rays through a tree of triangles.

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::{Ray, RayHit};
use obvhs::splits::split_aabbs_precise;
use obvhs::triangle::Triangle;
use rayon::prelude::*;

use super::light::normal_at;
use super::scene::Scene;
use super::sight::Sight;
use crate::progress::{Progress, Stopped};

/// Triangles whose box has more than this share of the whole box's surface are split for the tree,
const SPLIT_SHARE: f32 = 5e-5;
/// in up to six rounds, each of which may double their number, up to about so many boxes.
const BOXES: usize = 400_000;

/// Rays for each pixel.
const RAYS: usize = 2;
/// Pixels along the side of a square over which rays differ, and over which they are averaged.
const TILE: usize = 6;

/// How much of the sky is hidden by the mesh itself, 0 to 1, for each pixel. Few rays for each pixel,
/// different ones in each pixel of a square, then averaged over such a square where the surface is one.
pub(super) fn occlusion(scene: &Scene, seen: &Sight, progress: &Progress) -> Result<Vec<f32>, Stopped> {
    let [width, height] = seen.size;
    let reach = 0.22 * width.min(height) as f32;
    let directions = hemisphere();
    let sky = Sky::new(scene);
    progress.check()?;
    let mut points = vec![None; width * height];
    points.par_chunks_mut(width).enumerate().for_each(|(row, out)| {
        for (column, point) in out.iter_mut().enumerate() {
            *point = surface_point(scene, seen, row, column);
        }
    });
    let mut raw = vec![0f32; width * height];
    raw.par_chunks_mut(width).enumerate().try_for_each(|(row, out)| {
        progress.check()?;
        for (column, dark) in out.iter_mut().enumerate() {
            if let Some(point) = &points[row * width + column] {
                let tile = (row % TILE) * TILE + column % TILE;
                let hidden = |d: &Vec3| sky.hidden(point, *d, reach);
                *dark = directions[tile].iter().map(hidden).sum::<f32>() / RAYS as f32;
            }
        }
        Ok(())
    })?;
    Ok(averaged(&raw, &points, seen.size))
}

/// A visible point: position (pixels without perspective, y up) and normal on the viewer's side.
#[derive(Debug, Clone, Copy)]
struct Point {
    at: Vec3,
    normal: Vec3,
}

fn surface_point(scene: &Scene, seen: &Sight, row: usize, column: usize) -> Option<Point> {
    let k = seen.samples;
    let samples = (0..k * k).map(|i| (row * k + i / k, column * k + i % k));
    let (hit, [x, y]) = samples.filter_map(|(r, c)| seen.hit(r, c).map(|hit| (hit, seen.position(r, c)))).next()?;
    Some(Point { at: scene.camera.space(Vec3::new(x, y, hit.z)), normal: normal_at(scene, hit, x, y) })
}

/// Directions about +z, cosine-weighted, spread evenly within each pixel of a tile and over the tile.
fn hemisphere() -> Vec<[Vec3; RAYS]> {
    let count = TILE * TILE * RAYS;
    let direction = |k: usize| {
        // A lattice of rank 1: even in both coordinates at once.
        let u = (k as f32 + 0.5) / count as f32;
        let v = (k as f32 * 0.618_034).fract() * std::f32::consts::TAU;
        Vec3::new(u.sqrt() * v.cos(), u.sqrt() * v.sin(), (1.0 - u).sqrt())
    };
    // Neighbouring pixels take strides that are far apart.
    (0..TILE * TILE)
        .map(|tile| std::array::from_fn(|ray| direction(ray * TILE * TILE + (tile * 7) % (TILE * TILE))))
        .collect()
}

fn averaged(raw: &[f32], points: &[Option<Point>], [width, height]: [usize; 2]) -> Vec<f32> {
    let mut smooth = vec![0f32; raw.len()];
    smooth.par_chunks_mut(width).enumerate().for_each(|(row, out)| {
        for (column, dark) in out.iter_mut().enumerate() {
            let Some(own) = points[row * width + column] else { continue };
            let (mut sum, mut count) = (0.0, 0.0);
            for r in row.saturating_sub(TILE / 2)..(row + TILE / 2).min(height) {
                for c in column.saturating_sub(TILE / 2)..(column + TILE / 2).min(width) {
                    let Some(other) = points[r * width + c] else { continue };
                    // Off the tangent plane by more than a pixel or two, or turned away: another surface.
                    let apart = own.normal.dot(other.at - own.at).abs();
                    if apart < 1.5 && own.normal.dot(other.normal) > 0.8 {
                        sum += raw[r * width + c];
                        count += 1.0;
                    }
                }
            }
            *dark = if count > 0.0 { sum / count } else { raw[row * width + column] };
        }
    });
    smooth
}

/// The triangles as obstacles for rays.
struct Sky {
    tree: CwBvh,
    solids: Vec<Triangle>,
    /// Towards what is cut away, and where that begins.
    cut: Option<(Vec3A, f32)>,
}

impl Sky {
    fn new(scene: &Scene) -> Self {
        let corner = |p: Vec3| Vec3A::from(scene.camera.space(p));
        let solid = |c: &[Vec3; 3]| Triangle { v0: corner(c[0]), v1: corner(c[1]), v2: corner(c[2]) };
        let solids: Vec<Triangle> = scene.obstacles.iter().map(|&t| solid(&scene.corners[t as usize])).collect();
        let cut = scene.cut.map(|cut| {
            let (normal, at) = cut.in_space();
            (Vec3A::from(normal), at)
        });
        Self { tree: tree_over(&solids), solids, cut }
    }

    /// 1 for a ray that is blocked at once, falling to 0 at `reach`.
    fn hidden(&self, point: &Point, direction: Vec3, reach: f32) -> f32 {
        let (u, v) = point.normal.any_orthonormal_pair();
        let d = u * direction.x + v * direction.y + point.normal * direction.z;
        let origin = point.at + point.normal * 0.6 + Vec3::Z * 0.2;
        // Adding zero turns −0 into 0: the tree takes the two for opposite directions, and misses everything.
        let ray = Ray::new(Vec3A::from(origin), Vec3A::from(d) + Vec3A::ZERO, 0.0, reach);
        let mut hit = RayHit::none();
        self.tree.ray_traverse(ray, &mut hit, |ray, index| {
            let t = self.solids[self.tree.primitive_indices[index] as usize].intersect(ray);
            let gone = self.cut.is_some_and(|(normal, at)| normal.dot(ray.origin + ray.direction * t) > at);
            if gone { f32::INFINITY } else { t }
        });
        if hit.t < reach { (1.0 - hit.t / reach).powi(2) } else { 0.0 }
    }
}

/// The tree over triangles for occlusion rays. Slivers are split into several boxes: those of long ones that lie askew
/// would each hold half the scene.
fn tree_over(solids: &[Triangle]) -> CwBvh {
    let mut boxes: Vec<Aabb> = solids.iter().map(Triangle::aabb).collect();
    let mut ids: Vec<u32> = (0..solids.len() as u32).collect();
    let whole = boxes.iter().fold(Aabb::empty(), |all, b| all.union(b)).half_area();
    let large = whole * SPLIT_SHARE;
    let rounds = (BOXES / solids.len().max(1)).max(1).ilog2().min(6);
    split_aabbs_precise(&mut boxes, &mut ids, solids, large, large, 1.3, 1.1, rounds, 4);
    let params = BvhBuildParams::very_fast_build();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        params.ploc_search_distance,
        &boxes,
        ids,
        params.sort_precision,
        params.search_depth_threshold,
    );
    tree.uses_spatial_splits = true;
    ReinsertionOptimizer::default().run(&mut tree, params.reinsertion_batch_ratio, None);
    bvh2_to_cwbvh(&tree, 3, true, false)
}
