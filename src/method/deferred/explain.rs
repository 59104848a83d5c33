//! Explain every decision of every pass at one pixel, with its operands.

use super::Settings;
use super::filter::{Level, color};
use super::indices::{each_centre, indices, selected};
use super::part::{Part, Whole};
use super::picture::{first, flagged, unseen, whole};
use super::polygons::Polygons;
use super::visibility::{both, nearest};
use crate::error::Result;
use crate::method::Job;
use crate::method::decisions::{Decision, Place, Touch, touch};
use crate::method::prepare::Prepared;
use crate::number::Exact;
use crate::splat::{Splat, SplatSettings, View};
use glam::Vec3;
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct DeferredReplay<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// Counts of surfels: how many the high level leaves, how many of these have a flag that is
    /// set, and how many were selected.
    pub counts: [u64; 3],
    /// The depth of the nearest polygon, if there is one.
    pub polygon: Option<R>,
    /// Pass 1: the splats that reach the pixel, by name, in the order of ids.
    pub before: Vec<(String, Touch<R>)>,
    /// The depth that pass 1 leaves.
    pub visible: R,
    /// The depth of the visible band in world units.
    pub epsilon: R,
    /// Pass 2: the surfels whose centre is in the pixel: name, depth, and the tests.
    pub centres: Vec<Centre<R>>,
    /// Pass 3: the splats that reach the pixel, as in `before`.
    pub fresh: Vec<(String, Touch<R>)>,
    /// The depth that pass 3 leaves.
    pub nearest: R,
    /// Pass 4: the splats of B(i) that reach the pixel; each gives its weight, if it is visible.
    pub sums: Vec<(String, Touch<R>)>,
    /// The colours of these splats, if the surfels have prefiltered colours.
    pub colors: Vec<Filtered>,
}

/// The prefiltered colour of a surfel in pass 4.
#[derive(Clone, Debug)]
pub struct Filtered {
    /// The name of the surfel.
    pub name: String,
    /// The surfel's level, see [`mod@super::filter`], and the last level.
    pub level: [f64; 2],
    /// The colours of the levels below and above; one colour if both are the same level.
    pub between: Vec<Vec3>,
    /// The colour in which the surfel is drawn.
    pub color: Vec3,
}

/// A surfel whose centre is in the pixel.
#[derive(Clone, Debug)]
pub struct Centre<R> {
    /// The name of the surfel.
    pub name: String,
    /// The test against the depth of pass 1.
    pub visible: Decision<R>,
    /// Whether the pixel keeps this surfel.
    pub kept: bool,
}

/// Replays all passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture; else the errors of a picture.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<DeferredReplay<R>> {
    let place = Place::new(job, pixel)?;
    let splats = &settings.splats;
    let (whole, before) = whole(job, settings)?;
    let flagged = whole.part(flagged(&whole, &before)?, job.exec);
    let polygons = Polygons::draw(job, settings, &whole)?;
    let visible = first::<R>(job, settings, &flagged, polygons.as_ref());
    let kept = indices(job, splats, &whole, &visible);
    let part = whole.drawn(selected(&kept), job);
    let third = if settings.second { part.ids() } else { &[] };
    let fresh = whole.part(unseen(&whole, &before, third), job.exec);
    let depth = both(job, &visible, &nearest(job, splats, &fresh));

    let (x, y) = pixel;
    let at = visible.at(x, y);
    let epsilon = R::from_f32(splats.epsilon.in_units(whole.median_radius()));
    let mut centres = Vec::new();
    each_centre::<R>(job, splats, &whole, |id, found, t| {
        if found == [x, y] {
            let visible = Decision::visible(t, at.depth, epsilon);
            let kept = kept.at(x, y).id == id;
            centres.push(Centre { name: whole.name(id), visible, kept });
        }
    });
    let pass = |part: &Part, each: &dyn Fn(&mut Touch<R>, &Splat<R>)| {
        touches(job, splats, part, &whole, &place, each)
    };
    let nothing = |_: &mut Touch<R>, _: &Splat<R>| ();
    let end = depth.at(x, y).depth;
    let weigh = |touch: &mut Touch<R>, splat: &Splat<R>| {
        let t = touch.t;
        touch.decide(|| Decision::visible(t, end, epsilon));
        touch.gives = touch.passes().then(|| ("weight", splat.footprint.weight(touch.q)));
    };
    let all = whole.drawn_ids().len() as u64;
    let sums = pass(&part, &weigh);
    let names: Vec<&String> = sums.iter().map(|(name, _)| name).collect();
    let colors = colors(job, &whole, &part, &names);
    Ok(DeferredReplay {
        pixel,
        counts: [all, flagged.ids().len() as u64, part.ids().len() as u64],
        polygon: polygons
            .map(|polygons| polygons.nearest(x, y).depth)
            .filter(|depth| *depth < R::INFINITY),
        before: pass(&flagged, &nothing),
        visible: at.depth,
        epsilon,
        centres,
        fresh: pass(&fresh, &nothing),
        nearest: end,
        sums,
        colors,
    })
}

