use super::*;
use crate::frame::{Exec, Frame, NO_ID, Plane};
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::{Method, Session, ewa, peeling, single_pass};
use crate::scene::{Cloud, Groups, Lens, Pose, Sphere, Surfels};
use crate::source::Shape;
use crate::splat::Epsilon;
use glam::{DVec3, Vec3};
use proptest::prelude::*;

/// The value of a half float's bits, by its fields.
fn decoded(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let power = |e: i32| (0..e.abs()).fold(1.0, |p, _| if e < 0 { p / 2.0 } else { p * 2.0 });
    let value = match exponent {
        0 => fraction * power(-24),
        _ => (1024.0 + fraction) * power(exponent - 25),
    };
    if bits >> 15 == 1 { -value } else { value }
}

/// Every half float stays itself. A number between two half floats goes to the nearer one, and
/// halfway to the even one.
#[test]
fn halves_are_the_nearest() {
    for bits in 0..0x7c00_u16 {
        let (low, high) = (decoded(bits), decoded(bits + 1));
        assert_eq!([half(low), half(-low)], [low, -low], "{bits:#x}");
        if bits == 0x7bff {
            break;
        }
        let middle = f64::midpoint(low, high);
        let even = if bits % 2 == 0 { low } else { high };
        assert_eq!([half(middle), half(-middle)], [even, -even], "{bits:#x}");
        assert_eq!([half(middle.next_down()), half(middle.next_up())], [low, high], "{bits:#x}");
    }
    assert_eq!([half(65_519.9), half(65_520.0), half(-1e38)], [65_504.0, 65_504.0, -65_504.0]);
    assert_eq!(half(f64::INFINITY), f64::INFINITY, "an empty depth stays");
}

#[test]
fn eight_bits_have_256_values() {
    let stored = |v| Buffers::Unorm8.number(v);
    for code in 0..=255 {
        let value = f64::from(code) / 255.0;
        assert_eq!(stored(value), value);
        assert_eq!(stored(value + 0.499 / 255.0), value);
    }
    assert_eq!([stored(-3.0), stored(7.0), stored(f64::INFINITY)], [0.0, 1.0, 1.0]);
    let signed = |v| Buffers::Unorm8.signed(v);
    assert_eq!([signed(-1.0), signed(1.0), signed(-5.0), signed(0.001)], [-1.0, 1.0, -1.0, 0.0]);
}

fn range(perspective: bool) -> DepthRange {
    DepthRange { near: 2.0, far: 6.0, perspective }
}

/// The step of t is the step of z times the derivative of t by z: t^2 (f - n) / (n f) / (2^N - 1).
#[test]
fn a_depth_is_off_by_half_a_step_of_its_buffer() {
    for (format, count) in [(DepthBuffer::Unorm16, 65_535.0), (DepthBuffer::Unorm24, 16_777_215.0)]
    {
        for i in 0..=4000 {
            let t = 2.0 + f64::from(i) / 1000.0;
            let perspective = range(true).store(t, format);
            let step = t * t * 4.0 / 12.0 / count;
            assert!((perspective - t).abs() <= 0.501 * step, "{t}: {perspective}");
            let linear = range(false).store(t, format);
            assert!((linear - t).abs() <= 0.501 * 4.0 / count, "{t}: {linear}");
        }
    }
    for format in [DepthBuffer::Unorm16, DepthBuffer::F16] {
        assert_eq!(range(true).store(f64::INFINITY, format), f64::INFINITY);
    }
    assert_eq!(range(true).store(2.000_976, DepthBuffer::F16), 2.0);
    assert_eq!(range(true).store(2.000_977, DepthBuffer::F16), 2.0 + 1.0 / 512.0);
    let ends = [1.0, 9.0].map(|t| range(true).store(t, DepthBuffer::Unorm24));
    assert_eq!(ends, [2.0, 6.0], "what lies beyond is at the end");
}

