//! Whether a picture is right: comparison plane by plane, and the usual distances.
//!
//! - [`client`]: the planes of a client, and how exactly each is stored.
//! - [`compare`]: equal bit for bit, or where and by how much not.
//! - [`digest`]: one hash of many pictures.
//! - [`mod@laws`]: what must hold of compositing operators, anybody's.
//! - [`metrics`]: RMSE, PSNR and SSIM of planes, holes and spill.
//! - [`mod@signature`]: known mistakes, and which of them a client makes.
//! - [`verdict`]: what a right implementation may leave, and whether a client's planes are that.

pub mod client;
pub mod compare;
pub mod digest;
pub mod laws;
pub mod metrics;
pub mod signature;
pub mod verdict;
