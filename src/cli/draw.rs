//! Loads scenes and prepares sessions, with progress.

use super::options::SceneOptions;
use super::{progress, warn};
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::seen::Seen;
use splatref::io::scene_file::{Ready, SceneFile};
use splatref::method::Session;
use splatref::method::session::Made;

/// Loads a scene, with progress.
pub(super) fn ready(file: &SceneFile, exec: &Exec) -> Result<Ready> {
    let steps = progress::Steps::new("loading");
    let ready = file.ready(exec, &|what, done, of| steps.show(what, done, of))?;
    drop(steps);
    warned(file, ready)
}

/// Loads a scene of which each part of a picture may read its own surfels, with progress.
pub(super) fn ready_in_parts(file: &SceneFile, exec: &Exec) -> Result<Ready> {
    let steps = progress::Steps::new("loading");
    let ready = file.ready_in_parts(exec, &|what, done, of| steps.show(what, done, of))?;
    drop(steps);
    warned(file, ready)
}

/// Prints what is to be doubted about a scene.
fn warned(file: &SceneFile, ready: Ready) -> Result<Ready> {
    warn(&file.without_effect()?);
    warn(&ready.loaded.warnings);
    Ok(ready)
}

/// Prepares a scene for its method, with progress. The session continues from the state that the
/// options name.
pub(super) fn session<'a>(
    ready: &'a Ready,
    options: &SceneOptions,
    exec: &'a Exec,
) -> Result<(Session<'a>, Option<Made>)> {
    let steps = progress::Steps::new("preparing");
    let seen = seen(ready, options, exec)?;
    let (mut session, made) = ready.session(exec, &|what, done, of| steps.show(what, done, of))?;
    session.resume(seen);
    Ok((session, made))
}

/// The state after the previous frame, if the options name one.
pub(super) fn seen(ready: &Ready, options: &SceneOptions, exec: &Exec) -> Result<Option<Seen>> {
    options.state().map(|path| ready.state(path, exec)).transpose()
}
