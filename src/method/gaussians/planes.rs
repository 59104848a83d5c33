//! List the planes that each stage leaves, and read them back from a client.

use super::blending::GaussianPixel;
use crate::method::record::Part::{Count, Id, Number, Triple};
use crate::method::record::{Field, rows};
use crate::method::stage::Holds::{self, Color, Depth, Index, Scalar};
use crate::method::stage::When::Always;
use crate::method::stage::{PlaneRow, Stage};
use crate::method::surface::{ALPHA, DEPTH, ID, SHADED};

impl<R> GaussianPixel<R> {
    /// C.
    pub(crate) const COLOR: Field<Self, R> = Field::new(
        "blended",
        Color,
        Triple(|p: &mut Self| &mut p.blend.color),
    )
    .unit("the space of blending")
    .says("C, the blended colours over black, in the space of blending; 0 where there is none")
    .when(Always);
    /// T.
    pub(crate) const THROUGH: Field<Self, R> = Field::new(
        "T",
        Scalar,
        Number(|p: &mut Self| &mut p.blend.through),
    )
    .says("transmittance: how much of what is behind is seen, in [0, 1]; 1 where there is nothing")
    .when(Always);
    const EXPECTED: Field<Self, R> =
        Field::new("Z.expected", Depth, Number(|p: &mut Self| &mut p.expected))
            .says("mean depth of the fragments, by weight; +inf where there is none")
            .when(Always);
    const MEDIAN: Field<Self, R> =
        Field::new("Z.median", Depth, Number(|p: &mut Self| &mut p.median))
            .says("depth of the last fragment before which T > 1/2; +inf where there is none")
            .when(Always);
    /// The heaviest fragment.
    pub(crate) const HEAVIEST: Field<Self, R> =
        Field::new("heaviest", Index, Id(|p: &mut Self| &mut p.heaviest))
            .unit("surfel")
            .says("item of the greatest weight; 0xFFFF_FFFF where there is none")
            .when(Always);
    /// The fragments that are drawn.
    pub(crate) const COUNT: Field<Self, R> =
        Field::new("count", Holds::Count, Count(|p: &mut Self| &mut p.count))
            .unit("fragments")
            .says("how many fragments are drawn, up to 255")
            .when(Always);

    /// The planes of blending.
    pub(crate) const PLANES: [Field<Self, R>; 8] = [
        Self::COLOR,
        Self::THROUGH,
        DEPTH.at(Number(|p| &mut p.depth)),
        Self::EXPECTED,
        Self::MEDIAN,
        ID.at(Id(|p| &mut p.id)),
        Self::HEAVIEST,
        Self::COUNT,
    ];
}

const BLENDED: [PlaneRow; 8] = rows(&GaussianPixel::<f32>::PLANES);

/// The stages, see [`mod@crate::method::planes`].
pub(super) const STAGES: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage { name: "blending", reads: &["projection"], leaves: &BLENDED },
    Stage { name: "display", reads: &["blending"], leaves: &[SHADED, ALPHA] },
];
