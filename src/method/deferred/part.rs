//! All surfels of a scene by their ids, and some of them as a scene that the passes of `ewa` draw.

use crate::frame::Exec;
use crate::method::algorithm::Job;
use crate::scene::objects::{Ids, Split};
use crate::scene::{Scene, Surfels};
use std::borrow::Cow;

/// The surfels of a scene: those of its objects, or of a scene without objects its own, as one.
pub(super) struct Whole<'a> {
    scene: &'a Scene,
    ids: Cow<'a, Ids>,
}

impl<'a> Whole<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let alone = || {
            let counts = [scene.surfels.len() as u32];
            // Fewer than 2^32 - 1, which is what 32 bits hold.
            Ids::of(Split::Single(32), &counts).unwrap_or_else(Ids::none)
        };
        let ids = match &scene.objects {
            Some(objects) => Cow::Borrowed(objects.ids()),
            None => Cow::Owned(alone()),
        };
        Self { scene, ids }
    }

    pub(super) fn ids(&self) -> &Ids {
        &self.ids
    }

    /// A surfel in words.
    pub(super) fn name(&self, id: u64) -> String {
        match (&self.scene.objects, self.ids.find(id)) {
            (Some(objects), Some((object, surfel))) => {
                format!("surfel {surfel} of {}", objects.objects()[object as usize].name)
            }
            _ => format!("surfel {id}"),
        }
    }

    /// The unit of epsilon.
    pub(super) fn median_radius(&self) -> f32 {
        match &self.scene.objects {
            Some(objects) => objects.median_radius(),
            None => self.scene.surfels.median_radius(),
        }
    }

    /// The surfels of ascending ids in their places.
    pub(super) fn surfels(&self, ids: &[u64], exec: &Exec) -> Surfels {
        match &self.scene.objects {
            Some(objects) => objects.some(ids, exec),
            None => self.scene.surfels.some(ids),
        }
    }

    /// The surfels of ascending ids as a scene, unlit and before nothing.
    pub(super) fn part(&self, ids: Vec<u64>, exec: &Exec) -> Part {
        let scene = Scene::unlit(&self.scene.name, self.surfels(&ids, exec));
        Part { scene, ids }
    }
}

/// Some surfels of a scene.
pub(super) struct Part {
    scene: Scene,
    ids: Vec<u64>,
}

impl Part {
    /// The job of drawing them alone.
    pub(super) fn job<'j>(&'j self, whole: &Job<'j>) -> Job<'j> {
        Job { scene: &self.scene, ..*whole }
    }

    /// Their ids, ascending.
    pub(super) fn ids(&self) -> &[u64] {
        &self.ids
    }

    /// Whether surfels of the scene have colours.
    pub(super) fn has_colors(&self) -> bool {
        self.scene.surfels.color().is_some()
    }

    /// The id of the surfel of an index; [`super::visibility::NONE`] of that of none.
    pub(super) fn id(&self, index: u32) -> u64 {
        self.ids.get(index as usize).copied().unwrap_or(super::visibility::NONE)
    }
}
