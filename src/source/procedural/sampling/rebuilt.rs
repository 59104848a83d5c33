//! Rebuild the surfels of every shape from the page alone.

use crate::number::elementary::{cos, sin};
use crate::number::random::{GOLDEN, bits, unit};
use crate::source::Shape;
use std::f64::consts::{PI, TAU};

type V = [f64; 3];

const PALETTE: [V; 8] = [
    [0.875, 0.25, 0.0625],
    [0.0625, 0.25, 0.75],
    [0.875, 0.625, 0.0625],
    [0.125, 0.5, 0.25],
    [0.625, 0.0625, 0.375],
    [0.125, 0.625, 0.75],
    [0.75, 0.75, 0.6875],
    [0.375, 0.1875, 0.625],
];

/// Low, high, z, normal, colour.
type Plate = ([f64; 2], [f64; 2], f64, V, V);

/// Surfels made by the page: position, normal, radius, colour.
struct Page {
    seed: u64,
    made: Vec<(V, V, f64, V)>,
}

fn round(x: f64) -> f64 {
    (x + 0.5).floor()
}

fn at_least_1(x: f64) -> f64 {
    if x < 1.0 { 1.0 } else { x }
}

fn cell(a: f64, b: f64) -> f64 {
    ((a * a + b * b) / 2.0).sqrt()
}

fn pattern(p: V) -> V {
    let wave = |x: f64| 0.5 + 0.375 * sin(x);
    [wave(9.0 * p[0]), wave(11.0 * p[1] + 1.0), wave(7.0 * p[2] + 2.0)]
}

impl Page {
    /// e(s) and f(s) of the next surfel.
    fn offsets(&self) -> [f64; 2] {
        let s = 2 * self.made.len() as u64;
        [s, s + 1].map(|i| 0.5 + (f64::from(unit(self.seed, i)) - 0.5) / 4.0)
    }

    fn balls(&mut self, balls: &[(V, f64, Option<V>)], count: f64) {
        let (mut all, mut before, mut first) = (0.0, 0.0, 0.0);
        balls.iter().for_each(|(_, r, _)| all += r * r);
        for &(c, r, color) in balls {
            before += r * r;
            let end = round(count * (before / all));
            let n = if end > first { end - first } else { 1.0 };
            first += n;
            for i in 0..n as u64 {
                let y = 1.0 - (2 * i + 1) as f64 / n;
                let ring = (1.0 - y * y).sqrt();
                let turn = bits(self.seed, 0).wrapping_add(i.wrapping_mul(GOLDEN));
                let angle = (turn / 2048) as f64 * (TAU / 9_007_199_254_740_992.0);
                let normal = [ring * cos(angle), y, ring * sin(angle)];
                let p = [0, 1, 2].map(|k| c[k] + normal[k] * r);
                let radius = r * (4.0 * PI / n).sqrt();
                self.made.push((p, normal, radius, color.unwrap_or_else(|| pattern(p))));
            }
        }
    }

    fn cluster(&mut self, count: f64) {
        let v = |i: usize| f64::from(unit(6, i as u64));
        let ball = |k: usize| {
            let c = [0, 1, 2].map(|j| v(4 * k + j) * 2.0 - 1.0);
            (c, 0.125 + 0.25 * v(4 * k + 3), Some(PALETTE[k % 8]))
        };
        self.balls(&(0..32).map(ball).collect::<Vec<_>>(), count);
    }

    fn torus(&mut self, count: f64) {
        let spacing = (TAU * TAU * 0.375 / count).sqrt();
        let rows = at_least_1(round(TAU * 0.375 / spacing));
        let h = TAU / rows;
        let mut first = 0.0;
        for row in 0..rows as u64 {
            let edge = (row + 1) as f64 * h;
            let end = round(count * ((edge + 0.375 * sin(edge)) / TAU));
            let n = end - first;
            first = end;
            let around = TAU * (1.0 + 0.375 * cos(edge - h / 2.0));
            for i in 0..n as u64 {
                let [e, f] = self.offsets();
                let (a, b) = ((i as f64 + e) * (TAU / n), (row as f64 + f) * h);
                let out = 1.0 + 0.375 * cos(b);
                let normal = [cos(b) * cos(a), sin(b), cos(b) * sin(a)];
                let p = [out * cos(a), 0.375 * sin(b), out * sin(a)];
                self.made.push((p, normal, cell(0.375 * h, around / n), pattern(p)));
            }
        }
    }

