//! `splatref group`: divides a scene into groups, and writes a PLY.

use super::rows::{OfGroupsAlone, RowOptions};
use super::{Ended, Ending, output, progress, report, warn};
use splatref::frame::Exec;
use splatref::index::grouping::{Extended, Extension, Grouping, GroupingReport};
use splatref::io::ply;
use splatref::io::scene_file::{FileKind, GroupChoice, SceneFile};
use splatref::scene::Groups;
use splatref::scene::Scene;
use splatref::source::flatten;
use splatref::{Error, Result};
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref group dragon.ply -o grouped.ply
  splatref group dragon.ply --overlap 0.4 --opposite -o grouped.ply
  splatref group sphere --groups 4 --extend add -o grouped.ply
  splatref render grouped.ply --method transparent")]
pub(super) struct Args {
    /// A .ply, .obj, .las, .laz or .e57, a scene .toml, or a shape: sphere, torus, checkerboard, sheets, staircase, cluster
    scene: PathBuf,
    /// Write the surfels with their groups into this file
    #[arg(short, long, value_name = "FILE.ply")]
    output: PathBuf,
    #[command(flatten)]
    groups: RowOptions<OfGroupsAlone>,
    /// Make a procedural shape of about N surfels [default: 200000]
    #[arg(long, value_name = "N")]
    count: Option<usize>,
    /// Set the random seed of a procedural shape [default: 0]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Use N threads; 0 uses every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

pub(super) fn run(args: &Args) -> Ended {
    let grouping = args.grouping()?;
    if !matches!(FileKind::from_extension(&args.output), Ok(FileKind::Ply)) {
        let path = args.output.display();
        return Err(Error::Usage(format!(
            "{path}: groups are written as a PLY; give a name that ends in .ply"
        )));
    }
    let file = SceneFile::open_with(&args.scene, args.count, args.seed)?;
    output::check(&args.output, &args.scene, &file)?;
    let exec = Exec::new(args.threads, 32)?;
    let steps = progress::Steps::new("loading");
    let show = |what: &str, done, of| steps.show(what, done, of);
    let mut loaded = file.load(&exec, &show)?;
    if loaded.scene.gaussians.is_some() {
        let name = &loaded.scene.name;
        let what = format!(
            "{name} has 3D Gaussians, but only surfels are divided into groups; give points or a mesh"
        );
        return Err(Error::Invalid(what));
    }
    loaded.scene = flatten(&loaded.scene, &exec)?;
    let Scene { name, primitives, .. } = &loaded.scene;
    if !primitives.is_empty() {
        let what = format!(
            "{name} has triangles or lines, but only surfels are divided into groups; remove them"
        );
        return Err(Error::Invalid(what));
    }
    let start = Instant::now();
    let (groups, found, extended) = grouping.groups(&loaded.scene.surfels, &exec, &show)?;
    let time = start.elapsed();
    drop(steps);

    warn(&loaded.warnings);
    report::scene(&loaded);
    table(&found, &groups, extended.as_ref());
    report::line("time", format!("{:.2} s", time.as_secs_f64()));
    let mut cloud = loaded.scene.surfels.into_cloud();
    (cloud.groups, cloud.offset) = (Some(groups), loaded.scene.offset);
    progress::during("writing", || ply::write(&args.output, &cloud))?;
    report::line("file", args.output.display());
    Ok(Ending::Good)
}

impl Args {
    fn grouping(&self) -> Result<Grouping> {
        let chosen = GroupChoice { settings: self.groups.chosen.clone() };
        if chosen.settings.has("most") {
            let extension = chosen.settings.on(GroupChoice::ALONE, "groups").map(|g| g.extension);
            if !matches!(extension, Ok(Extension::Add { .. })) {
                return Err(Error::Usage(
                    "--most needs --extend add; add that, or remove --most".into(),
                ));
            }
        }
        chosen.grouping(GroupChoice::ALONE)
    }
}

/// Prints the row of Table 1 in \[ZP06\], and each group.
fn table(found: &GroupingReport, groups: &Groups, extended: Option<&Extended>) {
    let GroupingReport { groups: k, overlap, edges, max_degree, average_degree, .. } = found;
    report::line("groups", format!("{k} at c = {overlap}"));
    let degree = format!("{max_degree} at most, {average_degree:.1} on the average, {edges} edges");
    report::line("  degree", degree);
    let mut sizes = vec![0_u64; groups.len()];
    groups.own().iter().for_each(|&group| sizes[usize::from(group)] += 1);
    let Some(extended) = extended else {
        let sizes: Vec<String> = sizes.iter().map(u64::to_string).collect();
        return report::line("  surfels", sizes.join(" "));
    };
    report::line("  area", report::short(extended.area));
    report::line("  added", format!("{} surfels, {:.1} %", extended.added, extended.percent));
    for (k, (group, own)) in extended.groups.iter().zip(sizes).enumerate() {
        let change = if group.scale == 1.0 && group.converged {
            format!("{} more", group.surfels - own)
        } else {
            let end = if group.converged { "" } else { ", not converged" };
            format!("radii times {}{end}", report::short(group.scale.into()))
        };
        let [before, after] = [group.before, group.after].map(|part| 100.0 * part);
        let covered = format!("covers {before:.2} %, then {after:.2} %");
        report::line(&format!("  group {k}"), format!("{own} surfels, {change}; {covered}"));
    }
}
