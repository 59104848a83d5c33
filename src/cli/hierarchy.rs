//! Hierarchies in folders: `splatref surfels SCENE -o folder/` makes one, `splatref info` describes
//! it.

use super::report::{self, line};
use super::{Ended, Ending, output, progress};
use glam::Vec3;
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::hierarchy::{Built, Hierarchy, NONE, Object};
use splatref::io::scene_file::SceneFile;
use splatref::source::hierarchy::{Flaws, Numbers, Settings};
use std::path::Path;
use std::time::Instant;

/// Whether an output is a folder: it exists as one, its name ends with a slash, or it has no
/// extension.
pub(super) fn is_folder(path: &Path) -> bool {
    let slash = path.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    slash || path.is_dir() || path.extension().is_none()
}

/// Makes the hierarchy of a scene, or resumes one.
pub(super) fn make(scene: &Path, folder: &Path, settings: &Settings, threads: usize) -> Ended {
    output::check_folder(folder)?;
    let file = SceneFile::open(scene)?;
    let exec = Exec::new(threads, 32)?;
    let start = Instant::now();
    let steps = progress::Steps::new("loading");
    let built =
        file.approximate(folder, settings, &exec, &|what, done, of| steps.show(what, done, of));
    drop(steps);
    let Built { geometries, nodes, found, unseen } = built?;
    for (name, _, flaws) in &geometries {
        told(name, *flaws);
    }
    let there =
        if found > 0 { format!(", {found} of them from an earlier run") } else { String::new() };
    line("nodes", format!("{nodes} approximated{there}"));
    if unseen > 0 {
        line("unseen", format!("{unseen} nodes; no pixel sees a triangle of theirs"));
    }
    sizes(&Hierarchy::open(folder)?);
    line("time", format!("{:.2} s", start.elapsed().as_secs_f64()));
    line("folder", folder.display());
    Ok(Ending::Good)
}

/// Describes a folder.
pub(super) fn info(folder: &Path) -> Result<()> {
    let hierarchy = Hierarchy::open(folder)?;
    let mut all = Flaws::default();
    for geometry in hierarchy.geometries() {
        all = all.and(geometry.flaws);
    }
    sizes(&hierarchy);
    told("meshes", all);
    if hierarchy.upper() > 0 {
        let root = &hierarchy.nodes()[0];
        // Boxes of nodes over objects are one f32 wider on each side; that is hidden here.
        let (low, high) = (root.low.map(f32::next_up), root.high.map(f32::next_down));
        report::bounds(low + Vec3::ZERO, high + Vec3::ZERO);
    }
    Ok(())
}

/// Prints how many nodes, objects and surfels there are.
fn sizes(hierarchy: &Hierarchy) {
    let (nodes, geometries) = (hierarchy.nodes(), hierarchy.geometries());
    let own: u64 = nodes.iter().map(|node| u64::from(node.triangles)).sum();
    let below = |object: &Object| nodes[hierarchy.root(object) as usize].below;
    let shown: u64 = hierarchy.objects().iter().map(below).sum();
    let (objects, unique) = (hierarchy.objects().len(), geometries.len());
    line("objects", format!("{objects} of {unique} geometries"));
    line("triangles", format!("{shown}, {own} of them unique"));
    let lods: Vec<_> = nodes.iter().filter(|node| node.surfels > 0).collect();
    let upper = lods.iter().filter(|node| node.geometry == NONE).count();
    line("approximations", format!("{}, {upper} of them cover several objects", lods.len()));
    let surfels: u64 = lods.iter().map(|node| u64::from(node.surfels)).sum();
    let Numbers { opacity, properties } = hierarchy.numbers();
    let bytes = (20 + 4 * properties.len() as u64) * surfels;
    line("surfels", format!("{surfels}, {bytes} bytes"));
    let further = properties.iter().map(|name| name.escape_debug().to_string());
    let all: Vec<_> = opacity.then(|| "opacities".into()).into_iter().chain(further).collect();
    if !all.is_empty() {
        line("  with", all.join(", "));
    }
}

/// Prints the flaws of a mesh, if it has any.
fn told(name: &str, flaws: Flaws) {
    let Flaws { dropped, degenerate, duplicate, edges_of_many } = flaws;
    let kinds = [
        (dropped, "triangles dropped, because a corner is missing or not finite"),
        (degenerate, "without an area"),
        (duplicate, "twice"),
        (edges_of_many, "edges of more than two triangles"),
    ];
    let kinds = kinds.iter().filter(|(count, _)| *count > 0);
    let kinds: Vec<String> = kinds.map(|(count, what)| format!("{count} {what}")).collect();
    if !kinds.is_empty() {
        line("flaws", format!("{name}: {}", kinds.join(", ")));
    }
}
