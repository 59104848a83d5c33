//! Explain which primitives are drawn into one pixel by the projection, and which one stays.

use super::{SampleKind, SceneProjector, primitives};
use crate::frame::Rect;
use crate::frame::raster::Snap;
use crate::method::Job;
use crate::number::{Exact, Vector3};
use crate::splat::Fate;
use std::fmt;
use std::ops::Range;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub(crate) struct PixelProjection<R> {
    /// The primitives that reach the pixel, in ascending order of their ids.
    contenders: Vec<Contender<R>>,
    /// The id that the pixel keeps, and its depth.
    pub(crate) kept: Option<(u32, R)>,
}

/// A primitive that reaches the pixel.
#[derive(Clone, Copy, Debug)]
struct Contender<R> {
    kind: SampleKind,
    id: u32,
    depth: R,
    /// g, if the primitive is dropped because its back is seen.
    back: Option<R>,
}

/// Replays every primitive of a scene at one pixel.
pub(crate) fn replay<R: Exact>(
    job: &Job<'_>,
    cull: bool,
    snap: Snap,
    pixel: (u32, u32),
) -> PixelProjection<R> {
    let projector = SceneProjector::<R>::new(job.scene, job.camera, cull, snap);
    let count = job.scene.surfels.len() + job.scene.primitives.len();
    let ranges = (0..count).step_by(65_536).map(|first| first..count.min(first + 65_536));
    let found = job.exec.ordered(ranges.collect(), |ids: Range<usize>| {
        let mut found = Vec::new();
        for id in ids {
            if id < job.scene.surfels.len() {
                found.extend(surfel(&projector, id, pixel));
            } else {
                pieces(&projector, id, pixel, &mut found);
            }
        }
        found
    });
    let contenders: Vec<Contender<R>> = found.into_iter().flatten().collect();
    let mut kept = None;
    for c in contenders.iter().filter(|c| c.back.is_none()) {
        if c.depth < depth_of(kept) {
            kept = Some((c.id, c.depth));
        }
    }
    PixelProjection { contenders, kept }
}

/// The depth of the pixel.
fn depth_of<R: Exact>(kept: Option<(u32, R)>) -> R {
    kept.map_or(R::INFINITY, |(_, depth)| depth)
}

/// A surfel, if its centre is in the pixel.
fn surfel<R: Exact>(
    projector: &SceneProjector<'_, R>,
    i: usize,
    (x, y): (u32, u32),
) -> Option<Contender<R>> {
    let (surfels, points) = (&projector.scene.surfels, &projector.points);
    let n = points.view.direction(Vector3::from_glam(surfels.normal()[i]));
    let (placed, g, fate) = points.fate(Vector3::from_glam(surfels.position()[i]), n);
    let back = match fate {
        Fate::Visible => None,
        Fate::BackFacing => Some(g),
        _ => return None,
    };
    let center = placed.center;
    let on = |at: R, pixel: u32| at >= R::ZERO && at.to_pixel() == pixel;
    let depth = placed.t + R::ZERO;
    let contender = Contender { kind: SampleKind::Surface, id: i as u32, depth, back };
    (on(center.x, x) && on(center.y, y)).then_some(contender)
}

/// The pieces of a primitive that cover the pixel.
fn pieces<R: Exact>(
    projector: &SceneProjector<'_, R>,
    id: usize,
    (x, y): (u32, u32),
    found: &mut Vec<Contender<R>>,
) {
    let pixel = Rect::pixel((x, y));
    primitives::pieces(projector, id, |piece| {
        piece.for_each(&pixel, |at| {
            let sample = piece.sample(projector, &at);
            let (kind, depth) = (sample.kind, sample.depth);
            found.push(Contender { kind, id: sample.id, depth, back: None });
        });
    });
}

/// The primitives of a scene that cover a pixel, each with its id and its depth there, in the order
/// of their ids.
pub(crate) fn beside<R: Exact>(
    job: &Job<'_>,
    cull: bool,
    snap: Snap,
    pixel: (u32, u32),
) -> Vec<(u32, R)> {
    let projector = SceneProjector::<R>::new(job.scene, job.camera, cull, snap);
    let first = job.scene.surfels.len();
    let mut found = Vec::new();
    for id in first..first + job.scene.primitives.len() {
        pieces(&projector, id, pixel, &mut found);
    }
    found.iter().map(|contender| (contender.id, contender.depth)).collect()
}

impl<R: Exact> fmt::Display for PixelProjection<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.contenders.len();
        writeln!(
            f,
            "projection: {count} lie in the pixel; the nearest stays, of equal depths the first"
        )?;
        let mut kept = None;
        for c in &self.contenders {
            write!(f, "  {} {:>8}  ", c.kind.name(), c.id)?;
            if let Some(g) = c.back {
                writeln!(f, "dropped  the back is seen: g {}", compared(g, ">=", R::ZERO))?;
                continue;
            }
            let than = depth_of(kept);
            if c.depth < than {
                writeln!(f, "nearest  depth {}", compared(c.depth, "<", than))?;
                kept = Some((c.id, c.depth));
            } else {
                writeln!(f, "loses    depth {}", compared(c.depth, ">=", than))?;
            }
        }
        match self.kept {
            Some((id, depth)) => writeln!(f, "  the pixel shows {id} at depth {}", depth.to_f64()),
            None => writeln!(f, "  the pixel is empty"),
        }
    }
}

/// A comparison with its operands, and their distance in ulp.
pub(crate) fn compared<R: Exact>(a: R, sign: &str, b: R) -> String {
    format!("{} {sign} {}  ({} ulp)", a.to_f64(), b.to_f64(), a.ulps_to(b))
}

/// The sign between the form and the ellipse's square where the ellipse does not hold the form; an
/// ellipse that is edge-on or a point holds nothing.
pub(crate) fn outside<R: Exact>(form: R, square: R) -> &'static str {
    if form > square { ">" } else { "in no ellipse of" }
}
