//! Give the colours of triangles to their corners, see [`super`].

use crate::number::MapInline;
use crate::scene::Cloud;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// The mean colour of the triangles at each point, weighted by area, if triangles have colours.
pub(super) fn means(cloud: &Cloud) -> Option<Vec<Vec3>> {
    let colors = cloud.triangle_color.as_ref()?;
    let mut sums = vec![(0.0, DVec3::ZERO); cloud.position.len()];
    for (triangle, color) in cloud.triangles.iter().zip(colors) {
        let [a, b, c] = triangle.map_inline(|i| cloud.position[i as usize].as_dvec3());
        let weight = (b - a).cross(c - a).length();
        for &i in triangle {
            let (area, sum) = &mut sums[i as usize];
            *area += weight;
            *sum += color.as_dvec3() * weight;
        }
    }
    Some(sums.into_iter().map(|(area, sum)| (sum / area).as_vec3()).collect())
}

/// Gives each triangle corners of its own colour: a point becomes one for each colour. `normal` is
/// one for each point.
pub(super) fn split(cloud: &mut Cloud, normal: &mut Vec<Vec3>) {
    let Some(colors) = cloud.triangle_color.take() else { return };
    let mut first: Vec<Option<Vec3>> = vec![None; cloud.position.len()];
    let mut others = BTreeMap::new();
    // Equal bits are one colour, NaN too.
    let bits = |color: Vec3| color.to_array().map_inline(f32::to_bits);
    let mut more = Vec::new();
    for (triangle, &color) in cloud.triangles.iter_mut().zip(&colors) {
        for corner in triangle {
            let own = *first[*corner as usize].get_or_insert(color);
            if bits(own) == bits(color) {
                continue;
            }
            let next = first.len() + others.len();
            *corner = *others.entry((*corner, bits(color))).or_insert_with(|| {
                more.push((*corner, color));
                // An overflow is refused where the vertices are counted.
                next as u32
            });
        }
    }
    let again = |i: &(u32, Vec3)| i.0 as usize;
    cloud.position.extend(more.iter().map(again).map(|i| cloud.position[i]).collect::<Vec<_>>());
    normal.extend(more.iter().map(again).map(|i| normal[i]).collect::<Vec<_>>());
    if let Some(opacity) = &mut cloud.opacity {
        opacity.extend(more.iter().map(again).map(|i| opacity[i]).collect::<Vec<_>>());
    }
    for values in cloud.properties.iter_mut().map(|one| &mut one.values) {
        values.extend(more.iter().map(again).map(|i| values[i]).collect::<Vec<_>>());
    }
    let color = first.into_iter().map(|color| color.unwrap_or(Vec3::ONE));
    cloud.color = Some(color.chain(more.iter().map(|(_, color)| *color)).collect());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use crate::scene::Property;
    use crate::source::derive::{Derive, facets, polygons, surfels};

    /// A square of two triangles, the second twice as large: red, and blue.
    fn square() -> Cloud {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        Cloud {
            position: vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0), p(2.0, 1.0)],
            properties: vec![Property { name: "heat".into(), values: vec![0.0, 1.0, 2.0, 3.0] }],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            triangle_color: Some(vec![Vec3::X, Vec3::Z]),
            ..Cloud::default()
        }
    }

    #[test]
    fn facets_have_the_colour_of_their_triangle() {
        let (found, _) = facets(square(), &Exec::sequential(), &|_, _, _| ()).unwrap();
        assert_eq!(found.color(), Some(&[Vec3::X, Vec3::Z][..]));
        let white = Cloud { color: Some(vec![Vec3::ONE; 4]), ..square() };
        let (found, _) = facets(white, &Exec::sequential(), &|_, _, _| ()).unwrap();
        assert_eq!(found.color(), Some(&[Vec3::ONE; 2][..]), "colours of vertices win");
    }

    #[test]
    fn points_have_the_mean_by_area() {
        let options = Derive::default();
        let (found, _) = surfels(square(), &options, &Exec::sequential(), &|_, _, _| ()).unwrap();
        let mixed = Vec3::new((1.0_f64 / 3.0) as f32, 0.0, (2.0_f64 / 3.0) as f32);
        assert_eq!(found.color(), Some(&[Vec3::X, mixed, mixed, Vec3::Z][..]));
    }

    #[test]
    fn polygons_have_corners_of_one_colour_and_common_normals() {
        let (found, _) = polygons(square(), &Exec::sequential(), &|_, _, _| ()).unwrap();
        assert_eq!(found.corners(), [[0, 1, 2], [4, 3, 5]]);
        let vertices = found.vertices();
        let colors = vertices.color.as_ref().unwrap();
        assert_eq!(colors[..], [Vec3::X, Vec3::X, Vec3::X, Vec3::Z, Vec3::Z, Vec3::Z]);
        assert_eq!(vertices.position[4..], [Vec3::X, Vec3::Y]);
        assert_eq!(vertices.properties[0].values[4..], [1.0, 2.0]);
        assert_eq!((vertices.direction.len(), vertices.direction[5]), (6, Vec3::Z));
    }
}
