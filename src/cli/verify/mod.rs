//! `splatref verify`: decides whether a correct implementation can produce the planes of a client.

use super::options::{ExecOptions, SceneOptions};
use super::words::quoted;
use super::{Ended, Ending, draw, output, progress, region, say};
use splatref::frame::{Exec, Frame, Rect, Samples};
use splatref::io::client::Description;
use splatref::io::replace::Pending;
use splatref::io::scene_file::{FileKind, Number, OutputSettings, Ready, SceneFile};
use splatref::io::{exr, provenance};
use splatref::method::Session;
use splatref::report::VerdictReport;
use splatref::report::page::{self, Report};
use splatref::scene::Camera;
use splatref::setting::Words;
use splatref::verdict::Verdict;
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::{Client, Rounding};
use splatref::{Error, Result};
use std::io::Write;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
Hand in an EXR whose planes have the names that `render --stages` writes; `splatref info` lists them. The
more planes you hand in, the sharper the verdict. Each stage is judged from the client's own planes of
the stage before: a value is right if an implementation that rounds as promised can produce it. If you
computed in f64 and stored f32, add --number f64: the verdict then allows for that rounding too.

Examples:
  splatref render sphere --stages -o out/mine.exr && splatref verify sphere out/mine.exr
  splatref verify scene.toml gpu.exr --promise ieee -o out/errors.exr --json out/verdict.json
  splatref verify scene.toml part.exr --region 0,0,512,256
  splatref verify scene.toml gpu.toml --report out/verdict.html
  splatref verify scene.toml blender.exr --channels RGB=ViewLayer.Combined

The documentation of splatref::io::client describes the TOML file.

Exit codes: 0 right, 1 wrong, 2 could not be judged, 3 undecidable: too many sums are undecided, or a
plane was handed in without the planes that it follows from, 4 right in each pixel, but the errors
together are unlike those of any right renderer that was tried; with --strict that is 1.")]
pub(super) struct Args {
    /// The scene, as for render
    scene: PathBuf,
    /// The client's planes: an .exr, or a .toml that says what is in which file
    client: PathBuf,
    /// Take a plane from channels of another name, such as RGB=ViewLayer.Combined; repeatable
    #[arg(long, value_name = "PLANE=CHANNEL", value_parser = super::compare::channels)]
    channels: Vec<(String, String)>,
    /// Judge only the columns from X0 up to X1 and the rows from Y0 up to Y1, X1 and Y1 excluded
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = region::region, allow_hyphen_values = true)]
    region: Option<Rect>,
    /// Set how precise the client's operations are: gpu, as shading languages guarantee; precise,
    /// sums and products round once, in the written order; ieee, each operation rounds once
    /// [default: from the .toml, else gpu]
    #[arg(long, value_name = "gpu|precise|ieee", value_parser = rounding)]
    promise: Option<Rounding>,
    /// Report "undecidable" if more than this fraction of the pixels has undecided sums
    #[arg(long, value_name = "X", default_value_t = Verdict::BUDGET, value_parser = share)]
    budget: f64,
    /// Exit with 1 also if the picture is right, but unlike that of any right renderer
    #[arg(long)]
    strict: bool,
    /// Write, for each stage, the errors in bounds and the mask of undecided pixels
    #[arg(short, long, value_name = "FILE.exr")]
    output: Option<PathBuf>,
    /// Write the verdict as JSON
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
    /// Do not look for the mistake behind a wrong picture, which may take about as long as the verdict
    #[arg(long)]
    no_cause: bool,
    /// Write a page that shows each stage, its errors and the worst pixels in a browser
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

/// An error that prevents a verdict exits with 2, because it is no verdict.
pub(super) fn run(args: &Args) -> Ended {
    judge(args).map_err(|error| Error::Usage(error.to_string()))
}

fn judge(args: &Args) -> Ended {
    let file = args.options.scene_file(&args.scene)?;
    file.output.check_kept("a client's storage is described beside its planes")?;
    let exec = args.exec.exec()?;
    let described = Description::open(&args.client)?.with_channels(&args.channels);
    check(args, &file, &described)?;
    let ready = draw::ready(&file, &exec)?;
    let camera = &ready.camera;
    args.check_region(&ready)?;
    let (mut session, _) = draw::session(&ready, &args.options, &exec)?;
    session.set_region(args.region)?;
    let number = file.output.number;
    let client = progress::during("reading", || {
        read(&described, args.promise, number, camera, &session, &exec)
    })?;
    let (verdict, likely) = progress::during("judging", || -> Result<_> {
        let verdict = session.verify(camera, &client, args.budget)?;
        let likely = match args.no_cause {
            true => None,
            false => likely_cause(&session, camera, &client, &verdict)?,
        };
        Ok((verdict, likely))
    })?;
    let replay = |pixel| args.replay(pixel);
    let report = VerdictReport::new(&session, camera, &client, &verdict, likely, &replay)?;
    progress::during("writing", || {
        let page = || report.page(&session, camera, number, &exec);
        write(args, &report, || errors(camera, &verdict), page, &exec)
    })?;
    report.lines().iter().for_each(say);
    Ok(Ending::from(verdict.outcome()).or_strict(args.strict))
}

