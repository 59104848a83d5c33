//! A picture in the number type and with the planes that were asked for, as files hold it.

use super::options::SceneOptions;
use super::progress;
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::seen::Seen;
use splatref::io::scene_file::{Number, OutputSettings, Ready, SceneFile};
use splatref::method::session::Made;
use splatref::method::{Picture, Session};
use splatref::scene::Camera;
use std::borrow::Cow;

/// Loads a scene, with progress.
pub(super) fn ready(file: &SceneFile, exec: &Exec) -> Result<Ready> {
    let steps = progress::Steps::new("loading");
    file.ready(exec, &|what, done, of| steps.show(what, done, of))
}

/// Prepares a scene for its method, with progress; the session goes on from what the frame before saw.
pub(super) fn session<'a>(
    ready: &'a Ready,
    options: &SceneOptions,
    exec: &'a Exec,
) -> Result<(Session<'a>, Option<Made>)> {
    let steps = progress::Steps::new("preparing");
    let seen = seen(ready, options)?;
    let (mut session, made) = ready.session(exec, &|what, done, of| steps.show(what, done, of))?;
    session.resume(seen);
    Ok((session, made))
}

/// What the frame before saw, if somebody says.
pub(super) fn seen(ready: &Ready, options: &SceneOptions) -> Result<Option<Seen>> {
    options.state().map(|path| ready.state(path)).transpose()
}

/// Draws.
pub(super) fn draw<'s>(
    session: &'s mut Session<'_>,
    camera: &Camera,
    output: OutputSettings,
) -> Result<Cow<'s, Picture<f32>>> {
    Ok(match output {
        OutputSettings { number: Number::F32, stages: false, .. } => {
            Cow::Borrowed(session.render(camera)?)
        }
        OutputSettings { number: Number::F32, stages: true, .. } => {
            Cow::Owned(session.define::<f32>(camera, true)?)
        }
        OutputSettings { number: Number::F64, stages, .. } => {
            let Picture { frame, tally, timings, seen } = session.define::<f64>(camera, stages)?;
            Cow::Owned(Picture { frame: frame.to_f32(), tally, timings, seen })
        }
    })
}
