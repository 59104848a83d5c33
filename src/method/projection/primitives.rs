//! Draw triangles, ribbons and tubes as pixels \[MKC08, sections 4.1, 4.2 and 5.1\].
//!
//! A primitive has two or three corners. The corners of a piece of a primitive are clipped, see
//! [`crate::splat::clip`], placed like the centre of a surfel, see [`super`], and snapped to fixed
//! point. [`crate::frame::raster`] says exactly which pixels a piece covers. A clipped triangle is
//! drawn as the fan of its first corner. `Decided:` with culling a triangle whose corners run
//! clockwise on the screen is dropped; without, its normals are reversed.
//!
//! **Perspective-correct weights.** At a pixel the corners i of a piece have exact barycentric
//! weights `w_i` >= 0 out of w (of a line: den - num and num out of den); each is rounded to the
//! arithmetic. With `W_ik` the weight of corner k of the primitive at corner i of the piece, and
//! `m_i` as for surfels:
//!
//! ```text
//!   q_i = (w_i / w) m_i        b_i = q_i / ((q_0 + q_1) + q_2)
//!   c_k = (b_0 W_0k + b_1 W_1k) + b_2 W_2k
//!   attribute = (c_0 a_0 + c_1 a_1) + c_2 a_2                       two corners: without the third
//! ```
//!
//! The formulas give the position p in view space, the radius, the colour and the direction. The
//! direction is then turned to view space, see [`crate::splat::View::direction`], and divided by
//! its length, `sqrt((x x + y y) + z z)`, component by component (of length 0: the null vector). If
//! other parts of a scene have colours, a primitive without one has the material's. If one
//! primitive visits a pixel twice at equal depth, the first visit stays. The depth is t = -p.z, and
//! rho is computed as for surfels; the centre is the centre of the pixel.
//!
//! - **Triangles** have the radius of their vertices. Without a given radius it is 0, so that they
//!   are not expanded; where a mesh becomes points, its boundary has radii (section 5.2).
//! - **Ribbons** have two sides: where the back is seen (g > 0 at p) the normal is reversed.
//! - **Tubes** have the direction to the camera as normal, -p / |p| (orthographic: (0, 0, 1)), and
//!   keep their tangent. `Decided:` if `a_0 . a_1` < 0, `-a_1` takes the place of `a_1`. A tangent
//!   has no sign, so the tangents of the two corners may be opposite, and the tangents between them
//!   would pass through 0. The comparison is in world space, so that the camera has no part in it.

use super::surfels::{PlacedPoint, PointProjector};
use super::{PixelSample, SampleKind, SceneProjector};
use crate::frame::Rect;
use crate::frame::raster::{Line, Triangle};
use crate::number::{Exact, MapInline, Real, Vector2, Vector3};
use crate::scene::Vertices;
use crate::scene::indexed::Indexed;
use crate::splat::clip::Clipped;
use crate::splat::ellipse;

/// A piece of a primitive on the screen.
#[derive(Debug)]
pub(crate) struct Piece<R> {
    pub(crate) bounds: Rect,
    pub(crate) kind: SampleKind,
    pub(crate) id: u32,
    /// The index of the primitive in its list.
    index: usize,
    back: bool,
    raster: Raster,
    /// m of each corner of the piece.
    m: [R; 3],
    /// W: for each corner of the piece, the weights of the primitive's corners.
    weights: [[R; 3]; 3],
    /// The corners of the primitive in view space.
    p: [Vector3<R>; 3],
}

#[derive(Debug)]
enum Raster {
    Triangle(Triangle),
    Line(Line),
}

/// A pixel of a piece: c and the position there.
pub(crate) struct PiecePixel<R> {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(super) c: [R; 3],
    pub(crate) p: Vector3<R>,
}

/// Calls `draw` for each piece of a primitive that may be seen.
pub(super) fn pieces<R: Exact>(
    projector: &SceneProjector<'_, R>,
    id: usize,
    draw: impl FnMut(Piece<R>),
) {
    let of = &projector.scene.primitives;
    let index = id - projector.scene.surfels.len();
    if index < of.triangles.len() {
        return triangle(&of.triangles, projector, id as u32, index, draw);
    }
    let index = index - of.triangles.len();
    if index < of.ribbons.len() {
        return line(&of.ribbons, SampleKind::Ribbon, projector, id as u32, index, draw);
    }
    let index = index - of.ribbons.len();
    line(&of.tubes, SampleKind::Tube, projector, id as u32, index, draw);
}

