//! Blend a pixel in balls, with every decision that is open.

use super::discs;
use super::splats::{PossibleSplat, PossibleSplats, tie};
use super::walked::Walked;
use crate::composite::under::Under;
use crate::frame::Rect;
use crate::method::gaussians::Order;
use crate::method::gaussians::blending::{GaussianFragment, GaussianPixel, Rules};
use crate::method::gaussians::splats::{Beside, Source};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::splat::ray_disc::RayFragment;
use crate::verdict::Doubt;
use crate::verdict::checks::widened;
use crate::verdict::client::Storage;
use crate::verdict::marks::TilePart;
use crate::verdict::supposed::Supposed;

/// A fragment that may be drawn.
struct Possible<'s, P: Profile> {
    splat: &'s PossibleSplat<P>,
    alpha: Ball<P>,
    /// Whether it is inside, dense, and of a splat that is drawn.
    drawn: Three,
    /// What orders the fragments of the pixel.
    key: Ball<P>,
    depth: Ball<P>,
}

/// Whether a fragment that may be drawn certainly is, and what it would be at the pixel.
#[derive(Clone, Copy, Debug)]
struct Candidate<P: Profile> {
    index: u32,
    weight: Ball<P>,
    drawn: Three,
}

/// Walks the pixels of a rectangle in a tile.
pub(super) struct Walker<'a, P: Profile> {
    source: &'a Source<'a, Ball<P>>,
    splats: &'a PossibleSplats<P>,
    supposed: Supposed,
    /// What the client's test against the surface compares.
    depth_test: Storage,
    rules: Rules<Ball<P>>,
    places: Vec<usize>,
}

impl<'a, P: Profile> Walker<'a, P> {
    pub(super) fn new(
        source: &'a Source<'a, Ball<P>>,
        supposed: Supposed,
        depth_test: Storage,
        splats: &'a PossibleSplats<P>,
        part: TilePart,
    ) -> Self {
        let (rules, places) = (Rules::new(source.settings), splats.places(part));
        Self { source, splats, supposed, depth_test, rules, places }
    }

    /// What may be at a pixel.
    pub(super) fn walk(&mut self, at: (u32, u32)) -> Walked<P> {
        let own = self.source.settings.order == Order::Pixel;
        let splats = self.places.iter().map(|&place| &self.splats.all[place]);
        let mut all: Vec<_> = splats.filter_map(|splat| self.possible(splat, at)).collect();
        if own {
            all.sort_by(|a, b| {
                let by_key = a.key.middle.total_cmp(&b.key.middle);
                by_key.then(tie(self.supposed, a.splat.splat.index, b.splat.splat.index))
            });
        }
        let mut walk = Walk {
            rules: &self.rules,
            supposed: self.supposed,
            own,
            states: vec![(GaussianPixel::EMPTY, true.into())],
            candidates: Vec::with_capacity(all.len()),
            firsts: Vec::new(),
            covered: false,
            doubts: 0,
            brightest: 0.0,
        };
        let widest = all.iter().map(|one| one.key.radius);
        // NaN stands for any number.
        let widest = widest.fold(0.0, |most, r| if r <= most { most } else { r * 1.000_001 });
        let mut rest = &all[..];
        while !rest.is_empty() && walk.alive().possibly() {
            let (group, after) = rest.split_at(walk.tied(rest, widest));
            walk.group(group);
            rest = after;
        }
        walk.finished()
    }

    /// The fragment of a splat, if it may be drawn.
    fn possible<'s>(&self, splat: &'s PossibleSplat<P>, at: (u32, u32)) -> Option<Possible<'s, P>> {
        let own = &splat.splat;
        if !holds(&own.bounds, at) {
            return None;
        }
        let fragment = self.fragment(splat, at);
        let GaussianFragment { alpha, inside, dense, depth, .. } = fragment;
        let alpha = bounded(alpha, own.alpha.at_most(self.rules.most));
        let certain = splat.sound && holds(&splat.certain, at);
        let drawn = inside & dense & Three::new([certain, true, true]);
        if !drawn.possibly() {
            return None;
        }
        let depth = match splat.beside.as_deref() {
            Some(Beside::Solid(solid)) => {
                let ray = self.source.projector.ray(at);
                self.source.projector.deepest(&solid.adjugate, solid.place, ray)
            }
            _ => depth,
        };
        let drawn = drawn & self.before_surface(depth, at);
        if !drawn.possibly() {
            return None;
        }
        let key = if self.source.settings.order == Order::Pixel { depth } else { own.key };
        Some(Possible { splat, alpha, drawn, key, depth })
    }
}

