//! Choose how large the discs of prefixes are, and how much of an object and of its finer objects
//! is drawn \[BJFM19, 4, 4.1, 4.4\].
//!
//! **Objects and finer objects.** Objects may form a forest: the finer objects of an object show
//! the same surfaces with more surfels. The primitives of a geometry that has a
//! [prefix](super::prefix) are the surfaces themselves. "We blend between the node's approximation
//! and its children's approximations or original geometry by gradually decreasing the number of
//! rendered surfels for the node while increasing the number of rendered surfels of the child nodes
//! or rendering the original geometry." `Decided:` each object has a weight w, which is 1 if no
//! object is coarser. Let the object have n surfels, and let p = p(r) be asked for. In f64:
//!
//! ```text
//!   fade    = 0 if there is nothing finer, else min(max(((p / n) - 1) / 0.3, 0), 1)
//!   own     = w min(2 (1 - fade), 1)
//!   drawn   = 0 if own = 0, else min(max(ceil(own min(p, n)), 1), n)
//!   weight of each finer object, and of the primitives  =  w min(2 fade, 1)
//! ```
//!
//! So the fade begins where all n surfels are asked for: the paper blends "when a surfel
//! approximation \[...\] cannot sufficiently cover the visible geometry \[...\] anymore". It ends where
//! 1.3 n are asked for, as in the authors' program. In its first half the finer objects grow; in its
//! second half the coarser object shrinks. One of both is always drawn whole. If one shrank while
//! the other grew, there would be holes halfway, because two prefixes of half the length know
//! nothing of each other. `Departs:` in the authors' program, finer objects are whole as soon as the
//! fade begins. Primitives are drawn where their weight is greater than 0, because a surface is
//! either there or not. The same holds for an object without a prefix, whose finer objects have its
//! weight w.
//!
//! **Where p(r) exceeds n** and own > 0, the surfels that are drawn get the radius with which n
//! surfels cover, `r_n` = `r_m` sqrt(`p_m` / n). `Decided:` here discs grow beyond the size asked for;
//! with a fixed size there would be holes. Where something is finer, they grow to at most
//! sqrt(1.3) times that size before they are gone. Where nothing is finer, all n are drawn, because
//! nothing more is known of the surface.
//!
//! **Size.** s is the [size](Refinement::surfel_size) asked for, z the factor of the object's zone,
//! and r = (size (`d_p` z)) / 2, where size is s, or a greater number because of the budget. In the
//! world, discs have the radius r k, or `r_n` k, with the scale k of the object. The side of the
//! [square](crate::scene::Sides) of a surfel is size z, or (size z) (`r_n` / r). Both are brought
//! between 2^-100 and 2^100, then rounded to f32.
//!
//! **Zones** \[4.4\]: pairs of a distance from the principal point of the camera, in pixels, and a
//! factor of the size, "interpolate\[d\] \[...\] between zones on a per-object basis". Between the
//! pairs (a, from) and (b, to) the factor at the distance d is
//! `from + (to - from) ((d - a) / (b - a))`, in f64. The first factor holds before the first
//! distance, and the last factor behind the last; at equal distances the later pair counts.
//! `Decided:` the distance of an object is the distance of the middle of its sphere on the screen,
//! less the sphere's radius there, at least 0. In f64, with the middle (x, y) at the depth t in
//! view space, R the radius, and f the greater of fx and fy:
//!
//! ```text
//!   a = (fx x) / t     b = (fy y) / t     max(sqrt(a a + b b) - (f R) / t, 0), but 0 if t <= R
//!   a = fx x           b = fy y           max(sqrt(a a + b b) - f R, 0), whatever t      orthographic
//! ```
//!
//! **Budget**: at most this many surfels of prefixes are drawn, the best first. The best are the
//! surfels whose prefix has the widest gaps on the screen. So one greater size, common to all
//! objects, replaces the size asked for. The sizes tried are s, s (65/64), (s (65/64)) (65/64) and
//! so on, numbered k = 0 up to k = 2048. k is 0 if the objects draw no more than the budget with s.
//! Otherwise k is found by bisection: start with `(few, many) = (2048, 0)`. While `few - many > 1`,
//! take `k = (few + many) / 2`, rounded down; few becomes k if the objects draw no more than the
//! budget with it, else many becomes k. The result is k = few. Fades follow the greater size, so
//! finer objects give way to coarser ones. If the objects draw more even then, the surfels after
//! the budget in the order of objects are left out: one object may keep its first surfels.
//! Primitives stay as they are.
//!
//! An object with a prefix draws neither surfels nor primitives if its sphere is not in the view
//! frustum. [`super`] defines the test; the margin is 16 + s z, with the s that is asked for and
//! not the budget's. Its finer objects have the weight that they would have if it were in sight.

