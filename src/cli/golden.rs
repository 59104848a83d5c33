//! `splatref golden`: reproduces the pictures under `golden/` bit for bit, or blesses them.

use super::options::ExecOptions;
use super::{Ended, Ending, draw, say};
use splatref::compare::digest;
use splatref::compare::{Comparison, Criteria, Relation, Verdict, compare};
use splatref::frame::image::{Image, Values};
use splatref::frame::{Exec, Frame, Plane, Samples};
use splatref::index::seen::Seen;
use splatref::io::exr::{self, Compression};
use splatref::io::scene_file::{Ready, SceneFile};
use splatref::io::{png, provenance};
use splatref::method::Picture;
use splatref::{Error, Result};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
A case is a scene NAME.toml and its picture NAME.exr in one folder.

Examples:
  splatref golden
  splatref golden ewa_raycast_sheets --threads 1 --tile 8
  splatref golden --bless

Exit codes: 0 all equal, 1 any different or blessed, 2 wrong usage.")]
pub(super) struct Args {
    /// The cases to check; without names, all of them
    names: Vec<String>,
    /// Overwrite pictures that differ or are missing; the exit code is still 1
    #[arg(long)]
    bless: bool,
    /// Read the cases from this folder
    #[arg(long, value_name = "PATH", default_value = "golden")]
    dir: PathBuf,
    #[command(flatten)]
    exec: ExecOptions,
}

/// One case, and its rendered picture.
struct Case {
    scene: PathBuf,
    picture: PathBuf,
    text: String,
    frame: Frame<f32>,
}

pub(super) fn run(args: &Args) -> Ended {
    let exec = args.exec.exec()?;
    let names = names(&args.dir, &args.names)?;
    let mut rendered = Vec::new();
    let mut equal = 0;
    for name in &names {
        match check(args, &exec, name) {
            Ok((image, is_equal)) => {
                equal += usize::from(is_equal);
                rendered.push((name.as_str(), image));
            }
            // A case that cannot be rendered counts as different; the other cases still run.
            Err(error) => say(format!("different  {name}: {error}")),
        }
    }
    let different = names.len() - equal;
    say(format!("{equal} equal, {different} different"));
    say(format!("sha256 {}", digest::sha256(rendered.iter().map(|(name, image)| (*name, image)))));
    Ok(if different == 0 { Ending::Good } else { Ending::Different })
}

/// The cases of a directory, sorted by name. A picture without a scene counts as a case too.
fn names(dir: &Path, wanted: &[String]) -> Result<Vec<String>> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(dir).map_err(|source| Error::io(dir, source))? {
        let path = entry.map_err(|source| Error::io(dir, source))?.path();
        let is_part = path.extension().is_some_and(|e| e == "toml" || e == "exr");
        if let Some(name) = path.file_stem().and_then(|name| name.to_str()).filter(|_| is_part) {
            found.insert(name.to_owned());
        }
    }
    if found.is_empty() {
        return Err(Error::format(dir, "no case is here; add a scene NAME.toml"));
    }
    if let Some(unknown) = wanted.iter().find(|name| !found.contains(*name)) {
        return Err(Error::Usage(format!(
            "{}: no case is called {unknown}; leave out the names to check all cases",
            dir.display()
        )));
    }
    Ok(found.into_iter().filter(|name| wanted.is_empty() || wanted.contains(name)).collect())
}

/// Renders a case, prints the outcome, and returns the picture and whether it is equal.
fn check(args: &Args, exec: &Exec, name: &str) -> Result<(Image, bool)> {
    let case = render(&args.dir, exec, name)?;
    let actual = Image::from(&case.frame);
    let stored = match fs::exists(&case.picture) {
        Ok(false) => Err("there is no picture yet; --bless writes it".to_owned()),
        _ => exr::read_with(&case.picture, exec).map_err(|error| error.to_string()),
    };
    let exact = Criteria::default();
    let report = match &stored {
        Ok(stored) => Ok(compare(stored, &actual, &exact)?),
        Err(why) => Err(why),
    };
    if report.as_ref().is_ok_and(|report| report.verdict() == Verdict::Equal) {
        say(format!("equal      {name}"));
        return Ok((actual, true));
    }
    match &report {
        Ok(report) => differences(name, &case, report),
        Err(why) => say(format!("different  {name}: {why}")),
    }
    if args.bless {
        // A golden is kept for long, so a small file is worth the time.
        exr::pending(&case.picture, &case.frame, &case.text, Compression::Zip, exec)?.put()?;
        say(format!("  blessed: wrote {}", case.picture.display()));
    } else {
        keep(name, &case, stored.as_ref().ok())?;
    }
    Ok((actual, false))
}

