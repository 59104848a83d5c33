//! Turn the triangles and edges of a cloud into polygons, ribbons and tubes.

use super::{
    Derive, Derived, Origin, complete, drop_nowhere, face_colors, faces, given, missing_normals,
    texture,
};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::number::MapInline;
use crate::progress::Progress;
use crate::scene::indexed::{self, Indexed};
use crate::scene::{Cloud, Dropped, Polylines, Surfels, Triangles, Vertices};
use crate::source::hybrid::{HalfSpace, split};
use glam::{DVec3, Vec3};
use std::cell::OnceCell;

/// The triangles of a cloud as polygons. Every radius is 0, so that polygons are not extended.
///
/// Missing normals are derived as for surfels, see the module, and so are colours of a texture.
/// Vertices keep opacities and [properties](Cloud::properties). A triangle is dropped and counted
/// if the opacity of a corner is not in [0, 1], or if a property is not finite. It is no part of
/// the mesh, so that derived normals ignore it.
///
/// # Errors
/// [`Error::Invalid`] as [`super::surfels`], if there are no triangles, or if each has a corner
/// that is degenerate or has an invalid opacity or property.
pub fn polygons(
    mut cloud: Cloud,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Triangles, Derived)> {
    some_triangles(&cloud)?;
    let before = cloud.triangles.len();
    cloud.check()?;
    drop_unsound(&mut cloud)?;
    drop_nowhere(&mut cloud)?;
    let (mut normal, normals) = match cloud.take_normals() {
        Some(normal) => (normal, Origin::File),
        None => missing_normals(&cloud, &OnceCell::new(), exec, progress)?,
    };
    if cloud.paint.is_some() {
        let reach = faces::radii(&cloud.position, &cloud.triangles);
        cloud = texture::points(cloud, &reach, exec, progress)?;
    }
    if cloud.color.is_none() {
        face_colors::split(&mut cloud, &mut normal);
    }
    let radius = vec![0.0; cloud.position.len()];
    let triangles = std::mem::take(&mut cloud.triangles);
    finish(before, cloud, normal, normals, radius, Origin::Zero, triangles)
}

/// The triangles in a half space as polygons, and the rest of a mesh as surfels. Normals and radii
/// are derived from the whole mesh as in [`super::surfels`], then [`split`] divides it. One of the
/// two parts may be empty.
///
/// # Errors
/// [`Error::Invalid`] as [`super::surfels`], if there are no triangles, or if both parts are empty
/// in the end.
pub fn hybrid(
    cloud: Cloud,
    half: &HalfSpace,
    options: &Derive,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Surfels, Triangles, Derived)> {
    some_triangles(&cloud)?;
    let before = cloud.triangles.len();
    let (cloud, mut derived) = complete(cloud, options, exec, progress)?;
    let nowhere = (before - cloud.triangles.len()) as u64;
    let (points, mut mesh) = split(&cloud, half)?;
    let (surfels, dropped) = Surfels::new_or_none(points, exec)?;
    derived.dropped += dropped;
    let corners = std::mem::take(&mut mesh.triangles);
    let (normal, radius) = (mesh.normal.take(), mesh.radius.take());
    let vertices = vertices(bare(mesh), normal.unwrap_or_default(), radius.unwrap_or_default());
    let (triangles, degenerate) = Triangles::new(vertices, corners)?;
    derived.dropped_primitives = nowhere + degenerate;
    if surfels.is_empty() && triangles.is_empty() {
        let what = "the scene is empty: all of its points and triangles are degenerate";
        return Err(Error::Invalid(what.into()));
    }
    Ok((surfels, triangles, derived))
}

/// The edges of a cloud as ribbons. The file must give normals. Radii, which are half the widths,
/// come from the file or from the options.
///
/// # Errors
/// [`Error::Invalid`] if [`Cloud::check`] fails, if there are no edges, normals or radii, or if
/// each edge has an end that is degenerate.
pub fn ribbons(mut cloud: Cloud, options: &Derive) -> Result<(Polylines, Derived)> {
    let before = cloud.edges.len();
    let (radius, radius_from) = radii(&mut cloud, options, "ribbons")?;
    let Some(normal) = cloud.take_normals() else {
        return Err(Error::Invalid("ribbons need normals; give nx, ny and nz".into()));
    };
    let edges = std::mem::take(&mut cloud.edges);
    finish(before, bare(cloud), normal, Origin::File, radius, radius_from, edges)
}

