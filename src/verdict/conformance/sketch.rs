//! Draft a scene: discs or Gaussians, meshes, a camera, lights and settings, with defaults that a rule changes.
//!
//! The default camera stands at (0, 0, 8), looks along -z, and shows one world unit at z = 0 as 8
//! pixels, so that numbers of a sketch are short decimals of pixels: the picture has 48 x 40 pixels,
//! and the origin lies at its middle.

use super::{Case, Draws};
use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::index::mipmap;
use crate::method::Method;
use crate::number::random::unit;
use crate::scene::cloud::half_axes;
use crate::scene::gaussians::{Encoding, MAX_DEGREE, coefficients};
use crate::scene::{
    Camera, Cloud, Environment, GaussianArrays, Gaussians, Lens, Light, Phong, Polylines, Pose,
    Primitives, Scene, Surface, Surfels, Triangles,
};
use crate::setting::{Fields, Refused};
use crate::source::{Shape, derive};
use glam::{DVec3, Quat, Vec3, Vec4};

/// A surfel of a sketch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub(super) at: Vec3,
    pub(super) normal: Vec3,
    pub(super) radius: f32,
    pub(super) color: Vec3,
    pub(super) opacity: f32,
    /// The half axes of an ellipse.
    pub(super) axes: Option<[Vec3; 2]>,
}

/// A Gaussian of a sketch.
#[derive(Clone, Debug)]
pub(super) struct Blob {
    pub(super) at: Vec3,
    pub(super) scale: Vec3,
    pub(super) rotation: Quat,
    pub(super) opacity: f32,
    /// 1, 4, 9 or 16 coefficients.
    pub(super) harmonics: Vec<Vec3>,
}

impl Blob {
    /// Gives the splat a look that depends on the direction.
    pub(super) fn look(&mut self, degree: u8) {
        let rows = usize::from(degree) + 1;
        let seed = u64::from(self.at.x.to_bits());
        let part = |k: u64| unit(seed, k) - 0.5;
        let first = self.harmonics[0];
        let more = (1..(rows * rows) as u64)
            .map(|k| Vec3::new(part(3 * k), part(3 * k + 1), part(3 * k + 2)) * 0.5);
        self.harmonics = std::iter::once(first).chain(more).collect();
    }
}

/// Depth and colour of a surface at a column and row.
pub(super) type Opaque = fn(u32, u32) -> (f32, [f32; 3]);

/// A scene, a camera and settings that are still to be changed.
#[derive(Clone, Debug)]
pub(super) struct Sketch {
    pub(super) discs: Vec<Disc>,
    /// Gaussians in place of surfels.
    pub(super) blobs: Vec<Blob>,
    /// Whether Gaussians store linear light.
    pub(super) linear: bool,
    pub(super) meshes: Vec<(Cloud, Draws)>,
    pub(super) size: [u32; 2],
    pub(super) pose: Pose,
    pub(super) lens: Lens,
    /// How far the principal point lies from the middle, in pixels.
    pub(super) shift: [f32; 2],
    /// The vertical focal length, as a multiple of the horizontal one.
    pub(super) stretch: f32,
    pub(super) near: Option<f32>,
    pub(super) lights: Vec<Light>,
    pub(super) material: Phong,
    pub(super) sky: bool,
    /// The opaque geometry that Gaussians are mixed with.
    pub(super) surface: Option<Opaque>,
    /// Whether surfels have colours, and whether they have opacities.
    pub(super) colored: bool,
    pub(super) veiled: bool,
    /// Levels of prefiltered colours.
    pub(super) mipmaps: usize,
    /// Settings of the method and of its groups, as on the command line.
    pub(super) settings: Vec<(&'static str, &'static str)>,
    pub(super) groups: Vec<(&'static str, &'static str)>,
}

/// The colours that discs get in turn.
const PALETTE: [[f32; 3]; 5] = [
    [0.75, 0.25, 0.125],
    [0.125, 0.5, 0.75],
    [0.5, 0.75, 0.25],
    [0.75, 0.625, 0.125],
    [0.375, 0.25, 0.75],
];

impl Default for Sketch {
    fn default() -> Self {
        Self {
            discs: Vec::new(),
            blobs: Vec::new(),
            linear: false,
            meshes: Vec::new(),
            size: [48, 40],
            pose: Pose { eye: DVec3::new(0.0, 0.0, 8.0), target: DVec3::ZERO, up: DVec3::Y },
            lens: Lens::Focal(64.0),
            shift: [0.0; 2],
            stretch: 1.0,
            near: None,
            lights: vec![Light::DEFAULT],
            material: Phong::default(),
            sky: false,
            surface: None,
            colored: true,
            veiled: false,
            mipmaps: 0,
            settings: Vec::new(),
            groups: Vec::new(),
        }
    }
}

impl Sketch {
    /// Adds a disc that faces the camera.
    pub(super) fn disc(&mut self, at: [f32; 3], radius: f32) -> &mut Disc {
        self.tilted(at, radius, [0.0, 0.0, 1.0])
    }

