//! Verify a client's picture, from its finest level.

use super::levels::Level;
use super::planes::PicturePlanes;
use crate::method::Job;
use crate::method::projection::{Has, SampleKind, world};
use crate::method::pyramid::Cell;
use crate::method::record::Records;
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::splat::View;
use crate::verdict::checks::{Report, Shading, Surface, anything, number, triple, whole};
use crate::verdict::marks::PixelMarks;

/// The parts that all pixels share.
pub(super) struct PixelJudge<'a, P: Profile> {
    /// Level 0 after the push, if it is there.
    cells: Option<&'a Level<'a, P>>,
    client_planes: &'a PicturePlanes<'a>,
    view: View<Ball<P>>,
    shading: Shading<'a, P>,
    has: Has,
}

impl<'a, P: Profile> PixelJudge<'a, P> {
    pub(super) fn new(
        job: &Job<'a>,
        cells: Option<&'a Level<'a, P>>,
        client_planes: &'a PicturePlanes<'a>,
    ) -> Self {
        let has = Has::in_scene(job.scene);
        let shading = Shading::new(job, has.color).supposing(client_planes.supposed);
        Self { cells, client_planes, view: View::new(job.camera), shading, has }
    }

    /// The names of the judged planes. Without the finest level, only the planes of the picture
    /// that follow from others.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let PicturePlanes { shaded, alpha, depth, normal, tangent, kind, .. } = self.client_planes;
        let copies = [
            depth.map(|plane| plane.name),
            normal.map(|plane| plane.name),
            tangent.map(|plane| plane.name),
            kind.map(|plane| plane.name),
        ];
        let copies = copies.into_iter().flatten().filter(|_| self.cells.is_some());
        let own = [shaded.map(|plane| plane.name), alpha.map(|plane| plane.name)];
        own.into_iter().flatten().chain(copies).collect()
    }

    /// Marks a wrong pixel. Returns whether the pixel may be covered.
    pub(super) fn judge(&self, at: (u32, u32), pixel: &mut PixelMarks<'_>) -> bool {
        let cell = self.cells.map(|cells| cells.record(at.0, at.1));
        let cell = cell.as_ref();
        let report: &mut Report<'_> = &mut |_, error, fault| pixel.found(error, fault);
        if let Some(cell) = cell {
            self.check_copies(at, cell, report);
        }
        self.check_picture(at, cell, report);
        let depth = self.client_planes.depth.map(|plane| plane.plane.at(at.0, at.1).is_finite());
        // A client that says nothing about a pixel may have covered it.
        cell.map_or(depth.unwrap_or(true), Cell::is_valid)
    }

    /// Checks the values of a cell that the picture copies.
    fn check_copies(&self, at: (u32, u32), cell: &Cell<Ball<P>>, report: &mut Report<'_>) {
        let client_planes = self.client_planes;
        if let Some(plane) = &client_planes.depth {
            number(0, plane, at, cell.front, report);
        }
        if let Some(plane) = &client_planes.kind {
            whole(0, plane, at, cell.kind as u8, report);
        }
        for (plane, of) in
            [(&client_planes.normal, cell.normal), (&client_planes.tangent, cell.tangent)]
        {
            if let Some(plane) = plane {
                let truth = client_planes.supposed.in_space(&self.view, world(&self.view, of));
                triple(0, plane, at, truth, report);
            }
        }
    }

    /// Checks colour and opacity, from the client's own depth and vectors: as they were before they
    /// were stored, or after, because the same pass leaves them.
    fn check_picture(&self, at: (u32, u32), cell: Option<&Cell<Ball<P>>>, report: &mut Report<'_>) {
        let client_planes = self.client_planes;
        let own = cell.map_or_else(anything, |cell| cell.front);
        let depth = client_planes.depth.map_or(own, |plane| plane.ball(at));
        if let Some(plane) = &client_planes.shaded {
            let normal = || cell.map_or([anything(); 3], |cell| world(&self.view, cell.normal));
            let surface = Surface {
                depth,
                normal: client_planes.normal.map_or_else(normal, |plane| plane.balls(at)),
                tangent: self.tangent(at, cell),
                color: cell.map_or([anything(); 3], |cell| cell.color),
            };
            triple(0, plane, at, self.shading.color(at, &surface), report);
        }
        if let Some(plane) = &client_planes.alpha {
            number(0, plane, at, self.shading.alpha(self.seen(at, depth, cell)), report);
        }
    }

    /// The tangent of a tube in world space. None for a pixel that is shaded as a surface, which
    /// has the null vector.
    fn tangent(&self, at: (u32, u32), cell: Option<&Cell<Ball<P>>>) -> Option<[Ball<P>; 3]> {
        if !self.has.tangent {
            return None;
        }
        let own = || {
            let unknown = [anything(); 3];
            let surface = |cell: &Cell<_>| cell.is_valid() && cell.kind != SampleKind::Tube;
            match cell {
                Some(cell) if surface(cell) => [Ball::ZERO; 3],
                Some(cell) => world(&self.view, cell.tangent),
                None => unknown,
            }
        };
        let tangent = self.client_planes.tangent.map_or_else(own, |plane| plane.balls(at));
        // Other tangents have length 1, however coarsely they are stored.
        let null = |part: &Ball<P>| part.middle == 0.0 && part.radius < 0.5;
        (!tangent.iter().all(null)).then_some(tangent)
    }

    /// More than 0 where something is seen, by the kind, else by the depth.
    fn seen(&self, at: (u32, u32), depth: Ball<P>, cell: Option<&Cell<Ball<P>>>) -> Ball<P> {
        let kind = self.client_planes.kind.map(|plane| *plane.plane.at(at.0, at.1) > 0);
        let known = kind.or(cell.map(Cell::is_valid));
        match known {
            Some(true) => Ball::ONE,
            Some(false) => Ball::ZERO,
            None if !depth.radius.is_finite() => anything(),
            None if depth.middle.is_finite() => Ball::ONE,
            None => Ball::ZERO,
        }
    }
}
