//! `splatref project`: writes the visible splats of a scene as records for a backend to upload.

use super::options::{ExecOptions, SceneOptions};
use super::{Ended, Ending, draw, output, progress, report};
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::{Number, Ready};
use splatref::splat::record::{SplatRecord, project_records, shared_numbers};
use splatref::{Error, Result};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
The file has no header. Each visible splat is a record of 96 bytes, in ascending surfel index. A record
holds little-endian 32-bit floats and integers. The program prints the number of records and the offset
of each field; the documentation of splatref::splat::record::SplatRecord says what they mean.

Examples:
  splatref project bunny.ply -o records.bin
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
    check(args, method.splats().is_some(), file.output.number)?;
    file.output.check_kept("records are f32")?;
    output::check(&args.output, &args.scene, &file)?;
    let ready = draw::ready(&file, &exec)?;
    let Ready { loaded, camera, method, .. } = &ready;
    let Some(splats) = method.splats() else { return Ok(Ending::Good) };
    let surfels = &loaded.scene.surfels;
    let (records, tally) = progress::during("projecting", || {
        project_records(surfels, camera, &splats.kernel, splats.cull)
    });
    progress::during("writing", || write(&args.output, &records))?;

    report::scene(loaded);
    report::camera(camera);
    report::method(method, &loaded.scene, camera);
    report::tally(&tally);
    report::line("records", format!("{} of {} bytes", records.len(), SplatRecord::SIZE));
    for (name, offset, kind) in SplatRecord::FIELDS {
        report::line("", format!("{offset:>2} {name:<9} {kind}"));
    }
    let shared = shared_numbers(camera, &splats.kernel);
    let shared: Vec<String> = shared.iter().map(|(name, v)| format!("{name} = {v:?}")).collect();
    report::line("all share", shared.join(", "));
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

fn write(path: &Path, records: &[SplatRecord]) -> Result<()> {
    write_atomically(path, |file| {
        records.iter().try_for_each(|record| file.write_all(&record.to_bytes()))
    })
}
