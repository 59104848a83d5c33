//! Scenes for the pull-push pyramid that are hard on purpose.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::goldens;
use crate::oracle::kit::scene::{self, ahead, scene, turned};
use glam::Vec3;
use splatref::method::pyramid::{Occlusion, Settings, Weights};
use splatref::scene::indexed::{Indexed, Primitives, Vertices};
use splatref::scene::{Camera, Cloud, Lens, Light, Scene, Surfels};

pub(crate) const SIZES: [[u32; 2]; 6] = [[64, 48], [31, 33], [16, 16], [13, 9], [1, 7], [1, 1]];

/// What surfels a scene has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Discs {
    None,
    /// A few large ones, any normal.
    Few,
    /// So many that most pixels have one.
    Many,
    /// Radii from 10^-30 to 10^30.
    Sizes,
    /// Edge-on and nearly so, at the near plane and behind it, at the end of f32.
    EdgeOn,
    /// Two walls a radius or less apart, facing the camera.
    Walls,
}

/// What else it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Others {
    None,
    /// Twisted, with segments of length 0.
    Lines,
    /// From behind the camera into the picture, and out of the guard band.
    LongLines,
    /// Strips with shared edges, radii at the boundary, and degenerate ones.
    Triangles,
    /// Through the near plane, and out of the guard band.
    LargeTriangles,
    Mixture,
}

const DISCS: [Discs; 6] =
    [Discs::Few, Discs::Many, Discs::Sizes, Discs::EdgeOn, Discs::Walls, Discs::None];
const OTHERS: [Others; 6] = [
    Others::None,
    Others::Lines,
    Others::Triangles,
    Others::LongLines,
    Others::LargeTriangles,
    Others::Mixture,
];

fn surfel(discs: Discs, dice: &mut Dice) -> (Vec3, Vec3, f32) {
    let around = dice.vector(Vec3::new(-3.0, -2.5, -6.0), Vec3::new(3.0, 2.5, -2.0));
    let (any, radius) = (dice.direction(), dice.within(0.125, 1.0));
    // Towards the camera more or less.
    let facing = (any + Vec3::Z * 1.5).normalize();
    match discs {
        Discs::Few => (around, if dice.below(3) == 0 { any } else { facing }, radius * 2.0),
        Discs::Many | Discs::None => (around, facing, radius * 0.5),
        Discs::Sizes => {
            let radii = [1e-30, 1e-12, 1e-3, 0.1, 1.0, 30.0, 1e4, 1e30];
            (around, facing, radii[dice.below(radii.len())])
        }
        Discs::EdgeOn => match dice.below(7) {
            0 => (Vec3::new(0.0, around.y, around.z), Vec3::X, radius),
            1 => (Vec3::new(around.x, 0.0, around.z), Vec3::Y, radius),
            2 => (Vec3::new(around.x / 64.0, 0.0, -0.0625), Vec3::Z, radius),
            3 => (-around, Vec3::Z, radius),
            4 => (around, Vec3::new(1.0, 0.0, 2.0_f32.powi(-10 * dice.below(12) as i32)), radius),
            5 => (Vec3::new(0.0078125, around.y, around.z), Vec3::X, radius),
            // So far to the side that f32 overflows.
            _ => (Vec3::new(1e38, around.y, around.z), facing, radius),
        },
        Discs::Walls => {
            let depth = if dice.below(2) == 0 { 3.0 } else { 3.0 + 0.5 * dice.below(3) as f32 };
            let normal = if dice.below(8) == 0 { -Vec3::Z } else { Vec3::Z };
            // Intervals that touch, too.
            let radius = [0.25, 0.5, 1.0, radius][dice.below(4)];
            (Vec3::new(around.x, around.y, -depth), normal, radius)
        }
    }
}

