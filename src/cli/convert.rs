//! `splatref convert`: writes 3D Gaussians in another format.

use super::{Ended, Ending, complain, output, progress, report};
use splatref::io::gaussians::{self, GaussianFile};
use splatref::io::scene_file::FileKind;
use splatref::scene::Gaussians;
use splatref::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref convert scan.ply scan.glb
  splatref convert scan.glb scan.ply

Axes are kept: nothing is turned. A GLB holds the Gaussians bit for bit. A PLY holds logarithms of scales
and logits of opacities; the command says how many of them change when the PLY is read.")]
pub(super) struct Args {
    /// A .ply, .glb, .gltf, .splat or .spz with 3D Gaussians
    input: PathBuf,
    /// Write this .ply or .glb
    output: PathBuf,
}

pub(super) fn run(args: &Args) -> Ended {
    gaussians::check_name(&args.output)?;
    output::check_folder(&args.output)?;
    output::check_other(&args.output, &args.input)?;
    if !matches!(
        FileKind::from_extension(&args.input),
        Ok(FileKind::Ply | FileKind::Gaussians) | Err(_)
    ) {
        return Err(Error::Usage(format!(
            "{}: Gaussians are read from a .ply, .glb, .gltf, .splat or .spz; give one",
            args.input.display()
        )));
    }
    let (file, all, dropped) = progress::during("reading", || read(&args.input))?;
    for what in &file.warnings {
        complain(format!("warning: {}: {what}", args.input.display()));
    }
    report::line(
        "gaussians",
        format!("{}, spherical harmonics of degree {}", all.len(), all.degree()),
    );
    report::line("  read as", &file.convention);
    report::line("  dropped", report::dropped_gaussians(dropped));
    progress::during("writing", || gaussians::write(&args.output, &all, file.offset))?;
    let (written, again, lost) = progress::during("checking", || read(&args.output))?;
    let same = written.offset == file.offset && lost == 0;
    report::line("  changed", changed(&all, &again, same));
    report::line("file", args.output.display());
    Ok(Ending::Good)
}

/// Reads a file; the Gaussians that can be drawn, and how many cannot.
fn read(path: &Path) -> Result<(GaussianFile, Gaussians, u64)> {
    let mut file = gaussians::read(path)?;
    let (all, dropped) =
        Gaussians::new(std::mem::take(&mut file.arrays)).map_err(|error| match error {
            Error::Invalid(what) => Error::format(path, what),
            other => other,
        })?;
    Ok((file, all, dropped))
}

/// What is different when the output is read.
fn changed(all: &Gaussians, again: &Gaussians, same: bool) -> String {
    if !same || all.len() != again.len() {
        return "the offset of the positions, and so their last digits".into();
    }
    let scales = |of: &Gaussians| of.scale().iter().flat_map(|s| s.to_array()).collect::<Vec<_>>();
    let parts = [
        ("scales", differing(&scales(all), &scales(again)), "logarithms"),
        ("opacities", differing(all.opacity(), again.opacity()), "logits"),
    ];
    let parts = parts.into_iter().filter(|(_, (count, _, _), _)| *count > 0);
    let parts: Vec<String> = parts
        .map(|(name, (count, of, most), what)| {
            let most = report::short(most);
            format!(
                "{count} of {of} {name}, by at most {most} of their size, because of {what} in f32"
            )
        })
        .collect();
    match (parts.is_empty(), all == again) {
        (true, true) => "nothing: the file gives the same Gaussians, bit for bit".into(),
        (true, false) => "the colour space".into(),
        (false, _) => parts.join("; "),
    }
}

/// How many numbers differ, of how many, and the greatest relative difference.
fn differing(a: &[f32], b: &[f32]) -> (usize, usize, f64) {
    let pairs = a.iter().zip(b).filter(|(a, b)| a != b);
    let relative = |(a, b): (&f32, &f32)| (f64::from(*b) / f64::from(*a) - 1.0).abs();
    let most =
        pairs.clone().map(relative).fold(0.0, |most, off| if off > most { off } else { most });
    (pairs.count(), a.len(), most)
}
