//! The planes that a client hands in.

use crate::method::peeling::Settings;
use crate::method::peeling::layers::PeeledLayer;
use crate::method::peeling::planes::{LAYERS, STAGES};
use crate::method::record::rows;
use crate::method::surface::{ALPHA, DEPTH, ID, SHADED};
use crate::verdict::client::{Client, Storage, StoredPlane, Ties};

/// The planes of a layer; each may be missing.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerPlanes<'a> {
    pub(super) color: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) alpha: Option<StoredPlane<'a, f64>>,
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) count: Option<StoredPlane<'a, u8>>,
}

/// The planes of a client; each may be missing.
#[derive(Clone, Debug)]
pub(super) struct PeelingPlanes<'a> {
    /// The layers that leave planes, from the first.
    pub(super) layers: Vec<LayerPlanes<'a>>,
    /// Depth and surfel of the first layer.
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) id: Option<StoredPlane<'a, u32>>,
    pub(super) number: Option<StoredPlane<'a, u8>>,
    /// The most layers a pixel may have.
    pub(super) most: u32,
    pub(super) ties: Ties,
    pub(super) depth_test: Storage,
    pub(super) accumulator: Storage,
    /// The picture.
    pub(super) shaded: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) alpha: Option<StoredPlane<'a, f64>>,
}

impl<'a> PeelingPlanes<'a> {
    pub(super) fn new(client: &'a Client, settings: &Settings) -> Self {
        let [color, alpha, depth, count] = rows(&PeeledLayer::<f32>::PLANES);
        let layer = |number: usize| LayerPlanes {
            color: client.triple_of(&color, number),
            alpha: client.scalar_of(&alpha, number),
            depth: client.scalar_of(&depth, number),
            count: client.count_of(&count, number),
        };
        let last = settings.layers.min(STAGES) as usize;
        Self {
            layers: (1..=last).map(layer).collect(),
            depth: client.scalar(&DEPTH),
            id: client.index(&ID),
            number: client.count(&LAYERS),
            most: settings.layers,
            ties: client.ties,
            depth_test: client.depth_test,
            accumulator: client.accumulator,
            shaded: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
        }
    }

    /// The depth of a layer, counted from 0.
    pub(super) fn depth_of(&self, layer: usize) -> Option<StoredPlane<'a, f64>> {
        let own = self.layers[layer].depth;
        if layer == 0 { own.or(self.depth) } else { own }
    }

    /// Number of layers that have a depth, without a gap from the first.
    pub(super) fn known(&self) -> usize {
        (0..self.layers.len()).take_while(|&layer| self.depth_of(layer).is_some()).count()
    }

    /// The layers that are not judged although the client hands in planes of them: those behind a
    /// layer without a depth.
    pub(super) fn unjudged(&self) -> Vec<String> {
        let behind = (1..).zip(&self.layers).skip(self.known());
        let handed_in = behind.filter(|(_, layer)| {
            let LayerPlanes { color, alpha, depth, count } = layer;
            color.is_some() || alpha.is_some() || depth.is_some() || count.is_some()
        });
        handed_in.map(|(number, _): (usize, _)| format!("layer {number}")).collect()
    }

    /// Whether the layers can be blended.
    pub(super) fn blends(&self) -> bool {
        self.layers.iter().all(|layer| layer.color.is_some() && layer.alpha.is_some())
    }

    /// The surfel of the first layer, according to the client.
    pub(super) fn surfel(&self, (x, y): (u32, u32)) -> Option<u32> {
        self.id.map(|plane| *plane.plane.at(x, y))
    }

    /// The stages, each with the planes that it judges.
    pub(super) fn stages(&self) -> [(&'static str, Vec<&'static str>); 2] {
        let known = &self.layers[..self.known()];
        let any = |of: fn(&LayerPlanes<'a>) -> Option<&'static str>| known.iter().find_map(of);
        let all_known = self.known() == self.layers.len();
        let layers = [
            any(|layer| layer.color.map(|plane| plane.name)),
            any(|layer| layer.alpha.map(|plane| plane.name)),
            any(|layer| layer.depth.map(|plane| plane.name)),
            any(|layer| layer.count.map(|plane| plane.name)),
            self.depth.map(|plane| plane.name),
            self.id.map(|plane| plane.name),
            self.number.map(|plane| plane.name).filter(|_| all_known),
        ];
        let picture = [self.shaded.map(|plane| plane.name), self.alpha.map(|plane| plane.name)];
        let picture = picture.into_iter().flatten().filter(|_| self.blends());
        [("layers", layers.into_iter().flatten().collect()), ("blending", picture.collect())]
    }
}
