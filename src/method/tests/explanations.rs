//! An explanation says what the picture shows; a pixel outside the picture is an error.

use super::{cameras, color, count, id, scalar};
use crate::composite::over::Blend;
use crate::frame::{Exec, Frame, NO_ID};
use crate::index::Index;
use crate::index::order::BackToFront;
use crate::method::algorithm::{Algorithm, Job};
use crate::method::{Method, Session, blue, ewa, peeling, transparent, transparent_hq};
use crate::number::random::unit;
use crate::scene::{Camera, Cloud, Groups, Light, Scene, Surfels};

/// Random surfels of random opacities under a light, in three groups, seen from one side by a
/// camera.
struct Example {
    scene: Scene,
    index: Index,
    camera: Camera,
    exec: Exec,
}

impl Example {
    fn new() -> Self {
        let opacity = |i: u64| if i.is_multiple_of(5) { 1.0 } else { unit(3, i) };
        let cloud = Cloud {
            opacity: Some((0..120).map(opacity).collect()),
            ..super::surfels(120, 0.25, true, 1).into_cloud()
        };
        let mut scene = super::scene(Surfels::new(cloud).unwrap().0);
        scene.lights.push(Light::DEFAULT);
        let exec = Exec::new(1, 8).unwrap();
        let own = (0..120).map(|i| (i % 3) as u8).collect();
        let groups = Groups::new(own, Vec::new(), vec![1.0, 1.5, 1.0]).unwrap();
        let order = BackToFront::new(&scene.surfels, &exec);
        let index = Index { groups: Some(groups), order: Some(order), ..Index::default() };
        Self { scene, index, camera: cameras()[4], exec }
    }

    /// Calls `test` with the planes of the definition, for every pixel.
    fn each_pixel(
        &self,
        settings: &impl Algorithm,
        mut test: impl FnMut(&Job<'_>, &Frame<f64>, (u32, u32)),
    ) {
        let Self { scene, index, camera, exec } = self;
        let job = Job::new(scene, index, camera, exec);
        let frame = settings.define::<f64>(&job, true).unwrap().frame;
        let pixels = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y)));
        pixels.for_each(|pixel| test(&job, &frame, pixel));
    }
}

#[test]
fn ewa_is_explained_as_it_is_drawn() {
    let settings = ewa::Settings::default();
    Example::new().each_pixel(&settings, |job, frame, (x, y)| {
        let found = ewa::explain::explain::<f64>(job, &settings, (x, y)).unwrap();
        assert_eq!(found.nearest, *scalar(frame, "Z").at(x, y));
        let last = found.touches.iter().rev().find(|touch| touch.passes());
        assert_eq!(found.id, last.map(|touch| touch.surfel));
        assert_eq!(found.id.unwrap_or(NO_ID), *id(frame, "id").at(x, y));
        let visible: Vec<_> = found.visible.iter().filter_map(|touch| touch.gives).collect();
        assert_eq!(visible.len(), usize::from(*count(frame, "attributes.count").at(x, y)));
        let sum = visible.iter().fold(0.0, |sum, (_, weight)| sum + weight);
        assert_eq!(sum, *scalar(frame, "weight").at(x, y));
        assert_eq!(found.to_string().contains("the pixel is empty"), found.id.is_none());
    });
}

#[test]
fn peeling_is_explained_as_it_is_drawn() {
    let settings = peeling::Settings::default();
    Example::new().each_pixel(&settings, |job, frame, (x, y)| {
        let found = peeling::explain::explain::<f64>(job, &settings, (x, y)).unwrap();
        assert_eq!(found.layers.len(), usize::from(*count(frame, "layers").at(x, y)));
        for (number, at) in (1..=8).zip(&found.layers) {
            let plane = |name: &str| format!("layer{number}{name}");
            assert_eq!(at.layer.depth, *scalar(frame, &plane(".Z")).at(x, y));
            assert_eq!(at.layer.alpha, *scalar(frame, &plane(".A")).at(x, y));
            assert_eq!(at.layer.color, *color(frame, &plane("")).at(x, y));
            let visible = at.visible.iter().filter(|touch| touch.passes()).count();
            assert_eq!(visible, usize::from(*count(frame, &plane(".count")).at(x, y)));
            let last = at.touches.iter().rev().find(|touch| touch.passes());
            assert_eq!(last.map(|touch| touch.surfel), Some(at.layer.id));
        }
        assert_eq!(found.blend.color, *color(frame, "").at(x, y));
        let empty = found.to_string().contains("the pixel is empty");
        assert_eq!(empty, *id(frame, "id").at(x, y) == NO_ID);
    });
}

