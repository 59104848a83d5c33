//! Every plane of Gaussian splats against the oracle.

use crate::oracle::gaussians::blend::Pixel;
use crate::oracle::gaussians::cases;
use crate::oracle::gaussians::model::{Model, transferred};
use crate::oracle::gaussians::tolerance::GAUSSIANS;
use crate::oracle::kit::case::Case;
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::{index, number, unclean, value};
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use crate::oracle::transparent::surroundings::{radiance, world_ray};
use splatref::frame::Frame;
use splatref::method::gaussians::Settings;
use splatref::number::Exact;

/// One picture under test.
struct Check<'a, R> {
    frame: &'a Frame<R>,
    arithmetic: Arithmetic,
    measured: &'a mut Measured,
    place: &'a str,
    i: usize,
}

impl<R: Exact> Check<'_, R> {
    fn compare(&mut self, plane: &'static str, truth: Conditioned, found: f64) {
        assert!(!truth.value.is_nan(), "{}: {plane} {found}", self.place);
        let off = (found - truth.value).abs();
        // An alpha below the least normal number has no digits.
        let least = if self.arithmetic == Arithmetic::F32 { 1e-37 } else { 1e-300 };
        let deviation =
            if found == truth.value || off < least { 0.0 } else { off / truth.condition };
        let place = self.place;
        self.measured.add(plane, self.arithmetic, deviation, || {
            format!("{place}: {found:e} for {:e} +- {:e}", truth.value, truth.condition)
        });
    }

    fn number(&mut self, plane: &'static str, truth: Conditioned) {
        self.compare(plane, truth, number(self.frame, plane, self.i));
    }

    fn color(&mut self, plane: &'static str, truth: [Conditioned; 3]) {
        let found = value(self.frame, plane, self.i);
        (0..3).for_each(|c| self.compare(plane, truth[c], found[c]));
    }

    fn pixel(&mut self, truth: &Pixel) {
        let (frame, i, place) = (self.frame, self.i, self.place);
        let count = number(frame, "count", i) as usize;
        assert_eq!(count, truth.count.min(255), "{place}: count");
        assert_eq!(index(frame, "id", i), truth.id, "{place}: id");
        if !truth.open_heaviest {
            assert_eq!(index(frame, "heaviest", i), truth.heaviest, "{place}: heaviest");
        }
        self.color("blended", truth.color);
        self.number("T", truth.through);
        self.number("Z", truth.depth);
        self.number("Z.expected", truth.expected);
        if !truth.open_median {
            self.number("Z.median", truth.median);
        }
    }

    fn display(&mut self, model: &Model<'_>, truth: &Pixel, center: [f64; 2]) {
        let (srgb, step) = (model.blends_srgb(), model.step);
        let mut light = truth.color;
        let one = Conditioned::exact(1.0);
        let mut alpha = one - truth.through;
        let opaque = model.opaque(center.map(f64::floor));
        let opaque = opaque.map(|(_, color)| color.map(|c| Conditioned::exact(c.into())));
        let around = model.scene.environment.as_ref();
        let around =
            around.map(|around| radiance(around, world_ray(&model.eye, center), 4.0 * step));
        if let Some(mut behind) = opaque.or(around) {
            if srgb {
                behind = behind.map(|light| transferred(true, light, step));
            }
            light = [0, 1, 2].map(|c| light[c] + truth.through * behind[c]);
            alpha = one;
        }
        if srgb {
            light = light.map(|light| transferred(false, light, step));
        }
        // What nothing was blended over is not encoded and decoded again.
        let untouched = truth.through.value == 1.0 && truth.color.iter().all(|c| c.value == 0.0);
        if let Some(opaque) = opaque.filter(|_| untouched) {
            light = opaque;
        }
        self.color("", light);
        self.number("A", alpha);
    }
}

/// Compares one picture; returns how many pixels were left out.
fn compare<R: Exact>(
    case: &Case<Settings>,
    arithmetic: Arithmetic,
    measured: &mut Measured,
) -> usize {
    let frame = case.drawing().frame::<R>();
    assert_eq!(unclean(&frame), None, "{}", case.name);
    let digits = if arithmetic == Arithmetic::F32 { -24.0_f64 } else { -53.0 };
    let model = Model::new(&case.scene, &case.camera, &case.settings, digits.exp2());
    let (splats, mut left_out) = (model.splats(), 0);
    for (i, x, y) in case.pixels() {
        let at = [f64::from(x), f64::from(y)];
        let truth = model.pixel(&splats, at);
        if truth.open {
            left_out += 1;
            continue;
        }
        let place = format!("{arithmetic:?} pixel ({x}, {y}) of {}", case.name);
        let mut check =
            Check { frame: &frame, arithmetic, measured: &mut *measured, place: &place, i };
        check.pixel(&truth);
        check.display(&model, &truth, at.map(|v| v + 0.5));
    }
    left_out
}

fn compare_all(cases: Vec<Case<Settings>>) -> Measured {
    let (mut measured, mut left, mut all) = (Measured::default(), [0; 2], 0);
    for case in cases {
        let pixels = (case.camera.width * case.camera.height) as usize;
        let narrow = compare::<f32>(&case, Arithmetic::F32, &mut measured);
        let wide = compare::<f64>(&case, Arithmetic::F64, &mut measured);
        assert!(wide * 100 <= pixels, "{wide} of {pixels} left out of {}", case.name);
        (left[0], left[1], all) = (left[0] + narrow, left[1] + wide, all + pixels);
    }
    println!("left out of {all}: {left:?}");
    // In f32 whole scenes are open: splats that the camera is in, or a step of an order apart.
    assert!(left[0] * 20 <= all && left[1] * 1000 <= all, "{left:?} of {all} left out");
    measured
}

#[test]
fn every_plane_equals_the_oracle() {
    let mut all = cases::all();
    all.extend(goldens::of());
    compare_all(all).check(GAUSSIANS);
}
