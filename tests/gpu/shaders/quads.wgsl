// What the rasterizing clients share: a quad for each splat, and the normalization over the screen.

@group(0) @binding(1) var<storage, read> records: array<Splat>;
@group(0) @binding(2) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(4) var color_sums: texture_2d<f32>;
@group(0) @binding(5) var normal_sums: texture_2d<f32>;

struct Quad {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) center: vec2<f32>,
    @location(1) @interpolate(flat) conic: vec3<f32>,
    @location(2) @interpolate(flat) plane: vec3<f32>,
    @location(3) @interpolate(flat) range_and_amplitude: vec3<f32>,
    @location(4) @interpolate(flat) normal: vec3<f32>,
    @location(5) @interpolate(flat) color: vec3<f32>,
    @location(6) @interpolate(flat) surfel: u32,
}

fn quad(s: Splat, corner: u32) -> Quad {
    let low = vec2<f32>(s.bounds.xy);
    let high = vec2<f32>(s.bounds.zw);
    let pixel = vec2(select(low.x, high.x, (corner & 1u) != 0u), select(low.y, high.y, corner > 1u));
    let place = (pixel / view.size * 2.0 - 1.0) * vec2(1.0, -1.0);
    return Quad(
        vec4(place, 0.5, 1.0), s.center, vec3(s.ux, s.uy, s.vy), vec3(s.w0, s.wx, s.wy),
        vec3(s.w_far, s.w_near, s.amplitude), s.normal, s.color, s.surfel,
    );
}

fn splat(quad: Quad) -> Splat {
    var s = Splat();
    s.center = quad.center;
    s.ux = quad.conic.x;
    s.uy = quad.conic.y;
    s.vy = quad.conic.z;
    s.w0 = quad.plane.x;
    s.wx = quad.plane.y;
    s.wy = quad.plane.z;
    s.w_far = quad.range_and_amplitude.x;
    s.w_near = quad.range_and_amplitude.y;
    s.amplitude = quad.range_and_amplitude.z;
    return s;
}

@vertex
fn quad_of_record(@builtin(vertex_index) corner: u32, @builtin(instance_index) i: u32) -> Quad {
    return quad(records[i], corner);
}

@vertex
fn quad_of_surfel(@builtin(vertex_index) corner: u32, @builtin(instance_index) i: u32) -> Quad {
    return quad(project(surfels[i]), corner);
}

@vertex
fn whole_screen(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    return vec4(select(-1.0, 3.0, corner == 1u), select(-1.0, 3.0, corner == 2u), 0.5, 1.0);
}

struct Surface {
    @location(0) color: vec4<f32>,
    @location(1) normal: vec4<f32>,
}

@fragment
fn normalization(@builtin(position) position: vec4<f32>) -> Surface {
    let pixel = vec2<i32>(position.xy);
    let color = textureLoad(color_sums, pixel, 0);
    let normal = textureLoad(normal_sums, pixel, 0);
    return Surface(vec4(average(color.xyz, color.w), 1.0), vec4(direction(normal.xyz, color.w), 1.0));
}
