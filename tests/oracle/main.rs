//! The oracle: the picture by other means, known answers, laws, and bits.
//!
//! - [`kit`]: what every oracle shares.
//! - [`ewa`], [`single_pass`], [`transparent`], [`peeling`], [`pyramid`], [`template`]: a folder for
//!   each method.
//! - [`composite`]: laws of the operators.
//! - [`bounds`]: no pixel outside a splat's bounds is inside the splat.
//! - [`counter`]: a third number runs every formula and counts its operations.
//! - [`three`]: a number whose comparisons have three outcomes; [`three_outcomes`]: every decision
//!   and every formula that it can be asked.
//! - [`bits`]: fast and plain, threads and tiles, to the last bit.
#![expect(
    clippy::disallowed_methods,
    reason = "std's functions, so that the oracle shares no code with the crate; its bits are free"
)]

mod bits;
mod bounds;
mod composite;
mod counter;
mod ewa;
mod kit;
mod peeling;
mod pyramid;
mod single_pass;
mod template;
mod three;
mod three_outcomes;
mod transparent;
