//! Every plane of every stage of the pull-push pyramid against its oracle.
//!
//! Stage by stage: each is computed from what the crate left of the one before, so that errors do
//! not pile up, and a plane is compared in units of its running error bound. Where rounding may
//! decide, any outcome is accepted, and such cells are counted. A third run computes in `f32`
//! itself, where no decision is open: the documentation gives the bits.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::check::{Check, FAR, Number, Open, PROJECTION, vector};
use crate::oracle::kit::number::{BITS, Num, exact};
use crate::oracle::kit::planes::unclean;
use crate::oracle::kit::projection::{Projected, Sight};
use crate::oracle::kit::shade::{Surface, shaded};
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use crate::oracle::pyramid::cases;
use crate::oracle::pyramid::model::{Cell, Expected, Level, pulled, pushed};
use crate::oracle::pyramid::tolerance::PYRAMID;
use Arithmetic::{F32, F64};
use splatref::method::Picture;
use splatref::method::pyramid::Settings;
use splatref::number::Exact;
use splatref::scene::Camera;

/// One picture under test.
struct PyramidStages<'a, R, const P: u32> {
    case: &'a Case<Settings>,
    check: Check<'a, R, P>,
}

impl<R: Exact, const P: u32> PyramidStages<'_, R, P> {
    /// A cell against what it may be.
    fn cell(
        &mut self,
        pull: bool,
        expected: Vec<Expected<P>>,
        found: &Cell,
        place: impl Fn() -> String,
    ) {
        let rows = if pull { &PULL } else { &PUSH };
        let entries = |e: &Expected<P>| {
            let mut all: Vec<Number<P>> = vec![
                (rows[0], Num::exact(e.kind.into()), f64::from(found.kind)),
                (rows[1], e.front, found.front),
                (rows[2], e.back, found.back),
                (rows[3], e.radius, found.radius),
                (rows[4], e.displacement[0], found.displacement[0]),
                (rows[4], e.displacement[1], found.displacement[1]),
            ];
            all.extend(vector(rows[5], e.normal, found.normal));
            all.extend(vector(rows[6], e.tangent, found.tangent));
            all.extend(vector(rows[7], e.color, found.color));
            all
        };
        self.check.open.count(if pull { "pull" } else { "push" }, expected.len() > 1);
        self.check.best(expected.iter().map(entries).collect(), place);
    }

    /// Both phases; level 0 as the push phase left it.
    fn levels(&mut self) -> Level {
        let frame = self.check.frame;
        let mut sizes = vec![[frame.width, frame.height]];
        while let Some([w, h]) = sizes.last().copied().filter(|size| *size != [1, 1]) {
            sizes.push([w.div_ceil(2), h.div_ceil(2)]);
        }
        let mut pulls = vec![Level::projected(frame)];
        for (l, size) in sizes.iter().enumerate().skip(1) {
            let level = Level::read(frame, &format!("pull{l:02}"), *size);
            let side = (l as f64 - 1.0).exp2();
            for (k, cell) in level.cells.iter().enumerate() {
                let [x, y] = [k as u32 % size[0], k as u32 / size[0]].map(i64::from);
                let expected = pulled(&pulls[l - 1], side, x, y);
                self.cell(true, expected, cell, || format!("pull{l:02} ({x}, {y})"));
            }
            pulls.push(level);
        }
        let beyond = [format!("pull{:02}", sizes.len()), format!("push{:02}", sizes.len() - 1)];
        for stage in beyond {
            assert!(frame.plane(&format!("{stage}.front")).is_none(), "{stage}");
        }
        let mut coarse = pulls.pop().expect("a level");
        for (l, pull) in pulls.iter().enumerate().rev() {
            let level = Level::read(frame, &format!("push{l:02}"), sizes[l]);
            for (k, cell) in level.cells.iter().enumerate() {
                let at = [k as u32 % sizes[l][0], k as u32 / sizes[l][0]].map(i64::from);
                let side = (l as f64).exp2();
                let expected = pushed((pull, &coarse), &self.case.settings, side, at);
                self.cell(false, expected, cell, || format!("push{l:02} {at:?}"));
            }
            coarse = level;
        }
        coarse
    }

    fn picture(&mut self, level: &Level) {
        let (Case { scene, camera, name, .. }, check) = (self.case, &mut self.check);
        let sight = Sight::<P>::new(camera);
        let material = crate::oracle::kit::eye::wide(scene.material.color);
        for (i, x, y) in self.case.pixels() {
            let place = format!("pixel ({x}, {y})");
            let cell = level.cells[i];
            let [kind, depth, seen] = ["kind", "Z", "A"].map(|plane| check.number(plane, i));
            let expected = [f64::from(cell.kind), cell.front, f64::from(u8::from(cell.kind != 0))];
            assert_eq!([kind, depth, seen], expected, "{place} of {name}");
            let color = check.value("", i);
            let vectors = ["normal", "tangent"].map(|plane| check.optional(plane, i));
            if cell.kind == 0 {
                assert_eq!(color, [0.0; 3], "{place} of {name}");
                assert!(vectors.iter().flatten().all(|v| *v == [0.0; 3]), "{place}");
                continue;
            }
            let [normal, tangent] = vectors;
            let mut entries = Vec::new();
            for (row, found, own) in
                [("normal", normal, cell.normal), ("tangent", tangent, cell.tangent)]
            {
                if let Some(found) = found {
                    entries.extend(vector(row, sight.outwards(exact(own)), found));
                }
            }
            check.best(vec![entries], || place.clone());
            let own = if check.frame.plane("projection").is_some() { cell.color } else { material };
            let surface = Surface {
                depth,
                normal: normal.unwrap_or_default(),
                tangent: tangent.unwrap_or_default(),
                color: exact(own),
            };
            let outcomes = shaded(scene, &sight, (x, y), &surface);
            check.open.count("shading", outcomes.len() > 1);
            let outcomes = outcomes.into_iter().map(|c| vector("", c, color).to_vec()).collect();
            check.best(outcomes, || format!("shaded {place}"));
        }
    }
}

