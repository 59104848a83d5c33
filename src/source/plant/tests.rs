use super::*;
use crate::number::{elementary, random};

/// A mesh whose normals are +z.
fn mesh(position: Vec<Vec3>, corners: Vec<[u32; 3]>) -> Triangles {
    let n = position.len();
    let vertices = Vertices {
        position,
        direction: vec![Vec3::Z; n],
        radius: vec![0.0; n],
        color: None,
        ..Vertices::default()
    };
    Triangles::new(vertices, corners).unwrap().0
}

/// The numbers below `n`, in an order that depends on the seed.
fn order(n: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|&i| random::bits(seed, i as u64));
    order
}

/// The same mesh with its vertices and triangles in another order, each triangle turned, and some
/// turned over.
fn shuffled(mesh: &Triangles, seed: u64) -> Triangles {
    let from = mesh.vertices();
    let of = order(from.position.len(), seed);
    let mut to = vec![0; of.len()];
    for (new, &old) in of.iter().enumerate() {
        to[old] = new as u32;
    }
    let vertices = Vertices {
        position: of.iter().map(|&i| from.position[i]).collect(),
        direction: of.iter().map(|&i| from.direction[i]).collect(),
        radius: of.iter().map(|&i| from.radius[i]).collect(),
        color: from.color.as_ref().map(|color| of.iter().map(|&i| color[i]).collect()),
        ..Vertices::default()
    };
    let corners = order(mesh.len(), seed + 1).into_iter().map(|i| {
        let mut corners = mesh.corners()[i].map(|corner| to[corner as usize]);
        corners.rotate_left(i % 3);
        if random::unit(seed, i as u64) < 0.5 {
            corners.swap(0, 1);
        }
        corners
    });
    Triangles::new(vertices, corners.collect()).unwrap().0
}

/// Each segment as the bits of its vertices, in ascending order. Without sides, the end with the
/// lower bits comes first.
fn bits(lines: &Polylines, sides: bool) -> Vec<Vec<u32>> {
    let vertices = lines.vertices();
    let bits = |&i: &u32| {
        let i = i as usize;
        let color = vertices.color.as_ref().map_or(Vec3::ZERO, |color| color[i]);
        let vectors = [vertices.position[i], vertices.direction[i], color];
        let numbers = vectors.into_iter().flat_map(|v| v.to_array()).chain([vertices.radius[i]]);
        numbers.map(f32::to_bits).collect::<Vec<u32>>()
    };
    let segment = |segment: &[u32; 2]| {
        let mut ends: Vec<_> = segment.iter().map(bits).collect();
        if !sides {
            ends.sort();
        }
        ends.concat()
    };
    let mut all: Vec<_> = lines.corners().iter().map(segment).collect();
    all.sort();
    all
}

/// A tube around +z with rings at these heights. No two neighbouring rings are turned alike, so
/// that diagonals have all directions.
fn tube(sides: u32, radius: f64, heights: &[f64]) -> Triangles {
    let mut position = Vec::new();
    for (k, &z) in heights.iter().enumerate() {
        for side in 0..sides {
            let angle =
                std::f64::consts::TAU * (f64::from(side) + 0.3 * k as f64) / f64::from(sides);
            let (x, y) = (elementary::cos(angle) * radius, elementary::sin(angle) * radius);
            position.push(DVec3::new(x, y, z).as_vec3());
        }
    }
    let rings = (1..heights.len() as u32).map(|k| (k - 1) * sides);
    let corners = rings.flat_map(|ring| {
        (0..sides).flat_map(move |side| {
            let [a, b] = [ring + side, ring + (side + 1) % sides];
            [[a, b, a + sides], [b, b + sides, a + sides]]
        })
    });
    mesh(position, corners.collect())
}

