//! Whether a picture is right: comparison plane by plane, and the usual distances.
//!
//! - [`compare`]: equal bit for bit, or where and by how much not.
//! - [`digest`]: one hash of many pictures.
//! - [`mod@laws`]: what must hold of compositing operators, anybody's.
//! - [`metrics`]: RMSE, PSNR and SSIM of planes, holes and spill.

pub mod compare;
pub mod digest;
pub mod laws;
pub mod metrics;
