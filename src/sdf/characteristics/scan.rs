//! Slabs of bricks along z, each of which takes the polyhedra that reach it one after another.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::polyhedron::{Polyhedron, Solid};
use crate::lattice::{BRICK, BRICK_VOXELS, index_in_brick};
use crate::progress::{Progress, Stopped};
use crate::sdf::exact::{Features, Filled, MARGIN, Scope};

/// Features between two looks at the clock.
const CHUNK: usize = 1 << 11;
/// The number of a brick that is not there.
const NONE: u32 = u32::MAX;

/// The first and the last slab that a feature reaches; the first is larger where there is none.
type Reach = [i16; 2];

/// What every slab needs to know.
struct Scan<'a> {
    features: &'a Features,
    scope: &'a Scope,
    progress: &'a Progress,
    faces: Vec<Reach>,
    edges: Vec<Reach>,
    vertices: Vec<Reach>,
    /// First and last brick that any polyhedron meets; z does not matter.
    window: [IVec3; 2],
}

/// All bricks that have voxels in the band, slab by slab.
pub(super) fn bricks(features: &Features, scope: &Scope, progress: &Progress) -> Result<Vec<Filled>, Stopped> {
    let (faces, around_faces) = reaches(&features.faces, scope, progress)?;
    let (edges, around_edges) = reaches(&features.edges, scope, progress)?;
    let (vertices, around_vertices) = reaches(&features.vertices, scope, progress)?;
    let [low, high] = joined(joined(around_faces, around_edges), around_vertices);
    let (low, high) = (low - MARGIN, high + MARGIN);
    let last = scope.end.as_dvec3() - 1.0;
    if !(low.cmple(last).all() && high.cmpge(DVec3::ZERO).all()) {
        return Ok(Vec::new());
    }
    let window = [low.floor().max(DVec3::ZERO), high.ceil().min(last)].map(|p| p.as_ivec3() / BRICK);
    let scan = Scan { features, scope, progress, faces, edges, vertices, window };
    let count = scope.end.z / BRICK;
    let done = std::sync::atomic::AtomicI32::new(0);
    let work = |polyhedron: &mut Polyhedron, z: i32| {
        let found = scan.slab(z, polyhedron);
        let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress.share(done as f32 / count as f32);
        found
    };
    // Slabs differ in what they cost: each is a task.
    let slabs = (0..count).into_par_iter().with_max_len(1);
    let slabs: Vec<Vec<Filled>> = slabs.map_init(Polyhedron::default, work).collect::<Result<_, _>>()?;
    Ok(slabs.into_iter().flatten().collect())
}

/// Low and high corner of a box.
type Around = [DVec3; 2];

fn joined(a: Around, b: Around) -> Around {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Which slabs each feature reaches, and a box around all of their polyhedra.
fn reaches<S: Solid>(all: &[S], scope: &Scope, progress: &Progress) -> Result<(Vec<Reach>, Around), Stopped> {
    let of_chunk = |polyhedron: &mut Polyhedron, chunk: &[S]| {
        progress.check()?;
        let mut around = NOWHERE;
        let reach = |solid: &S| {
            around = joined(around, solid.bounds(scope.band));
            polyhedron.set(solid, scope.band);
            polyhedron.slices([0, scope.end.z - 1]).map(|z| z.div_euclid(BRICK) as i16)
        };
        let reaches: Vec<Reach> = chunk.iter().map(reach).collect();
        Ok((reaches, around))
    };
    let chunks: Vec<(Vec<Reach>, Around)> =
        all.par_chunks(CHUNK).map_init(Polyhedron::default, of_chunk).collect::<Result<_, Stopped>>()?;
    let around = chunks.iter().fold(NOWHERE, |around, chunk| joined(around, chunk.1));
    Ok((chunks.into_iter().flat_map(|chunk| chunk.0).collect(), around))
}

const NOWHERE: Around = [DVec3::INFINITY, DVec3::NEG_INFINITY];

impl Scan<'_> {
    fn slab(&self, z: i32, polyhedron: &mut Polyhedron) -> Result<Vec<Filled>, Stopped> {
        let mut slab = Slab::new(z, self.window, self.scope);
        // At the same distance the first one scanned decides the side: faces before edges before vertices.
        self.add(&mut slab, &self.features.faces, &self.faces, polyhedron)?;
        self.add(&mut slab, &self.features.edges, &self.edges, polyhedron)?;
        self.add(&mut slab, &self.features.vertices, &self.vertices, polyhedron)?;
        Ok(slab.finish())
    }

    fn add<S: Solid>(
        &self,
        slab: &mut Slab,
        all: &[S],
        reaches: &[Reach],
        polyhedron: &mut Polyhedron,
    ) -> Result<(), Stopped> {
        for (all, reaches) in all.chunks(CHUNK).zip(reaches.chunks(CHUNK)) {
            self.progress.check()?;
            let number = slab.z as i16;
            for (solid, _) in all.iter().zip(reaches).filter(|(_, reach)| reach[0] <= number && number <= reach[1]) {
                polyhedron.set(solid, self.scope.band);
                slab.convert(solid, polyhedron);
            }
        }
        Ok(())
    }
}

