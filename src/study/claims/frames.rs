//! Claims of \[GBP04\]: only visible surfels are splatted.

use super::subject::{Subject, colors, quiet};
use super::{Claim, Measured};
use crate::error::Result;
use crate::frame::Frame;
use crate::index::mipmap;
use crate::method::{Method, deferred, ewa};
use crate::scene::Camera;
use crate::scene::transform::rotation;
use crate::study::atlas::checked;
use glam::{DMat4, DVec3};

pub(super) const CLAIMS: [Claim; 7] = [
    Claim {
        id: "gbp04-culled",
        from: "[GBP04] 5, Table 1",
        says: "70 % of the points of a head are culled by the point selection",
        measured: "surfels that are splatted; all surfels: 0.3 times as many at most",
        at_most: 0.3,
        timed: false,
        more: "gbp04.md",
        of: culled,
    },
    Claim {
        id: "gbp04-speed",
        from: "[GBP04] 5, Table 1",
        says: "a head of 285 k points is drawn 39/34 times as fast with the selection",
        measured: "ms, at most 34/39 times: `deferred`; `ewa`",
        at_most: 34.0 / 39.0,
        timed: true,
        more: "gbp04.md",
        of: speed,
    },
    Claim {
        id: "gbp04-second",
        from: "[GBP04] 4.3, Fig. 3",
        says: "artifacts of a large rotation are removed by a second visibility splatting pass",
        measured: "RMSE to `ewa`, the frame of a turn by 32 degrees, one flag per surfel: `deferred`; `--second off`",
        at_most: 1.0,
        timed: false,
        more: "gbp04.md",
        of: second_pass,
    },
    Claim {
        id: "gbp04-next",
        from: "[GBP04] 4.3, Fig. 3",
        says: "without that pass, the next frame has the holes filled and no new ones",
        measured: "RMSE to `ewa`, one flag per surfel, `--second off`: the frame after the turn; the frame of the turn",
        at_most: 1.0,
        timed: false,
        more: "gbp04.md",
        of: next,
    },
    Claim {
        id: "gbp04-negligible",
        from: "[GBP04] 4.3, Table 2",
        says: "the cost of the second visibility splatting pass is negligible",
        measured: "ms, at most 0.05 times: pass 3; all five passes",
        at_most: 0.05,
        timed: true,
        more: "gbp04.md",
        of: negligible,
    },
    Claim {
        id: "gbp04-flicker",
        from: "[GBP04] 4.4",
        says: "as only one surfel per pixel is projected, aliasing and flickering appear",
        measured: "deviation of luminance, checks one pixel wide, 60,000 surfels, moved by eighths of a pixel: `ewa`; \
                   `deferred`",
        at_most: 1.0,
        timed: false,
        more: "gbp04.md",
        of: |subject| {
            let plain = dense(subject, false)?;
            let methods = [ewa::Settings::default().into(), deferred::Settings::default().into()];
            flickers([&plain; 2], methods)
        },
    },
    Claim {
        id: "gbp04-mipmaps",
        from: "[GBP04] 4.4, Fig. 4",
        says: "surfel mipmaps smooth what is aliased",
        measured: "the same: `deferred` with five levels of mipmaps; without",
        at_most: 1.0,
        timed: false,
        more: "gbp04.md",
        of: |subject| {
            let (smooth, plain) = (dense(subject, true)?, dense(subject, false)?);
            flickers([&smooth, &plain], [deferred::Settings::default().into(); 2])
        },
    },
];

/// The number of points of the paper's head.
const HEAD: usize = 285_000;

fn culled(subject: &Subject<'_>) -> Result<Measured> {
    let subject = subject.of_count(HEAD)?;
    let mut session = subject.session(deferred::Settings::default().into(), None)?;
    session.render(&subject.camera)?;
    let picture = session.render(&subject.camera)?;
    let selected: u32 = picture.seen.as_ref().map_or(0, |seen| seen.selected().iter().sum());
    let numbers = [f64::from(selected), subject.scene.surfels.len() as f64];
    Ok(Measured { numbers, pictures: Vec::new() })
}

