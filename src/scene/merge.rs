//! Join several models into one: their clouds, and their primitives.

use crate::error::{Error, Result};
use crate::number::MapInline;
use crate::scene::cloud::half_axes;
use crate::scene::indexed::Indexed;
use crate::scene::{Cloud, Mipmap, Primitives, Property, Vertices};
use glam::Vec3;

/// Joins complete clouds, with normals and radii, in their order. The result has no triangles,
/// edges, texture coordinates, tangents of tubes or further properties. Groups of several clouds
/// are left out too, because their numbers mean different things.
///
/// If only some clouds have an attribute, it is filled in for the others: colour by `color`,
/// opacity by 1, the half axes of a disc by [`half_axes`], prefiltered colours by the last level
/// that there is, or by the colour. A single cloud stays as it is; nothing is filled in.
#[must_use]
pub fn merge(mut clouds: Vec<Cloud>, color: Vec3) -> Cloud {
    let colored = clouds.iter().any(|c| c.color.is_some());
    let veiled = clouds.iter().any(|c| c.opacity.is_some());
    let elliptic = clouds.iter().any(|c| c.tangents.is_some());
    let levels = clouds.iter().filter_map(|c| c.mipmap.as_ref()).map(Mipmap::levels).max();
    if clouds.len() == 1 {
        // A single cloud is the usual case; do not copy it.
        let one = clouds.remove(0);
        let (tangent, coordinates) = (None, None);
        let (properties, triangles, edges) = (vec![], vec![], vec![]);
        return Cloud { tangent, coordinates, properties, triangles, edges, ..one };
    }
    let mut all = Cloud {
        normal: Some(Vec::new()),
        radius: Some(Vec::new()),
        color: colored.then(Vec::new),
        opacity: veiled.then(Vec::new),
        tangents: elliptic.then(Vec::new),
        mipmap: levels.map(Mipmap::empty),
        ..Cloud::default()
    };
    for cloud in clouds {
        let n = cloud.position.len();
        let normal = cloud.normal.unwrap_or_default();
        let radius = cloud.radius.unwrap_or_default();
        if let Some(to) = &mut all.tangents {
            let discs = || normal.iter().zip(&radius).map(|(&n, &r)| half_axes(n, r)).collect();
            to.extend(cloud.tangents.unwrap_or_else(discs));
        }
        if let Some(to) = &mut all.mipmap {
            for i in 0..n {
                let own = cloud.color.as_ref().map_or(color, |own| own[i]);
                to.push(cloud.mipmap.as_ref().map(|mipmap| mipmap.of_surfel(i)), own);
            }
        }
        append(&mut all.color, cloud.color, n, color);
        append(&mut all.opacity, cloud.opacity, n, 1.0);
        all.position.extend(cloud.position);
        append(&mut all.normal, Some(normal), n, Vec3::ZERO);
        append(&mut all.radius, Some(radius), n, 0.0);
    }
    all
}

/// Joins primitives kind by kind, in their order. If only some of a kind have colours, the others
/// get `color`. If only some have opacities, the others get 1. `Decided:` a missing further
/// property is not filled in, because no one knows what 0 would mean for it.
///
/// # Errors
/// [`crate::Error::Invalid`] as [`Indexed::new`], if there are too many primitives, or if not all
/// vertices have the same properties in the same order.
pub fn join(models: Vec<Primitives>, color: Vec3) -> Result<Primitives> {
    let (mut triangles, mut ribbons, mut tubes) = (Vec::new(), Vec::new(), Vec::new());
    for model in models {
        triangles.push(model.triangles);
        ribbons.push(model.ribbons);
        tubes.push(model.tubes);
    }
    let (triangles, ribbons) = (join_kind(triangles, color)?, join_kind(ribbons, color)?);
    Ok(Primitives { triangles, ribbons, tubes: join_kind(tubes, color)? })
}

