//! What an oracle is tried on.

use crate::oracle::kit::draw::Drawing;
use splatref::method::Method;
use splatref::scene::{Camera, Groups, Scene};

/// A scene, a camera and settings; and the groups, for methods that draw groups.
pub(crate) struct Case<S> {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) camera: Camera,
    pub(crate) settings: S,
    pub(crate) groups: Option<Groups>,
    /// Whether normals have length 1 and tangents are perpendicular to them exactly, in view space
    /// too. Otherwise they are off by the rounding of the input, which f64 sees.
    pub(crate) exact: bool,
}

impl<S> std::fmt::Debug for Case<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at {}x{}", self.name, self.camera.width, self.camera.height)
    }
}

impl<S> Case<S> {
    /// The same scene under other settings.
    pub(crate) fn with<T>(self, settings: T) -> Case<T> {
        let Self { name, scene, camera, groups, exact, .. } = self;
        Case { name, scene, camera, settings, groups, exact }
    }

    pub(crate) fn groups(&self) -> &Groups {
        self.groups.as_ref().expect("a case with groups")
    }

    /// The pixels: index, column, row.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = (usize, u32, u32)> + use<S> {
        let width = self.camera.width;
        (0..width * self.camera.height).map(move |i| (i as usize, i % width, i / width))
    }
}

impl<S: Copy + Into<Method>> Case<S> {
    pub(crate) fn drawing(&self) -> Drawing<'_> {
        let drawing = Drawing::new(&self.scene, &self.camera, self.settings);
        self.groups.as_ref().map_or(drawing, |groups| drawing.grouped(groups))
    }
}
