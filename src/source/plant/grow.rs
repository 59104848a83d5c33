//! Grow the tree.

use super::Plant;
use super::mesh::{Blade, Joint, Mesh};
use crate::error::Result;
use crate::number::{MapInline, elementary, random};
use glam::DVec3;
use std::f64::consts::TAU;

/// Radius of the trunk above its foot.
const TRUNK: f64 = 0.095;
/// How much wider the foot is than the trunk, and the fraction of the trunk where it ends.
const FOOT: (f64, f64) = (0.7, 0.3);
/// Sides of the trunk, and segments along it: 2 * 12 * 10 = 240 triangles.
const TRUNK_RINGS: (u32, usize) = (12, 10);
/// Sides of every other branch \[MKC08: "usually three"\].
const SIDES: u32 = 3;
/// The radius of a branch grows with its leaves to this power. It is a little less than the square
/// root, with which cross-sections would add up, because bark makes thin twigs thicker.
const PIPE: f64 = 0.45;
/// The radius at the tip of a twig, as a fraction of the radius at its base.
const TWIG_TIP: f64 = 0.4;
/// A branch with at most this many leaves is a twig, and bears them itself.
const TWIG: usize = 16;
/// The average number of leaves on a twig, where the order does not limit the number of branches.
const LEAVES_OF_A_TWIG: usize = 9;
/// The point from which the crown spreads.
const HEART: DVec3 = DVec3::new(0.0, 1.5, 0.0);
/// The length of a leaf is this divided by the square root of the number of leaves, so that their
/// total area is constant. It is at most [`LONGEST_LEAF`].
const LEAF: f64 = 13.0;
const LONGEST_LEAF: f64 = 0.3;
/// The golden section of a turn, the angle between a leaf or branch and the next.
const GOLDEN_TURN: f64 = 0.381_966_011_250_105_1;

/// Properties that all branches of one order share.
struct Order {
    /// The most branches that it has, and the fraction of its length where they begin.
    children: usize,
    bare: f64,
    /// The angles from its direction to its first branch and to its last, which continues it, in
    /// radians.
    angle: [f64; 2],
    /// The lengths of its first branch and of its last, as fractions of its own.
    reach: [f64; 2],
    /// What bends the direction from root to tip: a random part, an upward part, and a part away
    /// from the heart.
    wander: f64,
    rise: f64,
    spread: f64,
    /// The number of segments of the axis.
    segments: usize,
}

/// Trunk, limbs, branches, and everything thinner.
const ORDERS: [Order; 4] = [
    Order {
        children: 8,
        bare: 0.65,
        angle: [1.15, 0.2],
        reach: [1.2, 1.15],
        wander: 0.25,
        rise: 0.0,
        spread: 0.0,
        segments: TRUNK_RINGS.1,
    },
    Order {
        children: 12,
        bare: 0.25,
        angle: [1.0, 0.2],
        reach: [0.5, 0.3],
        wander: 1.1,
        rise: 0.25,
        spread: 0.2,
        segments: 24,
    },
    Order {
        children: 8,
        bare: 0.2,
        angle: [0.9, 0.2],
        reach: [0.55, 0.4],
        wander: 1.2,
        rise: 0.1,
        spread: 0.5,
        segments: 12,
    },
    Order {
        children: 8,
        bare: 0.2,
        angle: [0.9, 0.3],
        reach: [0.55, 0.45],
        wander: 1.2,
        rise: 0.0,
        spread: 0.4,
        segments: 9,
    },
];

/// Random numbers of one branch, one after another.
struct Dice {
    seed: u64,
    next: u64,
}

impl Dice {
    /// A random number in [low, high).
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.next += 1;
        low + (high - low) * f64::from(random::unit(self.seed, self.next))
    }

    /// A random vector in the cube [-1, 1)^3.
    fn vector(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map_inline(|()| self.between(-1.0, 1.0)))
    }

    /// The random numbers of another branch.
    fn branch(&mut self) -> Self {
        self.next += 1;
        Self { seed: random::bits(self.seed, self.next), next: 0 }
    }
}