fn join_kind<const N: usize>(mut parts: Vec<Indexed<N>>, color: Vec3) -> Result<Indexed<N>> {
    parts.retain(|part| !part.is_empty());
    if parts.len() == 1 {
        // A single part is the usual case; do not copy it.
        return Ok(parts.remove(0));
    }
    let colored = parts.iter().any(|part| part.vertices().color.is_some());
    let veiled = parts.iter().any(|part| part.vertices().opacity.is_some());
    let mut all = Vertices {
        color: colored.then(Vec::new),
        opacity: veiled.then(Vec::new),
        properties: of_all(&parts)?,
        ..Vertices::default()
    };
    let mut joined = Vec::new();
    for part in parts {
        let (vertices, corners) = part.into_parts();
        // An overflow is refused below, where the vertices are counted.
        let first = all.position.len() as u32;
        joined.extend(
            corners.into_iter().map(|corners| corners.map_inline(|i| first.wrapping_add(i))),
        );
        let n = vertices.position.len();
        append(&mut all.color, vertices.color, n, color);
        append(&mut all.opacity, vertices.opacity, n, 1.0);
        let properties = all.properties.iter_mut().zip(vertices.properties);
        properties.for_each(|(to, from)| to.values.extend(from.values));
        all.position.extend(vertices.position);
        all.direction.extend(vertices.direction);
        all.radius.extend(vertices.radius);
    }
    // This drops nothing, because each part has been checked.
    Ok(Indexed::new(all, joined)?.0)
}

/// The properties that the vertices of every part have, without values.
fn of_all<const N: usize>(parts: &[Indexed<N>]) -> Result<Vec<Property>> {
    let names = |part: &Indexed<N>| {
        let all = part.vertices().properties.iter();
        all.map(|one| one.name.clone()).collect::<Vec<_>>()
    };
    let first = parts.first().map(names).unwrap_or_default();
    if let Some(other) = parts.iter().map(names).find(|names| *names != first) {
        let [a, b] = [first, other].map(|names| names.join(", "));
        let what =
            format!("models have different vertex properties, [{a}] and [{b}]; give all the same");
        return Err(Error::Invalid(what));
    }
    Ok(first.into_iter().map(|name| Property { name, values: Vec::new() }).collect())
}

