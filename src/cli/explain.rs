//! `splatref explain`: every decision at one pixel.

use super::options::{ExecOptions, SceneOptions};
use super::ready::Ready;
use super::{Finding, Outcome, report, say};
use splatref::Error;
use splatref::io::scene_file::Number;
use splatref::method::Method;
use splatref::method::ewa::explain::explain;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref explain cluster 512 384
  splatref explain bunny.ply 10 20 --size 64x64 --number f64")]
pub(super) struct Args {
    /// The scene, as for render
    scene: PathBuf,
    /// Column of the pixel, from 0 at the left
    x: u32,
    /// Row of the pixel, from 0 at the top
    y: u32,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

pub(super) fn run(args: &Args) -> Finding {
    let file = args.options.scene_file(&args.scene)?;
    let exec = args.exec.exec()?;
    let Ready { loaded, camera, method, .. } = Ready::new(&file, &exec)?;
    let Method::Ewa(settings) = method else {
        let what = "explain replays the method ewa alone; its fragments are those of the others";
        return Err(Error::Usage(what.into()));
    };
    let surfels = &loaded.scene.surfels;
    let pixel = (args.x, args.y);
    let text = match file.output.number {
        Number::F32 => explain::<f32>(surfels, &camera, &settings, &exec, pixel)?.to_string(),
        Number::F64 => explain::<f64>(surfels, &camera, &settings, &exec, pixel)?.to_string(),
    };
    report::camera(&camera);
    report::picture(&camera, file.output);
    report::method(&method, surfels);
    say("");
    say(text.trim_end());
    Ok(Outcome::Good)
}