/// Writes the requested files; all are complete before any replaces an old file.
fn write(
    args: &Args,
    report: &VerdictReport<'_>,
    errors: impl FnOnce() -> Result<Frame<f32>>,
    page: impl FnOnce() -> Result<Report>,
    exec: &Exec,
) -> Result<()> {
    let compression = OutputSettings::default().compression;
    let picture = match &args.output {
        Some(path) => Some(exr::pending(path, &errors()?, "", compression, exec)?),
        None => None,
    };
    let json = match &args.json {
        Some(path) => {
            let text = report.json()?;
            Some(Pending::write(path, |file| file.write_all(text.as_bytes()))?)
        }
        None => None,
    };
    let page = match &args.report {
        Some(path) => Some(page::pending(path, &page()?, exec)?),
        None => None,
    };
    picture.into_iter().chain(json).chain(page).try_for_each(Pending::put)
}

/// Refuses wrong options before anything is loaded.
fn check(args: &Args, file: &SceneFile, described: &Description) -> Result<()> {
    let outputs: Vec<&PathBuf> = args.output.iter().chain(&args.json).chain(&args.report).collect();
    for (i, path) in outputs.iter().enumerate() {
        outputs[..i].iter().try_for_each(|other| output::check_two(other, path))?;
        output::check(path, &args.scene, file)?;
        output::check_other(path, &args.client)?;
        described.files().try_for_each(|read| output::check_other(path, read))?;
    }
    if let Some(path) = &args.output
        && !matches!(FileKind::from_extension(path), Ok(FileKind::Exr))
    {
        let path = path.display();
        return Err(Error::Usage(format!(
            "{path}: the errors are written as an EXR; give a name that ends in .exr"
        )));
    }
    Ok(())
}

/// Reads the planes of a client; `promise` replaces the promise in its description. A client that
/// computes in f64 rounds what it stores once more.
pub(super) fn read(
    described: &Description,
    promise: Option<Rounding>,
    number: Number,
    camera: &Camera,
    session: &Session<'_>,
    exec: &Exec,
) -> Result<Client> {
    let mut client = described.client(session.method().stages(), camera.size(), exec)?;
    client.rounding = promise.unwrap_or(client.rounding);
    Ok(match number {
        Number::F32 => client,
        Number::F64 => client.rounded(),
    })
}

/// The errors of each stage in bounds, and the mask of undecided pixels.
fn errors(camera: &Camera, verdict: &Verdict) -> Result<Frame<f32>> {
    let mut frame = Frame::new(camera.width, camera.height);
    for stage in &verdict.stages {
        frame.push(&format!("{}.error", stage.stage), Samples::Scalar(stage.errors.clone()))?;
        frame.push(&format!("{}.doubts", stage.stage), Samples::Count(stage.doubts.clone()))?;
    }
    Ok(frame)
}

/// Parses the word of a promise.
pub(super) fn rounding(text: &str) -> std::result::Result<Rounding, String> {
    Rounding::named(text).ok_or_else(|| "give gpu, precise or ieee".into())
}

/// Parses a fraction of pixels.
pub(super) fn share(text: &str) -> std::result::Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "give a fraction from 0 to 1".into())
}

impl Args {
    /// Checks the region. Without one, warns of a file that holds a part of the picture.
    fn check_region(&self, Ready { camera, method, .. }: &Ready) -> Result<()> {
        if let Some(region) = &self.region {
            method.check_alone()?;
            return camera.check_region(region);
        }
        if !matches!(FileKind::from_extension(&self.client), Ok(FileKind::Exr)) {
            return Ok(());
        }
        let header = exr::read_header(&self.client)?;
        provenance::check_finished(&self.client, header.text.as_deref())?;
        if let Some(data) = header.data.filter(|data| *data != Rect::of_size(camera.size()))
            && [header.width, header.height] == camera.size()
        {
            let (place, part) = (self.client.display(), region::words(data));
            super::warn(&[format!(
                "{place}: holds only the pixels of --region {part}, and the others are judged as empty; \
                 give --region {part} to judge these alone"
            )]);
        }
        Ok(())
    }

    /// The command that explains a pixel, with all options of this command that `explain` takes.
    fn replay(&self, (x, y): (u32, u32)) -> String {
        let mut words = vec!["splatref explain".to_owned(), quoted(self.scene.as_os_str())];
        words.extend([x.to_string(), y.to_string()]);
        words.extend(["--client".to_owned(), quoted(self.client.as_os_str())]);
        let flags = ["--strict", "--no-cause"];
        let files = ["-o", "--output", "--json", "--report"];
        let own = [&files[..], &["--budget", "--region"], &flags].concat();
        let mut paths = vec![self.scene.as_os_str(), self.client.as_os_str()];
        let mut given = std::env::args_os().skip(1).skip_while(|word| word != "verify").skip(1);
        while let Some(word) = given.next() {
            let text = word.to_string_lossy();
            let name = text.split_once('=').map_or(&*text, |(name, _)| name);
            // A short option may have its value attached.
            let attached = text.starts_with("-o") && text.len() > "-o".len();
            if attached || own.contains(&name) {
                if name == text && !attached && !flags.contains(&name) {
                    given.next();
                }
            } else if let Some(place) = paths.iter().position(|path| *path == word) {
                paths.remove(place);
            } else {
                words.push(quoted(&word));
            }
        }
        words.join(" ")
    }
}
