//! The scenes under `golden/`, so that no golden stands without an oracle behind it.
//!
//! Each is compared by the test of its method, beside that test's own scenes.

use crate::oracle::kit::case::Case;
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::{
    Method, Session, blue, deferred, ewa, gaussians, peeling, pyramid, single_pass, template,
};
use splatref::scene::Scene;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A method that the goldens of some name are of, and whose stages an oracle takes.
pub(crate) trait Taken: Sized {
    /// The goldens, by the names of their files, in their order.
    const NAMES: &[&str];

    /// The settings, if a method is this one.
    fn of(method: Method) -> Option<Self>;
}

macro_rules! taken {
    ($($settings:ty, $($variant:ident)|+: $names:expr;)*) => {
        $(impl Taken for $settings {
            const NAMES: &[&str] = &$names;

            fn of(method: Method) -> Option<Self> {
                match method {
                    $(Method::$variant(settings) => Some(settings.into()),)+
                    _ => None,
                }
            }
        })*

        /// Every golden that an oracle takes.
        const ALL: &[&[&str]] = &[$(<$settings>::NAMES),*];
    };
}

taken! {
    ewa::Settings, Ewa: [
        "ewa_affine_sphere",
        "ewa_cull_off_unoriented",
        "ewa_ellipses",
        "ewa_epsilon_zero",
        "ewa_f64",
        "ewa_ladder_affine",
        "ewa_ladder_inside",
        "ewa_ladder_perspective",
        "ewa_ladder_raycast",
        "ewa_near_plane",
        "ewa_odd_size",
        "ewa_ortho_torus",
        "ewa_perspective_close",
        "ewa_raycast_sheets",
    ];
    deferred::Settings, Deferred: ["gbp04_detail", "gbp04_ladder", "gbp04_motion", "gbp04_without_second"];
    gaussians::Settings, Gaussians: [
        "gaussians_2dgs",
        "gaussians_discs",
        "gaussians_exact",
        "gaussians_gsplat",
        "gaussians_inria",
        "gaussians_khr",
        "gaussians_mip_f64",
        "gaussians_rays",
        "gaussians_steps",
        "gaussians_surface",
    ];
    single_pass::Settings, SinglePass: [
        "zp06_identity_sphere",
        "zp06_ladder",
        "zp06_voronoi_cluster",
    ];
    crate::oracle::transparent::Settings, Transparent | TransparentHq: [
        "zp06_algorithm2_background",
        "zp06_algorithm2_sheets",
        "zp06_algorithm3_mixed",
        "zp06_groups_of_a_file",
        "zp06_refraction",
    ];
    peeling::Settings, Peeling: ["zp06_peeling"];
    pyramid::Settings, Pyramid: [
        "mkc08_f64_ortho",
        "mkc08_hybrid",
        "mkc08_odd_size_box",
        "mkc08_sphere",
    ];
    blue::Settings, Blue: [
        "bjfm19_budget",
        "bjfm19_ladder",
        "bjfm19_nodes",
        "bjfm19_points",
        "bjfm19_prefixes",
    ];
    template::Settings, Template: [
        "moc08_covering_3",
        "moc08_f64_7",
        "moc08_gaussian_5",
        "moc08_odd_size_radius",
        "moc08_sphere_3",
        "moc08_torus_5",
    ];
}

/// The goldens of a method, ready to be drawn; a test that takes them has them all.
pub(crate) fn of<S: Taken>() -> Vec<Case<S>> {
    S::NAMES.iter().map(|name| golden(name)).collect()
}

fn golden<S: Taken>(name: &str) -> Case<S> {
    let (exec, path) = (Exec::sequential(), Path::new("golden").join(name).with_extension("toml"));
    let file = SceneFile::read(&path).expect("a scene file");
    let method = file.method.method().expect("a method");
    let scene = if method.draws_objects() {
        file.load(&exec, &|_, _, _| ()).expect("loads").scene
    } else {
        // In view and flat, with surfels by index.
        let scene = file.ready(&exec, &|_, _, _| ()).expect("loads").loaded.scene;
        Scene { objects: None, ..scene }
    };
    let camera = file.camera(&scene).expect("a camera");
    let grouping = file.grouping(&method).expect("a grouping");
    let prepared = Session::prepare(&scene, method, grouping, &exec, &|_, _, _| ());
    let groups = prepared.expect("a session").0.groups().cloned();
    let settings = S::of(method).unwrap_or_else(|| panic!("{name} is of another method"));
    Case { name: path.display().to_string(), scene, camera, settings, groups, exact: false }
}

#[test]
fn every_golden_is_taken_by_an_oracle() {
    let stems = |kind: &str| -> BTreeSet<String> {
        let folder = std::fs::read_dir("golden").expect("golden/ beside the tests");
        let paths = folder.map(|entry| entry.expect("an entry").path());
        let those = paths.filter(|path| path.extension().is_some_and(|end| end == kind));
        let stem = |path: PathBuf| path.file_stem().and_then(|s| s.to_str()).map(str::to_owned);
        those.map(|path| stem(path).expect("a name")).collect()
    };
    let taken: BTreeSet<_> = ALL.iter().flat_map(|names| *names).map(|s| s.to_string()).collect();
    assert_eq!(
        taken.len(),
        ALL.iter().map(|names| names.len()).sum::<usize>(),
        "one is taken twice"
    );
    assert_eq!(stems("toml"), taken, "the scenes under golden/, and those that an oracle takes");
    assert_eq!(stems("exr"), taken, "the pictures under golden/, and the scenes");
}
