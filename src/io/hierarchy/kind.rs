//! What the vertices of a geometry have, as its file says it.

use crate::scene::Vertices;

/// Bytes in the file: a vertex's position and normal, its colour, any other number.
const VERTEX: u64 = 24;
const COLOR: u64 = 12;
const NUMBER: u64 = 4;

/// Which attributes vertices of a geometry have beside positions and normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kind {
    /// Colours.
    pub colored: bool,
    /// Opacities.
    pub veiled: bool,
    /// Number of further properties.
    pub properties: u32,
}

impl Kind {
    pub(super) fn from_vertices(vertices: &Vertices) -> Self {
        let (colored, veiled) = (vertices.color.is_some(), vertices.opacity.is_some());
        Self { colored, veiled, properties: vertices.properties.len() as u32 }
    }

    pub(super) fn word(self) -> u32 {
        u32::from(self.colored) + 2 * u32::from(self.veiled) + 4 * self.properties
    }

    pub(super) fn of_word(word: u32) -> Self {
        Self { colored: word & 1 == 1, veiled: word & 2 == 2, properties: word / 4 }
    }

    /// The bytes of a vertex.
    pub(super) fn vertex(self) -> u64 {
        let numbers = u64::from(self.veiled) + u64::from(self.properties);
        VERTEX + COLOR * u64::from(self.colored) + NUMBER * numbers
    }
}
