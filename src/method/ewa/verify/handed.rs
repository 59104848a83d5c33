//! The planes that a client has handed in, by the stage that judges them.

use crate::method::ewa::planes;
use crate::method::resolved;
use crate::splat::record::SplatRecord;
use crate::verify::client::{Client, Storage, Stored, Ties};

/// The planes of a client, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Handed<'a> {
    /// The splats, if the client has projected them.
    pub(super) records: Option<&'a [SplatRecord]>,
    /// Depth and surfel of the nearest fragment: those of the visibility pass, else the picture's.
    pub(super) depth: Option<Stored<'a, f64>>,
    pub(super) id: Option<Stored<'a, u32>>,
    pub(super) ties: Ties,
    /// The sums of the attribute pass; its weight may be the picture's.
    pub(super) weight: Option<Stored<'a, f64>>,
    pub(super) normal_sum: Option<Stored<'a, [f64; 3]>>,
    pub(super) color_sum: Option<Stored<'a, [f64; 3]>>,
    pub(super) count: Option<Stored<'a, u8>>,
    pub(super) accumulator: Storage,
    /// The averages.
    pub(super) color: Option<Stored<'a, [f64; 3]>>,
    pub(super) normal: Option<Stored<'a, [f64; 3]>>,
    /// Copies in the picture of what an earlier pass has left, if both are there.
    pub(super) depth_copy: Option<Stored<'a, f64>>,
    pub(super) id_copy: Option<Stored<'a, u32>>,
    pub(super) weight_copy: Option<Stored<'a, f64>>,
    /// The picture.
    pub(super) shaded: Option<Stored<'a, [f64; 3]>>,
    pub(super) alpha: Option<Stored<'a, f64>>,
}

impl<'a> Handed<'a> {
    pub(super) fn new(client: &'a Client) -> Self {
        let first = |own: Option<_>, other: Option<_>| (own.or(other), own.and(other));
        let (depth, depth_copy) =
            first(client.scalar(&planes::NEAREST), client.scalar(&resolved::DEPTH));
        let (weight, weight_copy) =
            first(client.scalar(&planes::WEIGHT_SUM), client.scalar(&resolved::WEIGHT));
        let own = client.index(&planes::NEAREST_ID);
        let other = client.index(&resolved::ID);
        Self {
            records: client.records.as_deref(),
            depth,
            id: own.or(other),
            ties: client.ties,
            weight,
            normal_sum: client.triple(&planes::NORMAL_SUM),
            color_sum: client.triple(&planes::COLOR_SUM),
            count: client.count(&planes::COUNT),
            accumulator: client.accumulator,
            color: client.triple(&resolved::COLOR),
            normal: client.triple(&resolved::NORMAL),
            depth_copy,
            id_copy: own.and(other),
            weight_copy,
            shaded: client.triple(&resolved::SHADED),
            alpha: client.scalar(&resolved::ALPHA),
        }
    }

    /// Whether nothing is said of the nearest fragments.
    pub(super) fn nothing(&self) -> bool {
        self.depth.is_none() && self.id.is_none()
    }

    /// The stages, each with the planes that it judges.
    pub(super) fn stages(&self) -> [(&'static str, Vec<&'static str>); 4] {
        let listed = |planes: &[Option<&'static str>]| planes.iter().flatten().copied().collect();
        let scalar = |plane: &Option<Stored<'_, f64>>| plane.map(|plane| plane.name);
        let triple = |plane: &Option<Stored<'_, [f64; 3]>>| plane.map(|plane| plane.name);
        let index = |plane: &Option<Stored<'_, u32>>| plane.map(|plane| plane.name);
        [
            ("visibility", listed(&[scalar(&self.depth), index(&self.id)])),
            (
                "attributes",
                listed(&[
                    scalar(&self.weight),
                    triple(&self.normal_sum),
                    triple(&self.color_sum),
                    self.count.map(|plane| plane.name),
                ]),
            ),
            (
                "normalization",
                listed(&[
                    triple(&self.color),
                    triple(&self.normal),
                    scalar(&self.depth_copy),
                    index(&self.id_copy),
                    scalar(&self.weight_copy),
                ]),
            ),
            ("shading", listed(&[triple(&self.shaded), scalar(&self.alpha)])),
        ]
    }
}