use super::prefix::Prefix;
use super::{Disc, DrawnPart, Eye, MARGIN};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::number::MapInline;
use crate::number::Real;
use crate::scene::objects::{Detail, Objects};
use crate::scene::{Projection, Sphere};
use std::sync::Arc;

/// The largest size of discs of prefixes, in pixels.
pub const MOST_SIZE: f32 = 4096.0;

/// What a view asks of prefixes.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// s: the diameter of discs where an object is nearest, in pixels, in (0, [`MOST_SIZE`]].
    pub surfel_size: f32,
    /// The most surfels of prefixes that are drawn; if absent, all that are asked for.
    pub budget: Option<u32>,
    /// Distances from the principal point in pixels, ascending, and factors of the size there,
    /// greater than 0.
    pub zones: Vec<[f32; 2]>,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { surfel_size: 2.0, budget: None, zones: Vec::new() }
    }
}

impl Refinement {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        let invalid = |what| Err(Error::Invalid(what));
        if !(self.surfel_size > 0.0 && self.surfel_size <= MOST_SIZE) {
            let size = self.surfel_size;
            return invalid(format!(
                "discs of {size} pixels; give more than 0, at most {MOST_SIZE}"
            ));
        }
        if self.budget == Some(0) {
            return invalid("a budget of 0 surfels; give at least 1".into());
        }
        let sound = |[distance, factor]: &[f32; 2]| {
            (0.0..f32::INFINITY).contains(distance) && *factor > 0.0 && *factor <= MOST_SIZE
        };
        if let Some([distance, factor]) = self.zones.iter().find(|zone| !sound(zone)) {
            return invalid(format!(
                "a zone at {distance} pixels with factor {factor}; give a distance >= 0 and a \
                 factor above 0, at most {MOST_SIZE}"
            ));
        }
        if !self.zones.is_sorted_by(|a, b| a[0] <= b[0]) {
            return invalid("zones must be sorted by distance".into());
        }
        Ok(())
    }

    /// The factor of the size at a distance from the principal point.
    #[must_use]
    pub fn factor(&self, distance: f64) -> f64 {
        let zones: Vec<[f64; 2]> =
            self.zones.iter().map(|zone| zone.map_inline(f64::from)).collect();
        let after = zones.partition_point(|zone| zone[0] <= distance);
        match (after.checked_sub(1).map(|before| zones[before]), zones.get(after)) {
            (None, None) => 1.0,
            (None, Some(first)) => first[1],
            (Some(last), None) => last[1],
            (Some([a, from]), Some([b, to])) => from + (to - from) * ((distance - a) / (b - a)),
        }
    }
}

/// The forest of objects and their finer objects.
#[derive(Clone, Debug)]
pub(in crate::scene::objects) struct Forest {
    /// For each object, the coarser object, if there is one.
    coarser: Vec<Option<u32>>,
    /// Whether each object has finer ones.
    has_finer: Vec<bool>,
    /// All objects, each after its coarser object.
    order: Vec<u32>,
}

impl Forest {
    /// Makes the forest from the coarser object of each object, if it has one.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is not one entry for each object, if an entry is no object, or
    /// if an object is finer than itself.
    fn new(coarser: Vec<Option<u32>>, objects: usize) -> Result<Self> {
        let invalid = |what| Err(Error::Invalid(what));
        if coarser.len() != objects {
            return invalid(format!("{} finer objects, but there are {objects}", coarser.len()));
        }
        let mut finer: Vec<Vec<u32>> = vec![Vec::new(); objects];
        let mut order = Vec::with_capacity(objects);
        for (object, of) in (0..).zip(&coarser) {
            match of {
                None => order.push(object),
                Some(of) if (*of as usize) < objects => finer[*of as usize].push(object),
                Some(of) => {
                    return invalid(format!("an object refines object {of}, which does not exist"));
                }
            }
        }
        let mut next = 0;
        // From the roots down: this never reaches objects that are finer than themselves.
        while let Some(&object) = order.get(next) {
            order.extend(&finer[object as usize]);
            next += 1;
        }
        if order.len() < objects {
            return invalid("objects refine themselves in a circle".into());
        }
        let has_finer = finer.iter().map(|finer| !finer.is_empty()).collect();
        Ok(Self { coarser, has_finer, order })
    }
}

/// What a camera asks of an object.
#[derive(Clone, Copy)]
struct Asked {
    /// `d_p` times the factor of the zone.
    pixel: f64,
    /// The factor of the zone.
    factor: f64,
    seen: bool,
}

