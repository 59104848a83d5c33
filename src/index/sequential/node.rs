//! The discs of the tree: the surfels that they stand for, and their errors.

use super::{larger, longer, up};
use crate::frame::Exec;
use crate::number::MapInline;
use crate::number::Real;
use crate::scene::Surfels;
use crate::scene::cloud::half_axes;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// How many surfels one job measures.
const CHUNK: usize = 1 << 14;

/// A sum of normals shorter than this part of the weights, 2^-16, has cancelled.
const CANCELLED: f64 = 1.0 / 65_536.0;

/// The least error of an inner node: 2^-149, the least f32 above 0.
const LEAST: f32 = f32::from_bits(1);

/// A surfel or the disc of a node; colours and opacities are 0 where there are none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    pub(super) radius: f32,
    pub(super) color: Vec3,
    pub(super) opacity: f32,
}

impl Disc {
    /// Takes a surfel as it is.
    pub(super) fn from_surfel(surfels: &Surfels, surfel: u32) -> Self {
        let i = surfel as usize;
        Self {
            position: surfels.position()[i],
            normal: surfels.normal()[i],
            radius: surfels.radius()[i],
            color: surfels.color().map_or(Vec3::ZERO, |color| color[i]),
            opacity: surfels.opacity().map_or(0.0, |opacity| opacity[i]),
        }
    }
}

/// Sums over the surfels of a node, each times its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    weight: f64,
    position: DVec3,
    normal: DVec3,
    color: DVec3,
    opacity: f64,
}

impl Sums {
    fn and(self, more: Self) -> Self {
        Self {
            weight: self.weight + more.weight,
            position: self.position + more.position,
            normal: self.normal + more.normal,
            color: self.color + more.color,
            opacity: self.opacity + more.opacity,
        }
    }
}

/// A child, with what its parent needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child {
    pub(super) sums: Sums,
    pub(super) center: Vec3,
    pub(super) normal: Vec3,
    /// How far the child reaches from its centre.
    pub(super) radius: f64,
    pub(super) error: f32,
}

/// Surfels in the order of the tree.
#[derive(Debug)]
pub(super) struct Leaves {
    pub(super) discs: Vec<Disc>,
    pub(super) tangents: Option<Vec<[Vec3; 2]>>,
    /// The largest allowed difference of a component of a colour.
    pub(super) most: f32,
}

impl Leaves {
    /// Turns a surfel into a child.
    pub(super) fn child(&self, place: usize) -> Child {
        let Disc { position, normal, radius, color, opacity } = self.discs[place];
        let r = f64::from(radius);
        let (radius, weight) = match &self.tangents {
            None => (r, r * r),
            Some(tangents) => {
                let [u, v] = tangents[place].map_inline(Vec3::as_dvec3);
                (longer_half_axis(u, v), u.cross(v).length())
            }
        };
        let sums = Sums {
            weight,
            position: position.as_dvec3() * weight,
            normal: normal.as_dvec3() * weight,
            color: color.as_dvec3() * weight,
            opacity: f64::from(opacity) * weight,
        };
        Child { sums, center: position, normal, radius, error: 0.0 }
    }

    /// Makes the node over some children and over the surfels of a range: as a child, and its disc.
    pub(super) fn parent(
        &self,
        children: &[Child],
        range: Range<usize>,
        exec: Option<&Exec>,
    ) -> (Child, Disc) {
        let (first, others) = (children[0], &children[1..]);
        let sums = others.iter().fold(first.sums, |sums, child| sums.and(child.sums));
        let position = (sums.position / sums.weight).as_vec3();
        let length = sums.normal.length();
        let normal = if length < CANCELLED * sums.weight {
            let heavier = |a: Child, b: &Child| if b.sums.weight > a.sums.weight { *b } else { a };
            others.iter().fold(first, heavier).normal
        } else {
            (sums.normal / length).as_vec3()
        };
        let center = position.as_dvec3();
        let reach = |child: &Child| (child.center.as_dvec3() - center).length() + child.radius;
        let radius = longer(children.iter().map(reach).fold(0.0, larger));
        let color = (sums.color / sums.weight).as_vec3();
        let opacity = (sums.opacity / sums.weight) as f32;
        let disc = Disc { position, normal, radius, color, opacity };
        let below = children.iter().map(|child| child.error).fold(LEAST, larger);
        let error = larger(up(self.error(&disc, range, exec)), below);
        (Child { sums, center: position, normal, radius: f64::from(radius), error }, disc)
    }

