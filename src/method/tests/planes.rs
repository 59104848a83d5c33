//! Test that the page of planes lists exactly the planes that pictures hold.

use super::sphere_of_groups;
use crate::frame::{Exec, pyramid};
use crate::method::{Method, PlaneRow, Session, Stage, peeling, single_pass, template};
use crate::scene::indexed::Indexed;
use crate::scene::{Camera, Cloud, Light, Primitives, Scene, Surfels, Vertices};
use crate::source::Shape;
use glam::Vec3;

/// The page of planes in the documentation.
const PAGE: &str = include_str!("../planes.md");

/// The line of the page for a row.
fn line(stage: &Stage, row: &PlaneRow) -> String {
    let PlaneRow { name, unit, meaning, .. } = row;
    // Formulas become code, because an underscore outside code is markup.
    let word = |word: &str| if word.contains('_') { format!("`{word}`") } else { word.to_owned() };
    let meaning = meaning.split(' ').map(word).collect::<Vec<_>>().join(" ");
    let name = if name.is_empty() { "no name".to_owned() } else { format!("`{name}`") };
    let (holds, when) = (row.holds.words(), row.when.words());
    format!("| {} | {name} | {holds} | {unit} | {when} | {meaning} |\n", stage.name)
}

/// The page that follows from the rows of the stages.
fn page() -> String {
    let mut page = String::new();
    for method in Method::all() {
        page += &format!("\n# `{}`\n\n", method.name());
        page += "| stage | plane | values | unit | when | what |\n|---|---|---|---|---|---|\n";
        for stage in method.stages() {
            stage.leaves.iter().for_each(|row| page += &line(stage, row));
        }
    }
    page
}

#[test]
fn the_page_has_every_row() {
    let page = page();
    for (found, expected) in PAGE.lines().zip(page.lines()) {
        assert_eq!(found, expected, "src/method/planes.md must read:\n{page}");
    }
    assert_eq!(PAGE, page);
}

/// The planes of a method that the page lists, each with the column *when*.
fn listed(method: &Method) -> Vec<(&'static str, &'static str)> {
    let heading = format!("\n# `{}`\n", method.name());
    let (_, section) = PAGE.split_once(&heading).expect("a section");
    let section = section.split("\n# ").next().unwrap_or_default();
    let rows = section.lines().filter(|line| line.starts_with("| ")).skip(1);
    let row = |line: &'static str| {
        let cells: Vec<_> = line.split(" | ").collect();
        (cells[1].trim_matches('`'), cells[4])
    };
    rows.map(row).map(|(name, when)| (if name == "no name" { "" } else { name }, when)).collect()
}

/// Whether a picture has a plane, by the column *when* of the page.
fn is_there(when: &str, session: &Session<'_>, stages: bool) -> bool {
    let (scene, method) = (session.scene(), session.method());
    let tubes = !scene.primitives.tubes.is_empty();
    let colors =
        scene.surfels.color().is_some() || (method.draws_polygons() && scene.primitives.colored());
    let plain = matches!(
        method,
        Method::SinglePass(single_pass::Settings { depth: single_pass::DepthTest::Plain, .. })
    );
    match when {
        "always" => true,
        "lit" => stages || !scene.lights.is_empty(),
        "tubes" => tubes,
        "stages" | "stages, whole" => stages,
        "stages, colours" => stages && colors,
        "stages, tubes" => stages && tubes,
        "stages, setting" => stages && !plain,
        // Scenes without objects have ids of 32 bits.
        "stages, wide ids" | "alone" => false,
        other => panic!("{other}"),
    }
}

/// The numbers that the `#` of a name stands for.
fn numbers(name: &str, session: &Session<'_>, camera: &Camera) -> std::ops::Range<usize> {
    let sizes = pyramid::sizes(camera.width, camera.height);
    let (head, _) = name.split_once('#').expect("a number");
    match (head, session.method()) {
        ("pull", _) => 1..sizes.len(),
        ("push", _) => 0..sizes.len() - 1,
        ("layer", Method::Peeling(settings)) => {
            1..settings.layers.min(peeling::STAGES) as usize + 1
        }
        ("level", Method::Template(settings)) => {
            let most = settings.size.div_ceil(2);
            let small = |size: &[u32; 2]| size.iter().all(|&side| side <= most);
            1..sizes.iter().position(small).expect("one pixel is small") + 1
        }
        _ => 0..session.groups().expect("groups").len(),
    }
}

