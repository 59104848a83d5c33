//! The planes of the picture that a client hands in.

use crate::frame::NO_ID;
use crate::method::PlaneRow;
use crate::method::template::planes::{ALPHA, DEPTH, NORMAL, SHADED, WEIGHT};
use crate::method::template::reconstruction::Gathered;
use crate::verdict::client::{Client, Storage, StoredPlane};
use crate::verdict::planes::RecordPlanes;
use crate::verdict::supposed::Supposed;

/// The planes of the picture and of its gathering; each may be missing.
#[derive(Clone, Debug)]
pub(super) struct PicturePlanes<'a> {
    /// The planes of the gathering.
    pub(super) gathered: RecordPlanes<'a>,
    weight: Option<StoredPlane<'a, f64>>,
    pub(super) accumulator: Storage,
    /// The averages, and the weight again.
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) normal: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) weight_copy: Option<StoredPlane<'a, f64>>,
    /// The picture.
    pub(super) shaded: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) alpha: Option<StoredPlane<'a, f64>>,
    pub(super) supposed: Supposed,
}

/// A stage, and the planes that it judges.
type StagePlanes = (&'static str, Vec<&'static str>);

impl<'a> PicturePlanes<'a> {
    pub(super) fn new(client: &'a Client) -> Self {
        Self {
            gathered: RecordPlanes::new(client, &Gathered::<f32>::PLANES, 0),
            weight: client.scalar(&Gathered::<f32>::WEIGHT.row),
            accumulator: client.accumulator,
            depth: client.scalar(&DEPTH),
            normal: client.triple(&NORMAL),
            weight_copy: client.scalar(&WEIGHT),
            shaded: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
            supposed: client.supposed,
        }
    }

    /// The stages, each with the planes that it judges. `gathers` says whether the gathering can be
    /// replayed.
    pub(super) fn stages(&self, gathers: bool) -> [StagePlanes; 3] {
        let scalar = |plane: &Option<StoredPlane<'_, f64>>| plane.map(|plane| plane.name);
        let triple = |plane: &Option<StoredPlane<'_, [f64; 3]>>| plane.map(|plane| plane.name);
        let sums = if gathers { self.gathered.names().to_vec() } else { Vec::new() };
        // Averages are judged from sums: the client's, or the sums of the gathering.
        let own = |row: PlaneRow| self.gathered.names().contains(&row.name);
        let known = |own: bool| gathers || (own && self.weight.is_some());
        let averages = [
            scalar(&self.depth).filter(|_| known(own(Gathered::<f32>::DEPTHS.row))),
            triple(&self.normal).filter(|_| known(own(Gathered::<f32>::NORMALS.row))),
            scalar(&self.weight_copy).filter(|_| known(true)),
        ];
        let shading = [triple(&self.shaded), scalar(&self.alpha)];
        [
            ("reconstruction", sums),
            ("normalization", averages.into_iter().flatten().collect()),
            ("shading", shading.into_iter().flatten().collect()),
        ]
    }

    /// Whether a pixel is empty according to the client; none if the client does not say.
    pub(super) fn empty(&self, (x, y): (u32, u32)) -> Option<bool> {
        let id = self.gathered.ids().map(|plane| *plane.plane.at(x, y) == NO_ID);
        let weight = self.weight.or(self.weight_copy);
        id.or(weight.map(|plane| *plane.plane.at(x, y) == 0.0))
            .or(self.depth.map(|plane| *plane.plane.at(x, y) == f64::INFINITY))
    }
}
