//! The epsilon-z test: which fragments belong to the visible surface.

use crate::number::Exact;

/// The greatest depth that still belongs to the surface whose nearest fragment lies at `nearest`:
/// `nearest + epsilon`.
///
/// Depths are > 0 under a perspective camera; `epsilon` is >= 0 and may be +inf.
#[inline(always)]
pub fn limit<R: Exact>(nearest: R, epsilon: R) -> R {
    nearest + epsilon
}

/// Whether a fragment of depth `t` belongs to the visible surface: `t <= limit(nearest, epsilon)`,
/// the limit included.
///
/// The conservative test of \[ZP06, section 3.2, Fig. 5, line 6\] and of the 2+1-pass methods
/// before it. Laws: the nearest fragment always passes; epsilon = 0 keeps the depth of the nearest
/// alone; epsilon = +inf keeps everything; a greater epsilon never drops a fragment that a smaller
/// kept.
#[inline(always)]
pub fn visible<R: Exact>(t: R, nearest: R, epsilon: R) -> bool {
    t <= limit(nearest, epsilon)
}