/// A branch before it grows.
struct Bud {
    base: DVec3,
    along: DVec3,
    length: f64,
    leaves: usize,
    order: usize,
    dice: Dice,
}

struct Tree {
    leaves: Mesh,
    bark: Mesh,
    trunk: Mesh,
    all_leaves: usize,
}

/// Grows a tree with `leaves` leaves, at least one.
pub(super) fn grow(leaves: usize, seed: u64) -> Result<Plant> {
    let mut tree = Tree {
        leaves: Mesh::default(),
        bark: Mesh::default(),
        trunk: Mesh::default(),
        all_leaves: leaves,
    };
    tree.branch(Bud {
        base: DVec3::ZERO,
        along: DVec3::Y,
        length: 1.15,
        leaves,
        order: 0,
        dice: Dice { seed, next: 0 },
    });
    Ok(Plant {
        leaves: tree.leaves.finish()?,
        bark: tree.bark.finish()?,
        trunk: tree.trunk.finish()?,
    })
}

impl Tree {
    /// Grows a branch with everything on it.
    fn branch(&mut self, mut bud: Bud) {
        let is_trunk = bud.order == 0;
        let order = &ORDERS[bud.order.min(ORDERS.len() - 1)];
        if bud.leaves <= TWIG && !is_trunk {
            let base = self.radius(bud.leaves);
            let leaves = bud.leaves;
            let joints = axis(&mut bud, order, leaves, |s| base * (1.0 + (TWIG_TIP - 1.0) * s));
            self.bark.branch(&joints, SIDES, bark(base, &mut bud.dice));
            // One leaf on each joint except the first, because there the twig is inside another
            // branch.
            for (i, joint) in joints[1..].iter().enumerate() {
                self.leaf(joint, i, &mut bud.dice);
            }
            return;
        }
        let shares = shares(&bud, order);
        let [base, tip] =
            [bud.leaves, shares[shares.len() - 1]].map_inline(|leaves| self.radius(leaves));
        let taper = |s: f64| {
            let foot = if is_trunk && s < FOOT.1 { 1.0 - s / FOOT.1 } else { 0.0 };
            (base + (tip - base) * s * s) * (1.0 + FOOT.0 * foot * foot)
        };
        let joints = axis(&mut bud, order, order.segments, taper);
        let color = bark(base, &mut bud.dice);
        if is_trunk {
            self.trunk.branch(&joints, TRUNK_RINGS.0, color);
        } else {
            self.bark.branch(&joints, SIDES, color);
        }
        let start = bud.dice.between(0.0, 1.0);
        for (i, &leaves) in shares.iter().enumerate() {
            if leaves > 0 {
                let child = child(&mut bud, order, &joints, [i, shares.len()], start, leaves);
                self.branch(child);
            }
        }
    }

    /// The radius of a branch with this number of leaves.
    fn radius(&self, leaves: usize) -> f64 {
        TRUNK * elementary::pow(leaves as f64 / self.all_leaves as f64, PIPE)
    }

    /// Adds leaf `i` of a twig: it points away from the twig and a little down, with its upper side
    /// to the light.
    fn leaf(&mut self, joint: &Joint, i: usize, dice: &mut Dice) {
        let turn = i as f64 * GOLDEN_TURN + dice.between(-0.1, 0.1);
        let radial = joint.radial(turn * TAU);
        let along = joint.along * 0.6 + radial * 0.8 - DVec3::Y * 0.25 + dice.vector() * 0.3;
        let along = along.normalize();
        let light = DVec3::Y + outwards(joint.at) * 0.7 + dice.vector() * 0.5;
        let normal = (light - along * along.dot(light)).normalize_or(joint.across);
        let longest = LEAF / (self.all_leaves as f64).sqrt();
        let longest = if longest > LONGEST_LEAF { LONGEST_LEAF } else { longest };
        let blade = Blade {
            base: joint.at + radial * joint.radius,
            along,
            normal,
            length: longest * dice.between(0.7, 1.0),
            bend: dice.between(0.0, 0.4),
        };
        let young = dice.between(0.0, 1.0);
        let color = DVec3::new(0.05, 0.15, 0.02).lerp(DVec3::new(0.2, 0.36, 0.05), young);
        self.leaves.leaf(&blade, color * dice.between(0.8, 1.2));
    }
}

