//! Find the connected parts of a mesh.

/// The connected parts of vertices; the root of a part is its lowest vertex.
pub(super) struct Parts {
    parent: Vec<u32>,
}

impl Parts {
    /// Every vertex is a part of its own.
    pub(super) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// The root of the part of a vertex; halves the path.
    pub(super) fn find(&mut self, vertex: u32) -> u32 {
        let mut i = vertex as usize;
        while self.parent[i] as usize != i {
            self.parent[i] = self.parent[self.parent[i] as usize];
            i = self.parent[i] as usize;
        }
        i as u32
    }

    /// Joins the parts of two vertices.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        self.parent[high as usize] = low;
    }
}
