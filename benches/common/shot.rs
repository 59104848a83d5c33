//! The planes of a picture that are measured, drawn or true.

use splatref::Result;
use splatref::frame::{Exec, Frame, NamedPlane, Plane, Samples};
use splatref::scene::{Camera, Scene};
use splatref::shade::phong::Shader;
use splatref::source::Shape;
use splatref::splat::View;

/// Colour (linear RGB), alpha (1 where the scene is seen) and depth (world units).
pub(crate) struct Shot {
    pub(crate) color: Plane<[f32; 3]>,
    pub(crate) alpha: Plane<f32>,
    pub(crate) depth: Plane<f32>,
}

impl Shot {
    /// The planes of a picture.
    pub(crate) fn of(frame: Frame<f32>) -> Self {
        let (width, height) = (frame.width, frame.height);
        let mut shot = Self {
            color: Plane::filled(width, height, [0.0; 3]),
            alpha: Plane::filled(width, height, 0.0),
            depth: Plane::filled(width, height, f32::INFINITY),
        };
        for NamedPlane { name, samples } in frame.planes {
            match (name.as_str(), samples) {
                ("", Samples::Color(plane)) => shot.color = plane,
                ("A", Samples::Scalar(plane)) => shot.alpha = plane,
                ("Z", Samples::Scalar(plane)) => shot.depth = plane,
                _ => {}
            }
        }
        shot
    }

    /// The true picture of a shape under the lights of a scene, lit in f64 and rounded.
    pub(crate) fn truth(
        scene: &Scene,
        shape: &Shape,
        camera: &Camera,
        exec: &Exec,
    ) -> Result<Self> {
        let Frame { width, height, planes } = shape.true_picture(camera)?;
        let (mut color, mut depth, mut normal) = (None, Plane::filled(width, height, 0.0), None);
        for NamedPlane { name, samples } in planes {
            match (name.as_str(), samples) {
                ("", Samples::Color(plane)) => color = Some(plane),
                ("Z", Samples::Scalar(plane)) => depth = plane,
                ("normal", Samples::Vector(plane)) => normal = Some(plane),
                _ => {}
            }
        }
        let Scene { lights, material, .. } = scene;
        let shader = Shader::<f64>::new(View::new(camera), lights, *material);
        let color = shader.shade(&depth, normal.as_ref(), None, color, exec);
        Ok(Self {
            color: color.map(|color| color.map(|v| v as f32)),
            alpha: depth.map(|depth| f32::from(u8::from(depth.is_finite()))),
            depth: depth.map(|depth| *depth as f32),
        })
    }

    /// The colours alone, as a frame.
    pub(crate) fn to_frame(&self) -> Frame<f32> {
        let (width, height) = (self.color.width(), self.color.height());
        let color = NamedPlane { name: String::new(), samples: Samples::Color(self.color.clone()) };
        Frame { width, height, planes: vec![color] }
    }
}