/// How many leaves each branch of a bud gets, by the squares of their lengths; the running sums are
/// rounded.
fn shares(bud: &Bud, order: &Order) -> Vec<usize> {
    let wanted = bud.leaves.div_ceil(LEAVES_OF_A_TWIG);
    let count = if wanted > order.children { order.children } else { wanted };
    let squares: Vec<f64> = (0..count)
        .map(|i| along(order.reach, i, count))
        .scan(0.0, |sum, reach| {
            *sum += reach * reach;
            Some(*sum)
        })
        .collect();
    let all = squares[count - 1];
    let sums = squares.iter().map(|sum| (bud.leaves as f64 * sum / all + 0.5).floor() as usize);
    sums.scan(0, |before, sum| {
        let share = sum - *before;
        *before = sum;
        Some(share)
    })
    .collect()
}

/// Interpolates from the first value to the last, for branch `i` of `count`.
fn along([first, last]: [f64; 2], i: usize, count: usize) -> f64 {
    first + (last - first) * ((i + 1) as f64 / count as f64)
}

/// The axis of a branch in equal steps; `radius` gets the fraction of the length.
fn axis(bud: &mut Bud, order: &Order, segments: usize, radius: impl Fn(f64) -> f64) -> Vec<Joint> {
    let step = 1.0 / segments as f64;
    let mut joint = Joint {
        at: bud.base,
        along: bud.along,
        across: bud.along.any_orthonormal_vector(),
        radius: radius(0.0),
    };
    let mut joints = vec![joint];
    for i in 1..=segments {
        let bent = bud.dice.vector() * (order.wander * step.sqrt() * 0.5)
            + (DVec3::Y * order.rise + outwards(joint.at) * order.spread) * step;
        joint.at += joint.along * (bud.length * step);
        joint.along = (joint.along + bent).normalize();
        let across = joint.across - joint.along * joint.along.dot(joint.across);
        joint.across = across.normalize();
        joint.radius = radius(i as f64 * step);
        joints.push(joint);
    }
    joints
}

/// The bud of branch `i` of `count`, which starts on the axis of its parent.
fn child(
    bud: &mut Bud,
    order: &Order,
    joints: &[Joint],
    [i, count]: [usize; 2],
    start: f64,
    leaves: usize,
) -> Bud {
    let part = along([order.bare, 1.0], i, count);
    let joint = &joints[(part * order.segments as f64).floor() as usize];
    let angle = along(order.angle, i, count) * bud.dice.between(0.8, 1.2);
    let turn = start + i as f64 * GOLDEN_TURN + bud.dice.between(-0.05, 0.05);
    let radial = joint.radial(turn * TAU);
    Bud {
        base: joint.at,
        along: (joint.along * elementary::cos(angle) + radial * elementary::sin(angle)).normalize(),
        length: bud.length * along(order.reach, i, count) * bud.dice.between(0.85, 1.15),
        leaves,
        order: bud.order + 1,
        dice: bud.dice.branch(),
    }
}

/// The direction away from the heart of the crown; null at the heart.
fn outwards(at: DVec3) -> DVec3 {
    (at - HEART).normalize_or_zero()
}

/// The colour of a branch: thin branches are lighter.
fn bark(radius: f64, dice: &mut Dice) -> DVec3 {
    let age = (radius / TRUNK).sqrt();
    let color = DVec3::new(0.16, 0.11, 0.06).lerp(DVec3::new(0.09, 0.06, 0.04), age);
    color * dice.between(0.85, 1.15)
}