/// Draws a golden. For a sequence this is the last frame, after all frames before it.
fn render(dir: &Path, exec: &Exec, name: &str) -> Result<Case> {
    let (scene, picture) = (dir.join(format!("{name}.toml")), dir.join(format!("{name}.exr")));
    let file = SceneFile::read(&scene)?;
    let mut ready = draw::ready(&file, exec)?;
    let mut seen = None;
    for frame in 0..file.frame_count() - 1 {
        ready = ready.at(frame, exec)?;
        seen = picture_of(&ready, seen, &file, exec)?.0.seen;
    }
    ready = ready.at(file.frame_count() - 1, exec)?;
    let (drawn, text) = picture_of(&ready, seen, &file, exec)?;
    Ok(Case { scene, picture, text, frame: drawn.frame })
}

/// The picture of a frame, given the state after the previous frame, and the text of its file.
fn picture_of(
    ready: &Ready,
    seen: Option<Seen>,
    file: &SceneFile,
    exec: &Exec,
) -> Result<(Picture<f32>, String)> {
    let Ready { loaded, camera, method, .. } = ready;
    let (mut session, _) = ready.session(exec, &|_, _, _| ())?;
    session.resume(seen);
    let drawn = file.output.draw(&mut session, camera)?.into_owned();
    let (groups, output) = (session.groups(), file.output);
    Ok((drawn, provenance::text(&loaded.scene, groups, camera, method, output)))
}

/// Prints the first planes that differ, and the command that explains the first pixel.
fn differences(name: &str, case: &Case, report: &Comparison) {
    let lines = report.lines();
    let (verdict, planes) = lines.split_last().map_or(("", [].as_slice()), |(v, p)| (v, p));
    say(format!("different  {name}: {}", verdict.trim_start_matches("different: ")));
    let different = |i: &usize| report.channels[*i].verdict() != Some(Verdict::Equal);
    for i in (0..planes.len()).filter(different).take(4) {
        say(format!("  {}", planes[i]));
    }
    let pixel = report.channels.iter().find_map(|channel| match &channel.relation {
        Relation::Values(values) => values.first,
        _ => None,
    });
    if let Some(at) = pixel {
        say(format!("  splatref explain {} {} {}", case.scene.display(), at.x, at.y));
    }
}

/// Writes the expected and the actual picture, so that you can look at both.
fn keep(name: &str, case: &Case, stored: Option<&Image>) -> Result<()> {
    let folder = Path::new("out").join("golden");
    fs::create_dir_all(&folder).map_err(|source| Error::io(&folder, source))?;
    let place = |what: &str| folder.join(format!("{name}.{what}"));
    exr::write(&place("actual.exr"), &case.frame, &case.text)?;
    png::write_frame(&place("actual.png"), &case.frame)?;
    if let Some(stored) = stored {
        let to = place("expected.exr");
        fs::copy(&case.picture, &to).map_err(|source| Error::io(&to, source))?;
        png::write_frame(&place("expected.png"), &preview(stored)?)?;
    }
    say(format!("  see {}", folder.join(format!("{name}.*")).display()));
    Ok(())
}

/// The colour and the coverage of a stored picture, if it has them.
fn preview(image: &Image) -> Result<Frame<f32>> {
    let (width, height) = (image.width, image.height);
    let channel = |name: &str| match image.channel(name) {
        Some(Values::Float(values)) => Some(values.clone()),
        _ => None,
    };
    let mut frame = Frame::new(width, height);
    if let (Some(r), Some(g), Some(b)) = (channel("R"), channel("G"), channel("B")) {
        let color = (0..r.len()).map(|i| [r[i], g[i], b[i]]).collect();
        frame.push("", Samples::Color(Plane::from_values(width, height, color)))?;
    }
    if let Some(alpha) = channel("A") {
        frame.push("A", Samples::Scalar(Plane::from_values(width, height, alpha)))?;
    }
    Ok(frame)
}
