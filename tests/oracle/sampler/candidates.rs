//! The oracle's own candidates: one triangle after the other, every pixel of its box asked.

use glam::{DVec3, Vec3};
use splatref::scene::{Scene, Similarity, Triangles, Vertices};

/// A triangle in its place.
#[derive(Clone)]
pub(crate) struct Triangle {
    position: [Vec3; 3],
    direction: [Vec3; 3],
    color: Option<[Vec3; 3]>,
    /// Of each further number of the vertices those of its corners, the opacity first, if there is one.
    pub(crate) numbers: Vec<[f32; 3]>,
}

/// What the candidates are, as bits.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Seen {
    pub(crate) position: Vec<[u32; 3]>,
    pub(crate) normal: Vec<[u32; 3]>,
    pub(crate) color: Option<Vec<[u32; 3]>>,
    /// Of each candidate.
    pub(crate) numbers: Vec<Vec<u32>>,
    pub(crate) counts: Vec<u32>,
    pub(crate) pixel: u64,
    pub(crate) dropped: u64,
}

pub(crate) fn bits(v: &Vec3) -> [u32; 3] {
    v.to_array().map(f32::to_bits)
}

/// The triangles of a scene, or those of its objects in the order of the objects.
pub(crate) fn triangles(scene: &Scene) -> Vec<Triangle> {
    let Some(objects) = &scene.objects else {
        let list = &scene.primitives.triangles;
        return parts(list, None, None, list.vertices().opacity.is_some());
    };
    let all = objects.objects();
    let colored = all.iter().any(|o| {
        let vertices = objects.geometries()[o.geometry].primitives.triangles.vertices();
        o.color.is_some() || vertices.color.is_some()
    });
    let veiled = all.iter().any(|o| {
        let list = &objects.geometries()[o.geometry].primitives.triangles;
        list.vertices().opacity.is_some()
    });
    let each = all.iter().zip(objects.places()).flat_map(|(o, place)| {
        let list = &objects.geometries()[o.geometry].primitives.triangles;
        let fill = if list.vertices().color.is_none() { Some(objects.fill()) } else { None };
        parts(list, Some(place), o.color.or(fill).filter(|_| colored), veiled)
    });
    each.collect()
}

fn parts(
    list: &Triangles,
    place: Option<&Similarity>,
    color: Option<Vec3>,
    veiled: bool,
) -> Vec<Triangle> {
    let Vertices { position, direction, color: own, opacity, properties, .. } = list.vertices();
    let numbers = |corners: &[u32; 3]| {
        let at = |all: &Vec<f32>| corners.map(|i| all[i as usize]);
        let first = veiled.then(|| opacity.as_ref().map_or([1.0; 3], at));
        first.into_iter().chain(properties.iter().map(|one| at(&one.values))).collect()
    };
    let point = |i: u32| place.map_or(position[i as usize], |s| s.point(position[i as usize]));
    let turn = |i: u32| place.map_or(direction[i as usize], |s| s.turned(direction[i as usize]));
    let each = list.corners().iter().map(|corners| Triangle {
        position: corners.map(point),
        direction: corners.map(turn),
        color: match (color, own) {
            (Some(one), _) => Some([one; 3]),
            (None, Some(own)) => Some(corners.map(|i| own[i as usize])),
            (None, None) => None,
        },
        numbers: numbers(corners),
    });
    each.collect()
}

/// The formulas of `Similarity`, each in f64 and rounded once.
trait Placed {
    fn point(&self, p: Vec3) -> Vec3;
    fn turned(&self, n: Vec3) -> Vec3;
}

impl Placed for Similarity {
    fn point(&self, p: Vec3) -> Vec3 {
        let [x, y, z] = p.to_array().map(|c| f64::from(c) * self.scale);
        let component = |i: usize| {
            let m = self.rotation.row(i);
            (((m.x * x + m.y * y) + m.z * z) + self.translation[i]) as f32
        };
        Vec3::from_array([0, 1, 2].map(component))
    }

    fn turned(&self, n: Vec3) -> Vec3 {
        let [x, y, z] = n.to_array().map(f64::from);
        let component = |i: usize| {
            let m = self.rotation.row(i);
            ((m.x * x + m.y * y) + m.z * z) as f32
        };
        Vec3::from_array([0, 1, 2].map(component))
    }
}

