//! Export the visible splats of a picture as bytes, for a backend to upload.

use super::Method;
use super::algorithm::Job;
use super::gaussians::record::{self, GaussianRecord};
use crate::frame::Exec;
use crate::index::Index;
use crate::scene::{Camera, Scene};
use crate::splat::Tally;
use crate::splat::record::{SplatRecord, project_records, shared_numbers};
use std::io::{self, Write};

/// The visible splats of a picture, projected in `f32`.
#[derive(Clone, Debug)]
pub struct Records {
    all: Kind,
    /// The numbers that all records share, each with its name.
    pub shared: Vec<(&'static str, f32)>,
    /// The fates of all surfels or Gaussians.
    pub tally: Tally,
}

/// The records of one kind.
#[derive(Clone, Debug)]
enum Kind {
    /// In ascending surfel index.
    Splats(Vec<SplatRecord>),
    /// In the order in which they are blended.
    Gaussians(Vec<GaussianRecord>),
}

impl Records {
    /// The number of bytes of a record.
    #[must_use]
    pub fn size(&self) -> usize {
        match self.all {
            Kind::Splats(_) => SplatRecord::SIZE,
            Kind::Gaussians(_) => GaussianRecord::SIZE,
        }
    }

    /// Name, offset in bytes and type of each field of a record.
    #[must_use]
    pub fn fields(&self) -> &'static [(&'static str, usize, &'static str)] {
        match self.all {
            Kind::Splats(_) => &SplatRecord::FIELDS,
            Kind::Gaussians(_) => &GaussianRecord::FIELDS,
        }
    }

    /// Writes the records one after the other.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn write(&self, file: &mut dyn Write) -> io::Result<()> {
        match &self.all {
            Kind::Splats(all) => all.iter().try_for_each(|own| file.write_all(&own.to_bytes())),
            Kind::Gaussians(all) => all.iter().try_for_each(|own| file.write_all(&own.to_bytes())),
        }
    }
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
            let (all, tally) = record::project_records(&job, settings);
            return Some(Records { all: Kind::Gaussians(all), shared: Vec::new(), tally });
        }
        let splats = self.splats()?;
        let (all, tally) = project_records(&scene.surfels, camera, &splats.kernel, splats.cull);
        let shared = shared_numbers(camera, &splats.kernel);
        Some(Records { all: Kind::Splats(all), shared, tally })
    }
}
