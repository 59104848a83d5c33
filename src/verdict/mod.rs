//! Verify a client's picture: verdicts on its planes, stage by stage.
//!
//! Hand in your planes and get a verdict. It needs no tolerance.
//! [`Session::verify`](crate::method::Session::verify) recomputes each stage in
//! [balls](crate::number::ball), from the planes that a [`client::Client`] has of the stage before.
//! The verdict says whether an implementation that keeps its promise of rounding may have left the
//! client's planes: [`Outcome`].
//!
//! The page of each method says what a verdict tests in each of its stages: [`mod@ewa`],
//! [`mod@deferred`], [`mod@single_pass`], [`mod@transparent`], [`mod@transparent_hq`],
//! [`mod@peeling`], [`mod@pyramid`], [`mod@template`], [`mod@blue`], [`mod@gaussians`]. The projection that `pyramid`
//! and `template` begin with has a page too: [`mod@projection`].
//!
//! - [`client`]: the planes of a client, and how exactly each is stored. Files:
//!   [`io::client`](crate::io::client).
//! - [`Verdict`]: the findings, with a [`Fault`] for each wrong pixel.
//! - [`causes`]: known mistakes, and which of them a client makes.
//! - [`Unlike`]: whether the errors are those of a correct renderer, all together.
//! - [`conformance`]: small scenes, one for each rule of a method, and a report on a renderer.
//! - [`shift`]: whether the undecided decisions lean to one side, over a suite of scenes.
//!
//! If you do not need a verdict: [`crate::compare`] compares planes with planes, and
//! [`crate::laws`] tests compositing operators.

pub mod blue;
pub mod causes;
mod checks;
pub mod client;
pub mod conformance;
pub mod deferred;
mod doubt;
pub mod ewa;
mod fault;
mod findings;
mod gaps;
pub mod gaussians;
mod marks;
mod outcomes;
pub mod peeling;
mod planes;
pub mod projection;
pub mod pyramid;
mod session;
pub mod shift;
pub mod single_pass;
mod storage;
mod supposed;
mod table;
pub mod template;
#[cfg(test)]
mod tests;
pub mod transparent;
pub mod transparent_hq;
mod unlike;

pub use doubt::Doubt;
pub use fault::{Check, Fault};
pub(crate) use findings::Cause;
pub use findings::{Causes, Finding, Outcome, StageVerdict, Verdict};
pub use unlike::Unlike;
