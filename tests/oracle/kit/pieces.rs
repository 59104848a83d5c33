//! The pixels of triangles and segments by other means: exact integers, pixel by pixel.
//!
//! A pixel centre is inside a triangle if, moved to the right by an infinitesimal and down by a
//! much smaller one, it is on the same side of all edges. Where snapping may go either way, each
//! outcome is a piece of its own.

use crate::oracle::kit::number::{N3, Num};
use crate::oracle::kit::projection::Sight;

/// A corner after clipping: where it is, and how much of each original corner is in it.
#[derive(Clone, Copy)]
struct Vertex<const P: u32, const N: usize> {
    p: N3<P>,
    shares: [Num<P>; N],
}

/// A triangle or a segment of the screen, snapped.
#[derive(Clone)]
pub(crate) struct Piece<const P: u32, const N: usize> {
    corners: [[i64; 2]; N],
    bits: u32,
    m: [Num<P>; N],
    shares: [[Num<P>; N]; N],
}

/// A pixel, and `w_i` / w there.
type Covered<const P: u32> = (i64, i64, Vec<Num<P>>);

/// Too much depends on rounding.
pub(crate) struct Loose;

/// The pieces of a primitive, of each all outcomes of snapping.
pub(crate) fn pieces<const P: u32, const N: usize>(
    sight: &Sight<P>,
    corners: &[N3<P>; N],
    bits: u32,
) -> Result<Vec<Vec<Piece<P, N>>>, Loose> {
    let kept = clip(sight, corners)?;
    let fans: Vec<[usize; N]> = if N == 2 {
        if kept.len() == 2 { vec![std::array::from_fn(|i| i)] } else { Vec::new() }
    } else {
        let fan = |i: usize| std::array::from_fn(|k| if k == 0 { 0 } else { i + k });
        (0..kept.len().saturating_sub(2)).map(fan).collect()
    };
    fans.into_iter().map(|fan| outcomes(sight, fan.map(|i| kept[i]), bits)).collect()
}

/// What is left before the near plane and within the guard band.
fn clip<const P: u32, const N: usize>(
    sight: &Sight<P>,
    corners: &[N3<P>; N],
) -> Result<Vec<Vertex<P, N>>, Loose> {
    let guard = Num::exact(131_072.0);
    let one = Num::exact(1.0);
    let unclipped = |i: usize| Vertex {
        p: corners[i],
        shares: std::array::from_fn(|k| Num::exact(f64::from(u8::from(i == k)))),
    };
    let mut kept: Vec<_> = (0..N).map(unclipped).collect();
    if kept.iter().any(|v| v.p.iter().any(|x| !x.v.is_finite())) {
        return Ok(Vec::new());
    }
    // Of each plane the coordinate that it bounds, its scale, and what is added, times s or not.
    let sides = [
        (2, -one, -sight.near, false),
        (0, sight.fx, guard + sight.cx, true),
        (0, -sight.fx, guard - sight.cx, true),
        (1, -sight.fy, guard + sight.cy, true),
        (1, sight.fy, guard - sight.cy, true),
    ];
    for (axis, scale, past, depth) in sides {
        let room = |p: &N3<P>| if depth && sight.perspective { past * -p[2] } else { past };
        let distance = |p: &N3<P>| scale * p[axis] + room(p);
        let onto = |p: &mut N3<P>| {
            p[2] = -((-p[2]).at_least(sight.near.v));
            p[axis] = -(room(p) / scale);
        };
        kept = cut(&kept, &distance, &onto)?;
    }
    Ok(kept)
}

