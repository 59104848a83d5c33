//! No verdict passes a value that it did not judge. From the crate's own planes one plane is left
//! out, and another holds garbage: either the garbage is wrong, or the verdict lists its plane as not
//! judged and is not "right".

use glam::Vec3;
use splatref::frame::{Exec, Frame, NamedPlane, Samples};
use splatref::method::{Holds, Method, Session};
use splatref::number::random::unit;
use splatref::scene::gaussians::{Encoding, GaussianArrays, Gaussians};
use splatref::scene::{Camera, Groups, Scene};
use splatref::source::Shape;
use splatref::verdict::client::Client;
use splatref::verdict::{Outcome, Verdict};

/// Whether a list of planes, levels, layers or groups has this plane of a stage.
fn has(list: &[String], plane: &str) -> bool {
    let digits: String = plane.chars().filter(char::is_ascii_digit).collect();
    let number = digits.parse::<u32>().ok();
    let shown = if plane.is_empty() { "RGB" } else { plane };
    list.iter().any(|item| match item.split_once(' ') {
        Some((_, own)) => number == own.parse().ok(),
        None => item == shown,
    })
}

/// A frame without a plane.
fn without(frame: &Frame<f32>, name: &str) -> Frame<f32> {
    let planes = frame.planes.iter().filter(|plane| plane.name != name).cloned().collect();
    Frame { planes, ..*frame }
}

/// Values that no renderer leaves.
fn garbage(plane: &mut NamedPlane<f32>) {
    match &mut plane.samples {
        Samples::Scalar(p) => p.values_mut().fill(12_345.69),
        Samples::Color(p) | Samples::Vector(p) => p.values_mut().fill([12_345.69; 3]),
        Samples::Index(p) => p.values_mut().fill(7_777_777),
        Samples::Count(p) => p.values_mut().fill(201),
    }
}

/// The values of other pixels.
fn moved(plane: &mut NamedPlane<f32>) {
    match &mut plane.samples {
        Samples::Scalar(p) => p.values_mut().rotate_right(3),
        Samples::Color(p) | Samples::Vector(p) => p.values_mut().rotate_right(3),
        Samples::Index(p) => p.values_mut().rotate_right(3),
        Samples::Count(p) => p.values_mut().rotate_right(3),
    }
}

struct Tried<'a> {
    session: Session<'a>,
    camera: Camera,
}

impl Tried<'_> {
    fn verdict(&self, frame: &Frame<f32>) -> Verdict {
        self.session.verify(&self.camera, &Client::from(frame), Verdict::BUDGET).unwrap()
    }

    /// The name of the stage that leaves a plane, unless no renderer has this plane.
    fn stage(&self, plane: &str) -> Option<&'static str> {
        let stages = self.session.method().stages();
        let found = stages.iter().find_map(|stage| Some((stage.name, stage.row(plane)?)));
        let (stage, row) = found.unwrap();
        (row.holds != Holds::Diagnostic).then_some(stage)
    }

    /// The verdict on a frame lists a plane that was left out, unless it lacks the whole stage.
    fn lists(&self, frame: &Frame<f32>, name: &str) {
        let Some(stage) = self.stage(name) else { return };
        let verdict = self.verdict(frame);
        let at = || format!("{} without `{name}`", self.session.method().name());
        assert!(verdict.first_wrong().is_none(), "{}", at());
        let found = verdict.stages.iter().find(|own| own.stage == stage).unwrap();
        let alone = !frame.planes.iter().any(|plane| self.stage(&plane.name) == Some(stage));
        assert!(alone || has(&found.missing, name), "{}: {:?}", at(), found.missing);
    }

    /// Wrong values in one plane of a frame are wrong, or the plane is listed as not judged.
    fn finds(&self, frame: &Frame<f32>, what: &str) -> Vec<String> {
        let mut silent = Vec::new();
        let before = self.verdict(frame);
        for (index, plane) in frame.planes.iter().enumerate() {
            let Some(stage) = self.stage(&plane.name) else { continue };
            let found = before.stages.iter().find(|own| own.stage == stage).unwrap();
            let judged = !has(&found.unjudged, &plane.name);
            for spoil in [garbage, moved] {
                let mut other = frame.clone();
                spoil(&mut other.planes[index]);
                if format!("{:?}", other.planes[index]) == format!("{plane:?}") {
                    continue;
                }
                let after = self.verdict(&other).outcome();
                // Without bounds nothing is proved, but nothing is passed either.
                let open = !judged || before.unbounded > 0;
                if !(after == Outcome::Wrong || (open && after == Outcome::Undecidable)) {
                    silent.push(format!("{what}: `{}` is {after:?}", plane.name));
                }
            }
        }
        silent
    }
}

/// Whether pictures without this plane are tried with garbage: of the numbered ones, only number 1.
fn is_tried(name: &str) -> bool {
    let digits: String = name.chars().filter(char::is_ascii_digit).collect();
    digits.parse().unwrap_or(1) == 1
}