impl<P: Profile> Walker<'_, P> {
    /// Whether a splat certainly has a fragment at a pixel.
    pub(super) fn certainly_draws(&self, splat: &PossibleSplat<P>, at: (u32, u32)) -> bool {
        self.possible(splat, at).is_some_and(|one| one.drawn.certainly())
    }

    /// Whether a fragment of this depth is not behind the surface.
    fn before_surface(&self, depth: Ball<P>, (x, y): (u32, u32)) -> Three {
        if matches!(self.supposed, Supposed::SurfaceNotTested | Supposed::SurfaceIgnored) {
            return true.into();
        }
        match self.source.surface().and_then(|surface| surface.at(x, y)) {
            // The surface has its bits from a file, so only the fragment's depth is open.
            Some((opaque, _)) => self.depth_test.tested(depth).le(Ball::exact(opaque.into())),
            None => true.into(),
        }
    }

    /// The fragment of a splat at a pixel within its bounds.
    fn fragment(&self, splat: &PossibleSplat<P>, at: (u32, u32)) -> GaussianFragment<Ball<P>> {
        let own = &splat.splat;
        let twice = self.supposed == Supposed::ExpWithoutHalf;
        if let Some(Beside::Disc(disc)) = splat.beside.as_deref() {
            let met = discs::fragment(disc, &self.source.projector.rays, at);
            let rho = if twice { met.rho + met.rho } else { met.rho };
            return self.rules.of_disc(own, &RayFragment { rho, ..met });
        }
        let power = splat.power(at);
        self.rules.with_power(own, if twice { power + power } else { power })
    }
}

/// An alpha without bounds lies between 0 and the alpha at the centre.
fn bounded<P: Profile>(alpha: Ball<P>, most: Ball<P>) -> Ball<P> {
    if alpha.radius.is_finite() {
        return alpha;
    }
    let half = most.ends()[1] * 0.5;
    let half = if half.is_finite() { half } else { 0.5 };
    Ball::new(half, half)
}

fn holds(&Rect { x0, y0, x1, y1 }: &Rect, (x, y): (u32, u32)) -> bool {
    (x0..x1).contains(&x) && (y0..y1).contains(&y)
}

/// The state of a walk through the fragments of a pixel.
struct Walk<'r, P: Profile> {
    rules: &'r Rules<Ball<P>>,
    supposed: Supposed,
    /// Whether the pixel has its own order.
    own: bool,
    /// What may be there, one state for each order that is followed.
    states: Vec<State<P>>,
    candidates: Vec<Candidate<P>>,
    firsts: Vec<(u32, Ball<P>)>,
    covered: bool,
    doubts: u8,
    brightest: f64,
}

/// The numbers of a pixel, and whether blending has not ended.
type State<P> = (GaussianPixel<Ball<P>>, Three);

/// The most fragments of which every order is followed.
const ORDERS: usize = 3;
/// The most states that are followed side by side, before they are put into one.
const STATES: usize = 12;

