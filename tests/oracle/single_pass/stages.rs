//! Every stage of Algorithm 1 against the oracle, for groups drawn by lot.

use crate::ewa::cases::{self, Case, Dice};
use crate::ewa::model::Seen;
use crate::ewa::stages::{at, index, measure, oracle};
use crate::kit::goldens;
use crate::kit::tolerance::{self, Arithmetic, Measured};
use crate::single_pass::model::Algorithm1;
use splatref::frame::{Exec, Frame, NO_ID, Samples};
use splatref::method::Method;
use splatref::method::ewa::Epsilon;
use splatref::method::single_pass::{self, BinCount, DepthTest, Settings};
use splatref::number::Exact;
use splatref::scene::Groups;

/// A plane of a depth-image: the end of its name, the row of the table that holds for all groups,
/// and what it holds where the image is empty.
type Kind = (&'static str, &'static str, f64);

const PLANES: [Kind; 5] = [
    (".Z", "group.Z", f64::INFINITY),
    (".weight", "group.weight", 0.0),
    (".normal", "group.normal", 0.0),
    ("", "group", 0.0),
    (".voronoi", "group.voronoi", f64::INFINITY),
];

/// A depth-image: its surfels, and those of [`PLANES`] that are there.
struct Layer<'a, R> {
    id: &'a Samples<R>,
    planes: Vec<(&'a Samples<R>, Kind)>,
}

impl<'a, R: Exact> Layer<'a, R> {
    fn new(frame: &'a Frame<R>, group: usize) -> Self {
        let named = |end: &str| frame.plane(&format!("group{group:02}{end}"));
        let planes = PLANES.into_iter().filter_map(|p| named(p.0).map(|samples| (samples, p)));
        Self { id: named(".id").expect("an id of each group"), planes: planes.collect() }
    }
}

/// What was left open, in pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Open {
    pixels: usize,
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

/// What the stages hold where no image has a fragment.
fn check_empty<R: Exact>(frame: &Frame<R>, i: usize, place: &str) {
    let stages = ["sums", "sums.normal", "sums.weight", "sums.count", "resolved", "weight", ""];
    for name in stages {
        let Some(samples) = frame.plane(name) else { continue };
        assert_eq!(at(samples, i), [0.0; 3], "{place}: empty, plane '{name}'");
    }
    assert_eq!(at(frame.plane("Z").expect("a plane Z"), i), [f64::INFINITY; 3], "{place}: Z");
    assert_eq!(index(frame, "id", i), Some(NO_ID), "{place}: id");
}

impl Subject<'_> {
    /// What every group keeps at a pixel, each checked against the candidates.
    fn kept<R: Exact>(
        &self,
        layers: &[Layer<'_, R>],
        (i, center): (usize, [f64; 2]),
        place: &str,
        measured: &mut Measured,
    ) -> (Vec<Seen<'_>>, bool) {
        let (mut kept, mut undecided) = (Vec::new(), false);
        for (k, (image, layer)) in self.algorithm.images(center).iter().zip(layers).enumerate() {
            let id = at(layer.id, i)[0] as u32;
            undecided |= image.undecided();
            if id == NO_ID {
                assert!(image.may_be_empty, "{place}: group {k} is empty");
                for (samples, (end, _, empty)) in &layer.planes {
                    assert_eq!(at(samples, i), [*empty; 3], "{place}: empty group {k}{end}");
                }
                continue;
            }
            let found = image.candidates.iter().find(|c| c.seen.0.index as u32 == id);
            let Some(candidate) = found else {
                panic!("{place}: group {k} keeps {id}, which cannot be")
            };
            for entry in self.algorithm.planes(center, candidate.seen) {
                let plane = layer.planes.iter().find(|(_, p)| p.0 == entry.plane);
                let (samples, (_, key, _)) = *plane.expect("a plane of each entry");
                measure((samples, key), &entry, i, (self.arithmetic, place), measured);
            }
            kept.push(candidate.seen);
        }
        (kept, undecided)
    }

    /// The compositing pass and the normalization of what was kept.
    fn composite<R: Exact>(
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
            check_empty(frame, i, place);
        }
        for entry in oracle.entries(center, kept, &seen) {
            let plane = match entry.plane {
                "attributes.weight" => "sums.weight",
                "attributes.normal" => "sums.normal",
                "attributes" => "sums",
                plane => plane,
            };
            let Some(samples) = frame.plane(plane) else { continue };
            measure((samples, plane), &entry, i, (self.arithmetic, place), measured);
        }
    }

    /// Compares pictures of one arithmetic, the first with its stages.
    fn compare<R: Exact>(&self, frames: &[&Frame<R>], measured: &mut Measured) -> Open {
        let (mut open, camera) = (Open::default(), &self.case.camera);
        let groups = 0..self.algorithm.count;
        let layers: Vec<_> = groups.map(|k| Layer::new(frames[0], k)).collect();
        for (i, (y, x)) in
            (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (y, x))).enumerate()
        {
            let place = format!("{:?} pixel ({x}, {y}) of {}", self.arithmetic, self.case.name);
            let pixel = (i, [f64::from(x) + 0.5, f64::from(y) + 0.5]);
            let (kept, undecided) = self.kept(&layers, pixel, &place, measured);
            open.pixels += 1;
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
    let (mut measured, mut all) = (Measured::default(), [Open::default(); 2]);
    let mut cases: Vec<_> = cases::all()
        .into_iter()
        .enumerate()
        .map(|(number, case)| {
            let (groups, depth) = variant(&case, number);
            (case, groups, depth)
        })
        .collect();
    let goldens = goldens::all().into_iter().filter_map(|golden| match golden.method {
        Method::SinglePass(settings) => Some((golden.case, golden.groups?, settings.depth)),
        _ => None,
    });
    cases.extend(goldens::at_least(2, goldens.collect()));
    for (case, groups, depth) in &cases {
        let (scene, camera, depth) = (&case.scene, &case.camera, *depth);
        let settings = Settings { splats: case.settings, depth };
        let epsilon = case.settings.epsilon.resolve(&scene.surfels);
        let range = match depth {
            DepthTest::Plain => None,
            DepthTest::Voronoi(bins) => match bins.resolve(&scene.surfels, camera, epsilon) {
                Ok(range) => Some(range),
                Err(error) => {
                    let refused = single_pass::render_f32(scene, groups, camera, &settings, &exec);
                    assert_eq!(refused.err().map(|e| e.to_string()), Some(error.to_string()));
                    continue;
                }
            },
        };
        let plain = single_pass::render::<f32>(scene, groups, camera, &settings, &exec, true);
        let fast = single_pass::render_f32(scene, groups, camera, &settings, &exec);
        let truth = single_pass::render::<f64>(scene, groups, camera, &settings, &exec, true);
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
        for (slot, open) in [narrow, wide].into_iter().enumerate() {
            let Open { pixels, ambiguous, .. } = open;
            assert!(ambiguous * 200 <= pixels, "{open:?} in {}", case.name);
            all[slot].pixels += pixels;
            all[slot].undecided += open.undecided;
            all[slot].ambiguous += ambiguous;
        }
    }
    println!("{} scenes; f32 and f64: {all:?}", cases.len());
    // Sheets and plates, where depths of one plane differ by rounding alone, are most of them.
    assert!(all.iter().all(|open| open.undecided * 20 <= open.pixels), "{all:?}");
    for (key, (worst, place)) in &measured.0 {
        println!("{key:?}: {worst:.3} {place}");
    }
    let complaints = measured.complaints(tolerance::SINGLE_PASS);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
