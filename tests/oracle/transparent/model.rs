//! \[ZP06, Algorithms 2 and 3\] by brute force: every surfel in every group of its own, at one
//! pixel.
//!
//! The order comes from a tree of its own; the nearest layer is that of [`crate::oracle::single_pass::model`]. A
//! pixel where rounding decides what is inside, in which bin, or in which layer is left out.

use crate::oracle::ewa::model::{Oracle, Seen};
use crate::oracle::ewa::splat::{Fragment, Splat};
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::eye::{Eye, V3, cross, dot, scaled, wide};
use crate::oracle::single_pass::model::Algorithm1;
use crate::oracle::transparent::Settings;
use splatref::composite::bins::Range;
use splatref::method::transparent::{BinEdges, Holes};
use splatref::scene::Groups;
use splatref::scene::{Camera, Surfels};
use splatref::splat::Outline;

/// The surfels from back to front, by recursion on sorted lists.
pub(crate) fn back_to_front(surfels: &Surfels, camera: &Camera) -> Vec<u32> {
    let eye = Eye::new(camera);
    let rows = [0, 1, 2].map(|i| eye.direction([0, 1, 2].map(|j| f64::from(u8::from(i == j)))));
    // Columns of the view matrix; its third row is the direction towards the eye.
    let towards = rows.map(|column| column[2]);
    let place = if eye.perspective {
        solve(rows, scaled(eye.point([0.0; 3]), -1.0))
    } else {
        towards.map(|v| if v > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY })
    };
    let mut order = Vec::new();
    visit(surfels, (0..surfels.len() as u32).collect(), place, &mut order);
    order
}

/// The x of a x[0] + b x[1] + c x[2] = right.
fn solve([a, b, c]: [V3; 3], right: V3) -> V3 {
    let volume = |a, b, c| dot(a, cross(b, c));
    let whole = volume(a, b, c);
    [volume(right, b, c) / whole, volume(a, right, c) / whole, volume(a, b, right) / whole]
}

fn visit(surfels: &Surfels, mut set: Vec<u32>, eye: V3, order: &mut Vec<u32>) {
    if set.len() <= 1 {
        order.extend(set);
        return;
    }
    let at = |i: u32, axis: usize| wide(surfels.position()[i as usize])[axis];
    let extents = [0, 1, 2].map(|axis| {
        let all = set.iter().map(|&i| at(i, axis));
        let (low, high) = (all.clone().fold(f64::INFINITY, f64::min), all.fold(-1e300, f64::max));
        high - low
    });
    let mut axis = 0;
    for other in 1..3 {
        if extents[other] > extents[axis] {
            axis = other;
        }
    }
    set.sort_by(|&i, &j| {
        at(i, axis).partial_cmp(&at(j, axis)).expect("finite").then_with(|| i.cmp(&j))
    });
    let high = set.split_off(set.len() / 2 + 1);
    let own = set.pop().expect("not empty");
    let (far, near) = if eye[axis] > at(own, axis) { (set, high) } else { (high, set) };
    visit(surfels, far, eye, order);
    order.push(own);
    visit(surfels, near, eye, order);
}

/// One surfel in one of its groups.
struct Drawn {
    group: usize,
    splat: Splat,
    scale: f64,
    alpha: f64,
    color: [Conditioned; 3],
}

/// The image of a group at a pixel, or the average of all.
#[derive(Clone, Copy)]
pub(crate) struct Image {
    pub(crate) color: [Conditioned; 3],
    pub(crate) alpha: Conditioned,
    /// The sum of opacities.
    pub(crate) opacity: Conditioned,
    pub(crate) hidden: Conditioned,
    pub(crate) layers: Conditioned,
    /// +inf while it is empty.
    pub(crate) bin: f64,
    /// The surfel that was blended last.
    pub(crate) last: u32,
}

impl Image {
    const EMPTY: Self = Self {
        color: [Conditioned::ZERO; 3],
        alpha: Conditioned::ZERO,
        opacity: Conditioned::ZERO,
        hidden: Conditioned::ZERO,
        layers: Conditioned::ZERO,
        bin: f64::INFINITY,
        last: u32::MAX,
    };

    /// One more layer, in front.
    fn blend(&mut self, drawn: &Drawn) {
        let alpha = Conditioned::exact(drawn.alpha);
        let through = Conditioned::exact(1.0 - drawn.alpha);
        for (below, own) in self.color.iter_mut().zip(drawn.color) {
            *below = alpha * own + through * *below;
        }
        self.alpha = alpha + through * self.alpha;
        if drawn.alpha == 1.0 {
            self.opacity = Conditioned::ZERO;
            self.hidden = Conditioned::exact(1.0);
        } else {
            self.opacity = self.opacity + alpha;
        }
        self.layers = self.layers + Conditioned::exact(1.0);
        self.last = drawn.splat.index as u32;
    }

