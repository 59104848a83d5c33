//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::compositing::composites;
use super::geometry::{Geometry, ImagePixel};
use crate::composite::decide;
use crate::error::Result;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::decisions::{Decision, Place, Touch, touch};
use crate::number::Exact;
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct GroupsReplay<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// k^2, the limit of q.
    pub limit: R,
    /// The depth of the visible band in world units.
    pub epsilon: R,
    /// Depth of the nearest fragment of all groups; +inf if the pixel is empty.
    pub nearest: R,
    /// Whether the Voronoi depth test was made.
    pub voronoi: bool,
    /// The groups whose splats reach the pixel, ascending.
    pub groups: Vec<GroupAt<R>>,
}

/// A group at the pixel.
#[derive(Clone, Debug)]
pub struct GroupAt<R> {
    /// The group.
    pub group: usize,
    /// Geometry pass: the splats whose bounds hold the pixel, in ascending surfel index. Each splat
    /// that passes was kept, until the next one that passes.
    pub touches: Vec<Touch<R>>,
    /// Compositing pass: the fragment that the depth-image keeps, if a fragment is inside; it gives
    /// its weight.
    pub kept: Option<Touch<R>>,
}

/// Replays both passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture; [`crate::Error::Invalid`] if there
/// are no groups, or if the Voronoi depth test takes too many bins.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<GroupsReplay<R>> {
    let place = Place::new(job, pixel)?;
    let geometry = Geometry::<R>::project(job, settings)?;
    let (limit, epsilon) = (geometry.shared().limit, geometry.splats.epsilon);
    let images = geometry.images(place.tile, place.rect);
    let composite = composites(&images, 1, epsilon, geometry.shared().empty())[0];
    let nearest = composite.sums.depth;
    let groups = geometry_pass(&geometry, place).into_iter().map(|(group, touches)| {
        let kept = compositing_pass(&touches, &images[group][0], nearest, epsilon);
        GroupAt { group, touches, kept }
    });
    let (groups, voronoi) = (groups.collect(), geometry.voronoi());
    Ok(GroupsReplay { pixel, limit, epsilon, nearest, voronoi, groups })
}

/// Replays the geometry pass: each group that reaches the pixel, and the splats by which it does.
fn geometry_pass<R: Exact>(
    geometry: &Geometry<'_, R>,
    place: Place,
) -> Vec<(usize, Vec<Touch<R>>)> {
    let shared = geometry.shared();
    let mut groups = vec![(geometry.empty(), Vec::new()); geometry.groups()];
    place.splats(&geometry.splats).each_in_bounds(|splat, _, q, w| {
        let (kept, touches) = &mut groups[geometry.group(splat)];
        let mut seen = touch(shared, splat.surfel, q, w);
        seen.decide(|| {
            let before = *kept;
            let (z, passes) = geometry.offer(splat, q, w, kept);
            let words = ["kept", "lost"];
            match geometry.voronoi() {
                true => Decision::new("z", [z, before.z], passes, ["< ", ">="], words),
                false => Decision::nearer(w, before.nearness, words),
            }
        });
        let inside = seen.decisions.len() > 1;
        seen.gives = inside.then_some(("depth", seen.t));
        touches.push(seen);
    });
    let reached = groups.into_iter().map(|(_, touches)| touches).enumerate();
    reached.filter(|(_, touches)| !touches.is_empty()).collect()
}

/// Replays the compositing pass: whether the fragment that an image keeps is visible.
fn compositing_pass<R: Exact>(
    touches: &[Touch<R>],
    image: &ImagePixel<R>,
    nearest: R,
    epsilon: R,
) -> Option<Touch<R>> {
    let kept = touches.iter().find(|touch| touch.surfel == image.surfel)?;
    let decisions = vec![Decision::visible(image.sample.depth, nearest, epsilon)];
    let gives = Some(("weight", image.sample.weight));
    (image.surfel != NO_ID).then(|| Touch { decisions, gives, ..kept.clone() })
}

impl<R: Exact> fmt::Display for GroupsReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        let n = |value: R| value.to_f64();
        let (test, sign) = if self.voronoi { ("z", "<") } else { ("nearness", ">") };
        writeln!(f, "pixel ({x}, {y}): groups whose splats reach it: {}", self.groups.len())?;
        let limit = n(self.limit);
        writeln!(f, "\ngeometry pass: inside if q <= {limit}, kept if {test} {sign} before")?;
        for at in &self.groups {
            writeln!(f, "  group {}", at.group)?;
            for touch in &at.touches {
                writeln!(f, "    {touch}")?;
            }
        }
        if self.groups.iter().all(|at| at.kept.is_none()) {
            return writeln!(f, "\nthe pixel is empty");
        }
        writeln!(
            f,
            "\ncompositing pass: visible if depth <= {} (nearest {} + epsilon {})",
            n(decide::limit(self.nearest, self.epsilon)),
            n(self.nearest),
            n(self.epsilon)
        )?;
        for at in &self.groups {
            if let Some(kept) = &at.kept {
                writeln!(f, "  group {:>2}  {kept}", at.group)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BinCount, DepthTest};
    use super::*;
    use crate::frame::Exec;
    use crate::index::Index;
    use crate::method::Algorithm;
    use crate::method::tests::{count, id, scalar, sphere_of_groups};
    use crate::scene::{Camera, Lens};
    use crate::source::Shape;
    use crate::splat::{Epsilon, SplatSettings};

    #[test]
    fn an_explanation_is_what_the_picture_shows() {
        let (scene, groups) = sphere_of_groups();
        let index = Index { groups: Some(groups), ..Index::default() };
        let lens = Lens::FieldOfView(40.0);
        let camera = Camera::new(19, 17, Shape::Sphere.default_pose(), lens).unwrap();
        let exec = Exec::new(1, 8).unwrap();
        let job = Job::new(&scene, &index, &camera, &exec);
        for depth in [DepthTest::Plain, DepthTest::Voronoi(BinCount::Count(40))] {
            let splats = SplatSettings { epsilon: Epsilon::World(0.0625), ..Default::default() };
            let settings = Settings { splats, depth };
            let frame = settings.define::<f64>(&job, true).unwrap().frame;
            for (x, y) in (0..17).flat_map(|y| (0..19).map(move |x| (x, y))) {
                let found = explain::<f64>(&job, &settings, (x, y)).unwrap();
                assert_eq!(found.nearest, *scalar(&frame, "Z").at(x, y));
                let kept = || found.groups.iter().filter_map(|group| group.kept.as_ref());
                let visible = || kept().filter(|kept| kept.passes());
                let sum = visible().fold(0.0, |sum, kept| sum + kept.gives.unwrap().1);
                assert_eq!(sum, *scalar(&frame, "weight").at(x, y));
                let counted = *count(&frame, "sums.count").at(x, y);
                assert_eq!(visible().count(), usize::from(counted));
                for group in &found.groups {
                    let seen = *id(&frame, &format!("group{:02}.id", group.group)).at(x, y);
                    assert_eq!(group.kept.as_ref().map_or(NO_ID, |kept| kept.surfel), seen);
                    let last = group.touches.iter().rev().find(|touch| touch.passes());
                    assert_eq!(last.map_or(NO_ID, |touch| touch.surfel), seen);
                }
                let text = found.to_string();
                assert_eq!(text.contains("the pixel is empty"), found.nearest.is_infinite());
            }
        }
    }
}
