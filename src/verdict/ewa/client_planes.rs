//! The planes that a client hands in, by the stage that judges them.

use crate::frame::NO_ID;
use crate::method::ewa::attributes::Sums;
use crate::method::ewa::visibility::Foremost;
use crate::method::record::rows;
use crate::method::stage::PlaneRow;
use crate::method::surface;
use crate::splat::record::SplatRecord;
use crate::verdict::client::{Band, Client, Storage, StoredPlane, Ties};
use crate::verdict::supposed::Supposed;

/// The planes of a client; each may be missing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClientPlanes<'a> {
    /// The splats, if the client has projected them.
    pub(crate) records: Option<&'a [SplatRecord]>,
    /// Depth and surfel of the nearest fragment, from the visibility pass, else from the picture.
    pub(crate) depth: Option<StoredPlane<'a, f64>>,
    pub(crate) id: Option<StoredPlane<'a, u32>>,
    pub(crate) ties: Ties,
    pub(crate) band: Band,
    pub(crate) depth_test: Storage,
    pub(crate) supposed: Supposed,
    /// The sums of the attribute pass. The weight may come from the picture.
    pub(crate) weight: Option<StoredPlane<'a, f64>>,
    pub(crate) normal_sum: Option<StoredPlane<'a, [f64; 3]>>,
    pub(crate) color_sum: Option<StoredPlane<'a, [f64; 3]>>,
    pub(crate) count: Option<StoredPlane<'a, u8>>,
    pub(crate) accumulator: Storage,
    /// The averages.
    pub(crate) color: Option<StoredPlane<'a, [f64; 3]>>,
    pub(crate) normal: Option<StoredPlane<'a, [f64; 3]>>,
    pub(crate) opacity: Option<StoredPlane<'a, f64>>,
    /// 1 where something is seen, else 0.
    pub(crate) mask: Option<StoredPlane<'a, u8>>,
    /// The picture's copies of planes from an earlier pass, if both are there.
    pub(crate) depth_copy: Option<StoredPlane<'a, f64>>,
    pub(crate) id_copy: Option<StoredPlane<'a, u32>>,
    /// Whether a pixel of the picture without weight is empty, whatever fragment is nearest. The
    /// copies are judged by this rule.
    pub(crate) weightless: bool,
    /// Whether an empty pixel says nothing about the nearest fragment, because it belongs to such a
    /// picture.
    pub(crate) empty_is_open: bool,
    pub(crate) weight_copy: Option<StoredPlane<'a, f64>>,
    /// The picture.
    pub(crate) shaded: Option<StoredPlane<'a, [f64; 3]>>,
    pub(crate) alpha: Option<StoredPlane<'a, f64>>,
}

/// The rows of the planes before the averages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SumRows {
    /// Depth and surfel of the nearest fragment, if a stage of its own leaves them.
    pub(crate) nearest: Option<[PlaneRow; 2]>,
    /// Colour, normal, weight and count.
    pub(crate) sums: [PlaneRow; 4],
}

impl<'a> ClientPlanes<'a> {
    pub(crate) fn new(client: &'a Client) -> Self {
        Self::from_client(
            client,
            &SumRows {
                nearest: Some(rows(&Foremost::<f32>::PLANES)),
                sums: rows(&Sums::<f32>::PLANES),
            },
        )
    }

    /// The planes for another method that ends in averages and their shading.
    pub(crate) fn from_client(client: &'a Client, rows: &SumRows) -> Self {
        let [color, normal, weight, count] = &rows.sums;
        let first = |own: Option<_>, other: Option<_>| (own.or(other), own.and(other));
        let nearest = rows.nearest.as_ref();
        let own = nearest.and_then(|[depth, _]| client.scalar(depth));
        let (depth, depth_copy) = first(own, client.scalar(&surface::DEPTH));
        let (sum, weight_copy) = first(client.scalar(weight), client.scalar(&surface::WEIGHT));
        let own = nearest.and_then(|[_, id]| client.index(id));
        let other = client.index(&surface::ID);
        Self {
            records: client.records.as_deref(),
            depth,
            id: own.or(other),
            ties: client.ties,
            band: client.band,
            depth_test: client.depth_test,
            supposed: client.supposed,
            weight: sum,
            normal_sum: client.triple(normal),
            color_sum: client.triple(color),
            count: client.count(count),
            accumulator: client.accumulator,
            color: client.triple(&surface::COLOR),
            normal: client.triple(&surface::NORMAL),
            opacity: None,
            mask: None,
            depth_copy,
            id_copy: own.and(other),
            weightless: false,
            empty_is_open: false,
            weight_copy,
            shaded: client.triple(&surface::SHADED),
            alpha: client.scalar(&surface::ALPHA),
        }
    }