/// The edges of a cloud as tubes. Radii come from the file or from the options.
///
/// `Decided:` if the file has no tangents, the tangent of a vertex is "the averaged direction of
/// the attached tube segments" \[MKC08, section 4.3\], as follows. The edges are taken in ascending
/// order. The direction of each edge, from its first to its second end and divided by its length,
/// in f64, is added to the sum at both its ends. It is subtracted instead if its dot product with
/// that sum is < 0. Each sum is divided by its length and rounded to `f32` once. An edge without
/// length adds nothing.
///
/// So edges may be stored in either direction, and nothing cancels. The signs agree along a line
/// only if the edges of the line follow each other.
///
/// # Errors
/// [`Error::Invalid`] if [`Cloud::check`] fails, if there are no edges or radii, or if each edge
/// has an end that is degenerate.
pub fn tubes(mut cloud: Cloud, options: &Derive) -> Result<(Polylines, Derived)> {
    let before = cloud.edges.len();
    let (radius, radius_from) = radii(&mut cloud, options, "tubes")?;
    let (tangent, tangent_from) = match cloud.tangent.take() {
        Some(tangent) => (tangent, Origin::File),
        None => (tangents(&cloud.position, &cloud.edges), Origin::Edges),
    };
    let edges = std::mem::take(&mut cloud.edges);
    finish(before, bare(cloud), tangent, tangent_from, radius, radius_from, edges)
}

/// Refuses a cloud without triangles.
pub(super) fn some_triangles(cloud: &Cloud) -> Result<()> {
    if cloud.triangles.is_empty() {
        let what = "there are no triangles to draw; give an element face, or draw points";
        return Err(Error::Invalid(what.into()));
    }
    Ok(())
}

/// Checks a cloud for lines, and takes its radii or the chosen one.
fn radii(cloud: &mut Cloud, options: &Derive, what: &str) -> Result<(Vec<f32>, Origin)> {
    if cloud.edges.is_empty() {
        let rest = "give an element edge, or draw points";
        return Err(Error::Invalid(format!("there are no edges to draw as {what}; {rest}")));
    }
    cloud.check()?;
    drop_nowhere(cloud)?;
    match (cloud.radius.take(), options.radius) {
        (Some(radius), _) => Ok((radius, Origin::File)),
        (None, Some(radius)) => Ok((given(radius, cloud.position.len())?, Origin::Given)),
        (None, None) => {
            let rest = "give the property radius, or one radius for all";
            Err(Error::Invalid(format!("{what} need radii; {rest}")))
        }
    }
}

/// Checks the primitives; at least one of `before` must be left.
fn finish<const N: usize>(
    before: usize,
    cloud: Cloud,
    direction: Vec<Vec3>,
    direction_from: Origin,
    radius: Vec<f32>,
    radius_from: Origin,
    corners: Vec<[u32; N]>,
) -> Result<(Indexed<N>, Derived)> {
    let (indexed, _) = Indexed::new(vertices(cloud, direction, radius), corners)?;
    if indexed.is_empty() {
        let what = if N == 3 { "triangles" } else { "edges" };
        let what = format!("the scene is empty: none of its {before} {what} can be drawn");
        return Err(Error::Invalid(what));
    }
    let dropped_primitives = (before - indexed.len()) as u64;
    let dropped = Dropped::default();
    let (normals, radii) = (direction_from, radius_from);
    Ok((indexed, Derived { normals, radii, dropped, dropped_primitives }))
}

fn vertices(cloud: Cloud, direction: Vec<Vec3>, radius: Vec<f32>) -> Vertices {
    let Cloud { position, color, opacity, properties, .. } = cloud;
    Vertices { position, direction, radius, color, opacity, properties }
}

/// The cloud without the attributes that only candidates need.
fn bare(cloud: Cloud) -> Cloud {
    Cloud { opacity: None, properties: Vec::new(), ..cloud }
}

