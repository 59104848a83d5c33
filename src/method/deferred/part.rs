//! Hold all surfels of a scene by their ids, and make some of them a scene that the passes of `ewa`
//! draw.

use super::Settings;
use super::filter::filtered;
use super::queries::Queries;
use crate::error::Result;
use crate::frame::Exec;
use crate::index::seen::Seen;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::part::Part as RectPart;
use crate::number::lanes::{LANES, Lanes};
use crate::scene::merge::join;
use crate::scene::objects::detail::Mask;
use crate::scene::objects::{Ids, Split};
use crate::scene::{Boxes, Primitives, Scene, Similarity, Surfels};
use glam::Vec3;
use std::borrow::Cow;

/// The surfels of a scene: the surfels of its objects, or the surfels of a scene without objects,
/// as one object.
pub(crate) struct Whole<'a> {
    scene: &'a Scene,
    ids: Cow<'a, Ids>,
    /// The boxes of a scene without objects, if the session made them.
    boxes: Option<&'a Boxes>,
    /// Whether pass 1 leaves out each object; empty: it leaves out none.
    left_out: Vec<bool>,
}

impl<'a> Whole<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let alone = || {
            let counts = [scene.surfels.len() as u32];
            // A scene has fewer than 2^32 - 1 surfels, so that 32 bits are enough.
            Ids::with_split(Split::Single(32), &counts).unwrap_or_else(Ids::none)
        };
        let ids = match &scene.objects {
            Some(objects) => Cow::Borrowed(objects.ids()),
            None => Cow::Owned(alone()),
        };
        Self { scene, ids, boxes: None, left_out: Vec::new() }
    }

    /// The surfels of a job, with the boxes that the session made of the scene.
    pub(super) fn of_job(job: &Job<'a>) -> Self {
        Self { boxes: job.index.boxes.as_ref(), ..Self::new(job.scene) }
    }

    /// Leaves out of pass 1 the objects of which the frame before selected few surfels, see
    /// [`Settings::share`].
    pub(crate) fn after(mut self, before: &Seen, settings: &Settings) -> Self {
        let share = f64::from(settings.share);
        if share > 0.0 {
            let few = |(object, &selected): (u32, &u32)| {
                let drawn = self.scene.objects.as_ref().and_then(|objects| objects.drawn(object));
                let all = drawn.map_or(self.ids.count(object).into(), Mask::count);
                selected > 0 && f64::from(selected) <= share * all as f64
            };
            self.left_out = (0..).zip(before.selected()).map(few).collect();
        }
        self
    }

    /// Whether pass 1 leaves out an object.
    pub(crate) fn leaves_out(&self, object: u32) -> bool {
        self.left_out.get(object as usize).is_some_and(|&left_out| left_out)
    }

    pub(crate) fn ids(&self) -> &Ids {
        &self.ids
    }

    /// The ids of all surfels that the high level leaves, ascending.
    pub(crate) fn drawn_ids(&self) -> Vec<u64> {
        match &self.scene.objects {
            Some(objects) => objects.drawn_ids(),
            None => (0..self.ids.total()).collect(),
        }
    }

    /// The name of a surfel in words.
    pub(super) fn name(&self, id: u64) -> String {
        match (&self.scene.objects, self.ids.find(id)) {
            (Some(objects), Some((object, surfel))) => {
                format!("surfel {surfel} of {}", objects.objects()[object as usize].name)
            }
            _ => format!("surfel {id}"),
        }
    }

    /// Whether surfels or polygons have colours.
    pub(super) fn has_colors(&self) -> bool {
        match &self.scene.objects {
            Some(objects) => objects.have_colors(),
            None => self.scene.surfels.color().is_some() || self.scene.primitives.colored(),
        }
    }

    /// The polygons in their places.
    ///
    /// # Errors
    /// As [`Objects::primitives`](crate::scene::Objects::primitives) and [`join`].
    pub(super) fn polygons(&self) -> Result<Cow<'_, Primitives>> {
        match &self.scene.objects {
            // Geometries without primitives are not read for this.
            Some(objects) if !objects.have_primitives() => Ok(Cow::Owned(Primitives::default())),
            Some(objects) => Ok(Cow::Owned(join(objects.primitives()?, objects.fill())?)),
            None => Ok(Cow::Borrowed(&self.scene.primitives)),
        }
    }

    /// All surfels in `count` shares of about one size, in ascending ids.
    pub(super) fn shares(&self, count: usize) -> Vec<Vec<Range<'_>>> {
        let total = self.ids.total();
        let ends: Vec<u64> = (1..=count as u64).map(|i| total * i / count as u64).collect();
        let mut shares: Vec<Vec<Range<'_>>> = vec![Vec::new()];
        let mut done = 0;
        for &object in self.ids.order() {
            let of_object = u64::from(self.ids.count(object));
            let mut from = 0;
            while from < of_object {
                while shares.len() < count && done >= ends[shares.len() - 1] {
                    shares.push(Vec::new());
                }
                let room = ends[shares.len() - 1] - done;
                let to = of_object.min(from + room);
                let last = shares.len() - 1;
                shares[last].push(self.range(object, from as usize..to as usize));
                done += to - from;
                from = to;
            }
        }
        shares
    }

    fn range(&self, object: u32, surfels: std::ops::Range<usize>) -> Range<'_> {
        let first = self.ids.id(object, 0);
        match &self.scene.objects {
            Some(objects) => {
                let place = &objects.places()[object as usize];
                let place = (*place != Similarity::IDENTITY).then_some(place);
                let (boxes, drawn) = (Some(objects.boxes(object)), objects.drawn(object));
                Range { of: &objects.geometry(object).surfels, place, drawn, boxes, first, surfels }
            }
            None => {
                let (of, boxes) = (&self.scene.surfels, self.boxes);
                Range { of, place: None, drawn: None, boxes, first, surfels }
            }
        }
    }

    /// Whether a surfel of an object is drawn.
    pub(super) fn draws(&self, object: u32, surfel: u32) -> bool {
        self.mask(object).is_none_or(|drawn| drawn.has(surfel as usize))
    }

    /// The surfels of an object that are drawn, if not all are.
    fn mask(&self, object: u32) -> Option<&Mask> {
        self.scene.objects.as_ref()?.drawn(object)
    }

    /// The unit of epsilon.
    pub(crate) fn median_radius(&self) -> f32 {
        match &self.scene.objects {
            Some(objects) => objects.median_radius(),
            None => self.scene.surfels.median_radius(),
        }
    }

    /// Whether the surfels of the scene are drawn as they stand: in their places and in their colours.
    pub(super) fn is_plain(&self) -> bool {
        let surfels = &self.scene.surfels;
        let plain = self.scene.objects.is_none() && surfels.mipmap().is_none();
        plain && self.has_colors() == surfels.color().is_some()
    }

    /// The surfels of ascending ids in their places.
    pub(super) fn surfels(&self, ids: &[u64], exec: &Exec) -> Surfels {
        spend(Work::Copy);
        match &self.scene.objects {
            Some(objects) => objects.some(ids, exec),
            None if self.has_colors() => {
                self.scene.surfels.some(ids, exec).colored(self.scene.material.color)
            }
            None => self.scene.surfels.some(ids, exec),
        }
    }

    /// The surfels of ascending ids as pass 4 draws them.
    pub(crate) fn drawn(&self, ids: Vec<u64>, job: &Job<'_>) -> Part {
        self.part(ids, job.exec).filtered(job)
    }

    /// The surfels of ascending ids as a scene without light and environment.
    pub(crate) fn part(&self, ids: Vec<u64>, exec: &Exec) -> Part {
        let scene = Scene::unlit(&self.scene.name, self.surfels(&ids, exec));
        Part { scene, ids }
    }

    /// The ids of the surfels of ranges that pass 1 draws, ascending as the ranges do.
    pub(super) fn first(&self, mut ranges: Vec<(u32, std::ops::Range<u32>)>) -> Vec<u64> {
        ranges.retain(|(object, _)| !self.leaves_out(*object));
        let mut ids = Vec::with_capacity(ranges.iter().map(|(_, range)| range.len()).sum());
        for (object, range) in ranges {
            let end = range.end;
            match self.mask(object) {
                None => ids.extend(self.ids.id(object, range.start)..self.ids.id(object, end)),
                Some(mask) => {
                    let drawn = range.filter(|&surfel| mask.has(surfel as usize));
                    ids.extend(drawn.map(|surfel| self.ids.id(object, surfel)));
                }
            }
        }
        ids
    }
}

