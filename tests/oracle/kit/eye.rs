//! Vectors and the camera of the oracle, in f64.

use glam::{DVec3, Vec3};
use splatref::scene::{Camera, Projection};

pub(crate) type V3 = [f64; 3];

pub(crate) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scaled(a: V3, s: f64) -> V3 {
    a.map(|v| v * s)
}

pub(crate) fn unit(a: V3) -> V3 {
    scaled(a, 1.0 / dot(a, a).sqrt())
}

pub(crate) fn wide(v: Vec3) -> V3 {
    v.to_array().map(f64::from)
}

/// The camera in f64.
pub(crate) struct Eye {
    rows: [[f64; 4]; 3],
    pub(crate) perspective: bool,
    pub(crate) fx: f64,
    pub(crate) fy: f64,
    pub(crate) cx: f64,
    pub(crate) cy: f64,
    pub(crate) near: f64,
    size: [f64; 2],
}

impl Eye {
    pub(crate) fn new(camera: &Camera) -> Self {
        let row = |i| camera.view_from_world.row(i).to_array().map(f64::from);
        Self {
            rows: [row(0), row(1), row(2)],
            perspective: camera.projection == Projection::Perspective,
            fx: camera.fx.into(),
            fy: camera.fy.into(),
            cx: camera.cx.into(),
            cy: camera.cy.into(),
            near: camera.near.into(),
            size: [camera.width.into(), camera.height.into()],
        }
    }

    /// Between the eyes of a stereo pair, the camera, where it stands, and what is added to its x for
    /// each eye; without a pair, the camera itself and zeros.
    pub(crate) fn middle(camera: &Camera) -> (Self, V3, [f64; 2]) {
        let mut eye = Self::new(camera);
        let own = eye.rows[0][3];
        let Some(other) = camera.other_eye.map(f64::from) else {
            return (eye, camera.eye().to_array(), [0.0; 2]);
        };
        let x = (own + other) / 2.0;
        eye.rows[0][3] = x;
        let mut view = camera.view_from_world.as_dmat4();
        view.w_axis.x = x;
        let at: DVec3 = view.inverse().w_axis.truncate();
        (eye, at.to_array(), [own - x, other - x])
    }

    pub(crate) fn direction(&self, v: V3) -> V3 {
        self.rows.map(|m| m[0] * v[0] + m[1] * v[1] + m[2] * v[2])
    }

    pub(crate) fn point(&self, v: V3) -> V3 {
        self.rows.map(|m| m[0] * v[0] + m[1] * v[1] + m[2] * v[2] + m[3])
    }

    /// The magnitudes that a view-space point is the sum of.
    pub(crate) fn magnitude(&self, v: V3) -> V3 {
        self.rows
            .map(|m| (m[0] * v[0]).abs() + (m[1] * v[1]).abs() + (m[2] * v[2]).abs() + m[3].abs())
    }

    /// Origin and direction of the ray through a point of the picture; the parameter is depth.
    pub(crate) fn ray(&self, x: f64, y: f64) -> (V3, V3) {
        let (u, v) = ((x - self.cx) / self.fx, (self.cy - y) / self.fy);
        if self.perspective { ([0.0; 3], [u, v, -1.0]) } else { ([u, v, 0.0], [0.0, 0.0, -1.0]) }
    }

    /// By how much a sphere about `p` lies beyond the worst side of the view, moved out by `reach`
    /// px: px times depth, > 0 if it is out of sight. And the terms that this is the difference of.
    pub(crate) fn beyond(&self, p: V3, radius: f64, reach: f64) -> [f64; 2] {
        let t = if self.perspective { -p[2] } else { 1.0 };
        let sides = [
            (self.fx, p[0], self.cx),
            (self.fx, -p[0], self.size[0] - self.cx),
            (self.fy, -p[1], self.cy),
            (self.fy, p[1], self.size[1] - self.cy),
        ];
        let excess = sides.map(|(f, along, room)| {
            let slope = if self.perspective { f.hypot(room) } else { f };
            let terms = (f * along).abs() + (room.abs() + reach) * t + radius * slope;
            [-(f * along + room * t) - (radius * slope + reach * t), terms]
        });
        excess.into_iter().fold([f64::NEG_INFINITY; 2], |a, b| if b[0] > a[0] { b } else { a })
    }

    /// The picture of a point.
    pub(crate) fn pixel(&self, p: V3) -> [f64; 2] {
        let t = if self.perspective { -p[2] } else { 1.0 };
        [self.cx + self.fx * p[0] / t, self.cy - self.fy * p[1] / t]
    }
}