    /// The error of a disc against the surfels of a range.
    fn error(&self, disc: &Disc, range: Range<usize>, exec: Option<&Exec>) -> f64 {
        let axes = axes(disc.normal);
        let measure = |range| self.measure(disc, &axes, range);
        let measured = match exec {
            // Only the few large nodes near the root are worth measuring in parallel.
            Some(exec) if range.len() > CHUNK => {
                let starts = range.clone().step_by(CHUNK);
                let chunks = starts.map(|start| start..range.end.min(start + CHUNK)).collect();
                let measured = exec.ordered(chunks, measure);
                measured.into_iter().fold(Measured::NOTHING, Measured::and)
            }
            _ => measure(range),
        };
        let [perpendicular, slabs @ ..] = measured.extents.map_inline(|[low, high]| high - low);
        let width = slabs.into_iter().fold(f64::INFINITY, Real::at_most);
        let diameter = 2.0 * f64::from(disc.radius);
        let tangential = larger(diameter - width, 0.0);
        let error = (perpendicular * perpendicular + tangential * tangential).sqrt();
        if measured.differs { larger(error, diameter) } else { error }
    }

    fn measure(&self, disc: &Disc, axes: &[DVec3; 5], range: Range<usize>) -> Measured {
        let center = disc.position.as_dvec3();
        let most = f64::from(self.most);
        let mut all = Measured::NOTHING;
        for place in range {
            let leaf = &self.discs[place];
            let offset = leaf.position.as_dvec3() - center;
            let tangents = self.tangents.as_ref().map(|tangents| tangents[place]);
            for (extent, axis) in all.extents.iter_mut().zip(axes) {
                let (middle, half) = (offset.dot(*axis), half_extent(leaf, tangents, *axis));
                extent[0] = extent[0].at_most(middle - half);
                extent[1] = extent[1].at_least(middle + half);
            }
            let difference = (leaf.color.as_dvec3() - disc.color.as_dvec3()).to_array();
            all.differs |= difference.iter().any(|difference| difference.abs() > most);
        }
        all
    }
}

/// Extents along the axes, from and to, and whether a colour differs.
#[derive(Clone, Copy, Debug)]
struct Measured {
    extents: [[f64; 2]; 5],
    differs: bool,
}

impl Measured {
    const NOTHING: Self = Self { extents: [[f64::INFINITY, f64::NEG_INFINITY]; 5], differs: false };

    fn and(mut self, more: Self) -> Self {
        for (extent, [low, high]) in self.extents.iter_mut().zip(more.extents) {
            *extent = [extent[0].at_most(low), extent[1].at_least(high)];
        }
        Self { differs: self.differs | more.differs, ..self }
    }
}

/// The normal, and four directions in its plane, 45 degrees from one to the next.
fn axes(normal: Vec3) -> [DVec3; 5] {
    const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let [u, v] = half_axes(normal, 1.0).map_inline(Vec3::as_dvec3);
    [normal.as_dvec3(), u, v, (u + v) * HALF_ROOT, (u - v) * HALF_ROOT]
}

/// How far a disc or an ellipse reaches from its centre along a unit vector. It uses the cross
/// product, because `1 - cos^2` would turn rounding errors of parallel normals into a thousandth of
/// the radius.
fn half_extent(disc: &Disc, tangents: Option<[Vec3; 2]>, axis: DVec3) -> f64 {
    match tangents {
        None => f64::from(disc.radius) * disc.normal.as_dvec3().cross(axis).length(),
        Some(tangents) => {
            let [u, v] = tangents.map_inline(|half| half.as_dvec3().dot(axis));
            (u * u + v * v).sqrt()
        }
    }
}

/// The longer half axis of the ellipse that two vectors span: the larger singular value.
fn longer_half_axis(u: DVec3, v: DVec3) -> f64 {
    let (a, b, g) = (u.dot(u), v.dot(v), u.dot(v));
    let root = ((a - b) * (a - b) + (4.0 * g) * g).sqrt();
    (((a + b) + root) / 2.0).sqrt()
}
