//! Samplers: points in an order of which every prefix is spread over all of them \[BJFM19, 3.2\].
//!
//! - [`mod@estimate`]: how densely an order covers.
//! - [`cells`]: colours averaged over what a point stands for.
//! - [`geodesic`]: the greedy order along a surface, around thin walls.
//! - [`greedy`]: the exact farthest-point order.
//! - [`progressive`]: the paper's, of some points by chance the farthest; and points by chance alone.
//! - [`mod@quality`]: how evenly a prefix is spread.
//! - [`mod@spectrum`]: at which frequencies it is even.

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
