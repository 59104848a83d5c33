//! One side for all normals [Hoppe et al. 1992, Surface Reconstruction from Unorganized Points].

use glam::{DVec3, Vec3};

/// How many nearest neighbours a place is tied to; `Decided:` half of those of the plane fit, as
/// the far ones are those across a gap.
pub(super) const TIES: usize = 8;

/// Flips normals so that neighbours agree.
///
/// Each place is tied to its nearest ones by edges of weight `1 - |n . n'|` (f64, at least 0, rounded
/// to `f32`). Along a minimum spanning tree, ties of weight by the lower pair of indices, the normals
/// of two ends get a dot product >= 0.
///
/// `Decided:` each connected part is then flipped as a whole so that the normal of its outermost
/// place points outwards: the one farthest from the mean of all places, the lower index of equal
/// ones. If that normal is nearly perpendicular to the way out (|cosine| <= 1/8), as on a flat
/// part, its largest component, the first of equal ones, becomes positive.
pub(super) fn agree(places: &[Vec3], ties: &[[u32; TIES]], normals: &mut [Vec3]) {
    let mut parts = Parts::new(places.len());
    for (_, a, b) in edges(ties, normals) {
        let against = dot(normals[a as usize], normals[b as usize]) < 0.0;
        parts.join(a, b, against);
    }

    let mut mean = DVec3::ZERO;
    for place in places {
        mean += place.as_dvec3();
    }
    mean /= places.len() as f64;
    let outwards = |i: u32| places[i as usize].as_dvec3() - mean;
    let mut outermost: Vec<Option<u32>> = vec![None; places.len()];
    for i in 0..places.len() as u32 {
        let best = &mut outermost[parts.find(i).0 as usize];
        if best.is_none_or(|b| outwards(i).length_squared() > outwards(b).length_squared()) {
            *best = Some(i);
        }
    }
    let mut flip = vec![false; places.len()]; // by root: whether it and what agrees with it flip
    for seed in outermost.into_iter().flatten() {
        let (root, against) = parts.find(seed);
        flip[root as usize] = against ^ points_inwards(normals[seed as usize], outwards(seed));
    }
    for i in 0..places.len() as u32 {
        let (root, against) = parts.find(i);
        if flip[root as usize] ^ against {
            normals[i as usize] = -normals[i as usize];
        }
    }
}

/// Whether the normal of an outermost place has to be flipped.
fn points_inwards(normal: Vec3, out: DVec3) -> bool {
    let cosine = normal.as_dvec3().dot(out);
    if 8.0 * cosine.abs() > out.length() {
        return cosine < 0.0;
    }
    let mut largest = 0;
    for other in 1..3 {
        if normal[other].abs() > normal[largest].abs() {
            largest = other;
        }
    }
    normal[largest] < 0.0
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().dot(b.as_dvec3())
}

/// All ties once, as (bits of the weight, lower index, higher index), ascending.
fn edges(ties: &[[u32; TIES]], normals: &[Vec3]) -> Vec<(u32, u32, u32)> {
    let mut edges = Vec::new();
    for (a, near) in (0..).zip(ties) {
        for &b in near {
            // A place with too few neighbours is tied to itself; a mutual tie is taken once.
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

/// Connected parts: a forest where each place knows whether its normal is against its parent's.
struct Parts {
    parent: Vec<u32>,
    against: Vec<bool>,
}

impl Parts {
    fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), against: vec![false; n] }
    }

    /// The root of a place, and whether its normal is against the root's; halves the path.
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

    /// Joins the parts of two places, whose own normals are for or against each other.
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