/// The colours of a part's surfels, by name; none if they have no prefiltered colours.
fn colors(job: &Job<'_>, whole: &Whole<'_>, part: &Part, names: &[&String]) -> Vec<Filtered> {
    let surfels = whole.surfels(part.ids(), job.exec);
    let Some(mipmap) = surfels.mipmap() else { return Vec::new() };
    let view = View::new(job.camera);
    let wanted = (0..surfels.len()).map(|i| (i, whole.name(part.ids()[i])));
    let filtered = wanted.filter(|(_, name)| names.contains(&name)).map(|(i, name)| {
        let level = Level::of_surfel(&view, &surfels, i);
        let ends = [level.below, level.below + usize::from(level.part > 0.0)];
        let mut between: Vec<Vec3> = Vec::new();
        let whole = |k: usize| color(&surfels, i, Level { below: k, part: 0.0 });
        between.extend(ends.iter().take(1 + ends[1] - ends[0]).map(|&k| whole(k)));
        let level_of = [level.number(), mipmap.levels() as f64];
        Filtered { name, level: level_of, between, color: color(&surfels, i, level) }
    });
    filtered.collect()
}

/// The splats of a part at the pixel.
fn touches<R: Exact>(
    job: &Job<'_>,
    settings: &SplatSettings,
    part: &Part,
    whole: &Whole<'_>,
    place: &Place,
    each: &dyn Fn(&mut Touch<R>, &Splat<R>),
) -> Vec<(String, Touch<R>)> {
    let job = part.job(job);
    let prepared = Prepared::splats(&job, settings);
    let tile = place.splats(&prepared);
    let mut touches = Vec::new();
    tile.each_in_bounds(|splat, _, q, w| {
        let mut seen = touch(tile.shared(), splat.surfel, q, w);
        each(&mut seen, splat);
        touches.push((whole.name(part.id(splat.surfel)), seen));
    });
    touches
}

impl<R: Exact> fmt::Display for DeferredReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), [all, flagged, selected]) = (self.pixel, self.counts);
        writeln!(
            f,
            "pixel ({x}, {y}); of {all} surfels {flagged} are flagged, {selected} selected"
        )?;
        if let Some(depth) = self.polygon {
            writeln!(f, "the nearest polygon has the depth {}", depth.to_f64())?;
        }
        let pass = |f: &mut fmt::Formatter<'_>, what: &str, touches: &[(String, Touch<R>)]| {
            writeln!(f, "\n{what}: {} splats reach the pixel", touches.len())?;
            for (name, touch) in touches {
                write!(f, "  {name:<24}")?;
                touch.fmt_decisions(f)?;
                writeln!(f)?;
            }
            Ok(())
        };
        pass(f, "1. visibility splatting of the flagged surfels", &self.before)?;
        let (depth, epsilon) = (self.visible.to_f64(), self.epsilon.to_f64());
        writeln!(f, "\n2. indices: drawn if depth <= {depth} + epsilon {epsilon}")?;
        for Centre { name, visible, kept } in &self.centres {
            writeln!(f, "  {name:<24}  {visible}{}", if *kept { "  kept" } else { "" })?;
        }
        pass(f, "3. visibility splatting of the selected surfels without a flag", &self.fresh)?;
        pass(
            f,
            &format!(
                "4. EWA splatting of the selected surfels, nearest depth {}",
                self.nearest.to_f64()
            ),
            &self.sums,
        )?;
        for Filtered { name, level: [level, last], between, color } in &self.colors {
            let between: Vec<String> = between.iter().map(Vec3::to_string).collect();
            let between = between.join(" and ");
            writeln!(f, "  {name:<24}  level {level:.4} of {last}, {between}: colour {color}")?;
        }
        Ok(())
    }
}