impl<P: Profile> Walk<'_, P> {
    /// How many of the next fragments may come in another order: all of them certainly come before
    /// every fragment after them.
    fn tied(&self, rest: &[Possible<'_, P>], widest: f64) -> usize {
        let (mut end, mut last) = (1, 1);
        while end < rest.len() {
            let own = &rest[end - 1];
            let reach = own.key.ends()[1] + widest;
            // Keys rise with their middles, so none that lies farther may come before.
            // Those up to `last` belong to the group already.
            let near = rest[last..].iter().take_while(|one| !(one.key.middle > reach)).count();
            let farthest = (last..last + near).rev().find(|&j| !self.before(own, &rest[j]));
            last = farthest.map_or(last, |j| j + 1);
            if last <= end {
                break;
            }
            end += 1;
        }
        last
    }

    /// Whether a fragment certainly comes before one that stands after it.
    fn before(&self, a: &Possible<'_, P>, b: &Possible<'_, P>) -> bool {
        let same = !self.own && a.splat.products == b.splat.products;
        let exact = a.key.radius == 0.0 && b.key.radius == 0.0;
        let first = tie(self.supposed, a.splat.splat.index, b.splat.splat.index).is_lt();
        a.key.lt(b.key).certainly() || ((same || exact) && a.key.middle == b.key.middle && first)
    }

    /// Blends fragments whose order is open.
    fn group(&mut self, group: &[Possible<'_, P>]) {
        for one in group {
            let parts = one.splat.splat.color.map_inline(|part| part.middle.abs());
            self.brightest = parts.into_iter().fold(self.brightest, f64::at_least);
        }
        if let [one] = group {
            self.candidate(one, self.through(), self.alive());
            self.each_state(|walk, state| walk.next(state, one));
        } else {
            self.doubts |= Doubt::Nearer as u8;
            self.any_order(group);
        }
        if self.candidates.iter().any(|one| one.drawn.certainly()) {
            self.covered = true;
        }
    }

    /// How much is seen through what was blended, in any state.
    fn through(&self) -> Ball<P> {
        let all = self.states.iter().map(|(numbers, _)| numbers.blend.through);
        all.reduce(Ball::either).unwrap_or(Ball::ONE)
    }

    /// Whether blending has not ended, in any state.
    fn alive(&self) -> Three {
        let all = self.states.iter().map(|(_, alive)| *alive);
        all.reduce(either).unwrap_or(true.into())
    }

    /// Replaces each state by the one after it.
    fn each_state(&mut self, mut after: impl FnMut(&mut Self, State<P>) -> State<P>) {
        let states = std::mem::take(&mut self.states);
        self.states = states.into_iter().map(|state| after(self, state)).collect();
    }

    /// The colour of a fragment by the rule that is supposed.
    fn color(&self, one: &Possible<'_, P>) -> [Ball<P>; 3] {
        let color = one.splat.splat.color;
        if self.supposed == Supposed::ColorsTwice {
            color.map_inline(|part| part * one.alpha)
        } else {
            color
        }
    }

    /// The state after one more fragment, which may be drawn or not.
    fn next(&mut self, (numbers, alive): State<P>, one: &Possible<'_, P>) -> State<P> {
        let ends = self.rules.ends(left(numbers.blend.through, one.alpha));
        let goes_on = alive & !(one.drawn & ends);
        let drawn = alive & one.drawn & !self.leaves_out(ends);
        if drawn.possibly() && !drawn.certainly() {
            self.doubts |= Doubt::CutOff as u8;
        }
        let mut after = numbers.after(one.alpha, self.color(one), one.depth);
        after.blend.through = left(numbers.blend.through, one.alpha);
        (select(drawn, &after, &numbers), goes_on)
    }

    /// Whether a fragment is left out that ends blending.
    fn leaves_out(&self, ends: Three) -> Three {
        if self.supposed == Supposed::StopAfter { false.into() } else { ends }
    }

    /// Follows every order of a few fragments, and bounds the weights of many.
    fn any_order(&mut self, group: &[Possible<'_, P>]) {
        let (through, alive) = (self.through(), self.alive());
        let alone: Vec<Ball<P>> = group.iter().map(|one| seen(one, Ball::ONE)).collect();
        let covers = products_of_others(&alone);
        for (one, cover) in group.iter().zip(&covers) {
            self.candidate(one, through.either(through * *cover), alive);
        }
        if group.len() > ORDERS {
            self.each_state(|walk, state| walk.many(state, group, &covers));
            return;
        }
        let orders = orders(group.len());
        if self.states.len() * orders.len() > STATES {
            let all = std::mem::take(&mut self.states).into_iter();
            self.states =
                all.reduce(|a, b| (hull(&a.0, &b.0), either(a.1, b.1))).into_iter().collect();
        }
        for state in std::mem::take(&mut self.states) {
            for order in &orders {
                let after = order.iter().fold(state, |state, &i| self.next(state, &group[i]));
                self.states.push(after);
            }
        }
    }

    /// The state after many fragments in any order, each with how much the others leave.
    fn many(
        &mut self,
        (mut numbers, mut alive): State<P>,
        group: &[Possible<'_, P>],
        covers: &[Ball<P>],
    ) -> State<P> {
        let (first, open) = (numbers.blend.through, alive);
        for (one, cover) in group.iter().zip(covers) {
            let before = first.either(first * *cover);
            let here =
                GaussianPixel { blend: Under { through: before, ..numbers.blend }, ..numbers };
            let ends = one.drawn & self.rules.ends(left(before, one.alpha));
            let drawn = open & one.drawn & !self.leaves_out(ends);
            let after = here.after(one.alpha, self.color(one), one.depth);
            let blended = select(drawn, &after, &here);
            let through = numbers.blend.through;
            let median = numbers.median.either(after.median);
            numbers = GaussianPixel { median, ..blended };
            numbers.blend.through = Ball::select(drawn, left(through, one.alpha), through);
            if drawn.possibly() && !drawn.certainly() {
                self.doubts |= Doubt::CutOff as u8;
            }
            alive = alive & !ends;
        }
        (numbers, alive)
    }

    /// Remembers a fragment in front of which this much is seen.
    fn candidate(&mut self, one: &Possible<'_, P>, through: Ball<P>, alive: Three) {
        let ends = self.rules.ends(left(through, one.alpha));
        let drawn = alive & one.drawn & !self.leaves_out(ends);
        if drawn.possibly() {
            let index = one.splat.splat.index;
            let weight = through * one.alpha;
            self.candidates.push(Candidate { index, weight, drawn });
            if !self.covered {
                self.firsts.push((index, one.depth));
            }
        }
    }

    fn finished(self) -> Walked<P> {
        let certain = self.candidates.iter().filter(|one| one.drawn.certainly());
        let least = certain.clone().count() as u32;
        let bar = certain.map(|one| one.weight.ends()[0]).fold(0.0, f64::at_least);
        let heavy = self.candidates.iter().filter(|one| !(one.weight.ends()[1] < bar));
        Walked {
            heaviest: heavy.map(|one| one.index).collect(),
            least,
            most: self.candidates.len() as u32,
            numbers: self.states.iter().map(|(numbers, _)| numbers.finished()).collect(),
            firsts: self.firsts,
            covered: self.covered,
            brightest: self.brightest,
            doubts: self.doubts,
        }
    }
}

/// T (1 - alpha). Where terms may be added in any order it may be T - T alpha, whose roundings are
/// relative to T: of a product and of a sum, 2 u each.
fn left<P: Profile>(through: Ball<P>, alpha: Ball<P>) -> Ball<P> {
    let left = through * (Ball::ONE - alpha);
    let lost = if P::ADDS_IN_ANY_ORDER { through.middle.abs() / 4_194_304.0 } else { 0.0 };
    widened(left, lost)
}

/// How much is seen behind a fragment that may be drawn.
fn seen<P: Profile>(one: &Possible<'_, P>, through: Ball<P>) -> Ball<P> {
    Ball::select(one.drawn, left(through, one.alpha), through)
}

/// For each number the product of all others: of those before it, times those after it. A quotient
/// of the whole product would have no bounds where a number may be 0.
fn products_of_others<P: Profile>(all: &[Ball<P>]) -> Vec<Ball<P>> {
    // A product with 1 would round.
    let times = |a: Option<Ball<P>>, b: Option<Ball<P>>| match (a, b) {
        (Some(a), Some(b)) => Some(a * b),
        (a, b) => a.or(b),
    };
    let (mut products, mut before) = (Vec::with_capacity(all.len()), None);
    for &one in all {
        products.push(before);
        before = times(before, Some(one));
    }
    let mut after = None;
    for (product, &one) in products.iter_mut().zip(all).rev() {
        *product = times(*product, after);
        after = times(Some(one), after);
    }
    products.into_iter().map(|product| product.unwrap_or(Ball::ONE)).collect()
}

/// A truth that holds if either of two may hold.
fn either(a: Three, b: Three) -> Three {
    let certain = a.certainly() && b.certainly();
    let possible = a.possibly() || b.possibly();
    Three::new([certain, possible, possible])
}

/// One of two pixels, or the hull of both.
fn select<P: Profile>(
    truth: Three,
    yes: &GaussianPixel<Ball<P>>,
    no: &GaussianPixel<Ball<P>>,
) -> GaussianPixel<Ball<P>> {
    let of = |yes, no| Ball::select(truth, yes, no);
    let color = [0, 1, 2].map_inline(|c| of(yes.blend.color[c], no.blend.color[c]));
    GaussianPixel {
        blend: Under {
            color,
            alpha: of(yes.blend.alpha, no.blend.alpha),
            through: of(yes.blend.through, no.blend.through),
        },
        moment: of(yes.moment, no.moment),
        median: of(yes.median, no.median),
        ..*yes
    }
}

/// The hull of two pixels.
fn hull<P: Profile>(
    a: &GaussianPixel<Ball<P>>,
    b: &GaussianPixel<Ball<P>>,
) -> GaussianPixel<Ball<P>> {
    select(Three::new([false, true, true]), a, b)
}

/// All orders of 2 or 3 items.
fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 2 {
        return vec![vec![0, 1], vec![1, 0]];
    }
    let firsts = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    firsts.map(|order| order.to_vec()).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::ball::Gpu;
    use crate::number::random::unit;

    #[test]
    fn products_of_others_are_as_tight_as_products_in_one_order() {
        for count in [1, 2, 3, 7, 40] {
            let ball = |i: u64| {
                let middle = f64::from(unit(count, i)).sqrt();
                Ball::<Gpu>::new(middle, f64::from(unit(count, 100 + i)) * 0.01)
            };
            let all: Vec<_> = (0..count).map(ball).collect();
            for (skip, product) in products_of_others(&all).into_iter().enumerate() {
                let others = all.iter().enumerate().filter(|(j, _)| *j != skip);
                let plain = others.fold(Ball::ONE, |product, (_, one)| product * *one);
                let exact = all.iter().enumerate().filter(|(j, _)| *j != skip);
                let exact: f64 = exact.map(|(_, one)| one.middle).product();
                let [low, high] = product.ends();
                assert!(low <= exact && exact <= high, "{skip} of {count}");
                let [own, plain] = [product.radius, plain.radius];
                assert!(own <= plain * 1.000_01, "{own} {plain}, {skip} of {count}");
            }
        }
    }
}
