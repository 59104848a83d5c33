//! Which pixels of a picture are wrong against a picture of the same surfels.
//!
//! A pixel of the reference is on a border if one of the pixels around it, of which there are up to
//! eight, is empty where it is not or the other way round, shows another object, or is nearer or farther
//! by more than 4 epsilon. Pixels on borders are not judged, but those are counted that are empty where
//! the reference is covered: gaps. Another pixel is wrong, as the first of these that it is:
//!
//! - a hole: empty where the reference is covered
//! - spill: covered where the reference is empty
//! - another surface: of another object, or nearer or farther by more than epsilon
//! - another colour: R, G or B differs by more than 8/255 as sRGB

use splatref::Result;
use splatref::frame::Frame;
use splatref::number::srgb::from_linear;

/// What is compared of a picture.
pub(crate) struct Seen {
    width: usize,
    color: Vec<[f32; 3]>,
    depth: Vec<f32>,
    object: Vec<Option<u32>>,
}

impl Seen {
    /// The planes of a frame; `object` tells the object of an id.
    pub(crate) fn of(frame: &Frame<f32>, object: impl Fn(u32) -> Option<u32>) -> Result<Self> {
        Ok(Self {
            width: frame.width as usize,
            color: frame.color("")?.values().to_vec(),
            depth: frame.scalar("Z")?.values().to_vec(),
            object: frame.index("id")?.values().iter().map(|&id| object(id)).collect(),
        })
    }

    fn covers(&self, i: usize) -> bool {
        self.depth[i].is_finite()
    }

    fn is_on_border(&self, i: usize, epsilon: f32) -> bool {
        let (x, y) = (i % self.width, i / self.width);
        let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
        let height = self.depth.len() / self.width;
        near(y, height).flat_map(|y| near(x, self.width).map(move |x| (x, y))).any(|(x, y)| {
            let other = y * self.width + x;
            self.object[i] != self.object[other]
                || self.covers(i) != self.covers(other)
                || (self.covers(i) && (self.depth[i] - self.depth[other]).abs() > 4.0 * epsilon)
        })
    }
}

/// Pixels by what is wrong with them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wrong {
    /// That are judged and that the reference covers.
    pub(crate) covered: u32,
    pub(crate) holes: u32,
    pub(crate) spill: u32,
    pub(crate) surface: u32,
    pub(crate) color: u32,
    /// On borders, no part of the others.
    pub(crate) gaps: u32,
}

impl Wrong {
    /// A picture against its reference; epsilon in world units.
    pub(crate) fn count(picture: &Seen, reference: &Seen, epsilon: f32) -> Self {
        let mut counts = Self::default();
        for i in 0..reference.depth.len() {
            if reference.is_on_border(i, epsilon) {
                counts.gaps += u32::from(reference.covers(i) && !picture.covers(i));
                continue;
            }
            counts.covered += u32::from(reference.covers(i));
            match (picture.covers(i), reference.covers(i)) {
                (false, false) => {}
                (false, true) => counts.holes += 1,
                (true, false) => counts.spill += 1,
                (true, true) => {
                    let off = (picture.depth[i] - reference.depth[i]).abs();
                    if picture.object[i] != reference.object[i] || off > epsilon {
                        counts.surface += 1;
                    } else if differ(picture.color[i], reference.color[i]) {
                        counts.color += 1;
                    }
                }
            }
        }
        counts
    }

    /// All of them, per cent of the covered pixels that are judged.
    pub(crate) fn share(&self) -> f64 {
        self.percent(self.holes + self.spill + self.surface + self.color)
    }

    pub(crate) fn percent(&self, pixels: u32) -> f64 {
        1e2 * f64::from(pixels) / f64::from(self.covered.max(1))
    }
}

/// Whether a component differs by more than 8/255 as sRGB.
fn differ(a: [f32; 3], b: [f32; 3]) -> bool {
    let stored = |x: f32| from_linear(f64::from(x));
    (0..3).any(|c| (stored(a[c]) - stored(b[c])).abs() > 8.0 / 255.0)
}
