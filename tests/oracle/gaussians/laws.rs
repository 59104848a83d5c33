//! What pictures of Gaussians must keep, whatever the scene.

use crate::oracle::gaussians::cases::{self, PRESETS};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{digest, index, number, numbers, pixels, plane, value};
use crate::oracle::kit::scene::ahead;
use glam::{Mat4, Quat, Vec3};
use splatref::frame::{Exec, Frame, Plane};
use splatref::method::gaussians::{BlendSpace, Order, Settings};
use splatref::number::Exact;
use splatref::scene::environment::Map;
use splatref::scene::gaussians::Encoding;
use splatref::scene::{Camera, Environment, GaussianArrays, Lens, Scene, Surface};

const SIZE: [u32; 2] = [33, 17];

/// Asserts that two frames are equal up to a relative difference, but for a hundredth of the pixels
/// where another fragment is drawn.
pub(crate) fn alike(a: &Frame<f64>, b: &Frame<f64>, part: f64, name: &str) {
    let mut others = 0;
    for i in pixels(a) {
        let ids = |f| ["id", "heaviest"].map(|plane| index(f, plane, i));
        if ids(a) != ids(b) || number(a, "count", i) != number(b, "count", i) {
            others += 1;
            continue;
        }
        for plane in ["", "A", "blended", "T", "Z", "Z.expected", "Z.median"] {
            // The depth of a ray that grazes a flake moves most.
            let part = if plane.starts_with('Z') { 100.0 * part } else { part };
            for (a, b) in value(a, plane, i).into_iter().zip(value(b, plane, i)) {
                let close = a == b || (a - b).abs() <= part * a.abs().max(1.0);
                assert!(close, "plane '{plane}', pixel {i}: {a} and {b}: {name}");
            }
        }
    }
    assert!(others * 100 <= pixels(a).len(), "{others} pixels have other fragments: {name}");
}

fn prefix(arrays: &GaussianArrays, n: usize) -> Scene {
    let each = arrays.harmonics.len() / arrays.position.len();
    let mut some = arrays.clone();
    some.position.truncate(n);
    some.scale.truncate(n);
    some.rotation.truncate(n);
    some.opacity.truncate(n);
    some.harmonics.truncate(n * each);
    cases::scene_of(some)
}

/// Not with a stop, which a splat in front of it may bring nearer: what it leaves out would have
/// hidden more. And not in steps, which are wider for a splat afar.
#[test]
fn transmittance_never_rises_with_more_splats() {
    fn check<R: Exact>(arrays: &GaussianArrays, settings: Settings, name: &str) {
        let camera = cases::camera(false, SIZE);
        let mut last: Option<Vec<f64>> = None;
        for n in 1..=arrays.position.len() {
            let scene = prefix(arrays, n);
            let frame = Drawing::new(&scene, &camera, settings).frame::<R>();
            let through = numbers(&frame, "T");
            if let Some(last) = last {
                let falls = through.iter().zip(&last).all(|(now, before)| now <= before);
                assert!(falls, "{name}, splat {}", n - 1);
            }
            last = Some(through);
        }
    }
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        let arrays = cases::arrays(24, 0, 60 + p as u64);
        // An order by pixel sorts depths that rounding may swap, but T is the same product but for
        // its rounding, and one order for the picture leaves the order of the others.
        let order = if settings.order == Order::Pixel { Order::Distance } else { settings.order };
        let settings = Settings { stop: 0.0, order, ..settings };
        check::<f32>(&arrays, settings, name);
        check::<f64>(&arrays, settings, name);
    }
}

/// Degree 1 turns with the scene: its three coefficients are a vector.
#[test]
fn a_rotation_of_scene_harmonics_and_camera_together_leaves_the_picture() {
    let mut dice = Dice(4);
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        for orthographic in [false, true] {
            let turn = Quat::from_array(cases::rotation(&mut dice)).normalize();
            let arrays = cases::arrays(30, 1, 70 + p as u64);
            let turned = cases::scene_of(turned(arrays.clone(), turn));
            let camera = cases::camera(orthographic, SIZE);
            let back = Mat4::from_quat(turn.inverse());
            let mut with = camera;
            with.view_from_world = camera.view_from_world * back;
            let before = cases::scene_of(arrays);
            let a = Drawing::new(&before, &camera, settings).frame::<f64>();
            let b = Drawing::new(&turned, &with, settings).frame::<f64>();
            alike(&a, &b, 1e-4, name);
        }
    }
}

fn turned(mut arrays: GaussianArrays, turn: Quat) -> GaussianArrays {
    arrays.position.iter_mut().for_each(|p| *p = turn * *p);
    for q in &mut arrays.rotation {
        *q = (turn * Quat::from_array(*q).normalize()).to_array();
    }
    for four in arrays.harmonics.chunks_exact_mut(4) {
        let [_, y, z, x] = [four[0], four[1], four[2], four[3]].map(|c| c.to_array());
        for c in 0..3 {
            let v = turn * Vec3::new(-x[c], -y[c], z[c]);
            (four[1][c], four[2][c], four[3][c]) = (-v.y, v.z, -v.x);
        }
    }
    arrays
}

