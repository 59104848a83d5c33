//! The matrix that certifies the verifier: every bug and every lawful variant of the second
//! implementations, in every scene, before every judge. The page is `docs/verdicts-tried.md`.
//!
//! A cell is a bug in a scene where it changes a bit of some plane. Beside the verdict stand the
//! rules that people use in its place, on the same pictures.

use super::client_is_right::differences;
use splatref::Camera;
use splatref::compare::metrics::{flip::flip, rmse::rmse, ssim::ssim};
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::Session;
use splatref::verdict::Outcome;
use splatref::verdict::client::{Client, Rounding, Ties};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

/// A picture of a second implementation.
pub(crate) struct Picture<'a> {
    pub(crate) session: &'a Session<'a>,
    pub(crate) camera: &'a Camera,
    pub(crate) scene: &'static str,
    /// The name of the bug or of the lawful variant.
    pub(crate) what: String,
    /// The promises that the client keeps; none for a bug.
    pub(crate) keeps: Option<&'static [Rounding]>,
    pub(crate) ties: Ties,
    pub(crate) frame: Frame<f32>,
}

/// Draws the pictures of a client, those of a scene in a row; the plain one comes first.
pub(crate) type Draws = fn(&mut dyn FnMut(Picture<'_>));

const PROMISES: [(&str, Rounding); 3] =
    [("gpu", Rounding::Gpu), ("precise", Rounding::Precise), ("ieee", Rounding::Ieee)];

/// A name, and whether a plane is handed in.
type Part = (&'static str, fn(&str) -> bool);

/// What a client hands in.
const PARTS: [Part; 3] = [
    ("all planes", |_| true),
    ("colour, depth and id", |plane| ["", "Z", "id"].contains(&plane)),
    ("colour", str::is_empty),
];

/// The rules that people use in place of a verdict.
const RULES: [(&str, Rule); 6] = [
    ("at most 20 pixels off by more than 1e-5 in any plane", |a, b| {
        a.planes
            .iter()
            .all(|plane| b.plane(&plane.name).is_some_and(|b| off(&plane.samples, b) <= 20))
    }),
    ("greatest difference of colour 1e-3", |a, b| {
        color(a).iter().zip(color(b)).all(|(a, b)| (a - b).abs() <= 1e-3)
    }),
    ("RMSE of colour 1e-4", |a, b| rmse(&color(a), &color(b)) <= 1e-4),
    ("PSNR 60 dB", |a, b| rmse(&color(a), &color(b)) <= 1e-3),
    ("SSIM 0.999", |a, b| {
        let channel = |frame, c| color(frame).into_iter().skip(c).step_by(3).collect::<Vec<_>>();
        let of = |c| ssim(&channel(a, c), &channel(b, c), a.width as usize).unwrap();
        (of(0) + of(1) + of(2)) / 3.0 >= 0.999
    }),
    ("FLIP 0.001", |a, b| {
        let [a, b] = [a, b].map(|frame| frame.color("").unwrap());
        flip(a, b, 67.0, &Exec::sequential()).unwrap().mean <= 1e-3
    }),
];

/// Whether a picture passes for the right one.
type Rule = fn(&Frame<f32>, &Frame<f32>) -> bool;

/// The colours of all pixels in a row; black in a picture without colours.
fn color(frame: &Frame<f32>) -> Vec<f32> {
    frame.color("").unwrap().values().iter().flatten().copied().collect()
}

/// The number of pixels in which two planes differ by more than 1e-5; NaN differs from everything.
fn off(a: &Samples<f32>, b: &Samples<f32>) -> usize {
    let near = |a: f32, b: f32| a == b || (a - b).abs() <= 1e-5;
    match (a, b) {
        (Samples::Scalar(a), Samples::Scalar(b)) => {
            a.values().iter().zip(b.values()).filter(|(a, b)| !near(**a, **b)).count()
        }
        (Samples::Color(a), Samples::Color(b)) | (Samples::Vector(a), Samples::Vector(b)) => {
            let far = |(a, b): &(&[f32; 3], &[f32; 3])| (0..3).any(|c| !near(a[c], b[c]));
            a.values().iter().zip(b.values()).filter(far).count()
        }
        (Samples::Index(a), Samples::Index(b)) => {
            a.values().iter().zip(b.values()).filter(|(a, b)| a != b).count()
        }
        (Samples::Count(a), Samples::Count(b)) => {
            a.values().iter().zip(b.values()).filter(|(a, b)| a != b).count()
        }
        _ => usize::MAX,
    }
}

/// What the judges say of the cells of a method.
#[derive(Default)]
struct Matrix {
    /// For each judge, how many cells it found, and how many lawful ones it called wrong.
    found: BTreeMap<usize, [usize; 2]>,
    /// How many lawful cells each judge was asked.
    lawful: BTreeMap<usize, usize>,
    /// For each bug, the scenes in which it changes something, and for each judge those in which it
    /// is found.
    bugs: BTreeMap<String, (BTreeSet<&'static str>, BTreeMap<usize, usize>)>,
    variants: BTreeSet<String>,
    /// Lawful pictures that a verdict does not call right.
    accused: Vec<String>,
}

/// The judges: each promise with each part, then the rules.
fn judges() -> Vec<String> {
    let verdicts = PROMISES.iter().flat_map(|(promise, _)| {
        PARTS.iter().map(move |(part, _)| format!("verdict, `{promise}`, {part}"))
    });
    verdicts.chain(RULES.iter().map(|(rule, _)| (*rule).to_owned())).collect()
}

impl Matrix {
    fn of(draws: Draws) -> Self {
        let (mut matrix, mut plain) = (Self::default(), BTreeMap::new());
        draws(&mut |picture: Picture<'_>| {
            let plain = plain.entry(picture.scene).or_insert_with(|| picture.frame.clone());
            let names = |frame: &Frame<f32>| -> BTreeSet<String> {
                frame.planes.iter().map(|plane| plane.name.clone()).collect()
            };
            let same = names(plain) == names(&picture.frame)
                && differences(plain, &picture.frame).is_empty();
            if !same || picture.keeps.is_some() {
                matrix.judge(&picture, plain);
            }
        });
        matrix
    }

    fn judge(&mut self, picture: &Picture<'_>, plain: &Frame<f32>) {
        let wanted = |promise| picture.keeps.is_none_or(|keeps| keeps.contains(&promise));
        for (p, (_, promise)) in PROMISES.iter().enumerate().filter(|(_, p)| wanted(p.1)) {
            for (i, (part, holds)) in PARTS.iter().enumerate() {
                let mut frame = picture.frame.clone();
                frame.planes.retain(|plane| holds(&plane.name));
                let mut client = Client::from(&frame);
                (client.rounding, client.ties) = (*promise, picture.ties);
                let verdict = picture.session.verify(picture.camera, &client, 1.0).unwrap();
                let alarm = matches!(verdict.outcome(), Outcome::Wrong | Outcome::Unlike);
                self.note(p * PARTS.len() + i, picture, alarm);
                if alarm && picture.keeps.is_some() {
                    let Picture { scene, what, .. } = picture;
                    let wrong = verdict.first_wrong().map(|stage| &stage.worst);
                    let why = format!("{wrong:?} {:?}", verdict.unlike);
                    self.accused.push(format!("{what} in {scene}, {promise:?}, {part}: {why}"));
                }
            }
        }
        for (i, (_, rule)) in RULES.iter().enumerate() {
            self.note(PROMISES.len() * PARTS.len() + i, picture, !rule(&picture.frame, plain));
        }
    }

    /// Notes what a judge says of a picture.
    fn note(&mut self, judge: usize, picture: &Picture<'_>, alarm: bool) {
        let lawful = picture.keeps.is_some();
        self.found.entry(judge).or_default()[usize::from(lawful)] += usize::from(alarm);
        if lawful {
            *self.lawful.entry(judge).or_default() += 1;
            self.variants.insert(picture.what.clone());
        } else {
            let (scenes, found) = self.bugs.entry(picture.what.clone()).or_default();
            scenes.insert(picture.scene);
            *found.entry(judge).or_default() += usize::from(alarm);
        }
    }

    /// The rows of the table: a judge a row.
    fn table(&self, page: &mut String) {
        let cells: usize = self.bugs.values().map(|(scenes, _)| scenes.len()).sum();
        writeln!(
            page,
            "| judge | found, of {cells} cells | bugs found, of {} | false alarms |\n|---|---|---|---|",
            self.bugs.len()
        )
        .unwrap();
        for (judge, name) in judges().into_iter().enumerate() {
            let [found, alarms] = self.found.get(&judge).copied().unwrap_or_default();
            let bugs = self.bugs.values().filter(|(_, found)| found.get(&judge) > Some(&0)).count();
            let lawful = self.lawful.get(&judge).copied().unwrap_or_default();
            writeln!(page, "| {name} | {found} | {bugs} | {alarms} of {lawful} |").unwrap();
        }
    }

    /// The bugs that a judge misses in some scene.
    fn missed(&self, judge: usize) -> String {
        let missed = self.bugs.iter().filter_map(|(bug, (scenes, found))| {
            let found = found.get(&judge).copied().unwrap_or_default();
            (found < scenes.len()).then(|| format!("{bug} {found} of {}", scenes.len()))
        });
        missed.collect::<Vec<_>>().join(", ")
    }
}

const INTRODUCTION: &str = "\
# What the verdict was tried on

This page shows what a verdict finds, what it misses, and what other rules find on the same pictures. Use it to decide what you compare.

The pictures are those of the second implementations in `tests/verify`, which were written from the documentation alone. A *bug* is a
change of one line. A *cell* is a bug in a scene where it changes a bit of some plane. A *false alarm* is a lawful variant, such as
fused products or coarse division, that is not called right; each promise is asked about the variants that keep it. A rule compares
the picture with that of the plain implementation.

A verdict misses bugs that move a limit by less than the rounding that the promise grants; the last lines of each section list what is
missed. From colour, depth and id alone, a picture of `pyramid` or `template` is undecidable, so nothing is found.

The test that writes this page: `cargo test --release --test all -- --ignored matrix`.
";

#[test]
#[ignore = "slow: .ci/run runs it"]
fn the_matrix_is_that_of_the_page() {
    let clients: [(&str, Draws); 4] = [
        ("ewa", super::verdicts::pictures),
        ("single-pass", super::groups::pictures),
        ("pyramid", super::image_space::pictures_of_pyramid),
        ("template", super::image_space::pictures_of_template),
    ];
    let (mut page, mut accused) = (INTRODUCTION.to_owned(), Vec::new());
    let matrices: Vec<Matrix> = std::thread::scope(|scope| {
        let all = clients.map(|(_, draws)| scope.spawn(move || Matrix::of(draws)));
        all.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    for ((method, _), matrix) in clients.iter().zip(&matrices) {
        let variants = matrix.variants.len();
        writeln!(page, "\n## {method}: {} bugs, {variants} lawful variants\n", matrix.bugs.len())
            .unwrap();
        matrix.table(&mut page);
        for (p, (promise, _)) in PROMISES.iter().enumerate() {
            let missed = matrix.missed(p * PARTS.len());
            let missed = if missed.is_empty() { "none".to_owned() } else { missed };
            writeln!(
                page,
                "\nNot found in every scene under `{promise}`, from all planes: {missed}."
            )
            .unwrap();
        }
        accused.extend(matrix.accused.iter().map(|accused| format!("{method}: {accused}")));
    }
    assert!(accused.is_empty(), "{accused:#?}");
    check(Section::Finds, &page);
}

/// How the part of the page begins that [`super::gaussians`] writes.
pub(crate) const GAUSSIANS: &str = "## gaussians: ";

/// The heading of the part of the page that [`super::matrix_of_causes`] writes.
pub(crate) const NAMES: &str = "## The names of mistakes";

/// A section of the page.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Section {
    Finds,
    Gaussians,
    Names,
}

/// Panics unless a section of the page is this text. Writes a page that has it.
pub(crate) fn check(section: Section, text: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let old = std::fs::read_to_string(root.join("docs/verdicts-tried.md")).unwrap_or_default();
    let (all, names) = old.split_at(old.find(NAMES).unwrap_or(old.len()));
    let (finds, gaussians) = all.split_at(all.find(GAUSSIANS).unwrap_or(all.len()));
    let page = match section {
        Section::Finds => format!("{text}\n{gaussians}{names}"),
        Section::Gaussians => format!("{finds}{text}\n{names}"),
        Section::Names => format!("{all}{text}"),
    };
    if old != page {
        let path = root.join("out/verdicts-tried.md");
        std::fs::create_dir_all(root.join("out")).unwrap();
        std::fs::write(&path, page).unwrap();
        panic!("docs/verdicts-tried.md is not what is found now: see {}", path.display());
    }
}
