//! Compare what a view reads with a view of the whole hierarchy.

use super::*;
use crate::frame::Frame;
use crate::io::checksum;
use crate::io::scene_file::Ready;
use crate::number::Real;
use crate::scene::bounds::Bounds;
use crate::scene::camera::stereo::Eye;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::objects::outline::{Missing, Needed};
use crate::scene::{Objects, Primitives, Stereo, Surfels};
use glam::DVec3;

/// From where a scene is seen, and how finely.
#[derive(Clone, Copy, Debug)]
struct View {
    /// The distance of the eye.
    eye: f64,
    /// The size of discs in pixels.
    surfel_size: f32,
}

/// From coarse to single triangles, from afar and from inside.
const VIEWS: [View; 6] = [
    View { eye: 60.0, surfel_size: 9.0 },
    View { eye: 60.0, surfel_size: 3.0 },
    View { eye: 40.0, surfel_size: 1.0 },
    View { eye: 12.0, surfel_size: 2.0 },
    View { eye: 3.0, surfel_size: 4.0 },
    View { eye: 40.0, surfel_size: 1e-3 },
];

fn scene(at: &TempDir, View { eye, surfel_size }: View, method: &'static str) -> SceneFile {
    let mut file = SceneFile::open(at.path().join("out")).unwrap();
    file.method.name = Some(method);
    file.refinement.surfel_size = surfel_size;
    file.camera.size = Some([120, 80]);
    file.camera.eye = Some(DVec3::new(4.0, 5.0, eye));
    file.camera.target = Some(DVec3::new(4.0, 5.0, 0.0));
    file
}

fn picture(ready: &Ready) -> Frame<f32> {
    let exec = Exec::sequential();
    let (mut session, _) = ready.session(&exec, &quiet).unwrap();
    session.render(&ready.camera).unwrap().frame.clone()
}

/// A folder whose files are read as far as the view needs them, and the view.
fn read(file: &SceneFile) -> Result<(Frame<f32>, Objects)> {
    let ready = file.ready(&Exec::sequential(), &quiet)?;
    Ok((picture(&ready), ready.loaded.scene.objects.clone().unwrap()))
}

/// The same view after reading the whole folder.
fn whole(file: &SceneFile) -> (Frame<f32>, Objects) {
    let exec = Exec::sequential();
    let ready = file.ready_of(file.load(&exec, &quiet).unwrap(), &exec).unwrap();
    (picture(&ready), ready.loaded.scene.objects.clone().unwrap())
}

fn made() -> TempDir {
    let at = given();
    make(&at, "scene.toml", "out", &quick(Traversal::BottomUp)).unwrap();
    at
}

/// How many surfels and triangles memory holds.
fn held(objects: &Objects) -> (usize, usize) {
    let each = objects.geometries().iter();
    let each = each.map(|one| (one.surfels.len(), one.primitives.triangles.len()));
    each.fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
}

#[test]
fn a_view_of_what_it_needs_is_the_view_of_all() {
    let at = made();
    for method in ["blue", "pyramid", "deferred"] {
        let mut least = (usize::MAX, usize::MAX);
        for view in VIEWS {
            for budget in [None, Some(300)] {
                let mut file = scene(&at, view, method);
                file.refinement.budget = budget;
                let (all, objects) = whole(&file);
                let (some, needed) = read(&file).unwrap();
                assert!(some == all, "{method} of {view:?} with {budget:?}");
                assert_eq!(needed.drawn_total(), objects.drawn_total());
                assert_eq!(needed.bounding_sphere(), objects.bounding_sphere());
                assert_eq!(needed.median_radius(), objects.median_radius());
                let ids = |of: &Objects| of.ids().clone();
                assert_eq!(ids(&needed), ids(&objects));
                // Memory holds no more than the objects draw.
                let (surfels, triangles) = held(&needed);
                assert!(surfels as u64 <= needed.drawn_total(), "{view:?}");
                assert!((surfels, triangles) <= held(&objects));
                least = (least.0.min(surfels), least.1.min(triangles));
            }
        }
        assert!(least.0 == 0 && least.1 == 0, "a view has no surfels, and one no triangles");
    }
}

