//! Whether a picture is right: comparison plane by plane, and the usual distances.
//!
//! - [`compare`]: equal bit for bit, or where and by how much not.
//! - [`digest`]: one hash of many pictures.
//! - [`metrics`]: RMSE, PSNR and SSIM of planes, holes and spill.

pub mod compare;
pub mod digest;
pub mod metrics;
