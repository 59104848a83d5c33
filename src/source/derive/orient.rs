//! Turn all normals to one side [Hoppe et al. 1992, Surface Reconstruction from Unorganized
//! Points].

use glam::{DVec3, Vec3};

/// How many nearest neighbours a place is tied to. `Decided:` half the number for the plane fit,
/// because the far ones are those across a gap.
pub(super) const TIES: usize = 8;

/// Flips normals so that neighbours agree, see the arithmetic of [`super`].
///
/// The ties in use are the edges of a minimum spanning tree; along each, the normals of the two
/// ends get a dot product >= 0.
pub(super) fn agree(places: &[Vec3], ties: &[[u32; TIES]], normals: &mut [Vec3]) {
    let mut parts = Forest::new(places.len());
    for (_, a, b) in edges(ties, normals) {
        let against = dot(normals[a as usize], normals[b as usize]) < 0.0;
        parts.join(a, b, against);
    }
    // Number the parts, and let each place agree with the root of its part.
    let mut number: Vec<Option<usize>> = vec![None; places.len()];
    let mut part = Vec::with_capacity(places.len());
    let mut count = 0;
    for (i, normal) in (0..).zip(&mut *normals) {
        let (root, against) = parts.find(i);
        part.push(*number[root as usize].get_or_insert_with(|| {
            count += 1;
            count - 1
        }));
        if against {
            *normal = -*normal;
        }
    }

    let mut sides = vec![Side::default(); count];
    for i in 0..places.len() {
        sides[part[i]].locate(places[i], area(places, i, &ties[i]));
    }
    for i in 0..places.len() {
        sides[part[i]].add(places[i], normals[i], area(places, i, &ties[i]));
    }
    for (normal, part) in normals.iter_mut().zip(part) {
        if sides[part].is_inner() {
            *normal = -*normal;
        }
    }
}

/// The area that a place represents, up to a factor: the squared distance to the farthest place it
/// is tied to.
fn area(places: &[Vec3], of: usize, ties: &[u32; TIES]) -> f64 {
    let distance2 =
        |&tie: &u32| places[tie as usize].as_dvec3().distance_squared(places[of].as_dvec3());
    ties.iter().map(distance2).fold(0.0, |most, d| if d > most { d } else { most })
}

/// Sums that show on which side of a part its normals are; in ascending index, in f64.
#[derive(Clone, Copy, Default)]
struct Side {
    /// The sum of areas, and of places times areas.
    area: f64,
    place: DVec3,
    /// The sums of `n . (p - mean)`, of `|p - mean|` and of the normals, all times areas.
    volume: f64,
    size: f64,
    facing: DVec3,
}

impl Side {
    fn locate(&mut self, place: Vec3, area: f64) {
        self.area += area;
        self.place += place.as_dvec3() * area;
    }

    fn add(&mut self, place: Vec3, normal: Vec3, area: f64) {
        let out = place.as_dvec3() - self.place / self.area;
        self.volume += normal.as_dvec3().dot(out) * area;
        self.size += out.length() * area;
        self.facing += normal.as_dvec3() * area;
    }

    /// Whether the normals point inwards and must be flipped. For an open part, the volume finds
    /// the convex side, because c is the mean.
    fn is_inner(&self) -> bool {
        if 256.0 * self.volume.abs() > self.size {
            return self.volume < 0.0;
        }
        let facing = self.facing.to_array();
        let mut largest = 0;
        for other in 1..3 {
            if facing[other].abs() > facing[largest].abs() {
                largest = other;
            }
        }
        facing[largest] < 0.0
    }
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().dot(b.as_dvec3())
}

/// All ties once, as (bits of the weight, lower index, higher index), in ascending order.
fn edges(ties: &[[u32; TIES]], normals: &[Vec3]) -> Vec<(u32, u32, u32)> {
    let mut edges = Vec::new();
    for (a, near) in (0..).zip(ties) {
        for &b in near {
            // A place with too few neighbours is tied to itself; a mutual tie counts once.
            if a < b || (b < a && !ties[b as usize].contains(&a)) {
                let weight = 1.0 - dot(normals[a as usize], normals[b as usize]).abs();
                let weight = if weight > 0.0 { weight as f32 } else { 0.0 };
                // The bits of floats that are not negative are in the order of the floats.
                edges.push(if a < b { (weight.to_bits(), a, b) } else { (weight.to_bits(), b, a) });
            }
        }
    }
    edges.sort_unstable();
    edges
}

/// Connected parts: a forest in which each place knows whether its normal opposes its parent's.
struct Forest {
    parent: Vec<u32>,
    against: Vec<bool>,
}

impl Forest {
    fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), against: vec![false; n] }
    }

    /// The root of a place, and whether its normal opposes the root's; halves the path.
    fn find(&mut self, place: u32) -> (u32, bool) {
        let (mut i, mut against) = (place as usize, false);
        loop {
            let parent = self.parent[i] as usize;
            if parent == i {
                return (i as u32, against);
            }
            self.against[i] ^= self.against[parent]; // a root is never against itself
            self.parent[i] = self.parent[parent];
            against ^= self.against[i];
            i = self.parent[i] as usize;
        }
    }

    /// Joins the parts of two places; `against` says whether their own normals oppose each other.
    fn join(&mut self, a: u32, b: u32, against: bool) {
        let ((a, a_against), (b, b_against)) = (self.find(a), self.find(b));
        if a != b {
            self.parent[b as usize] = a;
            self.against[b as usize] = against ^ a_against ^ b_against;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_alternating_normals_is_made_to_agree() {
        // A circle of places whose normals are radial, every other one inwards.
        let n = 64;
        let angle = |i: usize| i as f64 / n as f64 * std::f64::consts::TAU;
        let circle = |i: usize| {
            let (c, s) = (libm::cos(angle(i)) as f32, libm::sin(angle(i)) as f32);
            Vec3::new(c, s, 0.0)
        };
        let places: Vec<Vec3> = (0..n).map(circle).collect();
        let mut normals: Vec<Vec3> =
            (0..n).map(|i| if i % 2 == 0 { circle(i) } else { -circle(i) }).collect();
        let tie = |i: usize| {
            let mut ties = [i as u32; TIES];
            (ties[0], ties[1]) = (((i + 1) % n) as u32, ((i + n - 1) % n) as u32);
            ties
        };
        let ties: Vec<_> = (0..n).map(tie).collect();
        agree(&places, &ties, &mut normals);
        assert_eq!(normals, places);
    }

    #[test]
    fn a_flat_part_faces_the_positive_axis() {
        let places = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut normals = [-Vec3::Z, Vec3::Z, -Vec3::Z];
        let ties = [[1; TIES], [2; TIES], [0; TIES]];
        agree(&places, &ties, &mut normals);
        assert_eq!(normals, [Vec3::Z; 3]);
    }
}