type V = [f64; 3];

fn each(of: impl Fn(usize) -> f64) -> V {
    [0, 1, 2].map(of)
}

fn length(a: V) -> f64 {
    ((a[0] * a[0] + a[1] * a[1]) + a[2] * a[2]).sqrt()
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

fn unit(a: V) -> V {
    let quotient = 1.0 / length(a);
    a.map(|c| c * quotient)
}

/// The corners of the box around the triangles' vertices.
fn corners(triangles: &[Triangle]) -> [V; 2] {
    let all = || triangles.iter().flat_map(|t| t.position);
    let bound = |start: f64, of: fn(f64, f64) -> f64| {
        each(|i| all().map(|p| f64::from(p[i])).fold(start, of))
    };
    [bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max)]
}

/// Half the extents of the box.
pub(crate) fn half_extents(triangles: &[Triangle]) -> DVec3 {
    let [low, high] = corners(triangles);
    each(|i| (high[i] - low[i]) / 2.0).into()
}

/// An orthographic camera around a box.
struct View {
    rows: [[f32; 4]; 3],
    scale: f32,
    middle: f32,
}

impl View {
    /// The camera, and R.
    fn new(side: u32, [low, high]: [V; 2], from: V) -> (Self, f64) {
        let center = each(|i| (low[i] + high[i]) / 2.0);
        let half = length(each(|i| high[i] - low[i])) / 2.0;
        let radius = if half == 0.0 { 1.0 } else { half };
        let distance = 2.0 * (radius * 1.05);
        let towards = unit(from);
        let eye = each(|i| center[i] + towards[i] * distance);
        let upright = !(from[0] == 0.0 && from[2] == 0.0);
        let up = if upright { [0.0, 1.0, 0.0] } else { [-0.0, -0.0, -1.0] };

        let distance = length(each(|i| center[i] - eye[i]));
        let back = each(|i| (eye[i] - center[i]) / distance);
        let right = unit(cross(up, back));
        let up = cross(back, right);
        let row = |a: V| {
            let last = (a[0] * -eye[0] + a[1] * -eye[1]) + a[2] * -eye[2];
            [a[0], a[1], a[2], last].map(|c| (c + 0.0) as f32)
        };
        let side = f64::from(side);
        let scale = (side / (2.0 * radius)) as f32;
        let view =
            Self { rows: [row(right), row(up), row(back)], scale, middle: (side / 2.0) as f32 };
        (view, radius)
    }

    fn place(&self, p: Vec3) -> [f32; 3] {
        self.rows.map(|m| ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3])
    }

    fn fixed(&self, place: [f32; 3]) -> [i64; 2] {
        let snap = |x: f32| {
            let s = x.clamp(-131_072.0, 131_072.0) * 256.0;
            let floor = s.floor();
            floor as i64 + i64::from(s - floor >= 0.5)
        };
        [snap(self.middle + self.scale * place[0]), snap(self.middle - self.scale * place[1])]
    }

    /// The normal in view space of the interpolated direction.
    fn normal(&self, n: Vec3, front: bool) -> [f32; 3] {
        let turned = self.rows.map(|m| (m[0] * n.x + m[1] * n.y) + m[2] * n.z);
        let length =
            ((turned[0] * turned[0] + turned[1] * turned[1]) + turned[2] * turned[2]).sqrt();
        if length == 0.0 {
            return [0.0; 3];
        }
        turned.map(|c| if front { c / length } else { -(c / length) })
    }

    /// Back to world space.
    fn world(&self, m: [f32; 3]) -> Vec3 {
        let v = |i: usize, j: usize| f64::from(self.rows[i][j]);
        let m = m.map(f64::from);
        let component = |j| ((v(0, j) * m[0] + v(1, j) * m[1]) + v(2, j) * m[2]) + 0.0;
        Vec3::from_array(each(component).map(|c| c as f32))
    }
}

/// The weight of the corner that an edge lies opposite to, at a point in halves of a unit, and
/// whether the point is inside of that edge.
fn weight(q: [i64; 2], r: [i64; 2], sense: i64, [x, y]: [i64; 2]) -> (i64, bool) {
    let (dx, dy) = (r[0] - q[0], r[1] - q[1]);
    let w = sense * (dx * (y - 2 * q[1]) - dy * (x - 2 * q[0]));
    let grows = if dy == 0 { sense * dx > 0 } else { -sense * dy > 0 };
    (w, w > 0 || w == 0 && grows)
}

