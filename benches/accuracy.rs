//! Accuracy of \[ZP06\]: its figures 8, 9, 12 and 13 as numbers, with the time that each picture
//! took.
//!
//! `cargo bench --bench accuracy` prints Markdown tables, and with `--write` puts them into
//! `docs/zp06.md`; an argument is a pattern that the names of scenes must contain. Scenes are the
//! scans in the folder that `SPLATREF_MODELS` names (`../shared/models` if it is not set), those
//! that are missing are skipped, and procedural ones. Pictures have 800 x 600 pixels, `f32`, lit by
//! a headlight. RMSE and SSIM are of R, G and B against the picture named in the title; where both
//! are background counts too. Off is the share of the pixels inside, whose neighbours are covered
//! too, of which R, G or B differs by more than 8/255 as sRGB. With `--pictures DIR` every picture is kept there.

mod common;

use common::models;
use common::report::{Arguments, Table};
use splatref::Result;
use splatref::frame::Exec;
use splatref::frame::image::{Image, Values};
use splatref::index::grouping::Grouping;
use splatref::index::grouping::{Extension, Rules};
use splatref::io::scene_file::SceneFile;
use splatref::io::srgb::from_linear;
use splatref::io::{exr, provenance};
use splatref::method::ewa;
use splatref::method::single_pass::{self, BinCount, DepthTest};
use splatref::method::transparent::{self, Holes};
use splatref::method::transparent_hq;
use splatref::method::{Method, Session, peeling};
use splatref::scene::{Camera, Groups, Scene};
use splatref::splat::Epsilon;
use splatref::verify::metrics::{Region, regions, summary};
use std::path::Path;
use std::time::Instant;

/// A scene before a camera.
struct Subject {
    name: String,
    scene: Scene,
    camera: Camera,
}

/// A picture, how long it took, and in how many groups.
struct Shot {
    image: Image,
    milliseconds: f64,
    groups: Option<usize>,
}

fn main() -> Result<()> {
    let bench = Bench { arguments: Arguments::parse()?, exec: Exec::new(0, 32)? };
    bench.figure_8_and_9(&bench.subjects(&OPAQUE)?)?;
    let transparent = bench.subjects(&TRANSPARENT)?;
    bench.figure_12_and_13(&transparent)?;
    bench.arcs(&transparent)
}

const OPAQUE: [&str; 4] = ["bunny", "dragon", "igea", "cluster"];
const TRANSPARENT: [&str; 5] = ["bunny", "dragon", "igea", "cluster", "balls"];

/// Fig. 13: opaque balls inside and around a transparent scan, whose table this goes on with.
const BALLS: &str = "
color = [0.4, 0.6, 0.8]
[[model]]
shape = \"cluster\"
count = 60000
[model.transform]
scale = 0.035
translate = [-0.02, 0.11, 0.0]
";

/// Epsilon in median radii, groups, how they are extended, and what holes are.
const VARIANTS: [(f32, usize, Extension, Holes); 9] = [
    (1.0, 4, ADD, Holes::Skipped),
    (2.0, 4, ADD, Holes::Skipped),
    (4.0, 4, ADD, Holes::Skipped),
    (2.0, 4, ADD, Holes::Background),
    (2.0, 4, Extension::None, Holes::Skipped),
    (2.0, 4, Extension::None, Holes::Background),
    (2.0, 4, Extension::Enlarge, Holes::Skipped),
    (2.0, 8, ADD, Holes::Skipped),
    (2.0, 8, Extension::Enlarge, Holes::Skipped),
];
const COLUMNS: [&str; 14] = [
    "scene",
    "epsilon",
    "K",
    "groups cover it by",
    "holes",
    "Algorithm 2: RMSE",
    "SSIM",
    "off, %",
    "ms",
    "Algorithm 3: RMSE",
    "SSIM",
    "off, %",
    "ms",
    "peeling: ms",
];
/// How many bins of depth.
const BINS: [BinCount; 9] = [
    BinCount::Count(4),
    BinCount::Count(8),
    BinCount::Count(16),
    BinCount::Count(32),
    BinCount::Count(64),
    BinCount::Count(128),
    BinCount::Count(256),
    BinCount::Count(512),
    BinCount::Epsilon,
];
const ADD: Extension = Extension::Add { most: 0.5 };

struct Bench {
    arguments: Arguments,
    exec: Exec,
}

