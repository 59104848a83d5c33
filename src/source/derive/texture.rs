//! Derive colours from a texture, see [`super`].

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::number::MapInline;
use crate::progress::Progress;
use crate::scene::texture::Ellipse;
use crate::scene::{Cloud, Coordinates, Mipmap, Paint};
use glam::{DVec3, Vec2, Vec3};

/// Surfels between two reports of progress.
const BATCH: usize = 1 << 14;
/// Bytes of the keys of a triangle's corners.
const BYTES_A_TRIANGLE: u64 = 3 * size_of::<Key>() as u64 + 16;

/// One colour for each surfel, and further levels.
type Colors = (Vec<Vec3>, Option<Mipmap>);

/// A corner: point, bits of u and v, triangle.
type Key = (u32, [u32; 2], u32);

/// The colours of the facets of a cloud, if there is a texture.
///
/// # Errors
/// [`Error::Invalid`] if there are no coordinates, or if the process may not hold the colours.
pub(super) fn facets(cloud: &Cloud, exec: &Exec, progress: Progress<'_>) -> Result<Option<Colors>> {
    let Some(paint) = &cloud.paint else { return Ok(None) };
    let coordinates = coordinates(cloud)?;
    let find = |i: usize, scale: f64| {
        let [a, b, c] = coordinates.corners(i, cloud.triangles[i]).map_inline(|at| at.as_dvec2());
        let center = ((a + b) + c) / 3.0;
        let outline = Ellipse::from_half_axes(c - center, (b - a) / 3.0_f64.sqrt());
        paint.color(center, outline.times(scale))
    };
    colors(paint, cloud.triangles.len(), &find, exec, progress).map(Some)
}