fn try_method(method: Method, scene: &Scene) {
    let exec = Exec::sequential();
    let shape = Shape::Cluster;
    let camera = Camera::new(9, 7, shape.default_pose(), shape.default_lens()).unwrap();
    let groups = (0..scene.surfels.len()).map(|i| (i % 3) as u8).collect();
    let groups = Groups::new(groups, Vec::new(), vec![1.0; 3]).unwrap();
    let session = Session::with_groups(scene, method, Some(groups), &exec).unwrap();
    let whole = session.define::<f32>(&camera, true).unwrap().frame;
    let tried = Tried { session, camera };
    let verdict = tried.verdict(&whole);
    assert_eq!(verdict.outcome(), Outcome::Right, "{}", method.name());
    assert!(verdict.stages.iter().all(|stage| stage.missing.is_empty()), "{}", method.name());
    let mut silent = tried.finds(&whole, "all planes");
    for plane in &whole.planes {
        let rest = without(&whole, &plane.name);
        tried.lists(&rest, &plane.name);
        if is_tried(&plane.name) {
            silent.extend(tried.finds(&rest, &format!("without `{}`", plane.name)));
        }
    }
    assert!(silent.is_empty(), "{}: {}\n{}", method.name(), silent.len(), silent.join("\n"));
}

/// Splats of one form, each of a colour of its own.
fn gaussians() -> Scene {
    let number = |i: u32, k: u64| unit(5, u64::from(i) * 8 + k);
    let vector = |i, k| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2));
    let arrays = GaussianArrays {
        position: (0..40).map(|i| 1.6 * vector(i, 0) - 0.8).collect(),
        scale: vec![Vec3::new(0.2, 0.1, 0.3); 40],
        rotation: vec![[0.0, 0.0, 0.0, 1.0]; 40],
        opacity: (0..40).map(|i| 0.2 + 0.7 * number(i, 3)).collect(),
        degree: 0,
        harmonics: (0..40).map(|i| vector(i, 4)).collect(),
        encoding: Encoding::Srgb,
    };
    Scene::of_gaussians("splats", Gaussians::new(arrays).unwrap().0)
}

#[test]
fn of_each_method_a_value_is_judged_or_its_plane_is_listed() {
    let surfels = Scene::lit("", Shape::Cluster.surfels(60, 3).unwrap());
    for method in Method::all() {
        try_method(method, &surfels);
        if method.draws_gaussians() {
            try_method(method, &gaussians());
        }
    }
}

/// A level without the level before it is not judged, and the report says so in every form.
#[cfg(feature = "cli")]
#[test]
fn a_level_that_is_not_judged_is_in_the_lines_and_in_the_json() {
    use splatref::io::scene_file::Number;
    use splatref::report::verdict::VerdictReport;
    let exec = Exec::sequential();
    let shape = Shape::Cluster;
    let scene = Scene::lit("", shape.surfels(60, 3).unwrap());
    let camera = Camera::new(9, 7, shape.default_pose(), shape.default_lens()).unwrap();
    for (method, level, after) in
        [("template", "level01", "propagation"), ("pyramid", "pull01", "pull")]
    {
        let session = Session::new(&scene, Method::by_name(method).unwrap(), &exec).unwrap();
        let whole = session.define::<f32>(&camera, true).unwrap().frame;
        let rest = whole.planes.iter().filter(|plane| !plane.name.starts_with(level));
        let client = Client::from(&Frame { planes: rest.cloned().collect(), ..whole });
        let verdict = session.verify(&camera, &client, Verdict::BUDGET).unwrap();
        assert_eq!(verdict.outcome(), Outcome::Undecidable, "{method}");
        let replay = |_| String::new();
        let report =
            VerdictReport::new(&session, &camera, &client, &verdict, None, &replay).unwrap();
        let lines = report.lines();
        let line = lines.iter().find(|line| line.starts_with(after)).unwrap();
        assert!(line.contains("not judged") && line.contains("level 2"), "{line}");
        assert!(line.ends_with("; not handed in: level 1"), "{line}");
        let ending = lines.last().unwrap();
        assert!(ending.starts_with("undecidable: nothing is wrong, but not judged"), "{ending}");
        let json: serde_json::Value = serde_json::from_str(&report.json().unwrap()).unwrap();
        assert_eq!(json["outcome"], "undecidable");
        let stages = json["stages"].as_array().unwrap();
        let stage = stages.iter().find(|stage| stage["stage"] == after).unwrap();
        assert_eq!(stage["unjudged"], serde_json::json!(["level 2"]));
        assert_eq!(stage["missing"], serde_json::json!(["level 1"]));
        let page = report.page(&session, &camera, Number::F32, &exec).unwrap();
        assert!(page.title.contains("not judged"), "{}", page.title);
        let tab = page.tabs.iter().find(|tab| tab.name == after).unwrap();
        assert!(tab.says.ends_with("; not handed in: level 1"), "{}", tab.says);
    }
}
