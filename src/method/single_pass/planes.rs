//! The planes of the stages: where they leave, and where they come in.

use super::compositing::Composite;
use super::geometry::{ImagePixel, opacity};
use super::{DepthTest, Settings};
use crate::composite::groups::WeightedFragment;
use crate::error::Result;
use crate::frame::{NO_ID, NamedPlane};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::surface;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::View;

/// The planes of a depth-image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageRows {
    pub(crate) depth: PlaneRow,
    pub(crate) id: PlaneRow,
    pub(crate) weight: PlaneRow,
    pub(crate) normal: PlaneRow,
    pub(crate) color: PlaneRow,
    pub(crate) voronoi: PlaneRow,
}

impl ImageRows {
    /// The planes by their names: depth, id, weight, normal, colour, Voronoi-enhanced depth.
    pub(crate) const fn new(names: [&'static str; 6]) -> Self {
        use Holds::{Color, Index, Scalar, Vector};
        let [depth, id, weight, normal, color, voronoi] = names;
        let of = PlaneRow::new;
        Self {
            depth: of(
                depth,
                Scalar,
                "world units",
                "depth of the fragment that the group keeps; +inf where there is none",
                When::Stages,
            ),
            id: of(
                id,
                Index,
                "surfel",
                "surfel of the fragment that the group keeps; 0xFFFF_FFFF where there is none",
                When::Stages,
            ),
            weight: of(
                weight,
                Scalar,
                "",
                "weight of the fragment that the group keeps; 0 where there is none",
                When::Stages,
            ),
            normal: of(
                normal,
                Vector,
                "",
                "weight times normal, in world space; 0 where there is none",
                When::Stages,
            ),
            color: of(
                color,
                Color,
                "linear RGB",
                "weight times colour; 0 where there is none",
                When::Colored,
            ),
            voronoi: of(
                voronoi,
                Scalar,
                "bins",
                "Voronoi-enhanced depth of the fragment that the group keeps; +inf where there is \
                 none; under the Voronoi depth test",
                When::Settings,
            ),
        }
    }

    /// All of them.
    pub(crate) const fn all(&self) -> [PlaneRow; 6] {
        [self.depth, self.id, self.weight, self.normal, self.color, self.voronoi]
    }
}

pub(crate) const IMAGES: ImageRows = ImageRows::new([
    "group##.Z",
    "group##.id",
    "group##.weight",
    "group##.normal",
    "group##",
    "group##.voronoi",
]);

pub(crate) const COLOR_SUM: PlaneRow = PlaneRow::new(
    "sums",
    Holds::Color,
    "linear RGB",
    "sum of weight times colour over the visible groups; 0 where there is none",
    When::Colored,
);
pub(crate) const NORMAL_SUM: PlaneRow = PlaneRow::new(
    "sums.normal",
    Holds::Vector,
    "",
    "sum of weight times normal over the visible groups, in world space; 0 where there is none",
    When::Stages,
);
pub(crate) const WEIGHT_SUM: PlaneRow = PlaneRow::new(
    "sums.weight",
    Holds::Scalar,
    "",
    "sum of the weights of the visible groups; 0 where there is none",
    When::Stages,
);
pub(crate) const COUNT: PlaneRow = PlaneRow::new(
    "sums.count",
    Holds::Count,
    "fragments",
    "how many groups are visible, each by one fragment; 0 where there is none",
    When::Stages,
);

/// The stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "geometry", reads: &["projection"], leaves: &IMAGES.all() },
    Stage {
        name: "compositing",
        reads: &["geometry"],
        leaves: &[
            COLOR_SUM,
            NORMAL_SUM,
            WEIGHT_SUM,
            COUNT,
            surface::COLOR,
            surface::DEPTH,
            surface::NORMAL,
            surface::WEIGHT,
            surface::ID,
        ],
    },
    surface::shading(&["compositing"]),
];

/// What the geometry pass leaves.
pub(super) fn geometry<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    images: &[Tiled<ImagePixel<R>>],
) -> Vec<NamedPlane<R>> {
    image_planes(job, &IMAGES, settings.depth, images)
}

