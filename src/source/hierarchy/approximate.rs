//! Choose the surfels of a node: how many, from which pictures, in which order \[BJFM19, 3.4 and
//! 5.2\].
//!
//! **Count.** "We bounded the surfel count for an object by the minimum of 200k surfels and half
//! the complexity of the approximated object (number of triangles). Objects with a complexity of
//! below 1000 triangles were only approximated in groups in a higher hierarchy level." Let T be the
//! number of triangles of a node and of all below it, and n the [most](Settings::most). In a node
//! over objects, a triangle counts once for each object that shows it. In a node of a geometry's
//! tree, it counts once, however many objects show the geometry:
//!
//! ```text
//!   count = 0 if T < 1000, else min(n, floor(T / 2))
//! ```
//!
//! **Pictures.** [`mod@crate::source::candidates`] come from square pictures with the side
//!
//! ```text
//!   side = ceil(s sqrt(count / 200000)), at least 16, then at most s      s: Settings::side; in f64
//! ```
//!
//! Everything is drawn again with the side min(2 side, s), and so on, while two things hold: the
//! side is less than s, and there are fewer than 4 candidates for each of the surfels (4 count), or
//! none at all.
//!
//! `Decided:` the paper draws pictures of 1024 pixels of everything, for 10k to 200k surfels. Here
//! only a node with the paper's bound of surfels has that side. Smaller nodes have as many
//! candidates for each of their surfels, because "a much higher resolution unnecessarily increases
//! the preprocessing time". The candidates of a sphere are about 11 times its surfels. A node that
//! covers little of its box, such as houses far apart, gets larger pictures.
//!
//! **Order.** The surfels are the first `count` of the candidates in the order of the sampler, or
//! all if there are fewer. Greedy and progressive orders start at [`Start::Seed`] of the
//! [seed](Settings::seed); progressive and random orders also use it as their random seed.
//!
//! **What is drawn** depends on the traversal ("in a top-down or bottom-up order"):
//!
//! - [`Traversal::TopDown`]: all triangles of the node and below it, which must fit into memory
//!   together. Their order is the same as bottom-up, as if no node below had surfels.
//! - [`Traversal::BottomUp`]: "one can use the already computed surfels of the child nodes instead
//!   of the original geometry". First come the triangles that stay in the node, then child after
//!   child. A child is drawn as its surfels, as hexagons, if it has some; else by this same rule.
//!   The objects of a node of the scene count as its children, in their order, before its nodes.
//!   Surfels are the decoded ones of the file; every corner of a hexagon has the opacity and the
//!   properties of its surfel. Surfels are placed, and rounded to `f32`, before their hexagons are
//!   made.
//!
//! The view draws as many of a child's surfels as cover at the resolution of the picture, by the
//! estimate of [`crate::scene::objects::detail::prefix`]. Let P = 2 R / side ([`pixel`]), where R
//! is half the diagonal of the node's box, or 1 if that is 0; k the scale of the child's place; n
//! its surfels; `p_m` and `r_m` its estimate. In f64:
//!
//! ```text
//!   r      = P / k
//!   p      = min(n, ceil(p_m (q q))), at least 1      q = r_m / r
//!   radius = max(r, r_m sqrt(p_m / n)) k              rounded to f32 once
//! ```
//!
//! The first p surfels are drawn as [hexagons](super::parts::Gathered::hexagons) in their discs of
//! this `radius`. `Decided:` hexagons in discs, so that every candidate lies on a disc. The corners
//! of squares around the discs float sqrt(2) times as far beyond an edge, and twice as far above a
//! curved surface; and samplers choose what floats first. A hexagon reaches at least 0.87 of the
//! radius, and the estimate asks for discs that are 1.06 to 1.18 times as large as covering needs.
//! More corners cost more time, and did not cover better. `Decided:` no more than p, so that the
//! number of hexagons is bounded by the surface at the picture's resolution, however many triangles
//! lie below.
//!
//! If the triangles cover no pixel's centre, the node has no surfels, and the nodes above draw what
//! is below it.

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::objects::detail::prefix::Estimate;
use crate::scene::{Cloud, Primitives, Scene, Surfels, Triangles};
use crate::source::candidates::{self, Directions, candidates};
use crate::source::sampler::{Greedy, Order, Progressive, Schedule, Start, shuffled};
use glam::Vec3;