/// Neighbouring surfels of one object.
pub(super) struct Range<'a> {
    of: &'a Surfels,
    /// The place of the object; none: the surfels are in their places.
    place: Option<&'a Similarity>,
    /// The surfels that are drawn, if not all are.
    drawn: Option<&'a Mask>,
    /// The boxes around the surfels, in the surfels' own coordinates.
    boxes: Option<&'a Boxes>,
    /// The id of the surfel 0.
    first: u64,
    pub(super) surfels: std::ops::Range<usize>,
}

impl<'a> Range<'a> {
    /// The parts that no query reports hidden.
    pub(super) fn parts(&self, queries: &Queries<'_>) -> Vec<Self> {
        let whole = || Self { surfels: self.surfels.clone(), ..*self };
        let Some(boxes) = self.boxes else { return vec![whole()] };
        if !queries.any(boxes.all(), self.place) {
            return Vec::new();
        }
        let parts = boxes.parts(self.surfels.clone());
        let open = parts.filter(|(_, corners)| queries.any(*corners, self.place));
        open.map(|(surfels, _)| Self { surfels, ..*self }).collect()
    }
}

impl Range<'_> {
    #[inline]
    pub(super) fn id(&self, surfel: usize) -> u64 {
        self.first + surfel as u64
    }

    /// Whether a surfel is drawn.
    pub(super) fn draws(&self, surfel: usize) -> bool {
        self.drawn.is_none_or(|drawn| drawn.has(surfel))
    }

    /// The normal of a surfel in its place.
    #[inline]
    pub(super) fn normal(&self, i: usize) -> Vec3 {
        let normal = self.of.normal()[i];
        match self.place {
            None => normal,
            Some(place) => place.normal(normal),
        }
    }

    /// The positions of [`LANES`] surfels from `first` on in their places, component by component;
    /// beyond the last surfel, the position of the last.
    #[inline(always)]
    pub(super) fn positions(&self, first: usize) -> [Lanes; 3] {
        let all = &self.of.position()[..self.surfels.end];
        match all[first..].first_chunk::<LANES>() {
            Some(positions) => self.moved(positions),
            None => {
                let mut last = [all[all.len() - 1]; LANES];
                last[..all.len() - first].copy_from_slice(&all[first..]);
                self.moved(&last)
            }
        }
    }

    #[inline(always)]
    fn moved(&self, positions: &[Vec3; LANES]) -> [Lanes; 3] {
        let mut moved = [[0.0; LANES]; 3];
        let Some(place) = self.place else {
            for i in 0..LANES {
                [moved[0][i], moved[1][i], moved[2][i]] = positions[i].to_array();
            }
            return moved;
        };
        let place = *place;
        for i in 0..LANES {
            [moved[0][i], moved[1][i], moved[2][i]] = place.point(positions[i]).to_array();
        }
        moved
    }
}