    /// Whether the client says nothing about the nearest fragments.
    pub(crate) fn nothing(&self) -> bool {
        self.depth.is_none() && self.id.is_none()
    }

    /// Whether the client says nothing about the sums.
    pub(crate) fn no_sums(&self) -> bool {
        let triples = [self.normal_sum, self.color_sum];
        self.weight.is_none() && self.count.is_none() && triples.iter().all(Option::is_none)
    }

    /// Whether the client says nothing about the nearest fragment of a pixel.
    pub(super) fn says_nothing(&self, (x, y): (u32, u32)) -> bool {
        let far = || self.depth.is_none_or(|plane| *plane.plane.at(x, y) == f64::INFINITY);
        let none = || self.id.is_none_or(|plane| *plane.plane.at(x, y) == NO_ID);
        self.nothing() || (self.empty_is_open && far() && none())
    }

    /// Whether every plane that is there shows an empty, black pixel.
    pub(crate) fn is_empty(&self, (x, y): (u32, u32)) -> bool {
        let far = |plane: Option<StoredPlane<'_, f64>>| {
            plane.is_none_or(|plane| *plane.plane.at(x, y) == f64::INFINITY)
        };
        let none = |plane: Option<StoredPlane<'_, u32>>| {
            plane.is_none_or(|plane| *plane.plane.at(x, y) == NO_ID)
        };
        let zero = |plane: Option<StoredPlane<'_, f64>>| {
            plane.is_none_or(|plane| *plane.plane.at(x, y) == 0.0)
        };
        let zeros = |plane: Option<StoredPlane<'_, [f64; 3]>>| {
            // Written out because arrays are compared by a call.
            plane.is_none_or(|plane| {
                let [a, b, c] = *plane.plane.at(x, y);
                (a == 0.0) & (b == 0.0) & (c == 0.0)
            })
        };
        let clear = |plane: Option<StoredPlane<'_, u8>>| {
            plane.is_none_or(|plane| *plane.plane.at(x, y) == 0)
        };
        far(self.depth)
            && far(self.depth_copy)
            && [self.id, self.id_copy].into_iter().all(none)
            && [self.weight, self.weight_copy, self.opacity, self.alpha].into_iter().all(zero)
            && [self.normal_sum, self.color_sum, self.color, self.normal, self.shaded]
                .into_iter()
                .all(zeros)
            && [self.count, self.mask].into_iter().all(clear)
    }

    /// The stages, each with the planes that it judges.
    pub(crate) fn stages(&self) -> [(&'static str, Vec<&'static str>); 4] {
        let listed = |planes: &[Option<&'static str>]| planes.iter().flatten().copied().collect();
        let scalar = |plane: &Option<StoredPlane<'_, f64>>| plane.map(|plane| plane.name);
        let triple = |plane: &Option<StoredPlane<'_, [f64; 3]>>| plane.map(|plane| plane.name);
        let index = |plane: &Option<StoredPlane<'_, u32>>| plane.map(|plane| plane.name);
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
                    scalar(&self.opacity),
                    self.mask.map(|plane| plane.name),
                    scalar(&self.depth_copy),
                    index(&self.id_copy),
                    scalar(&self.weight_copy),
                ]),
            ),
            ("shading", listed(&[triple(&self.shaded), scalar(&self.alpha)])),
        ]
    }
}
