//! The depth bins of \[ZP06, 4.2.1\]: what is visibly off depth peeling by their number, of five scenes. It is why
//! [`BinCount::Epsilon`] is the default.
//!
//! `cargo bench --bench bins` prints a Markdown table, and with `--write` puts it into `docs/zp06.md`; an argument
//! is a pattern that the names of scenes must contain. Scenes are the scans in the folder that
//! `SPLATREF_MODELS` names (`../shared/models` if it is not set), those that are missing are skipped, and
//! procedural ones. Pictures have 800 x 600 pixels, `f32`, lit by a headlight, opacity 0.4.

mod common;

use common::models;
use common::report::{Arguments, Table};
use splatref::Result;
use splatref::frame::{Exec, Frame};
use splatref::index::grouping::{Extension, Grouping, Rules};
use splatref::io::scene_file::SceneFile;
use splatref::method::ewa;
use splatref::method::single_pass::BinCount;
use splatref::method::transparent;
use splatref::method::transparent_hq;
use splatref::method::{Method, Session, peeling};
use splatref::scene::{Camera, Groups, Scene};
use splatref::verify::metrics::visible;
use std::path::Path;

/// A scene before a camera.
struct Subject {
    name: String,
    scene: Scene,
    camera: Camera,
}

fn main() -> Result<()> {
    let bench = Bench { arguments: Arguments::parse()?, exec: Exec::new(0, 32)? };
    bench.arcs(&bench.subjects()?)
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
const ADD: Extension = Extension::Add { most: 0.5 };

struct Bench {
    arguments: Arguments,
    exec: Exec,
}

impl Bench {
    /// The scenes whose names contain the pattern, loaded; scans that are missing are skipped.
    fn subjects(&self) -> Result<Vec<Subject>> {
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
            let text =
                format!("[[model]]\n{file}\nopacity = 0.4\n{more}[camera]\nsize = [800, 600]\n");
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
                    row.push(format!("{:.1}", visible(&image, &truth)?));
                }
            }
            for (algorithm, row) in (2..).zip(rows) {
                table.row(&format!("{} | {algorithm} | {}", subject.name, row.join(" | ")));
            }
        }
        table.publish(&self.arguments, "zp06.md", "arcs")
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
