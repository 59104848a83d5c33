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
    /// How each record is laid out.
    pub layout: RecordLayout,
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

/// The bytes of a record.
#[derive(Clone, Copy, Debug)]
pub struct RecordLayout {
    /// The number of bytes of a record, and the distance from one to the next.
    pub size: usize,
    /// Name, offset in bytes and type of each field, in order: `u32`, `f32 x 3`.
    pub fields: &'static [(&'static str, usize, &'static str)],
}

impl RecordLayout {
    const SPLATS: Self = Self { size: SplatRecord::SIZE, fields: &SplatRecord::FIELDS };
    const GAUSSIANS: Self = Self { size: GaussianRecord::SIZE, fields: &GaussianRecord::FIELDS };
}

impl Records {
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
    /// How the records of the method are laid out; none: the method draws no splats.
    #[must_use]
    pub fn record_layout(&self) -> Option<RecordLayout> {
        match self {
            Self::Gaussians(_) => Some(RecordLayout::GAUSSIANS),
            _ => self.splats().map(|_| RecordLayout::SPLATS),
        }
    }

    /// Projects the visible splats of a picture; none: the method draws no splats.
    #[must_use]
    pub fn records(&self, scene: &Scene, camera: &Camera, exec: &Exec) -> Option<Records> {
        let layout = self.record_layout()?;
        if let Self::Gaussians(settings) = self {
            let index = Index::default();
            let job = Job::new(scene, &index, camera, exec);
            let (all, tally) = record::project_records(&job, settings);
            return Some(Records { all: Kind::Gaussians(all), layout, shared: Vec::new(), tally });
        }
        let splats = self.splats()?;
        let (all, tally) = project_records(&scene.surfels, camera, &splats.kernel, splats.cull);
        let shared = shared_numbers(camera, &splats.kernel);
        Some(Records { all: Kind::Splats(all), layout, shared, tally })
    }
}