/// The amount that is drawn of an object.
#[derive(Clone, Copy, Default)]
struct Drawn {
    /// The surfels of a prefix.
    count: u32,
    /// The weight of the object, and the weight of its primitives.
    weight: f64,
    of_primitives: f64,
}

impl Objects {
    /// Replaces what views ask of prefixes.
    ///
    /// # Errors
    /// As [`Refinement::check`].
    pub fn with_refinement(self, refinement: Refinement) -> Result<Self> {
        refinement.check()?;
        Ok(Self { refinement: Arc::new(refinement), ..self })
    }

    /// Makes the objects a forest: `coarser` has the coarser object of each object, if it has one.
    ///
    /// # Errors
    /// [`Error::Invalid`] if that is no forest, or if an object without a prefix has surfels and
    /// finer objects.
    pub fn with_coarser(self, coarser: Vec<Option<u32>>) -> Result<Self> {
        let forest = Forest::new(coarser, self.objects.len())?;
        for (object, _) in (0..).zip(&forest.has_finer).filter(|(_, has)| **has) {
            let geometry = self.geometry(object);
            if !geometry.surfels.is_empty() && geometry.prefix().is_none() {
                let name = &self.objects[object as usize].name;
                let what = format!("{name} has finer objects, but its surfels are not ordered");
                return Err(Error::Invalid(what));
            }
        }
        Ok(Self { forest: Some(Arc::new(forest)), ..self })
    }

    /// The coarser object of an object, if it has one.
    #[must_use]
    pub fn coarser(&self, object: u32) -> Option<u32> {
        self.forest.as_ref().and_then(|forest| forest.coarser[object as usize])
    }

    /// Whether some geometry has prefixes.
    #[must_use]
    pub fn have_prefixes(&self) -> bool {
        self.geometries.iter().any(|geometry| geometry.prefix().is_some())
    }

    /// What views ask of prefixes.
    #[must_use]
    pub fn refinement(&self) -> &Refinement {
        &self.refinement
    }

    /// Chooses what a camera draws of each object.
    pub(super) fn refined(&self, eye: &Eye, exec: &Exec) -> Vec<DrawnPart> {
        let all: Vec<u32> = (0..self.objects.len() as u32).collect();
        let asked = exec.ordered(all.clone(), |object| self.asked(object, eye));
        let (size, drawn) = self.within_budget(&asked);
        exec.ordered(all, |object| {
            let at = object as usize;
            let Drawn { count, weight, of_primitives } = drawn[at];
            let geometry = self.geometry(object);
            let seen = asked[at].seen;
            // Without levels of detail an object is drawn even out of sight, unless it has faded
            // out.
            match &geometry.detail {
                _ if weight == 0.0 => DrawnPart::nothing(),
                None => DrawnPart { count: self.count_of_all(object), ..DrawnPart::default() },
                Some(_) if !seen => DrawnPart::nothing(),
                Some(Detail::Tree(tree)) => {
                    let (count, mask) = tree.drawn(geometry, &self.places[at], eye);
                    DrawnPart { count, mask: Some(Arc::new(mask)), ..DrawnPart::default() }
                }
                Some(Detail::Prefix(prefix)) => DrawnPart {
                    count,
                    disc: Some(self.disc_with(object, prefix, size, &asked[at])),
                    primitives: of_primitives > 0.0,
                    mask: None,
                },
            }
        })
    }

    /// What a camera asks of an object.
    fn asked(&self, object: u32, eye: &Eye) -> Asked {
        let (place, sphere) = (&self.places[object as usize], self.sphere(object));
        match &self.geometry(object).detail {
            None => Asked { pixel: 0.0, factor: 1.0, seen: true },
            Some(Detail::Tree(tree)) => {
                let seen = eye.may_see(sphere, MARGIN + tree.threshold());
                Asked { pixel: 0.0, factor: 1.0, seen }
            }
            Some(Detail::Prefix(prefix)) => {
                let factor = self.refinement.factor(eye.off_principal_point(sphere));
                let side = f64::from(self.refinement.surfel_size) * factor;
                let seen = eye.may_see(sphere, MARGIN + side);
                Asked { pixel: prefix.pixel(place, eye) * factor, factor, seen }
            }
        }
    }

