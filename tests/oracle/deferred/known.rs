//! Known answers: frames of a few discs whose pixels follow by hand.
//!
//! A pixel is a world unit, discs face the camera, and there is no low-pass filter: at the distance
//! d from its centre a disc of radius r weighs exp(-2 d d / (r r)), up to d = r.

use crate::oracle::deferred::place::{Thing, World};
use crate::oracle::kit::planes::{index, number, numbers, value};
use crate::oracle::kit::scene::{OUTLINES, scene};
use crate::oracle::template::cases::{Dot, exact_camera, exact_scene};
use glam::{DVec3, Vec3};
use splatref::frame::{Exec, Frame, NO_ID};
use splatref::index::seen::Seen;
use splatref::method::deferred::Settings;
use splatref::method::{Picture, Session};
use splatref::number::Exact;
use splatref::scene::{Scene, Similarity, Surfels};
use splatref::splat::{Epsilon, Kernel, Outline, SplatSettings};

pub(super) const RED: Vec3 = Vec3::X;
pub(super) const BLUE: Vec3 = Vec3::Z;
/// The id of the first surfel of the second object.
const SECOND: u32 = 1 << 20;

pub(super) fn settings(outline: Outline, epsilon: f32) -> Settings {
    let kernel = Kernel { outline, cutoff: 2.0, low_pass: 0.0 };
    let splats = SplatSettings { kernel, epsilon: Epsilon::World(epsilon), cull: true };
    Settings { splats, flags: 64, second: true, share: 0.0 }
}

/// Displaced to a place in the picture and a depth, where a [`Dot`] at (0, 0, 0) then is.
pub(super) fn to(x: f64, y: f64, depth: f64) -> Similarity {
    Similarity { translation: DVec3::new(x, -y, -depth), ..Similarity::IDENTITY }
}

/// One disc at the origin, of a radius.
pub(super) fn disc(radius: f32) -> Surfels {
    exact_scene(&[Dot::new(0.0, 0.0, radius).at_depth(0.0)]).surfels
}

/// Keys of a motion.
pub(super) type Keys<'a> = &'a [(u32, Similarity)];

pub(super) fn thing(geometry: usize, keys: Keys<'_>, color: Vec3) -> Thing {
    Thing { geometry, keys: keys.to_vec(), color: Some(color) }
}

