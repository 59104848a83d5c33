//! The table of methods: one row a method. Everything that the program says about a method follows
//! from its row.

use super::algorithm::{Algorithm, Job};
use super::input_planes::InputPlanes;
use super::{
    Picture, Stage, blue, deferred, ewa, gaussians, peeling, pyramid, single_pass, template,
    transparent, transparent_hq,
};
use crate::error::{Error, Result};
use crate::frame::{Frame, Pool};
use crate::index::grouping::Grouping;
use crate::number::Exact;
use crate::scene::{Camera, Objects, Primitives, Scene};
use crate::setting::{Fields, Visit};
use crate::splat::SplatSettings;

/// Makes the enum of methods, and forwards every question to the settings of the method.
macro_rules! methods {
    ($($(#[$doc:meta])* $method:ident($settings:ty),)*) => {
        /// A method and what it computes.
        ///
        /// ```
        /// use splatref::method::{Method, ewa};
        ///
        /// for method in Method::all() {
        ///     println!("{}: {}", method.name(), method.summary());
        /// }
        /// // Settings that you do not name have their defaults.
        /// let method = Method::from(ewa::Settings { cull: false, ..Default::default() });
        /// method.check()?;
        /// assert_ne!(method, Method::by_name("ewa")?);
        /// # Ok::<(), splatref::Error>(())
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Method {
            $($(#[$doc])* $method($settings),)*
        }

        /// The memory that the fast path of a method works in.
        #[derive(Debug)]
        pub(crate) enum Memory {
            $($method(<$settings as Algorithm>::Memory),)*
        }

        $(impl From<$settings> for Method {
            fn from(settings: $settings) -> Self {
                Self::$method(settings)
            }
        })*

        impl Fields for Method {
            fn fields(&mut self, each: &mut Visit<'_>) {
                match self { $(Self::$method(settings) => settings.fields(each),)* }
            }
        }

        impl Method {
            /// Every method, with its default settings, in the order of the table.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$method(<$settings>::default()),)*]
            }

            /// The name in scene files and on the command line.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$method(_) => <$settings>::NAME,)* }
            }

            /// A one-line summary of the method, with its source.
            #[must_use]
            pub fn summary(&self) -> &'static str {
                match self { $(Self::$method(_) => <$settings>::SUMMARY,)* }
            }

            /// The passes, in the order in which they run.
            #[must_use]
            pub fn stages(&self) -> &'static [Stage] {
                match self { $(Self::$method(_) => <$settings>::STAGES,)* }
            }

            /// Whether the method draws triangles, ribbons and tubes beside surfels.
            #[must_use]
            pub fn draws_primitives(&self) -> bool {
                match self { $(Self::$method(_) => <$settings>::DRAWS_PRIMITIVES,)* }
            }

            /// Whether the method draws triangles beside surfels, with other primitives or without.
            #[must_use]
            pub fn draws_polygons(&self) -> bool {
                let alone = match self { $(Self::$method(_) => <$settings>::DRAWS_POLYGONS,)* };
                alone || self.draws_primitives()
            }

            /// Whether the method draws a scene of 3D Gaussians.
            #[must_use]
            pub fn draws_gaussians(&self) -> bool {
                match self { $(Self::$method(_) => <$settings>::DRAWS_GAUSSIANS,)* }
            }

            /// Whether the method draws the objects of a scene as they are; else the scene must be
            /// made flat.
            #[must_use]
            pub fn draws_objects(&self) -> bool {
                match self { $(Self::$method(_) => <$settings>::DRAWS_OBJECTS,)* }
            }

            /// How the method groups surfels by default; none: the method draws no groups.
            #[must_use]
            pub fn grouping(&self) -> Option<Grouping> {
                match self { $(Self::$method(_) => <$settings>::GROUPING,)* }
            }

            /// Whether the method blends layers of surfels with opacities; else a surfel is opaque.
            #[must_use]
            pub fn blends(&self) -> bool {
                match self { $(Self::$method(_) => <$settings>::BLENDS,)* }
            }

            /// Whether the method needs the surfels from back to front.
            #[must_use]
            pub fn needs_order(&self) -> bool {
                match self { $(Self::$method(_) => <$settings>::BACK_TO_FRONT,)* }
            }

            /// Why the method cannot draw a part of a picture alone, with the bits of the whole; none:
            /// it can. [`super::Session::set_region`] refuses such a method, unless it
            /// [projects regions](Self::projects_regions).
            #[must_use]
            pub fn needs_whole_picture(&self) -> Option<&'static str> {
                match self { $(Self::$method(_) => <$settings>::NEEDS_WHOLE_PICTURE,)* }
            }

            /// Whether a region of the picture has the planes of the [projection](super::projection)
            /// alone, from which [`super::Session::finish`] goes on once they are joined.
            #[must_use]
            pub fn projects_regions(&self) -> bool {
                match self { $(Self::$method(_) => <$settings>::PROJECTS_REGIONS,)* }
            }

            pub(crate) fn fast_bytes_a_pixel(&self) -> Option<u64> {
                match self { $(Self::$method(_) => <$settings>::FAST_BYTES_A_PIXEL,)* }
            }

            /// Footprints, epsilon and culling, if the method draws splats.
            #[must_use]
            pub fn splats(&self) -> Option<&SplatSettings> {
                match self { $(Self::$method(settings) => Algorithm::splats(settings),)* }
            }

            /// Checks that the numbers are in range.
            ///
            /// # Errors
            /// [`Error::Invalid`] if a number is not.
            pub fn check(&self) -> Result<()> {
                match self { $(Self::$method(settings) => settings.check(),)* }
            }

            /// What the settings resolve to in a scene: names and values as TOML.
            #[must_use]
            pub fn settings_in_scene(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
                match self { $(Self::$method(settings) => Algorithm::settings_in_scene(settings, scene, camera),)* }
            }

            pub(crate) fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
                match self { $(Self::$method(settings) => settings.define(job, stages),)* }
            }

            pub(crate) fn stage<R: Exact>(
                &self,
                job: &Job<'_>,
                stage: &str,
                from: &Frame<R>,
            ) -> Result<Frame<R>> {
                let given = InputPlanes::new(from, job)?;
                let planes = match self {
                    $(Self::$method(settings) => settings.stage(job, stage, &given),)*
                };
                Ok(job.frame(planes?))
            }

            pub(crate) fn finish(
                &self,
                job: &Job<'_>,
                from: &Frame<f32>,
                stages: bool,
            ) -> Result<Picture<f32>> {
                let given = InputPlanes::new(from, job)?;
                match self { $(Self::$method(settings) => settings.finish(job, &given, stages),)* }
            }

            pub(crate) fn levels(&self, job: &Job<'_>, stage: &str) -> Vec<usize> {
                match self { $(Self::$method(settings) => settings.levels(job, stage),)* }
            }

            pub(crate) fn explain<R: Exact>(&self, job: &Job<'_>, at: (u32, u32)) -> Result<String> {
                match self {
                    $(Self::$method(settings) => {
                        Ok(settings.explain::<R>(job, at)?.to_string())
                    })*
                }
            }

            pub(crate) fn weights(&self, job: &Job<'_>, at: (u32, u32)) -> Result<Vec<(u32, f64)>> {
                match self { $(Self::$method(settings) => settings.weights(job, at),)* }
            }

            pub(crate) fn memory(&self) -> Memory {
                match self { $(Self::$method(_) => Memory::$method(Default::default()),)* }
            }

            pub(crate) fn draw(
                &self,
                job: &Job<'_>,
                memory: &mut Memory,
                pool: &mut Pool,
            ) -> Result<Picture<f32>> {
                match (self, memory) {
                    $((Self::$method(settings), Memory::$method(memory)) => {
                        settings.draw(job, memory, pool)
                    })*
                    // A session makes its memory for its method.
                    _ => self.define(job, false),
                }
            }
        }
    };
}

