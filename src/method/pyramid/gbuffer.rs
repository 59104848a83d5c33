//! What the picture is shaded from: the planes that the definition and the fast path both leave.

use crate::frame::{Frame, NamedPlane, Plane, Samples};
use crate::method::projection::Has;
use crate::scene::{Camera, Scene};

/// What is seen, pixel by pixel; vectors in world space.
pub(super) struct GBuffer<R> {
    /// See [`crate::method::projection::Kind`].
    pub(super) kind: Plane<u8>,
    /// 1 where something is seen, else 0.
    pub(super) alpha: Plane<R>,
    /// Depth t; +inf where nothing is seen.
    pub(super) depth: Plane<R>,
    /// Unit normals, if there is light or they were asked for.
    pub(super) normal: Option<Plane<[R; 3]>>,
    /// Unit tangents of tubes, the null vector elsewhere; if the scene has tubes.
    pub(super) tangent: Option<Plane<[R; 3]>>,
    /// Colours, if `colored`; else anything.
    pub(super) color: Plane<[R; 3]>,
    /// Whether the scene has colours.
    pub(super) colored: bool,
}

impl GBuffer<f32> {
    /// What a scene needs, in the memory of an earlier frame of the same size; the values are any.
    pub(super) fn new(scene: &Scene, camera: &Camera, earlier: Option<Frame<f32>>) -> Self {
        let (width, height) = (camera.width, camera.height);
        let has = Has::of(scene);
        let mut target = Self {
            kind: Plane::filled(0, 0, 0),
            alpha: Plane::filled(0, 0, 0.0),
            depth: Plane::filled(0, 0, 0.0),
            normal: None,
            tangent: None,
            color: Plane::filled(0, 0, [0.0; 3]),
            colored: has.color,
        };
        let earlier = earlier.filter(|frame| (frame.width, frame.height) == (width, height));
        for NamedPlane { name, samples } in earlier.into_iter().flat_map(|frame| frame.planes) {
            match (name.as_str(), samples) {
                ("kind", Samples::Count(plane)) => target.kind = plane,
                ("A", Samples::Scalar(plane)) => target.alpha = plane,
                ("Z", Samples::Scalar(plane)) => target.depth = plane,
                ("normal", Samples::Vector(plane)) => target.normal = Some(plane),
                ("tangent", Samples::Vector(plane)) => target.tangent = Some(plane),
                ("", Samples::Color(plane)) => target.color = plane,
                _ => {}
            }
        }
        fit(&mut target.kind, camera, 0);
        fit(&mut target.alpha, camera, 0.0);
        fit(&mut target.depth, camera, 0.0);
        fit(&mut target.color, camera, [0.0; 3]);
        let vectors = |plane: Option<Plane<[f32; 3]>>, wanted: bool| {
            let plane = plane.filter(|_| wanted);
            wanted.then(|| plane.unwrap_or_else(|| Plane::filled(width, height, [0.0; 3])))
        };
        target.normal = vectors(target.normal, !scene.lights.is_empty());
        target.tangent = vectors(target.tangent, has.tangent);
        target
    }
}

/// Replaces a plane that is not of the size of the picture.
fn fit<T: Clone>(plane: &mut Plane<T>, camera: &Camera, value: T) {
    if plane.width() != camera.width {
        *plane = Plane::filled(camera.width, camera.height, value);
    }
}
