//! Where the vertices of triangles are in the picture, each computed once: of a mesh finer than the pixels,
//! most triangles cover no pixel's centre, and their corners alone say so.

use super::SceneProjector;
use super::primitives::placed;
use crate::frame::raster::Triangle;
use crate::frame::{Exec, Rect};
use crate::number::{Exact, Vector3};

/// The places of all vertices in fixed point; of one that is clipped none.
pub(super) struct PlacedVertices(Vec<Option<[i32; 2]>>);

impl PlacedVertices {
    pub(super) fn new<R: Exact>(projector: &SceneProjector<'_, R>, exec: &Exec) -> Self {
        let of = projector.scene.primitives.triangles.vertices();
        let mut places = Vec::new();
        // Without triangles nobody asks.
        let count =
            if projector.scene.primitives.triangles.is_empty() { 0 } else { of.position.len() };
        exec.extend(&mut places, count, |i| {
            let p = projector.points.view.point(Vector3::from_glam(of.position[i]));
            let kept = projector.clip.keeps(&[p]);
            // Held in the guard band, below 2^30.
            kept.then(|| placed(projector, p).0.map(|coordinate| coordinate as i32))
        });
        Self(places)
    }

    /// Whether a triangle of the scene may cover the centre of a pixel.
    pub(super) fn may_cover<R: Exact>(
        &self,
        projector: &SceneProjector<'_, R>,
        triangle: usize,
    ) -> bool {
        let corners = projector.scene.primitives.triangles.corners()[triangle];
        let [Some(a), Some(b), Some(c)] = corners.map(|corner| self.0[corner as usize]) else {
            return true;
        };
        let corners = [a, b, c].map(|place| place.map(i64::from));
        let [width, height] = projector.size;
        let picture = Rect { x0: 0, y0: 0, x1: width, y1: height };
        !Triangle::around(&projector.snap, corners).intersection(&picture).is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::super::primitives::pieces;
    use super::*;
    use crate::frame::raster::Snap;
    use crate::scene::{Camera, Lens, Pose, Primitives, Scene, Surfels, Triangles, Vertices};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    proptest! {
        /// Small triangles, some of them behind the camera, beside the picture and far out.
        #[test]
        fn what_is_passed_over_has_no_pieces(
            middle in prop::array::uniform3(-3.0_f32..3.0),
            spread in prop::sample::select(vec![1e-3_f32, 0.02, 0.3, 1e4]),
            corners in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 60),
            perspective: bool,
            bits in prop::sample::select(vec![0, 8, 12]),
        ) {
            let at = |p: &[f32; 3]| Vec3::from_array(middle) + Vec3::from_array(*p) * spread;
            let vertices = Vertices {
                position: corners.iter().map(at).collect(),
                direction: vec![Vec3::Z; 60],
                radius: vec![0.0; 60],
                color: None,
            };
            let indices = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let (triangles, _) = Triangles::new(vertices, indices).unwrap();
            let primitives = Primitives { triangles, ..Primitives::default() };
            let scene = Scene { primitives, ..Scene::unlit("small", Surfels::none()) };
            let pose = Pose { eye: DVec3::new(0.3, 0.2, 2.0), target: DVec3::ZERO, up: DVec3::Y };
            let lens = if perspective { Lens::FieldOfView(60.0) } else { Lens::Orthographic(3.0) };
            let camera = Camera::new(40, 30, pose, lens).unwrap();
            let snap = Snap::new(bits).unwrap();
            let projector = SceneProjector::<f32>::new(&scene, &camera, false, snap);
            let placed = PlacedVertices::new(&projector, &Exec::sequential());
            for triangle in 0..20 {
                let mut drawn = 0;
                pieces(&projector, triangle, |piece| {
                    piece.for_each(&piece.bounds, |_| drawn += 1);
                });
                prop_assert!(placed.may_cover(&projector, triangle) || drawn == 0);
            }
        }
    }
}
