// The pull-push pyramid: points of one pixel, then levels of cells in a buffer, the finest first.

@group(0) @binding(2) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(3) var ids: texture_2d<u32>;
@group(0) @binding(4) var normals: texture_2d<f32>; // and depth
@group(0) @binding(5) var colors: texture_2d<f32>; // and extent
@group(0) @binding(6) var centers: texture_2d<f32>; // and radius
@group(0) @binding(7) var<storage, read_write> pulled: array<Cell>;
@group(0) @binding(8) var<storage, read_write> pushed: array<Cell>;
@group(0) @binding(9) var<uniform> step: Step;

struct Cell {
    normal: vec3<f32>, kind: u32,
    color: vec3<f32>, extent: f32,
    front: f32, back: f32, displacement: vec2<f32>,
}

// A level and the next coarser one: their sizes, the first cells, and the side of a finer cell.
struct Step {
    fine: vec2<u32>, coarse: vec2<u32>,
    fine_at: u32, coarse_at: u32, side: f32, spare: u32,
}

struct Point {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) normal_and_depth: vec4<f32>,
    @location(1) @interpolate(flat) color_and_extent: vec4<f32>,
    @location(2) @interpolate(flat) center_and_radius: vec4<f32>,
    @location(3) @interpolate(flat) id: u32,
}

@vertex
fn point(@builtin(vertex_index) i: u32) -> Point {
    let s = surfels[i];
    let p = turned(s.position) + vec3(view.rows[0].w, view.rows[1].w, view.rows[2].w);
    let n = turned(s.normal);
    let t = -p.z;
    let m = select(1.0, 1.0 / t, perspective());
    let at = p.xy * m;
    let center = view.center + view.focal * at * vec2(1.0, -1.0);
    let g = select(-n.z, dot(n.xy, at) - n.z, perspective());
    var out = Point();
    out.position = vec4(2.0, 2.0, 0.0, 1.0); // out of sight
    if t > view.near && !(view.cull != 0u && g >= 0.0) && all(center >= vec2(0.0)) && all(center < view.size) {
        let pixel = floor(center) + 0.5;
        let tested = t * view.far_scale;
        out.position = vec4((pixel / view.size * 2.0 - 1.0) * vec2(1.0, -1.0), tested, 1.0);
    }
    let focal = sqrt(view.focal.x * view.focal.y);
    let extent = min(s.radius * (focal * m), 281474976710656.0);
    out.normal_and_depth = vec4(select(n, -n, g > 0.0), t);
    out.color_and_extent = vec4(s.color, extent);
    out.center_and_radius = vec4(center, s.radius, 0.0);
    out.id = s.index;
    return out;
}

struct Sample {
    @location(0) id: u32,
    @location(1) normal_and_depth: vec4<f32>,
    @location(2) color_and_extent: vec4<f32>,
    @location(3) center_and_radius: vec4<f32>,
    @builtin(frag_depth) tested: f32,
}

@fragment
fn projection(p: Point) -> Sample {
    let tested = p.normal_and_depth.w * view.far_scale;
    return Sample(p.id, p.normal_and_depth, p.color_and_extent, p.center_and_radius, tested);
}

fn empty() -> Cell {
    return Cell(vec3(0.0), 0u, vec3(0.0), 0.0, view.infinity, -view.infinity, vec2(0.0));
}

@compute @workgroup_size(8, 8)
fn finest(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= step.fine) {
        return;
    }
    var cell = empty();
    if textureLoad(ids, id.xy, 0).x != NONE {
        let normal = textureLoad(normals, id.xy, 0);
        let color = textureLoad(colors, id.xy, 0);
        let radius = textureLoad(centers, id.xy, 0).z;
        cell = Cell(normal.xyz, 1u, color.xyz, color.w, normal.w, normal.w + radius, vec2(0.0));
    }
    pulled[id.y * step.fine.x + id.x] = cell;
}

fn form(cell: Cell, v: vec2<f32>) -> f32 {
    let tilt = cell.normal.xy / cell.normal.z;
    let e = tilt.x * v.x - tilt.y * v.y;
    return (v.x * v.x + v.y * v.y) + e * e;
}

fn holds(cell: Cell, v: vec2<f32>) -> bool {
    let square = cell.extent * cell.extent;
    return cell.kind != 0u && square > 0.0 && form(cell, v) <= square;
}

struct Four {
    cells: array<Cell, 4>,
    v: array<vec2<f32>, 4>, // from the new cell's centre to their ellipses' centres
}

// Which of four cells are averaged: the foremost that holds the centre, and those it overlaps.
fn taken(four: ptr<function, Four>) -> vec4<bool> {
    var held = vec4<bool>();
    var nearest = view.infinity;
    var end = -view.infinity;
    for (var j = 0; j < 4; j++) {
        held[j] = holds((*four).cells[j], (*four).v[j]);
        if held[j] && (*four).cells[j].front < nearest {
            nearest = (*four).cells[j].front;
            end = (*four).cells[j].back;
        }
    }
    for (var j = 0; j < 4; j++) {
        held[j] = held[j] && (*four).cells[j].front <= end;
    }
    return held;
}

