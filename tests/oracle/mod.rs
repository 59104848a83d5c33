//! The oracle: pictures computed in another way, known answers, laws, and bits.
//!
//! A test goes into the folder of its method. If it belongs to no single method, it goes into the
//! files beside the folders. Scenes, cameras, pictures and planes come only from [`kit`].
//!
//! - [`kit`]: builders of scenes, the one place that draws, planes by name, numbers that carry their
//!   error, the projection to pixels, tables of tolerances and goldens, for all oracles.
//! - [`ewa`]: the 2+1-pass method by a renderer in f64 without tiles, bins or bounds. It shares no
//!   formula with the crate.
//! - [`deferred`]: deferred splatting, frame by frame of moving objects, over the splats of
//!   [`ewa`].
//! - [`single_pass`]: Algorithm 1 by brute force, and where it equals the 2+1-pass method.
//! - [`transparent`]: Algorithms 2 and 3 by every surfel in every group, environments and
//!   refraction by angles.
//! - [`gaussians`]: 3D Gaussian splats by the images of their axes, harmonics by Legendre functions.
//! - [`peeling`]: depth peeling, all fragments of a pixel in one band of depth after the other.
//! - [`pyramid`]: the pull-push pyramid, a cell at a time, over numbers that bound their rounding.
//! - [`template`]: reconstruction with templates, where a pixel asks every centre of every level.
//! - [`blue`]: discs in squares, every surfel at every pixel: the page again, and rays in world
//!   space.
//! - [`sampler`]: candidates by every pixel of every triangle, orders by every distance to every
//!   pick.
//! - [`detail`]: levels of detail: estimates of orders, prefixes and finer objects, the folders of
//!   hierarchies.
//! - [`composite`]: laws of the operators: bins, groups, over, sums and the epsilon-z test.
//! - [`bits`]: fast and plain, threads and tiles, to the last bit.
//! - [`bounds`]: no pixel outside a splat's bounds is inside the splat.
//! - [`counter`]: a third number runs every formula and counts its operations.
//! - [`three`]: a number whose comparisons have three outcomes. [`three_outcomes`]: every decision
//!   and every formula over this number.
//!
//! The files of a method have roles. A method has only those it needs, and more laws and known
//! answers under their own names.
//!
//! - `model`: the oracle's own computation.
//! - `cases`: the scenes to draw.
//! - `stages`: compares every plane of every stage of every case and golden with the model.
//! - `tolerance`: the table of how far a plane may be from the model, and why.
//! - `known`: pictures whose numbers are known in closed form.
//! - `laws`: the laws of a method, for every scene.
//!
//! Enter a new golden in `kit::goldens`, which fails while no method takes it.
#![expect(
    clippy::disallowed_methods,
    reason = "std's functions, so that the oracle shares no code with the crate; its bits are free"
)]

mod bits;
mod blue;
mod bounds;
mod composite;
mod counter;
mod deferred;
mod detail;
mod ewa;
mod gaussians;
mod kit;
mod layered;
mod peeling;
mod pyramid;
mod sampler;
mod single_pass;
mod template;
mod three;
mod three_outcomes;
mod transparent;
