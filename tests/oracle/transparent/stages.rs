//! Every stage of Algorithms 2 and 3 against the oracle, for groups, extensions and opacities drawn
//! by lot.

use crate::oracle::ewa::model::Entry;
use crate::oracle::ewa::stages::{measure, oracle};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::draw::{Drawing, back_to_front};
use crate::oracle::kit::eye::V3;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::{self, index, plane};
use crate::oracle::kit::scene::groups;
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use crate::oracle::transparent::Settings;
use crate::oracle::transparent::cases;
use crate::oracle::transparent::model::{self, Image, Transparent, Truth};
use crate::oracle::transparent::surroundings::{radiance, refracted, world_ray};
use crate::oracle::transparent::tolerance::TRANSPARENT;
use splatref::frame::{Frame, NO_ID, Samples};
use splatref::method::single_pass::{self, DepthTest};
use splatref::number::Exact;
use splatref::scene::{Environment, Scene};

/// Compares one number, or three.
pub(crate) struct Compare<'a, R> {
    pub(crate) frame: &'a Frame<R>,
    pub(crate) i: usize,
    pub(crate) place: &'a str,
    pub(crate) arithmetic: Arithmetic,
    pub(crate) measured: &'a mut Measured,
}

impl<R: Exact> Compare<'_, R> {
    pub(crate) fn color(&mut self, name: &str, key: &'static str, numbers: [Conditioned; 3]) {
        let (step, _) = self.arithmetic.step();
        let value: V3 = numbers.map(|n| n.value);
        let condition = numbers.map(|n| n.condition + step * n.value.abs());
        let entry = Entry { plane: key, value, condition };
        let to = (self.arithmetic, self.place);
        measure((plane(self.frame, name), key), &entry, self.i, to, self.measured);
    }

    /// As [`Self::color`], of a plane that does not ask whether normals are unit vectors: in f64 it
    /// owes the digits of f64 whatever the scene.
    fn sharp(&mut self, name: &str, key: &'static str, numbers: [Conditioned; 3]) {
        let own = self.arithmetic;
        let mut numbers = numbers;
        if own == Arithmetic::F64Rounded {
            let finer = Arithmetic::F64.step().0 / own.step().0;
            numbers = numbers.map(|n| Conditioned { condition: n.condition * finer, ..n });
            self.arithmetic = Arithmetic::F64;
        }
        self.color(name, key, numbers);
        self.arithmetic = own;
    }

    pub(crate) fn number(&mut self, name: &str, key: &'static str, number: Conditioned) {
        self.color(name, key, [number; 3]);
    }

    pub(crate) fn exact(&self, name: &str, value: f64) {
        assert_eq!(
            planes::value(self.frame, name, self.i),
            [value; 3],
            "plane {name}: {}",
            self.place
        );
    }

    fn image(&mut self, layer: &str, image: &Image) {
        self.sharp(layer, "blended.group", image.color);
        self.sharp(&format!("{layer}.A"), "blended.group.A", [image.alpha; 3]);
        self.sharp(&format!("{layer}.opacities"), "blended.group.opacities", [image.opacity; 3]);
        self.exact(&format!("{layer}.bin"), image.bin);
        self.exact(&format!("{layer}.count"), image.layers.value);
        self.exact(&format!("{layer}.id"), image.last.into());
    }

    fn stages(&mut self, truth: &Truth, nearest: bool) {
        for (k, image) in truth.images.iter().enumerate() {
            self.image(&format!("blended.group{k:02}"), image);
        }
        let mean = &truth.average;
        self.sharp("blended", "blended", mean.color);
        self.sharp("blended.A", "blended.A", [mean.alpha; 3]);
        self.sharp("blended.opacities", "blended.opacities", [mean.opacity; 3]);
        self.sharp("blended.hidden", "blended.hidden", [mean.hidden; 3]);
        self.sharp("blended.layers", "blended.layers", [mean.layers; 3]);
        if !nearest {
            return;
        }
        self.number("l", "l", truth.count());
        match &truth.near {
            Some(near) => {
                self.color("nearest", "nearest", near.color);
                self.number("nearest.A", "nearest.A", near.alpha);
                self.exact("nearest.mask", 1.0);
            }
            None => {
                for name in ["nearest", "nearest.A", "nearest.mask"] {
                    self.exact(name, 0.0);
                }
            }
        }
    }
}