impl Bench {
    /// The scenes of these names that contain the pattern, loaded; scans that are missing are
    /// skipped.
    fn subjects(&self, names: &[&str]) -> Result<Vec<Subject>> {
        let mut subjects = Vec::new();
        for name in names.iter().filter(|name| name.contains(&self.arguments.pattern)) {
            let model = models::path(if *name == "balls" { "bunny" } else { name });
            if *name != "cluster" && !model.exists() {
                self.arguments.without(&model)?;
                continue;
            }
            let file = match *name {
                "cluster" => "shape = \"cluster\"".to_owned(),
                _ => format!("file = \"{}\"\ndraw = \"points\"", model.display()),
            };
            let more = if *name == "balls" { BALLS } else { "" };
            let text =
                format!("[[model]]\n{file}\nopacity = 0.4\n{more}[camera]\nsize = [800, 600]\n");
            let file = SceneFile::parse(&text, Path::new("bench.toml"))?;
            let scene = file.load(&self.exec, &|_, _, _| ())?.scene;
            let camera = file.camera(&scene)?;
            subjects.push(Subject { name: (*name).to_owned(), scene, camera });
        }
        Ok(subjects)
    }

    /// Opaque: the single pass against 2+1 passes as c falls, with and without Voronoi depth.
    fn figure_8_and_9(&self, subjects: &[Subject]) -> Result<()> {
        println!("Fig. 8 and 9: the single pass against the picture of the 2+1 passes");
        let mut table = Table::new(&[
            "scene",
            "surfels",
            "c",
            "K",
            "plain: RMSE",
            "SSIM",
            "off, %",
            "ms",
            "Voronoi: RMSE",
            "SSIM",
            "off, %",
            "ms",
            "2+1: ms",
        ]);
        let splats = ewa::Settings::default();
        for subject in subjects {
            let truth = self.shoot(subject, "ewa", None, &Method::Ewa(splats))?;
            for c in [1.0, 0.8, 0.6, 0.4, 0.2] {
                let rules = Rules { overlap: c, opposite: true, coplanar: None };
                let grouping = Grouping { rules, count: None, extension: Extension::None };
                let mut cells = Vec::new();
                let mut k = None;
                for depth in [DepthTest::Plain, DepthTest::Voronoi(BinCount::Epsilon)] {
                    let method = Method::SinglePass(single_pass::Settings { splats, depth });
                    let kind = if depth == DepthTest::Plain { "plain" } else { "voronoi" };
                    match self.shoot(subject, &format!("{kind}-{c}"), Some(&grouping), &method) {
                        Ok(shot) => {
                            k = shot.groups;
                            cells.push(against(&shot, &truth));
                        }
                        Err(error) => cells.push(format!("{error} | | | ")),
                    }
                }
                table.row(&format!(
                    "{} | {} | {c} | {} | {} | {:.1}",
                    subject.name,
                    subject.scene.surfels.len(),
                    k.map_or_else(|| "-".into(), |k| k.to_string()),
                    cells.join(" | "),
                    truth.milliseconds
                ));
            }
        }
        table.publish_times(&self.arguments, "zp06.md", "opaque")
    }

    /// Transparent: Algorithms 2 and 3 against depth peeling with the same epsilon.
    fn figure_12_and_13(&self, subjects: &[Subject]) -> Result<()> {
        println!("Fig. 12 and 13 (`balls`): Algorithms 2 and 3 against the picture of peeling");
        let mut table = Table::new(&COLUMNS);
        for subject in subjects {
            let mut truth: Option<(f32, Shot)> = None;
            for (radii, count, extension, holes) in VARIANTS {
                let splats = ewa::Settings {
                    epsilon: Epsilon::MedianRadii(radii),
                    cull: false,
                    ..ewa::Settings::default()
                };
                if truth.as_ref().is_none_or(|(of, _)| *of != radii) {
                    let method = Method::Peeling(peeling::Settings { splats, layers: 64 });
                    let shot = self.shoot(subject, &format!("peeling-{radii}"), None, &method)?;
                    truth = Some((radii, shot));
                }
                let Some((_, peeled)) = &truth else { continue };
                let rules = Rules { overlap: 1.0, opposite: true, coplanar: None };
                let grouping = Grouping { rules, count: Some(count), extension };
                let mut cells = Vec::new();
                let mut k = 0;
                let layers =
                    transparent::Settings { splats, holes, ..transparent::Settings::default() };
                let behind = transparent_hq::Settings { layers, ..Default::default() };
                for (algorithm, method) in [(2, layers.into()), (3, behind.into())] {
                    let word = word(extension);
                    let name = format!("algorithm{algorithm}-{radii}-{count}-{word}-{holes:?}");
                    let shot = self.shoot(subject, &name, Some(&grouping), &method)?;
                    k = shot.groups.unwrap_or(0);
                    cells.push(against(&shot, peeled));
                }
                table.row(&format!(
                    "{} | {radii} r | {k} | {} | {} | {} | {:.0}",
                    subject.name,
                    word(extension),
                    format!("{holes:?}").to_lowercase(),
                    cells.join(" | "),
                    peeled.milliseconds
                ));
            }
        }
        table.publish_times(&self.arguments, "zp06.md", "transparent")
    }

