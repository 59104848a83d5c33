// EWA in compute: a projection for each surfel, then one thread a pixel.

struct Pixel {
    color_sum: vec3<f32>, weight: f32,
    normal_sum: vec3<f32>, count: u32,
    color: vec3<f32>, depth: f32,
    normal: vec3<f32>, id: u32,
}

@group(0) @binding(1) var<storage, read> records: array<Splat>;
@group(0) @binding(2) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(3) var<storage, read_write> projected: array<Splat>;
@group(0) @binding(4) var<storage, read_write> pixels: array<Pixel>;

@compute @workgroup_size(64)
fn project_all(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < view.count {
        projected[id.x] = project(surfels[id.x]);
    }
}

fn covers(bounds: vec4<u32>, pixel: vec2<u32>) -> bool {
    return all(pixel >= bounds.xy) && all(pixel < bounds.zw);
}

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    let size = vec2<u32>(view.size);
    if any(pixel >= size) {
        return;
    }
    let position = vec2<f32>(pixel) + 0.5;

    // A strict comparison: of equally near fragments the first stays, which has the lowest index.
    var nearest = select(-view.infinity, 0.0, perspective());
    var out = Pixel();
    out.depth = view.infinity;
    out.id = NONE;
    for (var i = 0u; i < view.count; i++) {
        if covers(records[i].bounds, pixel) {
            let f = fragment(records[i], position);
            if inside(f.q) && f.nearness > nearest {
                nearest = f.nearness;
                out.id = records[i].surfel;
            }
        }
    }
    if out.id != NONE {
        out.depth = depth(nearest);
        let limit = out.depth + epsilon();
        for (var i = 0u; i < view.count; i++) {
            if covers(records[i].bounds, pixel) {
                let s = records[i];
                let f = fragment(s, position);
                if inside(f.q) && depth(f.nearness) <= limit {
                    let weight = weight(s, f.q);
                    out.weight += weight;
                    out.color_sum += weight * s.color;
                    out.normal_sum += weight * s.normal;
                    out.count += 1u;
                }
            }
        }
    }
    out.color = average(out.color_sum, out.weight);
    out.normal = direction(out.normal_sum, out.weight);
    pixels[pixel.y * size.x + pixel.x] = out;
}
