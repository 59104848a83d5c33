//! Every stage of Algorithm 1 against the oracle, for groups drawn by lot.

use crate::pixel::{Entry, Seen};
use crate::scenes::{self, Case, Dice};
use crate::single_pass::Algorithm1;
use crate::stages::{at, index, measure, oracle};
use crate::tolerance::{self, Arithmetic, Measured};
use splatref::frame::{Exec, Frame, NO_ID};
use splatref::method::ewa::Epsilon;
use splatref::method::single_pass::{self, BinCount, DepthTest, Settings};
use splatref::number::Real;
use splatref::scene::group::Groups;

/// The names of a depth-image's planes and the rows of the table that hold for all groups.
const PLANES: [(&str, &str); 5] = [
    (".Z", "group.Z"),
    (".weight", "group.weight"),
    (".normal", "group.normal"),
    ("", "group"),
    (".voronoi", "group.voronoi"),
];

/// What was left open, in pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Open {
    /// Rounding decides what some group keeps: the crate's choice among the candidates was taken.
    undecided: usize,
    /// Rounding decides the epsilon-z test: left out.
    ambiguous: usize,
}

/// A picture's place in the test.
struct Subject<'a> {
    algorithm: Algorithm1<'a>,
    arithmetic: Arithmetic,
    case: &'a Case,
}

/// Groups without any extension.
pub(crate) fn groups(own: Vec<u8>, count: usize) -> Groups {
    Groups::new(own, Vec::new(), vec![1.0; count]).expect("groups below the count")
}

/// The colouring by lot, and the depth test.
fn variant(case: &Case, number: usize) -> (Groups, DepthTest) {
    let mut dice = Dice(number as u64 * 77 + 5);
    dice.below(1);
    let count = [1, 2, 5, 16, 64][number % 5];
    let own = (0..case.scene.surfels.len()).map(|_| dice.below(count) as u8).collect();
    let none = matches!(case.settings.epsilon, Epsilon::World(e) if e == 0.0);
    let depth = match number % 7 {
        0 | 4 => DepthTest::Plain,
        1 => DepthTest::Voronoi(BinCount::Count(1)),
        2 => DepthTest::Voronoi(BinCount::Count(7)),
        3 if none => DepthTest::Voronoi(BinCount::Count(65_535)),
        5 => DepthTest::Voronoi(BinCount::Count(4096)),
        _ if none => DepthTest::Plain,
        _ => DepthTest::Voronoi(BinCount::Epsilon),
    };
    (groups(own, count), depth)
}

/// What an image without a fragment holds.
fn check_empty<R: Real>(frame: &Frame<R>, layer: &str, i: usize, place: &str) {
    for plane in &frame.planes {
        let Some(end) = plane.name.strip_prefix(layer) else { continue };
        let expected = match end {
            ".Z" | ".voronoi" => f64::INFINITY,
            ".id" => f64::from(NO_ID),
            _ => 0.0,
        };
        assert_eq!(at(&plane.samples, i), [expected; 3], "{place}: empty, plane '{}'", plane.name);
    }
}

