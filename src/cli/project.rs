//! `splatref project`: writes the visible splats of a scene as records for a backend to upload.

use super::options::{ExecOptions, SceneOptions};
use super::{Ended, Ending, draw, output, progress, report};
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::{Number, Ready};
use splatref::{Error, Result};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
The file has no header. Each visible splat is a record of 96 bytes, in ascending surfel index; a 3D
Gaussian one of 128 bytes, in the order of blending. A record holds little-endian 32-bit floats and
integers. The program prints the number of records and the offset of each field; the documentation of
splatref::splat::record::SplatRecord and splatref::method::gaussians::record says what they mean.

Examples:
  splatref project bunny.ply -o records.bin
  splatref project splats.glb --method gaussians -o records.bin
  splatref project sphere --outline raycast --size 640x480 -o records.bin")]
pub(super) struct Args {
    /// The scene, as for render
    scene: PathBuf,
    /// Write the records into this file
    #[arg(short, long, value_name = "FILE.bin")]
    output: PathBuf,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

pub(super) fn run(args: &Args) -> Ended {
    let file = args.options.scene_file(&args.scene)?;
    let exec = args.exec.exec()?;
    let method = file.method.method()?;
    check(args, method.record_layout().is_some(), file.output.number)?;
    file.output.check_kept("records are f32")?;
    output::check(&args.output, &args.scene, &file)?;
    let ready = draw::ready(&file, &exec)?;
    let Ready { loaded, camera, method, .. } = &ready;
    method.check_scene(&loaded.scene)?;
    let records = progress::during("projecting", || method.records(&loaded.scene, camera, &exec));
    let Some(records) = records else { return Ok(Ending::Good) };
    progress::during("writing", || write_atomically(&args.output, |file| records.write(file)))?;

    report::scene(loaded);
    report::camera(camera);
    report::method(method, &loaded.scene, camera);
    report::tally(&records.tally);
    report::line("records", format!("{} of {} bytes", records.tally.visible, records.layout.size));
    for (name, offset, kind) in records.layout.fields {
        report::line("", format!("{offset:>3} {name:<12} {kind}"));
    }
    if !records.shared.is_empty() {
        let shared: Vec<_> =
            records.shared.iter().map(|(name, v)| format!("{name} = {v:?}")).collect();
        report::line("all share", shared.join(", "));
    }
    report::line("file", args.output.display());
    Ok(Ending::Good)
}

/// Refuses wrong options before anything is loaded.
fn check(args: &Args, splats: bool, number: Number) -> Result<()> {
    if !splats {
        let what = "this method draws no splats; give another --method";
        return Err(Error::Usage(what.into()));
    }
    if number != Number::F32 {
        return Err(Error::Usage("records are f32; give --number f32".into()));
    }
    if args.output.extension().is_none_or(|extension| extension != "bin") {
        let path = args.output.display();
        return Err(Error::Usage(format!(
            "{path}: records are raw bytes; give a name that ends in .bin"
        )));
    }
    Ok(())
}
