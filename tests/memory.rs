//! Measures the peak memory of a render from outside the allocator.
//!
//! Each method gets a process of its own, because memory that was freed hides later requests. It
//! measures the memory that is requested before a picture is made.
//!
//! The budget: 100 bytes a surfel and 64 bytes a pixel beyond the scene. The images of the single
//! pass have to fit into it too, and they would not fit as a whole.

#![cfg(target_os = "linux")]

use glam::{DVec3, Vec3};
use splatref::frame::{Exec, Samples};
use splatref::index::grouping::{Extension, Grouping, Rules};
use splatref::memory::set_limit;
use splatref::method::gaussians;
use splatref::method::session::Making;
use splatref::method::single_pass::{self, DepthTest};
use splatref::method::{Method, Session};
use splatref::number::random::unit;
use splatref::scene::gaussians::{Encoding, GaussianArrays, Gaussians};
use splatref::scene::{Camera, Cloud, Geometry, Groups, Lens, Motion, Object, Objects, Pose};
use splatref::scene::{Primitives, Scene, Similarity, Surfels};
use splatref::setting::Fields;
use splatref::source::Shape;
use splatref::source::sampler::{Greedy, Progressive, Schedule, Start, shuffled};
use splatref::splat::SplatSettings;
use splatref::verdict::client::Client;

/// A line of /proc/self/status, in bytes.
fn status(key: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kb| kb * 1024)
}

#[test]
fn a_render_stays_within_its_budget() {
    const SURFELS: usize = 2_000_000;
    const SIDE: u32 = 2048;
    const GROUPS: usize = 16;
    // Nothing is culled and everything is in sight: the worst case for the records of splats.
    let surfels = Shape::Sphere.surfels(SURFELS, 0).expect("a sphere");
    let scene = Scene::lit("sphere", surfels);
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(SIDE, SIDE, pose, Lens::Focal(3000.0)).expect("a camera");
    let splats = SplatSettings { cull: false, ..SplatSettings::default() };
    let exec = Exec::new(2, 32).expect("threads");
    // Neighbours are in different groups, so that every block of every image is touched.
    let own = (0..SURFELS).map(|i| (i % GROUPS) as u8).collect();
    let groups = Groups::new(own, Vec::new(), vec![1.0; GROUPS]).expect("groups");
    let single_pass = single_pass::Settings { splats, depth: DepthTest::Plain };
    let budget = 100 * SURFELS as u64 + 64 * u64::from(SIDE) * u64::from(SIDE);
    let methods: [(Method, _); 2] = [(splats.into(), None), (single_pass.into(), Some(groups))];
    for (method, groups) in methods {
        let name = method.name();
        let before = status("VmRSS").expect("a resident size");
        let mut session = Session::with_groups(&scene, method, groups, &exec).expect("a session");
        // Writing 5 resets the peak of the process to what it holds now.
        if std::fs::write("/proc/self/clear_refs", "5").is_err() {
            println!("skipped: this kernel does not let the peak be reset");
            return;
        }
        let tally = session.render(&camera).expect("renders").tally;
        let peak = status("VmHWM").expect("a peak").saturating_sub(before);
        assert_eq!(tally.visible, SURFELS as u64);
        println!("{name}: peak {peak} bytes of {budget}");
        assert!(peak <= budget, "{name}: peak {peak} bytes, budget {budget}");
        // The least that it can be: the planes themselves. A smaller figure measures nothing.
        assert!(peak >= 36 * u64::from(SIDE) * u64::from(SIDE), "{name}: peak {peak} bytes");
    }
}

/// How pictures are made.
const MAKINGS: [Making; 4] = [
    Making::Render,
    Making::Define { number: 4, stages: false },
    Making::Define { number: 4, stages: true },
    Making::Define { number: 8, stages: true },
];

/// A method that draws the backs of surfels, too: nothing is culled.
fn of_both_sides(method: &Method) -> Method {
    let mut all = *method;
    if let Some(Ok(off)) = method.read("cull", "off") {
        all.set("cull", &off).expect("a setting of the method");
    }
    all
}

