//! Samplers: points in an order of which every prefix is spread over all of them \[BJFM19, 3.2\].
//!
//! - [`greedy`]: the exact farthest-point order.
//! - [`mod@quality`]: how evenly a prefix is spread.

pub mod greedy;
pub mod quality;

pub use greedy::{Greedy, Order, Start};
pub use quality::{Quality, quality};
