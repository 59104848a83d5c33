//! Samplers: points in an order of which every prefix is spread over all of them \[BJFM19, 3.2\].
//!
//! - [`greedy`]: the exact farthest-point order.

pub mod greedy;

pub use greedy::{Greedy, Order, Start};
