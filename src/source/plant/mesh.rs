//! Build triangles: rings around an axis, and the blades of leaves.

use crate::error::Result;
use crate::number::MapInline;
use crate::number::elementary;
use crate::scene::{Triangles, Vertices};
use glam::DVec3;

/// Vertices and triangles, each number rounded to `f32` as it is pushed.
#[derive(Default)]
pub(super) struct Mesh {
    vertices: Vertices,
    color: Vec<glam::Vec3>,
    corners: Vec<[u32; 3]>,
}

/// A point of the axis of a branch.
#[derive(Clone, Copy)]
pub(super) struct Joint {
    /// Its position.
    pub(super) at: DVec3,
    /// The direction of the axis, of length 1.
    pub(super) along: DVec3,
    /// A unit vector across the axis, carried along the branch without rotation around it.
    pub(super) across: DVec3,
    /// The radius of the branch.
    pub(super) radius: f64,
}

impl Joint {
    /// The unit vector across the axis at this azimuth in radians, counter-clockwise as seen from
    /// the tip towards the root.
    pub(super) fn radial(&self, azimuth: f64) -> DVec3 {
        let third = self.along.cross(self.across);
        self.across * elementary::cos(azimuth) + third * elementary::sin(azimuth)
    }
}

/// The blade of a leaf.
pub(super) struct Blade {
    /// The point where it is attached.
    pub(super) base: DVec3,
    /// From the base to the tip, of length 1.
    pub(super) along: DVec3,
    /// The normal at the base, of length 1 and perpendicular to `along`.
    pub(super) normal: DVec3,
    /// The distance from the base to the tip before the blade is bent.
    pub(super) length: f64,
    /// How far the tip hangs from the plane of the base, in lengths.
    pub(super) bend: f64,
}

/// Half the greatest width of a leaf, in its lengths.
const HALF_WIDTH: f64 = 0.28;
/// The two pairs of a blade: their distance from the base, in lengths, and their width, as a
/// fraction of the greatest width.
const PAIRS: [(f64, f64); 2] = [(0.3, 1.0), (0.7, 0.75)];

impl Mesh {
    fn push(&mut self, position: DVec3, normal: DVec3, color: DVec3) -> u32 {
        let index = self.vertices.position.len() as u32;
        self.vertices.position.push(position.as_vec3());
        self.vertices.direction.push(normal.as_vec3());
        self.vertices.radius.push(0.0);
        self.color.push(color.as_vec3());
        index
    }

    /// Adds a ring of `sides` vertices around each joint, and two triangles a side between rings.
    /// Both ends are open.
    pub(super) fn branch(&mut self, joints: &[Joint], sides: u32, color: DVec3) {
        let first = self.vertices.position.len() as u32;
        for joint in joints {
            for side in 0..sides {
                let turn = f64::from(side) / f64::from(sides);
                let out = joint.radial(turn * std::f64::consts::TAU);
                self.push(joint.at + out * joint.radius, out, color);
            }
        }
        for ring in (1..joints.len() as u32).map(|ring| first + (ring - 1) * sides) {
            for side in 0..sides {
                let next = (side + 1) % sides;
                let [a, b] = [ring + side, ring + next];
                let [c, d] = [a + sides, b + sides];
                self.corners.extend([[a, b, c], [b, d, c]]);
            }
        }
    }

    /// Adds six vertices and four triangles: the base, two pairs, and the tip.
    ///
    /// The middle line is base + length (t along - bend t^2 normal) for t in [0, 1]; the normal at
    /// t is perpendicular to it.
    pub(super) fn leaf(&mut self, blade: &Blade, color: DVec3) {
        let side = blade.along.cross(blade.normal) * (HALF_WIDTH * blade.length);
        let mut push = |t: f64, sideways: f64| {
            let middle = blade.along * t - blade.normal * (blade.bend * t * t);
            let normal = blade.normal + blade.along * (2.0 * blade.bend * t);
            let position = blade.base + middle * blade.length + side * sideways;
            self.push(position, normal.normalize(), color)
        };
        let base = push(0.0, 0.0);
        let [[r, l], [s, m]] = PAIRS.map_inline(|(t, width)| [push(t, width), push(t, -width)]);
        let tip = push(1.0, 0.0);
        self.corners.extend([[base, r, l], [r, s, l], [s, m, l], [s, tip, m]]);
    }

    /// The checked triangles.
    pub(super) fn finish(self) -> Result<Triangles> {
        let vertices = Vertices { color: Some(self.color), ..self.vertices };
        Triangles::new(vertices, self.corners).map(|(triangles, _)| triangles)
    }
}
