//! Splats by the rule that is supposed.

use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Vector2};
use crate::splat::gaussian::{GaussianShape, ProjectedGaussian};
use crate::splat::ray_disc::RayDisc;
use crate::verdict::checks::widened;
use crate::verdict::client::Storage;
use crate::verdict::supposed::Supposed;

/// A shape by the rule that is supposed.
pub(super) fn supposed_shape<P: Profile>(
    shape: GaussianShape<Ball<P>>,
    supposed: Supposed,
) -> GaussianShape<Ball<P>> {
    if supposed != Supposed::HalfCovariance {
        return shape;
    }
    let half = |part: Ball<P>| widened(part, Storage::Half.radius(part.middle));
    GaussianShape { covariance: shape.covariance.map_inline(half), ..shape }
}

/// An ellipse by the rule that is supposed.
pub(super) fn supposed_ellipse<P: Profile>(
    own: ProjectedGaussian<Ball<P>>,
    supposed: Supposed,
) -> ProjectedGaussian<Ball<P>> {
    let ([xx, xy, yy], [a, b, c]) = (own.ellipse, own.conic);
    match supposed {
        Supposed::Mirrored => {
            ProjectedGaussian { ellipse: [xx, -xy, yy], conic: [a, -b, c], ..own }
        }
        Supposed::Transposed => {
            ProjectedGaussian { ellipse: [yy, xy, xx], conic: [c, b, a], ..own }
        }
        Supposed::CentersWhole => {
            let center = own.center.map(|at| at.floor() + Ball::from_f32(0.5));
            ProjectedGaussian { center, ..own }
        }
        _ => own,
    }
}

/// A disc by the rule that is supposed.
pub(super) fn supposed_disc<P: Profile>(
    own: RayDisc<Ball<P>>,
    supposed: Supposed,
) -> RayDisc<Ball<P>> {
    let RayDisc { center, filter, images: [a, b], .. } = own;
    match supposed {
        Supposed::Mirrored => {
            // The same pixel on the other side of the centre.
            let images = [Vector2::new(a.x, -a.y), Vector2::new(b.x, -b.y)];
            RayDisc { images, ..own }
        }
        Supposed::Transposed => {
            RayDisc { images: [Vector2::new(a.y, a.x), Vector2::new(b.y, b.x)], ..own }
        }
        Supposed::CentersWhole => {
            let whole = |at: Ball<P>| at.floor() + Ball::from_f32(0.5);
            RayDisc { center: center.map(whole), filter: filter.map(whole), ..own }
        }
        _ => own,
    }
}
