//! The camera of a scene file: the chosen parts, completed so that it shows the scene.

use super::{DEFAULT_FIELD_OF_VIEW, DEFAULT_SIDE, DEFAULT_SIZE, MOST_FRAMES, Model};
use super::{SceneFile, Source, Views};
use crate::error::{Error, Result};
use crate::io::cameras::View;
use crate::scene::camera::clip::from_clip;
use crate::scene::{Camera, CameraMotion, Convention, Intrinsics, Lens, Pose, PoseMatrix, Sphere};
use crate::scene::{Scene, Similarity, Stereo, Turntable};
use crate::source::Shape;
use glam::{DMat4, DVec3, DVec4};
use std::path::Path;

/// The chosen parts of a camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraChoice {
    /// Width and height in pixels.
    pub size: Option<[u32; 2]>,
    /// See [`Pose`].
    pub eye: Option<DVec3>,
    /// See [`Pose`]. A turntable without it turns around the middle of the scene.
    pub target: Option<DVec3>,
    /// See [`Pose`]; also the axis of a turntable.
    pub up: Option<DVec3>,
    /// Keys over frames, in place of these three.
    pub motion: Option<CameraMotion>,
    /// The view matrix, in place of the pose: [`Camera::view_from_world`] before it is rounded.
    pub view: Option<DMat4>,
    /// The view matrix takes the coordinates of the files minus this; it is the [`Scene::offset`] of
    /// the picture that the camera comes from, and 0 for matrices of other programs.
    pub offset: DVec3,
    /// The opening of the lens.
    pub lens: Option<Lens>,
    /// Focal lengths and principal point, in place of the lens. They belong to a size of their own;
    /// for another size they are [resized](Intrinsics::resized).
    pub intrinsics: Option<Intrinsics>,
    /// The near plane.
    pub near: Option<f64>,
    /// The far plane of another renderer. It changes no picture, because splatref has none.
    pub far: Option<f64>,
    /// The cameras of a file, in place of all these but the size and the planes.
    pub views: Option<Views>,
    /// The number of frames in which the camera goes once around the scene, see
    /// [`crate::scene::camera::turntable`].
    pub turntable: Option<u32>,
    /// A [stereo pair](crate::scene::camera::stereo) around the camera, or one eye of it.
    pub stereo: Option<Stereo>,
    /// [`Camera::other_eye`] beside a view matrix, before it is rounded.
    pub other_eye: Option<f64>,
}

/// Matrices of another program, and their convention.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matrices {
    /// The pose.
    pub pose: Option<PoseMatrix>,
    /// The projection matrix.
    pub projection: Option<DMat4>,
    /// Whose numbers they are.
    pub convention: Option<Convention>,
}

impl Matrices {
    /// Puts them into a choice: the view matrix, and from a projection matrix the intrinsics and
    /// the planes; a near plane that was chosen stays.
    ///
    /// # Errors
    /// One line that says what is wrong.
    pub fn apply(&self, choice: &mut CameraChoice) -> std::result::Result<(), String> {
        let Self { pose, projection, convention } = *self;
        if pose.is_none() && projection.is_none() && convention.is_none() {
            return Ok(());
        }
        let pose = pose.ok_or(
            "camera: a convention and a projection matrix belong to a pose; give world to camera, \
             or camera to world",
        )?;
        let convention = convention.ok_or(
            "camera: the matrices need a convention; give opencv, opengl or blender, or for a \
             projection matrix opengl, vulkan or d3d",
        )?;
        let refused = |what| format!("camera: {what}");
        let Some(projection) = projection else {
            choice.view = Some(pose.view(convention).map_err(refused)?);
            return Ok(());
        };
        if choice.lens.is_some() || choice.intrinsics.is_some() {
            let what =
                "camera: a projection matrix has the lens; remove the lens or the intrinsics";
            return Err(what.into());
        }
        let size = choice.picture_size();
        let camera = from_clip(&projection, convention, size, pose).map_err(refused)?;
        choice.view = Some(camera.view);
        choice.intrinsics = Some(camera.intrinsics);
        choice.near = choice.near.or(Some(camera.near));
        choice.far = choice.far.or(Some(camera.far)).filter(|far| far.is_finite());
        Ok(())
    }
}

