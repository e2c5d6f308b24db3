// For tests: the integers of wide.wgsl on numbers from outside.

/// a, b, c, d.
@group(0) @binding(0) var<storage, read> given: array<vec4<i32>>;
/// a b and a b - c d.
@group(0) @binding(1) var<storage, read_write> found: array<vec4<u32>>;
/// a b - c d as f32, and whether it is negative and zero.
@group(0) @binding(2) var<storage, read_write> judged: array<vec4<f32>>;

@compute @workgroup_size(64)
fn check(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let n = given[id.x];
    let product = wide_product(n.x, n.y);
    let difference = wide_difference(product, wide_product(n.z, n.w));
    found[id.x] = vec4(product, difference);
    let negative = select(0.0, 1.0, wide_is_negative(difference));
    let zero = select(0.0, 1.0, wide_is_zero(difference));
    judged[id.x] = vec4(wide_to_float(difference), negative, zero, 0.0);
}