impl Case<Settings> {
    /// The last step: colour, opacity, and whether rounding decides about total reflection.
    fn light(
        &self,
        oracle: &Transparent<'_>,
        truth: &Truth,
        at: [f64; 2],
    ) -> ([Conditioned; 3], Conditioned, bool) {
        let environment = self.scene.environment.as_ref();
        let (step, guard) = (oracle.one.oracle.step, oracle.one.oracle.guard);
        let ray = world_ray(&oracle.one.oracle.optics.eye, at);
        let one = Conditioned::exact(1.0);
        let (mut color, mut alpha) = (truth.average.color, truth.average.alpha);
        if let Some(near) = &truth.near {
            if let (Some(environment), Some(refraction)) = (environment, &self.settings.refraction)
            {
                let pair = (truth, near);
                let (color, doubt) = refracted(pair, environment, refraction, ray, [step, guard]);
                return (color, one, doubt);
            }
            // alpha C_F + (1 - alpha) C_O: one alpha, so its errors act on the difference.
            let blend = |front: Conditioned, behind: Conditioned| {
                let alpha = near.alpha;
                let value = alpha.value * front.value + (1.0 - alpha.value) * behind.value;
                let condition = alpha.value * front.condition
                    + (1.0 - alpha.value) * behind.condition
                    + (front.value - behind.value).abs() * alpha.condition
                    + step * behind.value.abs();
                Conditioned { value, condition }
            };
            color = [0, 1, 2].map(|c| blend(near.color[c], color[c]));
            alpha = blend(one, alpha);
        }
        if let Some(environment) = environment {
            let sky = radiance(environment, ray, step);
            color = [0, 1, 2].map(|c| color[c] + (one - alpha) * sky[c]);
            for (sum, light) in color.iter_mut().zip(sky) {
                sum.condition += step * light.value;
            }
            alpha = one;
        }
        (color, alpha, false)
    }

    /// Compares one picture; returns how many pixels were left out.
    fn compare<R: Exact>(
        &self,
        frame: &Frame<R>,
        arithmetic: Arithmetic,
        measured: &mut Measured,
    ) -> usize {
        let Self { camera, scene, settings, .. } = self;
        let voronoi = match settings.nearest {
            Some(DepthTest::Voronoi(bins)) => Some(self.range(bins)),
            _ => None,
        };
        let ranges = [Some(self.range(settings.bins)), voronoi];
        let rounding = oracle(self, &settings.splats, arithmetic);
        let oracle = Transparent::new(rounding, camera, self.groups(), settings, ranges);
        let mut left_out = 0;
        for (i, x, y) in self.pixels() {
            let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let truth = oracle.at(center);
            let (color, alpha, doubt) = self.light(&oracle, &truth, center);
            if truth.ambiguous || doubt {
                left_out += 1;
                continue;
            }
            let place = format!("{arithmetic:?} pixel ({x}, {y}) of {}", self.name);
            let place = place.as_str();
            let mut compare = Compare { frame, i, place, arithmetic, measured: &mut *measured };
            let nearest = settings.nearest.is_some();
            compare.stages(&truth, nearest);
            let key = match (&scene.environment, &settings.refraction) {
                (None, _) => "",
                (Some(_), None) => "before an environment",
                (Some(Environment::Sky), Some(_)) => "refracted sky",
                (Some(Environment::Map(_)), Some(_)) => "refracted map",
            };
            if nearest {
                compare.color("", key, color);
                compare.number("A", "A", alpha);
            } else {
                compare.sharp("", key, color);
                compare.sharp("A", "A", [alpha; 3]);
            }
            let id = index(frame, "id", i);
            if truth.nearest.is_empty() {
                compare.exact("Z", f64::INFINITY);
                assert_eq!(id, NO_ID, "{place}");
            } else {
                compare.number("Z", "Z", truth.depth);
                assert!(truth.nearest.contains(&id), "{place}: {id} of {:?}", truth.nearest);
            }
            let layer = Conditioned::exact(if truth.near.is_some() { 1.0 } else { 0.0 });
            compare.sharp("layers", "layers", [truth.average.layers + layer; 3]);
            if let Some(near) = &truth.near {
                compare.number("weight", "weight", near.weight);
                if frame.plane("normal").is_some() {
                    compare.color("normal", "normal", near.normal);
                }
            }
        }
        left_out
    }
}

