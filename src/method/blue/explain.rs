//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::discs::ray;
use super::squares::{Square, SquareProjector};
use crate::composite::decide;
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::method::Job;
use crate::method::projection::explain::{beside, compared};
use crate::number::Exact;
use crate::splat::{Fate, View};
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct BlueReplay<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// The surfels whose squares hold the pixel, ascending, then the triangles that cover it.
    pub touches: Vec<BlueTouch<R>>,
    /// The fragment that stays; none if the pixel is empty.
    pub kept: Option<BlueTouch<R>>,
    /// Depth of the near plane.
    near: R,
    surfels: usize,
}

/// A surfel or a triangle at the pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlueTouch<R> {
    /// The surfel, or the triangle by its id.
    pub id: u32,
    /// Depth of the fragment.
    pub t: R,
    /// The squared distance from the centre of the disc, and the square of its radius; none for a
    /// triangle.
    pub offset: Option<[R; 2]>,
    /// The fate of the fragment.
    pub end: BlueEnd<R>,
}

/// The fate of a fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlueEnd<R> {
    /// The back of its surfel is seen, g >= 0.
    Dropped(R),
    /// The plane is edge-on, or depth or offset is not finite.
    EdgeOn,
    /// The fragment is not beyond the near plane.
    Near,
    /// The fragment is outside the rim of its disc.
    Discarded,
    /// The fragment is not nearer than the pixel's depth, which this holds.
    Loses(R),
    /// The fragment is nearer than the pixel's depth, which this holds.
    Nearest(R),
}

/// Replays one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<BlueReplay<R>> {
    job.camera.check_pixel(pixel.0, pixel.1)?;
    let projector = SquareProjector::<R>::new(job, settings.cull);
    let view = View::new(job.camera);
    let count = job.scene.surfels.len();
    let ranges = (0..count).step_by(65_536).map(|first| first..count.min(first + 65_536));
    let found = job.exec.ordered(ranges.collect(), |range: std::ops::Range<usize>| {
        range.filter_map(|i| touch(&projector, &view, i, pixel)).collect::<Vec<_>>()
    });
    let mut touches = found.concat();
    // The loop below decides which fragment stays, so that all begin as losers.
    let triangle = |(id, t)| BlueTouch { id, t, offset: None, end: BlueEnd::Loses(t) };
    let triangles = beside(job, settings.cull, Snap::default(), pixel);
    touches.extend(triangles.into_iter().map(triangle));
    let mut kept: Option<BlueTouch<R>> = None;
    for touch in &mut touches {
        if matches!(touch.end, BlueEnd::Loses(_)) {
            let held = kept.map_or(R::INFINITY, |kept| kept.t);
            let nearest = decide::before(touch.t, held);
            touch.end = if nearest { BlueEnd::Nearest(held) } else { BlueEnd::Loses(held) };
            if nearest {
                kept = Some(*touch);
            }
        }
    }
    Ok(BlueReplay { pixel, touches, kept, near: view.near, surfels: count })
}

/// The fragment of a surfel, if its square holds the pixel; a fragment that stays is marked as
/// losing here.
fn touch<R: Exact>(
    projector: &SquareProjector<'_, R>,
    view: &View<R>,
    i: usize,
    (x, y): (u32, u32),
) -> Option<BlueTouch<R>> {
    let placed = projector.place(i);
    let (bounds, fate) = placed.fate(view);
    if !matches!(fate, Fate::Visible | Fate::BackFacing) || !bounds.contains(x, y) {
        return None;
    }
    let square = Square { bounds, surfel: i as u32, back: placed.g > R::ZERO, disc: placed.disc };
    let fragment = square.disc.at(ray(view, (x, y)), view.perspective);
    let end = if fate == Fate::BackFacing {
        BlueEnd::Dropped(placed.g)
    } else if !(fragment.t.is_finite() && fragment.offset.is_finite()) {
        BlueEnd::EdgeOn
    } else if !decide::beyond(fragment.t, view.near) {
        BlueEnd::Near
    } else if square.disc.holds(&fragment, view.near) {
        BlueEnd::Loses(fragment.t)
    } else {
        BlueEnd::Discarded
    };
    let offset = Some([fragment.offset, square.disc.limit]);
    Some(BlueTouch { id: square.surfel, t: fragment.t + R::ZERO, offset, end })
}

impl<R> BlueReplay<R> {
    /// The surfel that the pixel shows, if it shows one.
    #[must_use]
    pub fn surfel(&self) -> Option<u32> {
        let kept = self.kept.as_ref().map(|kept| kept.id);
        kept.filter(|&id| (id as usize) < self.surfels)
    }
}

impl<R: Exact> fmt::Display for BlueReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        let count = self.touches.len();
        writeln!(f, "pixel ({x}, {y}): {count} squares and triangles hold it")?;
        writeln!(f, "\ndiscs: the nearest stays, of equal depths the first")?;
        for touch in &self.touches {
            let kind = if (touch.id as usize) < self.surfels { "surfel  " } else { "triangle" };
            write!(f, "  {kind} {:>8}  ", touch.id)?;
            if let (Some([offset, limit]), BlueEnd::Loses(_) | BlueEnd::Nearest(_)) =
                (touch.offset, touch.end)
            {
                write!(f, "offset {}   ", compared(offset, "<=", limit))?;
            }
            match (touch.end, touch.offset) {
                (BlueEnd::Dropped(g), _) => {
                    writeln!(f, "dropped: the back is seen  g {}", compared(g, ">=", R::ZERO))?;
                }
                (BlueEnd::EdgeOn, _) => writeln!(f, "discarded: the disc is edge-on")?,
                (BlueEnd::Near, _) => {
                    writeln!(f, "discarded: depth {}", compared(touch.t, "<=", self.near))?;
                }
                (BlueEnd::Discarded, Some([offset, limit])) => {
                    writeln!(f, "discarded: offset {}", compared(offset, ">", limit))?;
                }
                // A triangle has no rim.
                (BlueEnd::Discarded, None) => writeln!(f, "discarded")?,
                (BlueEnd::Loses(held), _) => {
                    writeln!(f, "loses    depth {}", compared(touch.t, ">=", held))?;
                }
                (BlueEnd::Nearest(held), _) => {
                    writeln!(f, "nearest  depth {}", compared(touch.t, "<", held))?;
                }
            }
        }
        match &self.kept {
            Some(kept) => {
                writeln!(f, "  the pixel shows {} at depth {}", kept.id, kept.t.to_f64())
            }
            None => writeln!(f, "  the pixel is empty"),
        }
    }
}