/// An eye of a stereo pair draws the surfels that the camera in the middle chooses.
#[test]
fn an_eye_draws_the_choice_of_the_middle() {
    let at = made();
    let exec = Exec::sequential();
    for view in [VIEWS[1], VIEWS[2]] {
        let mut file = scene(&at, view, "blue");
        let middle = file.ready(&exec, &quiet).unwrap();
        let (mut session, _) = middle.session(&exec, &quiet).unwrap();
        for eye in Eye::BOTH {
            file.camera.stereo = Some(Stereo { distance: 0.5, eye: Some(eye) });
            let ready = file.ready(&exec, &quiet).unwrap();
            let forced = session.render(&ready.camera).unwrap().frame.clone();
            assert!(picture(&ready) == forced, "{eye:?} of {view:?}");
            assert!(picture(&middle) != forced);
        }
    }
}

/// Files of nodes that a distant view does not draw may hold anything, or be missing.
#[test]
fn what_no_view_draws_is_not_read() {
    let at = made();
    let out = at.path().join("out");
    let file = scene(&at, VIEWS[0], "blue");
    let expected = whole(&file).0;
    for name in bytes(&out).into_keys() {
        match name.as_str() {
            "index" | "bounds" | "surfels-0" => {}
            name if name.starts_with("mesh-") => fs::remove_file(out.join(name)).unwrap(),
            name => fs::write(out.join(name), "of something else").unwrap(),
        }
    }
    let (found, objects) = read(&file).unwrap();
    assert!(found == expected);
    assert_eq!(objects.needed().iter().filter(|one| **one != Needed::default()).count(), 1);
    // A nearer view draws more, and names the missing file.
    let line = read(&scene(&at, VIEWS[3], "blue")).unwrap_err().to_string();
    assert!(line.contains("out/surfels-") || line.contains("out/mesh-"), "{line}");
    assert_eq!(line.lines().count(), 1);
    fs::remove_file(out.join("surfels-0")).unwrap();
    let line = read(&file).unwrap_err().to_string();
    assert!(line.contains("out/surfels-0: ") && line.lines().count() == 1, "{line}");
}

/// A camera moves closer; each frame reads what it draws.
#[test]
fn frames_read_what_they_need() {
    let at = made();
    let exec = Exec::sequential();
    let text = "hierarchy = \"out\"\n[camera]\nsize = [90, 60]\nkeys = [\n\
                { frame = 0, eye = [4, 5, 60], target = [4, 5, 0] },\n\
                { frame = 3, eye = [4, 5, 8], target = [4, 5, 0] }]\n\
                [method]\nname = \"deferred\"\n";
    fs::write(at.path().join("walk.toml"), text).unwrap();
    let file = SceneFile::open(at.path().join("walk.toml")).unwrap();
    let mut needed = file.ready(&exec, &quiet).unwrap();
    let mut all = file.ready_of(file.load(&exec, &quiet).unwrap(), &exec).unwrap();
    let mut sizes = Vec::new();
    let identity = needed.identity(&exec).unwrap();
    for frame in [0, 1, 2, 3, 0] {
        needed = needed.at(frame, &exec).unwrap();
        all = all.at(frame, &exec).unwrap();
        assert!(picture(&needed) == picture(&all), "{frame}");
        let identities = [&needed, &all].map(|ready| ready.identity(&exec).unwrap());
        assert_eq!(identities, [identity.clone(), identity.clone()], "whatever is read");
        sizes.push(held(needed.loaded.scene.objects.as_ref().unwrap()));
    }
    // The last frame keeps at most twice as many surfels as it draws.
    assert!(
        sizes[0] != sizes[3] && sizes[4] >= sizes[0] && sizes[4].0 <= 2 * sizes[0].0,
        "{sizes:?}"
    );
}

