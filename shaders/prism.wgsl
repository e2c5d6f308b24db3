// Prism scan conversion (Sigg et al. 2003, §3.4 and §4): a slice of the frusta of triangles, at each of its voxels the exact
// signed distance to the triangle. The depth test keeps the smallest in absolute value. Lengths are voxels.

struct View {
    /// The slice.
    z: i32,
    /// Where its sections begin in `listed`.
    start: u32,
    /// Voxels along x and y.
    size: vec2<f32>,
}

/// A triangle in its own frame: (a, 0), (0, h) and (-b, 0) are its corners, t is the height over it.
struct TriangleFrame {
    /// A voxel near it, and a.
    base: vec3<i32>,
    a: f32,
    /// Origin of the frame from there, and h.
    origin: vec3<f32>,
    h: f32,
    /// The axes, and b.
    r: vec3<f32>,
    b: f32,
    s: vec4<f32>,
    t: vec4<f32>,
    /// Pseudonormals: of the sides from (-b, 0), (a, 0) and (0, h), then of these corners.
    normals: array<vec4<f32>, 6>,
}

/// Corners from the base of the triangle, whose number is in the first one's w.
struct Frustum {
    corners: array<vec4<f32>, 12>,
}

/// The edges of a frustum that a slice crosses, four to a word, in order around the section.
struct Section {
    frustum: u32,
    edges: array<u32, 2>,
}

@group(0) @binding(0) var<storage, read> view: View;
@group(0) @binding(1) var<storage, read> listed: array<u32>;
@group(0) @binding(2) var<storage, read> sections: array<Section>;
@group(0) @binding(3) var<storage, read> frusta: array<Frustum>;
@group(0) @binding(4) var<storage, read> frames: array<TriangleFrame>;

/// No distance is farther than this.
override band: f32;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) frame: u32,
}

/// The two corners of a frustum that edge `n` joins: around either hexagon, or between them.
fn ends(n: u32) -> vec2<u32> {
    let ring = n / 6u;
    let k = n % 6u;
    if ring == 2u {
        return vec2(k, k + 6u);
    }
    return vec2(6u * ring + k, 6u * ring + (k + 1u) % 6u);
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    // A fan of six triangles.
    let k = select(index / 3u + index % 3u, 0u, index % 3u == 0u);
    let section = sections[listed[view.start + instance]];
    let word = section.edges[k / 4u];
    let pair = ends((word >> (8u * (k % 4u))) & 255u);
    let frame = bitcast<u32>(frusta[section.frustum].corners[0].w);
    let foot = frusta[section.frustum].corners[pair.x].xyz;
    let head = frusta[section.frustum].corners[pair.y].xyz;
    let base = frames[frame].base;
    let height = f32(view.z - base.z);
    let rise = head.z - foot.z;
    let share = select(0.0, clamp((height - foot.z) / rise, 0.0, 1.0), rise != 0.0);
    let p = vec2<f32>(base.xy) + mix(foot.xy, head.xy, share);
    // Voxels are at the middles of pixels; rows go down.
    let place = (2.0 * p + 1.0) / view.size - 1.0;
    return Corner(vec4(place.x, -place.y, 0.5, 1.0), frame);
}

struct Nearest {
    @location(0) signed: f32,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(in: Corner) -> Nearest {
    let f = in.frame;
    let voxel = vec3(vec2<i32>(floor(in.position.xy)), view.z);
    let relative = vec3<f32>(voxel - frames[f].base) - frames[f].origin;
    let across = dot(frames[f].r, relative);
    let s = dot(frames[f].s.xyz, relative);
    let t = dot(frames[f].t.xyz, relative);
    // The half with r < 0 is mirrored.
    let left = across < 0.0;
    let r = abs(across);
    let a = select(frames[f].a, frames[f].b, left);
    let h = frames[f].h;
    let square = a * a + h * h;
    let along = (a * r - h * s + h * h) / square;
    let out = (h * r + a * s - a * h) / square;
    let corner = select(4u, 3u, left);
    // What is nearest: 0 to 2 a side, 3 to 5 a corner, 6 the inside.
    var nearest = 6u;
    var off = vec2(0.0, 0.0);
    if s < 0.0 {
        nearest = select(corner, 0u, r <= a);
        off = vec2(max(r - a, 0.0), s);
    } else if out > 0.0 {
        if along <= 0.0 {
            nearest = 5u;
            off = vec2(r, s - h);
        } else if along >= 1.0 {
            nearest = corner;
            off = vec2(r - a, s);
        } else {
            nearest = select(1u, 2u, left);
            off = vec2(out * h, out * a);
        }
    }
    let way = vec3(select(off.x, -off.x, left), off.y, t);
    var side = t;
    if nearest < 6u {
        side = dot(frames[f].normals[nearest].xyz, way);
    }
    let distance = length(way);
    if distance > band {
        discard;
    }
    return Nearest(select(distance, -distance, side < 0.0), min(distance / (2.0 * band), 1.0));
}