    /// Adds a disc with a normal of any length.
    pub(super) fn tilted(&mut self, at: [f32; 3], radius: f32, normal: [f32; 3]) -> &mut Disc {
        let at_once = self.discs.len();
        let color = PALETTE[at_once % PALETTE.len()].into();
        let (at, normal) = (at.into(), normal.into());
        self.discs.push(Disc { at, normal, radius, color, opacity: 1.0, axes: None });
        &mut self.discs[at_once]
    }

    /// Adds a Gaussian along the axes of the world, of opacity 0.9 and of one colour.
    pub(super) fn blob(&mut self, at: [f32; 3], scale: [f32; 3]) -> &mut Blob {
        let at_once = self.blobs.len();
        // Of degree 0: (color - 1/2) / 0.28209.
        let color = (Vec3::from(PALETTE[at_once % PALETTE.len()]) - 0.5) * 3.544_907_7;
        self.blobs.push(Blob {
            at: at.into(),
            scale: scale.into(),
            rotation: Quat::IDENTITY,
            opacity: 0.9,
            harmonics: vec![color],
        });
        &mut self.blobs[at_once]
    }

    /// Adds Gaussians at random places in front of the camera, with random rotations and looks.
    pub(super) fn scatter_blobs(&mut self, count: u64, scale: f32) {
        for i in 0..count {
            let random = |k: u64| 2.0 * unit(11, 12 * i + k) - 1.0;
            let at = [2.5 * random(0), 2.0 * random(1), random(2)];
            let size = |k: u64| scale * (1.05 + random(k));
            let blob = self.blob(at, [size(3), size(4), size(5)]);
            let parts = Vec4::new(random(6), random(7), random(8), 1.5).normalize();
            blob.rotation = Quat::from_vec4(parts);
            blob.opacity = 0.5 + 0.5 * random(9);
            blob.look(3);
        }
    }

    /// Adds the surfels of a shape, scaled.
    pub(super) fn shape(&mut self, shape: Shape, count: usize, scale: f32) {
        // The counts and parameters of the rules are in range.
        let Ok(surfels) = shape.surfels(count, 0) else { return };
        let color = |i: usize| surfels.color().map_or(Vec3::ONE, |color| color[i]);
        self.discs.extend((0..surfels.len()).map(|i| Disc {
            at: surfels.position()[i] * scale,
            normal: surfels.normal()[i],
            radius: surfels.radius()[i] * scale,
            color: color(i),
            opacity: 1.0,
            axes: None,
        }));
    }

    /// Adds a large shape, seen as the shape is by default, in a picture of 320 x 240 pixels.
    pub(super) fn large(&mut self, shape: Shape) {
        self.shape(shape, 5000, 1.0);
        self.size = [320, 240];
        (self.pose, self.lens) = (shape.default_pose(), shape.default_lens());
    }

    /// Adds discs at random places in front of the camera, tilted at random.
    pub(super) fn scatter(&mut self, count: u64, radius: f32) {
        for i in 0..count {
            let random = |k: u64| 2.0 * unit(7, 8 * i + k) - 1.0;
            let at = [2.5 * random(0), 2.0 * random(1), random(2)];
            let size = radius * (1.0 + 0.5 * random(3));
            let disc = self.tilted(at, size, [random(4), random(5), 1.5]);
            disc.color = Vec3::new(unit(7, 8 * i + 6), unit(7, 8 * i + 7), 0.5);
        }
    }

    /// Gives every disc this opacity.
    pub(super) fn veil(&mut self, opacity: f32) {
        self.veiled = true;
        self.discs.iter_mut().for_each(|disc| disc.opacity = opacity);
    }

    /// Sets a setting of the method; a later value replaces an earlier one.
    pub(super) fn set(&mut self, name: &'static str, value: &'static str) {
        self.settings.push((name, value));
    }

    /// Multiplies every radius.
    pub(super) fn grow(&mut self, factor: f32) {
        for disc in &mut self.discs {
            disc.radius *= factor;
            disc.axes = disc.axes.map(|axes| axes.map(|axis| axis * factor));
        }
        self.blobs.iter_mut().for_each(|blob| blob.scale *= factor);
    }

    /// The method with the settings of this sketch.
    pub(super) fn method(&self, mut method: Method) -> Result<Method> {
        self.settings.iter().try_for_each(|(name, value)| set(&mut method, name, value))?;
        method.check()?;
        Ok(method)
    }

    /// The case that this sketch makes for a method with its default settings.
    pub(super) fn case(self, rule: &str, method: Method, exec: &Exec) -> Result<Case> {
        let method = self.method(method)?;
        let surfels =
            if self.blobs.is_empty() { self.grouped(&method, exec)? } else { Surfels::none() };
        let gaussians = self.gaussians()?;
        let (camera, meshes) = (self.camera()?, self.meshes.clone());
        let planes = |of: Opaque| {
            let depth = Plane::from_pixels(self.size, |x, y| of(x, y).0);
            Surface::new(depth, Plane::from_pixels(self.size, |x, y| of(x, y).1))
        };
        let surface = self.surface.map(planes).transpose()?;
        let scene = Scene {
            // Gaussians are not lit.
            lights: if gaussians.is_some() { Vec::new() } else { self.lights },
            material: self.material,
            environment: self.sky.then_some(Environment::Sky),
            primitives: primitives(self.meshes, exec)?,
            gaussians,
            surface,
            ..Scene::unlit(rule, surfels)
        };
        Ok(Case { rule: rule.to_owned(), scene, meshes, camera, method })
    }