/// What the last frame drew is in memory: without files, the next one draws it again, and a finer one
/// does not.
#[test]
fn a_walk_reads_a_node_once() {
    let at = made();
    let exec = Exec::sequential();
    let file = scene(&at, VIEWS[1], "blue");
    let ready = file.ready(&exec, &quiet).unwrap();
    let expected = picture(&ready);
    for (name, _) in bytes(&at.path().join("out")) {
        if name.starts_with("surfels-") || name.starts_with("mesh-") {
            fs::remove_file(at.path().join("out").join(name)).unwrap();
        }
    }
    let again = ready.with_surfel_size(VIEWS[1].surfel_size).unwrap();
    assert!(again.has_ordered_points());
    let placed = |ready: Ready| {
        let objects = ready.loaded.scene.objects.clone().unwrap();
        let view = objects.at(0).unwrap().seen_from(&ready.camera, &exec).unwrap();
        drop((ready, objects));
        let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
        hierarchy.needed_by(view, &exec, &quiet)
    };
    let known = placed(again.clone()).unwrap();
    assert!(
        held(&known).0 > 0
            && known.needed() == again.loaded.scene.objects.as_ref().unwrap().needed()
    );
    let mut same = again.clone();
    same.loaded.scene.objects = Some(known);
    assert!(picture(&same) == expected);
    let finer = again.with_surfel_size(VIEWS[1].surfel_size / 2.0).unwrap();
    let line = placed(finer).unwrap_err().to_string();
    assert!(line.contains("out/surfels-") || line.contains("out/mesh-"), "{line}");
}

/// A prefix that has to grow goes on where it ended, half as far again and not beyond its end. One that
/// shrinks is cut.
#[test]
fn a_prefix_that_grows_goes_on_where_it_ended() {
    let at = made();
    let exec = Exec::sequential();
    let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
    let whole_file = fs::read(at.path().join("out/surfels-0")).unwrap();
    let camera = scene(&at, VIEWS[0], "blue").ready(&exec, &quiet).unwrap().camera;
    let sized = |objects: Objects, surfel_size: f32| {
        let refinement = Refinement { surfel_size, ..Refinement::default() };
        objects.with_refinement(refinement).unwrap().seen_from(&camera, &exec).unwrap()
    };
    let far = sized(hierarchy.outlined(&exec, &quiet).unwrap(), 9.0);
    let root = |objects: &Objects| {
        let all = objects.geometries().iter().zip(objects.needed()).zip(objects.missing());
        let at = all.into_iter().find(|((_, needed), _)| needed.surfels > 0).unwrap();
        (at.0.0.surfels.len() as u32, at.0.1.surfels, at.1.surfels)
    };
    let (held, needed, missing) = root(&far);
    assert_eq!((held, missing), (0, 0..needed), "the first view reads what it draws");
    let far = hierarchy.needed_by(far, &exec, &quiet).unwrap();
    assert_eq!(root(&far), (needed, needed, needed..needed));
    let near = sized(far, 8.0);
    let (held, grown, missing) = root(&near);
    assert!(held == needed && grown > needed);
    let end = (grown + grown / 2).min(hierarchy.nodes()[0].surfels);
    assert_eq!(missing, held..end);
    let near = hierarchy.needed_by(near, &exec, &quiet).unwrap();
    assert_eq!(root(&near), (end, grown, end..end));
    // The same surfels as when they are read at once.
    let at_once = |count: u32| {
        let missing = Missing { surfels: 0..count, primitives: false };
        hierarchy.read(0, missing, Surfels::none(), &exec).unwrap().0
    };
    let first = |objects: &Objects| objects.geometries()[0].surfels.clone();
    assert_eq!(first(&near), at_once(end));
    // Coarser again: kept up to twice what is drawn, then cut, without a file.
    fs::remove_file(at.path().join("out/surfels-0")).unwrap();
    let coarse = hierarchy.needed_by(sized(near, 40.0), &exec, &quiet).unwrap();
    let (held, needed, missing) = root(&coarse);
    assert_eq!((held, missing), (needed, needed..needed));
    assert!(2 * needed < end, "{needed} {end}");
    fs::write(at.path().join("out/surfels-0"), whole_file).unwrap();
    assert_eq!(first(&coarse), at_once(needed));
}