/// The corners of a primitive in view space.
pub(crate) fn corners<R: Real, const N: usize>(
    of: &Indexed<N>,
    points: &PointProjector<R>,
    index: usize,
) -> [Vector3<R>; N] {
    let position = &of.vertices().position;
    let mut corners = [Vector3::ZERO; N];
    for (corner, &i) in corners.iter_mut().zip(&of.corners()[index]) {
        *corner = points.view.point(Vector3::from_glam(position[i as usize]));
    }
    corners
}

/// A corner of a piece: its place in fixed point, and m.
pub(super) fn placed<R: Exact>(projector: &SceneProjector<'_, R>, p: Vector3<R>) -> ([i64; 2], R) {
    let PlacedPoint { m, center, .. } = projector.points.place(p);
    ([projector.snap.fixed(center.x), projector.snap.fixed(center.y)], m)
}

fn triangle<R: Exact>(
    of: &Indexed<3>,
    projector: &SceneProjector<'_, R>,
    id: u32,
    index: usize,
    mut draw: impl FnMut(Piece<R>),
) {
    let p = corners(of, &projector.points, index);
    projector.clip.fan(p, |[a, b, c]| {
        let end = |corner: &Clipped<R, 3>| placed(projector, corner.position);
        let (ends, weights) = ([end(a), end(b), end(c)], [a.weights, b.weights, c.weights]);
        if let Some(piece) = triangle_piece(projector, Primitive { id, index }, ends, weights, p) {
            draw(piece);
        }
    });
}

/// Which primitive a piece is of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Primitive {
    /// The id that a picture shows.
    pub(crate) id: u32,
    /// The index among the primitives of its kind.
    pub(crate) index: usize,
}

/// The piece of a triangle whose corners are snapped, each with its m, if it may be seen.
pub(crate) fn triangle_piece<R: Real>(
    projector: &SceneProjector<'_, R>,
    of: Primitive,
    ends: [([i64; 2], R); 3],
    weights: [[R; 3]; 3],
    p: [Vector3<R>; 3],
) -> Option<Piece<R>> {
    let places = [ends[0].0, ends[1].0, ends[2].0];
    let [x1, y1] = projector.size;
    let bounds = Triangle::around(&projector.snap, places);
    let bounds = bounds.intersection(&Rect { x0: 0, y0: 0, x1, y1 });
    // Checked before edges are made, because small triangles often have no centre of a pixel in
    // their bounds.
    if bounds.is_empty() {
        return None;
    }
    let raster = Triangle::new(&projector.snap, places)?;
    triangle_within(projector, of, raster, bounds, ends, weights, p)
}

/// As [`triangle_piece`], drawn in some pixels only.
pub(crate) fn triangle_within<R: Real>(
    projector: &SceneProjector<'_, R>,
    Primitive { id, index }: Primitive,
    raster: Triangle,
    bounds: Rect,
    ends: [([i64; 2], R); 3],
    weights: [[R; 3]; 3],
    p: [Vector3<R>; 3],
) -> Option<Piece<R>> {
    let back = !raster.front();
    if bounds.is_empty() || (projector.points.cull && back) {
        return None;
    }
    let (m, raster) = (ends.map_inline(|(_, m)| m), Raster::Triangle(raster));
    Some(Piece { bounds, kind: SampleKind::Polygon, id, index, back, raster, m, weights, p })
}

fn line<R: Exact>(
    of: &Indexed<2>,
    kind: SampleKind,
    projector: &SceneProjector<'_, R>,
    id: u32,
    index: usize,
    draw: impl FnMut(Piece<R>),
) {
    let p = corners(of, &projector.points, index);
    let Some([a, b]) = projector.clip.segment(p) else { return };
    let ends = [a, b].map_inline(|end| placed(projector, end.position));
    let weights = [a.weights, b.weights];
    line_piece(projector, kind, Primitive { id, index }, ends, weights, p)
        .into_iter()
        .for_each(draw);
}