    fn camera(&self) -> Result<Camera> {
        let [width, height] = self.size;
        let mut camera = Camera::new(width, height, self.pose, self.lens)?;
        let [x, y] = self.shift;
        (camera.cx, camera.cy) = (camera.cx + x, camera.cy + y);
        camera.fy *= self.stretch;
        camera.near = self.near.unwrap_or(camera.near);
        camera.check()?;
        Ok(camera)
    }

    /// The Gaussians, if there are any, all of the greatest degree.
    fn gaussians(&self) -> Result<Option<Gaussians>> {
        let blobs = &self.blobs;
        let Some(most) = blobs.iter().map(|blob| blob.harmonics.len()).max() else {
            return Ok(None);
        };
        let padded = |blob: &Blob| {
            let mut all = blob.harmonics.clone();
            all.resize(most, Vec3::ZERO);
            all
        };
        let arrays = GaussianArrays {
            position: blobs.iter().map(|blob| blob.at).collect(),
            scale: blobs.iter().map(|blob| blob.scale).collect(),
            rotation: blobs.iter().map(|blob| blob.rotation.to_array()).collect(),
            opacity: blobs.iter().map(|blob| blob.opacity).collect(),
            degree: (0..=MAX_DEGREE).find(|&d| coefficients(d) == most).unwrap_or(MAX_DEGREE),
            harmonics: blobs.iter().flat_map(padded).collect(),
            encoding: if self.linear { Encoding::Linear } else { Encoding::Srgb },
        };
        Ok(Some(Gaussians::new(arrays)?.0))
    }

    fn surfels(&self, exec: &Exec) -> Result<Surfels> {
        let discs = &self.discs;
        let elliptical = discs.iter().any(|disc| disc.axes.is_some());
        let tangents = |disc: &Disc| {
            disc.axes.unwrap_or_else(|| half_axes(disc.normal.normalize(), disc.radius))
        };
        let cloud = Cloud {
            position: discs.iter().map(|disc| disc.at).collect(),
            normal: Some(discs.iter().map(|disc| disc.normal).collect()),
            radius: Some(discs.iter().map(|disc| disc.radius).collect()),
            color: self.colored.then(|| discs.iter().map(|disc| disc.color).collect()),
            opacity: self.veiled.then(|| discs.iter().map(|disc| disc.opacity).collect()),
            tangents: elliptical.then(|| discs.iter().map(tangents).collect()),
            ..Cloud::default()
        };
        let surfels = Surfels::new(cloud)?.0;
        if self.mipmaps == 0 {
            return Ok(surfels);
        }
        let made = mipmap::build(&surfels, self.mipmaps, exec, &|_, _, _| ())?;
        surfels.with_mipmap(Some(made))
    }

    /// The surfels, in groups if the method draws groups.
    fn grouped(&self, method: &Method, exec: &Exec) -> Result<Surfels> {
        let surfels = self.surfels(exec)?;
        let Some(mut grouping) = method.grouping() else { return Ok(surfels) };
        self.groups.iter().try_for_each(|(name, value)| set(&mut grouping, name, value))?;
        let (groups, ..) = grouping.groups(&surfels, exec, &|_, _, _| ())?;
        let mipmap = surfels.mipmap().cloned();
        let cloud = Cloud { groups: Some(groups), mipmap, ..surfels.into_cloud() };
        Ok(Surfels::new(cloud)?.0)
    }
}

/// Sets a setting by its name and its text.
fn set<F: Fields>(settings: &mut F, name: &str, text: &str) -> Result<()> {
    let value = settings.read(name, text).unwrap_or_else(|| Err(format!("no setting `{name}`")));
    let value = value.map_err(Error::Invalid)?;
    settings.set(name, &value).map_err(|refused| match refused {
        Refused::Idle(why) => Error::Invalid(format!("`{name}` has no effect {why}")),
        Refused::Unknown => Error::Invalid(format!("no setting `{name}`")),
        Refused::Wrong(what) => Error::Invalid(what),
    })
}

/// The primitives of some meshes; at most one of each kind.
fn primitives(meshes: Vec<(Cloud, Draws)>, exec: &Exec) -> Result<Primitives> {
    let (mut triangles, mut ribbons, mut tubes) =
        (Triangles::default(), Polylines::default(), Polylines::default());
    let options = derive::Derive::default();
    for (cloud, draws) in meshes {
        match draws {
            Draws::Polygons => triangles = derive::polygons(cloud, exec, &|_, _, _| ())?.0,
            Draws::Ribbons => ribbons = derive::ribbons(cloud, &options)?.0,
            Draws::Tubes => tubes = derive::tubes(cloud, &options)?.0,
        }
    }
    Ok(Primitives { triangles, ribbons, tubes })
}
