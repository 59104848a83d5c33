//! Laps hold what their names say: time that is added to one kind of work moves one lap.
//!
//! The time is virtual, see [`crate::method::clock`]. In each run one kind of work takes time, and all
//! other work takes none.

use crate::frame::{Exec, Rect};
use crate::index::seen::Seen;
use crate::method::clock::Work::{self, *};
use crate::method::clock::virtual_time::with_slow;
use crate::method::{Laps, Method, Session};
use crate::number::random::unit;
use crate::scene::{
    Camera, Cloud, Environment, Light, Mipmap, Primitives, Scene, Surfels, Triangles, Vertices,
};
use crate::source::Shape;
use glam::Vec3;
use std::time::Duration;

/// The laps of a path, each with all kinds of work that it holds.
type Path = &'static [(&'static str, &'static [Work])];

/// A method, the laps of its definition and of its fast path, and the kinds of work that several
/// stages do.
struct Case {
    method: &'static str,
    plain: Path,
    fast: Path,
    shared: &'static [Work],
}

const SHADING: (&str, &[Work]) = ("shading", &[Shade, Environment]);

const CASES: [Case; 9] = [
    Case {
        method: "ewa",
        plain: &[
            ("projection", &[Project]),
            ("visibility", &[Visibility]),
            ("attributes", &[Attributes]),
            ("normalization", &[Normalize, Store]),
            SHADING,
        ],
        fast: &[
            ("projection", &[Project]),
            ("visibility", &[Gather, Visibility]),
            ("attributes", &[Limits, Attributes]),
            ("normalization", &[Normalize, Store]),
            SHADING,
        ],
        shared: &[],
    },
    Case {
        method: "single-pass",
        plain: &[
            ("projection", &[Project]),
            ("geometry", &[Images]),
            ("compositing", &[Composite, Normalize, Store]),
            SHADING,
        ],
        fast: &[
            ("projection", &[Project]),
            ("geometry", &[Gather, Images]),
            ("compositing", &[Composite, Limits, Normalize, Store]),
            SHADING,
        ],
        shared: &[],
    },
    Case {
        method: "transparent",
        plain: &[
            ("projection", &[Project]),
            ("blending", &[Blend]),
            ("averaging", &[Average, Environment, Store]),
        ],
        fast: &[
            ("projection", &[Project]),
            ("blending and averaging", &[Gather, Blend, Average, Environment, Store]),
        ],
        shared: &[],
    },
    Case {
        method: "transparent-hq",
        plain: &[
            ("projection", &[Project]),
            ("geometry", &[Images]),
            ("nearest", &[Composite, Normalize, Shade]),
            ("blending", &[Blend]),
            ("averaging", &[Average]),
            ("compositing", &[Over, Environment, Store]),
        ],
        fast: &[
            ("projection", &[Project]),
            ("geometry", &[Gather, Images]),
            ("nearest", &[Composite, Limits, Normalize, Shade]),
            ("blending and averaging", &[Blend, Average]),
            ("compositing", &[Over, Environment, Store]),
        ],
        shared: &[],
    },
    Case {
        method: "peeling",
        plain: &[
            ("projection", &[Project]),
            ("layers", &[Peel, Visibility, Attributes, Normalize, Shade]),
            ("blending", &[Blend, Environment, Store]),
        ],
        fast: &[
            ("projection", &[Project]),
            ("layers and blending", &[Gather, Peel, Blend, Environment, Store]),
        ],
        shared: &[],
    },
    Case {
        method: "pyramid",
        plain: &[
            ("projection", &[Project]),
            ("pull", &[Pull]),
            // The fast path writes a row of level 0 while the row is in the cache.
            ("push", &[Push, Store]),
            SHADING,
        ],
        fast: &[("projection", &[Project]), ("pull", &[Pull]), ("push", &[Push, Store]), SHADING],
        shared: &[],
    },
    Case {
        method: "template",
        plain: &[
            ("projection", &[Project]),
            ("propagation", &[Propagate]),
            ("reconstruction", &[Search]),
            ("normalization", &[Normalize]),
            SHADING,
        ],
        fast: &[
            ("projection", &[Project]),
            ("propagation", &[Propagate]),
            ("reconstruction and normalization", &[Search, Normalize]),
            SHADING,
        ],
        shared: &[],
    },
    Case {
        method: "blue",
        plain: &[("discs", &[Project, Discs, Polygons, Store]), SHADING],
        fast: &[("discs", &[Project, Gather, Discs, Polygons, Store]), SHADING],
        shared: &[],
    },
    Case {
        method: "gaussians",
        plain: &[
            ("projection", &[Project]),
            ("blending", &[Gather, Blend, Store]),
            ("display", &[Display]),
        ],
        fast: &[
            ("projection", &[Project]),
            ("blending", &[Gather, Blend, Store]),
            ("display", &[Display]),
        ],
        shared: &[],
    },
];

