//! The points to choose from: the points of a file, or samples of a mesh or of a scene.

use super::super::{warn, warn_of};
use super::{Args, report};
use splatref::frame::Exec;
use splatref::io::ply::ReadOptions;
use splatref::io::scene_file::{FileKind, SceneFile, read_model, read_properties};
use splatref::io::texture;
use splatref::progress::Progress;
use splatref::scene::Cloud;
use splatref::source::candidates::{self, Candidates, Directions, candidates};
use splatref::{Error, Result};

/// Points, and the side of a pixel if they were sampled from pictures.
pub(super) struct InputPoints {
    pub(super) cloud: Cloud,
    pub(super) pixel: Option<f64>,
}

impl From<Candidates> for InputPoints {
    fn from(found: Candidates) -> Self {
        Self { cloud: found.cloud, pixel: Some(found.pixel) }
    }
}

impl Args {
    /// The points of the input.
    pub(super) fn given(&self, exec: &Exec, show: Progress<'_>) -> Result<InputPoints> {
        if FileKind::from_extension(&self.points)? == FileKind::Toml {
            return self.scene(exec, show).map(InputPoints::from);
        }
        let mut cloud = read_model(&self.points, &ReadOptions::default(), exec)?;
        warn_of(&self.points, &mut cloud);
        cloud.normal = cloud.take_normals();
        if !self.properties.is_empty() {
            read_properties(&self.points, &self.properties, &mut cloud)?;
        }
        if !cloud.triangles.is_empty() {
            return self.candidates(cloud, exec, show).map(InputPoints::from);
        }
        self.points_alone(&cloud)?;
        Ok(InputPoints { cloud, pixel: None })
    }

    /// Samples a scene in its first frame.
    fn scene(&self, exec: &Exec, show: Progress<'_>) -> Result<Candidates> {
        let file = SceneFile::open(&self.points)?;
        if file.hierarchy.is_some() {
            let what = "a hierarchy already has its surfels; give a mesh or a scene";
            return Err(Error::Invalid(what.into()));
        }
        let loaded = file.load_polygons(&self.properties, exec, show)?;
        warn(&loaded.warnings);
        dropped(loaded.dropped_primitives);
        let (directions, side) = self.pictures();
        candidates(&loaded.scene, &directions, side, exec, show)
    }

    /// The directions of the pictures, and their size.
    fn pictures(&self) -> (Directions, u32) {
        (self.directions(), self.side.unwrap_or(candidates::SIDE))
    }

    /// Checks, for a file without triangles, that it holds only points, and that no option needs a
    /// mesh.
    fn points_alone(&self, cloud: &Cloud) -> Result<()> {
        let invalid = |what: String| Err(Error::format(&self.points, what));
        if !cloud.edges.is_empty() {
            let edges = cloud.edges.len();
            return invalid(format!(
                "the file has {edges} edges, but lines cannot be ordered; remove them"
            ));
        }
        if self.texture.is_some() {
            return invalid(
                "--texture needs a mesh, but the file has no triangles; remove it".into(),
            );
        }
        match (self.side, self.directions) {
            (None, None) => Ok(()),
            (Some(_), _) => {
                invalid("--side needs a mesh, but the file has no triangles; remove it".into())
            }
            (_, Some(_)) => invalid(
                "--directions needs a mesh, but the file has no triangles; remove it".into(),
            ),
        }
    }

    /// Samples a mesh.
    fn candidates(&self, mut mesh: Cloud, exec: &Exec, show: Progress<'_>) -> Result<Candidates> {
        texture::paint(&mut mesh, &self.points, self.texture.as_deref(), 0, exec)?;
        let (directions, side) = self.pictures();
        let offset = mesh.offset;
        let (mut found, derived) = candidates::of_cloud(mesh, &directions, side, exec, show)?;
        found.cloud.offset = offset;
        dropped(derived.dropped_primitives);
        Ok(found)
    }
}

/// Prints how many triangles were dropped.
fn dropped(triangles: u64) {
    if triangles > 0 {
        report::line("dropped", format!("{triangles} triangles"));
    }
}