/// One layer of bricks.
struct Slab {
    z: i32,
    window: [IVec3; 2],
    /// First and last voxel of the window along x and y.
    x: [i32; 2],
    y: [i32; 2],
    band: f32,
    /// Squares of distances from here on do not matter, h².
    limit: f64,
    /// Numbers of the bricks of the window that were met.
    numbers: Vec<u32>,
    places: Vec<IVec3>,
    /// Square of the least distance, h²; less than zero inside.
    squares: Vec<[f64; BRICK_VOXELS]>,
}

impl Slab {
    fn new(z: i32, window: [IVec3; 2], scope: &Scope) -> Self {
        let size = window[1] - window[0] + 1;
        Self {
            z,
            window,
            x: [window[0].x * BRICK, (window[1].x + 1) * BRICK - 1],
            y: [window[0].y * BRICK, (window[1].y + 1) * BRICK - 1],
            band: scope.band as f32,
            // A little more than the band: what is within it is told in single precision, as elsewhere.
            limit: (scope.band * scope.band).next_up() * (1.0 + f64::from(f32::EPSILON)),
            numbers: vec![NONE; size.x as usize * size.y as usize],
            places: Vec::new(),
            squares: Vec::new(),
        }
    }

    /// Measures a feature at all voxels of its polyhedron.
    fn convert<S: Solid>(&mut self, solid: &S, polyhedron: &Polyhedron) {
        for z in self.z * BRICK..(self.z + 1) * BRICK {
            let [first, last] = polyhedron.rows(z, self.y);
            for y in first..=last {
                let [first, last] = polyhedron.line(y, z, self.x);
                if first <= last {
                    self.line(solid, IVec3::new(first, y, z), last);
                }
            }
        }
    }

    #[inline]
    fn line<S: Solid>(&mut self, solid: &S, mut voxel: IVec3, last: i32) {
        let limit = self.limit;
        while voxel.x <= last {
            let Some(squares) = self.brick(voxel / BRICK) else { return };
            let until = (voxel.x | (BRICK - 1)).min(last);
            while voxel.x <= until {
                let square = &mut squares[index_in_brick(voxel)];
                if let Some((found, side)) = solid.distance(voxel.as_dvec3())
                    && found < square.abs().min(limit)
                {
                    *square = if side < 0.0 { -found } else { found };
                }
                voxel.x += 1;
            }
        }
    }

    /// The brick at `brick`; `None` outside of the window, where no polyhedron is.
    #[inline]
    fn brick(&mut self, brick: IVec3) -> Option<&mut [f64; BRICK_VOXELS]> {
        let [low, high] = self.window;
        let from = brick - low;
        let number = self.numbers.get_mut((from.y * (high.x - low.x + 1) + from.x) as usize)?;
        if *number == NONE {
            *number = self.places.len() as u32;
            self.places.push(brick);
            self.squares.push([f64::INFINITY; BRICK_VOXELS]);
        }
        self.squares.get_mut(*number as usize)
    }

    /// The bricks with voxels in the band.
    fn finish(self) -> Vec<Filled> {
        let band = self.band;
        let value = |square: f64| {
            let distance = square.abs().sqrt() as f32;
            if distance <= band { distance.copysign(square as f32) } else { f32::INFINITY }
        };
        let all = self.places.into_iter().zip(self.squares);
        let filled = all.map(|(brick, squares)| Filled { brick, values: Box::new(squares.map(value)) });
        filled.filter(|filled| filled.values.iter().any(|value| value.is_finite())).collect()
    }
}
