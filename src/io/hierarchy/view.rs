//! Load only the part of a hierarchy that a view draws.
//!
//! The index and the [bounds](super::bounds) are enough to
//! [decide](crate::scene::objects::detail::refine) what a camera draws. [`Hierarchy::outlined`]
//! makes objects from them, without reading any other file. Then [`Hierarchy::needed_by`] reads,
//! for each drawn node, as many surfels as the view needs, and the triangles if they are drawn. The
//! files of other nodes may be missing. Memory holds the index, a few hundred bytes for each node
//! in each of its places, and what is drawn.
//!
//! The objects are the same as in [`super::scene`], and a view draws the same from them, bit for
//! bit.
//!
//! `Decided:` a node without surfels, with fewer than 1,000 triangles, is read wherever its weight
//! is greater than 0, whether the camera looks there or not. The reason is that it is drawn there:
//! its triangles have their numbers in the picture.

use super::read::Hierarchy;
use super::scene::{Showing, estimate, name, radius};
use crate::error::Result;
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::Objects;
use crate::scene::objects::outline::{Needed, Outline};

/// How many nodes a thread reads between two reports of progress.
const ROUND: usize = 16;

impl Hierarchy {
    /// All that is in the folder as objects, without reading any node.
    ///
    /// # Errors
    /// As [`Hierarchy::load`]. Without a file of bounds, this reads all files to compute them, one
    /// node at a time.
    pub fn outlined(&self, exec: &Exec, progress: Progress<'_>) -> Result<Objects> {
        let has = self.has();
        self.ask(std::iter::empty())?;
        let bounds = self.bounds(exec, progress)?;
        let numbers = self.numbers();
        let outline = |&number: &u32| {
            let node = &self.nodes()[number as usize];
            let colored = || self.geometries()[node.geometry as usize].kind.colored;
            Outline {
                name: name(number),
                surfels: (node.surfels > 0).then(|| (node.surfels, estimate(node))),
                radius: if node.surfels > 0 { radius(node) } else { 0.0 },
                opacity: numbers.opacity,
                primitives: (node.triangles > 0).then(colored),
                bounds: bounds[number as usize],
            }
        };
        let outlines: Vec<Outline> = has.iter().map(outline).collect();
        let Showing { objects, coarser, .. } = self.showing(&has);
        let all = Objects::outlined(&outlines, objects, self.fill(), self.index.hash)?;
        all.with_coarser(coarser)
    }

    /// The objects of [`Hierarchy::outlined`] as a camera [sees](Objects::seen_from) them, loaded
    /// with what the camera draws. Reads what [is missing](Objects::missing) beside what an earlier
    /// view of these objects read, node by node on all threads. `progress` gets "loading", the number of
    /// nodes read, and their total.
    ///
    /// # Errors
    /// As [`Hierarchy::surfels`] and [`Hierarchy::triangles`]; [`crate::Error::Invalid`] if the
    /// process may not hold what is drawn.
    pub fn needed_by(&self, view: Objects, exec: &Exec, progress: Progress<'_>) -> Result<Objects> {
        let (has, missing) = (self.has(), view.missing());
        let node = |i: usize| &self.nodes()[has[i] as usize];
        self.ask(missing.iter().enumerate().map(|(i, missing)| {
            // A prefix that grows is copied, so all of it is asked for again.
            let surfels = if missing.surfels.is_empty() { 0 } else { missing.surfels.end };
            (node(i), Needed { surfels, primitives: missing.primitives })
        }))?;
        view.with_needed(exec, |jobs| {
            let (total, mut jobs) = (jobs.len(), jobs.into_iter());
            let mut read = Vec::with_capacity(total);
            // In rounds, because one thread reports the progress.
            while read.len() < total {
                progress("loading", read.len() as u64, total as u64);
                let round: Vec<_> = jobs.by_ref().take(ROUND * exec.threads()).collect();
                let round = exec.ordered(round, |(i, missing, held)| {
                    self.read(has[i], missing, held, &Exec::sequential())
                });
                for one in round {
                    read.push(one?);
                }
            }
            Ok(read)
        })
    }
}
