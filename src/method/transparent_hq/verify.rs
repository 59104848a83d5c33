//! What a right implementation may leave of the nearest layer, held against somebody's planes.
//!
//! Pass 1 alone is judged. **Geometry**: the depth-image of each group, by the rules of `single-pass`.
//! **Nearest**: `Z`, `id`, `normal` and `weight`, as the compositing pass of `single-pass` leaves them.
//!
//! Not judged are colour, opacity and mask of the nearest layer, the other layers (blending, averaging),
//! and the picture that is composited of both.

use super::Settings;
use super::nearest::single_pass;
use super::planes::IMAGES;
use crate::error::Result;
use crate::method::algorithm::Job;
use crate::method::ewa::verify::handed::Handed;
use crate::method::single_pass::verify::{self as groups, GroupsOf, sum_rows};
use crate::number::ball::Profile;
use crate::verify::client::Client;
use crate::verify::verdict::{Check, Verdict};

/// Judges the planes of a client.
///
/// # Errors
/// As the projection of the method.
pub(super) fn verify<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    budget: f64,
) -> Result<Verdict> {
    let mut verdict = groups::verify::<P>(job, &single_pass(settings), &nearest(client), budget)?;
    // Shading is not judged.
    verdict.stages.truncate(2);
    Ok(verdict)
}

/// Everything that is judged at one pixel.
pub(super) fn checks<P: Profile>(
    job: &Job<'_>,
    settings: &Settings,
    client: &Client,
    pixel: (u32, u32),
) -> Result<Vec<Check>> {
    groups::checks::<P>(job, &single_pass(settings), &nearest(client), pixel)
}

/// The planes of the nearest layer. Its sums leave none, and the picture is not its alone.
fn nearest(client: &Client) -> GroupsOf<'_> {
    let handed = Handed {
        normal_sum: None,
        color_sum: None,
        count: None,
        color: None,
        shaded: None,
        alpha: None,
        ..Handed::of(client, &sum_rows())
    };
    GroupsOf { client, handed, images: &IMAGES, stages: ["geometry", "nearest", "compositing"] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use crate::method::tests::surfels;
    use crate::method::tests::verdicts::{Slip, assert_found, verdict};
    use crate::method::{Method, Session};
    use crate::scene::{Camera, Scene};
    use crate::source::Shape;
    use crate::verify::client::Rounding;
    use crate::verify::verdict::Outcome;

    fn camera() -> Camera {
        let shape = Shape::Sphere;
        Camera::new(27, 23, shape.default_pose(), shape.default_lens()).unwrap()
    }

    #[test]
    fn the_nearest_layer_that_the_crate_renders_is_right() {
        let exec = Exec::new(1, 16).unwrap();
        for shape in [Shape::Sphere, Shape::Torus] {
            let scene = Scene::lit("", shape.surfels(250, 5).unwrap());
            let method = Method::TransparentHq(Settings::default());
            let session = Session::new(&scene, method, &exec).unwrap();
            for stages in [false, true] {
                let frame = session.define::<f32>(&camera(), stages).unwrap().frame;
                for rounding in [Rounding::Ieee, Rounding::Gpu] {
                    let found = verdict(&session, &camera(), &frame, rounding);
                    let worst = found.stages.iter().find_map(|stage| stage.worst.clone());
                    assert_eq!(worst, None, "{rounding:?}");
                    let judged: Vec<_> = found
                        .stages
                        .iter()
                        .map(|stage| (stage.stage, stage.planes.len()))
                        .collect();
                    let images = if stages { 6 } else { 0 };
                    assert_eq!(judged, [("geometry", images), ("nearest", 4)]);
                    assert!(!stages || found.outcome() == Outcome::Right);
                }
            }
        }
    }

    #[test]
    fn each_slip_is_found_in_its_stage() {
        let scene = Scene::lit("", surfels(150, 0.3, true, 1));
        let slips = [
            ("nearest.group00.Z", Slip::Off(1e-4), "geometry"),
            ("nearest.group01.id", Slip::More, "geometry"),
            ("nearest.group00.weight", Slip::NotANumber, "geometry"),
            ("Z", Slip::Next, "nearest"),
            ("id", Slip::More, "nearest"),
            ("normal", Slip::Off(1e-3), "nearest"),
            ("weight", Slip::Off(1e-3), "nearest"),
        ];
        let method = Method::TransparentHq(Settings::default());
        assert_found(&scene, &camera(), method, &slips);
    }
}