/// Appends the values, or `n` times `missing`, if there is an array to append to.
fn append<T: Clone>(to: &mut Option<Vec<T>>, values: Option<Vec<T>>, n: usize, missing: T) {
    if let Some(to) = to {
        to.extend(values.unwrap_or_else(|| vec![missing; n]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn cloud(n: usize) -> Cloud {
        Cloud {
            position: vec![Vec3::ONE; n],
            normal: Some(vec![Vec3::new(0.6, 0.0, 0.8); n]),
            radius: Some(vec![2.0; n]),
            ..Cloud::default()
        }
    }

    #[test]
    fn what_is_missing_is_filled_in() {
        let second = Cloud {
            color: Some(vec![Vec3::X; 2]),
            opacity: Some(vec![0.5; 2]),
            tangents: Some(vec![[Vec3::X, Vec3::Y]; 2]),
            ..cloud(2)
        };
        let all = merge(vec![cloud(1), second, cloud(1)], Vec3::Y);
        all.check().unwrap();
        assert_eq!(all.position.len(), 4);
        assert_eq!(all.color, Some(vec![Vec3::Y, Vec3::X, Vec3::X, Vec3::Y]));
        assert_eq!(all.opacity, Some(vec![1.0, 0.5, 0.5, 1.0]));
        let tangents = all.tangents.unwrap();
        assert_eq!(tangents[1..3], [[Vec3::X, Vec3::Y]; 2]);
        let [u, v] = tangents[3].map(|half| half.as_dvec3());
        let normal = DVec3::new(0.6, 0.0, 0.8);
        assert!((u.length() - 2.0).abs() < 1e-6 && (v.length() - 2.0).abs() < 1e-6);
        assert!((u.cross(v) - 4.0 * normal).length() < 1e-6, "right-handed with the normal");
    }

    #[test]
    fn half_axes_have_the_bits_of_their_formula() {
        let third = 1.0_f32 / 3.0_f32.sqrt();
        let cases = [
            (Vec3::splat(third), 0),
            (Vec3::Z, 0),
            (-Vec3::X, 1),
            (Vec3::new(0.6, -0.8, 0.0), 2),
            (Vec3::new(0.48, 0.6, -0.64), 0),
            (Vec3::new(-0.64, 0.48, 0.6), 1),
            (Vec3::new(0.6, 0.48, 0.48), 1),
        ];
        for (normal, shortest) in cases {
            let n = normal.to_array().map(f64::from);
            let mut axis = [0.0; 3];
            axis[shortest] = 1.0;
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
            };
            let c = cross(axis, n);
            let inverse = 1.0 / ((c[0] * c[0] + c[1] * c[1]) + c[2] * c[2]).sqrt();
            let u = c.map(|component| component * inverse);
            let bits = |half: [f64; 3]| half.map(|c| ((c * f64::from(0.3_f32)) as f32).to_bits());
            let found = half_axes(normal, 0.3).map(|half| half.to_array().map(f32::to_bits));
            assert_eq!(found, [bits(u), bits(cross(n, u))], "{normal}");
        }
    }

    #[test]
    fn primitives_are_joined_kind_by_kind() {
        let line = |x: f32, color: Option<Vec3>| {
            let vertices = Vertices {
                position: vec![Vec3::X * x, Vec3::Y],
                direction: vec![Vec3::Z; 2],
                radius: vec![x; 2],
                color: color.map(|color| vec![color; 2]),
                ..Vertices::default()
            };
            Indexed::new(vertices, vec![[0, 1]]).unwrap().0
        };
        let ribbons = Primitives { ribbons: line(1.0, None), ..Primitives::default() };
        let both = Primitives {
            ribbons: line(2.0, Some(Vec3::X)),
            tubes: line(3.0, None),
            ..ribbons.clone()
        };
        let all = join(vec![ribbons.clone(), Primitives::default(), both], Vec3::Y).unwrap();
        assert_eq!(all.ribbons.corners(), [[0, 1], [2, 3]]);
        let vertices = all.ribbons.vertices();
        assert_eq!(vertices.position, [Vec3::X, Vec3::Y, 2.0 * Vec3::X, Vec3::Y]);
        assert_eq!(vertices.radius, [1.0, 1.0, 2.0, 2.0]);
        assert_eq!(
            vertices.color.as_deref(),
            Some([Vec3::Y, Vec3::Y, Vec3::X, Vec3::X].as_slice())
        );
        assert_eq!((all.tubes, all.triangles.len()), (line(3.0, None), 0));
        assert_eq!(join(vec![ribbons.clone()], Vec3::Y).unwrap(), ribbons, "one stays as it is");
        assert_eq!(join(vec![], Vec3::Y).unwrap(), Primitives::default());
    }

    #[test]
    fn opacities_are_filled_in_and_properties_are_not() {
        let part = |opacity: Option<f32>, names: &[&str]| {
            let property = |name: &&str| Property { name: (*name).into(), values: vec![3.0; 2] };
            let vertices = Vertices {
                position: vec![Vec3::ZERO; 2],
                direction: vec![Vec3::Z; 2],
                radius: vec![0.0; 2],
                opacity: opacity.map(|opacity| vec![opacity; 2]),
                properties: names.iter().map(property).collect(),
                ..Vertices::default()
            };
            let tubes = Indexed::new(vertices, vec![[0, 1]]).unwrap().0;
            Primitives { tubes, ..Primitives::default() }
        };
        let all = join(vec![part(None, &["a", "b"]), part(Some(0.25), &["a", "b"])], Vec3::Y);
        let all = all.unwrap().tubes.into_parts().0;
        assert_eq!(all.opacity, Some(vec![1.0, 1.0, 0.25, 0.25]));
        assert_eq!(all.properties.iter().map(|one| one.values.len()).collect::<Vec<_>>(), [4, 4]);
        for other in [&["b", "a"][..], &["a"], &[]] {
            let line = join(vec![part(None, &["a", "b"]), part(None, other)], Vec3::Y).unwrap_err();
            let what = format!("[a, b] and [{}]; give all the same", other.join(", "));
            assert!(line.to_string().ends_with(&what), "{line}");
        }
    }

    #[test]
    fn what_nobody_has_is_not_allocated() {
        let all = merge(vec![cloud(1), cloud(3)], Vec3::Y);
        assert_eq!((all.position.len(), all.radius), (4, Some(vec![2.0; 4])));
        assert!(all.color.is_none() && all.opacity.is_none() && all.tangents.is_none());
        assert_eq!(merge(vec![cloud(2)], Vec3::Y), cloud(2), "one model stays as it is");
    }
}
