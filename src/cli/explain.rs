//! `splatref explain`: prints every decision at one pixel.

use super::options::{ExecOptions, SceneOptions};
use super::{Ended, Ending, draw, report, say, verify};
use splatref::composite::decide;
use splatref::frame::{NO_ID, Samples};
use splatref::io::client::Description;
use splatref::io::scene_file::{Number, Ready};
use splatref::method::Session;
use splatref::scene::Camera;
use splatref::splat::batch::disc;
use splatref::splat::{Fate, Projector, Shared, View, fragment, project};
use splatref::verdict::client::{Client, Rounding};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref explain cluster 512 384
  splatref explain bunny.ply 10 20 --size 64x64 --number f64
  splatref explain bunny.ply 512 384 --method single-pass --overlap 0.8
  splatref explain scene.toml 512 384 --client gpu.exr")]
pub(super) struct Args {
    /// The scene, as for render
    scene: PathBuf,
    /// Column of the pixel, from 0 at the left
    x: u32,
    /// Row of the pixel, from 0 at the top
    y: u32,
    /// Print the values of another renderer beside what each may be; the file is as for verify
    #[arg(long, value_name = "FILE")]
    client: Option<PathBuf>,
    /// Set the precision that the other renderer promises, as for verify
    #[arg(long, value_name = "gpu|precise|ieee", value_parser = verify::rounding, requires = "client")]
    promise: Option<Rounding>,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

pub(super) fn run(args: &Args) -> Ended {
    let file = args.options.scene_file(&args.scene)?;
    file.output.check_kept("explain shows the decisions of f32 or f64")?;
    let exec = args.exec.exec()?;
    let ready = draw::ready(&file, &exec)?;
    ready.camera.check_pixel(args.x, args.y)?;
    let (session, made) = draw::session(&ready, &args.options, &exec)?;
    let pixel = (args.x, args.y);
    let text = match file.output.number {
        Number::F32 => session.explain::<f32>(&ready.camera, pixel)?,
        Number::F64 => session.explain::<f64>(&ready.camera, pixel)?,
    };
    let (checks, named) = match &args.client {
        None => (Vec::new(), None),
        Some(path) => {
            let described = Description::open(path)?;
            let client = verify::read(
                &described,
                args.promise,
                file.output.number,
                &ready.camera,
                &session,
                &exec,
            )?;
            let named =
                named(&client, pixel).and_then(|id| fate(&session, &ready.camera, id, pixel));
            (session.checks(&ready.camera, &client, pixel)?, named)
        }
    };
    let Ready { loaded, camera, method, .. } = &ready;
    report::camera(camera);
    report::picture(camera, file.output);
    report::method(method, &loaded.scene, camera);
    report::groups(session.groups(), made.as_ref());
    say("");
    say(text.trim_end());
    if args.client.is_some() && checks.is_empty() {
        say("\nthe client: none of its planes can be judged at this pixel; see splatref verify");
    } else if !checks.is_empty() {
        say("\nthe client, stage by stage, each computed from the client's planes of the stage \
             before:");
        checks.iter().for_each(|check| say(format!("  {check}")));
    }
    named.iter().for_each(|named| say(format!("  {named}")));
    Ok(Ending::Good)
}

/// The surfel that a client names at a pixel.
fn named(client: &Client, (x, y): (u32, u32)) -> Option<u32> {
    let ids = client.frame().planes.iter().find_map(|plane| match &plane.samples {
        Samples::Index(ids) if plane.name == "id" || plane.name.ends_with(".id") => Some(ids),
        _ => None,
    });
    ids.map(|ids| *ids.at(x, y)).filter(|id| *id != NO_ID)
}

/// What becomes of a surfel that a client names, and how far from its centre the pixel is; none for
/// a method without splats.
fn fate(session: &Session<'_>, camera: &Camera, surfel: u32, pixel: (u32, u32)) -> Option<String> {
    let splats = session.method().splats()?;
    let surfels = &session.scene().surfels;
    if surfels.is_empty() {
        return None;
    }
    let of = format!("the client's surfel {surfel}");
    if surfel as usize >= surfels.len() {
        return Some(format!("{of} does not exist: there are {}", surfels.len()));
    }
    let view = View::<f32>::new(camera);
    let projector = Projector::new(view, &splats.kernel, splats.cull);
    let (splat, reasons) = project(&projector, &disc(surfels, surfel as usize), surfel);
    let why = match reasons.fate() {
        Fate::Visible => {
            let shared = Shared::new(&view, &splats.kernel);
            let (q, w) = fragment(&shared, &splat.footprint, pixel);
            let inside = if decide::inside(q, shared.limit) { "<=" } else { ">" };
            let depth = shared.depth(w);
            return Some(format!(
                "{of} has q {q} {inside} {} here, and depth {depth}",
                shared.limit
            ));
        }
        Fate::Behind => "its centre is not beyond the near plane",
        Fate::Degenerate => "it has no footprint in this arithmetic",
        Fate::BackFacing => "its back is seen, and culling is on",
        Fate::Outside => {
            "its bounding sphere is outside the view, or no pixel is within its bounds"
        }
    };
    Some(format!("{of} is not drawn: {why}"))
}