/// The rows of a cell's numbers.
const PULL: [&str; 8] = [
    "pull.kind",
    "pull.front",
    "pull.back",
    "pull.extent",
    "pull.displacement",
    "pull.normal",
    "pull.tangent",
    "pull",
];
const PUSH: [&str; 8] = [
    "push.kind",
    "push.front",
    "push.back",
    "push.extent",
    "push.displacement",
    "push.normal",
    "push.tangent",
    "push",
];

fn compare<R: Exact, const P: u32>(
    case: &Case<Settings>,
    arithmetic: Arithmetic,
    (measured, open): (&mut Measured, &mut Open),
) -> Picture<R> {
    let picture = case.drawing().define::<R>();
    assert_eq!(unclean(&picture.frame), None, "of {}", case.name);
    let Case { scene, camera, settings, name, .. } = case;
    let mut check = Check { name, frame: &picture.frame, arithmetic, measured, open };
    let truth = Projected::<P>::new(scene, camera, settings.cull, settings.subpixel_bits);
    check.projection(case, &truth, &picture.tally);
    let mut stages = PyramidStages { case, check };
    let level = stages.levels();
    stages.picture(&level);
    picture
}

#[test]
fn pyramid_stages_equal_the_oracle() {
    let (mut measured, mut opens) = (Measured::default(), [Open::default(), Open::default()]);
    let cases = cases::with_goldens();
    for case in &cases {
        let [narrow, wide] = &mut opens;
        compare::<f32, 24>(case, F32, (&mut measured, narrow));
        compare::<f64, 53>(case, F64, (&mut measured, wide));
    }
    for (open, most) in opens.iter().zip([5e-3, 2e-3]) {
        println!("{} scenes; compared, open: {:?}", cases.len(), open.0);
        for (stage, [all, open]) in &open.0 {
            assert!(*open as f64 <= most * *all as f64, "{open} of {all} are open: {stage}");
        }
    }
    // The corners of what is clipped are too far away for f32 to say where they are snapped; their
    // pixels are compared in the two other arithmetics.
    let [[near, _], [far, _]] = [PROJECTION, FAR].map(|stage| opens[0].get(stage));
    assert!(far < near / 10, "{far} pixels of far primitives, {near} others");
    assert_eq!(opens[1].get(FAR), [0, 0], "nothing is too far away for f64");
    measured.check(PYRAMID);
}

#[test]
fn pyramid_bits_are_those_of_the_documentation() {
    for case in &cases::with_goldens() {
        let (mut measured, mut open) = (Measured::default(), Open::default());
        let plain = compare::<f32, BITS>(case, F32, (&mut measured, &mut open));
        assert!(open.0.values().all(|[_, open]| *open == 0), "{:?} in {}", open.0, case.name);
        // The memory of the fast path held larger levels.
        let larger = Camera { width: 70, height: 81, ..case.camera };
        for fast in [case.drawing().fast(), case.drawing().fast_after(&larger)] {
            assert_eq!(fast.tally, plain.tally, "{}", case.name);
            for plane in &fast.frame.planes {
                let other = plain.frame.plane(&plane.name);
                assert!(other == Some(&plane.samples), "'{}' of {}", plane.name, case.name);
            }
        }
    }
}
