//! `splatref verify`: whether a right implementation may have left somebody's planes.

pub(super) mod report;

use super::options::{ExecOptions, SceneOptions};
use super::{Ended, Ending, draw, output, progress, say};
use splatref::frame::{Exec, Frame, Samples};
use splatref::io::client::Description;
use splatref::io::exr;
use splatref::io::replace::Pending;
use splatref::io::scene_file::{FileKind, OutputSettings, SceneFile};
use splatref::method::Session;
use splatref::scene::Camera;
use splatref::setting::Word;
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Outcome, Verdict};
use splatref::{Error, Result};
use std::io::Write;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
The planes of an EXR are found by the names that `render --stages` gives them (see `splatref info` of
such a file); the more of them, the sharper. Each stage is judged from what the client has of the
stage before: its interval is what an implementation may leave whose operations round as promised.

Examples:
  splatref render sphere --stages -o out/mine.exr && splatref verify sphere out/mine.exr
  splatref verify scene.toml gpu.exr --promise ieee -o out/errors.exr --json out/verdict.json
  splatref verify scene.toml gpu.toml

The TOML file is described in the documentation of splatref::io::client.

Exit codes: 0 right, 1 wrong, 2 could not be judged, 3 undecidable: no plane is judged, or too many
sums may be either way.")]
pub(super) struct Args {
    /// The scene, as for render
    scene: PathBuf,
    /// What the client drew: an .exr, or a .toml that says what is in which file
    client: PathBuf,
    /// What the client promises of its operations: gpu, what shading languages publish; ieee, one
    /// rounding each, to nearest [default: what the .toml says, else gpu]
    #[arg(long, value_name = "gpu|ieee", value_parser = rounding)]
    promise: Option<Rounding>,
    /// The greatest share of pixels with undecided sums of which a picture is judged
    #[arg(long, value_name = "X", default_value_t = Verdict::BUDGET, value_parser = share)]
    budget: f64,
    /// Where the errors go, in bounds, and the mask of what is undecided, a plane a stage
    #[arg(short, long, value_name = "FILE.exr")]
    output: Option<PathBuf>,
    /// Where the verdict goes for other programs
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

/// Whatever keeps a client from being judged is no verdict on it.
pub(super) fn run(args: &Args) -> Ended {
    judge(args).map_err(|error| Error::Usage(error.to_string()))
}

fn judge(args: &Args) -> Ended {
    let file = args.options.scene_file(&args.scene)?;
    file.output.check_kept("how a client stores planes is said beside them")?;
    let exec = args.exec.exec()?;
    let described = Description::open(&args.client)?;
    check(args, &file, &described)?;
    let ready = draw::ready(&file, &exec)?;
    let (session, _) = draw::session(&ready, &args.options, &exec)?;
    let camera = &ready.camera;
    let client =
        progress::during("reading", || read((&described, args.promise), &session, camera, &exec))?;
    let (verdict, likely) = progress::during("judging", || -> Result<_> {
        let verdict = session.verify(camera, &client, args.budget)?;
        let likely = likely_cause(&session, camera, &client, &verdict)?;
        Ok((verdict, likely))
    })?;
    let seen = report::Seen::new(&session, camera, (&verdict, likely))?;
    progress::during("writing", || {
        write(args, (&seen, &client), || errors(camera, &verdict), &exec)
    })?;
    seen.lines(args, &client).iter().for_each(say);
    Ok(match verdict.outcome() {
        Outcome::Right => Ending::Good,
        Outcome::Wrong => Ending::Different,
        Outcome::Undecidable => Ending::Undecidable,
    })
}

/// Writes the files that are asked for, both before one is put in its place.
fn write(
    args: &Args,
    (seen, client): (&report::Seen<'_>, &Client),
    errors: impl FnOnce() -> Result<Frame<f32>>,
    exec: &Exec,
) -> Result<()> {
    let compression = OutputSettings::default().compression;
    let picture = match &args.output {
        Some(path) => Some(exr::pending(path, &errors()?, "", compression, exec)?),
        None => None,
    };
    let json = match &args.json {
        Some(path) => {
            let text = seen.json(client)?;
            Some(Pending::write(path, |file| file.write_all(text.as_bytes()))?)
        }
        None => None,
    };
    picture.into_iter().chain(json).try_for_each(Pending::put)
}

/// What is refused before anything is loaded.
fn check(args: &Args, file: &SceneFile, described: &Description) -> Result<()> {
    for path in args.output.iter().chain(&args.json) {
        output::check(path, &args.scene, file)?;
        output::check_other(path, &args.client)?;
        described.files().try_for_each(|read| output::check_other(path, read))?;
    }
    if let (Some(errors), Some(json)) = (&args.output, &args.json) {
        output::check_two(errors, json)?;
    }
    if let Some(path) = &args.output
        && !matches!(FileKind::from_extension(path), Ok(FileKind::Exr))
    {
        let path = path.display();
        return Err(Error::Usage(format!("{path}: the errors are an EXR; give a name in .exr")));
    }
    Ok(())
}

/// The planes of a client, and what it promises if somebody says so.
pub(super) fn read(
    (described, promise): (&Description, Option<Rounding>),
    session: &Session<'_>,
    camera: &Camera,
    exec: &Exec,
) -> Result<Client> {
    let mut client = described.client(session.method().stages(), camera.size(), exec)?;
    client.rounding = promise.unwrap_or(client.rounding);
    Ok(client)
}

/// The errors of each stage in bounds, and what is undecided there.
fn errors(camera: &Camera, verdict: &Verdict) -> Result<Frame<f32>> {
    let mut frame = Frame::new(camera.width, camera.height);
    for stage in &verdict.stages {
        frame.push(&format!("{}.error", stage.stage), Samples::Scalar(stage.errors.clone()))?;
        frame.push(&format!("{}.doubts", stage.stage), Samples::Count(stage.doubts.clone()))?;
    }
    Ok(frame)
}

/// The word of a promise.
pub(super) fn rounding(text: &str) -> std::result::Result<Rounding, String> {
    let mut rounding = Rounding::default();
    if rounding.choose(text) { Ok(rounding) } else { Err("give gpu or ieee".into()) }
}

/// A share of pixels.
fn share(text: &str) -> std::result::Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "give a share from 0 to 1".into())
}

impl Args {
    /// The command that replays a pixel, with all options of this one that mean something there.
    fn replay(&self, (x, y): (u32, u32)) -> String {
        let mut words = vec!["splatref explain".to_owned(), quoted(&self.scene.to_string_lossy())];
        words.extend([x.to_string(), y.to_string()]);
        words.extend(["--client".to_owned(), quoted(&self.client.to_string_lossy())]);
        let own = ["-o", "--output", "--json", "--budget"];
        let mut paths = vec![self.scene.as_os_str(), self.client.as_os_str()];
        let mut given = std::env::args_os().skip(1).skip_while(|word| word != "verify").skip(1);
        while let Some(word) = given.next() {
            let text = word.to_string_lossy();
            let name = text.split_once('=').map_or(&*text, |(name, _)| name);
            // A short option may have its value attached.
            let attached = text.starts_with("-o") && text.len() > "-o".len();
            if attached || own.contains(&name) {
                if name == text && !attached {
                    given.next();
                }
            } else if let Some(place) = paths.iter().position(|path| *path == word) {
                paths.remove(place);
            } else {
                words.push(quoted(&text));
            }
        }
        words.join(" ")
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+@%".contains(c);
    if word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}
