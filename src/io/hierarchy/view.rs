//! What a view reads of a hierarchy.
//!
//! The index and the [bounds](super::bounds) tell all that [decides](crate::scene::objects::detail::refine) what a camera draws:
//! [`Hierarchy::outlined`] makes objects of them, without a look at any other file. Then [`Hierarchy::needed_by`] reads of
//! the nodes that are drawn the first so many surfels, and their triangles if they are drawn. Other nodes' files may be
//! missing. What is in memory is the index, a few hundred bytes for each node in each of its places, and what is drawn.
//!
//! The objects are those of [`super::scene`], and what is drawn of them is the same, bit for bit.
//!
//! `Decided:` a node without surfels, of fewer than 1,000 triangles, is read wherever its weight is greater than 0, whether
//! the camera looks there or not, since it is drawn there: its triangles have their numbers in the picture.

use super::read::Hierarchy;
use super::scene::{Showing, estimate, name, radius};
use crate::error::Result;
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::Objects;
use crate::scene::objects::outline::Outline;

impl Hierarchy {
    /// All that is in the folder as objects of which nothing is read yet.
    ///
    /// # Errors
    /// As [`Hierarchy::load`]; without a file of bounds all files are read for them, a node at a time.
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

    /// The objects of [`Hierarchy::outlined`] as a camera [sees](Objects::seen_from) them, with what it draws of
    /// them. `progress` is told "loading", how many nodes are read, and of how many.
    ///
    /// # Errors
    /// As [`Hierarchy::surfels`] and [`Hierarchy::triangles`]; [`crate::Error::Invalid`] if the process may not hold what is drawn.
    pub fn needed_by(&self, view: Objects, exec: &Exec, progress: Progress<'_>) -> Result<Objects> {
        let (has, needed) = (self.has(), view.needed());
        let node = |i: usize| &self.nodes()[has[i] as usize];
        self.ask(needed.iter().enumerate().map(|(i, &needed)| (node(i), needed)))?;
        view.with_needed(|i, needed| {
            progress("loading", i as u64, has.len() as u64);
            self.read(has[i], needed, exec)
        })
    }
}
