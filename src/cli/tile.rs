//! `splatref tile`: stores surfels in spatial order.

use super::report::line;
use super::{Ended, Ending, output, progress};
use splatref::frame::Exec;
use splatref::io::blocks::Tiled;
use splatref::io::scene_file::SceneFile;
use splatref::{Error, Result};
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref tile city.ply -o tiled/city
  splatref render tiled/city --size 4096x4096 --region 0,0,4096,512
  splatref render tiled/city --size 4096x4096 --bands 16

The folder stands for the PLY in every command. `render` reads only the blocks of surfels that a picture,
a region or a band may show, with the methods ewa, peeling and blue. Every bit is that of the PLY; name
the folder as the PLY, because the text in a picture has the name of the scene.")]
pub(super) struct Args {
    /// A model, as for render. A binary little-endian .ply whose vertices have nx ny nz and radius is read
    /// in parts; anything else must fit into memory once
    scene: PathBuf,
    /// Write into this folder
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Use N threads; 0 uses every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

pub(super) fn run(args: &Args) -> Ended {
    check(args)?;
    let start = Instant::now();
    let exec = Exec::new(args.threads, 32)?;
    let steps = progress::Steps::new("reading");
    let show = |what: &str, done, of| steps.show(what, done, of);
    let scene = SceneFile::open(&args.scene)?;
    let Tiled { surfels, dropped, blocks } = scene.tile(&args.output, &exec, &show)?;
    drop(steps);
    line("surfels", surfels);
    if dropped > 0 {
        line("  dropped", format!("{dropped} points that are no surfels"));
    }
    line("blocks", blocks);
    line("time", format!("{:.2} s", start.elapsed().as_secs_f64()));
    line("folder", args.output.display());
    Ok(Ending::Good)
}

/// Checks, before anything is read, that there can be a folder.
fn check(Args { output, .. }: &Args) -> Result<()> {
    if output.is_file() {
        let what = format!("{}: this is a file; give the name of a folder", output.display());
        return Err(Error::Usage(what));
    }
    output::check_folder(output)
}