/// Splats of 1 px, 4 px apart, cut off at 3 deviations of less than 2 px.
fn apart() -> GaussianArrays {
    let mut dice = Dice(9);
    let mut arrays = cases::arrays(32, 0, 80);
    for i in 0..32 {
        let t = dice.within(2.0, 6.0);
        let at = [(i % 8) as f32 * 4.0 - 14.0, (i / 8) as f32 * 4.0 - 6.0];
        arrays.position[i] = Vec3::new(at[0] * t / 24.0, at[1] * t / 24.0, -t);
        arrays.scale[i] = Vec3::splat(t / 24.0 * 0.25);
    }
    arrays
}

#[test]
fn the_order_is_irrelevant_where_supports_are_disjoint() {
    let camera = ahead(Lens::Focal(24.0), SIZE);
    let scene = cases::scene_of(apart());
    let draw = |scene: &Scene, order| {
        let settings = Settings { order, ..Settings::KHR };
        Drawing::new(scene, &camera, settings).frame::<f32>()
    };
    let first = draw(&scene, Order::Depth);
    let most = numbers(&first, "count").into_iter().fold(0.0, f64::max);
    assert_eq!(most, 1.0, "disjoint");
    let mut back = apart();
    back.position.reverse();
    back.scale.reverse();
    back.rotation.reverse();
    back.opacity.reverse();
    back.harmonics.reverse();
    let back = cases::scene_of(back);
    for order in [Order::Depth, Order::Distance, Order::Steps, Order::Pixel] {
        for scene in [&scene, &back] {
            let frame = draw(scene, order);
            for name in ["", "A", "blended", "T", "count"] {
                assert!(plane(&frame, name) == plane(&first, name), "'{name}', {order:?}");
            }
        }
    }
}

#[test]
fn the_sign_of_a_quaternion_changes_no_bit() {
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        let arrays = cases::arrays(40, 2, 90 + p as u64);
        let mut negated = arrays.clone();
        negated.rotation.iter_mut().flatten().for_each(|part| *part = -*part);
        let camera = cases::camera(p % 2 == 1, SIZE);
        let [a, b] = [arrays, negated].map(|arrays| {
            let scene = cases::scene_of(arrays);
            let drawing = Drawing::new(&scene, &camera, settings);
            let (narrow, wide) = (drawing.frame::<f32>(), drawing.frame::<f64>());
            (digest(&narrow), digest(&wide), digest(&drawing.fast().frame))
        });
        assert!(a == b, "{name}");
    }
}

#[test]
fn threads_and_tiles_leave_no_trace() {
    let one = Exec::new(1, 16).expect("in range");
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        let mut scene = cases::random(60, 1, Encoding::Srgb, 40 + p as u64);
        scene.surface = (p % 2 == 0).then(|| cases::opaque([67, 37], p as u64));
        let camera = cases::camera(p == 3, [67, 37]);
        let drawing = Drawing::new(&scene, &camera, settings);
        let bits = |exec: &Exec| {
            let drawing = drawing.on(exec);
            [digest(&drawing.frame::<f32>()), digest(&drawing.fast().frame)]
        };
        let wanted = bits(&one);
        for (threads, tile) in [(1, 8), (1, 64), (2, 16), (2, 64), (3, 8), (3, 32)] {
            let exec = Exec::new(threads, tile).expect("in range");
            assert!(bits(&exec) == wanted, "{name}: {threads} threads, tiles of {tile}");
        }
    }
}

/// The picture without stages, and the fast path if there is one, have the bits of the definition.
#[test]
fn the_fast_path_has_the_bits_of_the_plain_one() {
    for case in cases::all().into_iter().step_by(3) {
        let (plain, fast) = (case.drawing().frame::<f32>(), case.drawing().fast().frame);
        for made in &fast.planes {
            let same = plane(&plain, &made.name) == &made.samples;
            assert!(same, "plane '{}' of {}", made.name, case.name);
        }
    }
}

/// One depth at every pixel, in colours that differ or in this one.
fn wall(depth: f32, color: Option<[f32; 3]>) -> Surface {
    let mut dice = Dice(12);
    let mut pixel = || color.unwrap_or_else(|| [(); 3].map(|()| dice.within(0.0, 1.5)));
    let [width, height] = SIZE;
    let colors = (0..width * height).map(|_| pixel()).collect();
    let depths = Plane::filled(width, height, depth);
    Surface::new(depths, Plane::from_values(width, height, colors)).expect("a surface")
}

