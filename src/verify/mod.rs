//! Whether a picture is right: comparison plane by plane, the usual distances, and verdicts.
//!
//! A verdict takes no tolerance. [`Session::verify`](crate::method::Session::verify) recomputes each
//! stage in [balls](crate::number::ball) from the planes that a [`client::Client`] has of the stage before,
//! and says whether an implementation that keeps its promise of rounding may have left the client's
//! planes: [`verdict::Outcome`]. What is asked of each stage is said in the page `verify` of each
//! method: [`ewa`](crate::method::ewa::verify), [`single-pass`](crate::method::single_pass::verify),
//! [`transparent`](crate::method::transparent::verify),
//! [`transparent-hq`](crate::method::transparent_hq::verify), [`peeling`](crate::method::peeling::verify),
//! [`pyramid`](crate::method::pyramid::verify), [`template`](crate::method::template::verify),
//! [`blue`](crate::method::blue::verify). Files: [`io::client`](crate::io::client).
//!
//! - [`client`]: the planes of a client, and how exactly each is stored.
//! - [`compare`]: equal bit for bit, or where and by how much not.
//! - [`digest`]: one hash of many pictures.
//! - [`mod@laws`]: what must hold of compositing operators, anybody's.
//! - [`metrics`]: how far a picture is off, in numbers: colours, coverage, outline, depth, normals,
//!   flicker.
//! - [`mod@signature`]: known mistakes, and which of them a client makes.
//! - [`shift`]: whether the decisions that may be either way lean to one side, over a suite of scenes.
//! - [`verdict`]: what a right implementation may leave, and whether a client's planes are that.

pub mod client;
pub mod compare;
pub mod digest;
pub mod laws;
pub mod metrics;
pub mod shift;
pub mod signature;
pub mod verdict;
