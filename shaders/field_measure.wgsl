// The signed distance at each of the 64 voxels of a block, a workgroup a block: of its features the nearest whose outer side is seen, and the nearest
// whose inner side is. Where the two are too close for single precision to tell the side, the voxel is marked.

@group(0) @binding(2) var<storage, read> blocks: array<Block>;
@group(0) @binding(3) var<storage, read> lists: array<u32>;
/// Signed distances, h; the last bit says whether the side is in doubt. Beyond the band: infinity.
@group(0) @binding(4) var<storage, read_write> values: array<u32>;
/// For each block with a voxel in doubt the number of its features, else 0.
@group(0) @binding(5) var<storage, read_write> doubts: array<u32>;

const WIDTH: u32 = 64u;
/// Opposite sides closer together than this, h, and this share of the distance, are in doubt.
const DOUBT: f32 = 3e-5;
const DOUBT_SHARE: f32 = 1e-6;
/// The bits of infinity.
const NOTHING: u32 = 0x7f800000u;

/// A feature about the centre of the block. A face: its level and its three sides. An edge: two levels square to it, the way along it, and from its
/// other end, whether its normal says nothing. A vertex: the way from it, and the level of its normal.
struct Local {
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    d: vec4<f32>,
}

var<workgroup> locals: array<Local, WIDTH>;
var<workgroup> kinds: array<u32, WIDTH>;
var<workgroup> doubtful: atomic<u32>;

fn localise(lane: u32, id: u32, centre: vec3<i32>) {
    let at = rows_of(id);
    if id < job.kinds.x {
        let high = rows[at + 4u];
        locals[lane] = Local(
            about(rows[at], high.x, centre),
            about(rows[at + 1u], high.y, centre),
            about(rows[at + 2u], high.z, centre),
            about(rows[at + 3u], high.w, centre),
        );
        kinds[lane] = 0u;
    } else if id < job.kinds.y {
        let high = rows[at + 5u];
        let ends = rows[at + 6u];
        let blind = select(0.0, FAR, ends.w != 0);
        locals[lane] = Local(
            about(rows[at], high.x, centre),
            about(rows[at + 1u], high.y, centre),
            about(rows[at + 2u], high.z, centre),
            vec4(to_end(rows[at + 2u], high.z, ends, centre), blind, 0.0, 0.0),
        );
        kinds[lane] = 1u;
    } else {
        let twice = centre - 2 * rows[at].xyz;
        let way = 0.5 * vec3<f32>(twice) - bitcast<vec3<f32>>(rows[at + 1u].xyz);
        locals[lane] = Local(vec4(way, 0.0), about_near(rows[at + 2u], twice), vec4(0.0), vec4(0.0));
        kinds[lane] = 2u;
    }
}

/// The square of the distance and the side, each at `p` from the centre; `FAR` where the feature is not what it has nearest.
fn distance_to(n: u32, p: vec4<f32>) -> vec3<f32> {
    let local = locals[n];
    if kinds[n] == 0u {
        let inner = min(min(dot(local.b, p), dot(local.c, p)), dot(local.d, p));
        let level = dot(local.a, p);
        return vec3(select(FAR, level * level, inner >= -MARGIN), level, DOUBT);
    }
    if kinds[n] == 1u {
        let along = dot(local.c, p);
        let rest = local.d.x - dot(local.c.xyz, p.xyz);
        let across = vec2(dot(local.a, p), dot(local.b, p));
        return vec3(select(FAR, dot(across, across), min(along, rest) >= -MARGIN), across.x, DOUBT + local.d.y);
    }
    let way = local.a.xyz + p.xyz;
    return vec3(dot(way, way), dot(local.b, p), DOUBT);
}

@compute @workgroup_size(WIDTH)
fn measure(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let n = group.y * groups.x + group.x;
    if n >= job.kinds.w {
        return;
    }
    let block = blocks[n];
    if lane == 0u {
        atomicStore(&doubtful, 0u);
    }
    let centre = 2 * vec3(block.x, block.y, block.z) + 3;
    let voxel = vec3(lane & 3u, lane >> 2u & 3u, lane >> 4u);
    let p = vec4(vec3<f32>(voxel) - 1.5, 1.0);
    var outer = FAR;
    var inner = FAR;
    for (var first = 0u; first < block.count; first += WIDTH) {
        let count = min(block.count - first, WIDTH);
        if lane < count {
            localise(lane, lists[block.start + first + lane], centre);
        }
        workgroupBarrier();
        for (var k = 0u; k < count; k++) {
            let found = distance_to(k, p);
            outer = min(outer, select(FAR, found.x, found.y >= -found.z));
            inner = min(inner, select(FAR, found.x, found.y <= found.z));
        }
        workgroupBarrier();
    }

    let distance = sqrt(min(outer, inner));
    let doubt = DOUBT + DOUBT_SHARE * distance;
    let is_within = distance <= job.band;
    let close = is_within && abs(inner - outer) <= doubt * (2.0 * distance + doubt);
    let bits = bitcast<u32>(select(distance, -distance, inner < outer));
    let octant = n % 8u;
    let place = voxel + 4u * vec3(octant & 1u, octant >> 1u & 1u, octant >> 2u);
    let word = select(NOTHING, (bits & 0xfffffffeu) | select(0u, 1u, close), is_within);
    values[512u * (n / 8u) + place.x + 8u * place.y + 64u * place.z] = word;
    if close {
        atomicStore(&doubtful, 1u);
    }
    workgroupBarrier();
    if lane == 0u {
        doubts[n] = select(0u, block.count, atomicLoad(&doubtful) != 0u);
    }
}