methods! {
    /// EWA splatting in 2+1 passes.
    Ewa(ewa::Settings),
    /// Deferred splatting \[GBP04\].
    Deferred(deferred::Settings),
    /// Algorithm 1 of \[ZP06\].
    SinglePass(single_pass::Settings),
    /// Algorithm 2 of \[ZP06\].
    Transparent(transparent::Settings),
    /// Algorithm 3 of \[ZP06\].
    TransparentHq(transparent_hq::Settings),
    /// Depth peeling.
    Peeling(peeling::Settings),
    /// Pull-push interpolation \[MKC08\].
    Pyramid(pyramid::Settings),
    /// Reconstruction with templates \[MOC08\].
    Template(template::Settings),
    /// Oriented discs in squares \[BJFM19\].
    Blue(blue::Settings),
    /// 3D Gaussian splats.
    Gaussians(gaussians::Settings),
}

impl Default for Method {
    /// The first row of the table.
    fn default() -> Self {
        Self::Ewa(ewa::Settings::default())
    }
}

impl Method {
    /// The method with this name, with its default settings.
    ///
    /// # Errors
    /// [`Error::Usage`] with the existing names.
    pub fn by_name(name: &str) -> Result<Self> {
        Self::all().into_iter().find(|method| method.name() == name).ok_or_else(|| {
            let names: Vec<_> = Self::all().iter().map(Self::name).collect();
            Error::Usage(format!("method `{name}`; give one of {}", names.join(", ")))
        })
    }

