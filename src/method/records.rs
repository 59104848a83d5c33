//! Export the visible splats of a picture as bytes, for a backend to upload.

use super::Method;
use super::algorithm::Job;
use super::gaussians::record::{self, GaussianRecord};
use crate::frame::Exec;
use crate::index::Index;
use crate::scene::{Camera, Scene};
use crate::splat::Tally;
use crate::splat::record::{SplatRecord, project_records, shared_numbers};

/// The visible splats of a picture, projected in `f32`.
#[derive(Clone, Debug)]
pub struct Records {
    /// The records one after the other: [`SplatRecord`]s in ascending surfel index, or
    /// [`GaussianRecord`]s in the order in which they are blended.
    pub bytes: Vec<u8>,
    /// The number of bytes of a record.
    pub size: usize,
    /// Name, offset in bytes and type of each field of a record.
    pub fields: &'static [(&'static str, usize, &'static str)],
    /// The numbers that all records share, each with its name.
    pub shared: Vec<(&'static str, f32)>,
    /// The fates of all surfels or Gaussians.
    pub tally: Tally,
}

impl Method {
    /// Whether the method draws splats, so that it has records.
    #[must_use]
    pub fn has_records(&self) -> bool {
        matches!(self, Self::Gaussians(_)) || self.splats().is_some()
    }

    /// Projects the visible splats of a picture; none: the method draws no splats.
    #[must_use]
    pub fn records(&self, scene: &Scene, camera: &Camera, exec: &Exec) -> Option<Records> {
        if let Self::Gaussians(settings) = self {
            let index = Index::default();
            let job = Job::new(scene, &index, camera, exec);
            let (records, tally) = record::project_records(&job, settings);
            let bytes = records.iter().flat_map(GaussianRecord::to_bytes).collect();
            let (size, fields) = (GaussianRecord::SIZE, &GaussianRecord::FIELDS);
            return Some(Records { bytes, size, fields, shared: Vec::new(), tally });
        }
        let splats = self.splats()?;
        let (records, tally) = project_records(&scene.surfels, camera, &splats.kernel, splats.cull);
        let bytes = records.iter().flat_map(SplatRecord::to_bytes).collect();
        let shared = shared_numbers(camera, &splats.kernel);
        let (size, fields) = (SplatRecord::SIZE, &SplatRecord::FIELDS);
        Some(Records { bytes, size, fields, shared, tally })
    }
}
