//! `splatref render`: renders a scene into an EXR and a PNG.

use super::destination::{Depth, Destination, write};
use super::options::{ExecOptions, SceneOptions};
use super::rows::{OfFiles, RowOptions};
use super::sequence::{self, Frames};
use super::walk::{self, Walk};
use super::{Ended, Ending, bands, draw, progress, region, report};
use splatref::frame::{Exec, Rect};
use splatref::io::client::{DepthConvention, DepthFile};
use splatref::io::scene_file::{OutputSettings, Ready, SceneFile};
use splatref::method::{Method, Picture, Session};
use splatref::scene::camera::stereo::Eye;
use splatref::{Error, Result};
use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref render
  splatref render torus --count 5000 --outline raycast --stages
  splatref render tree --method pyramid
  splatref render bunny.ply --eye -1,2,3 --target 0,0.1,0 --fov 30 -o bunny.exr
  splatref render scene.toml --number f64 --epsilon 1.5r
  splatref render scene.toml --frames 0..60 -o out/walk.exr
  splatref render scan.ply --cameras transforms.json --view r_12
  splatref render bunny.ply --turntable 60 -o out/turn.exr
  splatref render scene.toml --stereo 0.065 -o out/pair.exr
  splatref render walk.toml --method blue --frames all --target-ms 40
  splatref render bunny.ply --size 4096x4096 --region 0,0,4096,512 -o parts/0.exr
  splatref render bunny.ply --write-depth png --depth-as t,1000 -o bunny.exr")]
pub(super) struct Args {
    /// A .ply, .obj, .las, .laz, .e57, .glb, .gltf, .splat or .spz, a scene .toml, a folder of `tile` or `surfels`, or a shape: sphere, torus, checkerboard, sheets, staircase, cluster,
    /// or tree (with --method pyramid)
    #[arg(default_value = "cluster", hide_default_value = false)]
    scene: PathBuf,
    /// Write the EXR here, and the PNG beside it [default: out/NAME.exr]
    #[arg(short, long, value_name = "FILE.exr")]
    output: Option<PathBuf>,
    /// Draw only the columns from X0 up to X1 and the rows from Y0 up to Y1, X1 and Y1 excluded. The EXR has
    /// the bits of the whole picture there, as its data window; `assemble` joins such parts. By the methods
    /// pyramid and template it holds the projection alone, and `assemble` runs the other stages [default
    /// output: out/NAME.X0-Y0-X1-Y1.exr]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = region::region, allow_hyphen_values = true,
        conflicts_with = "write_depth")]
    region: Option<Rect>,
    /// Draw the picture in about N bands of rows, one after the other, and write each as it is made: for
    /// pictures larger than memory. auto: as few bands as --memory allows. No PNG is written
    #[arg(long, value_name = "N|auto", value_parser = bands::count,
        conflicts_with_all = ["region", "write_depth", "frames", "repeat", "keep_state"])]
    bands: Option<bands::Count>,
    #[command(flatten)]
    files: RowOptions<OfFiles>,
    /// Render N times; print the minimum and the median of each stage. For the method deferred these
    /// are the N frames that follow, because the first frame does other work
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Render frames A to B - 1 of the sequence, or all of them, each into an EXR and a PNG of its
    /// own: out/walk.exr becomes out/walk.0000.exr and so on [default: one frame; all of --turntable
    /// and of several --cameras]
    #[arg(long, value_name = "A..B|all", value_parser = sequence::frames,
        conflicts_with_all = ["repeat", "frame"])]
    frames: Option<Frames>,
    /// Choose the size of ordered points by the time of the last frame, so that placing and drawing a
    /// frame take about MS milliseconds [BJFM19, 4.3]. The first frame has --surfel-size; every size is moved
    /// into 1 to 8 px. Writes the sizes and times into NAME.frames.csv and NAME.frames.svg
    #[arg(long, value_name = "MS", value_parser = walk::milliseconds,
        conflicts_with_all = ["bands", "repeat", "frame"])]
    target_ms: Option<f64>,
    /// Write the depth too: 16-bit codes into NAME.depth.png, or floats into NAME.depth.npy. Beside it,
    /// NAME.depth.toml says how it is stored; `verify` reads that
    #[arg(long, value_name = "png|npy", value_parser = depth_file)]
    write_depth: Option<DepthFile>,
    /// Store the depth t as t, 1/t, near/t,NEAR, z-buffer,NEAR,FAR, reversed-z,NEAR,FAR or
    /// linear,NEAR,FAR; in a PNG t,SCALE has SCALE codes for each world unit [--write-depth npy: t]
    #[arg(long, value_name = "CONVENTION", requires = "write_depth")]
    depth_as: Option<String>,
    /// Write the state after the last frame, for --state (method deferred)
    #[arg(long, value_name = "FILE")]
    keep_state: Option<PathBuf>,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    pub(super) options: SceneOptions,
}