    /// The mean of images, as many as are counted.
    fn average(images: &[Self], count: usize) -> Self {
        let mut mean = Self::EMPTY;
        if count == 0 {
            return mean;
        }
        let share = Conditioned::exact(1.0 / count as f64);
        let of = |f: &dyn Fn(&Self) -> Conditioned| {
            images.iter().fold(Conditioned::ZERO, |sum, image| sum + f(image)) * share
        };
        mean.color = [0, 1, 2].map(|c| of(&|image| image.color[c]));
        mean.alpha = of(&|image| image.alpha);
        mean.opacity = of(&|image| image.opacity);
        mean.hidden = of(&|image| image.hidden);
        mean.layers = of(&|image| image.layers);
        mean
    }
}

/// The nearest layer of a pixel.
pub(crate) struct Near {
    pub(crate) depth: f64,
    slack: f64,
    pub(crate) color: [Conditioned; 3],
    pub(crate) alpha: Conditioned,
    pub(crate) normal: [Conditioned; 3],
    pub(crate) weight: Conditioned,
    surfels: Vec<u32>,
}

/// What the oracle knows of a pixel.
pub(crate) struct Truth {
    /// Whether rounding decides anything.
    pub(crate) ambiguous: bool,
    pub(crate) near: Option<Near>,
    pub(crate) images: Vec<Image>,
    pub(crate) average: Image,
    /// Depth of the nearest fragment, +inf if there is none, and its condition.
    pub(crate) depth: Conditioned,
    /// The surfels that may be the nearest.
    pub(crate) nearest: Vec<u32>,
}

impl Truth {
    /// The layer count of eq. 11 and 12.
    pub(crate) fn count(&self) -> Conditioned {
        match &self.near {
            None => Conditioned::ZERO,
            Some(near) if near.alpha.value == 0.0 => Conditioned::ZERO,
            Some(near) => Conditioned::exact(1.0) + self.average.opacity / near.alpha,
        }
    }
}

/// The method before a scene.
pub(crate) struct Transparent<'a> {
    pub(crate) one: Algorithm1<'a>,
    settings: &'a Settings,
    range: Range,
    drawn: Vec<Drawn>,
}

impl<'a> Transparent<'a> {
    /// `ranges`: of the low-precision depth, and of the nearest layer's Voronoi depth.
    pub(crate) fn new(
        oracle: Oracle<'a>,
        camera: &Camera,
        groups: &'a Groups,
        settings: &'a Settings,
        [range, voronoi]: [Option<Range>; 2],
    ) -> Self {
        let surfels = &oracle.scene.surfels;
        let mut drawn = Vec::new();
        for i in back_to_front(surfels, camera) {
            let added = groups.added().iter().filter(|pair| pair.0 == i).map(|pair| pair.1);
            let i = i as usize;
            for group in added.chain([groups.own()[i]]).map(usize::from) {
                let scale = f64::from(groups.scale()[group]);
                let (cull, rounding) = (settings.splats.cull, [oracle.step, oracle.guard]);
                let splat = Splat::new(&oracle.optics, surfels, (i, scale), cull, rounding);
                let Some(splat) = splat.filter(|s| !s.outside || s.doubtful) else { continue };
                let alpha = surfels.opacity().map_or(1.0, |all| f64::from(all[i]));
                let color = shaded(&oracle, &splat);
                drawn.push(Drawn { group, splat, scale, alpha, color });
            }
        }
        let (own, count) = (groups.own(), groups.len());
        let one = Algorithm1 { oracle, own, count, range: voronoi };
        Self { one, settings, range: range.expect("bins"), drawn }
    }

    /// Everything about a point of the picture.
    pub(crate) fn at(&self, at: [f64; 2]) -> Truth {
        let mut truth = Truth {
            ambiguous: false,
            near: None,
            images: vec![Image::EMPTY; self.one.count],
            average: Image::EMPTY,
            depth: Conditioned::exact(f64::INFINITY),
            nearest: Vec::new(),
        };
        if self.settings.nearest.is_some() {
            self.nearest(at, &mut truth);
        }
        let mut all = Vec::new();
        for drawn in &self.drawn {
            if let Some(f) = drawn.splat.fragment(&self.one.oracle.optics, at[0], at[1]) {
                self.draw(drawn, f, &mut truth, &mut all);
            }
        }
        if self.settings.nearest.is_none() {
            let first = all.iter().fold(f64::INFINITY, |least, seen| seen.1.value.t.min(least));
            truth.nearest = self.one.oracle.nearest(&all);
            let spreads = all.iter().filter(|seen| truth.nearest.contains(&(seen.0.index as u32)));
            let spread = spreads.fold(0.0, |most, seen| seen.1.spread.t.max(most));
            truth.depth = Conditioned { value: first, condition: spread };
        }
        let covered = truth.images.iter().filter(|image| image.bin.is_finite()).count();
        let count = match self.settings.holes {
            Holes::Skipped => covered,
            Holes::Background => self.one.count,
        };
        truth.average = Image::average(&truth.images, count);
        truth
    }