/// The piece of a ribbon or a tube whose ends are snapped, each with its m, if it may be seen.
pub(crate) fn line_piece<R: Real>(
    projector: &SceneProjector<'_, R>,
    kind: SampleKind,
    Primitive { id, index }: Primitive,
    [(from, from_m), (to, to_m)]: [([i64; 2], R); 2],
    weights: [[R; 2]; 2],
    p: [Vector3<R>; 2],
) -> Option<Piece<R>> {
    let raster = Line::new(&projector.snap, from, to);
    let [width, height] = projector.size;
    let bounds = raster.bounds(width, height);
    let weights = weights.map_inline(|[a, b]| [a, b, R::ZERO]);
    (!bounds.is_empty()).then_some(Piece {
        bounds,
        kind,
        id,
        index,
        back: false,
        raster: Raster::Line(raster),
        m: [from_m, to_m, R::ZERO],
        weights: [weights[0], weights[1], [R::ZERO; 3]],
        p: [p[0], p[1], Vector3::ZERO],
    })
}

impl<R: Real> Piece<R> {
    /// Calls `visit` for every pixel of a rectangle that the piece covers.
    pub(crate) fn for_each(&self, rect: &Rect, mut visit: impl FnMut(PiecePixel<R>)) {
        let rect = rect.intersection(&self.bounds);
        match &self.raster {
            Raster::Triangle(triangle) => {
                let area = R::from_i64(triangle.area());
                triangle.for_each(&rect, |x, y, w| {
                    visit(self.at(x, y, w.map_inline(|w| R::from_i64(w) / area)));
                });
            }
            Raster::Line(line) => line.for_each(&rect, |x, y, num, den| {
                let w = [den - num, num, 0].map_inline(|w| R::from_i64(w) / R::from_i64(den));
                visit(self.at(x, y, w));
            }),
        }
    }

    /// Perspective-correct weights and position, see the module page.
    fn at(&self, x: u32, y: u32, w: [R; 3]) -> PiecePixel<R> {
        let q = [w[0] * self.m[0], w[1] * self.m[1], w[2] * self.m[2]];
        let whole = (q[0] + q[1]) + q[2];
        let b = q.map_inline(|q| q / whole);
        let of = &self.weights;
        let c = [0, 1, 2].map_inline(|k| (b[0] * of[0][k] + b[1] * of[1][k]) + b[2] * of[2][k]);
        self.with(x, y, c)
    }

    /// A pixel with these weights of the primitive's corners.
    #[inline]
    pub(crate) fn with(&self, x: u32, y: u32, c: [R; 3]) -> PiecePixel<R> {
        let p = (self.p[0] * c[0] + self.p[1] * c[1]) + self.p[2] * c[2];
        PiecePixel { x, y, c, p }
    }

    /// The sample that a pixel keeps of the piece.
    #[inline]
    pub(crate) fn sample(
        &self,
        projector: &SceneProjector<'_, R>,
        fragment: &PiecePixel<R>,
    ) -> PixelSample<R> {
        let PiecePixel { x, y, c, p } = *fragment;
        let (scene, points) = (projector.scene, &projector.points);
        let of = &scene.primitives;
        let (direction, radius, color) = match self.kind {
            SampleKind::Ribbon => attributes(&of.ribbons, self.index, c, self.kind),
            SampleKind::Tube => attributes(&of.tubes, self.index, c, self.kind),
            _ => attributes(&of.triangles, self.index, c, self.kind),
        };
        let direction = points.view.direction(direction).normalized();
        let placed = points.place(p);
        let (normal, tangent) = match self.kind {
            SampleKind::Tube if points.view.perspective => ((-p).normalized(), direction),
            SampleKind::Tube => (Vector3::new(R::ZERO, R::ZERO, R::ONE), direction),
            SampleKind::Ribbon => {
                let away = points.facing(&placed, direction).gt(R::ZERO);
                (direction.map(|part| R::select(away, -part, part)), Vector3::ZERO)
            }
            _ if self.back => (-direction, Vector3::ZERO),
            _ => (direction, Vector3::ZERO),
        };
        let zero = |v: Vector3<R>| v + Vector3::ZERO;
        let own = || scene.material.color.to_array().map_inline(R::from_f32);
        PixelSample {
            kind: self.kind,
            id: self.id,
            depth: placed.t,
            radius,
            extent: ellipse::radius_in_pixels(radius, points.focal, placed.m),
            center: Vector2::new(R::from_f32(x as f32 + 0.5), R::from_f32(y as f32 + 0.5)),
            normal: zero(normal),
            tangent: zero(tangent),
            color: if projector.has.color { color.unwrap_or_else(own) } else { [R::ZERO; 3] },
        }
    }
}

