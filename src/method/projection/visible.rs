//! Find only the nearest triangle of each pixel, without making a [`Piece`] of each triangle: the
//! result of [`super::project`] for triangles. Vertices are placed once, because most triangles of
//! a mesh finer than the pixels cover no pixel's centre.

use super::primitives::{Piece, pieces, placed};
use super::{PixelSample, SceneProjector};
use crate::composite::decide;
use crate::frame::raster::{Snap, Triangle};
use crate::frame::{Exec, NO_ID, Rect};
use crate::number::{Exact, MapInline, Vector3};
use crate::scene::{Camera, Scene};
use std::ops::Range;

/// The maximum number of shares that triangles are drawn in: each share takes a picture, 8 bytes a
/// pixel in `f32`.
pub(crate) const SHARES: usize = 8;

/// The triangles of a scene that has nothing else, before a camera; both sides are seen.
pub(crate) struct VisibleTriangles<'a, R: Exact> {
    projector: SceneProjector<'a, R>,
}

/// Depth and id of the nearest triangle; +inf and [`NO_ID`] where there is none.
pub(crate) type Foremost<R> = (R, u32);

/// A vertex that is not clipped: its place in fixed point, m, and its position in view space.
struct Placed<R> {
    at: [i32; 2],
    m: R,
    z: R,
}

impl<'a, R: Exact> VisibleTriangles<'a, R> {
    pub(crate) fn new(scene: &'a Scene, camera: &Camera, snap: Snap) -> Self {
        Self { projector: SceneProjector::new(scene, camera, false, snap) }
    }

    /// The nearest triangle of each pixel, row by row, as in [`super::project`].
    pub(crate) fn foremost(&self, exec: &Exec) -> Vec<Foremost<R>> {
        let [width, height] = self.projector.size;
        let pixels = width as usize * height as usize;
        let vertices = self.vertices(exec);
        let count = self.projector.scene.primitives.triangles.len();
        let shares = exec.threads().min(SHARES);
        let ranges = (0..shares).map(|i| count * i / shares..count * (i + 1) / shares);
        let mut pictures = exec.ordered(ranges.collect(), |range| {
            let mut picture = vec![(R::INFINITY, NO_ID); pixels];
            self.draw(range, &vertices, &mut picture);
            picture
        });
        let first = pictures.remove(0);
        let mut joined = Vec::new();
        exec.extend(&mut joined, pixels, |i| {
            // Ids of a later share are higher, so the earlier share wins a tie.
            let nearer = |kept: Foremost<R>, later: &Vec<Foremost<R>>| {
                if decide::before(later[i].0, kept.0) { later[i] } else { kept }
            };
            pictures.iter().fold(first[i], nearer)
        });
        joined
    }

    /// The sample that [`super::project`] keeps of a triangle at a pixel, and the weights c of the
    /// corners there, see [`super::primitives`]; none if the triangle does not cover the pixel.
    #[inline]
    pub(crate) fn sample(&self, id: u32, pixel: (u32, u32)) -> Option<(PixelSample<R>, [R; 3])> {
        let (mut nearest, mut found) = (R::INFINITY, None);
        // Snapping the corners can turn a piece of a clipped triangle over another piece.
        pieces(&self.projector, id as usize, |piece: Piece<R>| {
            piece.for_each(&Rect::pixel(pixel), |at| {
                if found.is_none() || decide::before(-at.p.z, nearest) {
                    nearest = -at.p.z;
                    found = Some((piece.sample(&self.projector, &at), at.c));
                }
            });
        });
        found
    }

    fn vertices(&self, exec: &Exec) -> Vec<Option<Placed<R>>> {
        let position = &self.projector.scene.primitives.triangles.vertices().position;
        let mut vertices = Vec::with_capacity(position.len());
        exec.extend(&mut vertices, position.len(), |i| {
            let p = self.projector.points.view.point(Vector3::from_glam(position[i]));
            self.projector.clip.keeps(&[p]).then(|| {
                let (at, m) = placed(&self.projector, p);
                // Held in the guard band, below 2^30.
                Placed { at: at.map_inline(|coordinate| coordinate as i32), m, z: p.z }
            })
        });
        vertices
    }

