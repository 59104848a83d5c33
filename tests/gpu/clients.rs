//! Every right client, with the scenes that it draws.

use crate::bugs::Bug;
use crate::device::Gpu;
use crate::ewa_raster::Variant;
use crate::scenes::{Job, of_ewa, of_pyramid, of_single_pass};
use crate::{ewa_compute, ewa_raster, pyramid, single_pass};
use splatref::verdict::client::Client;

/// A right client.
pub(crate) struct RightClient {
    pub(crate) name: &'static str,
    pub(crate) jobs: fn() -> Vec<Job>,
    pub(crate) draw: fn(&Gpu, &Job) -> Client,
}

pub(crate) const EWA_RECORDS: RightClient = RightClient {
    name: "`ewa`, raster, splatref's records",
    jobs: of_ewa,
    draw: |gpu, job| ewa_raster::draw(gpu, job, Variant { records: true, ..Variant::default() }),
};
pub(crate) const EWA_PROJECTION: RightClient = RightClient {
    name: "`ewa`, raster, own projection",
    jobs: of_ewa,
    draw: |gpu, job| ewa_raster::draw(gpu, job, Variant::default()),
};
pub(crate) const EWA_HALF: RightClient = RightClient {
    name: "`ewa`, raster, own projection, 16-bit sums",
    jobs: of_ewa,
    draw: |gpu, job| ewa_raster::draw(gpu, job, Variant { half: true, ..Variant::default() }),
};
pub(crate) const COMPUTE_RECORDS: RightClient = RightClient {
    name: "`ewa`, compute, splatref's records",
    jobs: of_ewa,
    draw: |gpu, job| ewa_compute::draw(gpu, job, true, Bug::None),
};
pub(crate) const COMPUTE_PROJECTION: RightClient = RightClient {
    name: "`ewa`, compute, own records",
    jobs: of_ewa,
    draw: |gpu, job| ewa_compute::draw(gpu, job, false, Bug::None),
};
pub(crate) const SINGLE_PASS: RightClient = RightClient {
    name: "`single-pass`, raster",
    jobs: of_single_pass,
    draw: |gpu, job| single_pass::draw(gpu, job, Bug::None),
};
pub(crate) const PYRAMID: RightClient = RightClient {
    name: "`pyramid`, raster and compute",
    jobs: of_pyramid,
    draw: |gpu, job| pyramid::draw(gpu, job, Bug::None),
};

/// All of them.
pub(crate) const ALL: [RightClient; 7] = [
    EWA_RECORDS,
    EWA_PROJECTION,
    EWA_HALF,
    COMPUTE_RECORDS,
    COMPUTE_PROJECTION,
    SINGLE_PASS,
    PYRAMID,
];

/// The bugs that a client is drawn with.
pub(crate) struct Seeded {
    pub(crate) client: &'static str,
    pub(crate) jobs: fn() -> Vec<Job>,
    pub(crate) draw: fn(&Gpu, &Job, Bug) -> Client,
    pub(crate) bugs: &'static [Bug],
}

pub(crate) const SEEDED: [Seeded; 3] = [
    Seeded {
        client: EWA_PROJECTION.name,
        jobs: of_ewa,
        draw: |gpu, job, bug| ewa_raster::draw(gpu, job, Variant { bug, ..Variant::default() }),
        bugs: &Bug::EWA,
    },
    Seeded {
        client: SINGLE_PASS.name,
        jobs: of_single_pass,
        draw: single_pass::draw,
        bugs: &Bug::SINGLE_PASS,
    },
    Seeded { client: PYRAMID.name, jobs: of_pyramid, draw: pyramid::draw, bugs: &Bug::PYRAMID },
];