#[test]
fn the_tree_has_the_size_of_the_published_one() {
    let tree = apple_tree(LEAVES, 0).unwrap();
    assert_eq!((tree.leaves.len(), tree.leaves.vertices().position.len()), (200_496, 6 * 50_124));
    assert_eq!(
        (tree.bark.len(), tree.trunk.len()),
        (353_088, 240),
        "as the page of the module says"
    );
    let lines = tree.lines().unwrap();
    assert_eq!(lines.ribbons.len(), 150_372);
    assert_eq!(lines.ribbons.vertices().position.len(), 200_496);
    // Six triangles for each segment, and one vertex more than segments in every branch.
    assert_eq!(lines.tubes.len(), 353_088 / 6);
    assert_eq!(lines.tubes.vertices().position.len(), 65_051);
    assert_eq!(lines.triangles.len(), 240, "all the rest is converted");
    assert_eq!(tree.polygons().unwrap().len(), 200_496 + 353_088 + 240);
}

#[test]
fn trees_of_every_size_are_converted_and_stand_on_the_ground() {
    for (leaves, seed) in [(1, 0), (2, 0), (16, 1), (17, 1), (40, 2), (300, 3), (2000, 4)] {
        let tree = apple_tree(leaves, seed).unwrap();
        assert_eq!(tree.leaves.len(), 4 * leaves, "none was dropped");
        let lines = tree.lines().unwrap();
        assert_eq!(lines.ribbons.len(), 3 * leaves);
        assert_eq!((6 * lines.tubes.len(), lines.triangles.len()), (tree.bark.len(), 240));
        assert!(lines.triangles == tree.trunk);
        let all = tree.polygons().unwrap().triangles;
        let low = all.vertices().position.iter().fold(Vec3::MAX, |low, &p| low.min(p));
        let high = all.vertices().position.iter().fold(Vec3::MIN, |high, &p| high.max(p));
        assert_eq!(low.y, 0.0);
        assert!((2.0..4.0).contains(&high.y), "{leaves} leaves: {high}");
        for side in [-low.x, -low.z, high.x, high.z] {
            assert!((0.1..2.5).contains(&side), "{leaves} leaves: {low} {high}");
        }
    }
    for leaves in [0, MAX_LEAVES + 1] {
        assert!(apple_tree(leaves, 0).is_err());
    }
}

#[test]
fn a_tree_is_a_function_of_its_seed() {
    let tree = apple_tree(200, 7).unwrap();
    assert!(tree == apple_tree(200, 7).unwrap());
    assert!(tree != apple_tree(200, 8).unwrap());
}

#[test]
fn normals_are_on_the_side_that_triangles_face() {
    let triangles = apple_tree(500, 1).unwrap().polygons().unwrap().triangles;
    let (vertices, mut least) = (triangles.vertices(), 1.0);
    for corners in triangles.corners() {
        let [a, b, c] = corners.map(|i| vertices.position[i as usize].as_dvec3());
        let face = (b - a).cross(c - a).normalize();
        for &i in corners {
            let cosine = face.dot(vertices.direction[i as usize].as_dvec3());
            least = if cosine < least { cosine } else { least };
        }
    }
    // The normals of a ring of three are 60 degrees from its faces; a bend adds some more.
    assert!(least > 0.2, "{least}");
}

#[test]
fn leaves_grow_from_the_surface_of_twigs() {
    let lines = apple_tree(300, 5).unwrap().lines().unwrap();
    let (leaves, twigs) = (lines.ribbons.vertices(), lines.tubes.vertices());
    for leaf in leaves.position.chunks_exact(4) {
        let on_a_twig = |end: Vec3| {
            let mut joints = twigs.position.iter().zip(&twigs.radius);
            // Positions below 4 are rounded to 2^-23, three times.
            joints.any(|(&at, &radius)| (at.distance(end) - radius).abs() < 1.0 / 2_097_152.0)
        };
        assert!(on_a_twig(leaf[0]) || on_a_twig(leaf[3]), "{leaf:?}");
    }
}

#[test]
fn lines_do_not_depend_on_the_order_of_the_mesh() {
    let tree = apple_tree(400, 9).unwrap();
    let (flat, _) = ribbons(&tree.leaves).unwrap();
    let (round, _) = tubes(&tree.bark).unwrap();
    for seed in [1, 2, 3] {
        let (other, rest) = ribbons(&shuffled(&tree.leaves, seed)).unwrap();
        assert!(bits(&other, false) == bits(&flat, false) && rest.is_empty());
        let (other, rest) = tubes(&shuffled(&tree.bark, seed)).unwrap();
        assert!(bits(&other, true) == bits(&round, true) && rest.is_empty());
    }
}

