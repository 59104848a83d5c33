//! The scenes under `golden/`, so that no golden stands without an oracle behind it.
//!
//! Each is compared by the test of its method, beside that test's own scenes.

use crate::ewa::cases::Case;
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::Method;
use splatref::scene::Groups;
use std::path::Path;

/// A golden's scene, ready to be drawn.
pub(crate) struct Golden {
    pub(crate) case: Case,
    pub(crate) method: Method,
    /// For methods that draw groups.
    pub(crate) groups: Option<Groups>,
}

/// All of them.
pub(crate) fn all() -> Vec<Golden> {
    let folder = std::fs::read_dir("golden").expect("golden/ beside the tests");
    let mut paths: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|kind| kind == "toml"));
    paths.sort();
    paths.iter().map(|path| golden(path)).collect()
}

fn golden(path: &Path) -> Golden {
    let exec = Exec::sequential();
    let file = SceneFile::read(path).expect("a scene file");
    let method = file.method.method().expect("a method");
    let scene = file.load(&exec, &|_, _, _| ()).expect("loads").scene;
    let groups = file.groups(&scene.surfels, &method, &exec, &|_, _, _| ()).expect("groups");
    let groups = groups.map(|(groups, _)| groups);
    let camera = file.camera(&scene).expect("a camera");
    let (name, settings) =
        (path.display().to_string(), method.splats().copied().unwrap_or_default());
    Golden { case: Case { name, camera, settings, scene, exact: false }, method, groups }
}

/// At least so many were found: a test whose goldens are gone would pass.
pub(crate) fn at_least<T>(count: usize, goldens: Vec<T>) -> Vec<T> {
    assert!(goldens.len() >= count, "the goldens are gone: {} are left", goldens.len());
    goldens
}