fn least(a: vec4<f32>, takes: vec4<bool>) -> f32 {
    let b = select(vec4(view.infinity), a, takes);
    return min(min(b.x, b.y), min(b.z, b.w));
}

fn average(a: vec4<f32>, w: vec4<f32>, takes: vec4<bool>) -> f32 {
    let term = w * select(vec4(0.0), a, takes);
    let mean = ((term.x + term.y) + (term.z + term.w)) * (1.0 / ((w.x + w.y) + (w.z + w.w)));
    return clamp(mean, least(a, takes), -least(-a, takes));
}

fn merged(four: ptr<function, Four>, w: vec4<f32>, takes: vec4<bool>) -> Cell {
    var a: array<array<f32, 4>, 11>;
    for (var j = 0; j < 4; j++) {
        let c = (*four).cells[j];
        let v = (*four).v[j];
        let numbers = array<f32, 11>(c.normal.x, c.normal.y, c.normal.z, c.color.x, c.color.y, c.color.z,
            c.extent, c.front, c.back, v.x, v.y);
        for (var i = 0; i < 11; i++) {
            a[i][j] = numbers[i];
        }
    }
    var m: array<f32, 11>;
    for (var i = 0; i < 11; i++) {
        m[i] = average(vec4(a[i][0], a[i][1], a[i][2], a[i][3]), w, takes);
    }
    return Cell(vec3(m[0], m[1], m[2]), 1u, vec3(m[3], m[4], m[5]), m[6], m[7], m[8], vec2(m[9], m[10]));
}

@compute @workgroup_size(8, 8)
fn pull(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= step.coarse) {
        return;
    }
    var four = Four();
    for (var j = 0u; j < 4u; j++) {
        let corner = vec2(j % 2u, j / 2u);
        let at = 2u * id.xy + corner;
        four.cells[j] = empty();
        if all(at < step.fine) {
            four.cells[j] = pulled[step.fine_at + at.y * step.fine.x + at.x];
        }
        four.v[j] = four.cells[j].displacement + select(vec2(-0.5), vec2(0.5), corner == vec2(1u)) * step.side;
    }
    let takes = taken(&four);
    var cell = empty();
    if any(takes) {
        cell = merged(&four, select(vec4(0.0), vec4(1.0), takes), takes);
        let fronts = vec4(four.cells[0].front, four.cells[1].front, four.cells[2].front, four.cells[3].front);
        let backs = vec4(four.cells[0].back, four.cells[1].back, four.cells[2].back, four.cells[3].back);
        cell.front = least(fronts, takes);
        cell.back = -least(-backs, takes);
    }
    pulled[step.coarse_at + id.y * step.coarse.x + id.x] = cell;
}

@compute @workgroup_size(8, 8)
fn push(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= step.fine) {
        return;
    }
    let here = step.fine_at + id.y * step.fine.x + id.x;
    var cell = pulled[here];
    let parent = id.xy / 2u;
    let above = pushed[step.coarse_at + parent.y * step.coarse.x + parent.x];
    let occluded = above.kind != 0u && cell.front > above.back && bug != NEVER_OCCLUDED;
    if cell.kind == 0u || occluded {
        var four = Four();
        let odd = id.xy % 2u == vec2(1u);
        let beside = vec2<i32>(parent) + select(vec2(-1), vec2(1), odd);
        for (var j = 0u; j < 4u; j++) {
            let neighbour = vec2(j % 2u, j / 2u) == vec2(1u);
            let at = select(vec2<i32>(parent), beside, neighbour);
            four.cells[j] = empty();
            if all(at >= vec2(0)) && all(at < vec2<i32>(step.coarse)) {
                four.cells[j] = pushed[step.coarse_at + u32(at.y) * step.coarse.x + u32(at.x)];
            }
            let side = select(step.side, 2.0 * step.side, bug == LEVEL_OFF);
            let far = side * select(vec2(0.5), vec2(1.5), neighbour);
            four.v[j] = four.cells[j].displacement + select(far, -far, neighbour != odd);
        }
        let takes = taken(&four);
        if any(takes) {
            var w = vec4(0.0);
            for (var j = 0; j < 4; j++) {
                if takes[j] {
                    let c = four.cells[j];
                    let falloff = exp(-2.0 * (form(c, four.v[j]) / (c.extent * c.extent)));
                    w[j] = select(falloff, 1.0, bug == EQUAL_WEIGHTS);
                }
            }
            cell = merged(&four, w, takes);
        }
    }
    pushed[here] = cell;
}