/// Direction, radius and colour of a primitive where its corners have the weights c.
fn attributes<R: Real, const N: usize>(
    of: &Indexed<N>,
    index: usize,
    c: [R; 3],
    kind: SampleKind,
) -> (Vector3<R>, R, Option<[R; 3]>) {
    let Vertices { direction, radius, color, .. } = of.vertices();
    let corners = of.corners()[index];
    // The third weight of a line is 0, so that any corner can stand for its third.
    let corner = |k: usize| corners[k.min(N - 1)] as usize;
    let sum =
        |a: &dyn Fn(usize) -> R| (c[0] * a(corner(0)) + c[1] * a(corner(1))) + c[2] * a(corner(2));
    let vector =
        |of: &[glam::Vec3]| [0, 1, 2].map_inline(|axis| sum(&|i| R::from_f32(of[i][axis])));
    let mut a: [Vector3<R>; 3] = [0, 1, 2].map_inline(|k| Vector3::from_glam(direction[corner(k)]));
    if kind == SampleKind::Tube {
        let opposite = a[0].dot(a[1]).lt(R::ZERO);
        a[1] = a[1].map(|part| R::select(opposite, -part, part));
    }
    let direction = (a[0] * c[0] + a[1] * c[1]) + a[2] * c[2];
    let radius = sum(&|i| R::from_f32(radius[i])).at_least(R::ZERO);
    (direction, radius, color.as_deref().map(vector))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::raster::Snap;
    use crate::scene::{Camera, Lens, Pose, Primitives, Scene, Surfels};
    use glam::{DVec3, Vec3};

    /// A segment along x whose corners have these directions.
    fn segment(direction: [Vec3; 2]) -> Indexed<2> {
        let position = vec![-Vec3::X, Vec3::X];
        let (direction, radius) = (direction.to_vec(), vec![0.125; 2]);
        let vertices = Vertices { position, direction, radius, color: None, ..Vertices::default() };
        Indexed::new(vertices, vec![[0, 1]]).unwrap().0
    }

    /// The tangents of a tube's pixels, seen by a camera whose axes are the world's axes.
    fn tangents(direction: [Vec3; 2]) -> Vec<Vector3<f64>> {
        let primitives = Primitives { tubes: segment(direction), ..Primitives::default() };
        let scene = Scene { primitives, ..crate::method::tests::scene(Surfels::none()) };
        let pose = Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(33, 17, pose, Lens::FieldOfView(40.0)).unwrap();
        let projector = SceneProjector::new(&scene, &camera, false, Snap::new(8).unwrap());
        let mut tangents = Vec::new();
        pieces(&projector, 0, |piece| {
            let visit = |fragment| tangents.push(piece.sample(&projector, &fragment).tangent);
            piece.for_each(&piece.bounds, visit);
        });
        assert!(tangents.len() > 9, "{tangents:?}");
        tangents
    }

    #[test]
    fn the_tangents_of_a_segment_never_cancel() {
        for sign in [1.0, -1.0] {
            // c_0 + c_1, divided by the root of its square: 1 or next to it.
            let along = Vec3::X * sign;
            for tangent in tangents([along, -along]) {
                assert!((tangent.x - f64::from(sign)).abs() < 1e-15, "that of the first corner");
                assert_eq!((tangent.y, tangent.z), (0.0, 0.0));
            }
        }
        let (first, second) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.8, 0.6));
        assert_eq!(tangents([first, second]), tangents([first, -second]));
        assert_ne!(
            tangents([first, second]),
            tangents([-first, second]),
            "the first keeps its sign"
        );
        // At right angles neither tangent is turned, and each pixel's tangent lies on its corner's
        // side.
        for sign in [1.0, -1.0] {
            let found = tangents([Vec3::X, Vec3::Y * sign]);
            assert!(found.iter().all(|t| t.x >= 0.0 && t.y * f64::from(sign) >= 0.0), "{found:?}");
            assert!(found.iter().any(|t| t.y != 0.0));
        }
    }

    #[test]
    fn only_tangents_are_turned() {
        let [up, half] = [Vec3::Z, Vec3::new(0.0, 0.6, -0.8)];
        let middle = |kind| attributes::<f64, 2>(&segment([up, half]), 0, [0.5, 0.5, 0.0], kind).0;
        let [y, z] = [0.6_f32, 0.8].map(|v| f64::from(v) / 2.0);
        assert_eq!(middle(SampleKind::Ribbon), Vector3::new(0.0, y, 0.5 - z));
        assert_eq!(middle(SampleKind::Tube), Vector3::new(0.0, -y, 0.5 + z));
    }
}
