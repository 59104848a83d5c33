//! The surfels of each group in balls, and their fragments from back to front.

use crate::composite::bins::DepthBins;
use crate::composite::decide;
use crate::error::Result;
use crate::frame::Rect;
use crate::index::Item;
use crate::method::Job;
use crate::method::ewa::possible::each_possible;
use crate::method::fragment::each_pixel;
use crate::method::prepare::Prepared;
use crate::method::transparent::Settings;
use crate::method::transparent::blending::appearance;
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Truth};
use crate::shade::phong::Shader;
use crate::splat::{Splat, Tally, View, batch, fragment};
use crate::verdict::single_pass::fragments::bin_ends;

/// A surfel that may be drawn in one of its groups.
#[derive(Clone, Copy)]
struct Drawing<P: Profile> {
    splat: Splat<Ball<P>>,
    /// Whether it certainly is drawn, and with this outline.
    certain: bool,
    group: u8,
    color: [Ball<P>; 3],
    alpha: Ball<P>,
}

/// All surfels that may be drawn in a picture.
pub(super) struct GroupDrawings<P: Profile> {
    prepared: Prepared<Ball<P>, Drawing<P>>,
    /// The depth bins of each group.
    bins: Vec<DepthBins<Ball<P>>>,
}

/// A fragment that may be inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawnFragment<P: Profile> {
    pub(super) surfel: u32,
    /// Whether its surfel certainly is drawn.
    pub(super) certain: bool,
    pub(super) inside: Three,
    pub(super) t: Ball<P>,
    /// The least and the greatest bin.
    pub(super) bins: [f64; 2],
    pub(super) color: [Ball<P>; 3],
    pub(super) alpha: Ball<P>,
}

/// The fragments of a row of pixels, by pixel and group.
pub(crate) struct RowDrawings<P: Profile> {
    groups: usize,
    /// The fragments in the order of their places, and within a place from back to front.
    all: Vec<(usize, DrawnFragment<P>)>,
}

impl<P: Profile> RowDrawings<P> {
    /// The fragments of a group at a pixel. Pixels are counted from the left.
    pub(super) fn at(
        &self,
        column: usize,
        group: usize,
    ) -> impl Iterator<Item = &DrawnFragment<P>> {
        let place = column * self.groups + group;
        let first = self.all.partition_point(|(at, _)| *at < place);
        self.all[first..].iter().take_while(move |(at, _)| *at == place).map(|(_, drawn)| drawn)
    }
}

impl<P: Profile> GroupDrawings<P> {
    /// Orders, projects and shades the surfels.
    pub(super) fn project(job: &Job<'_>, settings: &Settings) -> Result<Self> {
        let (scene, groups) = (job.scene, job.index.groups()?);
        let surfels = &scene.surfels;
        let bins = settings.bins(job, groups.len())?;
        let items = job.index.back_to_front(job.camera)?;
        let shader = Shader::new(View::new(job.camera), &scene.lights, scene.material);
        let picture = job.picture();
        let prepared = Prepared::new(
            job,
            &job.grid(),
            &settings.splats,
            items.len(),
            |projector, range, drawings| {
                for &Item { surfel, group } in &items[range] {
                    let scale = groups.scale()[usize::from(group)];
                    let disc = batch::enlarged(surfels, surfel, scale);
                    each_possible(projector, &disc, surfel, &mut |mut splat, certain| {
                        splat.bounds = splat.bounds.intersection(&picture);
                        if !splat.bounds.is_empty() {
                            let (color, alpha) = appearance(scene, &shader, &splat);
                            drawings.push(Drawing { splat, certain, group, color, alpha });
                        }
                    });
                }
                Tally::default()
            },
            |drawing: &Drawing<P>| drawing.splat.bounds,
        );
        Ok(Self { prepared, bins })
    }

    /// Number of groups.
    pub(super) fn groups(&self) -> usize {
        self.bins.len()
    }

    /// The fragments of a row of pixels in a tile that may be inside.
    pub(super) fn of_row(&self, tile: usize, row: &Rect) -> RowDrawings<P> {
        let (shared, mut all) = (&self.prepared.shared, Vec::new());
        self.prepared.for_each(tile, |drawing| {
            let Drawing { splat, certain, group, color, alpha } = drawing;
            each_pixel(splat, row, |column, at| {
                let (q, w) = fragment(shared, &splat.footprint, at);
                let inside = decide::inside(q, shared.limit);
                if inside.possibly() {
                    let t = shared.depth(w);
                    let drawn = DrawnFragment {
                        surfel: splat.surfel,
                        certain: *certain,
                        inside,
                        t,
                        bins: bin_ends(&self.bins[usize::from(*group)], t),
                        color: *color,
                        alpha: *alpha,
                    };
                    all.push((column * self.groups() + usize::from(*group), drawn));
                }
            });
        });
        // A stable sort keeps the fragments of a place in their order.
        all.sort_by_key(|(place, _)| *place);
        RowDrawings { groups: self.groups(), all }
    }
}
