//! Verify the groups of a client, blended one by one.

use super::drawings::{GroupDrawings, RowDrawings};
use super::planes::{GroupFound, GroupPlanes};
use super::replay::replay;
use crate::error::Result;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::record::rows;
use crate::method::stage::Keep;
use crate::method::transparent::Settings;
use crate::method::transparent::blending::GroupLayers;
use crate::number::Ball;
use crate::number::ball::{Profile, Three};
use crate::verdict::client::Client;
use crate::verdict::marks::PixelMarks;
use crate::verdict::{gaps, planes};

/// The judge of a client's geometry pass.
pub(crate) struct LayersJudge<'a, P: Profile> {
    planes: Vec<GroupPlanes<'a>>,
    drawings: GroupDrawings<P>,
}

/// The findings about the groups at a pixel.
pub(crate) struct LayersFound<P: Profile> {
    pub(crate) groups: Vec<GroupFound<P>>,
    /// Whether a group has several continuations, or is not judged.
    pub(crate) open: bool,
}

impl<'a, P: Profile> LayersJudge<'a, P> {
    /// Orders, projects and shades the surfels.
    pub(crate) fn project(job: &Job<'_>, settings: &Settings, client: &'a Client) -> Result<Self> {
        let drawings = GroupDrawings::project(job, settings)?;
        let planes = (0..drawings.groups()).map(|k| GroupPlanes::new(job, client, k)).collect();
        Ok(Self { planes, drawings })
    }

    /// The names of the planes that are judged.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let groups = self.planes.iter().map(|group| &group.planes);
        planes::names(&GroupLayers::<f32>::PLANES, groups)
    }

    /// The planes of groups that a client lacks.
    pub(crate) fn missing(&self, job: &Job<'_>, client: &Client) -> Vec<String> {
        let (rows, there) = (rows(&GroupLayers::<f32>::PLANES), job.there(Keep::Stages));
        gaps::missing(client, "group", &rows, 0..self.planes.len(), &there)
    }

    /// The fragments of a row of pixels in a tile.
    pub(crate) fn of_row(&self, tile: usize, row: &Rect) -> RowDrawings<P> {
        self.drawings.of_row(tile, row)
    }

    /// Marks a wrong pixel. Only fragments whose depth `stays` count.
    pub(crate) fn judge(
        &self,
        column: usize,
        at: (u32, u32),
        row: &RowDrawings<P>,
        stays: impl Fn(Ball<P>) -> Three,
        pixel: &mut PixelMarks<'_>,
    ) -> LayersFound<P> {
        let mut open = false;
        let groups = self.planes.iter().enumerate().map(|(k, planes)| {
            let found = replay(row.at(column, k), &stays);
            open |= found.all.as_ref().is_none_or(|all| all.len() > 1);
            pixel.doubts(found.doubts);
            planes.judge(at, found.all, pixel)
        });
        LayersFound { groups: groups.collect(), open }
    }
}