/// The paper's bound on the number of surfels.
pub const MOST: u32 = 200_000;
/// A node with fewer triangles has no surfels.
pub const LEAST: u64 = 1000;
/// The least side of a picture.
const LEAST_SIDE: u32 = 16;
/// The fewest candidates for each surfel.
const CANDIDATES: u64 = 4;

/// The input from which the surfels of a node are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traversal {
    /// All triangles.
    TopDown,
    /// The surfels of the nodes below, where they have some.
    BottomUp,
}

/// The sampler that orders candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// [`Greedy`].
    Greedy,
    /// [`Progressive`].
    Progressive(Schedule),
    /// [`shuffled`].
    Random,
}

/// Settings of an approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The most surfels of a node, at least 1.
    pub most: u32,
    /// The side of the pictures of a node of [`MOST`] surfels, in pixels.
    pub side: u32,
    /// The directions from which nodes are seen.
    pub directions: Directions,
    /// The sampler that orders candidates.
    pub sampler: Sampler,
    /// Random seed.
    pub seed: u64,
    /// The input of each node.
    pub traversal: Traversal,
    /// The names of further properties that surfels take from the vertices.
    pub properties: Vec<String>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            most: MOST,
            side: candidates::SIDE,
            directions: Directions::Cube,
            sampler: Sampler::Greedy,
            seed: 0,
            traversal: Traversal::BottomUp,
            properties: Vec::new(),
        }
    }
}

impl Settings {
    /// The most surfels of a node with this number of triangles.
    #[must_use]
    pub fn count(&self, triangles: u64) -> u32 {
        if triangles < LEAST { 0 } else { (triangles / 2).min(u64::from(self.most)) as u32 }
    }

    /// The side of the first pictures of a node with this number of surfels.
    #[must_use]
    pub fn side_of(&self, count: u32) -> u32 {
        let part = (f64::from(count) / f64::from(MOST)).sqrt();
        let side = (f64::from(self.side) * part).ceil() as u32;
        side.max(LEAST_SIDE).min(self.side)
    }
}

/// The side of a pixel in world units, for pictures with this side of a box.
#[must_use]
pub fn pixel(side: u32, low: Vec3, high: Vec3) -> f64 {
    let half = (high.as_dvec3() - low.as_dvec3()).length() / 2.0;
    let radius = if half > 0.0 { half } else { 1.0 };
    2.0 * radius / f64::from(side)
}

/// How many surfels of a child are drawn, and the radius of their discs; `pixel` is the side
/// of a pixel in the coordinates of the child.
#[must_use]
pub fn drawn(estimate: Estimate, count: u32, pixel: f64) -> (u32, f64) {
    let (p_m, r_m) = (f64::from(estimate.count), f64::from(estimate.distance));
    let q = r_m / pixel;
    let covering = (p_m * (q * q)).ceil();
    let all = r_m * (p_m / f64::from(count)).sqrt();
    // The cast takes numbers out of range to the nearest u32.
    ((covering as u32).min(count).max(1), if all > pixel { all } else { pixel })
}

