//! Surfels of objects in their places.

use super::{Geometry, Objects};
use crate::error::Result;
use crate::frame::Exec;
use crate::number::MapInline;
use crate::scene::cloud::half_axes;
use crate::scene::degenerate::unit;
use crate::scene::surfels::Arrays;
use crate::scene::transform::Similarity;
use crate::scene::{Boxes, Mipmap, Primitives, Sphere, Surfels, bounds};
use glam::Vec3;
use std::ops::Range;

/// How many surfels one job places.
const CHUNK: usize = 1 << 13;

/// Numbers of placed surfels stay between this, 2^-100, and its inverse. That is far from where f32
/// ends, so a valid surfel stays valid.
const LEAST: f64 = 1.0 / 1_267_650_600_228_229_401_496_703_205_376.0;

/// The numbers of a geometry that each of its objects needs in each frame.
#[derive(Clone, Debug)]
pub(super) struct Extent {
    pub(super) boxes: Boxes,
    /// The sphere around surfels and primitives.
    pub(super) sphere: Sphere,
    /// The least of all radii and half axes.
    pub(super) least: f64,
    /// How many surfels there are, whether they have been read or not.
    pub(super) count: u32,
    /// How many are drawn where no camera is known, and their median radius.
    pub(super) at_rest: (u32, f32),
    /// Which attributes the surfels have.
    pub(super) has: Has,
    /// Whether there are primitives, and whether some have colours.
    pub(super) primitives: bool,
    pub(super) colored: bool,
}

impl Extent {
    pub(super) fn new(geometry: &Geometry) -> Self {
        let surfels = &geometry.surfels;
        let halves = surfels.tangents().unwrap_or_default().iter().flatten();
        let halves = halves.map(|half| half.as_dvec3().length());
        let radii = surfels.radius().iter().map(|&radius| f64::from(radius));
        let less = |least, size| if size < least { size } else { least };
        let least = radii.chain(halves).fold(f64::INFINITY, less);
        let sphere = match &geometry.detail {
            // Discs of inner nodes reach farther, but not on the screen.
            Some(detail) => detail.sphere(),
            None => bounds::sphere(surfels, &geometry.primitives),
        };
        Self {
            boxes: Boxes::new(surfels),
            sphere,
            least,
            count: surfels.len() as u32,
            at_rest: geometry.at_rest(),
            has: [
                surfels.color().is_some(),
                surfels.opacity().is_some(),
                surfels.tangents().is_some(),
            ],
            primitives: !geometry.primitives.is_empty(),
            colored: geometry.primitives.colored(),
        }
    }

    /// Whether surfels stay valid in a place.
    pub(super) fn is_in_range(&self, place: &Similarity) -> bool {
        let Sphere { center: middle, radius } = self.sphere;
        let far = (middle.length() + radius) * place.scale + place.translation.length();
        far <= 1.0 / LEAST && self.least * place.scale >= LEAST
    }
}

/// Surfels that one job places.
enum Part<'a> {
    /// The drawn surfels of ranges, object by object.
    Ranges(Vec<(u32, Range<u32>)>),
    /// The surfels with these ids.
    Ids(&'a [u64]),
}

/// Which attributes surfels have beside positions, normals and radii: colours, opacities and half
/// axes.
type Has = [bool; 3];

impl Objects {
    /// Places all surfels that are drawn, in the order of their ids, and the primitives in the
    /// order of the scene.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`crate::scene::indexed::Indexed::new`].
    pub fn flattened(&self, exec: &Exec) -> Result<(Surfels, Vec<Primitives>)> {
        let all = self.ids.order().iter().map(|&object| (object, 0..self.ids.count(object)));
        Ok((self.gather(jobs(all.collect()), exec), self.primitives()?))
    }

