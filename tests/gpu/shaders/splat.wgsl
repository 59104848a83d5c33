// A splat on the screen, and its fragment at a pixel.

// The layout of splatref's `SplatRecord`.
struct Splat {
    center: vec2<f32>, ux: f32, uy: f32, vy: f32, w0: f32, wx: f32, wy: f32,
    w_far: f32, w_near: f32, amplitude: f32, surfel: u32, bounds: vec4<u32>,
    normal: vec3<f32>, opacity: f32, color: vec3<f32>, back: u32,
}

struct Fragment {
    q: f32,
    nearness: f32,
}

fn fragment(s: Splat, position: vec2<f32>) -> Fragment {
    let d = position - s.center + select(0.0, 0.5, bug == HALF_PIXEL);
    let u = s.ux * d.x + select(1.0, -1.0, bug == MIRRORED_TILT) * s.uy * d.y;
    let v = s.vy * d.y;
    let plane = s.w0 + s.wx * d.x + s.wy * d.y;
    let w = select(plane, s.w0, bug == DEPTH_OF_CENTER);
    return Fragment(u * u + v * v, clamp(w, s.w_far, s.w_near));
}

fn inside(q: f32) -> bool {
    let limit = view.cutoff * view.cutoff;
    return q <= select(limit, 0.99 * limit, bug == SMALL_CUTOFF);
}

fn weight(s: Splat, q: f32) -> f32 {
    var falloff = exp(-0.5 * q);
    if bug == COARSE_EXP { // (1 - x/256)^256
        falloff = pow(1.0 - q / 512.0, 256.0);
    }
    return select(s.amplitude, 1.0, bug == NO_AMPLITUDE) * falloff;
}