/// A stack of `count` discs, closer than epsilon, seen from the front.
fn stack(count: usize, color: f32) -> Scene {
    let cloud = Cloud {
        position: (0..count).map(|i| Vec3::Z * (i as f32 * 1e-5)).collect(),
        normal: Some(vec![Vec3::Z; count]),
        radius: Some(vec![1.0; count]),
        color: Some(vec![Vec3::splat(color); count]),
        ..Cloud::default()
    };
    Scene::unlit("stack", Surfels::new(cloud).unwrap().0)
}

fn front() -> Camera {
    let pose = Pose { eye: DVec3::Z * 4.0, target: DVec3::ZERO, up: DVec3::Y };
    Camera::new(17, 17, pose, Lens::Orthographic(1.0)).unwrap()
}

fn sums(scene: &Scene, formats: Formats) -> Frame<f32> {
    let exec = Exec::new(2, 8).unwrap();
    let mut session = Session::new(scene, ewa::Settings::default().into(), &exec).unwrap();
    session.emulate(&front(), formats, true).unwrap().frame
}

fn formats(buffers: Buffers) -> Formats {
    Formats { buffers, ..Formats::default() }
}

/// Additions one by one, by a table of all half floats: the sum sticks where half a step is more
/// than a weight.
#[test]
fn sums_are_rounded_after_every_addition() {
    let count = 3000;
    let scene = stack(count, 0.7);
    // All discs have the same weight, because the camera is orthographic.
    let one = sums(&stack(1, 0.7), Formats::default());
    let weight = f64::from(*one.scalar("attributes.weight").unwrap().at(8, 8));
    let halves: Vec<f64> = (0..=0x7bff).map(decoded).collect();
    let nearest = |v: f64| {
        let at = halves.partition_point(|half| *half < v);
        let [low, high] = [halves[at.saturating_sub(1)], halves[at]];
        let [down, up] = [v - low, high - v];
        let even = if at % 2 == 0 { high } else { low };
        if down < up {
            low
        } else if up < down {
            high
        } else {
            even
        }
    };
    let expected = (0..count).fold(0.0, |sum, _| nearest(sum + weight));
    let half = sums(&scene, formats(Buffers::F16));
    assert_eq!(f64::from(*half.scalar("attributes.weight").unwrap().at(8, 8)), expected);
    assert!(expected < 0.75 * count as f64, "from 2048 on a step is 2: {expected}");
    let eight = sums(&scene, formats(Buffers::Unorm8));
    assert_eq!(*eight.scalar("attributes.weight").unwrap().at(8, 8), 1.0);
    assert_eq!(*eight.color("attributes").unwrap().at(8, 8), [1.0; 3], "colours saturate too");
}

/// Sheets of one disc each, apart by more than epsilon, peeled: every layer as the page says, in 8
/// bits.
#[test]
fn layers_are_rounded_one_under_the_other() {
    let (count, own, opacity) = (6, 0.7, 0.3);
    let cloud = stack(count, own).surfels.into_cloud();
    let position = (0..count).map(|i| Vec3::Z * (i as f32 * 0.1)).collect();
    let cloud = Cloud { position, opacity: Some(vec![opacity; count]), ..cloud };
    let scene = Scene::unlit("sheets", Surfels::new(cloud).unwrap().0);
    let splats =
        ewa::Settings { epsilon: Epsilon::World(0.01), cull: false, ..ewa::Settings::default() };
    let method = peeling::Settings { splats, layers: 64 }.into();
    let exec = Exec::new(2, 8).unwrap();
    let mut session = Session::new(&scene, method, &exec).unwrap();
    let stored = session.emulate(&front(), formats(Buffers::Unorm8), true).unwrap().frame;
    let eight = |v: f64| (255.0 * v + 0.5).floor() / 255.0;
    let one = sums(&stack(1, 0.7), Formats::default());
    let weight = f64::from(*one.scalar("attributes.weight").unwrap().at(8, 8));
    let part = |of: f32| eight(eight(weight * f64::from(of)) / eight(weight));
    let (color, alpha) = (part(own), part(opacity));
    let (mut c, mut a, mut through) = (0.0, 0.0, 1.0);
    for layer in 1..=count {
        let name = format!("layer{layer}");
        let near = |found: f32, wanted: f64| (f64::from(found) - wanted).abs() < 1e-6;
        assert!(near(stored.color(&name).unwrap().at(8, 8)[0], color), "{name}");
        assert!(near(*stored.scalar(&format!("{name}.A")).unwrap().at(8, 8), alpha), "{name}");
        let factor = through * alpha;
        (c, a) = (eight(c + factor * color), eight(a + factor));
        through = eight(through * (1.0 - alpha));
    }
    let seen = [stored.color("").unwrap().at(8, 8)[0], *stored.scalar("A").unwrap().at(8, 8)];
    assert!((f64::from(seen[0]) - c).abs() < 1e-6, "{seen:?}: {c}");
    assert!((f64::from(seen[1]) - a).abs() < 1e-6, "{seen:?}: {a}");
    let whole = session.define::<f32>(&front(), false).unwrap().frame;
    assert_ne!(whole.color("").unwrap().at(8, 8)[0], seen[0]);
}