    /// Places the primitives of all objects that have some and draw them, in the order of the scene.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`crate::scene::indexed::Indexed::new`].
    pub fn primitives(&self) -> Result<Vec<Primitives>> {
        // A million objects without primitives would take half a gigabyte for empty lists.
        let has = |object: u32| !self.geometry(object).primitives.is_empty();
        let shown = (0..self.objects.len())
            .filter(|&object| self.shown[object].primitives && has(object as u32));
        let placed = shown.map(|object| {
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
        placed.collect()
    }

    /// Places the surfels with these ascending ids, with their prefiltered colours; ids that belong
    /// to no surfel are left out.
    #[must_use]
    pub fn some(&self, ids: &[u64], exec: &Exec) -> Surfels {
        self.gather(ids.chunks(CHUNK).map(Part::Ids).collect(), exec)
    }

    /// Places surfels with all attributes that some surfels have.
    fn gather(&self, parts: Vec<Part<'_>>, exec: &Exec) -> Surfels {
        let (has, levels) = (self.has(), self.levels());
        let chunks = exec.ordered(parts, |part| {
            let mut arrays = Arrays::new(has, levels);
            match part {
                Part::Ranges(ranges) => {
                    for (object, range) in ranges {
                        let drawn = self.drawn(object);
                        let is_drawn = |&i: &u32| drawn.is_none_or(|drawn| drawn.has(i as usize));
                        self.place(object, range.filter(is_drawn), &mut arrays);
                    }
                }
                Part::Ids(ids) => {
                    for (object, run) in self.ids.runs(ids) {
                        let first = self.ids.id(object, 0);
                        let surfels = run.iter().map(|id| (id - first) as u32);
                        self.place(object, surfels, &mut arrays);
                    }
                }
            }
            arrays
        });
        let mut all = Arrays::new(has, levels);
        all.reserve(chunks.iter().map(|chunk| chunk.position.len()).sum());
        chunks.into_iter().for_each(|chunk| all.append(chunk));
        all.into_surfels(self.median_radius, self.bounding_sphere())
    }

    /// Whether an object has primitives with colours.
    fn have_colored_primitives(&self) -> bool {
        self.objects.iter().any(|object| self.extents[object.geometry].colored)
    }

    /// Whether some surfels or primitives have colours; then all surfels have.
    pub(crate) fn have_colors(&self) -> bool {
        self.has()[0]
    }

    /// Whether some surfels have colours, opacities and half axes.
    fn has(&self) -> Has {
        let of = |i: usize| self.objects.iter().any(|object| self.extents[object.geometry].has[i]);
        let colored = self.objects.iter().any(|object| object.color.is_some());
        [colored || of(0) || self.have_colored_primitives(), of(1), of(2)]
    }

    /// The levels of prefiltered colours of the geometry that has the most; 0 if none has any.
    /// `Decided:` in a geometry with fewer, its last level, or its colour, stands for the missing
    /// ones.
    fn levels(&self) -> usize {
        let geometries = self.objects.iter().map(|object| &self.geometries[object.geometry]);
        let levels = geometries.filter_map(|geometry| geometry.surfels.mipmap());
        levels.map(Mipmap::levels).max().unwrap_or(0)
    }

    /// Appends surfels of an object in their places.
    fn place(&self, object: u32, of: impl Iterator<Item = u32>, to: &mut Arrays) {
        let (place, surfels) = (&self.places[object as usize], &self.geometry(object).surfels);
        let (moves, color) = (*place != Similarity::IDENTITY, self.objects[object as usize].color);
        let disc = self.disc(object).map(|disc| disc.radius);
        for i in of {
            let i = i as usize;
            let [mut position, mut normal] = [surfels.position()[i], surfels.normal()[i]];
            let mut radius = surfels.radius()[i];
            // An object in the identity place keeps every bit of its surfels.
            if moves {
                place.place(&mut position);
                place.turn(&mut normal);
                place.enlarge(&mut radius);
            }
            let radius = disc.unwrap_or(radius);
            if let Some(tangents) = &mut to.tangents {
                tangents.push(match surfels.tangents().filter(|_| disc.is_none()) {
                    Some(own) if moves => own[i].map_inline(|half| place.stretch(half)),
                    Some(own) => own[i],
                    None => half_axes(normal, radius),
                });
            }
            // The normal has a direction, because it was a unit vector before it was turned.
            unit(&mut normal);
            if let Some(colors) = &mut to.color {
                let own = || surfels.color().map(|colors| colors[i]);
                // Adding 0 turns -0 into 0.
                let shown = color.or_else(own).unwrap_or(self.fill) + Vec3::ZERO;
                colors.push(shown);
                if let Some(mipmap) = &mut to.mipmap {
                    let own = surfels.mipmap().filter(|_| color.is_none());
                    mipmap.push(own.map(|own| own.of_surfel(i)), shown);
                }
            }
            if let Some(opacities) = &mut to.opacity {
                opacities.push(surfels.opacity_of(i));
            }
            to.position.push(position);
            to.normal.push(normal);
            to.radius.push(radius);
        }
    }
}

/// Divides ranges into jobs of about [`CHUNK`] surfels.
fn jobs(ranges: Vec<(u32, Range<u32>)>) -> Vec<Part<'static>> {
    let (mut jobs, mut job, mut room) = (Vec::new(), Vec::new(), CHUNK);
    for (object, mut range) in ranges {
        while !range.is_empty() {
            let some = range.start..range.end.min(range.start.saturating_add(room as u32));
            range.start = some.end;
            room -= some.len();
            job.push((object, some));
            if room == 0 {
                jobs.push(Part::Ranges(std::mem::take(&mut job)));
                room = CHUNK;
            }
        }
    }
    jobs.push(Part::Ranges(job));
    jobs
}