fn surfels(discs: Discs, dice: &mut Dice, pixels: u32, colored: bool) -> Surfels {
    let count = match discs {
        Discs::None => return Surfels::none(),
        Discs::Few => 1 + dice.below(8),
        Discs::Many => 40 + pixels as usize * 2,
        _ => 12 + pixels as usize / 8,
    };
    let drawn: Vec<_> = (0..count).map(|_| surfel(discs, dice)).collect();
    let color = || drawn.iter().map(|_| dice.vector(Vec3::ZERO, Vec3::ONE)).collect();
    let color = colored.then(color);
    scene::surfels(Cloud { color, ..scene::discs(drawn.iter().copied()) })
}

/// Vertices at points, with everything else by lot.
fn vertices(dice: &mut Dice, points: Vec<Vec3>, most: f32, colored: bool) -> Vertices {
    let count = points.len();
    let radius = |dice: &mut Dice| [0.0, dice.within(0.0, most)][dice.below(4).min(1)];
    Vertices {
        position: points,
        direction: (0..count).map(|_| dice.direction()).collect(),
        radius: (0..count).map(|_| radius(dice)).collect(),
        color: colored.then(|| (0..count).map(|_| dice.vector(Vec3::ZERO, Vec3::ONE)).collect()),
        ..Vertices::default()
    }
}

/// Polylines of a few vertices, a quarter of them with a segment of length 0.
fn lines(dice: &mut Dice, long: bool, colored: bool) -> splatref::scene::indexed::Polylines {
    let (mut points, mut corners) = (Vec::new(), Vec::new());
    for _ in 0..4 {
        let first = points.len() as u32;
        let count = 2 + dice.below(4) as u32;
        for _ in 0..count {
            let point = if long {
                // Exact in the grid of no picture; far to the side, before and behind the camera.
                let far = [1.0, 1.0, 64.0, 32_768.0][dice.below(4)];
                dice.vector(Vec3::new(-4.0, -3.0, -6.0), Vec3::new(4.0, 3.0, 2.0)) * far
            } else {
                dice.vector(Vec3::new(-3.0, -2.5, -6.0), Vec3::new(3.0, 2.5, -2.0))
            };
            points.push(point);
        }
        corners.extend((first + 1..first + count).map(|i| [i - 1, i]));
        match dice.below(4) {
            0 => corners.push([first, first]),
            1 => {
                points.push(points[first as usize]);
                corners.push([points.len() as u32 - 1, first]);
            }
            _ => {}
        }
    }
    let vertices = vertices(dice, points, 0.25, colored);
    Indexed::new(vertices, corners).expect("good lines").0
}

