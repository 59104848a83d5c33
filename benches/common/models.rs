//! Scans, which are not part of this repository, and denser samplings of their surfaces.

use super::report::Arguments;
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::grouping::{GroupingReport, Rules, group};
use splatref::io::ply;
use splatref::number::random::bits;
use splatref::scene::{Cloud, Surfels};
use std::path::PathBuf;

/// The scan of a name in the folder `SPLATREF_MODELS`, or `../shared/models` if that is not set.
pub(crate) fn path(name: &str) -> PathBuf {
    let folder = std::env::var_os("SPLATREF_MODELS");
    let folder = folder.map_or_else(|| PathBuf::from("../shared/models"), PathBuf::from);
    folder.join(name).with_extension("ply")
}

/// The scans that are there and whose name contains a pattern.
pub(crate) fn models(pattern: &str, arguments: &Arguments) -> Result<Vec<(&'static str, Cloud)>> {
    let mut found = Vec::new();
    for name in ["bunny", "dragon", "armadillo", "igea", "koala", "fandisk"] {
        let path = path(name);
        if !name.contains(pattern) {
            continue;
        }
        if path.exists() {
            found.push((name, ply::read(&path)?));
        } else {
            arguments.without(&path)?;
        }
    }
    Ok(found)
}

/// `count` points on the triangles of a mesh, evenly by area, with interpolated normals of any
/// length, interpolated colours if the mesh has them, and nothing else; the mesh has triangles and
/// normals.
///
/// Point i lies in the triangle at which the sum of the areas first exceeds the whole times random
/// number 3i of the seed, at the corners' mean with the weights 1 - s, s (1 - v), s v, where s is
/// the square root of number 3i + 1 and v number 3i + 2; all in f64.
pub(crate) fn resample(cloud: &Cloud, count: usize, seed: u64) -> Cloud {
    let corner = |i: u32| cloud.position[i as usize].as_dvec3();
    let mut whole = 0.0;
    let sums: Vec<f64> = (cloud.triangles.iter())
        .map(|&[a, b, c]| {
            let area = (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
            whole += if area.is_finite() { area } else { 0.0 };
            whole
        })
        .collect();
    let normals = cloud.normal.as_ref().expect("a mesh with normals");
    let random = |i: usize, k: u64| {
        (bits(seed, 3 * i as u64 + k) >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    };
    let sample = |i: usize| {
        let at = random(i, 0) * whole;
        let triangle = cloud.triangles[sums.partition_point(|&sum| sum <= at)];
        let (s, v) = (random(i, 1).sqrt(), random(i, 2));
        let weights = [1.0 - s, s * (1.0 - v), s * v];
        let mean = |of: &[glam::Vec3]| {
            let corners = triangle.map(|i| of[i as usize].as_dvec3());
            (corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]).as_vec3()
        };
        (mean(&cloud.position), (mean(normals), cloud.color.as_deref().map(mean)))
    };
    let (position, (normal, color)): (_, (_, Vec<_>)) = (0..count).map(sample).unzip();
    let color = color.into_iter().collect();
    Cloud { position, normal: Some(normal), color, ..Cloud::default() }
}

/// What comes of grouping with this c; none if there are too many groups.
pub(crate) fn divide(surfels: &Surfels, overlap: f32, exec: &Exec) -> Option<GroupingReport> {
    let rules = Rules { overlap, ..Rules::default() };
    group(surfels, &rules, exec, &|_, _, _| ()).ok().map(|found| found.1)
}

/// Radii times a factor, so that the average degree at c = 1 is this: the factor is found in three
/// steps as the degree is that of an area.
pub(crate) fn scaled(surfels: &Surfels, degree: f64, exec: &Exec) -> (Surfels, f64) {
    // The degree of a graph with few enough edges to be made.
    let mut factor = 0.5;
    for _ in 0..3 {
        let found = divide(&times(surfels, factor), 1.0, exec).expect("few groups");
        factor *= (degree / found.average_degree).sqrt();
    }
    (times(surfels, factor), factor)
}

fn times(surfels: &Surfels, factor: f64) -> Surfels {
    let mut cloud = surfels.clone().into_cloud();
    let radii = cloud.radius.iter_mut().flatten();
    radii.for_each(|radius| *radius = (f64::from(*radius) * factor) as f32);
    Surfels::new(cloud).expect("surfels").0
}