/// The part of an outline on the inner side of one plane.
fn cut<const P: u32, const N: usize>(
    outline: &[Vertex<P, N>],
    distance: &dyn Fn(&N3<P>) -> Num<P>,
    onto: &dyn Fn(&mut N3<P>),
) -> Result<Vec<Vertex<P, N>>, Loose> {
    let mut kept = Vec::new();
    let sides: Option<Vec<bool>> =
        outline.iter().map(|v| Num::ZERO.at_most_as(distance(&v.p))).collect();
    let sides = sides.ok_or(Loose)?;
    for (i, v) in outline.iter().enumerate() {
        // The edge that ends here, then its end; a segment has one edge, not two.
        let last = (i + outline.len() - 1) % outline.len();
        if sides[i] != sides[last] && (N == 3 || i == 1) {
            let (a, b) = if sides[i] { (v, &outline[last]) } else { (&outline[last], v) };
            let (d, e) = (distance(&a.p), distance(&b.p));
            let (f, g) = (-e / (d - e), d / (d - e));
            let mix = |x: Num<P>, y: Num<P>| x * f + y * g;
            let mut p = [0, 1, 2].map(|k| mix(a.p[k], b.p[k]));
            onto(&mut p);
            kept.push(Vertex { p, shares: std::array::from_fn(|k| mix(a.shares[k], b.shares[k])) });
        }
        if sides[i] {
            kept.push(*v);
        }
    }
    Ok(kept)
}

/// The nearest positions of the grid, of two the greater.
fn snapped<const P: u32>(x: Num<P>, bits: u32) -> Result<Vec<i64>, Loose> {
    let scale = f64::from(1_u32 << bits);
    let (s, e) = (x.v.clamp(-131_072.0, 131_072.0) * scale, x.e * scale);
    if !(e < 0.25) {
        return Err(Loose);
    }
    let round = |s: f64| if s - s.floor() >= 0.5 { s.floor() as i64 + 1 } else { s.floor() as i64 };
    let mut all = vec![round(s)];
    if e > 0.0 {
        all.extend([round(s - e), round(s + e)]);
    }
    all.sort_unstable();
    all.dedup();
    Ok(all)
}

fn outcomes<const P: u32, const N: usize>(
    sight: &Sight<P>,
    vertices: [Vertex<P, N>; N],
    bits: u32,
) -> Result<Vec<Piece<P, N>>, Loose> {
    let mut all = vec![Piece {
        corners: [[0; 2]; N],
        bits,
        m: vertices.map(|v| sight.place(v.p).m),
        shares: vertices.map(|v| v.shares),
    }];
    for (i, vertex) in vertices.iter().enumerate() {
        let at = sight.place(vertex.p).at;
        for (axis, at) in at.into_iter().enumerate() {
            let mut more = Vec::new();
            for value in snapped(at, bits)? {
                more.extend(all.iter().cloned().map(|mut piece| {
                    piece.corners[i][axis] = value;
                    piece
                }));
            }
            all = more;
        }
    }
    if all.len() > 16 { Err(Loose) } else { Ok(all) }
}

fn cross(a: [i128; 2], b: [i128; 2]) -> i128 {
    a[0] * b[1] - a[1] * b[0]
}