/// What a picture is said to take, and what it takes in this process, which has drawn no other.
fn said_and_taken(
    (method, making, count, [width, height]): (Method, Making, usize, [u32; 2]),
) -> (u64, u64) {
    let surfels = Shape::Torus.surfels(count, 0).expect("a torus");
    let scene = Scene::lit("torus", surfels);
    let pose = Shape::Torus.default_pose();
    let camera = Camera::new(width, height, pose, Shape::Torus.default_lens()).expect("a camera");
    let exec = Exec::new(2, 32).expect("threads");
    let mut session = Session::new(&scene, method, &exec).expect("a session");
    let said = session.needs(&camera, making);
    if making == Making::Verdict {
        return (said, taken_by_a_verdict(&mut session, &camera));
    }
    let before = before_a_picture();
    let pixels = match making {
        Making::Render => session.render(&camera).expect("renders").frame.width,
        Making::Define { number: 4, stages } => {
            session.define::<f32>(&camera, stages).expect("renders").frame.width
        }
        Making::Verdict => unreachable!("measured above"),
        Making::Define { stages, .. } => {
            session.define::<f64>(&camera, stages).expect("renders").frame.to_f32().width
        }
    };
    assert_eq!(pixels, width);
    (said, status("VmHWM").expect("a peak") - before)
}

/// What the process holds before it makes a picture. What it held while the session was made counts no more.
fn before_a_picture() -> u64 {
    // Writing 5 resets the peak of the process to what it holds now.
    let reset = std::fs::write("/proc/self/clear_refs", "5").is_ok();
    status(if reset { "VmRSS" } else { "VmHWM" }).expect("a size")
}

/// What a verdict takes of planes in which every pixel is wrong, the planes included; drawing them, but
/// for their count, takes less.
fn taken_by_a_verdict(session: &mut Session<'_>, camera: &Camera) -> u64 {
    let mut frame = session.define::<f32>(camera, true).expect("renders").frame;
    for plane in &mut frame.planes {
        match &mut plane.samples {
            Samples::Scalar(plane) => plane.values_mut().fill(f32::NAN),
            Samples::Color(plane) | Samples::Vector(plane) => {
                plane.values_mut().fill([f32::NAN; 3]);
            }
            Samples::Index(_) | Samples::Count(_) => {}
        }
    }
    let before = before_a_picture();
    let client = Client::from(&frame);
    let verdict = session.verify(camera, &client, 1.0).expect("a verdict");
    let pixels = u64::from(camera.width) * u64::from(camera.height);
    assert_eq!(verdict.stages.iter().map(|stage| stage.wrong).max(), Some(pixels));
    status("VmHWM").expect("a peak") - before
}

/// Two numbers that a test prints in a process of its own, in which a variable is set.
fn in_a_process(test: &str, (name, value): (&str, &str)) -> [u64; 2] {
    let this = std::env::current_exe().expect("this program");
    let output = std::process::Command::new(this)
        .args(["--exact", test, "--nocapture"])
        .env(name, value)
        .output()
        .expect("this program");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = said.lines().find_map(|line| line.strip_prefix("memory "));
    let numbers = line.unwrap_or_else(|| panic!("{said}")).split_once(' ').expect("two");
    [numbers.0, numbers.1].map(|n| n.parse::<u64>().expect("a number"))
}

/// The forest of [GBP04]: 6,800 objects of a geometry of 750,000 surfels with levels of detail. What the
/// scene takes, and what three frames take beyond it.
fn forest() -> [u64; 2] {
    let exec = Exec::new(2, 32).expect("threads");
    let before = status("VmRSS").expect("a size");
    let surfels = Shape::Torus.surfels(750_000, 0).expect("a torus");
    let primitives = Primitives::default();
    let geometry = Geometry { name: "tree".into(), surfels, primitives, detail: None };
    let geometry = geometry.with_detail(1.0, &exec).expect("levels of detail");
    let object = |i: u32| {
        let translation =
            DVec3::new(f64::from(i % 80) * 3.0 - 120.0, 0.0, f64::from(i / 80) * -3.0);
        let place = Similarity { translation, ..Similarity::IDENTITY };
        Object { name: format!("{i}"), geometry: 0, motion: Motion::still(place), color: None }
    };
    let objects = Objects::new(vec![geometry], (0..6800).map(object).collect(), Vec3::ONE);
    let objects = objects.expect("objects");
    let scene = status("VmRSS").expect("a size") - before;
    if std::fs::write("/proc/self/clear_refs", "5").is_err() {
        println!("skipped: this kernel does not let the peak be reset");
        return [scene, 0];
    }
    let before = status("VmRSS").expect("a size");
    let mut seen = None;
    for frame in 0..3_u32 {
        let eye = DVec3::new(0.0, 5.0, 8.0);
        let target = eye + DVec3::new(0.1 * f64::from(frame), -0.1, -1.0);
        let pose = Pose { eye, target, up: DVec3::Y };
        let camera = Camera::new(512, 512, pose, Lens::FieldOfView(34.0)).expect("a camera");
        let objects = Some(objects.seen_from(&camera, &exec).expect("a view"));
        let scene = Scene { objects, ..Scene::lit("forest", Surfels::none()) };
        let method = Method::by_name("deferred").expect("a method");
        let mut session = Session::new(&scene, method, &exec).expect("a session");
        session.resume(seen);
        let picture = session.render(&camera).expect("renders");
        assert!(picture.tally.visible > 10_000);
        seen = picture.seen.clone();
    }
    [scene, status("VmHWM").expect("a peak") - before]
}