#[test]
fn every_stage_of_transparency_equals_the_oracle() {
    let (mut measured, mut worst) = (Measured::default(), [0.0_f64; 2]);
    let count: usize = std::env::var("ORACLE_CASES").map_or(96, |n| n.parse().expect("a number"));
    for subject in (0..count).map(cases::case).chain(goldens::of()) {
        let Case { scene, camera, exact, .. } = &subject;
        let order = back_to_front(&scene.surfels, camera);
        assert_eq!(order, model::back_to_front(&scene.surfels, camera), "the order");
        let (narrow, wide) = (subject.drawing().frame::<f32>(), subject.drawing().frame::<f64>());
        let rounded = if *exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let pixels = f64::from(camera.width * camera.height);
        let left = [
            subject.compare(&narrow, Arithmetic::F32, &mut measured) as f64 / pixels,
            subject.compare(&wide, rounded, &mut measured) as f64 / pixels,
        ];
        for (slot, left) in left.into_iter().enumerate() {
            worst[slot] = worst[slot].max(left);
            assert!(left <= 0.01, "{} % left out of {}", left * 100.0, subject.name);
        }
    }
    println!("{count} scenes; most left out: f32 {:.4}, f64 {:.4}", worst[0], worst[1]);
    measured.check(TRANSPARENT);
}

/// The nearest layer is Algorithm 1 of the groups without their extensions, to the last bit.
#[test]
fn the_images_of_the_nearest_layer_are_those_of_the_single_pass() {
    fn check<R: Exact>(subject: &Case<Settings>, depth: DepthTest) {
        let found = subject.drawing().frame::<R>();
        let plain = groups(subject.groups().own().to_vec(), subject.groups().len());
        let settings = single_pass::Settings { splats: subject.settings.splats, depth };
        let alone = Scene { environment: None, ..subject.scene.clone() };
        let one = Drawing::new(&alone, &subject.camera, settings).grouped(&plain).frame::<R>();
        let mut compared = 0;
        for plane in one.planes.iter().filter(|plane| plane.name.starts_with("group")) {
            let name = format!("nearest.{}", plane.name);
            assert!(found.plane(&name) == Some(&plane.samples), "{name}: {}", subject.name);
            compared += 1;
        }
        for name in ["Z", "id", "weight", "normal"] {
            if let (Some(a), Some(b)) = (found.plane(name), one.plane(name)) {
                assert!(a == b, "{name}: {}", subject.name);
                compared += 1;
            }
        }
        let color = plane(&found, "nearest");
        assert!(
            matches!(color, Samples::Color(_)) && one.plane("") == Some(color),
            "{}",
            subject.name
        );
        assert!(compared >= 4 * subject.groups().len() + 3);
    }
    let mut count = 0;
    for subject in (0..48).map(cases::case) {
        if let Some(depth) = subject.settings.nearest {
            check::<f32>(&subject, depth);
            check::<f64>(&subject, depth);
            count += 1;
        }
    }
    assert!(count > 20);
}
