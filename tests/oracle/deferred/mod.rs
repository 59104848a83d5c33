//! Oracle for deferred splatting.

mod cases;
mod ids;
mod known;
mod laws;
mod levels;
mod model;
mod place;
mod replay;
mod schemes;
mod stages;
mod tolerance;
mod view;
mod walls;
