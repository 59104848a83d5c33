//! The planes of the stages: where they leave, and where they come in.

use super::layers::{PeeledLayer, PeeledPixel};
use crate::composite::{decide, under::Under};
use crate::error::Result;
use crate::frame::{NamedPlane, Plane};
use crate::method::input_planes::InputPlanes;
use crate::method::stage::{Holds, PlaneRow, Stage, When};
use crate::method::surface::{ALPHA, DEPTH, ID, SHADED};
use crate::method::tiled::Tiled;
use crate::number::Exact;

/// How many layers leave planes.
pub const STAGES: u32 = 8;

pub(crate) const LAYER_COLOR: PlaneRow = PlaneRow::new(
    "layer#",
    Holds::Color,
    "linear RGB",
    "shaded colour C_j of layer j, not multiplied by its opacity; black where there is no layer",
    When::Stages,
);
pub(crate) const LAYER_ALPHA: PlaneRow = PlaneRow::new(
    "layer#.A",
    Holds::Scalar,
    "",
    "opacity a_j of layer j in [0, 1]; 0 where there is no layer",
    When::Stages,
);
pub(crate) const LAYER_DEPTH: PlaneRow = PlaneRow::new(
    "layer#.Z",
    Holds::Scalar,
    "world units",
    "depth t_j of the nearest fragment of layer j; +inf where there is no layer",
    When::Stages,
);
pub(crate) const LAYER_COUNT: PlaneRow = PlaneRow::new(
    "layer#.count",
    Holds::Count,
    "fragments",
    "how many fragments layer j averages, up to 255; 0 where there is no layer",
    When::Stages,
);
pub(crate) const LAYERS: PlaneRow = PlaneRow::new(
    "layers",
    Holds::Count,
    "layers",
    "how many layers the pixel has, up to 255",
    When::Always,
);

/// The stages, see [`mod@crate::method::planes`].
pub(super) const ROWS: &[Stage] = &[
    Stage { name: "projection", reads: &[], leaves: &[] },
    Stage {
        name: "layers",
        reads: &["projection"],
        leaves: &[LAYER_COLOR, LAYER_ALPHA, LAYER_DEPTH, LAYER_COUNT, DEPTH, ID, LAYERS],
    },
    Stage { name: "blending", reads: &["layers"], leaves: &[SHADED, ALPHA] },
];

/// The planes of layer `number`, counted from 1.
pub(super) fn layer<R: Exact>(number: usize, layer: &Tiled<PeeledLayer<R>>) -> [NamedPlane<R>; 4] {
    [
        LAYER_COLOR.triple(number, layer.plane(|pixel| pixel.color)),
        LAYER_ALPHA.scalar(number, layer.plane(|pixel| pixel.alpha)),
        LAYER_DEPTH.scalar(number, layer.plane(|pixel| pixel.depth)),
        LAYER_COUNT.count(number, layer.plane(|pixel| pixel.count)),
    ]
}

/// The planes of all layers together.
pub(super) fn pixels<R: Exact>(pixels: &Tiled<PeeledPixel<R>>) -> [NamedPlane<R>; 3] {
    pixel_planes(
        pixels.plane(|pixel| pixel.depth),
        pixels.plane(|pixel| pixel.id),
        pixels.plane(|pixel| pixel.layers.min(255) as u8),
    )
}

/// The same of planes.
pub(super) fn pixel_planes<R: Exact>(
    depth: Plane<R>,
    id: Plane<u32>,
    layers: Plane<u8>,
) -> [NamedPlane<R>; 3] {
    [DEPTH.scalar(0, depth), ID.index(0, id), LAYERS.count(0, layers)]
}

/// The planes of the picture.
pub(super) fn shown<R: Exact>((color, alpha): (Plane<[R; 3]>, Plane<R>)) -> [NamedPlane<R>; 2] {
    [SHADED.triple(0, color), ALPHA.scalar(0, alpha)]
}

/// How many of somebody's layers there are, one after the other from the first.
pub(super) fn given_layers<R: Exact>(given: &InputPlanes<'_, R>) -> usize {
    (1..=STAGES as usize).take_while(|&number| given.has(&LAYER_DEPTH, number)).count()
}

/// `limit_j` of somebody's layer j at each pixel; +inf where there is no layer, as none follows.
pub(super) fn given_limits<R: Exact>(
    given: &InputPlanes<'_, R>,
    number: usize,
    epsilon: R,
) -> Result<Tiled<R>> {
    let depth = given.scalar(&LAYER_DEPTH, number)?;
    Ok(given.tiled(|x, y| decide::limit(*depth.at(x, y), epsilon)))
}

/// Somebody's layers, blended: as many as some pixel has.
///
/// A pixel with fewer has an opacity of 0 there, which changes nothing.
pub(super) fn given_blends<R: Exact>(given: &InputPlanes<'_, R>) -> Result<Tiled<Under<R>>> {
    let counts = given.count(&LAYERS, 0)?.values();
    let most = counts.iter().copied().max().unwrap_or(0);
    let layer = |number: usize| {
        Ok((given.scalar(&LAYER_ALPHA, number)?, given.triple(&LAYER_COLOR, number)?))
    };
    let layers: Vec<_> = (1..=usize::from(most)).map(layer).collect::<Result<_>>()?;
    Ok(given.tiled(|x, y| {
        let layers = layers.iter().map(|(alpha, color)| (*alpha.at(x, y), *color.at(x, y)));
        layers.fold(Under::CLEAR, |before, (alpha, color)| before.under(alpha, color))
    }))
}
