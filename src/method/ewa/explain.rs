//! Every decision at one pixel.