/// The surfels of a node, in their order: positions, normals, colours, and opacities and properties
/// if vertices have them. None if no triangle covers a pixel's centre. `drawn` gives the triangles
/// for pictures of a side.
///
/// # Errors
/// As `drawn`; [`Error::Invalid`] as [`candidates()`].
pub fn approximate(
    drawn: &dyn Fn(u32) -> Result<Triangles>,
    count: u32,
    settings: &Settings,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Cloud> {
    let mut side = settings.side_of(count);
    let cloud = loop {
        let found = seen(drawn(side)?, side, settings, exec, progress)?;
        let few = (found.position.len() as u64) < CANDIDATES * u64::from(count);
        if !few || side == settings.side {
            break found;
        }
        side = side.saturating_mul(2).min(settings.side);
    };
    if cloud.position.is_empty() {
        return Ok(cloud);
    }
    let order = settings.order(&cloud.position, count as usize, exec, progress)?;
    Ok(cloud.some(&order.index))
}

/// The candidates of these triangles; empty if no pixel sees any.
fn seen(
    triangles: Triangles,
    side: u32,
    settings: &Settings,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Cloud> {
    if triangles.is_empty() {
        return Ok(Cloud::default());
    }
    let primitives = Primitives { triangles, ..Primitives::default() };
    let scene = Scene { primitives, ..Scene::unlit("node", Surfels::none()) };
    match candidates(&scene, &settings.directions, side, exec, progress) {
        Ok(found) => Ok(found.cloud),
        Err(Error::Invalid(what)) if what.starts_with(UNSEEN) => Ok(Cloud::default()),
        Err(error) => Err(error),
    }
}

/// The beginning of the error of [`candidates()`] if there are none.
const UNSEEN: &str = "no triangle covers the centre of a pixel";

impl Settings {
    fn order(
        &self,
        points: &[Vec3],
        count: usize,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Order> {
        let (start, seed) = (Start::Seed(self.seed), self.seed);
        match self.sampler {
            Sampler::Greedy => Greedy { start }.order(points, count, exec, progress),
            Sampler::Progressive(schedule) => {
                Progressive { start, seed, schedule }.order(points, count, progress)
            }
            Sampler::Random => shuffled(points, seed, count, progress),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Vertices;
    use std::cell::RefCell;

    #[test]
    fn counts_and_sides_by_hand() {
        let settings = Settings::default();
        let counts = [0, 999, 1000, 1001, 399_999, 400_000, u64::MAX].map(|n| settings.count(n));
        assert_eq!(counts, [0, 0, 500, 500, 199_999, 200_000, 200_000]);
        let sides = [1, 49, 500, 50_000, 200_000, 900_000].map(|n| settings.side_of(n));
        assert_eq!(sides, [16, 17, 52, 512, 1024, 1024]);
        let few = Settings { most: 7, side: 9, ..settings };
        assert_eq!((few.count(u64::MAX), few.side_of(7), few.side_of(200_000)), (7, 9, 9));
        assert_eq!(pixel(9, Vec3::ZERO, Vec3::new(2.0, 3.0, 6.0)), 7.0 / 9.0);
        assert_eq!(pixel(9, Vec3::ONE, Vec3::ONE), 2.0 / 9.0);
    }

    #[test]
    fn what_is_drawn_of_a_child_by_hand() {
        let estimate = Estimate { count: 1000, distance: 1.0 };
        // Half the distance takes four times as many.
        assert_eq!(drawn(estimate, 100_000, 0.5), (4000, 0.5));
        assert_eq!(drawn(estimate, 4000, 0.25), (4000, 0.5));
        assert_eq!(drawn(estimate, 100_000, 100.0), (1, 100.0));
        assert_eq!(drawn(Estimate { count: 1, distance: 0.0 }, 1, 3.0), (1, 3.0));
    }

    fn soup(position: Vec<Vec3>) -> Triangles {
        let n = position.len();
        let (direction, radius) = (vec![Vec3::Z; n], vec![0.0; n]);
        let vertices = Vertices { position, direction, radius, color: None, ..Vertices::default() };
        Triangles::new(vertices, vec![[0, 1, 2]]).unwrap().0
    }

    #[test]
    fn what_nobody_sees_has_no_surfels_and_what_is_small_is_seen_larger() {
        let exec = Exec::sequential();
        let quiet = |_: &str, _, _| ();
        let of = |triangles: Triangles, count| {
            let sides = RefCell::new(Vec::new());
            let drawn = |side| {
                sides.borrow_mut().push(side);
                Ok(triangles.clone())
            };
            let settings = Settings { side: 100, ..Settings::default() };
            let cloud = approximate(&drawn, count, &settings, &exec, &quiet).unwrap();
            (cloud.position.len(), sides.take())
        };
        assert_eq!(of(Triangles::default(), 10), (0, vec![16, 32, 64, 100]));
        let point = soup(vec![Vec3::ONE; 3]);
        assert_eq!(of(point, 10).0, 0, "the words of candidates are those known here");
        let triangle = || soup(vec![Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(of(triangle(), 10), (10, vec![16]));
        assert_eq!(of(triangle(), 300), (300, vec![16, 32, 64]));
    }
}