#[test]
fn a_known_leaf_becomes_its_ribbon() {
    let position = vec![
        Vec3::new(0.0, -1.0, 0.0), // an end
        Vec3::new(0.5, 0.0, 0.0),
        Vec3::new(-0.5, 0.0, 1.0),
        Vec3::new(0.25, 2.0, 0.5),
        Vec3::new(-0.75, 2.0, 0.5),
        Vec3::new(0.0, 3.0, 0.0), // an end
    ];
    let mut vertices = mesh(position, vec![]).into_parts().0;
    (vertices.direction[1], vertices.direction[2]) = (Vec3::X, Vec3::Y);
    (vertices.direction[3], vertices.direction[4]) = (Vec3::X, -Vec3::X);
    vertices.color = Some((0..6).map(|i| Vec3::splat(i as f32)).collect());
    // Both diagonals of the middle, and a reversed triangle.
    let strips = [
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [3, 5, 4]],
        [[0, 1, 2], [4, 1, 2], [3, 1, 4], [3, 5, 4]],
    ];
    for strip in strips {
        let (leaf, dropped) = Triangles::new(vertices.clone(), strip.to_vec()).unwrap();
        let (ribbon, rest) = ribbons(&leaf).unwrap();
        assert_eq!((dropped, rest), (0, vec![]));
        assert_eq!(ribbon.corners(), [[0, 1], [1, 2], [2, 3]]);
        let Vertices { position, direction, radius, color, .. } = ribbon.vertices();
        let middle = [Vec3::new(0.0, 0.0, 0.5), Vec3::new(-0.25, 2.0, 0.5)];
        assert_eq!(*position, [Vec3::NEG_Y, middle[0], middle[1], 3.0 * Vec3::Y]);
        let half = 0.5_f64.sqrt() as f32;
        let cancelled = Vec3::Y;
        assert_eq!(*direction, [Vec3::Z, Vec3::new(half, half, 0.0), cancelled, Vec3::Z]);
        assert_eq!(*radius, [0.0, half, 0.5, 0.0]);
        assert_eq!(color.as_deref().unwrap(), [0.0, 1.5, 3.5, 5.0].map(Vec3::splat));
    }
}

#[test]
fn what_is_no_leaf_stays() {
    let points = || (0..11).map(|i| Vec3::X * i as f32).collect();
    let leaf = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [3, 5, 4]];
    let others: [(&str, &[[u32; 3]]); 8] = [
        ("a fan", &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]),
        ("a star", &[[0, 1, 2], [0, 1, 3], [1, 2, 4], [2, 0, 5]]),
        ("no middle", &[[0, 1, 2], [1, 3, 2], [1, 4, 2], [3, 4, 5]]),
        ("a triangle without area", &[[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 5, 5]]),
        ("three triangles", &leaf[..3]),
        ("a fifth triangle", &[leaf[0], leaf[1], leaf[2], leaf[3], [5, 6, 7]]),
        ("a middle twice", &[[0, 1, 2], [1, 3, 2], [1, 3, 2], [3, 5, 4]]),
        ("ends apart", &[[0, 1, 2], [0, 1, 2], [3, 4, 5], [3, 4, 5]]),
    ];
    for (what, corners) in others {
        let (lines, rest) = ribbons(&mesh(points(), corners.to_vec())).unwrap();
        assert!(lines.is_empty(), "{what}");
        assert_eq!(rest.len(), corners.len(), "{what}");
    }
    // Two leaves that share a vertex are one part; beside them is a leaf.
    let both = leaf.map(|t| t.map(|i| i + 5));
    let (lines, rest) = ribbons(&mesh(points(), [leaf, both].concat())).unwrap();
    assert_eq!((lines.len(), rest.len()), (0, 8));
    let far = leaf.map(|t| t.map(|i| i + 6));
    let points = (0..12).map(|i| Vec3::X * i as f32).collect();
    let (lines, rest) = ribbons(&mesh(points, [&leaf[..3], &far[..]].concat())).unwrap();
    assert_eq!((lines.len(), rest), (3, leaf[..3].to_vec()));
}