/// Parses the kind of a file of depths.
fn depth_file(text: &str) -> std::result::Result<DepthFile, String> {
    let all = [DepthFile::Png, DepthFile::Npy];
    all.into_iter().find(|file| file.extension() == text).ok_or("give png or npy".into())
}

impl Args {
    /// The file of depths, if one is wanted.
    fn depth(&self) -> Result<Option<Depth>> {
        let Some(file) = self.write_depth else { return Ok(None) };
        let text = self.depth_as.as_deref().unwrap_or("t");
        let convention = DepthConvention::parse(file, text)
            .map_err(|what| Error::Usage(format!("--depth-as: {what}")))?;
        Ok(Some(Depth { file, convention }))
    }

    /// The files to write, and what part of the picture they hold.
    fn destination(&self, file: &SceneFile) -> Result<Destination<'_>> {
        if self.bands.is_some() {
            bands::check(&file.method.method()?)?;
        } else if self.region.is_some() {
            file.method.method()?.check_region()?;
        }
        Ok(Destination {
            scene: &self.scene,
            output: self.output.as_deref(),
            keep_state: self.keep_state.as_deref(),
            options: &self.options,
            depth: self.depth()?,
            region: self.region,
        })
    }

    /// Reads what the picture or the region needs of a folder of blocks. Each band reads its own part.
    fn read_part(&self, ready: &mut Ready, exec: &Exec) -> Result<()> {
        if self.bands.is_none()
            && let Some(part) = progress::during("loading", || ready.part(self.region, exec))?
        {
            ready.loaded.scene = part;
        }
        Ok(())
    }

    /// Whether both eyes of a stereo pair are drawn. If so, the scene file gets the left one; the right
    /// one follows from it.
    fn take_pair(&self, file: &mut SceneFile) -> Result<bool> {
        let Some(stereo) = file.camera.stereo.as_mut().filter(|stereo| stereo.eye.is_none()) else {
            return Ok(false);
        };
        stereo.eye = Some(Eye::Left);
        let distance = stereo.distance;
        let refused = [
            (self.bands.is_some(), "--bands"),
            (self.repeat > 1, "--repeat"),
            (self.keep_state.is_some(), "--keep-state"),
            (self.options.state().is_some(), "--state"),
            (file.surface.is_some(), "a surface"),
        ];
        match refused.iter().find(|(is, _)| *is) {
            None => Ok(true),
            Some((_, what)) => Err(Error::Usage(format!(
                "a stereo pair is two pictures, but {what} belongs to one; draw each eye alone: --stereo \
                 {distance},left and then --stereo {distance},right"
            ))),
        }
    }

    /// The frames to render as a sequence; `None` for one picture.
    fn sequence(&self, file: &SceneFile) -> Result<Option<Range<u32>>> {
        let frames = match &self.frames {
            Some(Frames::Some(frames)) => Some(frames.clone()),
            Some(Frames::All) => Some(0..file.frame_count()),
            // A camera that goes round, and the cameras of a file, are there to be drawn.
            None => {
                let one = self.options.names_frame() || self.repeat > 1;
                (file.camera.is_sequence() && !one).then(|| 0..file.frame_count())
            }
        };
        if frames.is_some() && self.bands.is_some() {
            let what = "--bands draws one picture, but this is a sequence; give --frame";
            return Err(Error::Usage(what.into()));
        }
        Ok(frames)
    }
}