fn speed(subject: &Subject<'_>) -> Result<Measured> {
    let subject = subject.of_count(HEAD)?;
    let numbers = subject.times([
        subject.session(deferred::Settings::default().into(), None)?,
        subject.session(ewa::Settings::default().into(), None)?,
    ])?;
    Ok(Measured { numbers, pictures: Vec::new() })
}

/// The angle of the turn, in degrees.
const TURN: f64 = 32.0;

/// Moves the camera as if the scene were turned about +y around its middle.
fn turned(subject: &Subject<'_>, degrees: f64) -> Camera {
    let middle = subject.scene.surfels.bounding_sphere().center;
    let turn = DMat4::from_mat3(rotation(DVec3::Y, degrees));
    let around = DMat4::from_translation(middle) * turn * DMat4::from_translation(-middle);
    let view = subject.camera.view_from_world.as_dmat4() * around;
    Camera { view_from_world: view.as_mat4(), ..subject.camera }
}

/// Draws two frames before a turn, the frame of the turn and the next, and compares the last two
/// with `ewa`. Both sides of surfels are drawn, because the far side is hidden.
fn frames(subject: &Subject<'_>, second: bool) -> Result<[Frame<f32>; 3]> {
    let splats = ewa::Settings::BOTH_SIDES;
    let settings = deferred::Settings { splats, flags: 1, second, ..Default::default() };
    let mut session = subject.session(settings.into(), None)?;
    let before = turned(subject, TURN);
    session.render(&before)?;
    session.render(&before)?;
    let of_the_turn = session.render(&subject.camera)?.frame.clone();
    let after = session.render(&subject.camera)?.frame.clone();
    Ok([of_the_turn, after, subject.reference(splats.into(), None)?])
}

fn second_pass(subject: &Subject<'_>) -> Result<Measured> {
    let [first, _, truth] = frames(subject, true)?;
    let [second, ..] = frames(subject, false)?;
    beside(subject, [first, second], &truth)
}

fn next(subject: &Subject<'_>) -> Result<Measured> {
    let [second, first, truth] = frames(subject, false)?;
    beside(subject, [first, second], &truth)
}

fn beside(
    subject: &Subject<'_>,
    [first, second]: [Frame<f32>; 2],
    truth: &Frame<f32>,
) -> Result<Measured> {
    let numbers = [subject.error(&first, truth, "rmse")?, subject.error(&second, truth, "rmse")?];
    Ok(Measured { numbers, pictures: colors(&[&first, &second, truth])? })
}

fn negligible(subject: &Subject<'_>) -> Result<Measured> {
    let subject = subject.of_count(HEAD)?;
    let mut session = subject.session(deferred::Settings::default().into(), None)?;
    let passes = ["visibility", "indices", "difference", "attributes", "normalization"];
    let numbers = subject.laps(&mut session, [&["difference"], &passes])?;
    Ok(Measured { numbers, pictures: Vec::new() })
}

/// The surfels of a shape with more than one surfel a pixel.
const DENSE: usize = 60_000;

/// The subject with more surfels and with checks of a pixel, and optionally with mipmaps.
fn dense<'e>(subject: &Subject<'e>, smooth: bool) -> Result<Subject<'e>> {
    let middle = subject.scene.surfels.bounding_sphere().center;
    let distance = -subject.camera.view_from_world.as_dmat4().transform_point3(middle).z;
    let pixel = distance / f64::from(subject.camera.fy);
    let surfels = checked(subject.of_count(DENSE)?.scene.surfels, pixel)?;
    if !smooth {
        return Ok(subject.with(surfels));
    }
    let levels = mipmap::build(&surfels, 5, subject.exec, &quiet)?;
    Ok(subject.with(surfels.with_mipmap(Some(levels))?))
}

fn flickers(subjects: [&Subject<'_>; 2], methods: [Method; 2]) -> Result<Measured> {
    let of = |i: usize| subjects[i].flicker(subjects[i].session(methods[i], None)?);
    Ok(Measured { numbers: [of(0)?, of(1)?], pictures: Vec::new() })
}