    fn checkerboard(&mut self, square: f64, count: f64) {
        let half = at_least_1(round((count / 8.5).sqrt() / 2.0));
        for ring in 0..=10 {
            let side = 4.0 * f64::from(1_u32 << ring) / half;
            let hole = |i: u64| 2 * i >= half as u64 && 2 * i + 2 <= 3 * half as u64;
            for (row, column) in
                (0..2 * half as u64).flat_map(|r| (0..2 * half as u64).map(move |c| (r, c)))
            {
                if ring > 0 && hole(row) && hole(column) {
                    continue;
                }
                let [e, f] = self.offsets();
                let place = |i: u64, offset: f64| ((i as f64 - half) + offset) * side;
                let p = [place(column, e), 0.0, place(row, f)];
                let index = |k: usize| (f64::from(p[k] as f32) / square).floor();
                let even = (index(0) + index(2)).rem_euclid(2.0) == 0.0;
                let color = if even { [0.875, 0.84375, 0.75] } else { [0.0625, 0.09375, 0.1875] };
                self.made.push((p, [0.0, 1.0, 0.0], cell(side, side), color));
            }
        }
    }

    fn plates(&mut self, plates: &[Plate], count: f64) {
        let size = |low: [f64; 2], high: [f64; 2]| [high[0] - low[0], high[1] - low[1]];
        let mut area = 0.0;
        for &(low, high, ..) in plates {
            let [width, height] = size(low, high);
            area += width * height;
        }
        let spacing = (area / count).sqrt();
        for &(low, high, z, normal, color) in plates {
            let [width, height] = size(low, high);
            let [columns, rows] = [width, height].map(|side| at_least_1(round(side / spacing)));
            let (dx, dy) = (width / columns, height / rows);
            for row in 0..rows as u64 {
                for column in 0..columns as u64 {
                    let [e, f] = self.offsets();
                    let p = [low[0] + (column as f64 + e) * dx, low[1] + (row as f64 + f) * dy, z];
                    self.made.push((p, normal, cell(dx, dy), color));
                }
            }
        }
    }

    fn shape(&mut self, shape: Shape, count: f64) {
        let up = [0.0, 0.0, 1.0];
        match shape {
            Shape::Sphere => self.balls(&[([0.0; 3], 1.0, None)], count),
            Shape::Torus => self.torus(count),
            Shape::Checkerboard { square } => self.checkerboard(square.into(), count),
            Shape::Sheets { gap } => {
                let front = ([-1.0; 2], [1.0; 2], 0.0, up, PALETTE[0]);
                self.plates(
                    &[front, ([-1.5; 2], [1.5; 2], -f64::from(gap), up, PALETTE[1])],
                    count,
                );
            }
            Shape::Staircase { step, thickness } => {
                let plate = |k: usize| {
                    let low = k as f64 / 4.0 - 1.125;
                    let (low, high) = ([-1.0, low], [1.0, low + 0.5]);
                    let z = -(k as f64) * f64::from(step);
                    let back = PALETTE[k].map(|c| 1.0 - c);
                    let deep = z - f64::from(thickness);
                    [(low, high, z, up, PALETTE[k]), (low, high, deep, [-0.0, -0.0, -1.0], back)]
                };
                self.plates(&(0..8).flat_map(plate).collect::<Vec<_>>(), count);
            }
            Shape::Cluster => self.cluster(count),
        }
    }
}

#[test]
fn every_shape_is_what_the_page_makes() {
    for (shape, count, seed) in
        Shape::ALL.into_iter().flat_map(|shape| [(shape, 1, 0), (shape, 7, 1), (shape, 3001, 5)])
    {
        let mut page = Page { seed, made: Vec::new() };
        page.shape(shape, count as f64);
        let surfels = shape.surfels(count, seed).unwrap();
        assert_eq!(page.made.len(), surfels.len(), "{shape:?}, {count}");
        let bits = |v: [f32; 3]| v.map(f32::to_bits);
        for (i, (p, n, r, c)) in page.made.into_iter().enumerate() {
            let found = [surfels.position()[i], surfels.normal()[i], surfels.color().unwrap()[i]];
            let expected = [p, n, c].map(|v| bits(v.map(|c| c as f32)));
            assert_eq!(found.map(|v| bits(v.to_array())), expected, "{shape:?}, {count}: {i}");
            assert_eq!(surfels.radius()[i], r as f32, "{shape:?}, {count}: {i}");
        }
    }
}
