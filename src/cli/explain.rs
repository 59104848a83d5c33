//! `splatref explain`: prints every decision at one pixel.

use super::options::{ExecOptions, SceneOptions};
use super::{Ended, Ending, draw, report, say, verify};
use splatref::io::client::Description;
use splatref::io::scene_file::{Number, Ready};
use splatref::verdict::client::Rounding;
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
    let checks = match &args.client {
        None => Vec::new(),
        Some(path) => {
            let described = Description::open(path)?;
            let numbers = (file.output.number, &ready.camera);
            let client = verify::read((&described, args.promise), numbers, &session, &exec)?;
            session.checks(&ready.camera, &client, pixel)?
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
    Ok(Ending::Good)
}