/// A geometry is there once: 100 bytes a node, and 1 KiB an object. A frame takes what it draws.
#[test]
fn a_forest_has_one_tree() {
    const FOREST: &str = "SPLATREF_MEMORY_FOREST";
    if std::env::var(FOREST).is_ok() {
        let [scene, frames] = forest();
        println!("\nmemory {scene} {frames}");
        return;
    }
    let [scene, frames] = in_a_process("a_forest_has_one_tree", (FOREST, "1"));
    println!("a forest: {scene} bytes, and {frames} for its frames");
    // 4/3 nodes a surfel and some.
    let budget = 100 * 1_100_000 + 1024 * 6800;
    assert!(scene < budget, "{scene} bytes of {budget}");
    // Placed one by one its surfels would take 6800 times as much: 28 bytes each.
    assert!(scene > 28 * 750_000, "{scene} bytes");
    assert!(frames < 200 << 20, "{frames} bytes");
}

/// Points, and what each takes at most, as the samplers ask before they begin.
const ORDERS: [(&str, u64); 4] =
    [("greedy", 80), ("progressive", 112), ("as shipped", 112), ("shuffled", 112)];
/// Just beyond a power of 2, where arrays that grow have twice the room they need.
const POINTS: usize = (1 << 20) + 9;

fn taken_by_an_order(case: usize) -> u64 {
    let points = Shape::Torus.surfels(POINTS, 0).expect("a torus").position().to_vec();
    let (exec, start) = (Exec::new(2, 32).expect("threads"), Start::Index(3));
    let quiet = |_: &str, _, _| ();
    std::fs::write("/proc/self/clear_refs", "5").ok();
    let before = status("VmRSS").expect("a size");
    let progressive =
        |schedule| Progressive { start, seed: 0, schedule }.order(&points, POINTS, &quiet);
    let order = match case {
        0 => Greedy { start }.order(&points, POINTS, &exec, &quiet),
        1 => progressive(Schedule::Paper),
        2 => progressive(Schedule::AsShipped),
        _ => shuffled(&points, 0, POINTS, &|_, _, _| ()),
    };
    assert!(order.expect("an order").index.len() > POINTS / 2);
    status("VmHWM").expect("a peak") - before
}

/// As a picture: what an order is said to take is about what it takes.
#[test]
fn an_order_takes_what_it_is_said_to() {
    const ORDER: &str = "SPLATREF_MEMORY_ORDER";
    if let Some(case) = std::env::var(ORDER).ok().and_then(|case| case.parse::<usize>().ok()) {
        println!("\nmemory 0 {}", taken_by_an_order(case));
        return;
    }
    for (case, (name, bytes)) in ORDERS.into_iter().enumerate() {
        let test = "an_order_takes_what_it_is_said_to";
        let [_, taken] = in_a_process(test, (ORDER, &case.to_string()));
        let ratio = (bytes * POINTS as u64) as f64 / taken as f64;
        println!("{name}: {} for {taken}, {ratio:.2}", bytes * POINTS as u64);
        assert!((1.0..6.0).contains(&ratio), "{name}: {ratio}");
    }
}