/// A depth buffer coarser than epsilon can return a depth before the fragment; the fragment is then
/// left over.
#[test]
fn a_layer_may_begin_before_its_fragment() {
    let cloud = stack(1, 0.7).surfels.into_cloud();
    let cloud = Cloud { position: vec![Vec3::Z * 0.9995], opacity: Some(vec![0.5]), ..cloud };
    let scene = Scene::unlit("sheet", Surfels::new(cloud).unwrap().0);
    let splats = ewa::Settings { epsilon: Epsilon::World(1e-4), ..ewa::Settings::default() };
    let exec = Exec::new(2, 8).unwrap();
    for (depth, layers) in [(DepthBuffer::Unorm24, 1), (DepthBuffer::F16, 5)] {
        let method = peeling::Settings { splats, layers: 5 }.into();
        let mut session = Session::new(&scene, method, &exec).unwrap();
        let formats = Formats { depth, ..Formats::default() };
        let picture = session.emulate(&front(), formats, false).unwrap().frame;
        assert_eq!(*picture.count("layers").unwrap().at(8, 8), layers, "{depth:?}");
        let shown = picture.color("").unwrap().values().as_flattened();
        assert!(shown.iter().all(|value| value.is_finite()), "{depth:?}");
    }
}

/// A scene that every method draws, and a camera of this size.
fn torus([width, height]: [u32; 2]) -> (Scene, Camera) {
    let shape = Shape::Torus;
    let camera = Camera::new(width, height, shape.default_pose(), shape.default_lens()).unwrap();
    (Scene::lit("torus", shape.surfels(800, 0).unwrap()), camera)
}

/// Buffers of `f32` change nothing: the stages one by one give the definition, for every method.
#[test]
fn stored_as_they_are_pictures_are_the_definition() {
    let exec = Exec::new(2, 16).unwrap();
    let (scene, camera) = torus([48, 40]);
    for method in Method::all() {
        let mut session = Session::new(&scene, method, &exec).unwrap();
        let whole = session.define::<f32>(&camera, false).unwrap().frame;
        let stored = session.emulate(&camera, Formats::default(), false).unwrap().frame;
        assert_eq!(stored.planes, whole.planes, "{}", method.name());
    }
}

/// Every number of every plane is one that its buffer can store.
#[test]
fn every_plane_holds_what_its_buffer_can() {
    let exec = Exec::new(2, 16).unwrap();
    let (scene, camera) = torus([48, 40]);
    let formats = Formats { buffers: Buffers::F16, depth: DepthBuffer::Unorm16 };
    for method in Method::all() {
        let mut session = Session::new(&scene, method, &exec).unwrap();
        let plain = session.define::<f32>(&camera, true).unwrap().frame;
        let picture = session.emulate(&camera, formats, true).unwrap().frame;
        assert_ne!(picture.color("").unwrap(), plain.color("").unwrap(), "{}", method.name());
        for NamedPlane { name, samples } in &picture.planes {
            let values: &[f32] = match samples {
                _ if ["Z", "margin"].contains(&name.as_str()) => continue,
                Samples::Scalar(_)
                    if name.ends_with(".Z")
                        || name.starts_with("Z.")
                        || name.ends_with("voronoi") =>
                {
                    continue;
                }
                Samples::Scalar(plane) => plane.values(),
                Samples::Color(plane) | Samples::Vector(plane) => plane.values().as_flattened(),
                Samples::Index(_) | Samples::Count(_) => continue,
            };
            let other = values.iter().find(|v| half(f64::from(**v)) != f64::from(**v));
            assert_eq!(other, None, "{} {name}", method.name());
        }
    }
}

