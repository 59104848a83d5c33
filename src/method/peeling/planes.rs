//! List the planes that each stage leaves, and read them back from a client.

use super::layers::{PeeledLayer, PeeledPixel};
use crate::composite::{decide, under::Under};
use crate::error::Result;
use crate::frame::{NamedPlane, Plane};
use crate::method::input_planes::InputPlanes;
use crate::method::record::Part::{Count, Number, Triple};
use crate::method::record::{Field, joined, rows};
use crate::method::stage::Holds::{self, Color, Depth, Scalar};
use crate::method::stage::When::Always;
use crate::method::stage::{PlaneRow, Stage};
use crate::method::surface::{ALPHA, DEPTH, ID, SHADED};
use crate::method::tiled::Tiled;
use crate::number::Exact;

/// The number of layers that leave planes.
pub const STAGES: u32 = 8;

impl<R> PeeledLayer<R> {
    const COLOR: Field<Self, R> = Field::new("layer#", Color, Triple(|p: &mut Self| &mut p.color))
        .says(
            "shaded colour C_j of layer j, not multiplied by its opacity; black where there \
             is no layer",
        );
    const ALPHA: Field<Self, R> =
        Field::new("layer#.A", Scalar, Number(|p: &mut Self| &mut p.alpha))
            .says("opacity a_j of layer j in [0, 1]; 0 where there is no layer");
    const DEPTH: Field<Self, R> =
        Field::new("layer#.Z", Depth, Number(|p: &mut Self| &mut p.depth))
            .says("depth t_j of the nearest fragment of layer j; +inf where there is no layer");
    const COUNT: Field<Self, R> =
        Field::new("layer#.count", Holds::Count, Count(|p: &mut Self| &mut p.count))
            .unit("fragments")
            .says("how many fragments layer j averages, up to 255; 0 where there is no layer");

    /// The planes that a layer leaves. Layers are counted from 1.
    pub(crate) const PLANES: [Field<Self, R>; 4] =
        [Self::COLOR, Self::ALPHA, Self::DEPTH, Self::COUNT];
}

pub(crate) const LAYERS: PlaneRow =
    PlaneRow::new("layers", Holds::Count, "how many layers the pixel has, up to 255")
        .unit("layers")
        .when(Always);

/// The stages, see [`mod@crate::method::planes`].
pub(super) const ROWS: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage {
        name: "layers",
        reads: &["projection"],
        leaves: joined!(rows(&PeeledLayer::<f32>::PLANES), [DEPTH, ID, LAYERS]),
    },
    Stage { name: "blending", reads: &["layers"], leaves: &[SHADED, ALPHA] },
];

/// Makes the planes of all layers together.
pub(super) fn pixels<R: Exact>(pixels: &Tiled<PeeledPixel<R>>) -> [NamedPlane<R>; 3] {
    pixel_planes(
        pixels.plane(|pixel| pixel.depth),
        pixels.plane(|pixel| pixel.id),
        pixels.plane(|pixel| pixel.layers.min(255) as u8),
    )
}

/// Makes the same planes from planes of depths, ids and counts.
pub(super) fn pixel_planes<R: Exact>(
    depth: Plane<R>,
    id: Plane<u32>,
    layers: Plane<u8>,
) -> [NamedPlane<R>; 3] {
    [DEPTH.scalar(0, depth), ID.index(0, id), LAYERS.count(0, layers)]
}

/// The planes of the picture.
pub(super) fn shown<R: Exact>(color: Plane<[R; 3]>, alpha: Plane<R>) -> [NamedPlane<R>; 2] {
    [SHADED.triple(0, color), ALPHA.scalar(0, alpha)]
}

/// Counts a client's layers, one after the other from the first, up to the first layer that is
/// missing.
pub(super) fn given_layers<R: Exact>(given: &InputPlanes<'_, R>) -> usize {
    let depth = PeeledLayer::<R>::DEPTH.row;
    (1..=STAGES as usize).take_while(|&number| given.has(&depth, number)).count()
}

/// `limit_j` of a client's layer j at each pixel. It is +inf where there is no layer, because no
/// layer follows.
pub(super) fn given_limits<R: Exact>(
    given: &InputPlanes<'_, R>,
    number: usize,
    epsilon: R,
) -> Result<Tiled<R>> {
    let depth = given.scalar(&PeeledLayer::<R>::DEPTH.row, number)?;
    Ok(given.tiled(|x, y| decide::limit(*given.at(depth, x, y), epsilon)))
}

/// Blends a client's layers, as many as any pixel has.
///
/// A pixel with fewer layers has an opacity of 0 in the others, which changes nothing.
pub(super) fn given_blends<R: Exact>(given: &InputPlanes<'_, R>) -> Result<Tiled<Under<R>>> {
    let counts = given.count(&LAYERS, 0)?.values();
    let most = counts.iter().copied().max().unwrap_or(0);
    let read = [PeeledLayer::ALPHA, PeeledLayer::COLOR];
    let layer = |number: usize| given.pixels(&read, number, PeeledLayer::NONE);
    let layers: Vec<_> = (1..=usize::from(most)).map(layer).collect::<Result<_>>()?;
    Ok(given.tiled(|x, y| {
        let layers = layers.iter().map(|layer| layer.at(x, y));
        layers.fold(Under::CLEAR, |before, layer| before.under(layer.alpha, layer.color))
    }))
}