/// The first frame: no surfel is flagged, so pass 1 draws the polygons alone.
const FIRST_FRAME: Case = Case {
    method: "deferred",
    plain: &[
        ("visibility", &[Copy, Polygons, Project, Visibility]),
        ("indices", &[Copy, Indices]),
        ("difference", &[Copy, Difference, Project, Visibility]),
        ("attributes", &[Copy, Filter, Project, Attributes]),
        ("normalization", &[Normalize, ShowPolygons, Store]),
        SHADING,
    ],
    fast: &[
        ("visibility", &[Copy, Polygons, Project, Gather, Store]),
        ("indices", &[Indices]),
        ("difference", &[Copy, Difference, Project, Gather, Visibility]),
        ("attributes", &[Filter, Rank, GatherRanked, Load, Limits, Attributes]),
        ("normalization", &[Normalize, ShowPolygons, Store]),
        SHADING,
    ],
    // Passes 1 to 4 copy the surfels that they draw; 1, 3 and, in the definition, 4 project them;
    // 1 and 3 are visibility splatting. The fast path stores the depth of pass 1 for pass 2.
    shared: &[Copy, Project, Visibility, Gather, Store],
};

/// A frame at rest: pass 1 draws all selected surfels, and pass 3 has none to project.
const AT_REST: Case = Case {
    plain: &[
        ("visibility", &[Copy, Polygons, Project, Visibility]),
        ("indices", &[Copy, Indices]),
        ("difference", &[Copy, Difference, Visibility]),
        ("attributes", &[Copy, Filter, Project, Attributes]),
        ("normalization", &[Normalize, ShowPolygons, Store]),
        SHADING,
    ],
    fast: &[
        ("visibility", &[Copy, Polygons, Project, Gather, Visibility, Store]),
        ("indices", &[Indices]),
        ("difference", &[Copy, Difference, Gather, Visibility]),
        ("attributes", &[Filter, Rank, GatherRanked, Load, Limits, Attributes]),
        ("normalization", &[Normalize, ShowPolygons, Store]),
        SHADING,
    ],
    ..FIRST_FRAME
};

/// A lit torus before the sky. Its surfels have colours, opacities and mipmaps. A triangle stands in
/// it, if the method draws triangles.
fn scene(triangle: bool) -> Scene {
    let surfels = Shape::Torus.surfels(200, 1).unwrap();
    let opacity = (0..200).map(|i| unit(7, i)).collect();
    let cloud = Cloud { opacity: Some(opacity), ..surfels.into_cloud() };
    let mipmap = Mipmap::new(1, vec![Vec3::splat(0.5); 200]).unwrap();
    let surfels = Surfels::new(cloud).unwrap().0.with_mipmap(Some(mipmap)).unwrap();
    let mut scene = Scene::unlit("torus", surfels);
    scene.lights.push(Light::DEFAULT);
    scene.environment = Some(Environment::Sky);
    if triangle {
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let vertices = Vertices {
            position: corners.map(Vec3::from_array).to_vec(),
            direction: vec![Vec3::Z; 3],
            radius: vec![0.0; 3],
            ..Vertices::default()
        };
        let triangles = Triangles::new(vertices, vec![[0, 1, 2]]).unwrap().0;
        scene.primitives = Primitives { triangles, ..Primitives::default() };
    }
    scene
}

/// A wide picture, so that tiles beside the torus have no splats.
fn camera() -> Camera {
    Camera::new(140, 16, Shape::Torus.default_pose(), Shape::Torus.default_lens()).unwrap()
}

