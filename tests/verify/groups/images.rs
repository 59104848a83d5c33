//! The geometry pass: a depth-image for each group.

use super::Client;
use super::bug::Bug;
use super::manner::Manner;
use crate::verify::client::number::{Number, Vector, scrambled};
use crate::verify::client::passes::{Pass, depth, fragment, half, inside, pixels, stored, weight};
use crate::verify::client::project::Splat;
use splatref::frame::NO_ID;

/// What the depth test compares.
#[derive(Clone, Copy)]
struct Key {
    nearness: f32,
    depth: f32,
    voronoi: f32,
}

/// What an image keeps at a pixel: depth, and what eq. 4 calls weighted attributes.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    pub(super) surfel: u32,
    pub(super) nearness: f32,
    pub(super) depth: f32,
    pub(super) voronoi: f32,
    pub(super) weight: Number,
    pub(super) normal: Vector,
    pub(super) color: Vector,
}

#[derive(Clone, Copy, Default)]
struct Cell {
    key: Option<Key>,
    kept: Option<Kept>,
}

/// The image of a group, row by row from the top left.
pub(super) type Image = Vec<Option<Kept>>;

/// The images of all groups.
pub(super) fn draw(client: &Client<'_>, splats: &[Splat]) -> Vec<Image> {
    let [width, height] = client.shared.size.map(|side| side as usize);
    let mut images = vec![vec![Cell::default(); width * height]; client.groups.len()];
    let mut order = splats.to_vec();
    if client.how.manner == Manner::AnyOrder {
        order.sort_by_key(|splat| scrambled(splat.surfel.into()));
    }
    for splat in &order {
        for group in groups(client, splat.surfel) {
            for [x, y] in pixels(&client.shared, splat) {
                let cell = &mut images[group][y as usize * width + x as usize];
                touch(client, splat, [x, y], cell);
            }
        }
    }
    let kept = |image: Vec<Cell>| image.into_iter().map(|cell| cell.kept).collect();
    let mut images: Vec<Image> = images.into_iter().map(kept).collect();
    spoil(client, &mut images);
    images
}

/// The groups that a surfel is drawn in.
fn groups(client: &Client<'_>, surfel: u32) -> Vec<usize> {
    let (index, count) = (surfel as usize, client.groups.len());
    let own = usize::from(client.groups.own()[index]);
    match client.how.bug {
        Some(Bug::GroupByIndex) => vec![index % count],
        Some(Bug::GroupsTooFew) if count > 1 => vec![own % (count - 1)],
        Some(Bug::GroupNotDrawn) if own + 1 == count => vec![],
        Some(Bug::AddedDrawn) => client.groups.of_surfel(surfel).map(usize::from).collect(),
        _ => vec![own],
    }
}

/// A fragment and what the image has.
fn touch(client: &Client<'_>, splat: &Splat, pixel: [u32; 2], cell: &mut Cell) {
    let shared = &client.shared;
    let (q, w) = fragment(shared, splat, pixel, Pass::Visibility);
    let is_inside = inside(shared, q);
    if !is_inside && !client.has(Bug::DiscardedWriteDepth) {
        return;
    }
    let w = shared.number(stored(shared, w));
    let t = depth(shared, w);
    let voronoi = client.bins.map_or(0.0, |bins| bins.voronoi(client, q, t));
    let key = Key { nearness: w.value, depth: t.value, voronoi };
    let first = cell.kept;
    if let (true, true, Some(kept)) = (client.has(Bug::IdOfTheLast), is_inside, &mut cell.kept) {
        kept.surfel = splat.surfel;
    }
    if cell.key.is_some_and(|than| !passes(client, key, than)) {
        return;
    }
    cell.key = Some(key);
    if !is_inside {
        return;
    }
    let mut kept = attributes(client, splat, q, key);
    if let (true, Some(first)) = (client.has(Bug::WeightOfTheFirst), first) {
        kept.weight = first.weight;
    }
    if let (true, Some(first)) = (client.has(Bug::ImagesBlended), first) {
        kept.weight = first.weight + kept.weight;
        kept.normal = [0, 1, 2].map(|i| first.normal[i] + kept.normal[i]);
        kept.color = [0, 1, 2].map(|i| first.color[i] + kept.color[i]);
    }
    cell.kept = Some(kept);
}

/// The depth test of a fragment that comes later; surfels come in ascending order.
fn passes(client: &Client<'_>, key: Key, than: Key) -> bool {
    let by_voronoi = client.bins.is_some() && !client.has(Bug::VoronoiIgnored);
    // Less is in front.
    let [key, than] = [key, than].map(|key| match client.how.manner {
        _ if by_voronoi => key.voronoi,
        Manner::DepthBufferOfDepth => key.depth,
        _ => -key.nearness,
    });
    match client.how.bug {
        Some(Bug::NoDepthTest) => true,
        Some(Bug::DepthTestReversed) => key > than,
        Some(Bug::TiesReversed) => key <= than,
        _ => key < than || (client.last_of_ties() && key == than),
    }
}

/// What the image keeps of a fragment.
fn attributes(client: &Client<'_>, splat: &Splat, q: Number, key: Key) -> Kept {
    let (shared, surfels) = (&client.shared, &client.shared.scene.surfels);
    let index = splat.surfel as usize;
    let weight = weight(shared, splat, q);
    let reversed = splat.back && !client.has(Bug::NormalsNotReversed);
    let normal = surfels.normal()[index];
    let normal = shared.vector((if reversed { -normal } else { normal }).to_array());
    let color = surfels.color().map_or([0.0; 3], |color| color[index].to_array());
    let color = shared.vector(color).map(|color| weight * color);
    // Only where there is one shader are the factors of a product still known. Else what is stored
    // of a product of -0 is +0, which the pages leave open: as if an empty image had been added to.
    let image = |value: Number| match client.how.bug {
        Some(Bug::HalfImages) => shared.number(half(value.value)),
        _ if client.how.manner == Manner::OneShader => value,
        _ => (value + shared.number(0.0)).stored(),
    };
    Kept {
        surfel: splat.surfel,
        nearness: key.nearness,
        depth: key.depth,
        voronoi: key.voronoi,
        weight: image(weight).stored(),
        normal: match client.how.bug {
            Some(Bug::NormalNotWeighted) => normal,
            _ => normal.map(|component| image(weight * component)),
        },
        color: match client.how.bug {
            Some(Bug::ColorWeightedTwice) => color.map(|color| weight * color),
            _ => color.map(image),
        },
    }
}

/// Mistakes in one pixel, the middle one of those where an image keeps something.
fn spoil(client: &Client<'_>, images: &mut [Image]) {
    if client.has(Bug::ImagesSwapped) && images.len() > 1 {
        images.swap(0, 1);
    }
    let mut covered: Vec<_> = images.iter_mut().flatten().filter(|cell| cell.is_some()).collect();
    let middle = covered.len() / 2;
    let Some(cell) = covered.get_mut(middle) else { return };
    let Some(kept) = cell.as_mut() else { return };
    match client.how.bug {
        Some(Bug::WeightNan) => kept.weight = client.shared.number(f32::NAN),
        Some(Bug::IdNext) => kept.surfel = (kept.surfel + 1).min(NO_ID - 1),
        Some(Bug::DepthOff) => kept.depth *= 1.0 + 2e-5,
        Some(Bug::FragmentMissing) => **cell = None,
        _ => {}
    }
}