/// Somebody's depth-images.
pub(super) fn given_geometry<R: Exact>(
    job: &Job<'_>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Tiled<ImagePixel<R>>>> {
    given_images(job, &IMAGES, given)
}

/// The depth-image of each group.
pub(crate) fn image_planes<R: Exact>(
    job: &Job<'_>,
    rows: &ImageRows,
    depth: DepthTest,
    images: &[Tiled<ImagePixel<R>>],
) -> Vec<NamedPlane<R>> {
    let (colored, voronoi) = (job.scene.surfels.color().is_some(), depth != DepthTest::Plain);
    let mut planes = Vec::new();
    for (k, image) in images.iter().enumerate() {
        planes.push(rows.depth.scalar(k, image.plane(|pixel| pixel.sample.depth)));
        planes.push(rows.id.index(k, image.plane(|pixel| pixel.surfel)));
        planes.push(rows.weight.scalar(k, image.plane(|pixel| pixel.sample.weight)));
        // Adding 0 turns a -0 into +0.
        let normal = image.plane(|pixel| pixel.sample.normal.map(|n| n + R::ZERO));
        planes.push(rows.normal.triple(k, normal));
        if colored {
            planes.push(rows.color.triple(k, image.plane(|pixel| pixel.sample.color)));
        }
        if voronoi {
            planes.push(rows.voronoi.scalar(k, image.plane(|pixel| pixel.z)));
        }
    }
    planes
}

/// Somebody's depth-image of each group of the scene.
///
/// The opacity is that of the surfel, times the weight. Nearness is that of the depth, rounded: so
/// of two images of the same depth the one of the lower surfel is the nearest, where the definition
/// may have told their nearnesses apart. The Voronoi-enhanced depth has done its work.
pub(crate) fn given_images<R: Exact>(
    job: &Job<'_>,
    rows: &ImageRows,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Tiled<ImagePixel<R>>>> {
    let (view, surfels) = (View::new(job.camera), &job.scene.surfels);
    let colored = surfels.color().is_some();
    let image = |k: usize| {
        let (depth, id) = (given.scalar(&rows.depth, k)?, given.ids(&rows.id, k)?);
        let (weight, normal) = (given.scalar(&rows.weight, k)?, given.triple(&rows.normal, k)?);
        let color = colored.then(|| given.triple(&rows.color, k)).transpose()?;
        Ok(given.tiled(|x, y| {
            let (depth, surfel, weight) = (*depth.at(x, y), *id.at(x, y), *weight.at(x, y));
            let opacity = match surfel {
                NO_ID => R::ZERO,
                surfel => weight * opacity(surfels, surfel),
            };
            let normal = *normal.at(x, y);
            let color = color.map_or([R::ZERO; 3], |plane| *plane.at(x, y));
            let sample = WeightedFragment { depth, weight, normal, color, opacity };
            ImagePixel { sample, nearness: view.nearness(depth), z: R::ZERO, surfel }
        }))
    };
    (0..job.index.groups()?.len()).map(image).collect()
}

/// The sums of the compositing pass.
pub(super) fn sums<R: Exact>(
    job: &Job<'_>,
    composites: &Tiled<Composite<R>>,
) -> Vec<NamedPlane<R>> {
    let colored = job.scene.surfels.color().is_some();
    let color = colored.then(|| COLOR_SUM.triple(0, composites.plane(|pixel| pixel.sums.color)));
    let mut planes: Vec<_> = color.into_iter().collect();
    let normal = composites.plane(|pixel| pixel.sums.normal.map(|n| n + R::ZERO));
    planes.push(NORMAL_SUM.triple(0, normal));
    planes.push(WEIGHT_SUM.scalar(0, composites.plane(|pixel| pixel.sums.weight)));
    // At most MAX_GROUPS.
    planes.push(COUNT.count(0, composites.plane(|pixel| pixel.count as u8)));
    planes
}
