//! Verify one pixel of a client: its gathering, averages and shading.

use super::gathering::outcomes;
use super::levels::Level;
use super::planes::PicturePlanes;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::projection::Has;
use crate::method::stage::{Conditions, Keep};
use crate::method::template::Settings;
use crate::method::template::normalization;
use crate::method::template::reconstruction::Gathered;
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real};
use crate::splat::View;
use crate::verdict::checks::{
    Report, Shading, Surface, anything, input, input_where, inputs, least_wrong, number, triple,
    widened,
};
use crate::verdict::client::StoredPlane;
use crate::verdict::marks::Marks;

/// The stages, by their index among the marks.
const RECONSTRUCTION: usize = 0;
const NORMALIZATION: usize = 1;
const SHADING: usize = 2;

/// The parts that all pixels share.
pub(super) struct PixelJudge<'a, P: Profile> {
    settings: &'a Settings,
    levels: Option<Vec<Level<'a, P>>>,
    client_planes: &'a PicturePlanes<'a>,
    view: View<Ball<P>>,
    shading: Shading<'a, P>,
    has: Has,
    there: Conditions,
    /// The greatest component of any colour, at least 1.
    brightest: f64,
}

impl<'a, P: Profile> PixelJudge<'a, P> {
    pub(super) fn new(
        job: &Job<'a>,
        settings: &'a Settings,
        levels: Option<Vec<Level<'a, P>>>,
        client_planes: &'a PicturePlanes<'a>,
    ) -> Self {
        let (scene, has) = (job.scene, Has::in_scene(job.scene));
        let colors = scene.surfels.color().unwrap_or_default();
        let brightest = colors.iter().fold(1.0_f64, |brightest, color| {
            let [r, g, b] = color.to_array().map_inline(f64::from);
            brightest.at_least(r).at_least(g).at_least(b)
        });
        let view = View::new(job.camera);
        let shading = Shading::new(job, has.color).supposing(client_planes.supposed);
        let there = job.there(Keep::Stages);
        Self { settings, levels, client_planes, view, shading, has, there, brightest }
    }

    /// Whether the gathering is replayed.
    pub(super) fn gathers(&self) -> bool {
        self.levels.is_some()
    }

    /// Marks a wrong pixel, by the outcome that errs least. Returns whether the pixel may be
    /// covered.
    pub(super) fn judge(&self, pixel: usize, at: (u32, u32), marks: &mut [Marks; 3]) -> bool {
        let (mut all, mut replayed) = (Vec::new(), false);
        if let Some(levels) = &self.levels {
            let found = outcomes(levels, self.settings, at);
            marks[RECONSTRUCTION].at(pixel).doubts(found.doubts);
            (all, replayed) = (found.all, true);
        }
        let sums = least_wrong::<_, 3>(&all, |sums, report| self.check(at, Some(sums), report));
        self.check(at, sums, &mut |part, error, fault| marks[part].at(pixel).found(error, fault));
        match sums {
            Some(sums) => sums.id != NO_ID,
            None => replayed || self.client_planes.empty(at) != Some(true),
        }
    }

    /// Checks every plane at a pixel, with these sums. Without sums, checks whatever follows from
    /// the client's own.
    fn check(&self, at: (u32, u32), sums: Option<&Gathered<Ball<P>>>, report: &mut Report<'_>) {
        if let Some(sums) = sums {
            self.check_sums(at, sums, report);
        }
        let nothing = Gathered {
            weight: anything(),
            depths: anything(),
            normals: [anything(); 3],
            colors: [anything(); 3],
            ..Gathered::empty()
        };
        // The next stage continues from the client's own numbers.
        let mut own = sums.copied().unwrap_or(nothing);
        self.client_planes.gathered.read(&Gathered::PLANES, &self.there, at, &mut own);
        self.check_averages(at, &own, report);
        self.check_shading(at, &own, report);
    }

    /// Checks the gathered sums.
    fn check_sums(&self, at: (u32, u32), sums: &Gathered<Ball<P>>, report: &mut Report<'_>) {
        let client_planes = self.client_planes;
        // Each addition rounds a sum that is at most this large.
        let most = |ball: Ball<P>| ball.middle.abs() + ball.radius;
        let (heaviest, count) = (most(sums.weight), f64::from(sums.count));
        let lost = |largest: f64| count * client_planes.accumulator.radius(largest);
        let truth = Gathered {
            weight: widened(sums.weight, lost(heaviest)),
            depths: widened(sums.depths, lost(most(sums.depths))),
            normals: sums.normals.map_inline(|part| widened(part, lost(heaviest))),
            colors: sums.colors.map_inline(|part| widened(part, lost(heaviest * self.brightest))),
            ..*sums
        };
        client_planes.gathered.check(RECONSTRUCTION, &Gathered::PLANES, at, &truth, report);
    }

    /// Checks the averages, and the weight again.
    fn check_averages(&self, at: (u32, u32), own: &Gathered<Ball<P>>, report: &mut Report<'_>) {
        let client_planes = self.client_planes;
        if let Some(plane) = &client_planes.depth {
            number(NORMALIZATION, plane, at, normalization::depth(own), report);
        }
        if let Some(plane) = &client_planes.normal {
            let truth = normalization::normal(&self.view, own);
            let truth = client_planes.supposed.in_space(&self.view, truth);
            triple(NORMALIZATION, plane, at, truth, report);
        }
        if let Some(plane) = &client_planes.weight_copy {
            number(NORMALIZATION, plane, at, own.weight, report);
        }
    }

    /// Checks the picture.
    fn check_shading(&self, at: (u32, u32), own: &Gathered<Ball<P>>, report: &mut Report<'_>) {
        let client_planes = self.client_planes;
        // Where nothing was gathered, every format holds a weight of exactly 0.
        let read = |plane: StoredPlane<'_, f64>| input_where(&plane, at, own.count == 0);
        let weight = client_planes.weight_copy.map_or(own.weight, read);
        if let Some(plane) = &client_planes.shaded {
            let depth = || normalization::depth(own);
            let normal = || normalization::normal(&self.view, own);
            let surface = Surface {
                depth: client_planes.depth.map_or_else(depth, |plane| input(&plane, at)),
                normal: client_planes.normal.map_or_else(normal, |plane| inputs(&plane, at)),
                tangent: None,
                color: match self.has.color {
                    true => client_planes.supposed.color(own.colors, weight, Some(own.count)),
                    false => own.colors,
                },
            };
            triple(SHADING, plane, at, self.shading.color(at, &surface), report);
        }
        if let Some(plane) = &client_planes.alpha {
            number(SHADING, plane, at, self.shading.alpha(weight), report);
        }
    }
}
