//! Where surfels come from that are written as blocks.

use super::index::Kind;
use crate::error::Result;
use crate::frame::Exec;
use crate::io::ply::Stream;
use crate::scene::Surfels;
use glam::DVec3;

/// Surfels, in parts, as often as needed.
pub(in crate::io) enum Input {
    /// They are read from a file.
    Stream(Stream),
    /// They are in memory, with the offset of their positions.
    Loaded(Surfels, DVec3),
}

/// How many surfels of those in memory are handed out at once.
const PART: usize = 1 << 14;

impl Input {
    /// How many surfels there are at most: as many as the file has points.
    pub(super) fn most(&self) -> u64 {
        match self {
            Self::Stream(stream) => stream.count(),
            Self::Loaded(surfels, _) => surfels.len() as u64,
        }
    }

    /// Which attributes they have.
    pub(super) fn kind(&self) -> Kind {
        let [color, opacity, tangents] = match self {
            Self::Stream(stream) => stream.has(),
            Self::Loaded(all, _) => {
                [all.color().is_some(), all.opacity().is_some(), all.tangents().is_some()]
            }
        };
        Kind { color, opacity, tangents }
    }

    /// What was subtracted from their positions.
    pub(super) fn offset(&self) -> DVec3 {
        match self {
            Self::Stream(stream) => stream.offset(),
            Self::Loaded(_, offset) => *offset,
        }
    }

    /// Calls `visit` with parts, in the order of the scene. A part may be empty.
    ///
    /// # Errors
    /// As [`Stream::each`].
    pub(super) fn each(
        &mut self,
        exec: &Exec,
        visit: &mut dyn FnMut(Surfels) -> Result<()>,
    ) -> Result<()> {
        let all = match self {
            Self::Stream(stream) => return stream.each(exec, visit),
            Self::Loaded(all, _) => all,
        };
        (0..all.len()).step_by(PART).try_for_each(|first| {
            let part: Vec<u64> = (first..all.len().min(first + PART)).map(|i| i as u64).collect();
            visit(all.some(&part, exec))
        })
    }
}
