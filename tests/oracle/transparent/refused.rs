//! What transparency refuses, in one line each.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::scene::groups;
use crate::oracle::transparent::Settings;
use crate::oracle::transparent::cases;
use splatref::Result;
use splatref::composite::bins::MAX_BINS;
use splatref::error::Error;
use splatref::frame::Exec;
use splatref::index::Index;
use splatref::index::order::BackToFront;
use splatref::method::single_pass::{BinCount, DepthTest};
use splatref::method::{Picture, peeling};
use splatref::scene::Environment;
use splatref::scene::Groups;
use splatref::shade::optics::{BendingLayers, Refraction};
use splatref::splat::Epsilon;

fn render(case: &Case<Settings>) -> Result<Picture<f32>> {
    case.drawing().try_define(false)
}

/// Asserts one line that holds these words.
fn refused(result: Result<Picture<f32>>, words: &[&str]) {
    let line = match result {
        Err(Error::Invalid(line)) => line,
        Err(other) => panic!("{other:?}"),
        Ok(_) => panic!("{words:?} was accepted"),
    };
    assert!(!line.contains('\n'), "{line}");
    for word in words {
        assert!(line.contains(word), "'{word}' is not in '{line}'");
    }
}

/// Discs about 4 away, coloured.
fn subject(settings: impl FnOnce(&mut Settings)) -> Case<Settings> {
    let mut case = cases::case(0).with(Settings::default());
    settings(&mut case.settings);
    case
}

#[test]
fn settings_out_of_range_are_refused() {
    assert!(render(&subject(|_| ())).is_ok());
    let bend = Refraction { ratio: [0.75; 3], layers: BendingLayers::Multiple };
    let settings = |s: &mut Settings| {
        s.nearest = Some(DepthTest::Plain);
        s.refraction = Some(bend);
    };
    let mut black = subject(settings);
    black.scene.environment = None;
    refused(render(&black), &["refraction", "environment"]);
    black.scene.environment = Some(Environment::Sky);
    assert!(render(&black).is_ok());
    for bad in [0.0, -1.0, 4.5, f32::NAN, f32::INFINITY] {
        let ratio = [0.75, bad, 0.75];
        let settings = |s: &mut Settings| {
            s.nearest = Some(DepthTest::Plain);
            s.refraction = Some(Refraction { ratio, ..bend });
        };
        refused(render(&subject(settings)), &["ratio", &bad.to_string()]);
    }
    for bad in [0, MAX_BINS + 1, u32::MAX] {
        let bins = BinCount::Count(bad);
        refused(render(&subject(|s| s.bins = bins)), &["bins", &bad.to_string()]);
        let voronoi = Some(DepthTest::Voronoi(bins));
        refused(render(&subject(|s| s.nearest = voronoi)), &["bins", &bad.to_string()]);
    }
    for good in [1, MAX_BINS] {
        assert!(render(&subject(|s| s.bins = BinCount::Count(good))).is_ok());
    }
    for bad in [-1.0, f32::NAN] {
        refused(render(&subject(|s| s.splats.epsilon = Epsilon::World(bad))), &["epsilon"]);
    }
    refused(render(&subject(|s| s.splats.kernel.cutoff = 9.0)), &["cut-off", "9"]);
}

#[test]
fn an_epsilon_of_too_many_bins_is_refused() {
    for epsilon in [0.0, 1e-30, 1e-5] {
        let settings = |s: &mut Settings| s.splats.epsilon = Epsilon::World(epsilon);
        refused(render(&subject(settings)), &["epsilon", "bins", &epsilon.to_string()]);
        // A number of bins that is given does not ask for epsilon, but that of Voronoi depth may.
        let settings = |s: &mut Settings| {
            s.splats.epsilon = Epsilon::World(epsilon);
            s.bins = BinCount::Count(100);
        };
        assert!(render(&subject(settings)).is_ok());
        let settings = |s: &mut Settings| {
            settings(s);
            s.nearest = Some(DepthTest::Voronoi(BinCount::Epsilon));
        };
        refused(render(&subject(settings)), &["epsilon", "bins"]);
    }
}

#[test]
fn layers_out_of_range_are_refused() {
    let subject = subject(|_| ());
    for layers in [0, peeling::MAX_LAYERS + 1, u32::MAX] {
        let settings = peeling::Settings { splats: subject.settings.splats, layers };
        let drawing = Drawing::new(&subject.scene, &subject.camera, settings);
        refused(drawing.try_define(false), &["layers", &layers.to_string()]);
    }
}

#[test]
fn groups_that_cannot_be_are_refused() {
    let bad = [
        (vec![0, 1], vec![], vec![1.0], "group 1"),
        (vec![0, 0], vec![(2, 0)], vec![1.0], "surfel 2"),
        (vec![0, 0], vec![(1, 3)], vec![1.0; 3], "group 3"),
        (vec![0, 0], vec![], vec![], "0 groups"),
        (vec![0, 0], vec![], vec![1.0; 65], "65 groups"),
        (vec![0, 0], vec![], vec![0.0], "scale of 0"),
        (vec![0, 0], vec![], vec![f32::INFINITY], "scale of inf"),
        (vec![0, 0], vec![], vec![f32::NAN], "scale of NaN"),
    ];
    for (own, added, scale, word) in bad {
        let line = Groups::new(own, added, scale).expect_err(word).to_string();
        assert!(line.contains(word) && !line.contains('\n'), "{line}");
    }
}

#[test]
fn groups_and_orders_of_other_surfels_are_refused() {
    let there = subject(|_| ()).scene.surfels.len();
    for count in [there - 1, there + 1] {
        let mut subject = subject(|_| ());
        subject.groups = Some(groups(vec![0; count], 1));
        refused(render(&subject), &["groups", &count.to_string(), &there.to_string()]);
    }
    for count in [8, 500] {
        let other = splatref::source::Shape::Sphere.surfels(count, 0).expect("few surfels");
        let order = Some(BackToFront::new(&other, &Exec::sequential()));
        let index = Index { order, ..Index::default() };
        let line = index.check(&subject(|_| ()).scene.surfels).expect_err("other surfels");
        assert!(
            line.to_string().contains("order") && line.to_string().contains(&there.to_string())
        );
    }
}
