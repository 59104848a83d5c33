//! A client: a second implementation of the method `ewa`, built as a renderer on a GPU is built.
//!
//! It was written from the pages of the crate, without the crate's code. It shares the types of its
//! input and output with the crate, but no formula. All arithmetic is f32. The passes:
//!
//! 1. [`project`]: surfels to records of splats, once for each picture.
//! 2. [`passes`]: quads on the screen, first into a depth buffer, then added up.
//! 3. [`targets`]: the textures, normalization, and the planes.
//! 4. [`shade`]: deferred shading.
//!
//! [`habit`] lists what a correct client may do differently, and [`bug`] lists the mistakes that a
//! client can make. Formulas are written once, over a [`number`] that rounds by the habit. The
//! client does not support elliptical surfels, environments or the plane `margin`. Opacities play
//! no part in the method.

pub(crate) mod bug;
pub(crate) mod habit;
pub(crate) mod named;
pub(crate) mod number;
pub(crate) mod passes;
pub(crate) mod project;
pub(crate) mod shade;
pub(crate) mod targets;
pub(crate) mod view;

pub(crate) use bug::Bug;
pub(crate) use habit::Habit;

use splatref::splat::SplatSettings;
use splatref::splat::record::SplatRecord;
use splatref::{Camera, Frame, Scene};

/// How a client draws: its lawful habits and at most one bug.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct How {
    pub(crate) habit: Habit,
    pub(crate) bug: Option<Bug>,
}

impl How {
    /// Whether the client makes this mistake.
    fn has(self, bug: Bug) -> bool {
        self.bug == Some(bug)
    }
}

/// The records of the splats that the client draws.
pub(crate) fn records(
    scene: &Scene,
    camera: &Camera,
    settings: &SplatSettings,
    how: How,
) -> Vec<SplatRecord> {
    let shared = view::Shared::new(scene, camera, settings, how);
    project::project(&shared).iter().map(|splat| splat.record(&scene.surfels)).collect()
}

/// What the client draws of a scene: every plane of every stage by the crate's names.
pub(crate) fn render(
    scene: &Scene,
    camera: &Camera,
    settings: &SplatSettings,
    how: How,
) -> Frame<f32> {
    assert!(scene.surfels.tangents().is_none(), "the client draws no ellipses");
    assert!(scene.environment.is_none(), "the client knows no environments");
    let shared = view::Shared::new(scene, camera, settings, how);
    let splats = project::project(&shared);
    let mut targets = targets::Targets::new(&shared);
    passes::visibility(&shared, &splats, &mut targets);
    passes::attributes(&shared, &splats, &mut targets);
    targets.finish(&shared)
}
