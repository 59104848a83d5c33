//! The box and the sphere around a whole scene: surfels and primitives, or Gaussians.

use super::{Primitives, Scene, Surfels};
use glam::{DVec3, Vec3};

impl Scene {
    /// The corners of the smallest axis-parallel box around all positions: the surfels' positions,
    /// and the vertices that a primitive uses; or the centres of Gaussians. Both corners are the
    /// origin if the scene is empty.
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match (&self.gaussians, &self.excerpt) {
            (Some(gaussians), _) => gaussians.bounds(),
            (None, Some(excerpt)) => excerpt.bounds,
            (None, None) => corners(&self.surfels, &self.primitives),
        }
    }

    /// A sphere around everything, in f64. If there are only surfels, it is their sphere, see
    /// [`super::Surfels::bounding_sphere`]. Otherwise it has the middle of [`Scene::bounds`] as its
    /// centre; its radius is the largest distance from there to a surfel plus its reach or to a
    /// used vertex plus its radius. A scene of objects uses [`super::Objects::bounding_sphere`]. Of
    /// Gaussians it reaches three standard deviations beyond their centres.
    #[must_use]
    pub fn bounding_sphere(&self) -> Sphere {
        match (&self.objects, &self.gaussians) {
            (Some(objects), _) => objects.bounding_sphere(),
            (None, Some(gaussians)) => {
                let (low, high) = gaussians.bounds();
                let center = (low.as_dvec3() + high.as_dvec3()) / 2.0;
                Sphere { center, radius: gaussians.reach(center) }
            }
            (None, None) => sphere(&self.surfels, &self.primitives),
        }
    }
}

/// A sphere, in the coordinates of what it surrounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sphere {
    /// The middle.
    pub center: DVec3,
    /// The radius.
    pub radius: f64,
}

/// The box and the sphere around surfels and primitives together, by the rules of
/// [`Scene::bounds`] and [`Scene::bounding_sphere`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// The corner of the box with the least coordinates.
    pub low: Vec3,
    /// The other corner.
    pub high: Vec3,
    /// The radius of the sphere around the middle of the box, (low + high) / 2 in f64.
    pub radius: f64,
}

impl Bounds {
    /// The bounds of surfels and primitives.
    #[must_use]
    pub fn around(surfels: &Surfels, primitives: &Primitives) -> Self {
        let (low, high) = corners(surfels, primitives);
        // Adding 0 turns -0 into 0.
        let (low, high) = (low + Vec3::ZERO, high + Vec3::ZERO);
        Self { low, high, radius: sphere(surfels, primitives).radius }
    }

    /// The box, and the sphere around it.
    pub(super) fn corners_and_sphere(&self) -> ([DVec3; 2], Sphere) {
        let corners = [self.low.as_dvec3(), self.high.as_dvec3()];
        (corners, Sphere { center: (corners[0] + corners[1]) / 2.0, radius: self.radius })
    }
}

/// See [`Scene::bounds`].
pub(super) fn corners(surfels: &Surfels, primitives: &Primitives) -> (Vec3, Vec3) {
    let surfels = (!surfels.is_empty()).then(|| surfels.bounds());
    let vertices = primitives.used().map(|(position, _)| (position, position));
    let all = surfels.into_iter().chain(vertices);
    all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
}

/// See [`Scene::bounding_sphere`].
pub(super) fn sphere(surfels: &Surfels, primitives: &Primitives) -> Sphere {
    if primitives.is_empty() {
        return surfels.bounding_sphere();
    }
    let (low, high) = corners(surfels, primitives);
    let center = (low.as_dvec3() + high.as_dvec3()) / 2.0;
    let reach = |(position, radius): (Vec3, f32)| {
        (position.as_dvec3() - center).length() + f64::from(radius)
    };
    let most = |most, far| if far > most { far } else { most };
    Sphere { center, radius: primitives.used().map(reach).fold(surfels.reach(center), most) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cloud, Polylines, Primitives, Surfels, Triangles, Vertices};

    fn vertices(position: &[Vec3], radius: f32) -> Vertices {
        let n = position.len();
        Vertices {
            position: position.to_vec(),
            direction: vec![Vec3::Z; n],
            radius: vec![radius; n],
            color: None,
            ..Vertices::default()
        }
    }

    fn scene(surfels: Surfels) -> Scene {
        let nowhere = Vec3::splat(f32::NAN);
        let flat = [Vec3::ZERO, 2.0 * Vec3::X, Vec3::new(2.0, 4.0, 0.0), nowhere, Vec3::ONE * 99.0];
        let (triangles, _) = Triangles::new(vertices(&flat, 0.0), vec![[0, 1, 2]]).unwrap();
        let line = [Vec3::new(1.0, 2.0, -3.0), Vec3::new(1.0, 2.0, 5.0)];
        let (tubes, _) = Polylines::new(vertices(&line, 0.5), vec![[0, 1]]).unwrap();
        let primitives = Primitives { triangles, tubes, ..Primitives::default() };
        Scene { primitives, ..Scene::unlit("a", surfels) }
    }

    #[test]
    fn vertices_that_are_used_are_inside() {
        let alone = scene(Surfels::none());
        let corners = (Vec3::new(0.0, 0.0, -3.0), Vec3::new(2.0, 4.0, 5.0));
        assert_eq!(alone.bounds(), corners, "the origin of no surfels is not");
        // Around (1, 2, 1): corners of the triangle at sqrt(6), the ends of the tube at 4 plus 0.5.
        assert_eq!(
            alone.bounding_sphere(),
            Sphere { center: DVec3::new(1.0, 2.0, 1.0), radius: 4.5 }
        );
    }

    #[test]
    fn surfels_count_with_their_reach() {
        let cloud = Cloud {
            position: vec![Vec3::new(1.0, 2.0, 1.0)],
            normal: Some(vec![Vec3::Z]),
            radius: Some(vec![7.0]),
            ..Cloud::default()
        };
        let (surfels, _) = Surfels::new(cloud).unwrap();
        let mut both = scene(surfels);
        assert_eq!(
            both.bounding_sphere(),
            Sphere { center: DVec3::new(1.0, 2.0, 1.0), radius: 7.0 }
        );
        both.primitives = Primitives::default();
        assert_eq!(both.bounding_sphere(), both.surfels.bounding_sphere());
        assert_eq!(both.bounds(), both.surfels.bounds());
    }
}