fn triangles(dice: &mut Dice, large: bool, colored: bool) -> splatref::scene::indexed::Triangles {
    let (low, high) = (Vec3::new(-3.0, -2.5, -6.0), Vec3::new(3.0, 2.5, -2.0));
    let (mut points, mut corners) = (Vec::new(), Vec::new());
    // A sheet of shared edges, on and off the pixel grid.
    for i in 0..9_u32 {
        let at = Vec3::new((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0, -4.0);
        points.push(at + dice.vector(Vec3::ZERO, Vec3::splat(0.25)) * dice.below(2) as f32);
    }
    for i in [0, 1, 3, 4] {
        corners.extend([[i, i + 1, i + 4], [i, i + 4, i + 3]]);
    }
    for _ in 0..6 {
        let first = points.len() as u32;
        for _ in 0..3 {
            let point = if large {
                let far = [1.0, 16.0, 32_768.0][dice.below(3)];
                dice.vector(Vec3::new(-4.0, -3.0, -6.0), Vec3::new(4.0, 3.0, 3.0)) * far
            } else {
                dice.vector(low, high)
            };
            points.push(point);
        }
        corners.push([first, first + 1, first + 2]);
    }
    // Two corners in one; a line; any three of those that are there.
    corners.extend([[0, 0, 4], [0, 1, 2]]);
    let any = |dice: &mut Dice| dice.below(points.len()) as u32;
    corners.push([any(dice), any(dice), any(dice)]);
    let vertices = vertices(dice, points, 0.5, colored);
    Indexed::new(vertices, corners).expect("good triangles").0
}

fn primitives(others: Others, dice: &mut Dice, colored: bool) -> Primitives {
    let mut all = Primitives::default();
    // Not all that a scene has need have colours.
    let own = |dice: &mut Dice| colored && dice.below(4) > 0;
    if matches!(others, Others::Lines | Others::LongLines | Others::Mixture) {
        let long = others == Others::LongLines;
        let both = dice.below(3);
        let (a, b) = (own(dice), own(dice));
        if both != 1 {
            all.ribbons = lines(dice, long, a);
        }
        if both != 2 {
            all.tubes = lines(dice, long, b);
        }
    }
    if matches!(others, Others::Triangles | Others::LargeTriangles | Others::Mixture) {
        let colored = own(dice);
        all.triangles = triangles(dice, others == Others::LargeTriangles, colored);
    }
    all
}

/// At the origin, looking along -z, turned a little on demand; every size sees the same part.
pub(crate) fn camera(dice: &mut Dice, orthographic: bool, [width, height]: [u32; 2]) -> Camera {
    let lens = if orthographic {
        Lens::Orthographic(6.0)
    } else {
        Lens::Focal(0.625 * f64::from(width.max(height)))
    };
    let mut camera = ahead(lens, [width, height]);
    camera.near = 0.0625;
    if dice.below(2) == 0 {
        camera.view_from_world = turned(dice);
        camera.fx *= 1.125;
        camera.cx += 0.25;
    }
    camera
}

fn lights(dice: &mut Dice) -> Vec<Light> {
    let color = dice.vector(Vec3::splat(0.25), Vec3::ONE);
    let all = [
        Light::Point { position: Vec3::new(2.0, 3.0, 1.0), color },
        Light::Headlight { towards: Vec3::new(0.25, 0.5, 1.0), color },
        Light::Directional { towards: Vec3::new(-1.0, 2.0, 3.0), color },
    ];
    all[..dice.below(4)].to_vec()
}

/// The case of a seed.
pub(crate) fn case(
    (discs, others): (Discs, Others),
    seed: u64,
    settings: Settings,
    (orthographic, size): (bool, [u32; 2]),
) -> Case<Settings> {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x1234_5678);
    dice.below(2);
    let colored = dice.below(4) > 0;
    let own = colored && dice.below(8) > 0;
    let surfels = surfels(discs, &mut dice, size[0] * size[1], own);
    let primitives = primitives(others, &mut dice, colored);
    let camera = camera(&mut dice, orthographic, size);
    let name = format!(
        "{discs:?} {others:?} seed {seed} orthographic {orthographic} {size:?} {settings:?}"
    );
    let scene = Scene { lights: lights(&mut dice), primitives, ..scene(surfels) };
    Case { name, scene, camera, settings, groups: None, exact: false }
}

/// Settings by number: every combination, with several grids.
pub(crate) fn settings(number: usize) -> Settings {
    Settings {
        weights: [Weights::Gaussian, Weights::Box][number % 2],
        occlusion: [Occlusion::Behind, Occlusion::Outside][number / 2 % 2],
        cull: number / 4 % 2 == 1,
        subpixel_bits: [8, 0, 4, 12][number / 8 % 4],
    }
}

/// Every mixture in every size, with settings and cameras by turns.
pub(crate) fn all() -> Vec<Case<Settings>> {
    let mut cases = Vec::new();
    for (s, size) in SIZES.into_iter().enumerate() {
        for (d, discs) in DISCS.into_iter().enumerate() {
            for (o, others) in OTHERS.into_iter().enumerate() {
                let seed = cases.len() as u64;
                let number = d * 7 + o * 5 + s * 3 + usize::from(o > 2) * 16;
                let orthographic = (d + o + s) % 3 == 1;
                let optics = (orthographic, size);
                cases.push(case((discs, others), seed, settings(number), optics));
            }
        }
    }
    cases
}

/// Those, and the goldens.
pub(crate) fn with_goldens() -> Vec<Case<Settings>> {
    let mut cases = all();
    cases.extend(goldens::of());
    cases
}