/// The covered pixels of a picture: column, row, and the exact weights of the corners.
fn covered(fixed: [[i64; 2]; 3], side: u32) -> Vec<([u32; 2], [i64; 3])> {
    let [a, b, c] = fixed;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let sense = area.signum();
    let mut found = Vec::new();
    if sense == 0 {
        return found;
    }
    let range = |axis: usize| {
        let all = fixed.map(|f| f[axis].div_euclid(256));
        let low = all.into_iter().min().unwrap_or(0).max(0);
        low..=all.into_iter().max().unwrap_or(0).min(i64::from(side) - 1)
    };
    for y in range(1) {
        for x in range(0) {
            let p = [(2 * x + 1) * 256, (2 * y + 1) * 256];
            let w = [(b, c), (c, a), (a, b)].map(|(q, r)| weight(q, r, sense, p));
            if w.iter().all(|(_, inside)| *inside) {
                found.push(([x as u32, y as u32], w.map(|(w, _)| w)));
            }
        }
    }
    found
}

/// Any attribute where the corners have these weights.
fn mixed(c: [f32; 3], a: [Vec3; 3]) -> Vec3 {
    let component = |i: usize| (c[0] * a[0][i] + c[1] * a[1][i]) + c[2] * a[2][i];
    Vec3::from_array([0, 1, 2].map(component))
}

/// What a pixel keeps: depth, triangle, weights, normal in view space.
type Kept = (f32, usize, [f32; 3], [f32; 3]);

fn picture(triangles: &[Triangle], view: &View, side: u32) -> Vec<Option<Kept>> {
    let mut pixels: Vec<Option<Kept>> = vec![None; (side * side) as usize];
    for (id, triangle) in triangles.iter().enumerate() {
        let places = triangle.position.map(|p| view.place(p));
        let fixed = places.map(|p| view.fixed(p));
        // With Y down corners run counter-clockwise, as one sees them, where this is negative.
        let [a, b, c] = fixed;
        let front = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0;
        for ([x, y], w) in covered(fixed, side) {
            let area = (w[0] + w[1] + w[2]) as f32;
            let q = w.map(|w| w as f32 / area);
            let sum = (q[0] + q[1]) + q[2];
            let c = q.map(|q| q / sum);
            let z = places.map(|p| p[2]);
            let t = -((c[0] * z[0] + c[1] * z[1]) + c[2] * z[2]);
            let pixel = &mut pixels[(y * side + x) as usize];
            if pixel.is_none_or(|kept| t < kept.0) {
                let normal = view.normal(mixed(c, triangle.direction), front);
                *pixel = Some((t, id, c, normal));
            }
        }
    }
    pixels
}

/// The candidates of triangles, seen from these directions.
pub(crate) fn candidates(triangles: &[Triangle], directions: &[DVec3], side: u32) -> Seen {
    let around = corners(triangles);
    let colored = triangles.iter().any(|t| t.color.is_some());
    let mut seen = Seen { color: colored.then(Vec::new), ..Seen::default() };
    for direction in directions {
        let (view, radius) = View::new(side, around, direction.to_array());
        seen.pixel = (2.0 * radius / f64::from(side)).to_bits();
        let before = seen.position.len();
        for (_, id, c, normal) in picture(triangles, &view, side).into_iter().flatten() {
            if normal == [0.0; 3] {
                seen.dropped += 1;
                continue;
            }
            let triangle = &triangles[id];
            seen.position.push(bits(&(mixed(c, triangle.position) + Vec3::ZERO)));
            seen.normal.push(bits(&view.world(normal)));
            // Only an opacity of these cases can come close to 1.
            let number = |a: &[f32; 3]| {
                (((c[0] * a[0] + c[1] * a[1]) + c[2] * a[2]) + 0.0).min(1.0).to_bits()
            };
            seen.numbers.push(triangle.numbers.iter().map(number).collect());
            if let (Some(all), Some(color)) = (&mut seen.color, triangle.color) {
                all.push(bits(&mixed(c, color)));
            }
        }
        seen.counts.push((seen.position.len() - before) as u32);
    }
    seen
}
