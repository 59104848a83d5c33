//! Order points so that every prefix covers the surface \[BJFM19, 3.2\].
//!
//! Order points:
//!
//! - [`greedy`]: compute the exact farthest-point order.
//! - [`geodesic`]: compute the greedy order along a surface, around thin walls.
//! - [`progressive`]: compute the paper's order, the farthest of some random points; or a random
//!   order.
//!
//! Improve and measure an order:
//!
//! - [`cells`]: average colours over the cell of each point.
//! - [`mod@estimate`]: estimate how densely an order covers.
//! - [`mod@quality`]: measure how evenly a prefix is spread.
//! - [`mod@spectrum`]: measure at which frequencies a prefix is even.

pub mod cells;
pub mod estimate;
pub mod geodesic;
pub mod greedy;
mod nearest;
pub mod progressive;
pub mod quality;
mod search;
pub mod spectrum;

pub use cells::averaged;
pub use estimate::estimate;
pub use geodesic::Graph;
pub use greedy::{Greedy, Order, Start};
pub use progressive::{Progressive, Schedule, shuffled};
pub use quality::{Quality, quality};
pub use spectrum::{Spectrum, spectrum};
