//! Prefiltered colours of surfels: surfel mipmaps \[GBP04, 4.4\].

use crate::error::{Error, Result};
use glam::Vec3;

/// The most levels beside the surfels' own colours: the last covers 2^16 radii.
pub const MOST_LEVELS: usize = 16;

/// Further colours of every surfel. The colour of level k, from 1 to L, is the average colour of
/// the surface within 2^k of the surfel's radii. Level 0 is the surfel's own colour and is not
/// stored here.
///
/// Linear RGB. [`crate::index::mipmap`] makes these colours, and [`crate::source::derive`] makes
/// them from a texture; files may also give them. Only the method `deferred` draws them.
#[derive(Clone, Debug, PartialEq)]
pub struct Mipmap {
    levels: usize,
    /// Surfel by surfel, each with its levels from 1 on.
    colors: Vec<Vec3>,
}

impl Mipmap {
    /// Takes colours surfel by surfel, each with its levels from 1 to `levels`. The colours are not
    /// checked here: [`super::Surfels::new`] drops surfels whose colours are impossible.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not 1 to [`MOST_LEVELS`] levels, or if the last surfel does
    /// not have them all.
    pub fn new(levels: usize, colors: Vec<Vec3>) -> Result<Self> {
        check_levels(levels)?;
        if !colors.len().is_multiple_of(levels) {
            let count = colors.len();
            let what = format!("{count} prefiltered colours cannot be {levels} for each surfel");
            return Err(Error::Invalid(what));
        }
        Ok(Self { levels, colors })
    }

    /// A mipmap without any surfel.
    pub(crate) fn empty(levels: usize) -> Self {
        Self { levels, colors: Vec::new() }
    }

    /// L: 1 to [`MOST_LEVELS`].
    #[must_use]
    pub fn levels(&self) -> usize {
        self.levels
    }

    /// How many surfels the mipmap has colours for.
    #[must_use]
    pub fn len(&self) -> usize {
        self.colors.len() / self.levels
    }

    /// Whether there is no surfel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.colors.is_empty()
    }

    /// All colours, surfel by surfel, each with its levels from 1 on.
    #[must_use]
    pub fn colors(&self) -> &[Vec3] {
        &self.colors
    }

    /// The colours, writable; their number must stay a multiple of the levels.
    pub(crate) fn colors_mut(&mut self) -> &mut Vec<Vec3> {
        &mut self.colors
    }

    /// The levels of a surfel, from 1 on.
    #[must_use]
    pub fn of_surfel(&self, surfel: usize) -> &[Vec3] {
        &self.colors[surfel * self.levels..][..self.levels]
    }

    /// Appends a surfel. If it has fewer levels, its last level stands for the others. If it has
    /// none, its colour stands for all: it is then drawn as it would be without prefiltered
    /// colours.
    pub(crate) fn push(&mut self, own: Option<&[Vec3]>, color: Vec3) {
        let own = own.unwrap_or_default();
        let last = own.last().copied().unwrap_or(color);
        self.colors.extend((0..self.levels).map(|k| own.get(k).copied().unwrap_or(last)));
    }

    /// The colours of some surfels, in the order of the indices.
    pub(crate) fn some(&self, indices: &[usize]) -> Self {
        let colors = indices.iter().flat_map(|&i| self.of_surfel(i)).copied().collect();
        Self { levels: self.levels, colors }
    }

    /// Keeps the colours of the marked surfels, in order.
    pub(crate) fn retain(self, keep: &[bool]) -> Self {
        if keep.iter().all(|&keep| keep) {
            return self;
        }
        let kept = self.colors.chunks_exact(self.levels).zip(keep).filter(|pair| *pair.1);
        let colors = kept.flat_map(|pair| pair.0).copied().collect();
        Self { levels: self.levels, colors }
    }
}

/// Checks that there may be this many levels.
///
/// # Errors
/// [`Error::Invalid`] if not.
pub fn check_levels(levels: usize) -> Result<()> {
    if (1..=MOST_LEVELS).contains(&levels) {
        return Ok(());
    }
    Err(Error::Invalid(format!("{levels} levels of a mipmap; give 1 to {MOST_LEVELS}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered(levels: usize, surfels: usize) -> Mipmap {
        let colors = (0..levels * surfels).map(|i| Vec3::splat(i as f32)).collect();
        Mipmap::new(levels, colors).unwrap()
    }

    #[test]
    fn surfels_keep_their_own_levels() {
        let all = numbered(3, 4);
        assert_eq!((all.levels(), all.len(), all.of_surfel(2)[1]), (3, 4, Vec3::splat(7.0)));
        let some = all.some(&[3, 1]);
        assert_eq!([some.of_surfel(0), some.of_surfel(1)], [all.of_surfel(3), all.of_surfel(1)]);
        let kept = all.clone().retain(&[false, true, false, true]);
        assert_eq!(
            [kept.of_surfel(0), kept.of_surfel(1), kept.colors()],
            [all.of_surfel(1), all.of_surfel(3), &kept.colors]
        );
        assert_eq!(all.clone().retain(&[true; 4]), all);
    }

    #[test]
    fn what_a_surfel_lacks_is_filled_in() {
        let mut all = Mipmap::empty(3);
        all.push(None, Vec3::X);
        all.push(Some(&[Vec3::Y, Vec3::Z]), Vec3::X);
        assert_eq!(all.of_surfel(0), [Vec3::X; 3]);
        assert_eq!(all.of_surfel(1), [Vec3::Y, Vec3::Z, Vec3::Z]);
    }

    #[test]
    fn uneven_ones_are_refused() {
        assert!(Mipmap::new(0, vec![]).is_err() && Mipmap::new(17, vec![]).is_err());
        let error = Mipmap::new(3, vec![Vec3::ZERO; 7]).unwrap_err().to_string();
        assert_eq!(error, "7 prefiltered colours cannot be 3 for each surfel");
    }
}
