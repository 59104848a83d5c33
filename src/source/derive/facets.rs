//! Turn the triangles of a mesh into elliptical surfels, one for each.

use super::{Derive, Derived, Origin, drop_nowhere, primitives, texture};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::number::MapInline;
use crate::progress::Progress;
use crate::scene::light::is_color;
use crate::scene::{Cloud, Surfels};
use glam::{DVec3, Vec3};
use std::ops::{Add, Div};

/// The triangles of a cloud as surfels, in their order. Each surfel is the Steiner circumellipse,
/// the ellipse of least area that holds the triangle. It has the triangle's plane and centroid,
/// goes through its corners, and has 4 pi / sqrt(27), about 2.4, times its area.
///
/// For the corners a, b, c, in f64:
///
/// ```text
///   place      g = (a + b + c) / 3
///   tangents   p = c - g       q = (b - a) / sqrt(3)        two conjugate half axes
///   radius     sqrt((p.p + q.q + h) / 2)                    the longer one of the ellipse's axes
///              h = sqrt(d d + m m), d = p.p - q.q, m = 2 (p.q)
///   normal     (b - a) x (c - a), turned if the file has normals and its dot product with their sum
///              (n_a + n_b) + n_c is < 0; divided by its length, plus 0
/// ```
///
/// Each result is rounded to `f32` once; products x.y and lengths are sums in the order x, y, z.
/// Colour and opacity are the means of the corners', ((a + b) + c) / 3 in `f32`. A triangle is
/// dropped and counted if the colour or opacity of a corner is invalid, as the corner itself would
/// be. If a texture has been read, the colour comes from the texture, see the module. A colour of
/// the triangle itself is used if the corners have none.
///
/// `Decided:` the corners' normals say which side is the front, because files wind their triangles
/// either way. Radii and tangents of the file are ignored. Prefiltered colours are left out,
/// because they depend on the radii. A triangle without area becomes a surfel without a normal,
/// which is dropped and counted.
///
/// # Errors
/// [`Error::Invalid`] as [`super::surfels`], if there are no triangles, or if the points have
/// groups, because groups say nothing about triangles.
pub fn facets(mut cloud: Cloud, exec: &Exec, progress: Progress<'_>) -> Result<(Surfels, Derived)> {
    primitives::some_triangles(&cloud)?;
    cloud.check()?;
    if cloud.groups.is_some() {
        return Err(Error::Invalid("facets have no groups: draw points, or remove `group`".into()));
    }
    let nowhere = drop_nowhere(&mut cloud)?;
    let count = cloud.triangles.len();
    memory::ask(count as u64 * BYTES_A_FACET, || format!("{count} facets"))?;
    let colors = texture::facets(&cloud, exec, progress)?;
    let mut found = ellipses(&cloud);
    if let Some((color, mipmap)) = colors {
        (found.color, found.mipmap) = (Some(color), mipmap);
    }
    let (surfels, mut dropped) = Surfels::new_with(found, exec)?;
    dropped.position += nowhere;
    let (normals, radii) = (Origin::Facets, Origin::Facets);
    Ok((surfels, Derived { normals, radii, dropped, dropped_primitives: 0 }))
}

/// The default choice: [`facets`] for a mesh whose points have no extent of their own, else
/// [`super::surfels`]. Such a mesh has triangles, and neither radii, half axes nor groups of
/// points, and no radius is asked for.
///
/// `Decided:` by measurement. The error against the mesh itself is smaller with facets than with
/// points of derived radii, because facets end where the surface ends. This holds in six scans and
/// three cylinders, by four methods, each in one view and three sizes (bench `meshes`).
///
/// # Errors
/// The errors of these two.
pub fn facets_or_surfels(
    cloud: Cloud,
    options: &Derive,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Surfels, Derived)> {
    if is_bare_mesh(&cloud, options) {
        facets(cloud, exec, progress)
    } else {
        super::surfels(cloud, options, exec, progress)
    }
}

fn is_bare_mesh(cloud: &Cloud, options: &Derive) -> bool {
    let Cloud { triangles, radius, tangents, groups, .. } = cloud;
    let own = radius.is_some() || tangents.is_some() || groups.is_some();
    !triangles.is_empty() && !own && options.radius.is_none()
}

/// Bytes that a facet and its checks take.
const BYTES_A_FACET: u64 = 128;

