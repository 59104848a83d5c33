//! Every decision at one pixel, with its operands.

use super::Settings;
use super::plain::{Geometry, Kept};
use crate::composite::epsilon;
use crate::error::Result;
use crate::frame::{Exec, NO_ID};
use crate::method::ewa::plain::fragment;
use crate::number::Exact;
use crate::scene::Groups;
use crate::scene::{Camera, Surfels};
use std::fmt;

/// What happened at one pixel.
#[derive(Clone, Debug)]
pub struct Explanation<R> {
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
    /// The groups that splats reach the pixel from, ascending.
    pub groups: Vec<GroupAt<R>>,
}

/// A group at the pixel.
#[derive(Clone, Debug)]
pub struct GroupAt<R> {
    /// The group.
    pub group: u8,
    /// The splats whose bounds hold the pixel, in ascending surfel index.
    pub touches: Vec<Touch<R>>,
    /// What its depth-image keeps; `surfel` is [`NO_ID`] if none is inside.
    pub kept: Kept<R>,
    /// Depth of what is kept; +inf if nothing is.
    pub t: R,
    /// Whether that passes the epsilon-z test.
    pub visible: bool,
}

/// One splat at the pixel.
#[derive(Clone, Copy, Debug)]
pub struct Touch<R> {
    /// The surfel.
    pub surfel: u32,
    /// Its q, compared with k^2.
    pub q: R,
    /// Depth of the fragment.
    pub t: R,
    /// What its depth test compares, if it is inside: its own value and that of what was kept
    /// before.
    pub test: Option<[R; 2]>,
    /// Whether it was kept.
    pub kept: bool,
}

/// Replays both passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture; [`crate::Error::Invalid`] as
/// [`super::render`].
pub fn explain<R: Exact>(
    surfels: &Surfels,
    groups: &Groups,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    (x, y): (u32, u32),
) -> Result<Explanation<R>> {
    camera.check_pixel(x, y)?;
    groups.check(surfels)?;
    let geometry = Geometry::<R>::project(surfels, groups, camera, settings, exec)?;
    let (shared, grid) = (geometry.shared(), geometry.grid());
    let tile = (y / grid.tile * grid.columns + x / grid.tile) as usize;

    // Geometry pass.
    let mut found: Vec<GroupAt<R>> = Vec::new();
    geometry.each_splat(tile, |splat| {
        if !splat.bounds.contains(x, y) {
            return;
        }
        let group = groups.own()[splat.surfel as usize];
        let at = found.partition_point(|other| other.group < group);
        if found.get(at).is_none_or(|other| other.group != group) {
            let kept = geometry.empty();
            let (touches, t) = (Vec::new(), R::INFINITY);
            found.insert(at, GroupAt { group, touches, kept, t, visible: false });
        }
        let state = &mut found[at];
        let (q, nearness) = fragment(shared, splat, x, y);
        let (before, mut test) = (state.kept, None);
        if q <= shared.limit {
            let z = geometry.offer(splat, q, nearness, &mut state.kept);
            test = Some(match geometry.voronoi() {
                true => [z, before.z],
                false => [nearness, before.nearness],
            });
        }
        let kept = state.kept.surfel == splat.surfel;
        let t = shared.depth(nearness);
        state.touches.push(Touch { surfel: splat.surfel, q, t, test, kept });
    });

    // Compositing pass.
    let mut nearest = R::INFINITY;
    for state in &mut found {
        state.t = shared.depth(state.kept.nearness);
        nearest = nearest.at_most(state.t);
    }
    let band = geometry.epsilon();
    for state in &mut found {
        state.visible = state.kept.surfel != NO_ID && epsilon::visible(state.t, nearest, band);
    }
    let (limit, voronoi) = (shared.limit, geometry.voronoi());
    Ok(Explanation { pixel: (x, y), limit, epsilon: band, nearest, voronoi, groups: found })
}