impl<const P: u32, const N: usize> Piece<P, N> {
    /// Counter-clockwise with Y up.
    pub(crate) fn front(&self) -> bool {
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[i.min(N - 1)].map(i128::from));
        cross([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]) < 0
    }

    /// `c_k`, from `w_i` / w.
    pub(crate) fn shares(&self, weights: &[Num<P>]) -> [Num<P>; N] {
        let q: [Num<P>; N] = std::array::from_fn(|i| weights[i] * self.m[i]);
        let total = if N == 3 { (q[0] + q[1]) + q[2] } else { q[0] + q[1] };
        let b = q.map(|q| q / total);
        std::array::from_fn(|k| {
            let two = b[0] * self.shares[0][k] + b[1] * self.shares[1][k];
            if N == 3 { two + b[2] * self.shares[2][k] } else { two }
        })
    }

    /// The pixels of the picture, and the share of each corner there; a line may visit one twice.
    pub(crate) fn covered(&self, size: [u32; 2]) -> Vec<Covered<P>> {
        if N == 2 { self.line(size) } else { self.inside(size) }
    }

    /// Every pixel of the box around the triangle against its three edges.
    fn inside(&self, [width, height]: [u32; 2]) -> Vec<Covered<P>> {
        let mut covered = Vec::new();
        let range = |axis: usize, size: u32| {
            let ends = self.corners.map(|c| c[axis] >> self.bits);
            let [low, high] = [ends.iter().min(), ends.iter().max()].map(|v| *v.expect("corners"));
            (low - 1).max(0)..(high + 2).min(i64::from(size))
        };
        for y in range(1, height) {
            for x in range(0, width) {
                if let Some(weights) = self.weights(x, y) {
                    covered.push((x, y, weights));
                }
            }
        }
        covered
    }

    /// The areas opposite to the corners out of the whole, if the pixel is covered.
    fn weights(&self, x: i64, y: i64) -> Option<Vec<Num<P>>> {
        // In halves of a unit of the grid.
        let center = [x, y].map(|v| (2 * i128::from(v) + 1) << self.bits);
        let corner = |i: usize| self.corners[i % N].map(|v| 2 * i128::from(v));
        let (mut areas, mut signs) = (Vec::new(), Vec::new());
        for i in 0..3 {
            let (q, r) = (corner(i + 1), corner(i + 2));
            let side = [r[0] - q[0], r[1] - q[1]];
            let area = cross(side, [center[0] - q[0], center[1] - q[1]]);
            // The change of the area when the centre moves to the right, then down.
            let sign = [area, -side[1], side[0]].into_iter().find(|v| *v != 0)?;
            areas.push(area.abs());
            signs.push(sign > 0);
        }
        if signs.iter().any(|sign| *sign != signs[0]) {
            return None;
        }
        let total: i128 = areas.iter().sum();
        // An infinitesimal triangle: of no area, and between infinitesimally different lines.
        (total > 0)
            .then(|| areas.iter().map(|area| Num::integer(*area) / Num::integer(total)).collect())
    }

    /// The pixels of a segment in its order, and the parameter as two shares.
    fn line(&self, size: [u32; 2]) -> Vec<Covered<P>> {
        let [a, b] = [self.corners[0], self.corners[1]].map(|c| c.map(i128::from));
        let one = 1_i128 << self.bits;
        let delta = [b[0] - a[0], b[1] - a[1]];
        let pixel = |p: [i128; 2]| p.map(|v| v.div_euclid(one));
        let mut visited = vec![(pixel(a), 0, 1)];
        let major = usize::from(delta[1].abs() > delta[0].abs());
        let length = delta[major].abs();
        let (low, high) = (a[major].min(b[major]), a[major].max(b[major]));
        let mut between = Vec::new();
        for i in 0..i128::from(size[major]) {
            // Twice the coordinate of the centre.
            let center = (2 * i + 1) * one;
            if !(2 * low < center && center < 2 * high) {
                continue;
            }
            let along = (center - 2 * a[major]).abs();
            // The other coordinate, out of 2 length.
            let other = a[1 - major] * 2 * length + delta[1 - major] * along;
            let mut at = [i; 2];
            at[1 - major] = other.div_euclid(2 * length * one);
            between.push((at, along, 2 * length));
        }
        if delta[major] < 0 {
            between.reverse();
        }
        visited.extend(between);
        if length > 0 {
            visited.push((pixel(b), 1, 1));
        }
        let share = |part: i128, whole: i128| Num::integer(part) / Num::integer(whole);
        let inside = visited
            .into_iter()
            .filter(|(p, ..)| (0..2).all(|axis| (0..i128::from(size[axis])).contains(&p[axis])));
        inside
            .map(|([x, y], part, whole)| {
                (x as i64, y as i64, vec![share(whole - part, whole), share(part, whole)])
            })
            .collect()
    }
}
