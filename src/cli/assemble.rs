//! `splatref assemble`: joins the parts of a picture.

use super::destination::write;
use super::{Ended, Ending, output, progress, report};
use splatref::frame::Exec;
use splatref::io::exr::{self, Window};
use splatref::io::provenance;
use splatref::io::scene_file::{FileKind, OutputSettings, projection};
use splatref::{Error, Result};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref render torus --size 512x512 --region 0,0,512,256
  splatref render torus --size 512x512 --region 0,256,512,512
  splatref assemble out/torus.0-*.exr -o torus.exr

The parts may come from any machine, in any order, and may overlap. The EXR has the same bytes as the
EXR of the whole picture. Parts by the methods pyramid and template hold the projection alone; assemble
then runs the other stages, and needs no scene for that.")]
pub(super) struct Args {
    /// The EXR files that `render --region` wrote
    #[arg(required = true, value_name = "PART.exr")]
    parts: Vec<PathBuf>,
    /// Write the EXR here, and the PNG beside it
    #[arg(short, long, value_name = "FILE.exr")]
    output: PathBuf,
}

pub(super) fn run(args: &Args) -> Ended {
    let (place, preview) = (&args.output, args.output.with_extension("png"));
    check(args)?;
    let exec = Exec::new(0, 32)?;
    let mut whole = progress::during("reading", || exr::assemble(&args.parts, &exec))?;
    let projection = provenance::is_projection(&whole.text);
    if projection {
        (whole.frame, whole.text) =
            progress::during("rendering", || projection::finish(whole.frame, &whole.text, &exec))?;
    }
    let output = OutputSettings { compression: whole.compression, ..OutputSettings::default() };
    let (frame, text) = (&whole.frame, || whole.text.clone());
    progress::during("writing", || {
        write(place, frame, Window::whole(frame), text, output, None, &exec)
    })?;
    report::line("picture", format!("{} x {} pixels", frame.width, frame.height));
    let holds = if projection { " with the projection; the other stages ran here" } else { "" };
    report::line("parts", format!("{}{holds}", args.parts.len()));
    report::line("files", place.display());
    if frame.color("").is_ok() {
        report::line("", preview.display());
    }
    Ok(Ending::Good)
}

/// Checks, before anything is read, that the picture can be written.
fn check(Args { parts, output: place }: &Args) -> Result<()> {
    if !matches!(FileKind::from_extension(place), Ok(FileKind::Exr)) {
        let place = place.display();
        let what = format!("{place}: the picture is an EXR; give a name that ends in .exr");
        return Err(Error::Usage(what));
    }
    output::check_folder(place)?;
    parts.iter().try_for_each(|part| output::check_other(place, part))
}
