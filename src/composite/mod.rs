//! Composite fragments with plain functions, each with laws that you can test.
//!
//! - [`bins`]: low-precision and Voronoi-enhanced depth.
//! - [`decide`]: every decision on fragments and cells, by its name.
//! - [`groups`]: the n-ary operator over the depth-images of groups.
//! - [`mod@mean`]: the average of neighbours in a pyramid.
//! - [`over`]: alpha-blend layers from back to front.
//! - [`sum`]: weighted accumulation and normalization.
//! - [`under`]: alpha-blend layers from front to back.

pub mod bins;
pub mod decide;
pub mod groups;
pub mod mean;
pub mod over;
pub mod sum;
pub mod under;