/// Some surfels of a scene.
pub(crate) struct Part {
    scene: Scene,
    ids: Vec<u64>,
}

impl Part {
    /// The surfels in the colours of pass 4, see [`mod@super::filter`].
    pub(super) fn filtered(self, job: &Job<'_>) -> Self {
        spend(Work::Filter);
        let surfels = filtered(self.scene.surfels, job.camera, job.exec);
        Self { scene: Scene { surfels, ..self.scene }, ..self }
    }

    /// The job that draws these surfels alone.
    pub(crate) fn job<'j>(&'j self, whole: &Job<'j>) -> Job<'j> {
        // The surfels have other numbers here.
        let part = whole.part.map(|part| RectPart { around: None, ..part });
        Job { scene: &self.scene, part, ..*whole }
    }

    pub(crate) fn surfels(&self) -> &Surfels {
        &self.scene.surfels
    }

    /// The ids of the surfels, ascending.
    pub(crate) fn ids(&self) -> &[u64] {
        &self.ids
    }

    pub(super) fn into_ids(self) -> Vec<u64> {
        self.ids
    }

    /// The id of the surfel with this index; [`super::visibility::NONE`] if there is no such
    /// surfel.
    pub(crate) fn id(&self, index: u32) -> u64 {
        self.ids.get(index as usize).copied().unwrap_or(super::visibility::NONE)
    }
}