impl Subject<'_> {
    /// What every group keeps at a pixel, each checked against the candidates.
    fn kept<R: Real>(
        &self,
        frame: &Frame<R>,
        (i, center): (usize, [f64; 2]),
        place: &str,
        measured: &mut Measured,
    ) -> (Vec<Seen<'_>>, bool) {
        let (mut kept, mut undecided) = (Vec::new(), false);
        for (k, image) in self.algorithm.images(center).into_iter().enumerate() {
            let layer = format!("group{k:02}");
            let id = index(frame, &format!("{layer}.id"), i).expect("an id of each group");
            undecided |= image.undecided();
            if id == NO_ID {
                assert!(image.may_be_empty, "{place}: {layer} is empty");
                check_empty(frame, &layer, i, place);
                continue;
            }
            let found = image.candidates.iter().find(|c| c.seen.0.index as u32 == id);
            let seen = match found {
                Some(candidate) => candidate.seen,
                None => panic!("{place}: {layer} keeps {id}, which cannot be"),
            };
            for entry in self.algorithm.planes(center, seen) {
                let (end, key) = PLANES.into_iter().find(|p| p.0 == entry.plane).expect("named");
                let names = (&*format!("{layer}{end}"), key);
                let there = measure(frame, names, &entry, i, (self.arithmetic, place), measured);
                assert!(there, "{place}: no plane {layer}{end}");
            }
            kept.push(seen);
        }
        (kept, undecided)
    }

    /// The compositing pass and the normalization of what was kept.
    fn composite<R: Real>(
        &self,
        frame: &Frame<R>,
        (i, center): (usize, [f64; 2]),
        kept: &[Seen<'_>],
        place: &str,
        measured: &mut Measured,
    ) {
        let oracle = &self.algorithm.oracle;
        let seen = oracle.seen(kept);
        if let Some(count) = frame.plane("sums.count") {
            assert_eq!(at(count, i), [seen.len() as f64; 3], "{place}: groups in the band");
        }
        let (nearest, id) = (oracle.nearest(kept), index(frame, "id", i).expect("a plane id"));
        assert!(nearest.contains(&id) || kept.is_empty(), "{place}: id {id}, not of {nearest:?}");
        let covered = if kept.is_empty() { 0.0 } else { 1.0 };
        assert_eq!(at(frame.plane("A").expect("a plane A"), i), [covered; 3], "{place}: A");
        if kept.is_empty() {
            check_empty(frame, "sums", i, place);
            check_empty(frame, "resolved", i, place);
            let (depth, weight) = (frame.plane("Z"), frame.plane("weight"));
            assert_eq!(at(depth.expect("a plane Z"), i), [f64::INFINITY; 3], "{place}: Z");
            assert_eq!(at(weight.expect("a plane weight"), i), [0.0; 3], "{place}: weight");
            assert_eq!(id, NO_ID, "{place}: id");
        }
        for entry in oracle.entries(center, kept, &seen) {
            let plane = match entry.plane {
                "attributes.weight" => "sums.weight",
                "attributes.normal" => "sums.normal",
                "attributes" => "sums",
                plane => plane,
            };
            let entry = Entry { plane, ..entry };
            measure(frame, (plane, plane), &entry, i, (self.arithmetic, place), measured);
        }
    }

    /// Compares pictures of one arithmetic, the first with its stages.
    fn compare<R: Real>(&self, frames: &[&Frame<R>], measured: &mut Measured) -> Open {
        let (mut open, camera) = (Open::default(), &self.case.camera);
        for (i, (y, x)) in
            (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (y, x))).enumerate()
        {
            let place = format!("{:?} pixel ({x}, {y}) of {}", self.arithmetic, self.case.name);
            let pixel = (i, [f64::from(x) + 0.5, f64::from(y) + 0.5]);
            let (kept, undecided) = self.kept(frames[0], pixel, &place, measured);
            open.undecided += usize::from(undecided);
            if self.algorithm.oracle.grazes(&kept) {
                open.ambiguous += 1;
                continue;
            }
            for frame in frames {
                self.composite(frame, pixel, &kept, &place, measured);
            }
        }
        open
    }
}

#[test]
fn every_stage_of_the_single_pass_equals_the_oracle() {
    let exec = Exec::sequential();
    let (mut measured, mut worst) = (Measured::default(), [Open::default(); 2]);
    let mut cases = scenes::all();
    cases.extend(scenes::goldens());
    for (number, case) in cases.iter().enumerate() {
        let (scene, camera) = (&case.scene, &case.camera);
        let (groups, depth) = variant(case, number);
        let settings = Settings { splats: case.settings, depth };
        let epsilon = case.settings.epsilon.resolve(&scene.surfels);
        let range = match depth {
            DepthTest::Plain => None,
            DepthTest::Voronoi(bins) => {
                Some(bins.resolve(&scene.surfels, camera, epsilon).expect("few bins"))
            }
        };
        let plain = single_pass::render::<f32>(scene, &groups, camera, &settings, &exec, true);
        let fast = single_pass::render_f32(scene, &groups, camera, &settings, &exec);
        let truth = single_pass::render::<f64>(scene, &groups, camera, &settings, &exec, true);
        let (plain, fast, truth) =
            (plain.expect("renders"), fast.expect("renders"), truth.expect("renders"));
        let subject = |arithmetic| {
            let (own, count) = (groups.own(), groups.len());
            let algorithm = Algorithm1 { oracle: oracle(case, arithmetic), own, count, range };
            Subject { algorithm, arithmetic, case }
        };
        let narrow = subject(Arithmetic::F32).compare(&[&plain.frame, &fast.frame], &mut measured);
        let wide = if case.exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let wide = subject(wide).compare(&[&truth.frame], &mut measured);
        let pixels = (camera.width * camera.height) as usize;
        for (slot, open) in [narrow, wide].into_iter().enumerate() {
            let most = &mut worst[slot];
            most.undecided = most.undecided.max(open.undecided * 10_000 / pixels);
            most.ambiguous = most.ambiguous.max(open.ambiguous * 10_000 / pixels);
            if open.undecided * 50 > pixels {
                println!("{open:?} of {pixels}: {settings:?} {}", case.name);
            }
        }
    }
    println!("{} scenes; most open, in 1/10000 of the pixels, f32 and f64: {worst:?}", cases.len());
    for (key, (worst, place)) in &measured.0 {
        println!("{key:?}: {worst:.3} {place}");
    }
    let complaints = measured.complaints(tolerance::SINGLE_PASS);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