const GROUPED_SURFELS: usize = 300_000;
/// Groups: how many pairs a surfel, how many groups, how they are extended.
const GROUPED: [(f32, usize, Extension); 5] = [
    (6.0, 4, Extension::None),
    (6.0, 4, Extension::Add { most: 0.5 }),
    (62.0, 64, Extension::None),
    (62.0, 20, Extension::Add { most: 0.5 }),
    (62.0, 64, Extension::Enlarge),
];

/// How many surfels are added to groups of random surfels of a square, of which the first `heap` stand at
/// one place; and what the groups take.
fn added_and_taken((pairs, count, extension): (f32, usize, Extension), heap: usize) -> [u64; 2] {
    let radius = (2.0 * pairs / (4.0 * std::f32::consts::PI * GROUPED_SURFELS as f32)).sqrt();
    let at = |i| match i {
        _ if i < heap => Vec3::splat(2.0),
        i => Vec3::new(unit(1, 2 * i as u64), unit(1, 2 * i as u64 + 1), 0.0),
    };
    let (surfels, _) = Surfels::new(Cloud {
        position: (0..GROUPED_SURFELS).map(at).collect(),
        normal: Some(vec![Vec3::Z; GROUPED_SURFELS]),
        radius: Some(vec![radius; GROUPED_SURFELS]),
        ..Cloud::default()
    })
    .expect("surfels");
    let exec = Exec::new(2, 32).expect("threads");
    let grouping = Grouping { rules: Rules::default(), count: Some(count), extension };
    std::fs::write("/proc/self/clear_refs", "5").ok();
    let before = status("VmRSS").expect("a size");
    let (groups, _, extended) = grouping.groups(&surfels, &exec, &|_, _, _| ()).expect("groups");
    assert!(groups.len() <= count && groups.len() > 2, "{}", groups.len());
    let added = extended.map_or(0, |extended| extended.added);
    [added, status("VmHWM").expect("a peak") - before]
}

/// A heap makes many groups, to each of which surfels are added that overlap no other: 8 bytes each time.
#[test]
fn what_is_added_to_groups_takes_what_it_is_said_to() {
    const HEAP: &str = "SPLATREF_MEMORY_HEAP";
    let case = (0.5, 64, Extension::Add { most: 0.5 });
    if std::env::var(HEAP).is_ok() {
        let [added, taken] = added_and_taken(case, 60);
        println!("\nmemory {added} {taken}");
        return;
    }
    let test = "what_is_added_to_groups_takes_what_it_is_said_to";
    let [added, taken] = in_a_process(test, (HEAP, "1"));
    assert!(added > 40 * GROUPED_SURFELS as u64, "{added}");
    let said = (272 + 9) * GROUPED_SURFELS as u64 + 8 * added;
    let ratio = said as f64 / taken as f64;
    println!("{added} added: {said} for {taken}, {ratio:.2}");
    assert!((1.0..6.0).contains(&ratio), "{ratio}");
}

/// As a picture: of groups, 272 bytes a surfel and 9 a neighbour are asked for.
#[test]
fn groups_take_what_they_are_said_to() {
    const CASE: &str = "SPLATREF_MEMORY_GROUPS";
    if let Some(case) = std::env::var(CASE).ok().and_then(|case| case.parse::<usize>().ok()) {
        println!("\nmemory 0 {}", added_and_taken(GROUPED[case], 0)[1]);
        return;
    }
    for (case, (pairs, ..)) in GROUPED.into_iter().enumerate() {
        let test = "groups_take_what_they_are_said_to";
        let [_, taken] = in_a_process(test, (CASE, &case.to_string()));
        let said = (272.0 + 9.0 * 2.0 * f64::from(pairs)) * GROUPED_SURFELS as f64;
        let ratio = said / taken as f64;
        println!("{:?}: {said} for {taken}, {ratio:.2}", GROUPED[case]);
        assert!((1.0..6.0).contains(&ratio), "{:?}: {ratio}", GROUPED[case]);
    }
}

