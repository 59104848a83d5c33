//! `splatref explain`: every decision at one pixel.

use super::options::{ExecOptions, SceneOptions};
use super::{Ended, Ending, draw, report, say};
use splatref::io::scene_file::{Number, Ready};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref explain cluster 512 384
  splatref explain bunny.ply 10 20 --size 64x64 --number f64
  splatref explain bunny.ply 512 384 --method single-pass --overlap 0.8")]
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

pub(super) fn run(args: &Args) -> Ended {
    let file = args.options.scene_file(&args.scene)?;
    let exec = args.exec.exec()?;
    let ready = draw::ready(&file, &exec)?;
    ready.camera.check_pixel(args.x, args.y)?;
    let (session, made) = draw::session(&ready, &exec)?;
    let pixel = (args.x, args.y);
    let text = match file.output.number {
        Number::F32 => session.explain::<f32>(&ready.camera, pixel)?,
        Number::F64 => session.explain::<f64>(&ready.camera, pixel)?,
    };
    let Ready { loaded, camera, method, .. } = &ready;
    report::camera(camera);
    report::picture(camera, file.output);
    report::method(method, &loaded.scene, camera);
    report::groups(session.groups(), made.as_ref());
    say("");
    say(text.trim_end());
    Ok(Ending::Good)
}