/// One complete point for each triangle.
fn ellipses(cloud: &Cloud) -> Cloud {
    let Cloud { position, triangles, normal, color, opacity, .. } = cloud;
    let found: Vec<Facet> = triangles
        .iter()
        .map(|triangle| {
            let side = normal.as_ref().map(|all| {
                let [a, b, c] = triangle.map_inline(|i| all[i as usize].as_dvec3());
                a + b + c
            });
            Facet::new(triangle.map_inline(|i| position[i as usize].as_dvec3()), side)
        })
        .collect();
    let own = cloud.triangle_color.clone();
    let color =
        color.as_ref().map(|all| means(triangles, all, |c| is_color(*c), Vec3::NAN)).or(own);
    let is_opacity = |o: &f32| (0.0..=1.0).contains(o);
    let opacity = opacity.as_ref().map(|all| means(triangles, all, is_opacity, f32::NAN));
    Cloud {
        position: found.iter().map(|f| f.place).collect(),
        normal: Some(found.iter().map(|f| f.normal).collect()),
        radius: Some(found.iter().map(|f| f.radius).collect()),
        tangents: Some(found.iter().map(|f| f.tangents).collect()),
        color,
        opacity,
        ..Cloud::default()
    }
}

/// The mean of the corners of each triangle; `none`, which is dropped later, if `can_be` refuses a
/// corner.
fn means<T: Copy + Add<Output = T> + Div<f32, Output = T>>(
    triangles: &[[u32; 3]],
    all: &[T],
    can_be: impl Fn(&T) -> bool,
    none: T,
) -> Vec<T> {
    let mean = |triangle: &[u32; 3]| {
        let corners = triangle.map_inline(|i| all[i as usize]);
        let [a, b, c] = corners;
        if corners.iter().all(&can_be) { (a + b + c) / 3.0 } else { none }
    };
    triangles.iter().map(mean).collect()
}

/// The surfel of a triangle.
struct Facet {
    place: Vec3,
    tangents: [Vec3; 2],
    radius: f32,
    normal: Vec3,
}