/// What a picture is said to take is about what it takes: not less, and not six times as much.
#[test]
fn a_picture_takes_what_it_is_said_to() {
    const CASE: &str = "SPLATREF_MEMORY_CASE";
    let all = Method::all();
    let large = |method: &Method| MAKINGS.map(|making| (*method, making, 20_000, [1000, 750]));
    // Where surfels count, and not pixels: what the margin needs of each.
    let ewa = SplatSettings { cull: false, ..SplatSettings::default() }.into();
    let many = (ewa, Making::Define { number: 4, stages: true }, 1_000_000, [300, 200]);
    // What a picture needs of each; memory that groups have freed would hide it.
    let ungrouped = all.iter().filter(|method| method.grouping().is_none());
    let crowded = |method: &Method| (of_both_sides(method), Making::Render, POINTS, [300, 200]);
    // What a verdict needs of each.
    let judged = (ewa, Making::Verdict, 1_000_000, [300, 200]);
    // What it needs of each surfel of a scene of which few are drawn.
    let placed = Method::by_name("deferred").expect("a method");
    let placed = (placed, Making::Verdict, 1_000_000, [300, 200]);
    let wrong = |method: &Method| (*method, Making::Verdict, 20_000, [700, 500]);
    let verdicts = all.iter().map(wrong).chain([judged, placed]);
    let cases =
        all.iter().flat_map(large).chain([many]).chain(verdicts).chain(ungrouped.map(crowded));
    if let Some(case) = std::env::var(CASE).ok().and_then(|case| case.parse::<usize>().ok()) {
        let (said, taken) = said_and_taken(cases.clone().nth(case).expect("a case"));
        println!("\nmemory {said} {taken}");
        return;
    }
    for (case, (method, making, ..)) in cases.enumerate() {
        let test = "a_picture_takes_what_it_is_said_to";
        let [said, taken] = in_a_process(test, (CASE, &case.to_string()));
        let ratio = said as f64 / taken as f64;
        println!("{}, {making:?}: {said} for {taken}, {ratio:.2}", method.name());
        assert!((1.0..6.0).contains(&ratio), "{}, {making:?}: {said} for {taken}", method.name());
    }
}

/// Splats that all lie in the two tiles of a small picture, whose pixels sort them by themselves. The
/// least memory with which they are drawn, and what they take.
fn allowed_and_taken() -> [u64; 2] {
    const SPLATS: usize = 20_000;
    let at = |i: usize| [0, 1, 2].map(|k| 0.2 * unit(3, (3 * i + k) as u64) - 0.1);
    let arrays = GaussianArrays {
        position: (0..SPLATS).map(|i| Vec3::from_array(at(i))).collect(),
        scale: vec![Vec3::splat(1.0); SPLATS],
        rotation: vec![[0.0, 0.0, 0.0, 1.0]; SPLATS],
        opacity: vec![0.005; SPLATS],
        degree: 0,
        harmonics: vec![Vec3::ZERO; SPLATS],
        encoding: Encoding::Srgb,
    };
    let scene = Scene::of_gaussians("heap", Gaussians::new(arrays).expect("splats").0);
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(64, 32, pose, Lens::FieldOfView(10.0)).expect("a camera");
    let settings =
        gaussians::Settings { order: gaussians::Order::Pixel, ..gaussians::Settings::default() };
    let exec = Exec::new(2, 32).expect("threads");
    let mut session = Session::new(&scene, settings.into(), &exec).expect("a session");
    let [before, held] = ["VmHWM", "VmRSS"].map(|key| status(key).expect("a size"));
    let mut allowed = session.needs(&camera, Making::Render) / 2;
    loop {
        set_limit(held + allowed);
        if session.render(&camera).is_ok() {
            return [allowed, status("VmHWM").expect("a peak") - before];
        }
        allowed += allowed / 16;
    }
}

/// As a picture: lists of fragments that each pixel sorts by itself are asked for.
#[test]
fn lists_of_fragments_take_what_they_are_said_to() {
    const LISTS: &str = "SPLATREF_MEMORY_LISTS";
    if std::env::var(LISTS).is_ok() {
        let [allowed, taken] = allowed_and_taken();
        println!("\nmemory {allowed} {taken}");
        return;
    }
    let test = "lists_of_fragments_take_what_they_are_said_to";
    let [allowed, taken] = in_a_process(test, (LISTS, "1"));
    let ratio = allowed as f64 / taken as f64;
    println!("lists: {allowed} for {taken}, {ratio:.2}");
    assert!((1.0..6.0).contains(&ratio), "{allowed} for {taken}");
}