    /// Draws triangles over samples that have lower ids.
    fn draw(
        &self,
        triangles: Range<usize>,
        vertices: &[Option<Placed<R>>],
        picture: &mut [Foremost<R>],
    ) {
        let projector = &self.projector;
        let [width, height] = projector.size;
        let whole = Rect { x0: 0, y0: 0, x1: width, y1: height };
        let mut keep = |x: u32, y: u32, id: u32, depth: R| {
            let kept = &mut picture[y as usize * width as usize + x as usize];
            if decide::before(depth, kept.0) {
                *kept = (depth, id);
            }
        };
        for id in triangles {
            let corners = projector.scene.primitives.triangles.corners()[id];
            let [Some(a), Some(b), Some(c)] =
                corners.map_inline(|corner| vertices[corner as usize].as_ref())
            else {
                // A triangle with a clipped corner takes the general way, piece by piece.
                pieces(projector, id, |piece| {
                    piece.for_each(&whole, |at| keep(at.x, at.y, id as u32, -at.p.z));
                });
                continue;
            };
            let places = [a, b, c].map_inline(|vertex| vertex.at.map_inline(i64::from));
            let around = Triangle::around(&projector.snap, places).intersection(&whole);
            if around.is_empty() {
                continue;
            }
            let Some(triangle) = Triangle::new(&projector.snap, places) else { continue };
            let area = R::from_i64(triangle.area());
            triangle.for_each(&around, |x, y, w| {
                // As for a piece that is the whole triangle: its c is b.
                let q = [(w[0], a), (w[1], b), (w[2], c)];
                let q = q.map_inline(|(w, vertex)| R::from_i64(w) / area * vertex.m);
                let sum = (q[0] + q[1]) + q[2];
                let [u, v, w] = q.map_inline(|q| q / sum);
                keep(x, y, id as u32, -((a.z * u + b.z * v) + c.z * w));
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::project;
    use super::*;
    use crate::index::Index;
    use crate::method::Job;
    use crate::scene::{Lens, Pose, Primitives, Surfels, Triangles, Vertices};
    use glam::{DVec3, Vec3};
    use proptest::prelude::*;

    /// Triangles; some reach behind the camera, beside the picture and far out.
    fn scene(corners: &[[f32; 3]], middle: [f32; 3], spread: f32) -> Scene {
        let at = |p: &[f32; 3]| Vec3::from_array(middle) + Vec3::from_array(*p) * spread;
        let n = corners.len();
        let vertices = Vertices {
            position: corners.iter().map(at).collect(),
            direction: (0..n).map(|i| Vec3::new(1.0, i as f32, 2.0).normalize()).collect(),
            radius: vec![0.0; n],
            color: Some((0..n).map(|i| Vec3::splat(i as f32 / 64.0)).collect()),
            ..Vertices::default()
        };
        // Shared corners, triangles twice, and some without area.
        let n = n as u32;
        let indices =
            (0..n).map(|i| [i, (i * 7 + 1) % n, (i * i) % n]).chain([[0, 1, 2], [0, 1, 2]]);
        let (triangles, _) = Triangles::new(vertices, indices.collect()).unwrap();
        let primitives = Primitives { triangles, ..Primitives::default() };
        Scene { primitives, ..Scene::unlit("some", Surfels::none()) }
    }

    fn same<R: Exact>(scene: &Scene, camera: &Camera, snap: Snap) -> Result<usize, TestCaseError> {
        let triangles = VisibleTriangles::<R>::new(scene, camera, snap);
        let (exec, index) = (Exec::sequential(), Index::default());
        let plain = project::<R>(&Job::new(scene, &index, camera, &exec), false, snap).unwrap();
        let mut seen = 0;
        for threads in [1, 3] {
            let found = triangles.foremost(&Exec::new(threads, 16).unwrap());
            for (i, sample) in plain.samples.values().iter().enumerate() {
                prop_assert_eq!((sample.depth, sample.id), found[i]);
                if sample.id != NO_ID {
                    let pixel = (i as u32 % camera.width, i as u32 / camera.width);
                    let (own, c) = triangles.sample(sample.id, pixel).unwrap();
                    prop_assert_eq!(&own, sample);
                    prop_assert!(((c[0] + c[1]) + c[2] - R::ONE).to_f64().abs() < 1e-6);
                    seen += 1;
                }
            }
        }
        Ok(seen)
    }

    proptest! {
        #[test]
        fn the_nearest_is_that_of_the_projection(
            middle in prop::array::uniform3(-2.0_f32..2.0),
            spread in prop::sample::select(vec![0.02_f32, 0.3, 2.0, 1e4, 3e38]),
            corners in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 3..30),
            perspective: bool,
            bits in prop::sample::select(vec![0, 8, 12]),
        ) {
            let scene = scene(&corners, middle, spread);
            let pose = Pose { eye: DVec3::new(0.3, 0.2, 2.0), target: DVec3::ZERO, up: DVec3::Y };
            let lens = if perspective { Lens::FieldOfView(60.0) } else { Lens::Orthographic(3.0) };
            let camera = Camera::new(40, 30, pose, lens).unwrap();
            let snap = Snap::new(bits).unwrap();
            same::<f32>(&scene, &camera, snap)?;
            same::<f64>(&scene, &camera, snap)?;
        }
    }

    #[test]
    fn something_is_seen() {
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.2], [0.0, 1.0, -0.2], [0.3, 0.3, 0.5]];
        let scene = scene(&corners, [0.0; 3], 1.0);
        let pose = Pose { eye: DVec3::new(0.3, 0.2, 3.0), target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(40, 30, pose, Lens::FieldOfView(60.0)).unwrap();
        assert!(same::<f32>(&scene, &camera, Snap::default()).unwrap() > 200);
    }
}