impl<R: Exact> fmt::Display for Explanation<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        let n = |value: R| value.to_f64();
        let (test, sign) = if self.voronoi { ("z", "<") } else { ("nearness", ">") };
        writeln!(f, "pixel ({x}, {y}): groups whose splats reach it: {}", self.groups.len())?;
        writeln!(
            f,
            "\ngeometry pass: inside if q <= {}, kept if {test} {sign} before",
            n(self.limit)
        )?;
        for state in &self.groups {
            writeln!(f, "  group {}", state.group)?;
            for touch in &state.touches {
                let margin = touch.q.ulps_to(self.limit);
                let (word, is) =
                    if touch.test.is_some() { ("inside ", "<=") } else { ("outside", "> ") };
                write!(
                    f,
                    "    surfel {:>8}  {word}  q {:<12.9} {is} {}",
                    touch.surfel,
                    n(touch.q),
                    n(self.limit)
                )?;
                write!(f, "  (margin {margin} ulp)")?;
                if let Some([own, before]) = touch.test {
                    let word = if touch.kept { "kept" } else { "lost" };
                    write!(f, "   {word}  {test} {:.9} against {:.9}", n(own), n(before))?;
                    write!(f, "  (margin {} ulp)  depth {}", own.ulps_to(before), n(touch.t))?;
                }
                writeln!(f)?;
            }
        }
        if self.groups.iter().all(|state| state.kept.surfel == NO_ID) {
            return writeln!(f, "\nthe pixel is empty");
        }
        let limit = epsilon::limit(self.nearest, self.epsilon);
        writeln!(
            f,
            "\ncompositing pass: visible if depth <= {} (nearest {} + epsilon {})",
            n(limit),
            n(self.nearest),
            n(self.epsilon)
        )?;
        for state in self.groups.iter().filter(|state| state.kept.surfel != NO_ID) {
            let (word, is) = if state.visible { ("visible", "<=") } else { ("hidden ", "> ") };
            let Kept { surfel, weight, .. } = state.kept;
            write!(f, "  group {:>2}  surfel {surfel:>8}  {word}", state.group)?;
            write!(f, "  depth {} {is} {}", n(state.t), n(limit))?;
            writeln!(f, "  (margin {} ulp)  weight {}", state.t.ulps_to(limit), n(weight))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BinCount, DepthTest, render};
    use super::*;
    use crate::frame::Samples;
    use crate::method::ewa::{self, Epsilon};
    use crate::scene::{Lens, Light, Phong, Scene};
    use crate::source::Shape;

    #[test]
    fn an_explanation_is_what_the_picture_shows() {
        let shape = Shape::Sphere;
        let surfels = shape.surfels(150, 3).unwrap();
        let own = (0..surfels.len()).map(|i| (i % 3) as u8).collect();
        let groups = Groups::new(own, Vec::new(), vec![1.0; 3]).unwrap();
        let (lights, material) = (vec![Light::DEFAULT], Phong::default());
        let scene = Scene {
            name: "sphere".into(),
            surfels,
            lights,
            material,
            primitives: Default::default(),
            environment: None,
        };
        let camera = Camera::new(19, 17, shape.default_pose(), Lens::FieldOfView(40.0)).unwrap();
        let exec = Exec::new(1, 8).unwrap();
        for depth in [DepthTest::Plain, DepthTest::Voronoi(BinCount::Count(40))] {
            let splats = ewa::Settings { epsilon: Epsilon::World(0.0625), ..Default::default() };
            let settings = Settings { splats, depth };
            let picture = render::<f64>(&scene, &groups, &camera, &settings, &exec, true).unwrap();
            let scalar = |name: &str, x: u32, y: u32| match picture.frame.plane(name) {
                Some(Samples::Scalar(plane)) => *plane.at(x, y),
                other => panic!("{name}: {other:?}"),
            };
            for (x, y) in (0..17).flat_map(|y| (0..19).map(move |x| (x, y))) {
                let found =
                    explain::<f64>(&scene.surfels, &groups, &camera, &settings, &exec, (x, y))
                        .unwrap();
                assert_eq!(found.nearest, scalar("Z", x, y));
                let visible = || found.groups.iter().filter(|group| group.visible);
                let sum = visible().fold(0.0, |sum, group| sum + group.kept.weight);
                assert_eq!(sum, scalar("weight", x, y));
                let Some(Samples::Count(counts)) = picture.frame.plane("sums.count") else {
                    panic!("no counts");
                };
                assert_eq!(visible().count(), usize::from(*counts.at(x, y)));
                for group in &found.groups {
                    let Some(Samples::Index(ids)) =
                        picture.frame.plane(&format!("group{:02}.id", group.group))
                    else {
                        panic!("no image of group {}", group.group);
                    };
                    assert_eq!(group.kept.surfel, *ids.at(x, y));
                    let last = group.touches.iter().rev().find(|touch| touch.kept);
                    assert_eq!(last.map_or(NO_ID, |touch| touch.surfel), group.kept.surfel);
                }
                let text = found.to_string();
                assert_eq!(text.contains("the pixel is empty"), found.nearest.is_infinite());
            }
        }
    }

    #[test]
    fn a_pixel_outside_is_wrong_usage() {
        let surfels = Shape::Sphere.surfels(20, 0).unwrap();
        let groups = Groups::new(vec![0; surfels.len()], Vec::new(), vec![1.0]).unwrap();
        let pose = Shape::Sphere.default_pose();
        let camera = Camera::new(8, 8, pose, Lens::FieldOfView(40.0)).unwrap();
        let exec = Exec::sequential();
        let settings = Settings::default();
        let error = explain::<f32>(&surfels, &groups, &camera, &settings, &exec, (8, 0));
        assert_eq!(error.unwrap_err().exit_code(), 2);
    }
}
