//! The compositing pass: sums over the images of what is near the nearest, and averages.

use super::Client;
use super::bug::Bug;
use super::images::{Image, Kept};
use super::manner::Manner;
use crate::verify::client::habit::Habit;
use crate::verify::client::number::{Number, Vector, scrambled, unit};
use crate::verify::client::passes::half;

/// What the pass leaves at a pixel.
#[derive(Clone, Copy)]
pub(super) struct Surface {
    pub(super) sums: Sums,
    pub(super) depth: f32,
    pub(super) id: u32,
    pub(super) color: [f32; 3],
    pub(super) normal: [f32; 3],
}

/// The sums over the groups that are visible.
#[derive(Clone, Copy)]
pub(super) struct Sums {
    pub(super) weight: f32,
    pub(super) normal: [f32; 3],
    pub(super) color: [f32; 3],
    pub(super) count: u8,
}

/// All pixels; none where no image has anything.
pub(super) fn composite(client: &Client<'_>, images: &[Image]) -> Vec<Option<Surface>> {
    let pixels = images[0].len();
    let mut surfaces: Vec<_> = (0..pixels).map(|at| pixel(client, images, at)).collect();
    if client.has(Bug::WeightOff) {
        let mut covered: Vec<_> = surfaces.iter_mut().flatten().collect();
        let middle = covered.len() / 2;
        if let Some(surface) = covered.get_mut(middle) {
            surface.sums.weight *= 1.001;
        }
    }
    surfaces
}

/// The groups in the order of the sums.
fn order(client: &Client<'_>, count: usize) -> Vec<usize> {
    let mut order: Vec<_> = (0..count).collect();
    match client.how.habit {
        Habit::LastFirst => order.reverse(),
        Habit::Shuffled => order.sort_by_key(|group| scrambled(*group as u64)),
        _ => {}
    }
    match client.how.bug {
        Some(Bug::GroupNotSummed) => _ = order.remove(0),
        Some(Bug::GroupTwice) => order.push(count - 1),
        _ => {}
    }
    order
}

fn pixel(client: &Client<'_>, images: &[Image], at: usize) -> Option<Surface> {
    let all: Vec<Kept> = images.iter().filter_map(|image| image[at]).collect();
    let nearest = nearest(&all)?;
    let front = front(client, &all)?;
    let order = order(client, images.len());
    let ordered: Vec<Kept> = order.iter().filter_map(|&group| images[group][at]).collect();
    let shown = shown(client, &ordered, nearest);
    let sums = sums(client, &shown, all.len());
    let (color, normal) = averages(client, &sums);
    let heavier = |a: &&Kept, b: &&Kept| a.weight.value.total_cmp(&b.weight.value);
    let deep = match client.how.bug {
        Some(Bug::DepthOfTheLast) => shown.last().copied(),
        Some(Bug::DepthOfTheHeaviest) => shown.iter().max_by(heavier).copied(),
        _ => None,
    };
    let named = match client.how.bug {
        Some(Bug::IdOfTheFirst) => shown.first().copied(),
        _ => None,
    };
    let depth = deep.unwrap_or(nearest).depth;
    Some(Surface { sums, depth, id: named.unwrap_or(front).surfel, color, normal })
}

/// The first of those of the least depth.
fn nearest(all: &[Kept]) -> Option<Kept> {
    all.iter().copied().reduce(|a, b| if b.depth < a.depth { b } else { a })
}

/// The fragment whose surfel is shown: of the greatest nearness, of equals the lower surfel.
fn front(client: &Client<'_>, all: &[Kept]) -> Option<Kept> {
    all.iter().copied().reduce(|a, b| {
        let [before, after] = [a, b].map(|kept| match client.how.manner {
            Manner::DepthBufferOfDepth => kept.depth,
            _ => -kept.nearness,
        });
        let of_equals = match client.how.manner {
            Manner::AnyOrder => false,
            _ if client.has(Bug::IdTiesByGroup) => true,
            _ => (b.surfel < a.surfel) != client.last_of_ties(),
        };
        if after < before || (after == before && of_equals) { b } else { a }
    })
}

/// The epsilon-z test.
fn shown(client: &Client<'_>, kept: &[Kept], nearest_of_all: Kept) -> Vec<Kept> {
    let (number, epsilon) = (|value| client.shared.number(value), client.shared.epsilon);
    let passes = |i: usize| {
        let (nearest, t) = match client.how.bug {
            Some(Bug::NearestSoFar) => (nearest(&kept[..=i]).unwrap_or(kept[i]), kept[i].depth),
            Some(Bug::NearestOfTheFirst) => (kept[0], kept[i].depth),
            Some(Bug::NearestIgnored) => (kept[i], kept[i].depth),
            _ => (nearest_of_all, kept[i].depth),
        };
        let (t, limit) = (number(t), number(nearest.depth));
        match client.how.bug {
            Some(Bug::NearestAlone) => t == limit,
            Some(Bug::EpsilonSubtracted) => t <= limit - epsilon,
            Some(Bug::EpsilonStrict) => t < limit + epsilon,
            Some(Bug::EpsilonOfNearness) => {
                number(kept[i].nearness) >= number(nearest.nearness) - epsilon
            }
            _ => t <= limit + epsilon,
        }
    };
    (0..kept.len()).filter(|&i| passes(i)).map(|i| kept[i]).collect()
}

fn sums(client: &Client<'_>, shown: &[Kept], all: usize) -> Sums {
    let count = match client.how.bug {
        Some(Bug::CountOfAll) => all,
        Some(Bug::CountOffByOne) => shown.len() + 1,
        _ => shown.len(),
    };
    let three = |of: fn(&Kept) -> Vector| {
        [0, 1, 2].map(|i| sum(client, shown.iter().map(|kept| of(kept)[i])))
    };
    let color = three(|kept| kept.color);
    Sums {
        weight: sum(client, shown.iter().map(|kept| kept.weight)),
        normal: three(|kept| kept.normal),
        color: match client.how.bug {
            Some(Bug::SumsSaturate) => color.map(|sum| if sum > 1.0 { 1.0 } else { sum }),
            _ => color,
        },
        count: u8::try_from(count).unwrap(),
    }
}

fn sum(client: &Client<'_>, values: impl Iterator<Item = Number>) -> f32 {
    if client.how.manner == Manner::DoubleSums {
        return values.map(|value| f64::from(value.value)).sum::<f64>() as f32;
    }
    values.fold(0.0, |sum, value| {
        let sum = (client.shared.number(sum) + value).value;
        if client.has(Bug::HalfSums) { half(sum) } else { sum }
    })
}

/// Average colour, and direction of the average normal.
fn averages(client: &Client<'_>, sums: &Sums) -> ([f32; 3], [f32; 3]) {
    let shared = &client.shared;
    let zero = shared.number(0.0); // turns -0 into +0
    if !(sums.weight > 0.0) {
        return ([0.0; 3], [0.0; 3]);
    }
    let average = |sum: [f32; 3], weight: f32| {
        shared.vector(sum).map(|sum| sum / shared.number(weight) + zero)
    };
    let color = match client.how.bug {
        Some(Bug::ColorNotDivided) => shared.vector(sums.color),
        Some(Bug::ColorByCount) => average(sums.color, sums.count.into()),
        _ => average(sums.color, sums.weight),
    };
    let normal = average(sums.normal, sums.weight);
    let normal = match client.how.bug {
        Some(Bug::NormalNotUnit) => normal,
        _ => unit(normal),
    };
    (color.map(|color| color.value), normal.map(|component| (component + zero).value))
}