#[test]
fn a_known_tube_becomes_its_axis() {
    // Segments much shorter than the edges of rings, and much longer.
    let heights = [-1.0, -0.875, -0.75, 4.0, 4.5, 20.0];
    for sides in 3..=8 {
        for mesh in [tube(sides, 2.0, &heights), shuffled(&tube(sides, 2.0, &heights), 1)] {
            let (axis, rest) = tubes(&mesh).unwrap();
            assert_eq!((axis.len(), rest), (5, vec![]));
            let Vertices { position, direction, radius, .. } = axis.vertices();
            let mut found: Vec<f32> = position.iter().map(|p| p.z).collect();
            found.sort_by(f32::total_cmp);
            assert_eq!(found, heights.map(|z| z as f32));
            // The roundings of coordinates below 4.
            let near = 1.0 / 1_048_576.0;
            assert!(position.iter().all(|p| p.truncate().length() < near));
            assert!(radius.iter().all(|r| (r - 2.0).abs() < near), "{radius:?}");
            // Either end may be the root, but all directions agree.
            assert!(direction.iter().all(|d| d.distance(Vec3::Z * d.z.signum()) < near));
            assert!(direction.iter().all(|d| d.dot(direction[0]) > 0.0));
            for [a, b] in axis.corners().iter().map(|ends| ends.map(|i| position[i as usize])) {
                assert!((b - a).dot(direction[0]) > 0.0, "segments agree with tangents");
            }
        }
    }
    // Four sides without a turn give exact results.
    let square = |z: f32| [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y].map(|p| p + Vec3::Z * z);
    let corners = tube(4, 1.0, &[0.0, 1.0]).corners().to_vec();
    let (axis, _) = tubes(&mesh([square(0.5), square(3.0)].concat(), corners)).unwrap();
    let Vertices { position, direction, radius, .. } = axis.vertices();
    assert_eq!(*position, [0.5 * Vec3::Z, 3.0 * Vec3::Z]);
    assert_eq!(
        (direction.as_slice(), radius.as_slice()),
        ([Vec3::Z; 2].as_slice(), [1.0; 2].as_slice())
    );
}

#[test]
fn tubes_run_from_the_thick_end_and_tangents_follow_bends() {
    // Thin end first: a point, a ring around +z, then one around +x to the side.
    let position = vec![
        Vec3::new(0.0, 0.0, 4.0),
        Vec3::new(0.5, -0.5, 3.0),
        Vec3::new(0.5, 0.5, 3.0),
        Vec3::new(-1.0, 0.0, 3.0),
        Vec3::new(-3.0, -1.0, 4.0),
        Vec3::new(-3.0, 1.0, 4.0),
        Vec3::new(-3.0, 0.0, 1.0),
    ];
    let tip = [[0, 1, 2], [0, 2, 3], [0, 3, 1]];
    let corners = [&tip[..], tube(3, 1.0, &[0.0, 1.0]).corners()].concat();
    let corners = corners.iter().enumerate();
    let corners = corners.map(|(i, t)| if i < 3 { *t } else { t.map(|v| v + 1) }).collect();
    let (lines, rest) = tubes(&mesh(position, corners)).unwrap();
    assert_eq!(rest, Rest::new());
    assert_eq!(lines.corners(), [[1, 0], [2, 1]], "each from the side of the root");
    let Vertices { position, direction, radius, .. } = lines.vertices();
    let bend = 3.0 * Vec3::Z;
    assert_eq!(*position, [4.0 * Vec3::Z, bend, bend - 3.0 * Vec3::X]);
    let half = 0.5_f64.sqrt() as f32;
    assert_eq!(*direction, [Vec3::Z, Vec3::new(half, 0.0, half), Vec3::X]);
    assert_eq!(*radius, [0.0, 1.0, 2.0]);
}

