//! Changes that make a mistake the rule, and the verdict under each.

use super::depths::Reading;
use super::{epsilon, planes};
use crate::error::Result;
use crate::method::{Method, Session};
use crate::number::MapInline;
use crate::number::srgb;
use crate::scene::{Camera, GaussianArrays, Gaussians, Scene};
use crate::verdict::Verdict;
use crate::verdict::client::{Band, Client, Rounding, Storage, Ties};
use crate::verdict::supposed::Supposed;
use std::sync::Arc;

/// What to change so that a mistake becomes the rule.
pub(super) enum Change {
    Method(Method),
    Camera(Camera),
    /// Another scene of as many surfels, and the method for it.
    Scene(Box<Scene>, Method),
    /// Other Gaussians. The scene is made when it is tried, because Gaussians are large.
    Gaussians(Box<dyn Fn(&mut GaussianArrays)>),
    /// Another scene and camera for the projection alone.
    Drawn(Arc<(Scene, Camera)>),
    Supposed(Supposed),
    /// Another change, of which only the planes of these names are judged.
    Part(fn(&str) -> bool, Box<Self>),
    Ties(Ties),
    Stored(&'static str, Storage),
    Accumulator(Storage),
    /// The depth test has this format.
    DepthTest(Storage),
    /// Judge by a weaker promise.
    Rounding(Rounding),
    Flipped,
    /// Decode the picture as sRGB, once or twice.
    Decoded(u32),
    /// Decode the picture by a power.
    Power(f64),
    /// Judge the depths alone, as those of all fragments in the quads.
    Discarded,
    Band(Band),
    /// Move the depths back by this much.
    Moved(f64),
    /// Judge sums of fragments that lie behind the band.
    Behind,
    /// Read the depths another way.
    Depths(Reading),
    /// Read normals from \[0, 1\].
    Unsigned,
    /// Read the components of colours in this order.
    Swapped([usize; 3]),
}

impl Change {
    /// Whether the change only widens what is allowed.
    pub(super) fn widens(&self) -> bool {
        matches!(
            self,
            Self::Stored(..) | Self::Accumulator(_) | Self::DepthTest(_) | Self::Rounding(_)
        ) || matches!(self, Self::Supposed(Supposed::CoarseExp(_) | Supposed::HalfWeights))
    }

    /// Judges the client as if this were the rule. Only one changed copy of the client is in memory
    /// at a time. None if the client has no plane that shows this mistake.
    pub(super) fn judge(
        &self,
        session: &Session<'_>,
        camera: &Camera,
        client: &Client,
        budget: f64,
    ) -> Result<Option<Verdict>> {
        let as_if = |client: Client| judged_as(session, session.method(), camera, &client, budget);
        let judge = |method, camera| judged_as(session, method, camera, client, budget);
        match self {
            Self::Method(method) => judge(method, camera),
            Self::Camera(camera) => judge(session.method(), camera),
            Self::Scene(scene, method) => {
                judged_as(&session.beside(scene)?, method, camera, client, budget)
            }
            Self::Gaussians(change) => {
                let scene = session.scene();
                let Some(gaussians) = &scene.gaussians else { return Ok(None) };
                let mut arrays = gaussians.clone().into_arrays();
                change(&mut arrays);
                let gaussians = Some(Gaussians::new(arrays)?.0);
                let scene = Scene { gaussians, ..scene.clone() };
                judged_as(&session.beside(&scene)?, session.method(), camera, client, budget)
            }
            Self::Drawn(drawn) => as_if(Client { drawn: Some(drawn.clone()), ..client.clone() }),
            Self::Supposed(supposed) => as_if(Client { supposed: *supposed, ..client.clone() }),
            Self::Part(part, change) => {
                change.judge(session, camera, &client.with_planes(*part), budget)
            }
            Self::Ties(ties) => as_if(Client { ties: *ties, ..client.clone() }),
            Self::Stored(plane, storage) => as_if(client.clone().stored(plane, *storage)),
            Self::Accumulator(accumulator) => {
                as_if(Client { accumulator: *accumulator, ..client.clone() })
            }
            Self::DepthTest(depth_test) => {
                as_if(Client { depth_test: *depth_test, ..client.clone() })
            }
            Self::Rounding(rounding) => as_if(Client { rounding: *rounding, ..client.clone() }),
            Self::Flipped => as_if(client.flipped()),
            Self::Band(band) => as_if(epsilon::banded(client, *band)),
            Self::Moved(by) => as_if(epsilon::moved_back(client, *by)),
            Self::Behind => match epsilon::behind(session, camera, client) {
                Some((method, client)) => judged_as(session, &method, camera, &client, budget),
                None => Ok(None),
            },
            Self::Depths(reading) => as_if(reading.read(client)),
            Self::Unsigned => as_if(client.signed()),
            Self::Swapped(order) => {
                as_if(client.colors(&planes::COLORS, |color| {
                    order.map_inline(|component| color[component])
                }))
            }
            Self::Decoded(times) => as_if(decoded(client, *times)),
            Self::Power(power) => as_if(client.to_power(*power)),
            Self::Discarded => {
                let supposed = Supposed::Limit(1e9);
                as_if(Client { supposed, ..epsilon::depths_alone(client) })
            }
        }
    }
}

/// The client whose picture is decoded as sRGB, once or twice.
fn decoded(client: &Client, times: u32) -> Client {
    // Even an encoding in f32 loses this much, because a shading language's power does.
    let lost = f64::from(times) / 262_144.0;
    let storage = Storage::Srgb { relative: lost, least: lost };
    let decode = |part: f64| (0..times).fold(part, |part, _| srgb::to_linear(part));
    client.colors(&[""], |color| color.map_inline(decode)).stored("", storage)
}

/// The verdict on a changed client, if any plane is left to judge.
fn judged_as(
    session: &Session<'_>,
    method: &Method,
    camera: &Camera,
    client: &Client,
    budget: f64,
) -> Result<Option<Verdict>> {
    if client.frame().planes.is_empty() {
        return Ok(None);
    }
    session.verify_as(method, camera, client, budget).map(Some)
}
