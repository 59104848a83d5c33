//! Surfels in the order of a tree, each with its groups as a set.
//!
//! A view from back to front walks the tree, and surfels that are close in the tree are close in
//! space. In the order of their indices, the surfels of a walk are scattered in memory. A copy in
//! the order of the tree is read almost from one end to the other. With its set of groups, a surfel
//! is projected once for all groups that draw it alike.

use super::order::BackToFront;
use crate::error::Result;
use crate::frame::Exec;
use crate::memory;
use crate::scene::{Groups, MAX_GROUPS, Surfels};

/// A set of groups, one bit for each group.
pub(crate) type Set = u64;
const _: () = assert!(MAX_GROUPS <= Set::BITS as usize, "a bit for each group");

/// The surfels in the order of a tree, and their groups.
#[derive(Debug)]
pub struct Members {
    /// The surfels in the order of the tree.
    pub(crate) surfels: Surfels,
    /// Each surfel's own group.
    pub(crate) own: Vec<u8>,
    /// All groups that each surfel is in.
    sets: Vec<Set>,
    /// Groups with the same factor on radii: the factor, and the set of groups.
    alike: Vec<(f32, Set)>,
}

impl Members {
    /// Builds the copy; groups and order must have as many surfels.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if that takes too much memory.
    pub(crate) fn new(
        surfels: &Surfels,
        groups: &Groups,
        order: &BackToFront,
        exec: &Exec,
    ) -> Result<Self> {
        let (count, of_a_set) = (surfels.len() as u64, size_of::<Set>() as u64);
        memory::ask(surfels.bytes_reordered() + (2 * of_a_set + 1) * count, || {
            format!("{count} surfels in the order of a tree")
        })?;
        let mut sets: Vec<Set> = groups.own().iter().map(|&group| 1 << group).collect();
        for &(surfel, group) in groups.added() {
            sets[surfel as usize] |= 1 << group;
        }
        let mut alike: Vec<(f32, Set)> = Vec::new();
        for (group, scale) in groups.scale().iter().enumerate() {
            match alike.iter_mut().find(|(other, _)| other.to_bits() == scale.to_bits()) {
                Some((_, set)) => *set |= 1 << group,
                None => alike.push((*scale, 1 << group)),
            }
        }
        let sets = order.indices().map(|surfel| sets[surfel as usize]).collect();
        let own = order.indices().map(|surfel| groups.own()[surfel as usize]).collect();
        Ok(Self { surfels: surfels.reordered(order.indices(), exec), own, sets, alike })
    }

    /// The most splats that a view can have.
    pub(crate) fn splats(&self) -> usize {
        let mut splats = 0;
        (0..self.sets.len()).for_each(|place| self.each_scale(place, |_, _| splats += 1));
        splats
    }

    /// Whether every group draws its surfels with their own radii.
    pub(crate) fn keep_radii(&self) -> bool {
        self.alike.iter().all(|(scale, _)| *scale == 1.0)
    }

    /// Calls `visit` for each scale at which a surfel, given by its place in the tree, is drawn:
    /// with the scale, and with the groups that draw it at this scale.
    #[inline(always)]
    pub(crate) fn each_scale(&self, place: usize, mut visit: impl FnMut(f32, Set)) {
        for &(scale, alike) in &self.alike {
            let groups = self.sets[place] & alike;
            if groups != 0 {
                visit(scale, groups);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Cloud;
    use glam::Vec3;

    #[test]
    fn groups_of_one_scale_draw_a_surfel_once() {
        let position: Vec<_> = (0..5).map(|i| Vec3::new((i * i) as f32, 0.0, 0.0)).collect();
        let (normal, radius) = (Some(vec![Vec3::Z; 5]), Some(vec![1.0, 2.0, 3.0, 4.0, 5.0]));
        let cloud = Cloud { position, normal, radius, ..Cloud::default() };
        let surfels = Surfels::new(cloud).unwrap().0;
        let (own, added) = (vec![0, 1, 2, 0, 1], vec![(1, 0), (1, 2), (3, 2)]);
        let groups = Groups::new(own, added, vec![1.0, 1.5, 1.0]).unwrap();
        let exec = Exec::sequential();
        let order = BackToFront::new(&surfels, &exec);
        let members = Members::new(&surfels, &groups, &order, &exec).unwrap();
        assert!(!members.keep_radii());
        let expected = [
            vec![(1.0, 0b001)],
            vec![(1.0, 0b101), (1.5, 0b010)],
            vec![(1.0, 0b100)],
            vec![(1.0, 0b101)],
            vec![(1.5, 0b010)],
        ];
        for place in 0..5 {
            let surfel = order.index(place) as usize;
            assert_eq!(members.surfels.radius()[place], surfels.radius()[surfel]);
            let mut found = Vec::new();
            members.each_scale(place, |scale, groups| found.push((scale, groups)));
            assert_eq!(found, expected[surfel], "surfel {surfel}");
        }
        assert_eq!(members.splats(), 6);
    }
}