/// Gives points with these radii the colours of the texture, and removes the coordinates.
///
/// # Errors
/// As [`facets`].
pub(super) fn points(
    cloud: Cloud,
    radius: &[f32],
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Cloud> {
    let Some(paint) = &cloud.paint else { return Ok(Cloud { coordinates: None, ..cloud }) };
    let coordinates = coordinates(&cloud)?;
    let find: Box<dyn Fn(usize, f64) -> Vec3 + Sync> = match coordinates {
        Coordinates::Points(all) if cloud.triangles.is_empty() => {
            Box::new(|i, _| paint.color(all[i].as_dvec2(), Ellipse::default()))
        }
        _ => {
            let count = cloud.triangles.len();
            memory::ask(count as u64 * BYTES_A_TRIANGLE, || {
                format!("the corners of {count} triangles with a texture")
            })?;
            let keys = keys(&cloud.triangles, coordinates, exec);
            let cloud = &cloud;
            Box::new(move |i, scale| {
                let start = keys.partition_point(|key| (key.0 as usize) < i);
                let end = start + keys[start..].partition_point(|key| key.0 as usize == i);
                let size2 = size2(cloud, radius, i) * scale;
                of_groups(&keys[start..end], cloud, coordinates, paint, size2)
            })
        }
    };
    let (color, mipmap) = colors(paint, cloud.position.len(), &*find, exec, progress)?;
    drop(find);
    Ok(Cloud { color: Some(color), mipmap, coordinates: None, paint: None, ..cloud })
}

fn coordinates(cloud: &Cloud) -> Result<&Coordinates> {
    let missing = || Error::Invalid("the texture needs texture coordinates".into());
    cloud.coordinates.as_ref().ok_or_else(missing)
}

/// The colours and levels of all surfels; `find` gets the number of a surfel and a factor for its
/// matrix.
fn colors(
    paint: &Paint,
    count: usize,
    find: &(dyn Fn(usize, f64) -> Vec3 + Sync),
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Colors> {
    let levels = paint.levels();
    memory::ask(count as u64 * 12 * (levels as u64 + 1), || {
        format!("colours of {count} surfels of a texture")
    })?;
    let all = count as u64;
    let (mut color, mut more) = (Vec::with_capacity(count), Vec::with_capacity(count * levels));
    for start in (0..count).step_by(BATCH) {
        progress("sampling the texture", start as u64, all);
        let some = BATCH.min(count - start);
        exec.extend(&mut color, some, |i| find(start + i, 1.0));
        exec.extend(&mut more, some * levels, |at| {
            let level = at % levels + 1;
            find(start + at / levels, (1_u64 << (2 * level)) as f64)
        });
    }
    progress("sampling the texture", all, all);
    let mipmap = (levels > 0).then(|| Mipmap::new(levels, more)).transpose()?;
    Ok((color, mipmap))
}

/// The corners of all triangles, sorted by point, then by coordinates.
fn keys(triangles: &[[u32; 3]], coordinates: &Coordinates, exec: &Exec) -> Vec<Key> {
    let bits = |at: Vec2| (at + Vec2::ZERO).to_array().map_inline(f32::to_bits);
    let mut keys = Vec::with_capacity(3 * triangles.len());
    for (i, corners) in triangles.iter().enumerate() {
        let at = coordinates.corners(i, *corners);
        keys.extend(corners.iter().zip(at).map(|(&corner, at)| (corner, bits(at), i as u32)));
    }
    // Equal keys are corners of one triangle, which has no area.
    exec.sort(&mut keys);
    keys
}

/// The square of a surfel's size: r r, or |U x V| with half axes U and V.
fn size2(cloud: &Cloud, radius: &[f32], i: usize) -> f64 {
    match &cloud.tangents {
        None => f64::from(radius[i]) * f64::from(radius[i]),
        Some(tangents) => {
            let [u, v] = tangents[i].map_inline(Vec3::as_dvec3);
            length(cross(u, v))
        }
    }
}

/// The colour of the point with these corners.
fn of_groups(
    corners: &[Key],
    cloud: &Cloud,
    coordinates: &Coordinates,
    paint: &Paint,
    size2: f64,
) -> Vec3 {
    let (mut sum, mut weight, mut groups) = (DVec3::ZERO, 0.0, 0);
    let mut last = Vec3::NAN;
    for group in corners.chunk_by(|a, b| a.1 == b.1) {
        let (mut matrix, mut area) = (Ellipse::default(), 0.0);
        for &(_, _, triangle) in group {
            let corners = cloud.triangles[triangle as usize];
            let places = corners.map_inline(|corner| cloud.position[corner as usize]);
            let Some((own, a)) = stretched(places, coordinates.corners(triangle as usize, corners))
            else {
                continue;
            };
            matrix.xx += own.xx;
            matrix.xy += own.xy;
            matrix.yy += own.yy;
            area += a;
        }
        if area > 0.0 {
            let at = Vec2::from_array(group[0].1.map_inline(f32::from_bits)).as_dvec2();
            last = paint.color(at, matrix.times(size2 / area));
            sum += last.as_dvec3() * area;
            weight += area;
            groups += 1;
        }
    }
    // One group's colour must not be rounded again; no group leaves NaN.
    if groups <= 1 { last } else { (sum / weight).as_vec3() }
}

/// S and A of a triangle, see the module; `None` without an area.
fn stretched(places: [Vec3; 3], at: [Vec2; 3]) -> Option<(Ellipse, f64)> {
    let [a, b, c] = places.map_inline(|place| place.as_dvec3());
    let (e, f) = (b - a, c - a);
    let area = length(cross(e, f));
    if !(area > 0.0) {
        return None;
    }
    let [a, b, c] = at.map_inline(|at| at.as_dvec2());
    let (x, y) = (b - a, c - a);
    let (ee, ef, ff) = (dot(e, e), dot(e, f), dot(f, f));
    let entry = |i: usize, j: usize| {
        ((x[i] * x[j] * ff - (x[i] * y[j] + y[i] * x[j]) * ef) + y[i] * y[j] * ee) / area
    };
    Some((Ellipse { xx: entry(0, 0), xy: entry(0, 1), yy: entry(1, 1) }, area))
}

/// The matrix in (u, v) of a disc of radius 1 in the plane of a triangle; 0 for a triangle without
/// an area.
pub(in crate::source) fn stretch(places: [Vec3; 3], at: [Vec2; 3]) -> Ellipse {
    stretched(places, at).map_or(Ellipse::default(), |(matrix, area)| matrix.times(1.0 / area))
}

fn dot(a: DVec3, b: DVec3) -> f64 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}

fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y)
}

fn length(a: DVec3) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests;
