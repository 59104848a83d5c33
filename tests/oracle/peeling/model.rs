//! Depth peeling by brute force: all fragments of a pixel, one band of depth after the other.

use crate::oracle::ewa::model::{Oracle, Seen};
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::transparent::model::opacity;

/// One layer of a pixel.
pub(crate) struct PeeledLayer {
    pub(crate) depth: Conditioned,
    pub(crate) color: [Conditioned; 3],
    pub(crate) alpha: Conditioned,
    pub(crate) count: usize,
}

/// The layers of a pixel from the front.
pub(crate) struct Peeled {
    pub(crate) ambiguous: bool,
    pub(crate) layers: Vec<PeeledLayer>,
    /// The surfels that may be the nearest of all.
    pub(crate) nearest: Vec<u32>,
}

pub(crate) fn peel(oracle: &Oracle<'_>, at: [f64; 2], most: usize) -> Peeled {
    let mut rest = oracle.fragments(at);
    let reach = |seen: &Seen<'_>| seen.1.value.q - oracle.limit();
    rest.retain(|seen| reach(seen) <= oracle.margin(&seen.1));
    let mut ambiguous = rest.iter().any(|seen| oracle.unsure(seen));
    rest.retain(|seen| reach(seen) <= 0.0);
    let nearest = oracle.nearest(&rest);
    let mut layers = Vec::new();
    while !rest.is_empty() && layers.len() < most {
        ambiguous |= oracle.grazes(&rest);
        let seen = oracle.seen(&rest);
        let entries = oracle.entries(at, &rest, &seen);
        let find = |plane| {
            let entry = entries.iter().find(|e| e.plane == plane).expect("of every pixel");
            [0, 1, 2].map(|c| Conditioned { value: entry.value[c], condition: entry.condition[c] })
        };
        let ([depth, ..], [weight, ..]) = (find("Z"), find("weight"));
        let alpha = opacity(oracle, &seen, weight);
        layers.push(PeeledLayer { depth, color: find(""), alpha, count: seen.len() });
        rest.retain(|seen| seen.1.value.t > depth.value + oracle.epsilon);
    }
    Peeled { ambiguous, layers, nearest }
}

impl Peeled {
    /// The layers one behind the other: colour over black, opacity, and what is let through.
    pub(crate) fn blend(&self) -> ([Conditioned; 3], Conditioned, Conditioned) {
        let one = Conditioned::exact(1.0);
        let (mut color, mut through) = ([Conditioned::ZERO; 3], one);
        let mut alpha = Conditioned::ZERO;
        for layer in &self.layers {
            let part = through * layer.alpha;
            color = [0, 1, 2].map(|c| color[c] + part * layer.color[c]);
            alpha = alpha + part;
            through = through * (one - layer.alpha);
        }
        (color, alpha, through)
    }
}