/// The camera of each frame of a sequence.
#[derive(Clone, Debug)]
pub(super) enum CameraPath {
    /// Poses between keys, under a lens, in a scene with this offset.
    Keys(CameraMotion, Box<CameraChoice>, Lens, DVec3),
    /// One camera a frame.
    Views(Vec<Camera>),
    /// Around the scene.
    Turntable(Turntable),
}

impl CameraPath {
    /// The camera in a frame.
    pub(super) fn at(&self, frame: u32) -> Result<Camera> {
        match self {
            Self::Views(all) => Ok(all[frame as usize % all.len()]),
            Self::Turntable(turntable) => Ok(turntable.at(frame)),
            Self::Keys(motion, choice, lens, offset) => {
                let [width, height] = choice.picture_size();
                let pose = motion.at(frame).relative_to(*offset);
                choice.open(Camera::new(width, height, pose, *lens)?)
            }
        }
    }
}

impl CameraChoice {
    /// Checks that no two parts exclude each other.
    ///
    /// # Errors
    /// One line that says what to remove.
    pub fn check(&self) -> std::result::Result<(), String> {
        let posed = self.eye.is_some() || self.motion.is_some();
        let aimed = (self.target.is_some() || self.up.is_some()) && self.turntable.is_none();
        if self.view.is_some() && (posed || aimed) {
            return Err(
                "camera: a matrix replaces eye, target, up and keys; remove one or the other \
                        (a turntable may have target and up beside it)"
                    .into(),
            );
        }
        if self.lens.is_some() && self.intrinsics.is_some() {
            return Err(
                "camera: intrinsics replace fov, focal and ortho; remove one or the other".into()
            );
        }
        let own = posed || aimed || self.view.is_some();
        if self.views.is_some() && (own || self.lens.is_some() || self.intrinsics.is_some()) {
            return Err(
                "camera: a camera file has the pose and the lens; remove the others, or the file"
                    .into(),
            );
        }
        self.stereo.map_or(Ok(()), Stereo::check)?;
        if self.other_eye.is_some() && self.view.is_none() {
            return Err("camera: other_eye belongs to view_from_world; remove it".into());
        }
        if let Some(frames) = self.turntable {
            if !(1..=MOST_FRAMES).contains(&frames) {
                return Err(format!(
                    "camera: a turntable of {frames} frames; give 1 to {MOST_FRAMES}"
                ));
            }
            if self.motion.is_some() {
                return Err("camera: a turntable and keys both move the camera; remove one".into());
            }
            if self.views.as_ref().is_some_and(|views| views.view.is_none()) {
                return Err("camera: a turntable turns one camera; choose one with view".into());
            }
        }
        Ok(())
    }

    /// The number of frames that the camera asks for, if it does.
    pub(super) fn frames(&self) -> Option<u32> {
        let views =
            self.views.as_ref().filter(|views| views.view.is_none() && !views.all.is_empty());
        // A file has at most MOST_FRAMES views.
        self.turntable.or_else(|| views.map(|views| views.all.len() as u32))
    }

    /// Whether the camera itself makes a sequence: a turntable, or several views.
    #[must_use]
    pub fn is_sequence(&self) -> bool {
        self.turntable.is_some() || self.frames().is_some_and(|frames| frames > 1)
    }

    fn picture_size(&self) -> [u32; 2] {
        let own = self.intrinsics.map(|intrinsics| intrinsics.size);
        self.size.or(own).unwrap_or(DEFAULT_SIZE)
    }

    /// The camera with the chosen intrinsics and near plane in place of its own.
    fn open(&self, mut camera: Camera) -> Result<Camera> {
        if let Some(intrinsics) = &self.intrinsics {
            camera = intrinsics.resized(camera.size()).on(camera);
        }
        if let Some(near) = self.near {
            camera.near = near as f32;
        }
        camera.check()?;
        Ok(camera)
    }
}

