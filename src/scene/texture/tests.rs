use super::*;
use crate::number::elementary::{cos, sin};
use crate::number::random::unit;
use glam::Vec2;
use proptest::prelude::*;

/// A colour for each texel.
type Color = dyn Fn(u32, u32) -> [f32; 3];

fn texture(width: u32, height: u32, color: impl Fn(u32, u32) -> [f32; 3]) -> Texture {
    Texture::new(Plane::from_pixels([width, height], color)).unwrap()
}

fn noise(seed: u64) -> impl Fn(u32, u32) -> [f32; 3] {
    move |x, y| [0, 1, 2].map(|c| unit(seed, u64::from(x) << 32 | u64::from(y) << 2 | c))
}

/// An ellipse with these half axes, the longer one turned by `angle` radians.
fn turned(long: f64, short: f64, angle: f64) -> Ellipse {
    let (s, c) = (sin(angle), cos(angle));
    Ellipse::of(DVec2::new(c, s) * long, DVec2::new(-s, c) * short)
}

#[test]
fn cells_are_exact_means_of_odd_sizes() {
    for (width, height) in [(1, 1), (7, 5), (1, 9), (16, 3)] {
        let texture = texture(width, height, noise(1));
        assert_eq!(texture.0.last().unwrap().values().len(), 1);
        for (level, cells) in texture.0.iter().enumerate() {
            let side = 1_u32 << level;
            assert_eq!(cells.width(), width.div_ceil(side), "{width} x {height}");
            for y in 0..cells.height() {
                for x in 0..cells.width() {
                    let (mut sum, mut count) = (0.0, 0.0);
                    for j in (y * side..height).take(side as usize) {
                        for i in (x * side..width).take(side as usize) {
                            sum += f64::from(texture.0[0].at(i, j)[1]);
                            count += 1.0;
                        }
                    }
                    let off = f64::from(cells.at(x, y)[1]) - sum / count;
                    assert!(off.abs() < 3e-7, "level {level} ({x}, {y}): {off:e}");
                }
            }
        }
    }
}

