//! `splatref compare`: two EXR files, plane by plane.

use super::{Ended, Ending, report, say};
use splatref::io::exr;
use splatref::verify::compare::{Tolerance, Verdict, compare};
use splatref::verify::metrics;
use splatref::{Error, Result};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref compare out/a.exr out/b.exr
  splatref compare truth.exr gpu.exr --max-ulp 4 --max-abs 1e-6

Exit codes: 0 equal or within the tolerance, 1 different.")]
pub(super) struct Args {
    /// The picture that is right
    first: PathBuf,
    /// The picture in question
    second: PathBuf,
    /// Let floats pass that are so many representable numbers apart
    #[arg(long, value_name = "N")]
    max_ulp: Option<u32>,
    /// Let floats pass that differ by so much
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    max_abs: Option<f32>,
}

pub(super) fn run(args: &Args) -> Ended {
    let tolerance = tolerance(args)?;
    let (first, second) = (exr::read(&args.first)?, exr::read(&args.second)?);
    let found = compare(&first, &second, tolerance);
    let lines = found.lines();
    let (verdict, planes) = lines.split_last().map_or(("", [].as_slice()), |(v, p)| (v, p));
    planes.iter().for_each(say);
    if let Some(metrics::Summary { rmse, psnr, ssim }) = metrics::summary(&first, &second) {
        let ssim = ssim.map_or_else(|| "too small for SSIM".into(), |s| format!("SSIM {s:.6}"));
        let rmse = report::short(rmse);
        say(format!("R, G, B: RMSE {rmse}, PSNR {psnr:.3} dB, {ssim}"));
    }
    say(verdict);
    Ok(match found.verdict() {
        Verdict::Equal | Verdict::Within => Ending::Good,
        Verdict::Different => Ending::Different,
    })
}

fn tolerance(args: &Args) -> Result<Tolerance> {
    if let Some(most) = args.max_abs.filter(|most| most.is_nan() || *most < 0.0) {
        return Err(Error::Usage(format!("--max-abs {most}; give a number >= 0")));
    }
    Ok(Tolerance { max_ulp: args.max_ulp, max_abs: args.max_abs })
}