impl Facet {
    /// The surfel of these corners; its front is towards `side`, if that is known.
    fn new([a, b, c]: [DVec3; 3], side: Option<DVec3>) -> Self {
        let g = (a + b + c) / 3.0;
        let (p, q) = (c - g, (b - a) / 3.0_f64.sqrt());
        let (pp, qq, m) = (p.dot(p), q.dot(q), 2.0 * p.dot(q));
        let d = pp - qq;
        let h = (d * d + m * m).sqrt();
        let across = (b - a).cross(c - a);
        let across = if side.is_some_and(|side| across.dot(side) < 0.0) { -across } else { across };
        let length = across.length();
        Self {
            place: g.as_vec3(),
            tangents: [p, q].map_inline(|axis| axis.as_vec3()),
            radius: ((pp + qq + h) / 2.0).sqrt() as f32,
            normal: if length > 0.0 {
                (across / length).as_vec3() + Vec3::ZERO
            } else {
                Vec3::ZERO
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary::{cos, sin};
    use crate::number::random::unit;
    use crate::scene::Groups;

    /// The ellipse goes through the corners and its area is 4 pi / sqrt(27) of the triangle's: the
    /// only such ellipse around the centroid.
    #[test]
    fn the_ellipse_is_that_of_steiner() {
        for seed in 0..200 {
            let at = |k: u64| f64::from(unit(seed, k)) * 8.0 - 4.0;
            let corner = |k: u64| DVec3::new(at(3 * k), at(3 * k + 1), at(3 * k + 2));
            let corners = [corner(0), corner(1), corner(2)];
            let facet = Facet::new(corners, None);
            let [u, v] = facet.tangents.map(|t| t.as_dvec3());
            let across = u.cross(v);
            for corner in corners {
                // Coordinates in the frame of the two tangents.
                let offset = corner - facet.place.as_dvec3();
                let x = offset.cross(v).dot(across) / across.length_squared();
                let y = u.cross(offset).dot(across) / across.length_squared();
                let close = (x * x + y * y - 1.0).abs();
                assert!(close < 1e-4, "{corners:?}: {close:e}");
                assert!(offset.dot(facet.normal.as_dvec3()).abs() < 1e-5, "its plane");
            }
            let [a, b, c] = corners;
            let area = (b - a).cross(c - a).length() / 2.0;
            let ratio = std::f64::consts::PI * across.length() / area;
            assert!((ratio - 4.0 * std::f64::consts::PI / 27.0_f64.sqrt()).abs() < 1e-4);
            // The farthest point of the rim, by a search.
            let rim = |i: u32| {
                let angle = f64::from(i) * std::f64::consts::TAU / 1e4;
                (u * cos(angle) + v * sin(angle)).length()
            };
            let farthest = (0..10_000).map(rim).max_by(f64::total_cmp).unwrap();
            assert!((farthest / f64::from(facet.radius) - 1.0).abs() < 1e-5, "{corners:?}");
        }
    }

    fn cloud() -> Cloud {
        let p = |x: f32, y: f32| Vec3::new(x, y, 1.0);
        Cloud {
            position: vec![p(0.0, 0.0), p(3.0, 0.0), p(0.0, 3.0), p(6.0, 0.0), p(f32::NAN, 0.0)],
            color: Some((0..5).map(|i| Vec3::splat(i as f32)).collect()),
            opacity: Some(vec![0.0, 0.5, 1.0, 1.0, 1.0]),
            triangles: vec![[0, 1, 2], [0, 1, 3], [1, 4, 2], [2, 1, 0]],
            ..Cloud::default()
        }
    }

    #[test]
    fn a_triangle_is_a_surfel_or_counted() {
        let (surfels, derived) = facets(cloud(), &Exec::sequential(), &|_, _, _| ()).unwrap();
        assert_eq!(surfels.position(), [Vec3::new(1.0, 1.0, 1.0); 2]);
        assert_eq!(surfels.normal(), [Vec3::Z, -Vec3::Z], "by the order of the corners");
        assert_eq!(surfels.color(), Some([Vec3::ONE; 2].as_slice()));
        assert_eq!(surfels.opacity(), Some([0.5; 2].as_slice()));
        let normal = Some(vec![Vec3::Z, Vec3::Z, Vec3::new(0.0, 1.0, -1.5), Vec3::Z, Vec3::Z]);
        let turned =
            facets(Cloud { normal, ..cloud() }, &Exec::sequential(), &|_, _, _| ()).unwrap().0;
        assert_eq!(turned.normal(), [Vec3::Z; 2], "the corners' normals say the side");
        // A point that is nowhere, with its triangle, and a triangle without area.
        assert_eq!((derived.dropped.position, derived.dropped.normal), (1, 1));
    }

    /// -1 and 3 are 1 in the mean: a corner that would be dropped as a point spoils its triangles.
    #[test]
    fn what_no_corner_may_have_is_not_averaged_away() {
        let two = || Cloud { triangles: vec![[0, 1, 2], [1, 3, 2]], ..cloud() };
        let whole = facets(two(), &Exec::sequential(), &|_, _, _| ()).unwrap().0;
        assert_eq!(whole.len(), 2);
        for wrong in [-1.0, f32::NAN, 3e38] {
            let mut color = vec![Vec3::ONE; 5];
            color[3].y = wrong;
            let mut opacity = vec![0.5; 5];
            opacity[3] = if wrong == 3e38 { 1.25 } else { wrong };
            let colored = Cloud { color: Some(color), ..two() };
            let dim = Cloud { opacity: Some(opacity), ..two() };
            for cloud in [colored, dim] {
                let (surfels, derived) = facets(cloud, &Exec::sequential(), &|_, _, _| ()).unwrap();
                assert_eq!(surfels.position(), &whole.position()[..1], "{wrong}");
                assert_eq!(derived.dropped.attribute, 1, "{wrong}");
            }
        }
    }

    #[test]
    fn a_mesh_is_bare_without_any_extent_of_its_points() {
        let bare = |cloud: Cloud, radius| is_bare_mesh(&cloud, &Derive { radius });
        assert!(bare(cloud(), None) && !bare(cloud(), Some(1.0)));
        let groups = Groups::new(vec![0; 5], Vec::new(), vec![1.0]).ok();
        for cloud in [
            Cloud { triangles: Vec::new(), ..cloud() },
            Cloud { radius: Some(vec![1.0; 5]), ..cloud() },
            Cloud { tangents: Some(vec![[Vec3::X, Vec3::Y]; 5]), ..cloud() },
            Cloud { groups, ..cloud() },
        ] {
            assert!(!bare(cloud, None));
        }
    }

    #[test]
    fn points_with_groups_and_clouds_without_triangles_are_refused() {
        let grouped = Groups::new(vec![0, 0, 0, 1, 1], Vec::new(), vec![1.0; 2]).unwrap();
        for cloud in
            [Cloud { groups: Some(grouped), ..cloud() }, Cloud { triangles: Vec::new(), ..cloud() }]
        {
            assert!(matches!(
                facets(cloud, &Exec::sequential(), &|_, _, _| ()),
                Err(Error::Invalid(_))
            ));
        }
    }
}
