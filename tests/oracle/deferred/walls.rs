//! Polygons beside the surfels: the nearest of each pixel, and what it shows.

use crate::oracle::deferred::model::{Behind, NOTHING};
use crate::oracle::ewa::model::Oracle;
use crate::oracle::kit::number::{N3, Num};
use crate::oracle::kit::planes::{index, number, value};
use crate::oracle::kit::projection::{Projected, Sight};
use crate::oracle::kit::shade::{Surface, shaded};
use glam::Vec3;
use splatref::frame::{Frame, NO_ID};
use splatref::number::Exact;
use splatref::scene::indexed::Indexed;
use splatref::scene::{Camera, Primitives, Scene, Surfels, Triangles, Vertices};

/// The triangles of all objects as one list; where some have colours the others get `fill`.
fn joined(all: Vec<Primitives>, fill: Vec3) -> Triangles {
    let (mut vertices, mut corners) = (Vertices::default(), Vec::new());
    let colored = all.iter().any(Primitives::colored);
    for one in all {
        let (own, its) = one.triangles.into_parts();
        let first = vertices.position.len() as u32;
        corners.extend(its.iter().map(|c| c.map(|v| v + first)));
        if colored {
            let own = own.color.unwrap_or_else(|| vec![fill; own.position.len()]);
            vertices.color.get_or_insert_default().extend(own);
        }
        vertices.position.extend(own.position);
        vertices.direction.extend(own.direction);
        vertices.radius.extend(own.radius);
    }
    Indexed::new(vertices, corners).expect("good triangles").0
}

/// The nearest polygon of a pixel.
#[derive(Clone, Copy)]
pub(crate) struct Wall<const P: u32> {
    /// That of its nearness.
    pub(crate) depth: Num<P>,
    normal: N3<P>,
    color: N3<P>,
}

/// As the passes see it.
pub(crate) fn behind<const P: u32>(oracle: &Oracle<'_>, wall: Option<Wall<P>>) -> Behind {
    let error = |w: Wall<P>| oracle.guard * (oracle.step * w.depth.v + w.depth.e);
    wall.map_or(NOTHING, |w| (w.depth.v, error(w)))
}

/// The polygons before a camera.
pub(crate) struct Walls<const P: u32> {
    scene: Scene,
    sight: Sight<P>,
    all: Projected<P>,
}

impl<const P: u32> Walls<P> {
    pub(crate) fn new(
        around: &Scene,
        (all, fill): (Vec<Primitives>, Vec3),
        camera: &Camera,
        cull: bool,
    ) -> Self {
        let primitives = Primitives { triangles: joined(all, fill), ..Primitives::default() };
        let scene = Scene { surfels: Surfels::none(), primitives, ..around.clone() };
        let all = Projected::new(&scene, camera, cull, 8);
        assert!(all.loose.is_empty(), "triangles too far away");
        Self { scene, sight: Sight::new(camera), all }
    }

    /// The nearest at a pixel, if any; none if rounding decides that.
    pub(crate) fn at(&self, i: usize) -> Option<Option<Wall<P>>> {
        let all = &self.all.pixels[i];
        let may: Vec<_> = all.iter().filter(|c| !c.is_hidden(all)).collect();
        let [c] = may[..] else { return may.is_empty().then_some(None) };
        let depth = if self.sight.perspective {
            let one = Num::exact(1.0);
            one / (one / c.t)
        } else {
            c.t
        };
        let color = if self.scene.primitives.colored() {
            c.color
        } else {
            self.scene.material.color.to_array().map(|v| Num::exact(v.into()))
        };
        let normal = self.sight.outwards(c.normal);
        c.certain.then_some(Some(Wall { depth, normal, color }))
    }

    /// A pixel that shows a polygon.
    pub(crate) fn check<R: Exact>(
        &self,
        wall: &Wall<P>,
        frame: &Frame<R>,
        (i, place): (usize, &str),
    ) {
        assert_eq!(index(frame, "id", i), NO_ID, "{place}: a polygon has no id");
        assert_eq!(number(frame, "weight", i), 1.0, "{place}: the weight of a polygon");
        assert_eq!(number(frame, "A", i), 1.0, "{place}: A of a polygon");
        let near = |truth: Num<P>, found: f64, what: &str| {
            let off = truth.deviation(found);
            assert!(off <= 1.0, "{place}: {what} of a polygon {found:?} for {truth:?}");
        };
        let three = |truth: N3<P>, found: [f64; 3], what: &str| {
            (0..3).for_each(|k| near(truth[k], found[k], what));
        };
        near(wall.depth, number(frame, "Z", i), "Z");
        let normal = value(frame, "normal", i);
        three(wall.normal, normal, "the normal");
        if frame.plane("resolved").is_some() {
            three(wall.color, value(frame, "resolved", i), "the colour");
        }
        let pixel = (i as u32 % frame.width, i as u32 / frame.width);
        let depth = number(frame, "Z", i);
        let surface = Surface { depth, normal, tangent: [0.0; 3], color: wall.color };
        let found = value(frame, "", i);
        let fits = |c: &N3<P>| (0..3).all(|k| c[k].deviation(found[k]) <= 1.0);
        let may = shaded(&self.scene, &self.sight, pixel, &surface);
        assert!(may.iter().any(fits), "{place}: {found:?} of a polygon, not of {may:?}");
    }
}
