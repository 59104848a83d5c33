//! The table of verdicts: one row for each method.

use super::client::Client;
use super::{Check, Verdict};
use super::{
    blue, deferred, ewa, gaussians, peeling, pyramid, single_pass, template, transparent,
    transparent_hq,
};
use crate::error::Result;
use crate::method::{Job, Method};
use crate::number::ball::Profile;

/// Judges the planes of a client against the planes that a correct implementation may leave of each
/// stage. If the fraction of undecided sums exceeds `budget`, the picture cannot be judged.
///
/// # Errors
/// [`crate::Error::Invalid`] if the method cannot draw the scene with these settings.
pub(super) fn verify<P: Profile>(
    method: &Method,
    job: &Job<'_>,
    client: &Client,
    budget: f64,
) -> Result<Verdict> {
    match method {
        Method::Ewa(settings) => Ok(ewa::verify::<P>(job, settings, client, budget)),
        Method::Deferred(settings) => deferred::verify::<P>(job, settings, client, budget),
        Method::SinglePass(settings) => single_pass::verify::<P>(job, settings, client, budget),
        Method::Transparent(settings) => transparent::verify::<P>(job, settings, client, budget),
        Method::TransparentHq(settings) => {
            transparent_hq::verify::<P>(job, settings, client, budget)
        }
        Method::Peeling(settings) => Ok(peeling::verify::<P>(job, settings, client, budget)),
        Method::Pyramid(settings) => Ok(pyramid::verify::<P>(job, settings, client, budget)),
        Method::Template(settings) => Ok(template::verify::<P>(job, settings, client, budget)),
        Method::Blue(settings) => Ok(blue::verify::<P>(job, settings, client, budget)),
        Method::Gaussians(settings) => Ok(gaussians::verify::<P>(job, settings, client, budget)),
    }
}

/// The numbers that are wrong in the records of a client.
pub(super) fn wrong_fields<P: Profile>(
    method: &Method,
    job: &Job<'_>,
    client: &Client,
) -> Vec<ewa::WrongField> {
    match (method, &client.records, &client.gaussian_records) {
        (Method::Ewa(settings), Some(records), _) => ewa::wrong_fields::<P>(job, settings, records),
        (Method::Gaussians(settings), _, Some(records)) => {
            gaussians::wrong_fields::<P>(job, settings, records)
        }
        _ => Vec::new(),
    }
}

/// Every check of a client at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture; else as [`verify`].
pub(super) fn checks<P: Profile>(
    method: &Method,
    job: &Job<'_>,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    match method {
        Method::Ewa(settings) => ewa::checks::<P>(job, settings, client, pixel),
        Method::Deferred(settings) => deferred::checks::<P>(job, settings, client, pixel),
        Method::SinglePass(settings) => single_pass::checks::<P>(job, settings, client, pixel),
        Method::Transparent(settings) => transparent::checks::<P>(job, settings, client, pixel),
        Method::TransparentHq(settings) => {
            transparent_hq::checks::<P>(job, settings, client, pixel)
        }
        Method::Peeling(settings) => peeling::checks::<P>(job, settings, client, pixel),
        Method::Pyramid(settings) => pyramid::checks::<P>(job, settings, client, pixel),
        Method::Template(settings) => template::checks::<P>(job, settings, client, pixel),
        Method::Blue(settings) => blue::checks::<P>(job, settings, client, pixel),
        Method::Gaussians(settings) => gaussians::checks::<P>(job, settings, client, pixel),
    }
}