/// The layers that an explanation blends, from back to front, agree with the planes.
fn agree(found: &transparent::explain::TransparentReplay<f64>, frame: &Frame<f64>) -> usize {
    let (x, y) = found.pixel;
    for at in &found.groups {
        let plane = |name: &str| format!("blended.group{:02}{name}", at.group);
        assert_eq!(at.color, *color(frame, &plane("")).at(x, y));
        assert_eq!(at.alpha, *scalar(frame, &plane(".A")).at(x, y));
        assert_eq!(at.opacity, *scalar(frame, &plane(".opacities")).at(x, y));
        assert_eq!(at.count, *count(frame, &plane(".count")).at(x, y));
        let blended = || at.touches.iter().filter(|touch| touch.passes());
        assert_eq!(blended().count(), usize::from(at.count));
        let last = blended().next_back().map_or(NO_ID, |touch| touch.surfel);
        assert_eq!(last, *id(frame, &plane(".id")).at(x, y));
    }
    assert_eq!(found.color, *color(frame, "blended").at(x, y));
    assert_eq!(found.alpha, *scalar(frame, "blended.A").at(x, y));
    found.groups.iter().map(|at| usize::from(at.count)).sum()
}

#[test]
fn transparent_is_explained_as_it_is_drawn() {
    let settings = transparent::Settings::default();
    let mut most = 0;
    Example::new().each_pixel(&settings, |job, frame, (x, y)| {
        let found = transparent::explain::explain::<f64>(job, &settings, (x, y)).unwrap();
        most = most.max(agree(&found, frame));
        assert_eq!(found.nearest, *scalar(frame, "Z").at(x, y));
        assert_eq!(found.id, *id(frame, "id").at(x, y));
        assert_eq!(found.to_string().contains("the pixel is empty"), found.id == NO_ID);
    });
    assert!(most > 4, "{most} layers");
}

#[test]
fn transparent_hq_is_explained_as_it_is_drawn() {
    let settings = transparent_hq::Settings::default();
    let mut most = 0;
    Example::new().each_pixel(&settings, |job, frame, (x, y)| {
        let found = transparent_hq::explain::explain::<f64>(job, &settings, (x, y)).unwrap();
        most = most.max(agree(&found.others, frame));
        assert_eq!(found.nearest.nearest, *scalar(frame, "Z").at(x, y));
        assert_eq!(found.alpha, *scalar(frame, "nearest.A").at(x, y));
        assert_eq!(found.color, *color(frame, "nearest").at(x, y));
        let Blend { color: shown, alpha } = found.shown;
        assert_eq!(shown, *color(frame, "").at(x, y));
        assert_eq!(alpha, *scalar(frame, "A").at(x, y));
        let text = found.to_string();
        assert_eq!(text.contains("the pixel is empty"), found.nearest.nearest.is_infinite());
    });
    assert!(most > 2, "{most} layers");
}

#[test]
fn blue_is_explained_as_it_is_drawn() {
    let mut ends = [0; 3];
    for cull in [false, true] {
        let settings = blue::Settings { cull };
        Example::new().each_pixel(&settings, |job, frame, (x, y)| {
            let found = blue::explain::explain::<f64>(job, &settings, (x, y)).unwrap();
            let shown = *id(frame, "id").at(x, y);
            assert_eq!(found.surfel().unwrap_or(NO_ID), shown);
            let depth = found.kept.map_or(f64::INFINITY, |kept| kept.t);
            assert_eq!(depth, *scalar(frame, "Z").at(x, y));
            let offset = found.kept.and_then(|kept| kept.offset);
            assert_eq!(offset.map_or(0.0, |[o, _]| o), *scalar(frame, "discs.offset").at(x, y));
            let kept = |touch: &&blue::explain::BlueTouch<f64>| {
                matches!(touch.end, blue::explain::BlueEnd::Nearest(_))
            };
            let last = found.touches.iter().rfind(kept).map_or(NO_ID, |touch| touch.id);
            assert_eq!(last, shown);
            let weights: Vec<_> = found.surfel().map(|surfel| (surfel, 1.0)).into_iter().collect();
            assert_eq!(settings.weights(job, (x, y)).unwrap(), weights);
            let text = found.to_string();
            assert_eq!(text.contains("the pixel is empty"), shown == NO_ID, "{text}");
            let words = ["dropped: the back", "discarded: offset", "loses    depth"];
            for (count, word) in ends.iter_mut().zip(words) {
                *count += usize::from(text.contains(word));
            }
        });
    }
    assert!(ends.iter().all(|count| *count > 20), "{ends:?}");
}

#[test]
fn a_pixel_outside_is_wrong_usage() {
    let Example { scene, camera, exec, index } = Example::new();
    for method in Method::all() {
        let session = Session::with_groups(&scene, method, index.groups.clone(), &exec).unwrap();
        for pixel in [(camera.width, 0), (0, camera.height)] {
            let error = session.explain::<f32>(&camera, pixel).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{method:?}");
        }
    }
}
