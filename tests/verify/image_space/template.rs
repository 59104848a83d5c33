//! Templates: propagation, reconstruction, normalization.

use super::Client;
use super::bug::Bug;
use super::ellipse::Ellipse;
use super::levels::{Level, sizes};
use super::mean::Mean;
use super::planes::{Sheet, Surface};
use super::projection::{Sample, project};
use crate::verify::client::number::{Number, Vector};
use splatref::Frame;
use splatref::frame::NO_ID;
use splatref::method::template::{Falloff, LevelRule, Settings};

/// 2^-24, the least weight.
const LEAST_WEIGHT: f32 = f32::from_bits((127 - 24) << 23);

struct Template<'a> {
    client: &'a Client<'a>,
    settings: &'a Settings,
    /// h: how many cells the template reaches to every side.
    half: u32,
    /// Of the levels 0 to the top.
    sizes: Vec<[u32; 2]>,
}

/// What a pixel has gathered.
#[derive(Clone, Copy)]
struct Gathered {
    id: u32,
    depth: Number,
    radius: Number,
    weight: Number,
    depths: Number,
    normals: Vector,
    colors: Vector,
    count: u8,
}

/// Every plane of the method.
pub(super) fn render(client: &Client<'_>, settings: &Settings) -> Frame<f32> {
    let half = (settings.size - 1) / 2;
    let mut sizes = sizes(client);
    let top = sizes.iter().position(|[w, h]| *w <= half + 1 && *h <= half + 1).unwrap();
    sizes.truncate(top + 1);
    let template = Template { client, settings, half, sizes };
    let samples = project(client);
    let levels = template.propagate(&samples);
    let gathered = Level::made(client.shared.size, |pixel| template.gather(&levels, pixel));
    let mut sheet = Sheet::new(client);
    sheet.projection(&samples);
    for (number, level) in levels.iter().enumerate().skip(1) {
        let (layer, level) = (format!("level{number:02}"), level.handed(client));
        sheet.index(&format!("{layer}.id"), &level, |center| center.id);
        sheet.samples(&layer, &level);
    }
    leave_gathered(&mut sheet, &gathered);
    let surfaces = gathered.cells.iter().map(|pixel| Some(template.normalized(pixel.as_ref()?)));
    sheet.picture(client, &Level { size: gathered.size, cells: surfaces.collect() });
    sheet.frame
}

fn leave_gathered(sheet: &mut Sheet, gathered: &Level<Gathered>) {
    sheet.count("gathered.count", gathered, |pixel| pixel.count);
    sheet.scalar("gathered.weight", gathered, 0.0, |pixel| pixel.weight);
    sheet.scalar("gathered.depths", gathered, 0.0, |pixel| pixel.depths);
    sheet.scalar("gathered.Z", gathered, f32::INFINITY, |pixel| pixel.depth);
    sheet.scalar("gathered.radius", gathered, 0.0, |pixel| pixel.radius);
    sheet.vector("gathered.normal", gathered, |pixel| pixel.normals);
    sheet.color("gathered", gathered, |pixel| pixel.colors);
    sheet.index("id", gathered, |pixel| pixel.id);
    sheet.scalar("weight", gathered, 0.0, |pixel| pixel.weight);
}