    /// How far the splats of the method reach beyond what [`Nearby::holds_any`] takes for their surfels,
    /// in pixels. `None` if a pixel may depend on surfels elsewhere: on the groups of all surfels, for
    /// instance.
    ///
    /// [`Nearby::holds_any`]: super::part::Nearby::holds_any
    pub(crate) fn skirt(&self) -> Option<f64> {
        match self {
            Self::Ewa(_) | Self::Peeling(_) => {
                let kernel = self.splats()?.kernel;
                Some(f64::from(kernel.cutoff) * f64::from(kernel.low_pass).sqrt())
            }
            // A square is at least a pixel wide.
            Self::Blue(_) => Some(0.5),
            _ => None,
        }
    }

    /// Checks that [`super::Session::set_region`] can limit the method to a part of a picture.
    ///
    /// # Errors
    /// As [`Method::check_alone`], unless the method [projects regions](Self::projects_regions).
    pub fn check_region(&self) -> Result<()> {
        if self.projects_regions() { Ok(()) } else { self.check_alone() }
    }

    /// Checks that the method can draw the pixels of a part of a picture alone.
    ///
    /// # Errors
    /// [`Error::Usage`] with the reason why it cannot.
    pub fn check_alone(&self) -> Result<()> {
        let Some(why) = self.needs_whole_picture() else { return Ok(()) };
        let able = Self::all().into_iter().filter(|method| method.needs_whole_picture().is_none());
        let able: Vec<_> = able.map(|method| method.name()).collect();
        Err(Error::Usage(format!(
            "the method {} cannot draw a region alone, because {why}; draw the whole picture, or choose \
             one of {}",
            self.name(),
            able.join(", ")
        )))
    }

    /// Checks that the method can draw everything in a scene.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has Gaussians or a surface and the method does not draw them, if the
    /// scene has primitives and the method draws surfels alone, or if the
    /// scene consists of objects, has not been made flat, and the method does not draw objects.
    pub fn check_scene(&self, scene: &Scene) -> Result<()> {
        if scene.gaussians.is_some() && !self.draws_gaussians() {
            return Err(Error::Invalid(format!(
                "{} has 3D Gaussians, but the method {} draws surfels; use --method gaussians",
                scene.name,
                self.name()
            )));
        }
        if scene.surface.is_some() && !self.draws_gaussians() {
            return Err(Error::Invalid(format!(
                "a surface is mixed with splats, but the method {} draws none; remove the surface, or use \
                 --method gaussians",
                self.name()
            )));
        }
        let flat = !scene.surfels.is_empty() || !scene.primitives.is_empty();
        // Objects of which this view draws nothing are flat too.
        let seen = |objects: &Objects| {
            let primitives = |all: Vec<Primitives>| all.iter().any(|one| !one.is_empty());
            objects.drawn_total() > 0 || objects.primitives().is_ok_and(primitives)
        };
        let seen = scene.objects.as_ref().is_some_and(seen);
        if seen && !flat && !self.draws_objects() {
            return Err(Error::Invalid(format!(
                "{} has objects, but the method {} does not draw them; flatten the scene first",
                scene.name,
                self.name()
            )));
        }
        // The primitives of objects count too, because a method that draws objects never makes the
        // scene flat.
        let objects = scene.objects.iter().flat_map(|objects| {
            objects.objects().iter().map(|object| &objects.geometries()[object.geometry].primitives)
        });
        let all = || objects.clone().chain([&scene.primitives]);
        let lines = all().any(|one| !one.ribbons.is_empty() || !one.tubes.is_empty());
        // Primitives of a geometry that was not loaded cannot be looked at, only counted.
        let unread = scene.objects.as_ref().is_some_and(Objects::have_primitives);
        let nothing = all().all(Primitives::is_empty) && !unread;
        let draws = |method: &Self| match (lines, nothing) {
            (true, _) => method.draws_primitives(),
            (false, nothing) => nothing || method.draws_polygons(),
        };
        if draws(self) {
            return Ok(());
        }
        let able = Self::all().into_iter().filter(draws);
        let able: Vec<_> = able.map(|method| format!("--method {}", method.name())).collect();
        Err(Error::Invalid(format!(
            "{} has triangles or lines, but the method {} does not draw them; use {}",
            scene.name,
            self.name(),
            able.join(" or ")
        )))
    }
}