    /// Algorithms 2 and 3 by the number of bins, against depth peeling: what is off.
    fn arcs(&self, subjects: &[Subject]) -> Result<()> {
        println!("What is off, %, by the number of depth bins");
        let titles = BINS.map(|bins| match bins {
            BinCount::Epsilon => "of epsilon".to_owned(),
            BinCount::Count(count) => count.to_string(),
        });
        let columns = ["scene", "algorithm"].into_iter().chain(titles.iter().map(String::as_str));
        let mut table = Table::new(&columns.collect::<Vec<_>>());
        let splats = ewa::Settings { cull: false, ..ewa::Settings::default() };
        let rules = Rules { overlap: 1.0, opposite: true, coplanar: None };
        let grouping = Grouping { rules, count: Some(4), extension: ADD };
        for subject in subjects {
            let method = Method::Peeling(peeling::Settings { splats, layers: 64 });
            let truth = self.image(subject, None, &method)?;
            let silent = |_: &str, _, _| ();
            let (groups, ..) = grouping.groups(&subject.scene.surfels, &self.exec, &silent)?;
            let mut rows = [const { Vec::new() }; 2];
            for bins in BINS {
                let layers = transparent::Settings { splats, bins, ..Default::default() };
                let behind = transparent_hq::Settings { layers, ..Default::default() };
                for (row, method) in rows.iter_mut().zip([layers.into(), behind.into()]) {
                    let image = self.image(subject, Some(groups.clone()), &method)?;
                    row.push(format!("{:.1}", off(&image, &truth)));
                }
            }
            for (algorithm, row) in (2..).zip(rows) {
                table.row(&format!("{} | {algorithm} | {}", subject.name, row.join(" | ")));
            }
        }
        table.publish(&self.arguments, "zp06.md", "arcs")
    }

    /// A picture alone.
    fn image(&self, subject: &Subject, groups: Option<Groups>, method: &Method) -> Result<Image> {
        let mut session = Session::with_groups(&subject.scene, *method, groups, &self.exec)?;
        Ok(Image::from(&session.render(&subject.camera)?.frame))
    }

    /// Draws a picture, and again five times for the median of the time.
    fn shoot(
        &self,
        subject: &Subject,
        name: &str,
        grouping: Option<&Grouping>,
        method: &Method,
    ) -> Result<Shot> {
        let Subject { scene, camera, .. } = subject;
        let groups = grouping
            .map(|grouping| grouping.groups(&scene.surfels, &self.exec, &|_, _, _| ()))
            .transpose()?;
        let groups = groups.map(|(groups, ..)| groups);
        let mut session = Session::with_groups(scene, *method, groups, &self.exec)?;
        let image = Image::from(&session.render(camera)?.frame);
        let mut times = Vec::new();
        for _ in 0..5 {
            let start = Instant::now();
            session.render(camera)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        if let Some(folder) = &self.arguments.pictures {
            let path = folder.join(format!("{}-{name}.exr", subject.name));
            let text =
                provenance::text(scene, session.groups(), camera, method, Default::default());
            exr::write(&path, &session.render(camera)?.frame, &text)?;
        }
        Ok(Shot {
            image,
            milliseconds: times[times.len() / 2],
            groups: session.groups().map(Groups::len),
        })
    }
}

/// RMSE, SSIM, what is off, and time of a picture against another.
fn against(shot: &Shot, truth: &Shot) -> String {
    match summary(&shot.image, &truth.image) {
        Some(found) => format!(
            "{:.4} | {} | {:.1} | {:.1}",
            found.rmse,
            found.ssim.map_or_else(|| "-".into(), |ssim| format!("{ssim:.4}")),
            off(&shot.image, &truth.image),
            shot.milliseconds
        ),
        None => "- | - | - | -".into(),
    }
}

/// Pixels of the truth's inside of which R, G or B is more than 8/255 off as sRGB, per cent.
fn off(picture: &Image, truth: &Image) -> f64 {
    let channel = |image: &Image, name: &str| match image.channel(name) {
        Some(Values::Float(values)) => values.clone(),
        _ => Vec::new(),
    };
    let stored = |image: &Image| {
        let of = |name| channel(image, name).iter().map(|x| from_linear(f64::from(*x))).collect();
        ["R", "G", "B"].map(of)
    };
    let (a, b): ([Vec<f64>; 3], [Vec<f64>; 3]) = (stored(picture), stored(truth));
    let all = regions(&channel(truth, "A"), truth.width as usize);
    let inside = |i: &usize| all[*i] == Region::Interior;
    let pixels: Vec<usize> = (0..all.len()).filter(inside).collect();
    let differs = |i: &&usize| (0..3).any(|c| (a[c][**i] - b[c][**i]).abs() > 8.0 / 255.0);
    1e2 * pixels.iter().filter(differs).count() as f64 / pixels.len().max(1) as f64
}

fn word(extension: Extension) -> &'static str {
    match extension {
        Extension::None => "none",
        Extension::Add { .. } => "add",
        Extension::Enlarge => "enlarge",
    }
}
