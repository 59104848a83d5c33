// From a surfel to its splat: the affine outline of EWA, by the formulas of `splatref::splat::project`.

struct Surfel {
    position: vec3<f32>, radius: f32,
    normal: vec3<f32>, is_ellipse: u32,
    color: vec3<f32>, reach: f32, // radius of the bounding sphere
    u: vec3<f32>, index: u32, // of an ellipse: its half axes
    v: vec3<f32>, spare: u32,
}

// The covariance of a disc or an ellipse on the screen, in px^2.
struct Covariance {
    xx: f32, xy: f32, yy: f32,
    area: f32, // the root of its determinant
    half: f32, // half the range of depth
}

fn turned(v: vec3<f32>) -> vec3<f32> {
    return vec3(dot(view.rows[0].xyz, v), dot(view.rows[1].xyz, v), dot(view.rows[2].xyz, v));
}

// The smallest power that splatref draws: a fainter splat counts as seen edge-on.
const FAINT = 1.0 / 79228162514264337593543950336.0;

fn project(s: Surfel) -> Splat {
    var splat = Splat(); // without pixels, until it is known to be visible
    splat.surfel = s.index;
    let p = turned(s.position) + vec3(view.rows[0].w, view.rows[1].w, view.rows[2].w);
    let n = turned(s.normal);
    let t = -p.z;
    let m = select(1.0, 1.0 / t, perspective());
    let d = select(vec2(0.0), p.xy * m, perspective()); // the ray through the centre is (d, -1)
    let at = select(p.xy, d, perspective());
    let g = dot(n.xy, d) - n.z; // < 0: the front is seen
    if !(t > view.near) || (view.cull != 0u && g >= 0.0) || !in_sight(p, t, s.reach) {
        return splat;
    }
    splat.center = view.center + view.focal * at * vec2(1.0, -1.0);
    let scale = view.focal * m;
    let c = covariance(s, n, d, g, scale);

    let h = select(view.low_pass, 0.0, bug == NO_LOW_PASS);
    let det = (c.area * c.area + h * (c.xx + c.yy)) + h * h;
    let xx = c.xx + h;
    let yy = c.yy + h;
    splat.ux = sqrt(yy / det);
    splat.uy = -((c.xy / yy) * splat.ux);
    splat.vy = 1.0 / sqrt(yy);
    splat.amplitude = c.area / sqrt(det);

    splat.w0 = nearness(t);
    splat.wx = (m * n.x) / (view.focal.x * g);
    splat.wy = -((m * n.y) / (view.focal.y * g));
    splat.w_far = nearness(t + c.half);
    splat.w_near = nearness(max(t - c.half, view.near));

    let back = g > 0.0;
    splat.normal = select(s.normal, -s.normal, back && bug != BACK_NOT_TURNED);
    splat.opacity = 1.0;
    splat.color = s.color;
    splat.back = u32(back);
    if splat.amplitude >= FAINT {
        // A pixel more than the ellipse needs: the test of q decides.
        let rim = view.cutoff * vec2(sqrt(xx), sqrt(yy));
        let reach = select(rim + 1.0, 0.9 * rim, bug == SMALL_QUADS);
        let low = clamp(floor(splat.center - reach), vec2(0.0), view.size);
        let high = clamp(ceil(splat.center + reach), vec2(0.0), view.size);
        splat.bounds = vec4(vec2<u32>(low), vec2<u32>(high));
    }
    return splat;
}

fn covariance(s: Surfel, n: vec3<f32>, d: vec2<f32>, g: f32, scale: vec2<f32>) -> Covariance {
    if s.is_ellipse != 0u {
        let u = turned(s.u) / view.cutoff;
        let v = turned(s.v) / view.cutoff;
        let a = vec2(scale.x * (u.x + d.x * u.z), -(scale.y * (u.y + d.y * u.z)));
        let b = vec2(scale.x * (v.x + d.x * v.z), -(scale.y * (v.y + d.y * v.z)));
        let normal = cross(u, v);
        let area = abs((scale.x * scale.y) * (dot(normal.xy, d) - normal.z));
        let half = view.cutoff * sqrt(u.z * u.z + v.z * v.z);
        return Covariance(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y, area, half);
    }
    let r = (s.radius / view.cutoff) * scale;
    let c = vec3(-(d.x * n.y), d.x * n.x - n.z, n.y);
    let e = vec3(n.z - d.y * n.y, d.y * n.x, -n.x);
    let area = abs((r.x * r.y) * g);
    let half = s.radius * sqrt(n.x * n.x + n.y * n.y);
    return Covariance((r.x * r.x) * dot(c, c), -((r.x * r.y) * dot(c, e)), (r.y * r.y) * dot(e, e), area, half);
}

// Whether the bounding sphere reaches into the view, to within the reach of the low-pass filter.
fn in_sight(p: vec3<f32>, t: f32, radius: f32) -> bool {
    let far = view.size - view.center;
    let depth = select(1.0, t, perspective());
    let filtered = view.cutoff * sqrt(view.low_pass) * depth;
    let x = view.focal.x * p.x;
    let y = view.focal.y * p.y;
    return x + view.center.x * depth >= -(side(radius, view.focal.x, view.center.x) + filtered)
        && -x + far.x * depth >= -(side(radius, view.focal.x, far.x) + filtered)
        && -y + view.center.y * depth >= -(side(radius, view.focal.y, view.center.y) + filtered)
        && y + far.y * depth >= -(side(radius, view.focal.y, far.y) + filtered);
}

fn side(radius: f32, focal: f32, edge: f32) -> f32 {
    return radius * select(focal, sqrt(focal * focal + edge * edge), perspective());
}