/// Every stage, run on the stored planes with all of its levels at once, leaves the stored planes.
/// So no stage and no level was made from numbers that no buffer held.
#[test]
fn what_is_stored_was_made_of_what_is_stored() {
    let exec = Exec::new(2, 16).unwrap();
    let formats = Formats { buffers: Buffers::F16, depth: DepthBuffer::Unorm16 };
    let one_by_one = |method: &Method| !matches!(method, Method::Peeling(_));
    let sizes = [[1, 1], [48, 40], [67, 131]];
    for (scene, camera) in sizes.map(torus) {
        for method in Method::all().into_iter().filter(one_by_one) {
            let mut session = Session::new(&scene, method, &exec).unwrap();
            let mut frame = session.emulate(&camera, formats, true).unwrap().frame;
            session.resume(None);
            let (job, range) = session.storing(&camera, formats).unwrap();
            for stage in method.stages().iter().filter(|stage| !stage.leaves.is_empty()) {
                let mut left = method.stage(&job, stage.name, &frame).unwrap();
                formats.store(stage, &mut left, &range);
                for plane in left.planes {
                    let stored = frame.plane(&plane.name);
                    assert!(stored == Some(&plane.samples), "{} {}", method.name(), plane.name);
                }
            }
            frame.planes.retain(|plane| session.is_shown(plane));
            let shown = session.emulate_planes(&camera, formats).unwrap();
            let sorted = |mut frame: Frame<f32>| {
                frame.planes.sort_by(|a, b| a.name.cmp(&b.name));
                frame
            };
            assert_eq!(sorted(frame), sorted(shown), "{}", method.name());
        }
    }
}

proptest! {
    /// Rounding never swaps two numbers, and never gives a value that a plane may not hold.
    #[test]
    fn order_stays(a in any::<f32>(), b in any::<f32>()) {
        prop_assume!(!a.is_nan() && !b.is_nan());
        let (a, b) = (f64::from(a), f64::from(b));
        for buffers in [Buffers::F16, Buffers::Unorm8] {
            prop_assert!(!buffers.number(a).is_nan() && !buffers.signed(a).is_nan());
            if a <= b {
                prop_assert!(buffers.number(a) <= buffers.number(b));
                prop_assert!(buffers.signed(a) <= buffers.signed(b));
            }
        }
    }
}

#[test]
fn an_empty_plane_is_left_alone() {
    let mut plane = Frame::new(2, 1)
        .with("visibility.Z", Samples::Scalar(Plane::filled(2, 1, f32::INFINITY)))
        .unwrap();
    let stage = Method::default().stages()[1];
    let formats = Formats { buffers: Buffers::Unorm8, depth: DepthBuffer::Unorm16 };
    formats.store(&stage, &mut plane, &range(true));
    assert_eq!(plane.scalar("visibility.Z").unwrap().values(), [f32::INFINITY; 2]);
}

/// Discs of one group at these heights; the colour of each is its index.
fn discs(heights: &[f32], offsets: &[f32]) -> Scene {
    let count = heights.len();
    let place = |(z, x): (&f32, &f32)| Vec3::new(*x, 0.0, *z);
    let cloud = Cloud {
        position: heights.iter().zip(offsets).map(place).collect(),
        normal: Some(vec![Vec3::Z; count]),
        radius: Some(vec![1.0; count]),
        color: Some((0..count).map(|i| Vec3::splat(i as f32 / 16.0)).collect()),
        ..Cloud::default()
    };
    Scene::unlit("discs", Surfels::new(cloud).unwrap().0)
}

