//! A client of the method `single-pass`: a second implementation of Algorithm 1 of \[ZP06\].
//!
//! As [`crate::verify::client`], it was written from the pages of the crate, without the crate's
//! code, and shares no formula with it. It takes splats, their fragments, numbers, habits and light
//! from that client.
//!
//! - [`bins`]: bins of depth, and the Voronoi-enhanced depth.
//! - [`images`]: the geometry pass, into a depth-image for each group.
//! - [`compositing`]: the sums over the images, and averages.
//! - [`planes`]: the planes that the client hands in.
//! - [`manner`]: what a correct client may do differently, beside habits. [`bug`]: the mistakes
//!   that a client can make.
//! - [`cases`]: the scenes. [`verdicts`]: what the verifier says.

mod bins;
mod bug;
mod cases;
mod compositing;
mod images;
mod manner;
mod planes;
mod verdicts;

pub(crate) use verdicts::pictures;

use crate::verify::client::habit::Habit;
use crate::verify::client::project::project;
use crate::verify::client::view::Shared;
use bins::Bins;
use bug::Bug;
use manner::Manner;
use splatref::method::single_pass::{DepthTest, Settings};
use splatref::scene::{Groups, Surfels};
use splatref::{Camera, Frame, Scene};

/// How a client draws: its lawful habits and at most one bug.
#[derive(Clone, Copy, Debug, Default)]
struct How {
    habit: Habit,
    manner: Manner,
    bug: Option<Bug>,
}

impl From<Habit> for How {
    fn from(habit: Habit) -> Self {
        Self { habit, ..Self::default() }
    }
}

impl From<Bug> for How {
    fn from(bug: Bug) -> Self {
        Self { bug: Some(bug), ..Self::default() }
    }
}

/// What every pass of the client knows.
struct Client<'a> {
    shared: Shared<'a>,
    how: How,
    groups: &'a Groups,
    /// None under the plain depth test.
    bins: Option<Bins>,
}

impl Client<'_> {
    /// Whether the client makes this mistake.
    fn has(&self, bug: Bug) -> bool {
        self.how.bug == Some(bug)
    }

    /// Whether of equals the last one stays.
    fn last_of_ties(&self) -> bool {
        self.how.habit == Habit::TiesToTheLast
    }
}

/// What the client draws of a scene: every plane of every stage by the crate's names.
fn render(
    scene: &Scene,
    groups: &Groups,
    camera: &Camera,
    settings: &Settings,
    how: How,
) -> Frame<f32> {
    assert!(scene.surfels.tangents().is_none(), "the client draws no ellipses");
    assert!(scene.environment.is_none(), "the client knows no environments");
    let enlarged = (how.bug == Some(Bug::ScaleApplied)).then(|| enlarged(scene, groups));
    let drawn = enlarged.as_ref().unwrap_or(scene);
    let of_splats =
        crate::verify::client::How { habit: how.habit, bug: how.bug.and_then(Bug::of_splats) };
    let bins = match settings.depth {
        DepthTest::Plain => None,
        DepthTest::Voronoi(count) => {
            Some(Bins::new(scene, camera, &settings.splats, count, how.bug))
        }
    };
    let shared = Shared::new(drawn, camera, &settings.splats, of_splats);
    let client = Client { shared, how, groups, bins };
    let splats = project(&client.shared);
    let images = images::draw(&client, &splats);
    let surfaces = compositing::composite(&client, &images);
    planes::frame(&client, &images, &surfaces)
}

/// The scene with the radii of an extension.
fn enlarged(scene: &Scene, groups: &Groups) -> Scene {
    let mut cloud = scene.surfels.clone().into_cloud();
    let scales = groups.own().iter().map(|group| groups.scale()[usize::from(*group)]);
    let radii = scene.surfels.radius().iter().zip(scales);
    cloud.radius = Some(radii.map(|(radius, scale)| radius * scale).collect());
    Scene { surfels: Surfels::new(cloud).unwrap().0, ..scene.clone() }
}
