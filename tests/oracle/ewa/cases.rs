//! Small scenes that are hard on purpose.

use glam::{DVec3, Mat4, Vec3};
use splatref::method::ewa::{Epsilon, Settings};
use splatref::scene::{Camera, Cloud, Lens, Light, Phong, Pose, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::{Kernel, Outline};

pub(crate) const OUTLINES: [Outline; 3] = [Outline::Affine, Outline::Perspective, Outline::RayCast];

/// A scene, a camera and settings.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) camera: Camera,
    pub(crate) settings: Settings,
    /// Whether normals have length 1 and tangents are perpendicular to them exactly, in view space
    /// too. Otherwise they are off by the rounding of the input, which f64 sees.
    pub(crate) exact: bool,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at {}x{}", self.name, self.camera.width, self.camera.height)
    }
}

/// Random numbers: a 64-bit congruential generator, upper bits.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// In [low, high), in 4096 steps, so that sums stay exact.
    pub(crate) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.bits() % 4096) as f32 / 4096.0)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub(crate) fn vector(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::new(
            self.within(low.x, high.x),
            self.within(low.y, high.y),
            self.within(low.z, high.z),
        )
    }

    /// A direction, not one of the axes.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector(Vec3::splat(-1.0), Vec3::ONE);
            if v.length() > 0.25 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }

    fn axis(&mut self) -> Vec3 {
        let sign = if self.below(2) == 0 { 1.0 } else { -1.0 };
        [Vec3::X, Vec3::Y, Vec3::Z][self.below(3)] * sign
    }
}

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

/// A camera at the origin that looks along -z: its view matrix is the identity.
pub(crate) fn straight(orthographic: bool, [width, height]: [u32; 2]) -> Camera {
    let lens = if orthographic { Lens::Orthographic(6.0) } else { Lens::Focal(28.0) };
    let pose = Pose { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };
    let mut camera = Camera::new(width, height, pose, lens).expect("a plain camera");
    camera.view_from_world = Mat4::IDENTITY;
    camera.near = 0.0625;
    // Pixels that are not square, a principal point off the middle.
    camera.fx *= 1.125;
    camera.cx += 1.25;
    camera
}

/// The camera of a shape, orthographic on demand.
pub(crate) fn framed(shape: &Shape, orthographic: bool, [width, height]: [u32; 2]) -> Camera {
    let lens = if orthographic { Lens::Orthographic(2.5) } else { shape.default_lens() };
    Camera::new(width, height, shape.default_pose(), lens).expect("the camera of a shape")
}

fn lights(dice: &mut Dice) -> Vec<Light> {
    let color = dice.vector(Vec3::splat(0.25), Vec3::ONE);
    let all = [
        Light::Headlight { towards: Vec3::new(0.25, 0.5, 1.0), color },
        Light::Directional { towards: Vec3::new(-1.0, 2.0, 3.0), color },
        Light::Point { position: Vec3::new(2.0, 3.0, 4.0), color },
    ];
    all[..dice.below(4)].to_vec()
}

impl Case {
    pub(crate) fn new(kind: Kind, seed: u64, settings: Settings, orthographic: bool) -> Self {
        let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66);
        dice.bits();
        let size = [[37, 29], [40, 24], [33, 31], [64, 48]][dice.below(4)];
        let (surfels, mut camera) = if let Kind::Shape(which) = kind {
            let shape = &Shape::ALL[which];
            let surfels = shape.surfels(250, seed).expect("few surfels");
            (surfels, framed(shape, orthographic, size))
        } else {
            let surfels = Surfels::new(kind.cloud(&mut dice, 40)).expect("good surfels").0;
            (surfels, straight(orthographic, size))
        };
        let rolled = !kind.exact() && !matches!(kind, Kind::Shape(_));
        if rolled {
            let roll = Mat4::from_rotation_x(0.1) * Mat4::from_rotation_z(dice.within(-3.0, 3.0));
            camera.view_from_world = roll;
        }
        let name = format!("{kind:?} seed {seed} orthographic {orthographic} {settings:?}");
        let (lights, material) = (lights(&mut dice), Phong::default());
        let scene = Scene {
            name: String::new(),
            surfels,
            lights,
            material,
            primitives: Default::default(),
            environment: None,
        };
        Self { name, scene, camera, settings, exact: kind.exact() }
    }
}

/// Every outline, camera, culling, epsilon and kernel with several kinds of scenes.
pub(crate) fn all() -> Vec<Case> {
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
                cases.push(Case::new(kind, cases.len() as u64, settings, ortho == 1));
            }
        }
    }
    cases
}
