//! `splatref explain`: every decision at one pixel.

use super::options::{ExecOptions, SceneOptions};
use super::ready::Ready;
use super::{Finding, Outcome, report, say};
use splatref::frame::Exec;
use splatref::io::scene_file::Number;
use splatref::method::{Method, ewa, single_pass};
use splatref::number::Exact;
use splatref::{Error, Result};
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

pub(super) fn run(args: &Args) -> Finding {
    let file = args.options.scene_file(&args.scene)?;
    let exec = args.exec.exec()?;
    if !matches!(file.method.method()?, Method::Ewa(_) | Method::SinglePass(_)) {
        let what = "explain replays the methods ewa and single-pass; give one of them by --method";
        return Err(Error::Usage(what.into()));
    }
    let ready = Ready::new(&file, &exec)?;
    let pixel = (args.x, args.y);
    let text = match file.output.number {
        Number::F32 => replay::<f32>(&ready, &exec, pixel)?,
        Number::F64 => replay::<f64>(&ready, &exec, pixel)?,
    };
    let Ready { loaded, camera, method, .. } = &ready;
    report::camera(camera);
    report::picture(camera, file.output);
    report::method(method, &loaded.scene.surfels);
    ready.report_groups();
    say("");
    say(text.trim_end());
    Ok(Outcome::Good)
}

/// The decisions at a pixel, in words.
fn replay<R: Exact>(ready: &Ready, exec: &Exec, pixel: (u32, u32)) -> Result<String> {
    let Ready { loaded, preparation, camera, method, .. } = ready;
    let surfels = &loaded.scene.surfels;
    match (method, preparation.groups()) {
        (Method::Ewa(settings), _) => {
            let found = ewa::explain::explain::<R>(surfels, camera, settings, exec, pixel)?;
            Ok(found.to_string())
        }
        (Method::SinglePass(settings), Some(groups)) => {
            let found =
                single_pass::explain::explain::<R>(surfels, groups, camera, settings, exec, pixel)?;
            Ok(found.to_string())
        }
        _ => Err(Error::Usage("there is no replay of this method".into())),
    }
}