#[test]
fn bounds_are_those_of_each_node_and_are_not_needed() {
    let at = made();
    let out = at.path().join("out");
    let exec = Exec::sequential();
    let hierarchy = Hierarchy::open(&out).unwrap();
    let bounds = hierarchy.bounds(&exec, &quiet).unwrap();
    let loaded = hierarchy.load(&exec, &quiet).unwrap();
    for geometry in loaded.geometries() {
        let node: usize = geometry.name.rsplit("node-").next().unwrap().parse().unwrap();
        let Bounds { low, high, radius } = bounds[node];
        // By hand: every surfel and every corner, in any order.
        let Primitives { triangles, .. } = &geometry.primitives;
        let corners = triangles.corners().iter().flatten();
        let corners = corners.map(|&i| (triangles.vertices().position[i as usize], 0.0));
        let surfels: &Surfels = &geometry.surfels;
        let all = surfels.position().iter().copied().zip(surfels.radius().iter().copied());
        let all: Vec<(Vec3, f32)> = all.chain(corners).collect();
        for axis in 0..3 {
            let mut along: Vec<f32> = all.iter().map(|(p, _)| p[axis]).collect();
            along.sort_by(f32::total_cmp);
            assert_eq!((low[axis], high[axis]), (along[0], along[along.len() - 1]));
        }
        let middle = (low.as_dvec3() + high.as_dvec3()) / 2.0;
        let reach = all.iter().map(|(p, r)| (p.as_dvec3() - middle).length() + f64::from(*r));
        assert_eq!(radius, reach.fold(0.0, Real::at_least));
    }
    let file = scene(&at, VIEWS[2], "blue");
    let expected = read(&file).unwrap().0;
    let whole = fs::read(out.join("bounds")).unwrap();
    fs::remove_file(out.join("bounds")).unwrap();
    assert!(read(&file).unwrap().0 == expected, "as folders of earlier versions are");
    let told = |bytes: &[u8]| {
        fs::write(out.join("bounds"), bytes).unwrap();
        read(&file).unwrap_err().to_string()
    };
    for end in [0, 20, 55, 56, whole.len() - 1] {
        assert!(told(&whole[..end]).contains("out/bounds: "), "{end}");
    }
    let changed = |at: usize, value: u8| {
        let mut bytes = whole.clone();
        bytes[at] = value;
        bytes
    };
    assert!(told(&changed(0, 0)).contains("not the bounds of a splatref hierarchy"));
    assert!(told(&changed(20, whole[20] ^ 1)).contains("damaged: its checksum is wrong"));
    let sealed = |bytes: &[u8]| told(&checksum::seal(bytes[..bytes.len() - 4].to_vec()));
    assert!(sealed(&changed(20, whole[20] ^ 1)).contains("belong to another hierarchy"));
    // The radius of node 0 below 0, and the highest byte of its low x not finite.
    for (at, value) in [(56 + 31, 0xc0), (56 + 3, 0xff)] {
        let mut bytes = changed(at, value);
        bytes[56 + 2] |= if at == 56 + 3 { 0x80 } else { 0 };
        assert!(sealed(&bytes).contains("the bounds of node 0 are invalid"), "{at}");
    }
    fs::write(out.join("bounds"), &whole).unwrap();
    assert!(read(&file).unwrap().0 == expected);
    make(&at, "scene.toml", "out", &quick(Traversal::BottomUp)).unwrap();
    assert_eq!(fs::read(out.join("bounds")).unwrap(), whole, "made again it is the same");
}