/// The mean as the module page defines it, cell by cell, over all cells in 33 tiles.
fn by_the_page(texture: &Texture, at: DVec2, m: Ellipse, repeats: [bool; 2]) -> Option<Vec3> {
    let [half, diff] = [(m.xx + m.yy) / 2.0, (m.xx - m.yy) / 2.0];
    let root = (diff * diff + m.xy * m.xy).sqrt();
    let mut level = 0;
    let four = |n: usize| (0..n).fold(1.0, |power, _| power * 4.0);
    while level + 1 < texture.0.len()
        && (16.0 * four(level + 1) <= half - root || 16384.0 * four(level) < half + root)
    {
        level += 1;
    }
    let g2 = four(level);
    let [vxx, vxy, vyy] = [m.xx + g2, m.xy, m.yy + g2];
    let det = vxx * vyy - vxy * vxy;
    let side = 1_u32 << level;
    let cells = &texture.0[level];
    let [width, height] = texture.size();
    let tiles = repeats.map(|repeats| if repeats { -16..=16 } else { 0..=0 });
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    for (tile_y, y) in tiles[1].clone().flat_map(|t| (0..cells.height()).map(move |y| (t, y))) {
        for (tile_x, x) in tiles[0].clone().flat_map(|t| (0..cells.width()).map(move |x| (t, x))) {
            let (left, right) = (x * side, width.min((x + 1) * side));
            let (top, bottom) = (y * side, height.min((y + 1) * side));
            let middle = |tile: i32, of: u32, a: u32, b: u32| {
                f64::from(tile) * f64::from(of) + f64::from(a + b) / 2.0
            };
            let dx = middle(tile_x, width, left, right) - at.x;
            let dy = middle(tile_y, height, top, bottom) - at.y;
            let q = ((vyy / det) * (dx * dx) - (2.0 * (vxy / det)) * (dx * dy))
                + (vxx / det) * (dy * dy);
            if q < 1.0 {
                let area = f64::from(right - left) * f64::from(bottom - top);
                let w = area * ((1.0 - q) * (1.0 - q));
                sum += Vec3::from_array(*cells.at(x, y)).as_dvec3() * w;
                weight += w;
            }
        }
    }
    (weight > 0.0).then(|| (sum / weight).as_vec3() + Vec3::ZERO)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_mean_is_that_of_the_page(
        size in prop::array::uniform2(1_u32..40),
        place in prop::array::uniform2(0.0_f64..=1.0),
        long in prop::sample::select(vec![0.0, 0.4, 3.0, 11.0, 40.0, 150.0, 1e5]),
        ratio in prop::sample::select(vec![0.0, 0.02, 0.3, 1.0]),
        angle in 0.0_f64..3.2,
        repeats in prop::array::uniform2(prop::bool::ANY),
        seed in 0_u64..9,
    ) {
        let texture = texture(size[0], size[1], noise(seed));
        let at = DVec2::from_array(place) * DVec2::from_array(size.map(f64::from));
        let ellipse = turned(long, long * ratio, angle);
        let found = texture.mean(at, ellipse, repeats);
        prop_assert!(found.is_finite() && found.min_element() >= 0.0 && found.max_element() <= 1.0);
        if let Some(expected) = by_the_page(&texture, at, ellipse, repeats) {
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn one_colour_stays_that_colour(
        size in prop::array::uniform2(1_u32..200),
        place in prop::array::uniform2(-3.0_f32..4.0),
        color in prop::array::uniform3(0.0_f32..2.0),
        long in prop::sample::select(vec![0.0, 0.01, 0.3, 40.0, 1e9]),
        ratio in 0.0_f64..1.0,
        angle in 0.0_f64..3.2,
    ) {
        let texture = texture(size[0], size[1], |_, _| color);
        let paint = Paint::new(texture, &Coordinates::Points(vec![Vec2::splat(2.0)]), 0);
        let at = Vec2::from_array(place).as_dvec2();
        let found = paint.color(at, turned(long, long * ratio, angle));
        prop_assert_eq!(found, Vec3::from_array(color));
    }
}

/// The integral over the texture, with texels as squares of one colour, by 6 x 6 points a texel: no
/// pyramid, no g.
fn integral(
    size: [u32; 2],
    color: impl Fn(u32, u32) -> [f32; 3],
    at: DVec2,
    m: Ellipse,
    tiles: i64,
) -> DVec3 {
    let det = m.xx * m.yy - m.xy * m.xy;
    let [width, height] = size.map(i64::from);
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    for y in -tiles * height * 6..(tiles + 1) * height * 6 {
        for x in -tiles * width * 6..(tiles + 1) * width * 6 {
            let d = (DVec2::new(x as f64, y as f64) + 0.5) / 6.0 - at;
            let q = (m.yy * d.x * d.x - 2.0 * m.xy * d.x * d.y + m.xx * d.y * d.y) / det;
            if q < 1.0 {
                let [i, j] = [(x, width), (y, height)].map(|(x, n)| x.div_euclid(6).rem_euclid(n));
                let w = (1.0 - q) * (1.0 - q);
                sum += DVec3::from_array(color(i as u32, j as u32).map(f64::from)) * w;
                weight += w;
            }
        }
    }
    sum / weight
}

/// For a checkerboard of squares of 8 texels, for noise, and for a ramp; the differences come from
/// the blur by cells and by g.
#[test]
fn means_are_near_the_integrals() {
    let board = |x: u32, y: u32| [((x / 8 + y / 8) % 2) as f32; 3];
    let ramp = |x: u32, y: u32| [x as f32 / 64.0, y as f32 / 48.0, 0.5];
    let (width, height) = (64, 48);
    let grains = noise(5);
    let textures: [(&str, &Color, f64); 3] =
        [("board", &board, 0.05), ("noise", &grains, 0.05), ("ramp", &ramp, 0.01)];
    for (name, color, most) in textures {
        let texture = texture(width, height, color);
        for (at, long, short, angle) in [
            ([31.3, 22.8], 4.0, 4.0, 0.0),
            ([31.3, 22.8], 9.0, 6.0, 0.7),
            ([30.0, 24.0], 20.0, 5.0, 2.0),
            ([5.0, 40.0], 12.0, 12.0, 0.0),
            ([60.0, 10.0], 40.0, 30.0, 1.0),
        ] {
            let at = DVec2::from_array(at);
            for tiles in [0, 1] {
                let found = texture.mean(at, turned(long, short, angle), [tiles > 0; 2]);
                let truth = integral([width, height], color, at, turned(long, short, angle), tiles);
                let off = (found.as_dvec3() - truth).abs().max_element();
                assert!(off < most, "{name} {at} {long} x {short}, {tiles}: {off:.4}");
            }
        }
    }
}

#[test]
fn a_ramp_has_its_value_at_the_centre() {
    let (width, height) = (100, 80);
    let texture = texture(width, height, |x, y| [x as f32 + 0.5, y as f32 + 0.5, 0.0]);
    // The mean of a point averages its neighbours, with weights that are smooth and not linear.
    for (long, short, most) in
        [(0.0, 0.0, 0.2), (2.0, 1.0, 0.1), (8.0, 4.0, 0.05), (20.0, 20.0, 0.05)]
    {
        for i in 0..50 {
            let at = DVec2::new(40.0 + f64::from(unit(1, i)), 30.0 + f64::from(unit(2, i)) * 9.0);
            let found = texture.mean(at, turned(long, short, i as f64), [false; 2]);
            let off = (found.as_dvec3().truncate() - at).abs().max_element();
            assert!(off < most, "{long} x {short} at {at}: {off}");
        }
    }
}

#[test]
fn the_first_row_is_at_the_top() {
    let texture = texture(4, 2, |x, y| [x as f32, y as f32, 0.0]);
    let paint = |all: &[f32]| {
        let all = all.iter().map(|&x| Vec2::splat(x)).collect();
        Paint::new(texture.clone(), &Coordinates::Points(all), 0)
    };
    let at = |paint: &Paint, u, v| paint.color(DVec2::new(u, v), Ellipse::default());
    let clamped = paint(&[0.0, 1.0]);
    let (found, expected) = (at(&clamped, 0.625, 0.75), Vec3::new(2.0, 0.0, 0.0));
    assert_eq!(found, expected, "the centre of texel (2, 0)");
    assert_eq!(at(&clamped, 0.125, 0.25), Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(at(&clamped, 0.0, 1.0), Vec3::ZERO, "half a texel from the border");
    let repeated = paint(&[0.5, -0.5]);
    assert_eq!(at(&repeated, 0.625, 0.75), expected);
    assert_eq!(at(&repeated, -7.375, 5.75), expected);
    assert_eq!(at(&repeated, 0.0, 0.75), Vec3::new(1.5, 0.0, 0.0), "between 3 and 0");
    // One axis alone repeats; a coordinate that is not finite does not count.
    let one =
        Coordinates::Corners(vec![[Vec2::new(1.5, 0.5), Vec2::new(0.0, f32::NAN), Vec2::ZERO]]);
    assert_eq!(one.repeats(), [true, false]);
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(at(&repeated, bad, 0.0).is_nan() && at(&clamped, 0.0, bad).is_nan());
    }
}

#[test]
fn no_texture_is_refused_in_one_line() {
    let error = |width, height, color| {
        let plane = Plane::filled(width, height, color);
        Texture::new(plane).unwrap_err().to_string()
    };
    assert_eq!(error(0, 3, [0.0; 3]), "a texture of 0 x 3 pixels; give sides of 1 to 65536");
    assert!(error(65_537, 1, [0.0; 3]).contains("65537 x 1"));
    assert!(error(2, 2, [0.0, -1.0, 0.0]).starts_with("texel (0, 0) is [0, -1, 0]; clamp"));
    assert!(error(2, 2, [f32::NAN; 3]).contains("clamp the texture to [0, 65536]"));
}