/// Objects of one disc each: its radius, its keys and its colour.
fn world(all: &[(f32, Keys<'_>, Vec3)]) -> World {
    let geometries = all.iter().map(|(radius, ..)| disc(*radius)).collect();
    let objects = all.iter().enumerate().map(|(i, (_, keys, color))| thing(i, keys, *color));
    World { geometries, whole: Vec::new(), objects: objects.collect(), fill: Vec3::ONE }
}

/// A frame, given what another saw.
pub(super) fn shot<R: Exact>(
    world: &World,
    settings: Settings,
    size: [u32; 2],
    (frame, seen): (u32, Option<&Seen>),
) -> Picture<R> {
    let objects = world.objects().at(frame).expect("in range");
    let scene = Scene { objects: Some(objects), ..scene(Surfels::none()) };
    let exec = Exec::sequential();
    let mut session = Session::new(&scene, settings.into(), &exec).expect("a session");
    session.resume(seen.cloned());
    session.define(&exact_camera(size), true).expect("renders")
}

/// What a frame saw that selected these.
fn after(world: &World, group: u32, selected: &[u64]) -> Seen {
    Seen::from_selected(world.objects().ids(), group, selected)
}

pub(super) fn selected<R: Exact>(frame: &Frame<R>) -> Vec<u32> {
    let pixels = (frame.width * frame.height) as usize;
    let ids = (0..pixels).map(|i| index(frame, "indices.id", i));
    let mut all: Vec<_> = ids.filter(|id| *id != NO_ID).collect();
    all.sort_unstable();
    all
}

/// The weight of a disc about the pixel (cx, cy) at the pixel (x, y); 0 beyond its rim.
fn weight([cx, cy]: [i32; 2], [x, y]: [i32; 2], radius: i32) -> f64 {
    let (square, rim) = ((x - cx).pow(2) + (y - cy).pow(2), radius * radius);
    if square <= rim { (-2.0 * f64::from(square) / f64::from(rim)).exp() } else { 0.0 }
}

/// What a pixel shows: colour, weight, depth, id.
pub(super) type Shows = ([f64; 3], f64, f64, u32);

const EMPTY: Shows = ([0.0; 3], 0.0, f64::INFINITY, NO_ID);

pub(super) fn assert_shows(frame: &Frame<f64>, [x, y]: [i32; 2], expected: Shows, name: &str) {
    let i = (y as u32 * frame.width + x as u32) as usize;
    let (color, weight) = (value(frame, "", i), number(frame, "weight", i));
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-14;
    let colors = color.iter().zip(expected.0).all(|(a, b)| close(*a, b));
    assert!(colors, "{name}, ({x}, {y}): {color:?} for {:?}", expected.0);
    assert!(close(weight, expected.1), "{name}, ({x}, {y}): weight {weight} for {}", expected.1);
    let rest = (number(frame, "Z", i), index(frame, "id", i));
    assert_eq!(rest, (expected.2, expected.3), "{name}, ({x}, {y}): depth and id");
}

pub(super) fn rgb(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

#[test]
fn deferred_a_disc_that_was_hidden_becomes_visible() {
    // Red before blue, their centres in one pixel; in frame 1 red is 4 px to the left.
    let moves = [(0, to(4.5, 4.5, 2.0)), (1, to(0.5, 4.5, 2.0))];
    let rests = [(0, to(4.5, 4.5, 4.0))];
    let world = world(&[(3.0, &moves, RED), (3.0, &rests, BLUE)]);
    for (outline, second) in OUTLINES.into_iter().flat_map(|o| [(o, true), (o, false)]) {
        let settings = Settings { second, ..settings(outline, 1.0) };
        let name = &format!("{settings:?}");
        let first = shot::<f64>(&world, settings, [9; 2], (0, None));
        assert!(
            numbers(&first.frame, "visibility.Z").iter().all(|z| *z == f64::INFINITY),
            "{name}"
        );
        assert_eq!(selected(&first.frame), [0], "{name}");
        let next = shot::<f64>(&world, settings, [9; 2], (1, first.seen.as_ref()));
        assert_eq!(selected(&next.frame), [0, SECOND], "{name}");
        let pixels = (0..9).flat_map(|y| (0..9).map(move |x| [x, y]));
        let (mut both, mut behind) = (0, 0);
        for at in pixels {
            let [was, red, blue] = [[4, 4], [0, 4], [4, 4]].map(|centre| weight(centre, at, 3));
            let show = |w: f64, shows: Shows| if w > 0.0 { shows } else { EMPTY };
            assert_shows(&first.frame, at, show(was, (rgb(RED), was, 2.0, 0)), name);
            let hidden = show(blue, (rgb(BLUE), blue, 4.0, SECOND));
            let expected = if red > 0.0 { (rgb(RED), red, 2.0, 0) } else { hidden };
            assert_shows(&next.frame, at, expected, name);
            let i = (at[1] * 9 + at[0]) as usize;
            let before = if red > 0.0 { 2.0 } else { f64::INFINITY };
            assert_eq!(number(&next.frame, "visibility.Z", i), before, "{name}: pass 1 draws red");
            both += usize::from(red > 0.0 && blue > 0.0);
            behind += usize::from(red == 0.0 && blue > 0.0);
        }
        assert!(both > 5 && behind > 10, "{both}, {behind}");
    }
}

#[test]
fn deferred_a_centre_may_lie_as_deep_as_epsilon_behind_the_depth() {
    // Blue's centre, at depth 3, lies under red at depth 2.
    let world =
        world(&[(3.0, &[(0, to(2.5, 2.5, 2.0))], RED), (1.0, &[(0, to(4.5, 2.5, 3.0))], BLUE)]);
    let red = weight([2, 2], [4, 2], 3);
    let mixed = [red / (red + 1.0), 0.0, 1.0 / (red + 1.0)];
    for outline in OUTLINES {
        // The depth with the lesser of them is the number before 3 in `f32`.
        for (epsilon, passes) in [(1.0, true), (1.0 - (-22.0_f32).exp2(), false), (0.0, false)] {
            let settings = settings(outline, epsilon);
            let name = &format!("{settings:?}");
            // Without depth nothing fails; pass 4 hides what lies behind.
            let first = shot::<f64>(&world, settings, [8, 5], (0, None));
            assert_eq!(selected(&first.frame), [0, SECOND], "{name}");
            let next = shot::<f64>(&world, settings, [8, 5], (1, first.seen.as_ref()));
            let expected: &[u32] = if passes { &[0, SECOND] } else { &[0] };
            assert_eq!(selected(&next.frame), expected, "{name}");
            let both = (mixed, red + 1.0, 2.0, 0);
            let one = (rgb(RED), red, 2.0, 0);
            for picture in [&first, &next] {
                assert_shows(&picture.frame, [4, 2], if passes { both } else { one }, name);
            }
            // Right of red's rim only blue is; once it is not selected, nothing.
            assert_eq!(weight([2, 2], [5, 2], 3), (-2.0_f64).exp());
            let narrow = shot::<f32>(&world, settings, [8, 5], (1, first.seen.as_ref()));
            assert_eq!(selected(&narrow.frame), expected, "{name}: f32");
        }
    }
}

#[test]
fn deferred_equally_near_fragments_of_both_passes_go_to_the_lower_id() {
    let world =
        world(&[(3.0, &[(0, to(2.5, 2.5, 2.0))], RED), (3.0, &[(0, to(4.5, 2.5, 2.0))], BLUE)]);
    for outline in OUTLINES {
        let settings = settings(outline, 0.0);
        for (group, flagged) in [(64, vec![0]), (1, vec![u64::from(SECOND)]), (1, vec![])] {
            let settings = Settings { flags: group, ..settings };
            let seen = after(&world, group, &flagged);
            let Picture { frame, .. } = shot::<f64>(&world, settings, [8, 5], (1, Some(&seen)));
            assert_eq!(selected(&frame), [0, SECOND]);
            for (i, x) in (16..24).zip(0..8) {
                let [red, blue] = [[2, 2], [4, 2]].map(|centre| weight(centre, [x, 2], 3));
                let id = if red > 0.0 { 0 } else { SECOND };
                let id = if red + blue > 0.0 { id } else { NO_ID };
                assert_eq!(index(&frame, "difference.id", i), id, "{flagged:?}, column {x}");
                assert_eq!(index(&frame, "id", i), id, "{flagged:?}, column {x}");
                let before = match flagged.first() {
                    Some(0) if red > 0.0 => 0,
                    Some(1..) if blue > 0.0 => SECOND,
                    _ => NO_ID,
                };
                assert_eq!(index(&frame, "visibility.id", i), before, "{flagged:?}, column {x}");
            }
        }
    }
}

#[test]
fn deferred_without_a_depth_everything_is_added_up() {
    let world =
        world(&[(3.0, &[(0, to(2.5, 2.5, 6.0))], RED), (3.0, &[(0, to(4.5, 2.5, 2.0))], BLUE)]);
    for outline in OUTLINES {
        let with = settings(outline, 1.0);
        let without = Settings { second: false, ..with };
        let off = shot::<f64>(&world, without, [9, 5], (0, None)).frame;
        let on = shot::<f64>(&world, with, [9, 5], (0, None)).frame;
        for at in (0..5).flat_map(|y| (0..9).map(move |x| [x, y])) {
            let [red, blue] = [[2, 2], [4, 2]].map(|centre| weight(centre, at, 3));
            let sum = red + blue;
            let both = ([red / sum, 0.0, blue / sum], sum, 2.0, SECOND);
            let alone = (rgb(RED), red, 6.0, 0);
            let front = (rgb(BLUE), blue, 2.0, SECOND);
            let [all, nearest] = match (red > 0.0, blue > 0.0) {
                (true, true) => [both, front],
                (true, false) => [alone; 2],
                (false, true) => [front; 2],
                (false, false) => [EMPTY; 2],
            };
            assert_shows(&off, at, all, "without pass 3");
            assert_shows(&on, at, nearest, "with pass 3");
        }
        assert!(numbers(&off, "difference.Z").iter().all(|z| *z == f64::INFINITY));
        // Where pass 1 has left the depth of the farther disc, the nearer one is in the sums, and
        // the pixel names what left the depth.
        let seen = after(&world, 64, &[0]);
        let late = shot::<f64>(&world, without, [9, 5], (1, Some(&seen))).frame;
        let [red, blue] = [[2, 2], [4, 2]].map(|centre| weight(centre, [3, 2], 3));
        let both = ([red / (red + blue), 0.0, blue / (red + blue)], red + blue, 6.0, 0);
        assert_shows(&late, [3, 2], both, "pass 3 off, red flagged");
    }
}

#[test]
fn deferred_the_nearest_of_a_pixel_may_not_be_selected() {
    // Two discs that share a flag: one in the picture, one whose centre is left of it. And a small
    // blue disc half a unit behind the latter.
    let pair = [Dot::new(12.5, 2.5, 1.0).at_depth(2.0), Dot::new(-0.5, 2.5, 3.0).at_depth(2.0)];
    let geometries = vec![exact_scene(&pair).surfels, disc(1.0)];
    let blue = thing(1, &[(0, to(0.5, 2.5, 2.5))], BLUE);
    let objects = vec![thing(0, &[(0, Similarity::IDENTITY)], RED), blue];
    let world = World { geometries, whole: Vec::new(), objects, fill: Vec3::ONE };
    for outline in OUTLINES {
        for epsilon in [1.0, 0.5, 0.25] {
            let settings = Settings { flags: 2, ..settings(outline, epsilon) };
            let seen = after(&world, 2, &[0]);
            let Picture { frame, .. } = shot::<f64>(&world, settings, [14, 5], (1, Some(&seen)));
            let chosen = epsilon >= 0.5;
            let expected: &[u32] = if chosen { &[0, SECOND] } else { &[0] };
            assert_eq!(selected(&frame), expected, "{settings:?}");
            for at in (0..5).flat_map(|y| (0..4).map(move |x| [x, y])) {
                let [left, blue] = [([-1, 2], 3), ([0, 2], 1)].map(|(c, r)| weight(c, at, r));
                let i = (at[1] * 14 + at[0]) as usize;
                let depth = number(&frame, "difference.Z", i);
                let own = (rgb(BLUE), blue, 2.0, 1);
                assert_eq!(depth == 2.0, left > 0.0, "{at:?}: the disc of the flag leaves depth");
                let shows = if chosen && blue > 0.0 { own } else { EMPTY };
                assert!(blue == 0.0 || left > 0.0, "blue lies under the other");
                assert_shows(&frame, at, shows, &format!("{settings:?}"));
            }
        }
    }
}

#[test]
fn deferred_what_is_seen_from_behind_takes_no_pixel_if_it_is_culled() {
    let back = Dot { normal: Vec3::NEG_Z, ..Dot::new(0.0, 0.0, 1.0).at_depth(0.0) };
    let geometries = vec![exact_scene(&[back]).surfels, disc(1.0)];
    let objects =
        vec![thing(0, &[(0, to(1.5, 1.5, 2.0))], RED), thing(1, &[(0, to(1.5, 1.5, 4.0))], BLUE)];
    let world = World { geometries, whole: Vec::new(), objects, fill: Vec3::ONE };
    for (cull, id, color, depth) in [(true, SECOND, BLUE, 4.0), (false, 0, RED, 2.0)] {
        let mut settings = settings(Outline::Affine, 1.0);
        settings.splats.cull = cull;
        let Picture { frame, .. } = shot::<f64>(&world, settings, [3; 2], (0, None));
        assert_eq!(selected(&frame), [id]);
        assert_shows(&frame, [1, 1], (rgb(color), 1.0, depth, id), "culling");
        let normal = value(&frame, "normal", 4);
        assert_eq!(normal, [0.0, 0.0, 1.0], "towards the viewer");
    }
}

#[test]
fn deferred_a_frame_that_selects_nothing_has_all_planes() {
    // In frame 0 the disc is in the picture, in frame 1 behind the camera.
    let moves = [(0, to(1.5, 1.5, 2.0)), (1, to(1.5, 1.5, -2.0))];
    let world = world(&[(1.0, &moves, RED)]);
    let names = |frame: u32| -> Vec<String> {
        let settings = settings(Outline::Affine, 1.0);
        let Picture { frame, .. } = shot::<f64>(&world, settings, [3; 2], (frame, None));
        frame.planes.iter().map(|plane| plane.name.clone()).collect()
    };
    assert_eq!(names(0), names(1), "a scene with colours has planes of colours");
}
