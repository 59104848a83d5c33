//! Deferred Phong shading.

use super::bug::Bug;
use super::number::{Number, Vector, dot, unit};
use super::view::Shared;
use glam::Vec3;
use splatref::scene::Light;

/// A light in view space: where it is, or whence it comes.
enum Placed {
    Towards(Vector),
    Position(Vector),
}

/// The lights before the camera.
pub(crate) struct Shader<'a> {
    shared: &'a Shared<'a>,
    lights: Vec<(Placed, Vector)>,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(shared: &'a Shared<'a>) -> Self {
        let place = |light: &Light| match *light {
            Light::Directional { towards, color } => {
                (Placed::Towards(unit(shared.direction(towards))), color)
            }
            Light::Headlight { towards, color } => {
                (Placed::Towards(unit(shared.vector(towards.to_array()))), color)
            }
            Light::Point { position, color } => (Placed::Position(shared.point(position)), color),
        };
        let lights = shared.scene.lights.iter().map(|light| {
            let (placed, color) = place(light);
            (placed, shared.vector(color.to_array()))
        });
        Self { shared, lights: lights.collect() }
    }

    /// The colour of a surface at a pixel, whose normal is given in world space.
    pub(crate) fn shade(
        &self,
        pixel: [f32; 2],
        t: f32,
        normal: [f32; 3],
        color: [f32; 3],
    ) -> [f32; 3] {
        let shared = self.shared;
        let material = &shared.scene.material;
        let colored = shared.scene.surfels.color().is_some();
        let s = shared.vector(if colored { color } else { material.color.to_array() });
        if self.lights.is_empty() {
            return s.map(|s| s.value);
        }
        let p = self.point(pixel, shared.number(t));
        let v = self.eye(p);
        // The page of shading has n divided by its length here. The crate only turns it, as the
        // plane of normals holds unit vectors.
        let n = match shared.how.bug {
            Some(Bug::NormalNotTurned) => shared.vector(normal),
            _ => shared.direction(Vec3::from_array(normal)),
        };
        let mut sum = s.map(|s| shared.number(material.ambient) * s);
        for (placed, radiance) in &self.lights {
            let l = match placed {
                Placed::Towards(towards) => *towards,
                Placed::Position(q) => unit([q[0] - p[0], q[1] - p[1], q[2] - p[2]]),
            };
            let facing = dot(n, l);
            if !(facing.value > 0.0) {
                continue;
            }
            let highlight = self.highlight(n, l, v, facing);
            for i in 0..3 {
                let diffuse = (shared.number(material.diffuse) * facing) * s[i];
                sum[i] = sum[i] + radiance[i] * (diffuse + highlight);
            }
        }
        sum.map(|sum| sum.value)
    }

    fn highlight(&self, n: Vector, l: Vector, v: Vector, facing: Number) -> Number {
        let material = &self.shared.scene.material;
        let twice = facing * 2.0;
        let r = [0, 1, 2].map(|i| n[i] * twice - l[i]);
        let cosine = dot(r, v);
        if cosine.value > 0.0 {
            self.shared.number(material.specular) * cosine.pow(material.shininess)
        } else {
            self.shared.number(0.0)
        }
    }

    /// The point at depth t of a pixel, in view space.
    fn point(&self, [x, y]: [f32; 2], t: Number) -> Vector {
        let shared = self.shared;
        let x = (shared.number(x + 0.5) - shared.cx) / shared.fx;
        let y = -((shared.number(y + 0.5) - shared.cy) / shared.fy);
        if shared.perspective { [x * t, y * t, -t] } else { [x, y, -t] }
    }

    /// The direction from a point to the eye.
    fn eye(&self, p: Vector) -> Vector {
        let towards = if self.shared.perspective {
            unit(p.map(|p| -p))
        } else {
            self.shared.vector([0.0, 0.0, 1.0])
        };
        match self.shared.how.bug {
            Some(Bug::SpecularSign) => towards.map(|v| -v),
            _ => towards,
        }
    }
}