/// Asserts that a picture has the planes of the page, each once, and no others.
fn agrees(session: &Session<'_>, camera: &Camera, stages: bool, found: Vec<&str>) {
    let mut expected = Vec::new();
    for (name, when) in listed(session.method()) {
        if !is_there(when, session, stages) {
            continue;
        }
        if name.contains('#') {
            let (head, tail) = name.split_once('#').expect("a number");
            let digits = 1 + tail.bytes().take_while(|&c| c == b'#').count();
            let tail = tail.trim_start_matches('#');
            let numbers = numbers(name, session, camera);
            expected.extend(numbers.map(|number| format!("{head}{number:0digits$}{tail}")));
        } else {
            expected.push(name.to_owned());
        }
    }
    let mut found = found;
    found.sort_unstable();
    expected.sort_unstable();
    let size = camera.size();
    assert_eq!(found, expected, "{:?}, stages {stages}, {size:?}", session.method());
}

/// Spheres with and without colours and light, some with tubes, ribbons and an environment.
fn scenes() -> Vec<Scene> {
    let (sphere, _) = sphere_of_groups();
    let surfels = Shape::Sphere.surfels(60, 3).unwrap();
    let plain = Cloud { color: None, ..surfels.clone().into_cloud() };
    let plain = Surfels::new(plain).unwrap().0;
    let line = |color: Option<Vec3>| {
        let vertices = Vertices {
            position: vec![Vec3::ZERO, Vec3::Y * 2.0],
            direction: vec![Vec3::Z; 2],
            radius: vec![0.125; 2],
            color: color.map(|color| vec![color; 2]),
            ..Vertices::default()
        };
        Indexed::new(vertices, vec![[0, 1]]).unwrap().0
    };
    let ribbon = Primitives { ribbons: line(Some(Vec3::X)), ..Primitives::default() };
    let tube = Primitives { tubes: line(None), ..Primitives::default() };
    let mut lit = Scene::unlit("lit, plain", plain.clone());
    lit.lights.push(Light::DEFAULT);
    let unlit = Scene::unlit("coloured", surfels);
    let dark = Scene::unlit("plain", plain.clone());
    let with = |scene: &Scene, primitives| Scene { primitives, ..scene.clone() };
    let (ribbons, tubes) = (with(&dark, ribbon.clone()), with(&lit, tube.clone()));
    let both = Primitives { tubes: tube.tubes, ..ribbon };
    vec![sphere, with(&unlit, both), lit, unlit, dark, ribbons, tubes]
}

#[test]
fn pictures_have_the_planes_of_the_page() {
    let exec = Exec::sequential();
    let plain =
        single_pass::Settings { depth: single_pass::DepthTest::Plain, ..Default::default() };
    let few = peeling::Settings { layers: 3, ..Default::default() };
    let three = template::Settings { size: 3, ..Default::default() };
    let mut methods = Method::all();
    methods.extend([Method::from(plain), few.into(), three.into()]);
    for method in methods {
        for scene in scenes().iter().filter(|scene| method.check_scene(scene).is_ok()) {
            let mut session = Session::new(scene, method, &exec).unwrap();
            for size in [[13, 9], [1, 1]] {
                let (pose, lens) = (Shape::Sphere.default_pose(), Shape::Sphere.default_lens());
                let camera = Camera::new(size[0], size[1], pose, lens).unwrap();
                for stages in [false, true] {
                    let picture = session.define::<f64>(&camera, stages).unwrap();
                    let names = picture.frame.planes.iter().map(|plane| plane.name.as_str());
                    agrees(&session, &camera, stages, names.collect());
                }
                session.resume(None);
                let picture = session.render(&camera).unwrap().clone();
                let names = picture.frame.planes.iter().map(|plane| plane.name.as_str());
                agrees(&session, &camera, false, names.collect());
            }
        }
    }
}
