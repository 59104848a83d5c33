//! The planes of depth-images that a client hands in.

use crate::composite::groups::WeightedFragment;
use crate::method::PlaneRow;
use crate::method::record::rows;
use crate::method::single_pass::planes::COUNT;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline};
use crate::verdict::checks::{Report, input, inputs, number, triple, widened};
use crate::verdict::client::{Client, StoredPlane};
use crate::verdict::ewa::client_planes::SumRows;

/// The rows of the compositing pass.
pub(crate) fn sum_rows() -> SumRows {
    let [color, normal, weight] = rows(&WeightedFragment::<f32>::SUMS);
    SumRows { nearest: None, sums: [color, normal, weight, COUNT] }
}

/// The planes of a group's depth-image; each may be missing.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImagePlanes<'a> {
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) id: Option<StoredPlane<'a, u32>>,
    weight: Option<StoredPlane<'a, f64>>,
    normal: Option<StoredPlane<'a, [f64; 3]>>,
    color: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) voronoi: Option<StoredPlane<'a, f64>>,
}

impl<'a> ImagePlanes<'a> {
    pub(super) fn new(client: &'a Client, rows: &[PlaneRow; 6], group: usize) -> Self {
        let [depth, id, weight, normal, color, voronoi] = rows;
        Self {
            depth: client.scalar_of(depth, group),
            id: client.index_of(id, group),
            weight: client.scalar_of(weight, group),
            normal: client.triple_of(normal, group),
            color: client.triple_of(color, group),
            voronoi: client.scalar_of(voronoi, group),
        }
    }

    /// The names of the planes that are there.
    fn names(&self) -> [Option<&'static str>; 6] {
        [
            self.depth.map(|plane| plane.name),
            self.id.map(|plane| plane.name),
            self.weight.map(|plane| plane.name),
            self.normal.map(|plane| plane.name),
            self.color.map(|plane| plane.name),
            self.voronoi.map(|plane| plane.name),
        ]
    }

    /// Whether the client hands in no plane of the image.
    pub(super) fn nothing(&self) -> bool {
        self.names().iter().all(Option::is_none)
    }

    /// Whether the compositing pass finds all planes that it sums.
    pub(super) fn complete(&self, colored: bool) -> bool {
        let color = self.color.is_some() || !colored;
        self.depth.is_some() && self.weight.is_some() && self.normal.is_some() && color
    }

    /// The surfel that the image keeps at a pixel, according to the client.
    pub(super) fn surfel(&self, (x, y): (u32, u32)) -> Option<u32> {
        self.id.map(|plane| *plane.plane.at(x, y))
    }

    /// Checks depth and weighted attributes at a pixel.
    pub(super) fn check<P: Profile>(
        &self,
        at: (u32, u32),
        truth: &WeightedFragment<Ball<P>>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.depth {
            number(0, plane, at, truth.depth, report);
        }
        if let Some(plane) = &self.weight {
            number(0, plane, at, truth.weight, report);
        }
        if let Some(plane) = &self.normal {
            triple(0, plane, at, truth.normal, report);
        }
        if let Some(plane) = &self.color {
            triple(0, plane, at, truth.color, report);
        }
    }

    /// The sample that the compositing pass reads: the client's numbers, where there are any.
    pub(super) fn read<P: Profile>(
        &self,
        at: (u32, u32),
        own: &WeightedFragment<Ball<P>>,
    ) -> WeightedFragment<Ball<P>> {
        // The weight was multiplied by an opacity of at most 1. It may be the stored weight, or the
        // weight before it was stored.
        let lost = self.weight.map_or(0.0, |plane| plane.ball::<P>(at).radius);
        WeightedFragment {
            depth: self.depth.map_or(own.depth, |plane| input(&plane, at)),
            weight: self.weight.map_or(own.weight, |plane| input(&plane, at)),
            normal: self.normal.map_or(own.normal, |plane| inputs(&plane, at)),
            color: self.color.map_or(own.color, |plane| inputs(&plane, at)),
            opacity: widened(own.opacity, lost),
        }
    }
}

/// The names of the planes of all groups, each once, in the order of the rows.
pub(super) fn names(images: &[ImagePlanes<'_>]) -> Vec<&'static str> {
    let all = images.iter().map(ImagePlanes::names);
    let first =
        |a: [Option<_>; 6], b: [Option<_>; 6]| [0, 1, 2, 3, 4, 5].map_inline(|i| a[i].or(b[i]));
    all.fold([None; 6], first).into_iter().flatten().collect()
}
