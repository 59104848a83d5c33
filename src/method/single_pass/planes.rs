//! List the planes that each stage leaves, and read them back from a client.

use super::DepthTest;
use super::compositing::Composite;
use super::geometry::{ImagePixel, opacity};
use crate::composite::groups::WeightedFragment;
use crate::error::Result;
use crate::frame::{NO_ID, NamedPlane};
use crate::method::Job;
use crate::method::input_planes::InputPlanes;
use crate::method::record::Part::{Id, Number, Triple};
use crate::method::record::{self, Field, joined, rows};
use crate::method::stage::Holds::{Color, Count, Depth, Diagnostic, Index, Scalar, Vector};
use crate::method::stage::{Keep, PlaneRow, Stage, When};
use crate::method::surface::{self, SurfacePixel};
use crate::method::tiled::Tiled;
use crate::number::{Exact, MapInline};
use crate::splat::View;

/// The planes of a depth-image. `##` is the group.
macro_rules! image {
    ($group:literal) => {
        [
            Field::new(concat!($group, ".Z"), Depth, Number(|p: &mut Self| &mut p.sample.depth))
            .says("depth of the fragment that the group keeps; +inf where there is none"),
            Field::new(concat!($group, ".id"), Index, Id(|p: &mut Self| &mut p.surfel))
            .unit("surfel")
            .says("surfel of the fragment that the group keeps; 0xFFFF_FFFF where there is none"),
            Field::new(concat!($group, ".weight"), Scalar, Number(|p: &mut Self| &mut p.sample.weight))
            .says("weight of the fragment that the group keeps; 0 where there is none"),
            Field::new(concat!($group, ".normal"), Vector, Triple(|p: &mut Self| &mut p.sample.normal))
            .says("weight times normal, in world space; 0 where there is none"),
            Field::new($group, Color, Triple(|p: &mut Self| &mut p.sample.color))
            .when(When::Colored)
            .says("weight times colour; 0 where there is none"),
            Field::new(concat!($group, ".voronoi"), Diagnostic, Number(|p: &mut Self| &mut p.z))
            .unit("bins").when(When::Settings)
            .says("Voronoi-enhanced depth of the fragment that the group keeps; +inf where there is \
                 none; under the Voronoi depth test"),
        ]
    };
}

/// The planes of a depth-image.
pub(crate) type ImageFields<R> = [Field<ImagePixel<R>, R>; 6];

impl<R> ImagePixel<R> {
    /// The planes of the depth-images of this method.
    pub(crate) const GROUPS: ImageFields<R> = image!("group##");
    /// The planes of the depth-images of [`mod@crate::method::transparent_hq`].
    pub(crate) const NEAREST: ImageFields<R> = image!("nearest.group##");
}

impl<R> WeightedFragment<R> {
    /// The planes of the sums of the compositing pass.
    pub(crate) const SUMS: [Field<Self, R>; 3] = [
        Field::new("sums", Color, Triple(|p: &mut Self| &mut p.color))
            .when(When::Colored)
            .says("sum of weight times colour over the visible groups; 0 where there is none"),
        Field::new("sums.normal", Vector, Triple(|p: &mut Self| &mut p.normal)).says(
            "sum of weight times normal over the visible groups, in world space; 0 where \
             there is none",
        ),
        Field::new("sums.weight", Scalar, Number(|p: &mut Self| &mut p.weight))
            .says("sum of the weights of the visible groups; 0 where there is none"),
    ];
}

/// The count of visible groups in the compositing pass.
pub(crate) const COUNT: PlaneRow = PlaneRow::new(
    "sums.count",
    Count,
    "how many groups are visible, each by one fragment; 0 where there is none",
)
.unit("fragments");

/// The stages.
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "geometry", reads: &["projection"], leaves: &rows(&ImagePixel::<f32>::GROUPS) },
    Stage {
        name: "compositing",
        reads: &["geometry"],
        leaves: joined!(
            rows(&WeightedFragment::<f32>::SUMS),
            [COUNT],
            rows(&SurfacePixel::<f32>::PLANES)
        ),
    },
    surface::shading(&["compositing"]),
];

/// Makes the planes of the depth-image of each group.
pub(crate) fn image_planes<R: Exact>(
    job: &Job<'_>,
    fields: &ImageFields<R>,
    depth: DepthTest,
    images: &[Tiled<ImagePixel<R>>],
) -> Vec<NamedPlane<R>> {
    let there = job.there(Keep::Stages).with_settings(depth != DepthTest::Plain);
    let planes = |(k, image): (usize, &Tiled<ImagePixel<R>>)| {
        let at = |x, y| {
            let mut pixel = *image.at(x, y);
            pixel.sample.normal = unsigned(pixel.sample.normal);
            pixel
        };
        record::planes(fields, k, job.window, &at, &there)
    };
    images.iter().enumerate().flat_map(planes).collect()
}

/// Turns -0 into +0 by adding 0.
fn unsigned<R: Exact>(vector: [R; 3]) -> [R; 3] {
    vector.map_inline(|part| part + R::ZERO)
}

/// Reads a client's depth-image of each group of the scene.
///
/// The opacity is the opacity of the surfel, times the weight. Nearness is computed from the
/// client's depth, rounded. So if two images have the same depth, the image of the lower surfel is
/// the nearest. The definition may have told their nearnesses apart. The Voronoi-enhanced depth is
/// not needed any more.
pub(crate) fn given_images<R: Exact>(
    job: &Job<'_>,
    fields: &ImageFields<R>,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<Tiled<ImagePixel<R>>>> {
    let (view, surfels) = (View::new(job.camera), &job.scene.surfels);
    let sample = WeightedFragment {
        depth: R::INFINITY,
        weight: R::ZERO,
        normal: [R::ZERO; 3],
        color: [R::ZERO; 3],
        opacity: R::ZERO,
    };
    let empty = ImagePixel { sample, nearness: R::ZERO, z: R::ZERO, surfel: NO_ID };
    let image = |k: usize| {
        let image = given.pixels(fields, k, empty)?;
        Ok(image.map(|pixel| {
            let ImagePixel { mut sample, surfel, .. } = *pixel;
            if surfel != NO_ID {
                sample.opacity = sample.weight * opacity(surfels, surfel);
            }
            ImagePixel { sample, nearness: view.nearness(sample.depth), ..*pixel }
        }))
    };
    (0..job.index.groups()?.len()).map(image).collect()
}

/// Makes the planes of the sums of the compositing pass.
pub(super) fn sums<R: Exact>(
    job: &Job<'_>,
    composites: &Tiled<Composite<R>>,
) -> Vec<NamedPlane<R>> {
    let at = |x, y| {
        let sums = composites.at(x, y).sums;
        WeightedFragment { normal: unsigned(sums.normal), ..sums }
    };
    let there = job.there(Keep::Stages);
    let mut planes = record::planes(&WeightedFragment::SUMS, 0, job.window, &at, &there);
    // The count is at most MAX_GROUPS, which fits the count's type.
    planes.push(COUNT.count(0, composites.plane(|pixel| pixel.count as u8)));
    planes
}