#[test]
fn what_is_no_row_of_rings_stays() {
    let count = |mesh: &Triangles| {
        let (lines, rest) = tubes(mesh).unwrap();
        (lines.len(), rest.len())
    };
    // No boundary, one triangle, a leaf, and a tube that is cut open along its side.
    let points = || (0..6).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect();
    assert_eq!(count(&mesh(points(), vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])), (0, 4));
    assert_eq!(count(&mesh(points(), vec![[0, 1, 2]])), (0, 1));
    assert_eq!(count(&mesh(points(), vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [3, 5, 4]])), (0, 4));
    let whole = tube(5, 1.0, &[0.0, 1.0, 2.0]);
    let cut = mesh(whole.vertices().position.clone(), {
        let keeps = |t: &&[u32; 3]| !t.iter().all(|v| v % 5 == 0 || v % 5 == 4);
        whole.corners().iter().filter(keeps).copied().collect()
    });
    assert_eq!(count(&cut), (0, cut.len()));
}

#[test]
fn a_fork_is_converted_but_for_its_crotch() {
    // A ring of six (0 to 5, the widest) that parts into rings of three (6, 7, 8 and 9, 10, 11),
    // and two more rings on each of those.
    let mut corners = vec![
        [0, 1, 6],
        [1, 2, 6],
        [0, 6, 8],
        [2, 7, 6], // on the left
        [3, 4, 9],
        [4, 5, 9],
        [3, 9, 11],
        [5, 10, 9], // on the right
        [0, 8, 10],
        [0, 10, 5],
        [2, 3, 11],
        [2, 11, 7], // between them, above and below
        [8, 7, 11],
        [8, 11, 10], // the crotch
    ];
    for (below, above) in [(6, 12), (12, 15), (9, 18), (18, 21)] {
        for side in 0..3 {
            let next = (side + 1) % 3;
            let [a, b, c, d] = [below + side, below + next, above + side, above + next];
            corners.extend([[a, b, c], [b, d, c]]);
        }
    }
    let mut position = vec![Vec3::ZERO; 24];
    for (i, p) in position.iter_mut().enumerate() {
        let (ring, sides, wide) = if i < 6 { (0, 6, 9.0) } else { (i / 3, 3, 1.0) };
        let angle = std::f64::consts::TAU * i as f64 / f64::from(sides);
        let (x, y) = (elementary::cos(angle) * wide, elementary::sin(angle) * wide);
        *p = DVec3::new(x, y, f64::from(ring as u32)).as_vec3();
    }
    let mesh = mesh(position, corners);
    let (lines, rest) = tubes(&mesh).unwrap();
    assert_eq!(lines.corners(), [[0, 1], [2, 3]], "the rings after the crotch");
    assert_eq!(
        rest,
        mesh.corners().iter().filter(|t| t.iter().any(|&v| v < 12)).copied().collect::<Rest>()
    );
}

#[test]
fn what_is_not_converted_is_kept_as_triangles() {
    let mut tree = apple_tree(10, 0).unwrap();
    let plain = mesh((0..5).map(|i| Vec3::Y * i as f32).collect(), vec![[1, 2, 4]]);
    tree.leaves = plain.clone();
    let lines = tree.lines().unwrap();
    assert_eq!((lines.ribbons.len(), lines.triangles.len()), (0, 241));
    let vertices = lines.triangles.vertices();
    let n = tree.trunk.vertices().position.len() as u32;
    assert_eq!(lines.triangles.corners()[240], [n, n + 1, n + 2], "only the vertices it uses");
    assert_eq!(vertices.position[n as usize..], [1.0, 2.0, 4.0].map(|y| Vec3::Y * y));
    assert_eq!(vertices.color.as_ref().unwrap()[n as usize..], [Vec3::ONE; 3]);
    tree.bark = Triangles::default();
    tree.trunk = plain;
    assert_eq!(tree.polygons().unwrap().triangles.vertices().color, None);
}
