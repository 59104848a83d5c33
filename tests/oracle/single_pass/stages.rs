//! Every stage of Algorithm 1 against the oracle, for groups drawn by lot.

use crate::oracle::ewa::cases;
use crate::oracle::ewa::model::Seen;
use crate::oracle::ewa::stages::{measure, oracle};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::{at, index, plane};
use crate::oracle::kit::scene::groups;
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use crate::oracle::single_pass::model::Algorithm1;
use crate::oracle::single_pass::tolerance::SINGLE_PASS;
use splatref::frame::{Frame, NO_ID, Samples};
use splatref::method::ewa;
use splatref::method::single_pass::{BinCount, DepthTest, Settings};
use splatref::number::Exact;
use splatref::splat::Epsilon;

/// A plane of a depth-image: the end of its name, the row of the table that holds for all groups,
/// and what it holds where the image is empty.
type PlaneRow = (&'static str, &'static str, f64);

const PLANES: [PlaneRow; 5] = [
    (".Z", "group.Z", f64::INFINITY),
    (".weight", "group.weight", 0.0),
    (".normal", "group.normal", 0.0),
    ("", "group", 0.0),
    (".voronoi", "group.voronoi", f64::INFINITY),
];

/// A depth-image: its surfels, and those of [`PLANES`] that are there.
struct DepthImage<'a, R> {
    id: &'a Samples<R>,
    planes: Vec<(&'a Samples<R>, PlaneRow)>,
}

impl<'a, R: Exact> DepthImage<'a, R> {
    fn new(frame: &'a Frame<R>, group: usize) -> Self {
        let named = |end: &str| frame.plane(&format!("group{group:02}{end}"));
        let planes = PLANES.into_iter().filter_map(|p| named(p.0).map(|samples| (samples, p)));
        Self { id: named(".id").expect("an id of each group"), planes: planes.collect() }
    }
}

/// The planes that are not of one group: few names, which are looked up at every pixel.
fn without_groups<R: Exact>(frame: &Frame<R>) -> Frame<R> {
    let planes = frame.planes.iter().filter(|plane| !plane.name.starts_with("group"));
    Frame { planes: planes.cloned().collect(), ..*frame }
}

/// What was left open, in pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Left {
    pixels: usize,
    /// Rounding decides what some group keeps: the crate's choice among the candidates was taken.
    undecided: usize,
    /// Rounding decides the epsilon-z test: left out.
    ambiguous: usize,
}

/// A picture's place in the test.
struct GroupStages<'a> {
    algorithm: Algorithm1<'a>,
    arithmetic: Arithmetic,
    case: &'a Case<Settings>,
}

/// A case with a colouring by lot, and a depth test.
fn variant(case: Case<ewa::Settings>, number: usize) -> Case<Settings> {
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
    let settings = Settings { splats: case.settings, depth };
    Case { groups: Some(groups(own, count)), ..case.with(settings) }
}

/// What the stages hold where no image has a fragment.
fn check_empty<R: Exact>(frame: &Frame<R>, i: usize, place: &str) {
    let stages = ["sums", "sums.normal", "sums.weight", "sums.count", "resolved", "weight", ""];
    for name in stages {
        let Some(samples) = frame.plane(name) else { continue };
        assert_eq!(at(samples, i), [0.0; 3], "{place}: empty, plane '{name}'");
    }
    assert_eq!(at(plane(frame, "Z"), i), [f64::INFINITY; 3], "{place}: Z");
    assert_eq!(index(frame, "id", i), NO_ID, "{place}: id");
}

impl GroupStages<'_> {
    /// What every group keeps at a pixel, each checked against the candidates.
    fn kept<R: Exact>(
        &self,
        layers: &[DepthImage<'_, R>],
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
        let (nearest, id) = (oracle.nearest(kept), index(frame, "id", i));
        assert!(nearest.contains(&id) || kept.is_empty(), "{place}: id {id}, not of {nearest:?}");
        let covered = if kept.is_empty() { 0.0 } else { 1.0 };
        assert_eq!(at(plane(frame, "A"), i), [covered; 3], "{place}: A");
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
    fn compare<R: Exact>(&self, frames: &[&Frame<R>], measured: &mut Measured) -> Left {
        let mut open = Left::default();
        let groups = 0..self.algorithm.count;
        let layers: Vec<_> = groups.map(|k| DepthImage::new(frames[0], k)).collect();
        let frames: Vec<_> = frames.iter().map(|frame| without_groups(frame)).collect();
        for (i, x, y) in self.case.pixels() {
            let place = format!("{:?} pixel ({x}, {y}) of {}", self.arithmetic, self.case.name);
            let pixel = (i, [f64::from(x) + 0.5, f64::from(y) + 0.5]);
            let (kept, undecided) = self.kept(&layers, pixel, &place, measured);
            open.pixels += 1;
            open.undecided += usize::from(undecided);
            if self.algorithm.oracle.grazes(&kept) {
                open.ambiguous += 1;
                continue;
            }
            for frame in &frames {
                self.composite(frame, pixel, &kept, &place, measured);
            }
        }
        open
    }
}

#[test]
fn every_stage_of_the_single_pass_equals_the_oracle() {
    let (mut measured, mut all) = (Measured::default(), [Left::default(); 2]);
    let by_lot = cases::all().into_iter().enumerate();
    let mut cases: Vec<_> = by_lot.map(|(number, case)| variant(case, number)).collect();
    cases.extend(goldens::of());
    for case in &cases {
        let (drawing, groups) = (case.drawing(), case.groups());
        let Settings { splats, depth } = &case.settings;
        let epsilon = splats.epsilon.resolve(&case.scene.surfels);
        let range = match depth {
            DepthTest::Plain => None,
            DepthTest::Voronoi(bins) => {
                match bins.resolve(&case.scene.surfels, &case.camera, epsilon) {
                    Ok(range) => Some(range),
                    Err(error) => {
                        let refused = drawing.try_fast().err().map(|e| e.to_string());
                        assert_eq!(refused, Some(error.to_string()));
                        continue;
                    }
                }
            }
        };
        let (plain, fast) = (drawing.frame::<f32>(), drawing.fast().frame);
        let truth = drawing.frame::<f64>();
        let subject = |arithmetic| {
            let (own, count) = (groups.own(), groups.len());
            let oracle = oracle(case, splats, arithmetic);
            GroupStages { algorithm: Algorithm1 { oracle, own, count, range }, arithmetic, case }
        };
        let narrow = subject(Arithmetic::F32).compare(&[&plain, &fast], &mut measured);
        let wide = if case.exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let wide = subject(wide).compare(&[&truth], &mut measured);
        for (slot, open) in [narrow, wide].into_iter().enumerate() {
            let Left { pixels, ambiguous, .. } = open;
            // The ladder is made of decisions at their limits.
            let least = if case.name.contains("ladder") { 100 } else { 200 };
            assert!(ambiguous * least <= pixels, "{open:?} in {}", case.name);
            all[slot].pixels += pixels;
            all[slot].undecided += open.undecided;
            all[slot].ambiguous += ambiguous;
        }
    }
    println!("{} scenes; f32 and f64: {all:?}", cases.len());
    // Sheets and plates, where depths of one plane differ by rounding alone, are most of them.
    assert!(all.iter().all(|open| open.undecided * 20 <= open.pixels), "{all:?}");
    measured.check(SINGLE_PASS);
}