    /// Finds the size that keeps the budget, and what is drawn with it.
    fn within_budget(&self, asked: &[Asked]) -> (f64, Vec<Drawn>) {
        let mut size = f64::from(self.refinement.surfel_size);
        let drawn = self.drawn_with(size, asked);
        let total = |drawn: &[Drawn]| drawn.iter().map(|one| u64::from(one.count)).sum::<u64>();
        let Some(budget) = self.refinement.budget.map(u64::from) else { return (size, drawn) };
        if total(&drawn) <= budget {
            return (size, drawn);
        }
        let sizes: Vec<f64> = (0..=STEPS)
            .map(|k| {
                size *= if k == 0 { 1.0 } else { 65.0 / 64.0 };
                size
            })
            .collect();
        let (mut few, mut many) = (STEPS, 0);
        while few - many > 1 {
            let k = usize::midpoint(few, many);
            let fits = total(&self.drawn_with(sizes[k], asked)) <= budget;
            *(if fits { &mut few } else { &mut many }) = k;
        }
        // Even the largest size may exceed the budget: then the last objects lose their surfels.
        let mut drawn = self.drawn_with(sizes[few], asked);
        let mut left = budget;
        for one in &mut drawn {
            one.count = u64::from(one.count).min(left) as u32;
            left -= u64::from(one.count);
        }
        (sizes[few], drawn)
    }

    /// What is drawn with a size: this pushes the weights down the forest.
    fn drawn_with(&self, size: f64, asked: &[Asked]) -> Vec<Drawn> {
        let mut drawn = vec![Drawn { count: 0, weight: 1.0, of_primitives: 1.0 }; asked.len()];
        let mut one = |object: u32, coarser: Option<u32>| {
            let weight = coarser.map_or(1.0, |of| drawn[of as usize].of_primitives);
            let geometry = self.geometry(object);
            // An object without a prefix only passes its weight on.
            let Some(prefix) = geometry.prefix() else {
                drawn[object as usize] = Drawn { count: 0, weight, of_primitives: weight };
                return;
            };
            let all = f64::from(prefix.count());
            let Asked { pixel, seen, .. } = asked[object as usize];
            let wanted = prefix.covering(size * pixel / 2.0);
            let fade = if self.has_finer(object) {
                ((wanted / all - 1.0) / FADE).clamped(0.0, 1.0)
            } else {
                0.0
            };
            let own = weight * (2.0 * (1.0 - fade)).at_most(1.0);
            let count = if own > 0.0 && seen {
                (own * wanted.at_most(all)).ceil().clamped(1.0, all) as u32
            } else {
                0
            };
            let finer = weight * (2.0 * fade).at_most(1.0);
            drawn[object as usize] = Drawn { count, weight, of_primitives: finer };
        };
        match &self.forest {
            None => (0..asked.len() as u32).for_each(|object| one(object, None)),
            Some(forest) => {
                let all = forest.order.iter();
                all.for_each(|&object| one(object, forest.coarser[object as usize]));
            }
        }
        drawn
    }

    /// Whether anything shows the surfaces of an object better than its surfels.
    fn has_finer(&self, object: u32) -> bool {
        let forest = self.forest.as_ref();
        forest.is_some_and(|forest| forest.has_finer[object as usize])
            || self.extents[self.objects[object as usize].geometry].primitives
    }

    /// The discs of an object with a prefix.
    fn disc_with(&self, object: u32, prefix: &Prefix, size: f64, asked: &Asked) -> Disc {
        let (mut radius, mut side) = (size * asked.pixel / 2.0, size * asked.factor);
        let of_all = prefix.radius_of_all();
        // More surfels are asked for than there are: with the size asked for there would be holes.
        if of_all > radius {
            side *= of_all / radius;
            radius = of_all;
        }
        let scale = self.places[object as usize].scale;
        let radius = (radius * scale).clamped(LEAST, 1.0 / LEAST);
        let most = f64::from(f32::MAX);
        Disc { radius: radius as f32, side: side.clamped(LEAST, most) as f32 }
    }
}

/// From n to (1 + this) n surfels asked for, an object gives way to finer ones.
const FADE: f64 = 0.3;
/// The most steps by which the size grows until the budget holds.
const STEPS: usize = 2048;
/// 2^-100.
const LEAST: f64 = 1.0 / 1_267_650_600_228_229_401_496_703_205_376.0;

impl Eye {
    /// How far a sphere is from the principal point on the screen, in pixels; of a stereo pair, in the
    /// picture where it is nearer.
    fn off_principal_point(&self, Sphere { center: middle, radius }: Sphere) -> f64 {
        let v = self.view_from_world.transform_point3(middle);
        let (depth, fx, fy) = (-v.z, f64::from(self.camera.fx), f64::from(self.camera.fy));
        let m = match self.camera.projection {
            Projection::Orthographic => 1.0,
            Projection::Perspective if depth > radius => 1.0 / depth,
            Projection::Perspective => return 0.0,
        };
        let [one, other] = self.shifts.map_inline(|shift| {
            let (x, y) = (fx * ((v.x + shift) * m), fy * (v.y * m));
            (x * x + y * y).sqrt()
        });
        (one.at_most(other) - self.focal() * (radius * m)).at_least(0.0)
    }
}
