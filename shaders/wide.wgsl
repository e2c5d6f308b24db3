// Integers of 64 bits as (low, high) words in two's complement. The CPU twin is Rust's i64.

/// a * b, exactly.
fn wide_product(a: i32, b: i32) -> vec2<u32> {
    let x = bitcast<u32>(a);
    let y = bitcast<u32>(b);
    let x0 = x & 0xffffu;
    let x1 = x >> 16u;
    let y0 = y & 0xffffu;
    let y1 = y >> 16u;
    let low = x0 * y0;
    let first = x0 * y1;
    let second = x1 * y0;
    let middle = (low >> 16u) + (first & 0xffffu) + (second & 0xffffu);
    var high = x1 * y1 + (first >> 16u) + (second >> 16u) + (middle >> 16u);
    // The words were multiplied as if unsigned.
    high -= select(0u, y, a < 0) + select(0u, x, b < 0);
    return vec2(x * y, high);
}

/// a - b; the caller sees to it that it fits.
fn wide_difference(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2(a.x - b.x, a.y - b.y - select(0u, 1u, a.x < b.x));
}

fn wide_sum(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn wide_is_negative(a: vec2<u32>) -> bool {
    return bitcast<i32>(a.y) < 0;
}

fn wide_is_zero(a: vec2<u32>) -> bool {
    return (a.x | a.y) == 0u;
}

/// The nearest f32, or one beside it.
fn wide_to_float(a: vec2<u32>) -> f32 {
    let negative = wide_is_negative(a);
    let size = select(a, wide_difference(vec2(0u), a), negative);
    let value = f32(size.y) * 4294967296.0 + f32(size.x);
    return select(value, -value, negative);
}
