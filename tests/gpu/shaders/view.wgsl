// What every shader of these clients shares: the camera, and bugs that a test switches on.

struct View {
    rows: array<vec4<f32>, 3>, // of the view matrix
    focal: vec2<f32>,
    center: vec2<f32>,
    size: vec2<f32>,
    near: f32,
    infinity: f32, // WGSL has no literal for it
    cutoff: f32,
    low_pass: f32,
    epsilon: f32,
    depth_scale: f32, // a power of two, so that the depth test compares exact numbers
    perspective: u32,
    cull: u32,
    count: u32, // of records or surfels
    far_scale: f32, // likewise a power of two, for depths
    bins: vec4<f32>, // nearest and farthest depth, and how many; of Algorithm 1
}

@group(0) @binding(0) var<uniform> view: View;

const NONE = 0xffffffffu;

// The seeded bugs; 0 is a right client. Their names in Rust are in `bugs.rs`, in this order.
override bug: u32 = 0u;
const NO_LOW_PASS = 1u;
const HALF_EPSILON = 2u;
const HALF_PIXEL = 3u;
const NO_WEIGHT_GUARD = 4u;
const SMALL_CUTOFF = 5u;
const SMALL_QUADS = 6u;
const MIRRORED_TILT = 7u;
const NO_AMPLITUDE = 8u;
const BACK_NOT_TURNED = 9u;
const DEPTH_OF_CENTER = 10u;
const COARSE_EXP = 11u;
const RATIO_ABOVE_ONE = 12u; // from here on, of Algorithm 1
const ROUNDED_BIN = 13u;
const LEVEL_OFF = 14u; // from here on, of the pyramid
const EQUAL_WEIGHTS = 15u;
const NEVER_OCCLUDED = 16u;

fn perspective() -> bool {
    return view.perspective != 0u;
}

// Orders fragments: 1/t, or -t under an orthographic camera. The nearer fragment has the greater one.
fn nearness(depth: f32) -> f32 {
    return select(-depth, 1.0 / depth, perspective());
}

fn depth(nearness: f32) -> f32 {
    return select(-nearness, 1.0 / nearness, perspective());
}

fn epsilon() -> f32 {
    return select(view.epsilon, 0.5 * view.epsilon, bug == HALF_EPSILON);
}
