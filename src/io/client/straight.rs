//! Divide premultiplied colours by their alpha.

use super::format::F32_STEP;
use crate::frame::Plane;
use crate::number::Real;
use crate::verdict::client::Storage;

/// The divided colours, and how far off each may be.
///
/// Where alpha is 0 the colour stays as it is. The error combines the errors of the product and of
/// alpha. A product in `f32` was rounded once more than a plain colour.
pub(super) fn straight(
    colors: &Plane<[f64; 3]>,
    storage: Storage,
    alphas: &Plane<f64>,
    alpha_storage: Storage,
) -> (Plane<[f64; 3]>, Plane<[f64; 3]>) {
    let (width, height) = (colors.width(), colors.height());
    let pixels = colors.values().iter().zip(alphas.values());
    let both = |(product, &alpha): (&[f64; 3], &f64)| {
        let value = product.map(|p| if alpha == 0.0 { p } else { p / alpha });
        let radius = [0, 1, 2].map(|i| {
            let product_off = storage.radius(product[i]).at_least(F32_STEP * product[i].abs());
            let (alpha_off, least) = off(alpha, alpha_storage);
            match (alpha == 0.0, least > 0.0) {
                (true, _) => storage.radius(product[i]),
                (_, true) => (product_off + value[i].abs() * alpha_off) / least,
                (_, false) => f64::INFINITY,
            }
        });
        (value, radius)
    };
    let (values, radii) = pixels.map(both).unzip();
    (Plane::from_values(width, height, values), Plane::from_values(width, height, radii))
}

/// How far off an alpha may be, and the least value that it may have.
fn off(alpha: f64, storage: Storage) -> (f64, f64) {
    let radius = storage.radius(alpha);
    (radius, alpha - radius)
}
