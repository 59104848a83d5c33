//! The depth bins of \[ZP06, 4.2.1\]: what is visibly off depth peeling by their number and by where they begin, of
//! five scenes; and of the default number in three sizes. It is why [`BinCount::Epsilon`] and
//! [`BinEdges::Staggered`] are the defaults.
//!
//! `cargo bench --bench bins` prints Markdown tables, and with `--write` puts them into `docs/zp06.md`; an argument
//! is a pattern that the names of scenes must contain. Scenes are the scans in the folder that
//! `SPLATREF_MODELS` names (`../shared/models` if it is not set), those that are missing are skipped, and
//! procedural ones. Pictures are `f32`, lit by a headlight, opacity 0.4.

mod common;

use common::models;
use common::report::{Arguments, Table};
use splatref::Result;
use splatref::compare::metrics::visible;
use splatref::frame::{Exec, Frame};
use splatref::index::grouping::{Extension, Grouping, Rules};
use splatref::io::scene_file::SceneFile;
use splatref::method::ewa;
use splatref::method::single_pass::BinCount;
use splatref::method::transparent::{self, BinEdges};
use splatref::method::transparent_hq;
use splatref::method::{Method, Session, peeling};
use splatref::scene::{Camera, Groups, Scene};
use std::path::Path;

/// A scene before a camera.
struct Subject {
    name: String,
    scene: Scene,
    camera: Camera,
}

fn main() -> Result<()> {
    let bench = Bench { arguments: Arguments::parse()?, exec: Exec::new(0, 32)? };
    let [_, middle, _] = SIZES;
    bench.arcs(&bench.subjects(middle)?)?;
    bench.sizes()
}

const SCENES: [&str; 5] = ["bunny", "dragon", "igea", "cluster", "balls"];

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
const SIZES: [[u32; 2]; 3] = [[400, 300], [800, 600], [1600, 1200]];
const EDGES: [(&str, BinEdges); 2] =
    [("common", BinEdges::Common), ("staggered", BinEdges::Staggered)];
const SPLATS: ewa::Settings = ewa::Settings::BOTH_SIDES;
const ADD: Extension = Extension::Add { most: 0.5 };

struct Bench {
    arguments: Arguments,
    exec: Exec,
}

impl Bench {
    /// The scenes whose names contain the pattern, loaded; scans that are missing are skipped.
    fn subjects(&self, [width, height]: [u32; 2]) -> Result<Vec<Subject>> {
        let mut subjects = Vec::new();
        for name in SCENES.iter().filter(|name| name.contains(&self.arguments.pattern)) {
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
            let text = format!(
                "[[model]]\n{file}\nopacity = 0.4\n{more}[camera]\nsize = [{width}, {height}]\n"
            );
            let file = SceneFile::parse(&text, Path::new("bench.toml"))?;
            let scene = file.load(&self.exec, &|_, _, _| ())?.scene;
            let camera = file.camera(&scene)?;
            subjects.push(Subject { name: (*name).to_owned(), scene, camera });
        }
        Ok(subjects)
    }

    /// Algorithms 2 and 3 by the number of bins, against depth peeling: what is off.
    fn arcs(&self, subjects: &[Subject]) -> Result<()> {
        println!("What is off, %, by the number of depth bins");
        let titles = BINS.map(|bins| match bins {
            BinCount::Epsilon => "from epsilon".to_owned(),
            BinCount::Count(count) => count.to_string(),
        });
        let columns =
            ["scene", "algorithm", "edges"].into_iter().chain(titles.iter().map(String::as_str));
        let mut table = Table::new(&columns.collect::<Vec<_>>());
        for subject in subjects {
            let off = self.off(subject, &BINS)?;
            rows(&mut table, subject, &off);
        }
        table.publish(&self.arguments, "zp06.md", "arcs")
    }

    /// The same of the bins of epsilon by the size of the picture.
    fn sizes(&self) -> Result<()> {
        println!("What is off, %, by the size of the picture");
        let titles = SIZES.map(|[width, height]| format!("{width} x {height}"));
        let columns =
            ["scene", "algorithm", "edges"].into_iter().chain(titles.iter().map(String::as_str));
        let mut table = Table::new(&columns.collect::<Vec<_>>());
        let mut all: Vec<(Subject, Off)> = Vec::new();
        for size in SIZES {
            for (i, subject) in self.subjects(size)?.into_iter().enumerate() {
                let off = self.off(&subject, &[BinCount::Epsilon])?;
                match all.get_mut(i) {
                    Some((_, before)) => before.iter_mut().zip(off).for_each(|(b, o)| b.extend(o)),
                    None => all.push((subject, off)),
                }
            }
        }
        for (subject, off) in &all {
            rows(&mut table, subject, off);
        }
        table.publish(&self.arguments, "zp06.md", "arcs-sizes")
    }

    /// What is off by each number of bins: Algorithm 2 and then 3, each by common and by staggered edges.
    fn off(&self, subject: &Subject, counts: &[BinCount]) -> Result<Off> {
        let rules = Rules { overlap: 1.0, opposite: true, coplanar: None };
        let grouping = Grouping { rules, count: Some(4), extension: ADD };
        let method = Method::Peeling(peeling::Settings { splats: SPLATS, layers: 64 });
        let truth = self.image(subject, None, &method)?;
        let silent = |_: &str, _, _| ();
        let (groups, ..) = grouping.groups(&subject.scene.surfels, &self.exec, &silent)?;
        let mut off = Off::default();
        for (place, (_, bin_edges)) in EDGES.into_iter().enumerate() {
            for &bins in counts {
                let layers = transparent::Settings {
                    splats: SPLATS,
                    bins,
                    bin_edges,
                    ..transparent::Settings::default()
                };
                let behind = transparent_hq::Settings { layers, ..Default::default() };
                for (algorithm, method) in [layers.into(), behind.into()].into_iter().enumerate() {
                    let image = self.image(subject, Some(groups.clone()), &method)?;
                    off[2 * algorithm + place].push(visible(&image, &truth)?);
                }
            }
        }
        Ok(off)
    }

    /// A picture alone.
    fn image(
        &self,
        subject: &Subject,
        groups: Option<Groups>,
        method: &Method,
    ) -> Result<Frame<f32>> {
        let mut session = Session::with_groups(&subject.scene, *method, groups, &self.exec)?;
        Ok(session.render(&subject.camera)?.frame.clone())
    }
}

/// Rows of numbers: Algorithm 2 by each of [`EDGES`], then Algorithm 3.
type Off = [Vec<f64>; 4];

/// The rows of a scene.
fn rows(table: &mut Table, subject: &Subject, off: &Off) {
    for (place, row) in off.iter().enumerate() {
        let (algorithm, (edges, _)) = (2 + place / 2, EDGES[place % 2]);
        let row: Vec<_> = row.iter().map(|off| format!("{off:.1}")).collect();
        table.row(&format!("{} | {algorithm} | {edges} | {}", subject.name, row.join(" | ")));
    }
}
