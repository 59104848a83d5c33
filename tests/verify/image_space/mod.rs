//! A client of the methods `template` and `pyramid`: a second implementation of both.
//!
//! As [`crate::verify::client`], it was written from the pages of the crate, without the crate's
//! code, and shares no formula with it. It takes numbers, habits, view and light from that client.
//! It draws surfels only.
//!
//! - [`projection`]: surfels to single pixels.
//! - [`ellipse`] and [`mean`]: discs by orthogonal projection; averages of up to four cells.
//! - [`template`]: propagation, reconstruction, normalization.
//! - [`pyramid`]: pull and push.
//! - [`levels`]: the levels of a pyramid. [`planes`]: the planes that the client hands in.
//! - [`bug`]: the mistakes that a client can make.
//! - [`cases`]: the scenes. [`verdicts`]: what the verifier says.

mod bug;
mod cases;
mod ellipse;
mod levels;
mod mean;
mod planes;
mod projection;
mod pyramid;
mod template;
mod verdicts;

pub(crate) use verdicts::{pictures_of_pyramid, pictures_of_template};

use crate::verify::client::habit::Habit;
use crate::verify::client::number::{Number, Vector, dot, sum, unit};
use crate::verify::client::view::Shared;
use bug::Bug;
use splatref::method::Method;
use splatref::splat::SplatSettings;
use splatref::{Camera, Frame, Scene};

/// How a client draws: its lawful habits and at most one bug.
#[derive(Clone, Copy, Debug, Default)]
struct How {
    habit: Habit,
    bug: Option<Bug>,
}

/// What every pass of the client knows.
struct Client<'a> {
    shared: Shared<'a>,
    how: How,
}

impl<'a> Client<'a> {
    fn new(scene: &'a Scene, camera: &Camera, cull: bool, how: How) -> Self {
        let settings = SplatSettings { cull, ..SplatSettings::default() };
        let of_splats = crate::verify::client::How { habit: how.habit, bug: None };
        Self { shared: Shared::new(scene, camera, &settings, of_splats), how }
    }

    /// Whether the client makes this mistake.
    fn has(&self, bug: Bug) -> bool {
        self.how.bug == Some(bug)
    }

    fn number(&self, value: f32) -> Number {
        self.shared.number(value)
    }

    fn zero(&self) -> Number {
        self.number(0.0)
    }

    /// A vector of view space in world space, divided by its length; plus 0: there is no -0.
    fn to_world(&self, v: Vector) -> [f32; 3] {
        let rows = &self.shared.rows;
        let turned = [0, 1, 2].map(|i| dot([rows[0][i], rows[1][i], rows[2][i]], v));
        let world = match self.how.bug {
            Some(Bug::NormalNotTurned) => unit(v),
            Some(Bug::NormalNotUnit) => turned,
            _ => unit(turned),
        };
        world.map(|component| (component + self.zero()).value)
    }

    /// A + B + C + D in pairs, as the page of averages has it.
    fn in_pairs(&self, [a, b, c, d]: [Number; 4]) -> Number {
        match self.how.habit {
            Habit::Reassociated => sum(a, b, c) + d,
            _ => (a + b) + (c + d),
        }
    }
}

/// What the client draws of a scene: every plane of every stage by the crate's names.
fn render(scene: &Scene, camera: &Camera, method: &Method, how: How) -> Frame<f32> {
    match method {
        Method::Template(settings) => {
            template::render(&Client::new(scene, camera, settings.cull, how), settings)
        }
        Method::Pyramid(settings) => {
            pyramid::render(&Client::new(scene, camera, settings.cull, how), settings)
        }
        _ => panic!("another client draws that"),
    }
}
