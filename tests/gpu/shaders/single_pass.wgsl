// Algorithm 1: a depth-image for each group, then compositing over the images.

@group(0) @binding(6) var color_images: texture_2d_array<f32>;
@group(0) @binding(7) var normal_images: texture_2d_array<f32>;
@group(0) @binding(8) var id_images: texture_2d_array<u32>;

struct Kept {
    @location(0) color_and_weight: vec4<f32>,
    @location(1) normal_and_depth: vec4<f32>,
    @location(2) id: u32,
    @builtin(frag_depth) tested: f32,
}

@fragment
fn geometry(quad: Quad) -> Kept {
    let s = splat(quad);
    let f = fragment(s, quad.position.xy);
    if !inside(f.q) {
        discard;
    }
    let weight = weight(s, f.q);
    let t = depth(f.nearness);
    // At most 65,536 bins of 256 steps: 2^-17 brings them to [0, 1], exactly.
    let tested = voronoi(t, f.q) / 131072.0;
    return Kept(vec4(weight * quad.color, weight), vec4(weight * quad.normal, t), quad.surfel, tested);
}

fn voronoi(t: f32, q: f32) -> f32 {
    let position = ((t - view.bins.x) / (view.bins.y - view.bins.x)) * view.bins.z;
    let bin = clamp(floor(position + select(0.0, 0.5, bug == ROUNDED_BIN)), 0.0, view.bins.z);
    if bug == RATIO_ABOVE_ONE {
        return bin + sqrt(q);
    }
    let ratio = sqrt(q / (view.cutoff * view.cutoff));
    return bin + min(ratio, 255.0 / 256.0);
}

struct Composite {
    @location(0) color_and_weight: vec4<f32>,
    @location(1) normal_and_count: vec4<f32>,
    @location(2) depth: f32,
    @location(3) id: u32,
}

@fragment
fn compositing(@builtin(position) position: vec4<f32>) -> Composite {
    let pixel = vec2<i32>(position.xy);
    let groups = textureNumLayers(color_images);
    var out = Composite();
    out.depth = view.infinity;
    out.id = NONE;
    for (var k = 0u; k < groups; k++) {
        let t = textureLoad(normal_images, pixel, k, 0).w;
        let id = textureLoad(id_images, pixel, k, 0).x;
        if t < out.depth || (t == out.depth && id < out.id) {
            out.depth = t;
            out.id = id;
        }
    }
    for (var k = 0u; k < groups; k++) {
        let normal = textureLoad(normal_images, pixel, k, 0);
        let id = textureLoad(id_images, pixel, k, 0).x;
        if id != NONE && normal.w <= out.depth + epsilon() {
            out.color_and_weight += textureLoad(color_images, pixel, k, 0);
            out.normal_and_count += vec4(normal.xyz, 1.0);
        }
    }
    return out;
}
