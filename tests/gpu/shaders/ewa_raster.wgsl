// EWA by the rasterizer: a depth buffer, then additive blending.

@group(0) @binding(3) var nearest_depth: texture_2d<f32>;

struct Nearest {
    @location(0) depth: f32,
    @location(1) id: u32,
    @builtin(frag_depth) tested: f32,
}

@fragment
fn visibility(quad: Quad) -> Nearest {
    let f = fragment(splat(quad), quad.position.xy);
    if !inside(f.q) {
        discard;
    }
    // Reversed under a perspective camera: near / t. Else t / far.
    let tested = select(-f.nearness, f.nearness, perspective()) * view.depth_scale;
    return Nearest(depth(f.nearness), quad.surfel, tested);
}

struct Sums {
    @location(0) color_and_weight: vec4<f32>,
    @location(1) normal_and_count: vec4<f32>,
}

@fragment
fn attributes(quad: Quad) -> Sums {
    let s = splat(quad);
    let f = fragment(s, quad.position.xy);
    let nearest = textureLoad(nearest_depth, vec2<i32>(quad.position.xy), 0).x;
    if !(inside(f.q) && depth(f.nearness) <= nearest + epsilon()) {
        discard;
    }
    let weight = weight(s, f.q);
    return Sums(vec4(weight * quad.color, weight), vec4(weight * quad.normal, 1.0));
}