impl SceneFile {
    /// The camera in the frame to draw: the chosen parts, completed so that the camera shows
    /// `scene`, which is this scene after loading.
    ///
    /// A scene of one untransformed shape has the shape's own pose and lens. Any other scene is
    /// framed from [`DEFAULT_SIDE`], (0.5, 0.375, 1), see [`Camera::framing`], with a vertical field
    /// of view of [`DEFAULT_FIELD_OF_VIEW`], 34 degrees, unless a lens is chosen. If only the eye was
    /// chosen, it looks at the middle of [`Scene::bounding_sphere`]. If only the target was chosen, the camera looks
    /// from [`DEFAULT_SIDE`] at a sphere of that radius around the target.
    ///
    /// Chosen intrinsics replace the lens after the camera is placed; it is placed with
    /// [`Intrinsics::lens`]. A camera with a chosen view matrix and without a chosen near plane has
    /// its near plane at d / 1024, computed in f64. d is the distance from [`Camera::eye`] to the
    /// middle of the sphere; if that is 0, the radius of the sphere; and if that is 0 too, 1.
    ///
    /// Cameras are in the coordinates of the files. In a scene with an offset O, a view matrix with
    /// the elements Lij and the last column t gets the last column u in f64, before it is rounded; A
    /// is [`CameraChoice::offset`], and d = O - A:
    ///
    /// ```text
    ///   ui = ti + ((Li0 d0 + Li1 d1) + Li2 d2)             t itself if d is 0
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Camera::new`], and if a view has no size. Else as [`Stereo::camera`].
    pub fn camera(&self, scene: &Scene) -> Result<Camera> {
        let camera = match self.camera_path(scene)? {
            Some(path) => path.at(self.frame)?,
            None => self.still_camera(scene)?,
        };
        self.camera.stereo.map_or(Ok(camera), |stereo| stereo.camera(camera))
    }

    /// The camera over the frames, if it moves.
    pub(super) fn camera_path(&self, scene: &Scene) -> Result<Option<CameraPath>> {
        let choice = &self.camera;
        choice.check().map_err(Error::Invalid)?;
        if let Some(frames) = choice.turntable {
            let first = self.still_camera(scene)?;
            let target = choice.target.map(|target| target - scene.offset);
            let center = target.unwrap_or_else(|| scene.bounding_sphere().center);
            let axis = choice.up.unwrap_or(DVec3::Y);
            return Ok(Some(CameraPath::Turntable(Turntable::new(first, center, axis, frames)?)));
        }
        if let Some(views) = choice.views.as_ref().filter(|views| views.view.is_none()) {
            let place = Place::of_scene(scene);
            let all = views.all.iter().map(|view| self.seen_from(view, &views.path, &place));
            let all = all.collect::<Result<Vec<_>>>()?;
            return if all.is_empty() {
                Err(not_read(views))
            } else {
                Ok(Some(CameraPath::Views(all)))
            };
        }
        let keys = |motion: &CameraMotion| {
            let choice = Box::new(choice.clone());
            CameraPath::Keys(motion.clone(), choice, self.lens(), scene.offset)
        };
        Ok(choice.motion.as_ref().map(keys))
    }

    /// The camera without its motion; of a camera file, the chosen view.
    pub(super) fn still_camera(&self, scene: &Scene) -> Result<Camera> {
        let choice = &self.camera;
        if let Some(views) = &choice.views {
            let view = views.chosen.and_then(|chosen| views.all.get(chosen));
            let view = view.ok_or_else(|| not_read(views))?;
            return self.seen_from(view, &views.path, &Place::of_scene(scene));
        }
        let [width, height] = choice.picture_size();
        let camera = match choice.view {
            Some(view) => {
                let place = Place::of_scene(scene);
                let CameraChoice { offset, other_eye, .. } = *choice;
                place.camera(view, offset, other_eye, [width, height], self.lens())?
            }
            None => self.posed(scene, [width, height])?,
        };
        choice.open(camera)
    }

    /// The camera of a view of a file.
    fn seen_from(&self, view: &View, path: &Path, place: &Place) -> Result<Camera> {
        let CameraChoice { size, near, .. } = self.camera;
        let intrinsics = view.intrinsics(size).map_err(|what| Error::format(path, what))?;
        let choice = CameraChoice {
            size: size.or(Some(intrinsics.size)),
            intrinsics: Some(intrinsics),
            near: near.or(view.near),
            ..CameraChoice::default()
        };
        let (size, lens) = (choice.picture_size(), intrinsics.lens());
        let camera = place.camera(view.view, view.offset, view.other_eye, size, lens);
        let camera = camera.and_then(|camera| choice.open(camera));
        camera.map_err(|error| Error::format(path, format!("view {}: {error}", view.name)))
    }

    /// The camera at the chosen eye, looking at the chosen target.
    fn posed(&self, scene: &Scene, [width, height]: [u32; 2]) -> Result<Camera> {
        let CameraChoice { eye, target, up, .. } = self.camera;
        // Poses are in the coordinates of the files.
        let [eye, target] = [eye, target].map(|place| place.map(|place| place - scene.offset));
        let (shape, lens) = (self.shape(), self.lens());
        if let (Some(eye), Some(target)) = (eye, target) {
            let pose = Pose { eye, target, up: up.unwrap_or(DVec3::Y) };
            return Camera::new(width, height, pose, lens);
        }
        let pose = match shape {
            Some(shape) => shape.default_pose(),
            None => {
                let Sphere { center: middle, radius } = scene.bounding_sphere();
                let target = target.unwrap_or(middle);
                let framed = Camera::framing(
                    width,
                    height,
                    Sphere { center: target, radius },
                    DEFAULT_SIDE,
                    lens,
                )?;
                if eye.is_none() && up.is_none() {
                    return Ok(framed);
                }
                Pose { eye: framed.eye(), target, up: DVec3::Y }
            }
        };
        let pose = Pose {
            eye: eye.unwrap_or(pose.eye),
            target: target.unwrap_or(pose.target),
            up: up.unwrap_or(pose.up),
        };
        Camera::new(width, height, pose, lens)
    }

    /// The shape, if the scene is nothing but one untransformed shape.
    fn shape(&self) -> Option<&Shape> {
        match self.models.as_slice() {
            [Model { source: Source::Shape { shape, .. }, transform, .. }]
                if *transform == Similarity::IDENTITY && self.objects.is_empty() =>
            {
                Some(shape)
            }
            _ => None,
        }
    }

    /// The lens that [`SceneFile::camera`] places the camera with.
    fn lens(&self) -> Lens {
        let CameraChoice { lens, intrinsics, .. } = &self.camera;
        let given = || {
            let intrinsics = (*intrinsics)?.resized(self.camera.picture_size());
            Some(intrinsics.lens())
        };
        let own = || self.shape().map(Shape::default_lens);
        lens.or_else(given).or_else(own).unwrap_or(Lens::FieldOfView(DEFAULT_FIELD_OF_VIEW))
    }
}

/// What a camera with a given view matrix must know about the scene.
struct Place {
    /// The sphere around the scene.
    sphere: Sphere,
    offset: DVec3,
}

impl Place {
    fn of_scene(scene: &Scene) -> Self {
        Self { sphere: scene.bounding_sphere(), offset: scene.offset }
    }

    /// The camera with this view matrix, its offset and its other eye, and with the near plane that
    /// [`SceneFile::camera`] states.
    fn camera(
        &self,
        mut view: DMat4,
        offset: DVec3,
        mut other_eye: Option<f64>,
        [width, height]: [u32; 2],
        lens: Lens,
    ) -> Result<Camera> {
        let d = self.offset - offset;
        // No arithmetic without a difference, so that the matrix keeps its bits.
        if d != DVec3::ZERO {
            let moved = |i: usize| {
                let row = view.row(i);
                row.w + ((row.x * d.x + row.y * d.y) + row.z * d.z)
            };
            let row = view.row(0);
            other_eye = other_eye.map(|w| w + ((row.x * d.x + row.y * d.y) + row.z * d.z));
            view.w_axis = DVec4::new(moved(0), moved(1), moved(2), 1.0);
        }
        // Only the opening and the size of this camera stay.
        let pose = Pose { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y };
        let opened = Camera::new(width, height, pose, lens)?;
        let other_eye = other_eye.map(|x| x as f32);
        let mut camera = Camera { view_from_world: view.as_mat4(), other_eye, ..opened };
        let Sphere { center: middle, radius } = self.sphere;
        let distance = (middle - camera.eye()).length();
        let scale = [distance, radius].into_iter().find(|&length| length > 0.0);
        camera.near = (scale.unwrap_or(1.0) / 1024.0) as f32;
        camera.check()?;
        Ok(camera)
    }
}

fn not_read(views: &Views) -> Error {
    Error::format(
        &views.path,
        "the cameras of this file are not read; open the scene with SceneFile::read",
    )
}
