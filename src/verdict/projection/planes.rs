//! The planes of the projection that a client hands in.

use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::projection::{PixelSample, SampleKind};
use crate::method::record::Field;
use crate::method::stage::{Conditions, Holds, Keep, PlaneRow};
use crate::number::Ball;
use crate::number::ball::Profile;
use crate::scene::Scene;
use crate::verdict::checks::{Report, whole};
use crate::verdict::client::{Client, Storage, StoredPlane, Ties};
use crate::verdict::planes::{ClientRecords, RecordPlanes};

/// The planes of the projection; each may be missing.
#[derive(Clone, Debug)]
pub(crate) struct SamplePlanes<'a> {
    scene: &'a Scene,
    pub(super) ties: Ties,
    pub(super) depth_test: Storage,
    planes: RecordPlanes<'a>,
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    id: Option<StoredPlane<'a, u32>>,
    kind: Option<StoredPlane<'a, u8>>,
}

/// The content of a pixel, according to the client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelContent {
    /// The client gives neither id, nor kind, nor depth.
    Nothing,
    Empty,
    /// This id, which the scene may not have.
    Id(u32),
    /// Something, of this kind if the client says which.
    Some(Option<SampleKind>),
    /// Something that is not judged, except for its kind, if the kind is known.
    Unjudged(Option<SampleKind>),
}

impl<'a> SamplePlanes<'a> {
    pub(crate) fn new(client: &'a Client, scene: &'a Scene) -> Self {
        let fields = &PixelSample::<f32>::PLANES;
        let kind = client.count(&PixelSample::<f32>::KIND.row);
        Self::from_record_planes(client, scene, RecordPlanes::new(client, fields, 0), kind)
    }

    /// The planes of a pass that leaves only depths and ids.
    pub(crate) fn of_nearest(client: &'a Client, scene: &'a Scene, rows: [PlaneRow; 2]) -> Self {
        // They are judged as the depth and the id of a sample.
        let place = |row: &PlaneRow| {
            let fields = PixelSample::<f32>::PLANES;
            fields.iter().position(|field| field.row.holds == row.holds).unwrap_or(usize::MAX)
        };
        let rows = rows.into_iter().map(|row| (place(&row), row));
        Self::from_record_planes(client, scene, RecordPlanes::of_rows(client, rows, 0), None)
    }

    fn from_record_planes(
        client: &Client,
        scene: &'a Scene,
        planes: RecordPlanes<'a>,
        kind: Option<StoredPlane<'a, u8>>,
    ) -> Self {
        let (depth, id) = (planes.depths(), planes.ids());
        let Client { ties, depth_test, .. } = *client;
        Self { scene, ties, depth_test, planes, depth, id, kind }
    }

    /// The names of the planes that are there.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.planes.names().to_vec()
    }

    /// The content of a pixel, according to the client. `unclear` lists primitives whose pieces are
    /// not known.
    pub(super) fn says(&self, at: (u32, u32), unclear: &[u32]) -> PixelContent {
        if let Some(ids) = self.id {
            return match *ids.plane.at(at.0, at.1) {
                NO_ID => PixelContent::Empty,
                id if unclear.binary_search(&id).is_ok() => {
                    PixelContent::Unjudged(kind_of(self.scene, id))
                }
                id => PixelContent::Id(id),
            };
        }
        let says = match (self.kind, self.depth) {
            (Some(kinds), _) => match *kinds.plane.at(at.0, at.1) {
                0 => PixelContent::Empty,
                kind => PixelContent::Some(SampleKind::ALL.get(usize::from(kind)).copied()),
            },
            (None, Some(depths)) if *depths.plane.at(at.0, at.1) == f64::INFINITY => {
                PixelContent::Empty
            }
            (None, Some(_)) => PixelContent::Some(None),
            (None, None) => PixelContent::Nothing,
        };
        let sure =
            matches!(says, PixelContent::Empty | PixelContent::Some(Some(SampleKind::Surface)));
        if sure || unclear.is_empty() { says } else { PixelContent::Unjudged(None) }
    }

    /// Checks every plane at a pixel against a sample.
    pub(super) fn check<P: Profile>(
        &self,
        at: (u32, u32),
        sample: &PixelSample<Ball<P>>,
        report: &mut Report<'_>,
    ) {
        self.planes.check(0, &PixelSample::PLANES, at, sample, report);
    }

    /// Checks the kind of a pixel, if it is known.
    pub(super) fn check_kind(
        &self,
        at: (u32, u32),
        kind: Option<SampleKind>,
        report: &mut Report<'_>,
    ) {
        if let (Some(plane), Some(kind)) = (&self.kind, kind) {
            whole(0, plane, at, kind as u8, report);
        }
    }

    /// What the next stage makes of the samples, if all planes that it reads are there. `places` says
    /// whether it reads ids and centres. If not, an id stands for a kind.
    pub(crate) fn samples<'s, T, P: Profile>(
        &'s self,
        job: &Job<'_>,
        places: bool,
        made: impl Fn(&PixelSample<Ball<P>>) -> T + Sync + 's,
    ) -> Option<ClientRecords<'s, T>> {
        let (depth, there) = (self.depth?, Conditions::new(self.scene, Keep::Stages));
        let all = &PixelSample::<Ball<P>>::PLANES;
        let of_place = [PixelSample::<f32>::LEFT.row, PixelSample::<f32>::UPPER.row];
        let known = |(place, field): (usize, &Field<_, _>)| {
            let row = &field.row;
            self.planes.has(place)
                || match row.holds {
                    Holds::Index => !places && self.kind.is_some(),
                    Holds::Count => self.id.is_some(),
                    _ => !there.hold(row) || (!places && of_place.contains(row)),
                }
        };
        if !all.iter().enumerate().all(known) {
            return None;
        }
        let size = [depth.plane.width(), depth.plane.height()];
        let read = move |x, y| {
            let mut sample = PixelSample::empty();
            self.planes.read(&PixelSample::PLANES, &there, (x, y), &mut sample);
            if self.kind.is_none() {
                sample.kind = kind_of(self.scene, sample.id).unwrap_or_default();
            }
            made(&sample)
        };
        Some(ClientRecords::new(job, size, read))
    }
}

/// The kind of an id, if the scene has it.
pub(super) fn kind_of(scene: &Scene, id: u32) -> Option<SampleKind> {
    let of = &scene.primitives;
    let counts = [
        (scene.surfels.len(), SampleKind::Surface),
        (of.triangles.len(), SampleKind::Polygon),
        (of.ribbons.len(), SampleKind::Ribbon),
        (of.tubes.len(), SampleKind::Tube),
    ];
    if id == NO_ID {
        return Some(SampleKind::Empty);
    }
    let mut end = 0;
    counts.into_iter().find_map(|(count, kind)| {
        end += count;
        ((id as usize) < end).then_some(kind)
    })
}