/// The laps that the work `slow` moves, in order. Checks that they sum up to all of its time, if
/// `all` says that no work is outside of laps.
fn moved(slow: Work, all: bool, draw: &mut impl FnMut() -> Laps) -> Vec<&'static str> {
    let (laps, passed, _) = with_slow(slow, draw);
    let sum: Duration = laps.iter().map(|(_, time)| *time).sum();
    assert!(sum == passed || !all, "{slow:?} takes {passed:?}: {laps:?}");
    laps.iter().filter(|(_, time)| !time.is_zero()).map(|(name, _)| *name).collect()
}

/// Checks a path: its laps are named after all stages, and each kind of work moves the laps that
/// hold it and no others.
fn check(case: &Case, path: Path, all: bool, mut draw: impl FnMut() -> Laps) {
    let name = case.method;
    let (laps, _, done) = with_slow(Project, &mut draw);
    let names: Vec<_> = laps.iter().map(|(lap, _)| *lap).collect();
    assert_eq!(names, path.iter().map(|(lap, _)| *lap).collect::<Vec<_>>(), "{name}");
    let stages: Vec<_> = names.iter().flat_map(|lap| lap.split(" and ")).collect();
    let of_method = Method::by_name(name).unwrap();
    assert_eq!(stages, of_method.stages().iter().map(|s| s.name).collect::<Vec<_>>());
    for work in path.iter().flat_map(|(_, works)| *works) {
        assert!(done.contains(work), "{name}: the scene has no work of the kind {work:?}");
    }
    for work in done {
        let holds = path.iter().filter(|(_, works)| works.contains(&work));
        let holds: Vec<_> = holds.map(|(lap, _)| *lap).collect();
        assert_eq!(moved(work, all, &mut draw), holds, "{name}: {work:?}");
        let kept = holds.is_empty() && !all;
        let several = holds.len() > 1 && case.shared.contains(&work);
        assert!(holds.len() == 1 || kept || several, "{name}: {work:?} in {holds:?}");
    }
}

/// Checks the definition, without and with the planes of the stages, and the fast path.
fn check_all(case: &Case, seen: Option<&Seen>) {
    let method = Method::by_name(case.method).unwrap();
    let scene = scene(method.draws_polygons() && method.name() != "pyramid");
    // One thread runs on the thread of the test, whose time is virtual.
    let exec = Exec::new(1, 8).unwrap();
    let camera = camera();
    let mut session = Session::new(&scene, method, &exec).unwrap();
    session.resume(seen.cloned());
    // Keeping planes of stages is work outside of all laps.
    for (stages, all) in [(false, true), (true, false)] {
        let define = || session.define::<f64>(&camera, stages).unwrap().timings;
        check(case, case.plain, all, define);
    }
    check(case, case.fast, true, || {
        session.resume(seen.cloned());
        session.render(&camera).unwrap().timings.clone()
    });
}

#[test]
fn work_that_takes_longer_moves_the_lap_of_its_stage() {
    for case in &CASES {
        check_all(case, None);
    }
    let methods: Vec<_> = CASES.iter().chain([&FIRST_FRAME]).map(|case| case.method).collect();
    for method in Method::all() {
        assert!(methods.contains(&method.name()), "{}", method.name());
    }
}

#[test]
fn passes_of_deferred_have_laps_of_their_own() {
    check_all(&FIRST_FRAME, None);
    let (scene, exec, method) = (scene(true), Exec::sequential(), Method::by_name("deferred"));
    let session = Session::new(&scene, method.unwrap(), &exec).unwrap();
    let seen = session.define::<f32>(&camera(), false).unwrap().seen;
    check_all(&AT_REST, seen.as_ref());
}

#[test]
fn a_region_of_a_projection_has_one_lap() {
    let (scene, exec, camera) = (scene(false), Exec::sequential(), camera());
    for method in ["pyramid", "template"] {
        let method = Method::by_name(method).unwrap();
        let mut session = Session::new(&scene, method, &exec).unwrap();
        session.set_region(Some(Rect { x0: 40, y0: 0, x1: 100, y1: 9 })).unwrap();
        for work in [Project, Environment] {
            let mut draw = || session.define::<f32>(&camera, false).unwrap().timings;
            assert_eq!(moved(work, true, &mut draw), ["projection"], "{work:?}");
        }
    }
}
