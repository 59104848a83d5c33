//! `splatref render`: a scene into an EXR and a PNG.

use super::options::{ExecOptions, SceneOptions};
use super::rows::{OfFiles, RowOptions};
use super::{Ended, Ending, draw, output, progress, report};
use splatref::io::replace::Pending;
use splatref::io::scene_file::{FileKind, Ready, SceneFile};
use splatref::io::{exr, png, provenance};
use splatref::method::Picture;
use splatref::{Error, Result};
use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref render
  splatref render torus --count 5000 --outline raycast --stages
  splatref render tree --method pyramid
  splatref render bunny.ply --eye -1,2,3 --target 0,0.1,0 --fov 30 -o bunny.exr
  splatref render scene.toml --number f64 --epsilon 1.5r")]
pub(super) struct Args {
    /// A .ply, a scene .toml, or a shape: sphere, torus, checkerboard, sheets, staircase, cluster,
    /// or tree (with --method pyramid)
    #[arg(default_value = "cluster", hide_default_value = false)]
    scene: PathBuf,
    /// Where the EXR goes, the PNG beside it [default: out/NAME.exr]
    #[arg(short, long, value_name = "FILE.exr")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: RowOptions<OfFiles>,
    /// Render N times; print the minimum and the median of each stage
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

pub(super) fn run(args: &Args) -> Ended {
    let start = Instant::now();
    let mut file = args.options.scene_file(&args.scene)?;
    file.output = args.files.chosen.on(file.output, "the output")?;
    let exec = args.exec.exec()?;
    let picture = place(args, &file)?;
    let preview = picture.with_extension("png");
    let ready = draw::ready(&file, &exec)?;
    let (mut session, made) = draw::session(&ready, &exec)?;
    let loading = start.elapsed();
    let Ready { loaded, camera, method, .. } = &ready;
    let scene = &loaded.scene;
    // The picture may lie in the session.
    let groups = session.groups().cloned();

    let mut times = Vec::new();
    let drawing = progress::during("rendering", || -> Result<_> {
        for _ in 1..args.repeat {
            timed(&mut times, || draw::draw(&mut session, camera, file.output))?;
        }
        timed(&mut times, || draw::draw(&mut session, camera, file.output))
    })?;

    let writing = Instant::now();
    if args.output.is_none() {
        let folder = Path::new(FOLDER);
        fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    }
    progress::during("writing", || -> Result<()> {
        let frame = &drawing.frame;
        let text = || provenance::text(scene, groups.as_ref(), camera, method, file.output.number);
        let compression = file.output.compression;
        let (small, large) = exec.join(
            || png::pending_frame(&preview, frame),
            || exr::pending(&picture, frame, &text(), compression, &exec),
        );
        // Both are written before one is put in its place.
        let (small, large) = (small?, large?);
        large.put()?;
        small.map_or(Ok(()), Pending::put)
    })?;
    let (writing, tally) = (writing.elapsed(), drawing.tally);
    drop(drawing);

    report::scene(loaded);
    report::camera(camera);
    report::picture(camera, file.output);
    report::method(method, scene, camera);
    report::groups(session.groups(), made.as_ref());
    report::tally(&tally);
    print_times(&exec, loading, times, writing);
    report::time("total", vec![start.elapsed()]);
    report::line("files", picture.display());
    report::line("", preview.display());
    Ok(Ending::Good)
}

/// Where pictures go of which nobody says; made when they are written.
const FOLDER: &str = "out";

/// Where the picture goes.
fn place(args: &Args, file: &SceneFile) -> Result<PathBuf> {
    match &args.output {
        Some(path) if matches!(FileKind::of(path), Ok(FileKind::Exr)) => {
            output::check(path, &args.scene, file)?;
            Ok(path.clone())
        }
        Some(path) => {
            let path = path.display();
            Err(Error::Usage(format!("{path}: the picture is an EXR; give a name in .exr")))
        }
        None => {
            let path = Path::new(FOLDER).join(format!("{}.exr", file.name));
            output::check_unread(&path, &args.scene, file)?;
            Ok(path)
        }
    }
}

/// Each stage, and last the whole, of each repetition.
type Times = Vec<Vec<(&'static str, Duration)>>;

/// Draws once and notes how long it took.
fn timed<'s>(
    times: &mut Times,
    render: impl FnOnce() -> Result<Cow<'s, Picture<f32>>>,
) -> Result<Cow<'s, Picture<f32>>> {
    let start = Instant::now();
    let drawing = render()?;
    let mut laps = drawing.timings.clone();
    laps.push(("picture", start.elapsed()));
    times.push(laps);
    Ok(drawing)
}

fn print_times(exec: &splatref::frame::Exec, loading: Duration, times: Times, writing: Duration) {
    let threads = match exec.threads() {
        1 => "1 thread".into(),
        n => format!("{n} threads"),
    };
    let of = match times.len() {
        1 => String::new(),
        n => format!(", minimum and median of {n} pictures"),
    };
    report::line("time", format!("{threads}{of}"));
    report::time("loading", vec![loading]);
    for stage in 0..times[0].len() {
        let laps = times.iter().map(|laps| laps[stage].1).collect();
        report::time(times[0][stage].0, laps);
    }
    report::time("writing", vec![writing]);
}
