//! What a right client of this method may do otherwise, beside the habits of numbers.

use crate::verify::client::named::named;

named! {
    /// How the passes are built.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub(crate) enum Manner {
        /// As the page says.
        #[default]
        Plain,
        /// The sums are of 64 bits, and rounded once (a page of the crate knows no more exact ones).
        DoubleSums,
        /// One shader makes both passes: no image is stored, so that a product of weight and
        /// attribute may go into the sum without a rounding of its own.
        OneShader,
        /// Splats come in a pseudo-random order, and the first of those that tie stays.
        AnyOrder,
        /// The depth test compares depths, as a depth buffer that stores t does: 1/t rounds, so that
        /// two of different nearness may tie.
        DepthBufferOfDepth,
        /// The number of bins over the range of depth is one factor, which the host computes.
        BinsByFactor,
        /// sqrt(q) / k in place of sqrt(q / (k k)).
        RatioOfRoots,
    }
}