/// Drops points whose opacity is not in [0, 1] or with a property that is not finite, and their
/// triangles.
///
/// # Errors
/// [`Error::Invalid`] if there were triangles and none is left.
pub(in crate::source) fn drop_unsound(cloud: &mut Cloud) -> Result<()> {
    if cloud.opacity.is_none() && cloud.properties.is_empty() {
        return Ok(());
    }
    let before = cloud.triangles.len();
    let sound = |i| indexed::sound(cloud.opacity.as_deref(), &cloud.properties, i);
    let keep: Vec<bool> = (0..cloud.position.len()).map(sound).collect();
    if keep.contains(&false) {
        cloud.retain(&keep);
    }
    if cloud.triangles.is_empty() && before > 0 {
        let what = format!(
            "none of its {before} triangles has corners with an opacity in [0, 1] and finite properties"
        );
        return Err(Error::Invalid(format!("the scene is empty: {what}")));
    }
    Ok(())
}

/// See [`tubes`]; null at vertices without an edge.
fn tangents(points: &[Vec3], edges: &[[u32; 2]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    for ends in edges {
        let [a, b] = ends.map_inline(|i| points[i as usize].as_dvec3());
        let length = (b - a).length();
        if !(length > 0.0) {
            continue;
        }
        let along = (b - a) / length;
        for &i in ends {
            let sum = &mut sums[i as usize];
            *sum += if sum.dot(along) < 0.0 { -along } else { along };
        }
    }
    let unit = |sum: DVec3| {
        let length = sum.length();
        if length > 0.0 { (sum / length).as_vec3() } else { Vec3::ZERO }
    };
    sums.into_iter().map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh() -> Cloud {
        // Two triangles in the plane z = 1, one of them at a point that is nowhere.
        let p = |x: f32, y: f32| Vec3::new(x, y, 1.0);
        Cloud {
            position: vec![p(f32::NAN, 0.0), p(0.0, 0.0), p(3.0, 0.0), p(0.0, 4.0), p(9.0, 9.0)],
            color: Some((0..5).map(|i| Vec3::splat(i as f32)).collect()),
            triangles: vec![[0, 1, 2], [1, 2, 3]],
            edges: vec![[1, 2], [3, 2], [0, 3]],
            ..Cloud::default()
        }
    }

    fn drawn(cloud: Cloud) -> Result<(Triangles, Derived)> {
        polygons(cloud, &Exec::sequential(), &|_, _, _| ())
    }

    #[test]
    fn polygons_have_normals_and_no_radii() {
        let (triangles, derived) = drawn(mesh()).unwrap();
        assert_eq!((derived.normals, derived.radii), (Origin::Triangles, Origin::Zero));
        assert_eq!((derived.dropped_primitives, derived.dropped.total()), (1, 0));
        assert_eq!(triangles.corners(), [[0, 1, 2]], "the lost point is gone");
        let vertices = triangles.vertices();
        assert_eq!(vertices.direction[..3], [Vec3::Z; 3]);
        assert_eq!(vertices.radius, [0.0; 4]);
        assert_eq!(vertices.color.as_ref().unwrap()[0], Vec3::ONE);

        let normal = Some(vec![2.0 * Vec3::Y; 5]);
        let (triangles, derived) = drawn(Cloud { normal, ..mesh() }).unwrap();
        assert_eq!((triangles.vertices().direction[0], derived.normals), (Vec3::Y, Origin::File));
    }

    #[test]
    fn a_hybrid_has_surfels_and_polygons() {
        let at = |d: f64| HalfSpace::new([1.0, 0.0, 0.0, d]).unwrap();
        let drawn = |half| {
            let options = Derive::default();
            hybrid(mesh(), &half, &options, &Exec::sequential(), &|_, _, _| ()).unwrap()
        };
        let (surfels, triangles, derived) = drawn(at(1.0));
        assert_eq!((surfels.len(), triangles.len()), (3, 0));
        assert_eq!(surfels.radius(), [5.0; 3], "the longest edge of the triangle");
        // The point that is nowhere, and the one that no triangle gives a normal.
        assert_eq!(derived.dropped, Dropped { position: 1, normal: 1, ..Dropped::default() });
        let (surfels, triangles, derived) = drawn(at(-1.0));
        assert_eq!((surfels, triangles.len()), (Surfels::none(), 1));
        assert_eq!((derived.dropped.total(), derived.dropped_primitives), (2, 1));
    }

    #[test]
    fn tangents_follow_the_edges() {
        let options = Derive { radius: Some(0.5) };
        let (tubes, derived) = tubes(mesh(), &options).unwrap();
        assert_eq!((derived.normals, derived.radii), (Origin::Edges, Origin::Given));
        assert_eq!((tubes.corners(), derived.dropped_primitives), ([[0, 1], [2, 1]].as_slice(), 1));
        let vertices = tubes.vertices();
        assert_eq!(vertices.radius, [0.5; 4]);
        // The edges are +x and (3/5, -4/5), which is stored against the line but turns by < 90.
        let (second, both) =
            (Vec3::new(0.6, -0.8, 0.0), Vec3::new(1.6, -0.8, 0.0) / 3.2_f32.sqrt());
        let expected = [Vec3::X, both, second, Vec3::ZERO];
        for (found, expected) in vertices.direction.iter().zip(expected) {
            assert!(found.distance(expected) < 1e-6, "{found} instead of {expected}");
        }
        let opposite = tangents(&[Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], &[[0, 1], [2, 1], [1, 1]]);
        assert_eq!(opposite, [Vec3::X, Vec3::X, -Vec3::X], "nothing cancels");
    }

    #[test]
    fn what_lines_need_is_taken_from_the_file() {
        let all = Cloud {
            normal: Some(vec![Vec3::Y; 5]),
            tangent: Some(vec![Vec3::Z; 5]),
            radius: Some(vec![0.25, 0.25, 0.125, -1.0, 1.0]),
            ..mesh()
        };
        let options = Derive { radius: Some(9.0) };
        let (ribbons, derived) = ribbons(all.clone(), &options).unwrap();
        assert_eq!((derived.normals, derived.radii), (Origin::File, Origin::File));
        assert_eq!((ribbons.corners(), derived.dropped_primitives), ([[0, 1]].as_slice(), 2));
        assert_eq!(ribbons.vertices().direction[0], Vec3::Y);
        assert_eq!(ribbons.vertices().radius[..2], [0.25, 0.125]);
        let (tubes, derived) = tubes(all, &options).unwrap();
        assert_eq!((tubes.vertices().direction[1], derived.normals), (Vec3::Z, Origin::File));
    }

    #[test]
    fn what_is_missing_is_one_line() {
        let none = Derive::default();
        let line = |error: Error| error.to_string();
        let points = Cloud { triangles: vec![], edges: vec![], ..mesh() };
        assert!(
            line(drawn(points.clone()).unwrap_err()).contains("there are no triangles to draw")
        );
        let half = HalfSpace::new([1.0, 0.0, 0.0, 0.0]).unwrap();
        let exec = Exec::sequential();
        let error = hybrid(points.clone(), &half, &none, &exec, &|_, _, _| ()).unwrap_err();
        assert!(line(error).contains("there are no triangles"));
        let error = line(ribbons(points.clone(), &none).unwrap_err());
        assert!(error.contains("there are no edges to draw as ribbons; give an element edge"));
        assert!(line(tubes(points, &none).unwrap_err()).contains("no edges to draw as tubes"));
        assert!(line(tubes(mesh(), &none).unwrap_err()).contains("tubes need radii; give"));
        assert!(line(ribbons(mesh(), &none).unwrap_err()).contains("ribbons need radii; give"));
        let asked = Derive { radius: Some(1.0) };
        assert!(line(ribbons(mesh(), &asked).unwrap_err()).contains("ribbons need normals; give"));
        let asked = Derive { radius: Some(-1.0) };
        assert!(line(tubes(mesh(), &asked).unwrap_err()).contains("give a finite number > 0"));
        let none = Cloud { color: Some(vec![Vec3::NAN; 5]), ..mesh() };
        let error = line(drawn(none).unwrap_err());
        assert_eq!(error, "the scene is empty: none of its 2 triangles can be drawn");
    }
}
