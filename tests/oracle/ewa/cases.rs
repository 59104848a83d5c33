//! Small scenes that are hard on purpose.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{OUTLINES, framed, lights, scene, straight, surfels, turned};
use glam::Vec3;
use splatref::method::ewa::Settings;
use splatref::scene::{Cloud, Scene};
use splatref::source::Shape;
use splatref::splat::Epsilon;
use splatref::splat::Kernel;

/// What fills a scene. The surfels of all but `Shape` lie around (0, 0, -4), before a camera at
/// the origin that looks along -z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// Discs of about 2 to 10 px, any normal.
    Discs,
    /// Discs whose normals are axes: exact in f64 too.
    Axes,
    /// Ellipses in axis-parallel planes: exact in f64 too.
    Ellipses,
    /// Ellipses at any angle.
    Tilted,
    /// Radii from 10^-12 to 1000.
    Sizes,
    /// Depths a few ulp apart, facing the camera.
    Layers,
    /// Edge-on, nearly edge-on, at the near plane, behind the camera.
    Degenerate,
    /// A procedural shape.
    Shape(usize),
}

pub(crate) const KINDS: [Kind; 12] = [
    Kind::Discs,
    Kind::Axes,
    Kind::Ellipses,
    Kind::Tilted,
    Kind::Sizes,
    Kind::Layers,
    Kind::Degenerate,
    Kind::Shape(0),
    Kind::Shape(1),
    Kind::Shape(2),
    Kind::Shape(4),
    Kind::Shape(5),
];

impl Kind {
    fn exact(self) -> bool {
        matches!(self, Self::Axes | Self::Ellipses | Self::Degenerate | Self::Layers)
    }

    /// Whether discs lie in one plane: without a band, rounding alone decides which are seen.
    fn flat(self) -> bool {
        matches!(self, Self::Layers | Self::Shape(2 | 4))
    }

    fn cloud(self, dice: &mut Dice, count: usize) -> Cloud {
        let mut cloud = Cloud {
            position: Vec::new(),
            normal: Some(Vec::new()),
            radius: Some(Vec::new()),
            color: (dice.below(4) > 0).then(Vec::new),
            opacity: None,
            tangents: matches!(self, Self::Ellipses | Self::Tilted).then(Vec::new),
            groups: None,
            ..Cloud::default()
        };
        for _ in 0..count {
            let (position, normal, radius) = self.surfel(dice);
            cloud.position.push(position);
            cloud.normal.as_mut().into_iter().for_each(|all| all.push(normal));
            cloud.radius.as_mut().into_iter().for_each(|all| all.push(radius));
            let color = dice.vector(Vec3::ZERO, Vec3::ONE);
            cloud.color.as_mut().into_iter().for_each(|all| all.push(color));
            if let Some(all) = &mut cloud.tangents {
                all.push(Self::tangents(dice, normal, radius));
            }
        }
        cloud
    }

    fn surfel(self, dice: &mut Dice) -> (Vec3, Vec3, f32) {
        let around = dice.vector(Vec3::new(-3.0, -2.5, -6.0), Vec3::new(3.0, 2.5, -2.0));
        let radius = dice.within(0.15, 1.0);
        match self {
            Self::Axes | Self::Ellipses => (around, dice.axis(), radius),
            Self::Sizes => {
                let radius = [1e-12, 1e-6, 1e-3, 0.01, 0.1, 1.0, 30.0, 1000.0][dice.below(8)];
                let normal =
                    if radius > 10.0 { dice.direction() + Vec3::Z * 2.0 } else { dice.direction() };
                (around, normal.normalize(), radius)
            }
            Self::Layers => {
                let ulps = dice.below(5) as u32;
                let depth = f32::from_bits(4.0_f32.to_bits() + ulps);
                (Vec3::new(around.x, around.y, -depth), Vec3::Z, radius)
            }
            Self::Degenerate => match dice.below(5) {
                // Exactly edge-on: the ray through the centre lies in the plane.
                0 => (Vec3::new(0.0, around.y, around.z), Vec3::X, radius),
                1 => (Vec3::new(around.x, 0.0, around.z), Vec3::Y, radius),
                // At the near plane, and behind it.
                2 => (Vec3::new(around.x / 64.0, 0.0, -0.0625), Vec3::Z, radius),
                3 => (-around, Vec3::Z, radius),
                // Nearly edge-on.
                _ => (Vec3::new(0.0078125, around.y, around.z), Vec3::X, radius),
            },
            _ => (around, dice.direction(), radius),
        }
    }

    /// Half axes perpendicular to the normal; exactly so if that is an axis.
    fn tangents(dice: &mut Dice, normal: Vec3, radius: f32) -> [Vec3; 2] {
        let helper = if normal.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
        let first = normal.cross(helper).normalize();
        let second = normal.cross(first);
        let (c, s) = (dice.within(-1.0, 1.0) + 0.125, dice.within(-1.0, 1.0));
        let ratio = [1.0, 0.5, 0.125, 0.015625][dice.below(4)];
        [(first * c + second * s) * radius, (second * c - first * s) * (radius * ratio)]
    }
}

/// The case of a seed.
pub(crate) fn case(
    kind: Kind,
    seed: u64,
    settings: Settings,
    orthographic: bool,
) -> Case<Settings> {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66);
    dice.bits();
    let size = [[37, 29], [40, 24], [33, 31], [64, 48]][dice.below(4)];
    let (surfels, mut camera) = if let Kind::Shape(which) = kind {
        let shape = &Shape::ALL[which];
        let surfels = shape.surfels(250, seed).expect("few surfels");
        (surfels, framed(shape, orthographic, size))
    } else {
        (surfels(kind.cloud(&mut dice, 40)), straight(orthographic, size))
    };
    let rolled = !kind.exact() && !matches!(kind, Kind::Shape(_));
    if rolled {
        camera.view_from_world = turned(&mut dice);
    }
    let name = format!("{kind:?} seed {seed} orthographic {orthographic} {settings:?}");
    let scene = Scene { lights: lights(&mut dice), ..scene(surfels) };
    Case { name, scene, camera, settings, groups: None, exact: kind.exact() }
}

/// Every outline, camera, culling, epsilon and kernel with several kinds of scenes.
pub(crate) fn all() -> Vec<Case<Settings>> {
    let mut cases = Vec::new();
    for (o, outline) in OUTLINES.into_iter().enumerate() {
        for number in 0..24 {
            let [ortho, cull, kernel, band] =
                [number % 2, number / 2 % 2, number / 4 % 2, number / 8];
            let epsilon =
                [Epsilon::World(0.0), Epsilon::MedianRadii(1.0), Epsilon::World(f32::INFINITY)]
                    [band];
            let kernel = [Kernel::DEFAULT, Kernel::ZPVBG01][kernel];
            let settings =
                Settings { kernel: Kernel { outline, ..kernel }, epsilon, cull: cull == 1 };
            for turn in 0..4 {
                let kind = KINDS[(number * 5 + o + turn * 3) % KINDS.len()];
                if kind.flat() && band == 0 {
                    continue;
                }
                cases.push(case(kind, cases.len() as u64, settings, ortho == 1));
            }
        }
    }
    cases
}