pub(super) fn run(args: &Args) -> Ended {
    let start = Instant::now();
    let mut file = args.options.scene_file(&args.scene)?;
    file.output = args.files.chosen.on(file.output, "the output")?;
    let exec = args.exec.exec()?;
    let destination = args.destination(&file)?;
    let pair = args.take_pair(&mut file)?;
    let frames = args.sequence(&file)?;
    if args.target_ms.is_some() && frames.is_none() {
        let what = "--target-ms needs a sequence; give --frames, --turntable or several --cameras";
        return Err(Error::Usage(what.into()));
    }
    if frames.is_some() || pair {
        return several(args, &destination, file, frames, pair, &exec);
    }
    let picture = destination.place(&file, "")?;
    let mut ready = draw::ready_in_parts(&file, &exec)?;
    destination.check_state(&ready, &file, std::slice::from_ref(&picture))?;
    destination.check_region(&ready.camera)?;
    args.read_part(&mut ready, &exec)?;
    let (mut session, made) = draw::session(&ready, &args.options, &exec)?;
    if let Some(count) = args.bands {
        let (to, output) = (&destination, file.output);
        return bands::render(&mut session, &ready, to, &picture, output, count, &exec);
    }
    let window = destination.limit(&mut session, &ready.camera)?;
    let loading = start.elapsed();
    let Ready { loaded, camera, method, .. } = &ready;
    let (scene, projects) = (&loaded.scene, destination.projects(method, camera));
    // Cloned, because the picture may borrow from the session.
    let groups = session.groups().cloned();

    let mut times = Vec::new();
    let drawing = progress::during("rendering", || {
        repeated(&mut session, &ready, file.output, args.repeat, &mut times)
    })?;

    let writing = Instant::now();
    destination.make_folder()?;
    progress::during("writing", || -> Result<()> {
        let text = || destination.text(scene, groups.as_ref(), camera, method, file.output);
        write(&picture, &drawing.frame, window, text, file.output, destination.depth, &exec)
    })?;
    let (writing, tally, seen) = (writing.elapsed(), drawing.tally, drawing.seen.clone());
    drop(drawing);
    destination.keep(&ready, ready.frame(), seen.as_ref(), &exec)?;

    report::scene(loaded);
    report::camera(camera);
    report::far(&file, scene, camera);
    report::picture(camera, file.output);
    print_part(&destination, projects);
    report::method(method, scene, camera);
    report::groups(session.groups(), made.as_ref());
    report::tally(&tally);
    report::selection(scene, seen.as_ref());
    let steady = if seen.is_some() { " after this one" } else { "" };
    print_times(&exec, loading, times, steady, writing);
    report::time("total", vec![start.elapsed()]);
    print_files(&destination, &picture, projects);
    Ok(Ending::Good)
}

/// Renders the frames of a sequence, and of a stereo pair both eyes.
fn several(
    args: &Args,
    destination: &Destination<'_>,
    mut file: SceneFile,
    frames: Option<Range<u32>>,
    pair: bool,
    exec: &Exec,
) -> Ended {
    if let Some(frames) = &frames {
        file.check_frame(frames.end - 1)?;
        file.frame = frames.start;
    }
    let size = file.refinement.surfel_size;
    let walk = |target| Walk::new(target, size, &destination.place(&file, "")?);
    let walk = args.target_ms.map(walk).transpose()?;
    let shots = sequence::shots(destination, &file, frames, pair)?;
    sequence::render(destination, &file, &shots, walk, exec)
}

/// Draws the picture, and times this many pictures: of `deferred` the frames that follow, because
/// the first frame does other work.
fn repeated<'s>(
    session: &'s mut Session<'_>,
    Ready { camera, method, .. }: &Ready,
    output: OutputSettings,
    count: u32,
    times: &mut Times,
) -> Result<Cow<'s, Picture<f32>>> {
    if count > 1 && matches!(method, Method::Deferred(_)) {
        let before = session.seen().cloned();
        let mut seen = output.draw(session, camera)?.seen.clone();
        for _ in 0..count {
            session.resume(seen);
            seen = timed(times, || output.draw(session, camera))?.seen.clone();
        }
        // The picture itself is still the frame that was asked for.
        session.resume(before);
        return output.draw(session, camera);
    }
    for _ in 1..count {
        timed(times, || output.draw(session, camera))?;
    }
    timed(times, || output.draw(session, camera))
}

/// The times of each repetition: each stage, and last the whole picture.
type Times = Vec<Vec<(&'static str, Duration)>>;

/// Draws once and records the times.
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

/// Prints what part of the picture the file holds.
fn print_part(destination: &Destination<'_>, projects: bool) {
    if let Some(part) = destination.region {
        report::line("region", region::words(part));
    }
    if projects {
        report::line("holds", region::PROJECTION);
    }
}

/// Prints the files. A projection has no colours for a preview.
fn print_files(destination: &Destination<'_>, picture: &Path, projects: bool) {
    report::line("files", picture.display());
    if !projects {
        report::line("", picture.with_extension("png").display());
    }
    if let Some(depth) = destination.depth {
        depth.places(picture).iter().for_each(|place| report::line("", place.display()));
    }
}

/// Prints the times. `which` says which pictures were timed.
fn print_times(exec: &Exec, loading: Duration, times: Times, which: &str, writing: Duration) {
    let threads = report::threads(exec);
    let of = match times.len() {
        1 => String::new(),
        n => format!(", minimum and median of {n} pictures{which}"),
    };
    report::line("time", format!("{threads}{of}"));
    report::time("loading", vec![loading]);
    for stage in 0..times[0].len() {
        let laps = times.iter().map(|laps| laps[stage].1).collect();
        report::time(times[0][stage].0, laps);
    }
    report::time("writing", vec![writing]);
}