impl Template<'_> {
    /// The largest radius in pixels that stays at a level.
    fn reach(&self, level: usize) -> f32 {
        let (cells, half) = (self.settings.size as f32, self.half as f32);
        let cells = match self.settings.levels {
            LevelRule::Radius => cells,
            LevelRule::Diameter => cells / 2.0,
            LevelRule::Covering => half,
            LevelRule::BySize if self.settings.size == 3 => cells,
            LevelRule::BySize if self.client.has(Bug::LevelsByRadius) => cells,
            LevelRule::BySize => cells / 2.0,
        };
        let side = if self.client.has(Bug::ReachNotDoubled) { 1 } else { 1_u32 << level };
        cells * side as f32
    }

    /// Whether a centre stays at a level.
    fn stays(&self, center: &Sample, level: usize) -> bool {
        let (reach, top) = (self.reach(level), level + 1 == self.sizes.len());
        let within = match self.client.how.bug {
            Some(Bug::ReachStrict) => center.extent.value < reach,
            _ => center.extent.value <= reach,
        };
        within || (top && !self.client.has(Bug::TopMovesOn))
    }

    /// All levels: what stays there and what moves on.
    fn propagate(&self, samples: &Level<Sample>) -> Vec<Level<Sample>> {
        let mut levels = vec![samples.clone()];
        for (fine, &size) in self.sizes[1..].iter().enumerate() {
            let coarse = Level::made(size, |cell| {
                let copied = self.client.has(Bug::StayingMovesOn);
                let moves = |center: &Sample| copied || !self.stays(center, fine);
                self.merge(levels[fine].finer(cell).map(|center| center.filter(moves)))
            });
            levels.push(coarse.stored(self.client, fine + 1));
        }
        levels
    }

    /// One centre from those that move.
    fn merge(&self, finer: [Option<Sample>; 4]) -> Option<Sample> {
        let client = self.client;
        let moving = || (0..4).filter(|&j| finer[j].is_some());
        if moving().count() < 2 {
            return finer[moving().next()?];
        }
        let before = |a: &Sample, b: &Sample| match client.how.bug {
            Some(Bug::ForemostIsFarthest) => a.depth > b.depth,
            Some(Bug::ForemostByLast) => a.depth <= b.depth,
            _ => a.depth < b.depth,
        };
        let first = moving().reduce(|first, j| match (finer[j], finer[first]) {
            (Some(a), Some(b)) if before(&a, &b) => j,
            _ => first,
        })?;
        let front = finer[first]?;
        let meets = |center: Sample| match client.how.bug {
            Some(Bug::MergeWithoutDepth) => true,
            Some(Bug::MergeStrict) => center.depth - front.depth < center.radius + front.radius,
            Some(Bug::MergeRadiusSign) => {
                center.depth - front.depth <= center.radius - front.radius
            }
            _ => center.depth - front.depth <= center.radius + front.radius,
        };
        let one = client.number(1.0);
        let mean = Mean::new(client, finer.map(|center| center.filter(|c| meets(*c)).map(|_| one)));
        let number = |of: fn(&Sample) -> Number| {
            mean.of(finer.map(|center| center.map_or(client.zero(), |center| of(&center))))
        };
        let vector = |of: fn(&Sample) -> Vector| {
            mean.vector(finer.map(|center| center.map_or([client.zero(); 3], |center| of(&center))))
        };
        let last = moving().next_back().and_then(|last| finer[last]);
        Some(Sample {
            id: if client.has(Bug::IdOfTheLast) { last?.id } else { front.id },
            depth: number(|center| center.depth),
            radius: number(|center| center.radius),
            extent: number(|center| center.extent),
            center: match client.how.bug {
                Some(Bug::PlaceNotMerged) => front.center,
                _ => [number(|center| center.center[0]), number(|center| center.center[1])],
            },
            normal: vector(|center| center.normal),
            color: vector(|center| center.color),
        })
    }

    /// What a pixel gathers from all templates.
    fn gather(&self, levels: &[Level<Sample>], pixel: [u32; 2]) -> Option<Gathered> {
        let mut order: Vec<_> = levels.iter().enumerate().collect();
        if self.client.has(Bug::CoarseLevelsFirst) {
            order.reverse();
        }
        let half = match self.client.how.bug {
            Some(Bug::TemplateTooSmall) => i64::from(self.half) - 1,
            _ => i64::from(self.half),
        };
        let mut gathered = None;
        for (number, level) in order {
            let [x, y] = pixel.map(|side| i64::from(side >> number));
            for row in -half..=half {
                for column in -half..=half {
                    let row = if self.client.has(Bug::RowsFromBelow) { -row } else { row };
                    let Some(center) = level.at([x + column, y + row]) else { continue };
                    let own = number == 0 && [row, column] == [0, 0];
                    let stays = self.stays(&center, number);
                    if let Some(weight) = self.weight(&center, pixel, own).filter(|_| stays) {
                        gathered = self.blend(gathered, &center, weight);
                    }
                }
            }
        }
        gathered
    }

    /// The weight of a centre at a pixel that it holds.
    fn weight(&self, center: &Sample, pixel: [u32; 2], own: bool) -> Option<Number> {
        let client = self.client;
        let middle = if client.has(Bug::CornerOfPixel) { 0.0 } else { 0.5 };
        let offset =
            [0, 1].map(|axis| client.number(pixel[axis] as f32 + middle) - center.center[axis]);
        let ellipse = Ellipse::new(center.normal, center.extent);
        let form = ellipse.form(client, offset);
        let least = client.number(LEAST_WEIGHT);
        if !ellipse.holds(client, form) {
            return (own && !client.has(Bug::OwnPixelLost)).then_some(least);
        }
        let ratio = form / ellipse.square;
        Some(match (self.settings.falloff, client.how.bug) {
            (Falloff::Gaussian, _) => (ratio * -2.0).exp(),
            (_, Some(Bug::WeightWithoutRoot)) => (client.number(1.0) - ratio).larger(least),
            (_, Some(Bug::RimWithoutWeight)) => client.number(1.0) - ratio.sqrt(),
            _ => (client.number(1.0) - ratio.sqrt()).larger(least),
        })
    }

    /// The ternary test.
    fn blend(&self, sums: Option<Gathered>, center: &Sample, weight: Number) -> Option<Gathered> {
        let client = self.client;
        let Some(front) = sums else { return Some(self.started(center, weight)) };
        let reach = match client.how.bug {
            Some(Bug::TernaryOfOneRadius) => center.radius,
            Some(Bug::TernaryRadiusSign) => center.radius - front.radius,
            _ => center.radius + front.radius,
        };
        if front.depth - center.depth > reach && !client.has(Bug::HiddenFrontStays) {
            return Some(self.started(center, weight));
        }
        if center.depth - front.depth > reach && !client.has(Bug::HiddenBlended) {
            return Some(front);
        }
        let nearer = match client.how.bug {
            Some(Bug::FrontNotUpdated) => false,
            Some(Bug::FrontIsTheLast) => true,
            _ => center.depth < front.depth,
        };
        Some(self.added(front, center, weight, nearer))
    }

    /// Sums of one centre.
    fn started(&self, center: &Sample, weight: Number) -> Gathered {
        let zero = self.client.zero();
        let nothing = Gathered {
            id: NO_ID,
            depth: zero,
            radius: zero,
            weight: zero,
            depths: zero,
            normals: [zero; 3],
            colors: [zero; 3],
            count: 0,
        };
        self.added(nothing, center, weight, true)
    }

    fn added(&self, sums: Gathered, center: &Sample, weight: Number, nearer: bool) -> Gathered {
        let weighed = if self.client.has(Bug::NormalsNotWeighted) {
            weight * 0.0 + self.client.number(1.0)
        } else {
            weight
        };
        let add = |sum: Number, weight: Number, value: Number| (sum + weight * value).stored();
        let three = |sums: Vector, weight: Number, values: Vector| {
            [0, 1, 2].map(|i| add(sums[i], weight, values[i]))
        };
        Gathered {
            id: if nearer { center.id } else { sums.id },
            depth: if nearer { center.depth } else { sums.depth },
            radius: if nearer { center.radius } else { sums.radius },
            weight: (sums.weight + weight).stored(),
            depths: add(sums.depths, weight, center.depth),
            normals: three(sums.normals, weighed, center.normal),
            colors: three(sums.colors, weight, center.color),
            count: sums.count.saturating_add(1),
        }
    }

    /// Sums over weights.
    fn normalized(&self, sums: &Gathered) -> Surface {
        let client = self.client;
        let average = |sum: Number| sum / sums.weight + client.zero();
        let color = match client.how.bug {
            Some(Bug::ColorNotDivided) => sums.colors,
            _ => sums.colors.map(average),
        };
        Surface {
            depth: match client.how.bug {
                Some(Bug::DepthOfTheNearest) => sums.depth.value,
                _ => average(sums.depths).value,
            },
            normal: client.to_world(sums.normals.map(average)),
            color: color.map(|color| color.value),
        }
    }
}