/// The digests of all planes in both numbers and by the fast path.
fn all_bits(scene: &Scene, camera: &Camera, settings: Settings) -> [Vec<u8>; 3] {
    let drawing = Drawing::new(scene, camera, settings);
    [
        digest(&drawing.frame::<f32>()),
        digest(&drawing.frame::<f64>()),
        digest(&drawing.fast().frame),
    ]
}

#[test]
fn a_surface_that_is_nowhere_changes_nothing() {
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        let mut scene = cases::random(40, 1, Encoding::Srgb, 110 + p as u64);
        scene.environment = (p % 2 == 0).then_some(Environment::Sky);
        let camera = cases::camera(p == 3, SIZE);
        let bare = all_bits(&scene, &camera, settings);
        scene.surface = Some(wall(f32::INFINITY, None));
        assert!(all_bits(&scene, &camera, settings) == bare, "{name}");
    }
}

#[test]
fn a_surface_before_everything_is_the_picture() {
    fn check<R: Exact>(frame: &Frame<R>, surface: &Surface, name: &str) {
        for (i, color) in surface.colors().values().iter().enumerate() {
            assert_eq!(value(frame, "", i), color.map(f64::from), "{name}, pixel {i}");
            let empty = [number(frame, "T", i), number(frame, "A", i), number(frame, "count", i)];
            assert_eq!(empty, [1.0, 1.0, 0.0], "{name}, pixel {i}");
            assert_eq!(number(frame, "Z", i), f64::INFINITY, "{name}, pixel {i}");
        }
    }
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        let mut scene = cases::random(40, 1, Encoding::Srgb, 120 + p as u64);
        let surface = wall(0.0, None);
        scene.surface = Some(surface.clone());
        let camera = cases::camera(p == 3, SIZE);
        let drawing = Drawing::new(&scene, &camera, settings);
        check(&drawing.frame::<f32>(), &surface, name);
        check(&drawing.frame::<f64>(), &surface, name);
        check(&drawing.fast().frame, &surface, name);
    }
}

/// In linear light, where an environment is not rounded by encoding and decoding.
#[test]
fn a_surface_behind_everything_is_an_environment_of_its_colour() {
    let color = [0.25, 0.75, 0.125];
    let map = Map::new(Plane::filled(8, 4, color)).expect("a map");
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        let settings = Settings { blend: BlendSpace::Linear, ..settings };
        let mut scene = cases::random(40, 1, Encoding::Srgb, 130 + p as u64);
        scene.environment = Some(Environment::Map(map.clone()));
        let camera = cases::camera(p == 3, SIZE);
        let around = all_bits(&scene, &camera, settings);
        (scene.environment, scene.surface) = (None, Some(wall(1e30, Some(color))));
        assert!(all_bits(&scene, &camera, settings) == around, "{name}");
    }
}

/// Where splats have one depth each, a wall leaves the picture of those that are not behind it.
#[test]
fn a_wall_leaves_out_the_splats_behind_it() {
    let camera = cases::camera(false, SIZE);
    let row = camera.view_from_world.row(2).as_dvec4();
    let some = |arrays: &GaussianArrays, keep: &dyn Fn(Vec3) -> bool| {
        let all = || (0..arrays.position.len()).filter(|i| keep(arrays.position[*i]));
        GaussianArrays {
            position: all().map(|i| arrays.position[i]).collect(),
            scale: all().map(|i| arrays.scale[i]).collect(),
            rotation: all().map(|i| arrays.rotation[i]).collect(),
            opacity: all().map(|i| arrays.opacity[i]).collect(),
            harmonics: all().map(|i| arrays.harmonics[i]).collect(),
            ..arrays.clone()
        }
    };
    for (p, (name, settings)) in PRESETS.into_iter().take(4).enumerate() {
        let arrays = cases::arrays(40, 0, 140 + p as u64);
        let depth = |at: Vec3| -row.dot(at.as_dvec3().extend(1.0));
        let mut depths: Vec<f64> = arrays.position.iter().map(|at| depth(*at)).collect();
        depths.sort_by(f64::total_cmp);
        // Between two splats, where no rounding reaches.
        let gap = |i: &usize| depths[*i + 1] - depths[*i];
        let widest = (15..25).max_by(|a, b| gap(a).total_cmp(&gap(b))).expect("a gap");
        let at = 0.5 * (depths[widest] + depths[widest + 1]);
        let before = cases::scene_of(some(&arrays, &|own| depth(own) < at));
        let mixed = Scene { surface: Some(wall(at as f32, None)), ..cases::scene_of(arrays) };
        let [a, b] = [&before, &mixed].map(|scene| {
            let drawing = Drawing::new(scene, &camera, settings);
            (drawing.frame::<f64>(), drawing.fast().frame)
        });
        for plane in ["blended", "T", "Z", "Z.expected", "Z.median", "count"] {
            let same = self::plane(&a.0, plane) == self::plane(&b.0, plane)
                && self::plane(&a.1, plane) == self::plane(&b.1, plane);
            assert!(same, "{name}: '{plane}'");
        }
    }
}
