//! Every decision at one pixel, with its operands.

use super::Settings;
use super::plain::fragment;
use crate::composite::epsilon;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::Exact;
use crate::scene::{Camera, Surfels};
use crate::splat::{Projector, Shared, Splat, View, batch};
use std::fmt;
use std::ops::Range;

/// What happened at one pixel.
#[derive(Clone, Debug)]
pub struct Explanation<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// k^2, the limit of q.
    pub limit: R,
    /// The depth of the visible band in world units.
    pub epsilon: R,
    /// Depth of the nearest fragment; +inf if the pixel is empty.
    pub nearest: R,
    /// The surfel of the nearest fragment.
    pub id: Option<u32>,
    /// The splats whose bounds hold the pixel, in ascending surfel index.
    pub touches: Vec<Touch<R>>,
}

/// One splat at the pixel.
#[derive(Clone, Copy, Debug)]
pub struct Touch<R> {
    /// The surfel.
    pub surfel: u32,
    /// Its q, compared with k^2.
    pub q: R,
    /// Depth of the fragment.
    pub t: R,
    /// Nearness of the fragment.
    pub w: R,
    /// The greatest nearness of the splats before it, compared with `w`.
    pub before: R,
    /// The weight, if the fragment is accumulated.
    pub weight: Option<R>,
}

/// Replays both passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub fn explain<R: Exact>(
    surfels: &Surfels,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    (x, y): (u32, u32),
) -> Result<Explanation<R>> {
    camera.check_pixel(x, y)?;
    let view = View::new(camera);
    let projector = Projector::<R>::new(view, &settings.kernel, settings.cull);
    let shared = Shared::new(&view, &settings.kernel);
    let epsilon = R::from_f32(settings.epsilon.resolve(surfels));
    let ranges = (0..surfels.len()).step_by(65_536);
    let ranges = ranges.map(|first| first..surfels.len().min(first + 65_536)).collect();
    let found = exec.ordered(ranges, |range: Range<usize>| {
        let mut found: Vec<Splat<R>> = Vec::new();
        batch::splats(&projector, surfels, range, |splat| {
            if splat.bounds.contains(x, y) {
                found.push(splat);
            }
        });
        found
    });

    // Visibility splatting.
    let (mut nearest, mut id) = (shared.empty(), None);
    let mut touches = Vec::new();
    for splat in found.iter().flatten() {
        let (q, w) = fragment(&shared, splat, x, y);
        let t = shared.depth(w);
        touches.push(Touch { surfel: splat.surfel, q, t, w, before: nearest, weight: None });
        if q <= shared.limit && w > nearest {
            (nearest, id) = (w, Some(splat.surfel));
        }
    }
    // Attribute splatting.
    let nearest = shared.depth(nearest);
    for (touch, splat) in touches.iter_mut().zip(found.iter().flatten()) {
        if touch.q <= shared.limit && epsilon::visible(touch.t, nearest, epsilon) {
            touch.weight = Some(splat.footprint.weight(touch.q));
        }
    }
    Ok(Explanation { pixel: (x, y), limit: shared.limit, epsilon, nearest, id, touches })
}

impl<R: Exact> fmt::Display for Explanation<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        let n = |value: R| value.to_f64();
        writeln!(f, "pixel ({x}, {y}): {} splats reach it", self.touches.len())?;
        writeln!(f, "\nvisibility splatting: inside if q <= {}", n(self.limit))?;
        for t in &self.touches {
            let margin = t.q.ulps_to(self.limit);
            let inside = t.q <= self.limit;
            let (sign, word) = if inside { ("<=", "inside ") } else { ("> ", "outside") };
            write!(
                f,
                "  surfel {:>8}  {word}  q {:<12.9} {sign} {}",
                t.surfel,
                n(t.q),
                n(self.limit)
            )?;
            write!(f, "  (margin {margin} ulp)")?;
            if inside {
                let wins = t.w > t.before;
                let (sign, word) = if wins { ("> ", "nearest") } else { ("<=", "farther") };
                write!(f, "   {word}  nearness {:.9} {sign} {:.9}", n(t.w), n(t.before))?;
                write!(f, "  (margin {} ulp)  depth {}", t.w.ulps_to(t.before), n(t.t))?;
            }
            writeln!(f)?;
        }
        let Some(id) = self.id else {
            return writeln!(f, "\nthe pixel is empty");
        };
        let limit = epsilon::limit(self.nearest, self.epsilon);
        writeln!(
            f,
            "\nattribute splatting: visible if depth <= {} (nearest {}, surfel {id}, + epsilon {})",
            n(limit),
            n(self.nearest),
            n(self.epsilon)
        )?;
        for t in self.touches.iter().filter(|t| t.q <= self.limit) {
            let margin = t.t.ulps_to(limit);
            let (sign, word) =
                if t.weight.is_some() { ("<=", "visible") } else { ("> ", "hidden ") };
            write!(f, "  surfel {:>8}  {word}  depth {} {sign} {}", t.surfel, n(t.t), n(limit))?;
            write!(f, "  (margin {margin} ulp)")?;
            match t.weight {
                Some(weight) => writeln!(f, "  weight {}", n(weight))?,
                None => writeln!(f)?,
            }
        }
        Ok(())
    }
}
