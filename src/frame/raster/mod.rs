//! Rasterize triangles and lines exactly: integer arithmetic, one answer.
//!
//! ```text
//!   pixel position (X, Y) ──Snap::fixed──▶ fixed point ──Triangle──▶ pixel, weights of 3 corners
//!                                                      ──Line──────▶ pixel, parameter from a to b
//! ```
//!
//! Rounding happens once, when a corner is snapped. After that, coverage, weights and parameters
//! are exact:
//!
//! - Primitives that share corners neither leave gaps nor overlap.
//! - A picture does not depend on its tiles.
//! - `f32` and `f64` disagree only where they snap a corner differently.
//!
//! Two modules do the work:
//!
//! - [`triangle`]: pixels whose centres are inside, by the top-left rule.
//! - [`mod@line`]: connected lines, one pixel wide.
//!
//! In \[MKC08, sections 4 and 5\] the graphics hardware rasterizes polygons and lines. `Decided:`
//! which pixels those are. Triangles follow the rule that the graphics interfaces share. The
//! interfaces do not agree about lines, so lines follow the rule of [`mod@line`].
//!
//! **Fixed point.** An integer F stands for the coordinate F / 2^bits, with 8 sub-pixel bits as in
//! Direct3D unless said otherwise. Coordinates reach to the **guard band**, |X| <= 2^17 and |Y| <=
//! 2^17 px, twice the largest picture; anything that reaches farther is clipped first
//! ([`crate::splat::clip`]). The guard band and at most 12 bits keep every product here below 2^63.

pub mod line;
mod snap;
pub mod triangle;

#[cfg(test)]
mod tests;

pub use line::Line;
pub use snap::{GUARD_BAND, Snap};
pub use triangle::Triangle;
