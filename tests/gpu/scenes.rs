//! The scenes that the clients draw, and what they upload of them.

use splatref::SceneFile;
use splatref::composite::bins::Range;
use splatref::method::single_pass::{DepthTest, Settings};
use splatref::scene::{Camera, Projection, Scene, Sphere};
use splatref::source::Shape;
use splatref::splat::SplatSettings;
use splatref::splat::record::{SplatRecord, project_records};
use splatref::{Exec, Method, Session};

/// A scene, seen by a camera, drawn by a method.
pub(crate) struct Job {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) camera: Camera,
    pub(crate) method: Method,
}

impl Job {
    /// A shape of this many surfels.
    fn shape(shape: Shape, count: usize, [width, height]: [u32; 2], method: &str) -> Self {
        let surfels = shape.surfels(count, 0).expect("a shape");
        Self {
            name: format!("{} of {count} surfels at {width} x {height}", shape.name()),
            scene: Scene::lit(shape.name(), surfels),
            camera: Camera::new(width, height, shape.default_pose(), shape.default_lens())
                .expect("a camera"),
            method: Method::by_name(method).expect("a method"),
        }
    }

    /// A golden with its own camera and settings.
    fn golden(name: &str) -> Self {
        let path = format!("{}/../../golden/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let file = SceneFile::open(path).expect("a golden");
        let ready = file.ready(&exec(), &|_, _, _| ()).expect("a golden that can be drawn");
        let [width, height] = ready.camera.size();
        Self {
            name: format!("{name} at {width} x {height}"),
            scene: ready.loaded.scene.clone(),
            camera: ready.camera,
            method: ready.method,
        }
    }

    /// The settings of the method's splats.
    pub(crate) fn splats(&self) -> SplatSettings {
        match &self.method {
            Method::Ewa(settings) => *settings,
            Method::SinglePass(settings) => settings.splats,
            _ => SplatSettings::default(),
        }
    }

    pub(crate) fn session<'a>(&'a self, exec: &'a Exec) -> Session<'a> {
        Session::new(&self.scene, self.method, exec).expect("a scene that the method draws")
    }

    /// Whether the camera is a perspective one.
    pub(crate) fn perspective(&self) -> bool {
        self.camera.projection == Projection::Perspective
    }

    /// The splats as splatref projects them.
    pub(crate) fn records(&self) -> Vec<SplatRecord> {
        let SplatSettings { kernel, cull, .. } = self.splats();
        project_records(&self.scene.surfels, &self.camera, &kernel, cull).0
    }

    /// `View` of `view.wgsl`, for `count` splats.
    pub(crate) fn view_words(&self, count: usize) -> Vec<u32> {
        let (camera, splats) = (&self.camera, self.splats());
        let m = camera.view_from_world;
        let mut numbers: Vec<f32> = (0..3).flat_map(|row| m.row(row).to_array()).collect();
        let [width, height] = camera.size().map(|side| side as f32);
        numbers.extend([
            camera.fx,
            camera.fy,
            camera.cx,
            camera.cy,
            width,
            height,
            camera.near,
            f32::INFINITY,
        ]);
        let epsilon = splats.epsilon.resolve(&self.scene.surfels);
        numbers.extend([splats.kernel.cutoff, splats.kernel.low_pass, epsilon, self.depth_scale()]);
        let bins = self.bins(epsilon);
        let flags = [self.perspective(), splats.cull].map(u32::from);
        let bins = bins.unwrap_or_default().map(f32::to_bits);
        let words = numbers.into_iter().map(f32::to_bits);
        words.chain(flags).chain([count as u32, self.far_scale().to_bits()]).chain(bins).collect()
    }

    /// The bins of the Voronoi-enhanced depth test, if the method has it.
    fn bins(&self, epsilon: f32) -> Option<[f32; 4]> {
        let Method::SinglePass(Settings { depth: DepthTest::Voronoi(bins), .. }) = &self.method
        else {
            return None;
        };
        let surfels = &self.scene.surfels;
        let Range { nearest, farthest, count } =
            bins.resolve(surfels, &self.camera, epsilon).expect("bins of a checked method");
        Some([nearest, farthest, count as f32, 0.0])
    }

    /// The power of two that brings what the depth test of EWA compares to [0, 1].
    fn depth_scale(&self) -> f32 {
        let near = power_of_two(self.camera.near);
        if self.perspective() { near } else { self.far_scale() }
    }

    /// The power of two that brings depths to [0, 1].
    fn far_scale(&self) -> f32 {
        let Sphere { center, radius } = self.scene.surfels.bounding_sphere();
        let farthest = (self.camera.eye() - center).length() + radius;
        0.5 / power_of_two(farthest as f32)
    }

    /// All surfels, as [`Job::words_of`] gives them.
    pub(crate) fn surfel_words(&self) -> Vec<u32> {
        self.words_of(&(0..self.scene.surfels.len()).collect::<Vec<_>>())
    }

    /// These surfels as `Surfel` of `project.wgsl`, 20 words each.
    pub(crate) fn words_of(&self, chosen: &[usize]) -> Vec<u32> {
        let surfels = &self.scene.surfels;
        let one = |&i: &usize| {
            let (p, n, radius) = (surfels.position()[i], surfels.normal()[i], surfels.radius()[i]);
            let color = surfels.color().map_or([0.0; 3], |colors| colors[i].to_array());
            let tangents = surfels.tangents().map(|tangents| tangents[i]);
            let [u, v] = tangents.unwrap_or_default();
            let reach = tangents.map_or(radius, |[u, v]| (u.dot(u) + v.dot(v)).sqrt());
            let bits = |v: [f32; 3]| v.map(f32::to_bits);
            let rows = [
                (bits(p.to_array()), radius.to_bits()),
                (bits(n.to_array()), tangents.is_some().into()),
                (bits(color), reach.to_bits()),
                (bits(u.to_array()), i as u32),
                (bits(v.to_array()), 0),
            ];
            rows.into_iter().flat_map(|([x, y, z], w)| [x, y, z, w])
        };
        chosen.iter().flat_map(one).collect()
    }
}

/// The greatest power of two that is not greater than a normal number.
fn power_of_two(number: f32) -> f32 {
    f32::from_bits(number.to_bits() & 0x7f80_0000)
}

/// A record as the shaders read it.
pub(crate) fn record_words(records: &[SplatRecord]) -> Vec<u32> {
    let bytes: Vec<u8> = records.iter().flat_map(SplatRecord::to_bytes).collect();
    bytemuck::pod_collect_to_vec(&bytes)
}

pub(crate) fn exec() -> Exec {
    Exec::new(0, 32).expect("tiles of 32 pixels")
}

/// The scenes of EWA: smooth ones in three sizes, ellipses beside discs, ties, and decisions beside their limits.
pub(crate) fn of_ewa() -> Vec<Job> {
    vec![
        Job::shape(Shape::Sphere, 500, [64, 64], "ewa"),
        Job::shape(Shape::Sphere, 2_000, [160, 120], "ewa"),
        Job::shape(Shape::Torus, 5_000, [320, 240], "ewa"),
        Job::shape(Shape::Sheets { gap: 0.25 }, 800, [96, 72], "ewa"),
        Job::golden("ewa_ellipses"),
        Job::golden("ewa_cull_off_unoriented"),
        Job::golden("ewa_ladder_affine"),
    ]
}

/// The scenes of Algorithm 1.
pub(crate) fn of_single_pass() -> Vec<Job> {
    vec![
        Job::shape(Shape::Sphere, 500, [64, 64], "single-pass"),
        Job::shape(Shape::Torus, 2_000, [160, 120], "single-pass"),
        Job::shape(Shape::Cluster, 5_000, [320, 240], "single-pass"),
    ]
}

/// The scenes of the pyramid.
pub(crate) fn of_pyramid() -> Vec<Job> {
    vec![
        Job::shape(Shape::Sphere, 300, [64, 64], "pyramid"),
        Job::shape(Shape::Torus, 2_000, [160, 120], "pyramid"),
        Job::shape(Shape::Cluster, 8_000, [301, 203], "pyramid"),
    ]
}
