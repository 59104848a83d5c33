//! Discs in world space, in f64: where rays from the eye meet them, and how far all this is from being
//! otherwise.

use crate::oracle::kit::case::Case;
use glam::{DVec3, Vec3};
use splatref::method::blue::Settings;
use splatref::scene::Projection;

/// A disc that may be seen at a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) surfel: u32,
    pub(crate) t: f64,
    /// How far off the depth may be.
    pub(crate) off: f64,
    /// Whether it certainly is there.
    pub(crate) certain: bool,
    /// The square of the distance from its centre, and how far off that may be.
    pub(crate) offset: [f64; 2],
}

/// Discs before a camera.
pub(crate) struct World<'a> {
    case: &'a Case<Settings>,
    discs: Vec<Placed>,
}

struct Placed {
    surfel: u32,
    position: DVec3,
    normal: DVec3,
    radius: f64,
    /// The centre of the square, half its side, and how far off its edges may be.
    center: [f64; 2],
    half: f64,
    off: f64,
    /// Whether it is certain that it is drawn.
    certain: bool,
}

/// What inputs are rounded by, some times over.
const U: f64 = 1e-6;

fn wide(v: Vec3) -> DVec3 {
    v.as_dvec3()
}

impl<'a> World<'a> {
    pub(crate) fn new(case: &'a Case<Settings>) -> Self {
        let of = &case.scene.surfels;
        let discs = (0..of.len()).filter_map(|i| Placed::new(case, i as u32)).collect();
        Self { case, discs }
    }

    /// All that may be seen at a pixel.
    pub(crate) fn hits(&self, x: u32, y: u32) -> Vec<Hit> {
        let camera = &self.case.camera;
        let world = camera.view_from_world.as_dmat4().inverse();
        let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let a = (at[0] - f64::from(camera.cx)) / f64::from(camera.fx);
        let b = (f64::from(camera.cy) - at[1]) / f64::from(camera.fy);
        let (from, along) = match camera.projection {
            Projection::Perspective => (DVec3::ZERO, DVec3::new(a, b, -1.0)),
            Projection::Orthographic => (DVec3::new(a, b, 0.0), DVec3::NEG_Z),
        };
        let (from, along) = (world.transform_point3(from), world.transform_vector3(along));
        let near = f64::from(camera.near);
        let hit = |disc: &Placed| {
            // > 0: inside, by so many pixels.
            let room = (0..2).map(|k| disc.half - (at[k] - disc.center[k]).abs());
            let room = room.fold(f64::INFINITY, f64::min);
            let to = disc.position - from;
            let cosine = along.dot(disc.normal);
            let t = to.dot(disc.normal) / cosine;
            let size = to.length() + from.length() + disc.position.length();
            let off = U * size * along.length() / cosine.abs();
            let distance = (from + along * t - disc.position).length();
            let beyond = distance - disc.radius;
            let slack = off * along.length() + U * disc.radius;
            // NaN and what is not known may be there.
            let never = room < -disc.off || beyond > slack || t < near - off;
            let certain = disc.certain && room > disc.off && beyond < -slack && t > near + off;
            let square = distance * distance;
            let offset = [square, 2.0 * slack * (distance + slack)];
            (!never).then_some(Hit { surfel: disc.surfel, t, off, certain, offset })
        };
        self.discs.iter().filter_map(hit).collect()
    }
}

impl Placed {
    fn new(case: &Case<Settings>, surfel: u32) -> Option<Self> {
        let Case { scene, camera, settings, .. } = case;
        let i = surfel as usize;
        let position = wide(scene.surfels.position()[i]);
        let normal = wide(scene.surfels.normal()[i]);
        let radius = f64::from(scene.surfels.radius()[i]);
        let view = camera.view_from_world.as_dmat4();
        let p = view.transform_point3(position);
        let off = U * (p.length() + position.length());
        let perspective = camera.projection == Projection::Perspective;
        let eye = if perspective { p } else { DVec3::NEG_Z };
        // > 0: its back is seen, as the way from the eye to it goes along its normal.
        let back = eye.dot(view.transform_vector3(normal));
        let unsure = back.abs() < U * (eye.length() + off);
        let near = f64::from(camera.near);
        if -p.z < near - off || (settings.cull && back > 0.0 && !unsure) {
            return None;
        }
        let t = if perspective { -p.z } else { 1.0 };
        let [fx, fy] = [f64::from(camera.fx), f64::from(camera.fy)];
        let center = [f64::from(camera.cx) + fx * p.x / t, f64::from(camera.cy) - fy * p.y / t];
        let own = (radius * (fx * fy).sqrt() / t).max(0.5);
        let side = scene.sides.as_ref().and_then(|sides| sides.side(surfel));
        let half = side.map_or(own, |side| f64::from(side) / 2.0);
        let relative = if perspective { off / t } else { off };
        let reach = center[0].abs() + center[1].abs() + half + 64.0;
        let off = reach * (U + relative) + fx * off / t;
        let certain = -p.z > near + off && !(settings.cull && unsure);
        Some(Self { surfel, position, normal, radius, center, half, off, certain })
    }
}