/// The disc seen in the middle, by every index plane that holds the nearest fragment.
fn winners(scene: &Scene, method: Method, depth: DepthBuffer) -> Vec<u32> {
    let exec = Exec::new(2, 8).unwrap();
    let groups = method
        .grouping()
        .map(|_| Groups::new(vec![0; scene.surfels.len()], Vec::new(), vec![1.0]).unwrap());
    let mut session = Session::with_groups(scene, method, groups, &exec).unwrap();
    let formats = Formats { depth, ..Formats::default() };
    let frame = session.emulate(&front(), formats, true).unwrap().frame;
    let nearest = |plane: &NamedPlane<f32>| match &plane.samples {
        Samples::Index(ids) if !plane.name.starts_with("level") => Some(*ids.at(8, 8)),
        _ => None,
    };
    frame.planes.iter().filter_map(nearest).filter(|id| *id != NO_ID).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// The depth buffer's whole numbers decide, and the first of equal ones wins: by the
    /// orthographic z of the page.
    #[test]
    fn fragments_that_round_to_one_depth_tie(heights in prop::collection::vec(-1e-4_f32..1e-4, 2..6)) {
        let scene = discs(&heights, &vec![0.0; heights.len()]);
        // The bounding sphere of discs around the origin has a radius of at least 1, and the eye is
        // 4 away.
        let Sphere { center, radius } = scene.bounding_sphere();
        let (near, far) = (4.0 - center.z - radius, 4.0 - center.z + radius);
        let far = if far > 2.0 * near { far } else { 2.0 * near };
        let code = |z: f32, count: f64| {
            // The depth as the program computes it, in f32: the view matrix of this camera only
            // moves.
            let t = f64::from(-(z - 4.0));
            ((t - near) / (far - near) * count + 0.5).floor()
        };
        let halves = |z: f32| half(f64::from(-(z - 4.0)));
        for (depth, key) in [
            (DepthBuffer::F32, Box::new(|z: f32| f64::from(-(z - 4.0))) as Box<dyn Fn(f32) -> f64>),
            (DepthBuffer::F16, Box::new(halves)),
            (DepthBuffer::Unorm24, Box::new(|z| code(z, 16_777_215.0))),
            (DepthBuffer::Unorm16, Box::new(|z| code(z, 65_535.0))),
        ] {
            let mut expected = 0;
            for i in 1..heights.len() {
                if key(heights[i]) < key(heights[expected]) {
                    expected = i;
                }
            }
            for name in ["ewa", "deferred", "single-pass", "pyramid", "template", "blue"] {
                let mut method = Method::by_name(name).unwrap();
                if let Method::SinglePass(settings) = &mut method {
                    settings.depth = DepthTest::Plain;
                }
                let found = winners(&scene, method, depth);
                prop_assert!(!found.is_empty());
                prop_assert!(found.iter().all(|id| *id == expected as u32), "{name} {depth:?} {found:?} {expected}");
            }
        }
    }
}

/// z / n of \[ZP06, eq. 10\]: if there are as many bins as the buffer has numbers, no number is
/// left for the ratio. The first disc of a bin then stays, although the second is seen nearer to
/// its centre.
#[test]
fn a_voronoi_depth_has_what_the_bins_leave() {
    let scene = discs(&[0.0, 0.0], &[0.4, 0.1]);
    let seen = |count, depth| {
        let bins = DepthTest::Voronoi(BinCount::Count(count));
        let method = single_pass::Settings { depth: bins, ..single_pass::Settings::default() };
        let mut found = winners(&scene, method.into(), depth);
        found.dedup();
        assert_eq!(found.len(), 1, "{found:?}");
        found[0]
    };
    for depth in [DepthBuffer::F32, DepthBuffer::Unorm24] {
        assert_eq!(seen(65_535, depth), 1, "{depth:?}");
    }
    assert_eq!(seen(65_535, DepthBuffer::Unorm16), 0);
    assert_eq!(seen(1000, DepthBuffer::Unorm16), 1, "65 numbers a bin");
}
