//! Surfels of objects in their places.

use super::{Geometry, Objects};
use crate::error::Result;
use crate::frame::Exec;
use crate::scene::cloud::half_axes;
use crate::scene::degenerate::unit;
use crate::scene::surfels::Arrays;
use crate::scene::transform::Similarity;
use crate::scene::{Boxes, Mipmap, Primitives, Surfels, bounds};
use glam::{DVec3, Vec3};
use std::ops::Range;

/// So many surfels are placed by one job.
const CHUNK: usize = 1 << 13;

/// Numbers of placed surfels stay between this and its inverse, 2^-100: far from where f32 ends, so
/// that no surfel that is one becomes none.
const LEAST: f64 = 1.0 / 1_267_650_600_228_229_401_496_703_205_376.0;

/// What is asked of a geometry for each of its objects in each frame.
#[derive(Clone, Debug)]
pub(super) struct Extent {
    pub(super) boxes: Boxes,
    /// Around surfels and primitives: middle and radius.
    pub(super) sphere: (DVec3, f64),
    /// The least of all radii and half axes.
    least: f64,
}

impl Extent {
    pub(super) fn new(geometry: &Geometry) -> Self {
        let surfels = &geometry.surfels;
        let halves = surfels.tangents().unwrap_or_default().iter().flatten();
        let halves = halves.map(|half| half.as_dvec3().length());
        let radii = surfels.radius().iter().map(|&radius| f64::from(radius));
        let less = |least, size| if size < least { size } else { least };
        let least = radii.chain(halves).fold(f64::INFINITY, less);
        let sphere = bounds::sphere(surfels, &geometry.primitives);
        Self { boxes: Boxes::new(surfels), sphere, least }
    }

    /// Whether surfels stay surfels in a place.
    pub(super) fn is_in_range(&self, place: &Similarity) -> bool {
        let (middle, radius) = self.sphere;
        let far = (middle.length() + radius) * place.scale + place.translation.length();
        far <= 1.0 / LEAST && self.least * place.scale >= LEAST
    }
}

/// Surfels of one object: all of a range, or those of some ids.
enum Part<'a> {
    Range(u32, Range<u32>),
    Ids(&'a [u64]),
}

impl Objects {
    /// The surfels of all objects in the order of their ids, and their primitives in the order of
    /// the scene.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`crate::scene::indexed::Indexed::new`].
    pub fn flattened(&self, exec: &Exec) -> Result<(Surfels, Vec<Primitives>)> {
        let parts = self.ids.order().iter().flat_map(|&object| {
            let count = self.ids.count(object);
            let starts = (0..count).step_by(CHUNK);
            starts.map(move |start| {
                Part::Range(object, start..count.min(start.saturating_add(CHUNK as u32)))
            })
        });
        let surfels = self.gather(parts.collect(), exec);
        let placed = (0..self.objects.len()).map(|object| {
            let primitives = self.geometry(object as u32).primitives.clone();
            let color = self.objects[object].color;
            let placed = primitives.map(|vertices| {
                if let Some(color) = color {
                    vertices.color = Some(vec![color; vertices.position.len()]);
                }
                self.places[object].apply_to_vertices(vertices);
            });
            placed.map(|(placed, _)| placed)
        });
        Ok((surfels, placed.collect::<Result<_>>()?))
    }

    /// The surfels of some ids, which ascend, with their prefiltered colours; an id that is none is left out.
    #[must_use]
    pub fn some(&self, ids: &[u64], exec: &Exec) -> Surfels {
        self.gather(ids.chunks(CHUNK).map(Part::Ids).collect(), exec)
    }

    fn gather(&self, parts: Vec<Part<'_>>, exec: &Exec) -> Surfels {
        let (has, levels) = (self.has(), self.levels());
        let chunks = exec.ordered(parts, |part| {
            let mut arrays = Arrays::new(has, levels);
            match part {
                Part::Range(object, range) => {
                    range.for_each(|surfel| self.place(object, surfel, &mut arrays));
                }
                Part::Ids(ids) => {
                    // Ids ascend, so that neighbours mostly are of one object.
                    let mut of = 0..0;
                    let mut object = 0;
                    for &id in ids {
                        if !of.contains(&id) {
                            let Some(found) = self.ids.find(id) else { continue };
                            object = found.0;
                            let first = self.ids.id(object, 0);
                            of = first..first + u64::from(self.ids.count(object));
                        }
                        self.place(object, (id - of.start) as u32, &mut arrays);
                    }
                }
            }
            arrays
        });
        let mut all = Arrays::new(has, levels);
        chunks.into_iter().for_each(|chunk| all.append(chunk));
        all.into_surfels(self.median_radius, self.bounding_sphere())
    }

    /// Whether some surfels have colours, which all have then.
    pub(crate) fn have_colors(&self) -> bool {
        self.has()[0]
    }

    /// Whether some surfels have colours, opacities and half axes.
    fn has(&self) -> [bool; 3] {
        let of = |has: fn(&Surfels) -> bool| {
            self.objects.iter().any(|object| has(&self.geometries[object.geometry].surfels))
        };
        let colored = self.objects.iter().any(|object| object.color.is_some());
        [
            colored || of(|surfels| surfels.color().is_some()),
            of(|surfels| surfels.opacity().is_some()),
            of(|surfels| surfels.tangents().is_some()),
        ]
    }

    /// The levels of prefiltered colours of the geometry that has the most; 0 if none has any.
    /// `Decided:` a geometry with fewer has its last one, or its colour, in the place of the others.
    fn levels(&self) -> usize {
        let geometries = self.objects.iter().map(|object| &self.geometries[object.geometry]);
        let levels = geometries.filter_map(|geometry| geometry.surfels.mipmap());
        levels.map(Mipmap::levels).max().unwrap_or(0)
    }

    /// Appends one surfel in its place.
    fn place(&self, object: u32, surfel: u32, to: &mut Arrays) {
        let (place, surfels) = (&self.places[object as usize], &self.geometry(object).surfels);
        let (moves, i) = (*place != Similarity::IDENTITY, surfel as usize);
        let [mut position, mut normal] = [surfels.position()[i], surfels.normal()[i]];
        let mut radius = surfels.radius()[i];
        if moves {
            place.place(&mut position);
            place.turn(&mut normal);
            place.enlarge(&mut radius);
        }
        if let Some(tangents) = &mut to.tangents {
            tangents.push(match surfels.tangents() {
                Some(own) if moves => own[i].map(|half| place.stretch(half)),
                Some(own) => own[i],
                None => half_axes(normal, radius),
            });
        }
        // It has a direction: it was a unit vector before it was turned.
        unit(&mut normal);
        if let Some(colors) = &mut to.color {
            let painted = self.objects[object as usize].color;
            let own = || surfels.color().map(|colors| colors[i]);
            // -0 becomes 0.
            let color = painted.or_else(own).unwrap_or(self.fill) + Vec3::ZERO;
            colors.push(color);
            if let Some(mipmap) = &mut to.mipmap {
                let own = surfels.mipmap().filter(|_| painted.is_none());
                mipmap.push(own.map(|own| own.of(i)), color);
            }
        }
        if let Some(opacities) = &mut to.opacity {
            opacities.push(surfels.opacity().map_or(1.0, |own| own[i]));
        }
        to.position.push(position);
        to.normal.push(normal);
        to.radius.push(radius);
    }
}
