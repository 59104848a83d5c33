//! Draw surfels of a larger scene with the bits of the whole scene.
//!
//! A picture depends on a surfel that it does not show in four ways only: by the indices of the
//! surfels after it, by the median radius and the bounding sphere of all surfels, and by the hash of
//! the scene in its text. [`Surfels`](super::Surfels) carries the median and the sphere of the whole.
//! An [`Excerpt`] carries the rest.

use glam::Vec3;
use sha2::Sha256;

/// Which surfels of a whole scene the surfels of a scene are, and what the whole has.
#[derive(Clone, Debug)]
pub struct Excerpt {
    /// The indices in the whole scene, ascending: one for each surfel of the excerpt.
    pub(crate) ids: Vec<u32>,
    /// How many surfels the whole has.
    pub(crate) total: u64,
    /// The box around all positions of the whole, as [`super::Surfels::bounds`].
    pub(crate) bounds: (Vec3, Vec3),
    /// The state of [`super::Scene::sha256`] after all surfels of the whole.
    pub(crate) hash: Sha256,
}

impl Excerpt {
    /// The indices of the surfels in the whole scene, ascending.
    #[must_use]
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// How many surfels the whole scene has.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.total
    }

    /// The index among these surfels of a surfel of the whole.
    pub(crate) fn index(&self, id: u64) -> Option<u32> {
        let id = u32::try_from(id).ok()?;
        self.ids.binary_search(&id).ok().map(|index| index as u32)
    }
}
