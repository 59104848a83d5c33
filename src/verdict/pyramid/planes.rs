//! The planes of the picture that a client hands in.

use crate::method::pyramid::planes::{ALPHA, DEPTH, KIND, NORMAL, SHADED, TANGENT};
use crate::verdict::client::{Client, StoredPlane};
use crate::verdict::supposed::Supposed;

/// The planes of the picture; each may be missing.
#[derive(Clone, Copy, Debug)]
pub(super) struct PicturePlanes<'a> {
    pub(super) shaded: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) alpha: Option<StoredPlane<'a, f64>>,
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) normal: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) tangent: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) kind: Option<StoredPlane<'a, u8>>,
    pub(super) supposed: Supposed,
}

impl<'a> PicturePlanes<'a> {
    pub(super) fn new(client: &'a Client) -> Self {
        Self {
            shaded: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
            depth: client.scalar(&DEPTH),
            normal: client.triple(&NORMAL),
            tangent: client.triple(&TANGENT),
            kind: client.count(&KIND),
            supposed: client.supposed,
        }
    }
}
