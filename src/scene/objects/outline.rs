//! Objects whose geometries are read when a view needs them.
//!
//! What a view draws of an object with a [prefix](super::detail::prefix), and of its finer ones, is a function of a few
//! numbers of each geometry, its [`Outline`]: how many surfels there are, how densely they cover, what bounds them. So
//! objects can be made of outlines, [seen](Objects::seen_from) by a camera, and then only that be read which is drawn.
//! The objects that result draw what those with all surfels and primitives do, bit for bit.

use super::detail::prefix::{Estimate, Prefix};
use super::place::Extent;
use super::{Detail, Geometry, Object, Objects};
use crate::error::Result;
use crate::scene::bounds::Bounds;
use crate::scene::{Boxes, Primitives, Surfels};
use glam::Vec3;
use std::sync::Arc;

/// What views ask of a geometry that has not been read: of surfels in an order, all of one radius, with colours, and
/// without half axes and prefiltered colours; and of primitives.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// What it is called.
    pub name: String,
    /// How many surfels there are, and how densely they cover; none without surfels.
    pub surfels: Option<(u32, Estimate)>,
    /// The radius of each.
    pub radius: f32,
    /// Whether they have opacities.
    pub opacity: bool,
    /// Whether there are primitives; if so, whether they have colours.
    pub primitives: Option<bool>,
    /// What bounds all of it.
    pub bounds: Bounds,
}

/// What is drawn of a geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needed {
    /// So many of its first surfels.
    pub surfels: u32,
    /// Whether its primitives are.
    pub primitives: bool,
}

impl Extent {
    fn outlined(outline: &Outline) -> Self {
        let count = outline.surfels.map_or(0, |(count, _)| count);
        let some = count > 0;
        Self {
            boxes: Boxes::new(&Surfels::none()),
            sphere: outline.bounds.corners_and_sphere().1,
            least: if some { f64::from(outline.radius) } else { f64::INFINITY },
            count,
            at_rest: (count, if some { outline.radius } else { 0.0 }),
            has: [some, some && outline.opacity, false],
            primitives: outline.primitives.is_some(),
            colored: outline.primitives == Some(true),
        }
    }
}

impl Objects {
    /// Objects of which no geometry has been read. What they are read from is known by `source`, a hash; two scenes
    /// with the same are the same.
    ///
    /// # Errors
    /// As [`Objects::new`].
    pub fn outlined(
        outlines: &[Outline],
        objects: Vec<Object>,
        fill: Vec3,
        source: [u8; 32],
    ) -> Result<Self> {
        let geometry = |outline: &Outline| Geometry {
            name: outline.name.clone(),
            surfels: Surfels::none(),
            primitives: Primitives::default(),
            detail: outline.surfels.map(|(count, estimate)| {
                Detail::Prefix(Prefix::outlined(count, estimate, &outline.bounds))
            }),
        };
        let extents = outlines.iter().map(Extent::outlined).collect();
        let geometries = outlines.iter().map(geometry).collect();
        let all = Self::assembled(geometries, extents, objects, fill)?;
        Ok(all.with_source(source))
    }

    /// The same objects, known by what they are read from.
    #[must_use]
    pub(crate) fn with_source(self, source: [u8; 32]) -> Self {
        Self { source: Some(source), ..self }
    }

    /// The hash of what geometries are read from, which may be as views need them; none if they are known by what is in
    /// memory.
    #[must_use]
    pub fn source(&self) -> Option<&[u8; 32]> {
        self.source.as_ref()
    }

    /// What the view draws of each geometry: the most that one of its objects does.
    #[must_use]
    pub fn needed(&self) -> Vec<Needed> {
        let mut all = vec![Needed::default(); self.geometries.len()];
        for (number, object) in (0..).zip(self.objects.iter()) {
            let needed = &mut all[object.geometry];
            needed.surfels = needed.surfels.max(self.ids.count(number));
            let has = self.extents[object.geometry].primitives;
            needed.primitives |= has && self.shown[number as usize].primitives;
        }
        all
    }

    /// The same objects with what the view draws of each geometry, and nothing else: `read` gives so much of the
    /// geometry of an index.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn with_needed(
        mut self,
        mut read: impl FnMut(usize, Needed) -> Result<(Surfels, Primitives)>,
    ) -> Result<Self> {
        let needed = self.needed();
        let known = |geometry: &Geometry| (geometry.name.clone(), geometry.detail.clone());
        let known: Vec<_> = self.geometries.iter().map(known).collect();
        // What another view needed makes room.
        self.geometries = Arc::new([]);
        let (mut geometries, mut extents) = (Vec::new(), Vec::new());
        for (index, (needed, (name, detail))) in needed.into_iter().zip(known).enumerate() {
            let nothing = needed == Needed::default();
            let (surfels, primitives) = match nothing {
                true => (Surfels::none(), Primitives::default()),
                false => read(index, needed)?,
            };
            extents.push(Extent { boxes: Boxes::new(&surfels), ..self.extents[index].clone() });
            geometries.push(Geometry { name, surfels, primitives, detail });
        }
        Ok(Self { geometries: geometries.into(), extents: extents.into(), ..self })
    }
}