    /// By what part of a bin the bins of a group lie nearer: a quotient in `f32`, as the page says.
    fn shift(&self, group: usize) -> f64 {
        match self.settings.bin_edges {
            BinEdges::Staggered => f64::from(group as f32 / self.one.count as f32),
            BinEdges::Common => 0.0,
        }
    }

    /// One fragment into the image of its group.
    fn draw<'b>(&self, drawn: &'b Drawn, f: Fragment, truth: &mut Truth, all: &mut Vec<Seen<'b>>) {
        let oracle = &self.one.oracle;
        let seen = (&drawn.splat, f);
        if f.value.q - oracle.limit() > oracle.margin(&f) {
            return;
        }
        if self.settings.nearest.is_some() {
            let Some(near) = &truth.near else { return };
            let beyond = f.value.t - (near.depth + oracle.epsilon);
            // The plane of a disc does not depend on its radius, but for the centre of its picture.
            let one_plane =
                drawn.scale == 1.0 || self.settings.splats.kernel.outline != Outline::Perspective;
            let same = one_plane && near.surfels == [drawn.splat.index as u32];
            let doubt = oracle.slack(&f) + near.slack + oracle.band();
            if beyond < -doubt || (same && beyond <= 0.0) {
                return;
            }
            truth.ambiguous |= beyond.abs() <= doubt;
            if beyond <= 0.0 {
                return;
            }
        }
        truth.ambiguous |= oracle.unsure(&seen);
        if f.value.q > oracle.limit() {
            return;
        }
        let [bin, other] = self.one.bins(&self.range, self.shift(drawn.group), &f);
        truth.ambiguous |= bin != other;
        let image = &mut truth.images[drawn.group];
        if bin < image.bin {
            image.bin = bin;
            image.blend(drawn);
            all.push(seen);
        }
    }

    /// The nearest layer.
    fn nearest(&self, at: [f64; 2], truth: &mut Truth) {
        let oracle = &self.one.oracle;
        let images = self.one.images(at);
        truth.ambiguous |= images.iter().any(|image| image.undecided());
        let kept: Vec<Seen<'_>> =
            images.iter().filter_map(|image| image.candidates.first()).map(|c| c.seen).collect();
        truth.ambiguous |= oracle.grazes(&kept);
        let seen = oracle.seen(&kept);
        let entries = oracle.entries(at, &kept, &seen);
        let find = |plane| {
            let entry = entries.iter().find(|e| e.plane == plane).expect("of every pixel");
            [0, 1, 2].map(|c| Conditioned { value: entry.value[c], condition: entry.condition[c] })
        };
        if kept.is_empty() {
            return;
        }
        let [weight, depth] = ["weight", "Z"].map(|plane| find(plane)[0]);
        let first = kept.iter().find(|s| s.1.value.t == depth.value).expect("the nearest");
        let slack = oracle.slack(&first.1);
        truth.nearest = oracle.nearest(&kept);
        truth.depth = depth;
        let alpha = opacity(oracle, &seen, weight);
        let (color, normal) = (find(""), find("normal"));
        let (depth, surfels) = (depth.value, truth.nearest.clone());
        truth.near = Some(Near { depth, slack, color, alpha, normal, weight, surfels });
    }
}

/// The weighted average of the opacities of fragments, of their sum of weights.
pub(crate) fn opacity(oracle: &Oracle<'_>, seen: &[Seen<'_>], weight: Conditioned) -> Conditioned {
    let opacity = oracle.scene.surfels.opacity();
    let terms = seen.iter().map(|(splat, f)| {
        let condition = f.spread.weight + oracle.step * f.value.weight;
        let alpha = opacity.map_or(1.0, |all| all[splat.index].into());
        Conditioned { value: f.value.weight, condition } * Conditioned::exact(alpha)
    });
    terms.fold(Conditioned::ZERO, |sum, term| sum + term) / weight
}

/// The colour of a surfel, shaded at its centre, and its change with every input.
fn shaded(oracle: &Oracle<'_>, splat: &Splat) -> [Conditioned; 3] {
    let (scene, eye) = (oracle.scene, &oracle.optics.eye);
    let own = scene.surfels.color().map(|all| all[splat.index]);
    let surface = wide(own.unwrap_or(scene.material.color));
    let world = wide(scene.surfels.position()[splat.index]);
    let side = if splat.back { -1.0 } else { 1.0 };
    let normal = scaled(wide(scene.surfels.normal()[splat.index]), side);
    let (p, reach) = (eye.point(world), eye.magnitude(world));
    let color = |p: V3, n: V3| oracle.phong(eye.pixel(p), -p[2], n, surface);
    let value = color(p, normal);
    let mut condition = scaled(value, oracle.step);
    for axis in 0..3 {
        let (mut q, mut n) = (p, normal);
        q[axis] += oracle.step * reach[axis];
        n[axis] += oracle.step;
        for other in [color(q, normal), color(p, n)] {
            for c in 0..3 {
                condition[c] += (other[c] - value[c]).abs();
            }
        }
    }
    [0, 1, 2].map(|c| Conditioned { value: value[c], condition: condition[c] })
}
