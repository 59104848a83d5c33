//! Settings as they were chosen; anything not chosen keeps its default.

use super::SceneFile;
use crate::error::{Error, Result};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::io::exr::Compression;
use crate::method::Method;
use crate::method::buffer_formats::Formats;
use crate::setting::{Field, Fields, Refused, Setting, Slot, Value, Visit, Words};

/// Chosen settings, in the order in which they are set. A later value replaces an earlier one, and
/// a preset replaces all its parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    values: Vec<(&'static str, Value)>,
}

impl Choice {
    /// Adds one choice.
    pub fn push(&mut self, name: &'static str, value: Value) {
        self.values.push((name, value));
    }

    /// Adds all choices of `later`.
    pub fn extend(&mut self, later: Self) {
        self.values.extend(later.values);
    }

    /// Whether nothing was chosen.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Whether a setting was chosen.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.values.iter().any(|(chosen, _)| *chosen == name)
    }

    /// The choices that mean something to `settings`.
    #[must_use]
    pub fn fitting(&self, mut settings: impl Fields) -> Self {
        let fits = |(name, value): &&(&'static str, Value)| settings.set(name, value).is_ok();
        Self { values: self.values.iter().filter(fits).cloned().collect() }
    }

    /// Applies all choices to `settings`, which belong to `owner`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a choice is unknown to the settings, means nothing with the others as
    /// they are, or has another type. Ranges are not checked.
    pub fn on<F: Fields>(&self, mut settings: F, owner: &str) -> Result<F> {
        for (name, value) in &self.values {
            settings.set(name, value).map_err(|refused| {
                Error::Invalid(match refused {
                    Refused::Unknown => format!("`{name}` does not apply to {owner}; remove it"),
                    Refused::Idle(why) => format!("`{name}` has no effect {why}; remove it"),
                    Refused::Wrong(what) => what,
                })
            })?;
        }
        Ok(settings)
    }
}

/// The chosen method and settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MethodChoice {
    /// Its name; if absent, the first method of the table.
    pub name: Option<&'static str>,
    /// Its settings.
    pub settings: Choice,
}

impl MethodChoice {
    /// The settings of all methods.
    #[must_use]
    pub fn rows() -> Vec<Setting> {
        Setting::of(Method::all().into_iter().map(|method| (method.name(), method)))
    }

    /// The method: the choices, and defaults for the rest.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Choice::on`], or if a number is out of range.
    pub fn method(&self) -> Result<Method> {
        let default = self.default_method()?;
        let method = self.settings.on(default, &format!("the method {}", default.name()))?;
        method.check()?;
        Ok(method)
    }

    /// Chooses another method. Settings that also mean something to the new method are kept.
    ///
    /// # Errors
    /// [`Error::Usage`] as [`Method::by_name`].
    pub fn replace(&mut self, name: &'static str) -> Result<()> {
        self.settings = self.settings.fitting(Method::by_name(name)?);
        self.name = Some(name);
        Ok(())
    }

    /// The named method with its default settings.
    fn default_method(&self) -> Result<Method> {
        self.name.map_or_else(|| Ok(Method::default()), Method::by_name)
    }
}

/// The chosen settings of groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupChoice {
    /// How groups are made.
    pub settings: Choice,
}

impl GroupChoice {
    /// The default grouping if surfels are only divided: disjoint groups, as many as that takes,
    /// not extended.
    pub const ALONE: Grouping = Grouping {
        rules: Rules { overlap: 1.0, opposite: false, coplanar: None },
        count: None,
        extension: Extension::None,
    };

    /// The settings of groups, with the defaults of every method that draws groups.
    #[must_use]
    pub fn rows() -> Vec<Setting> {
        let default = |method: Method| method.grouping().map(|default| (method.name(), default));
        Setting::of(Method::all().into_iter().filter_map(default))
    }

    /// The grouping: the choices, and `default` for the rest. If a count but no overlap is chosen,
    /// the overlap is 1, its upper end. If an overlap but no count is chosen, there is no count.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Choice::on`], or if a number is out of range.
    pub fn grouping(&self, mut default: Grouping) -> Result<Grouping> {
        match (self.settings.has("overlap"), self.settings.has("count")) {
            (false, true) => default.rules.overlap = 1.0,
            (true, false) => default.count = None,
            _ => {}
        }
        let grouping = self.settings.on(default, "groups")?;
        grouping.check()?;
        Ok(grouping)
    }
}

impl SceneFile {
    /// Chooses a method, settings and groups in place of the file's own. Settings of the file that
    /// also mean something to the new method are kept.
    ///
    /// # Errors
    /// [`Error::Usage`] as [`Method::by_name`], [`MethodChoice::method`] and
    /// [`GroupChoice::grouping`], and if there are settings of groups for a method without groups.
    pub fn choose_method(
        &mut self,
        name: Option<&'static str>,
        settings: &Choice,
        groups: &Choice,
    ) -> Result<()> {
        if let Some(name) = name {
            // The file's settings belong to its own method; `replace` keeps those that fit the new
            // one.
            self.method.replace(name)?;
        }
        self.method.settings.extend(settings.clone());
        let method = self.method.method();
        // Without choices the settings are the file's own, and so is the error.
        let given = name.is_some() || !settings.is_empty();
        let method = if given { usage(method)? } else { method? };
        if name.is_some() {
            // As the settings: what means nothing to the new method is forgotten.
            self.groups.settings = match method.grouping() {
                Some(default) => self.groups.settings.fitting(default),
                None => Choice::default(),
            };
        }
        if !groups.is_empty() && method.grouping().is_none() {
            let what = format!(
                "the method {} has no groups, so --overlap, --groups and their like have no \
                 effect; give another --method",
                method.name()
            );
            return Err(Error::Usage(what));
        }
        self.groups.settings.extend(groups.clone());
        if !groups.is_empty() {
            usage(self.grouping(&method))?;
        }
        Ok(())
    }
}

/// A choice that cannot be is wrong usage; the same in a scene file is not.
fn usage<T>(checked: Result<T>) -> Result<T> {
    checked.map_err(|error| match error {
        Error::Invalid(what) => Error::Usage(what),
        other => other,
    })
}

/// The arithmetic of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Number {
    /// The arithmetic of the executable specification.
    #[default]
    F32,
    /// The arithmetic of the truth; files hold it rounded to `f32`.
    F64,
}

impl Words for Number {
    const WORDS: &'static [(&'static str, Self)] = &[("f32", Self::F32), ("f64", Self::F64)];
}

/// What is stored of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputSettings {
    /// The arithmetic.
    pub number: Number,
    /// How passes store their results.
    pub formats: Formats,
    /// Whether to keep the planes of every stage.
    pub stages: bool,
    /// How the blocks of the EXR are compressed.
    pub compression: Compression,
}

impl Fields for OutputSettings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        each(Field::new("number", "compute in this arithmetic", Slot::Word(&mut self.number)));
        let storage = "store the colours, weights and normals of passes in this buffer format, \
                       rounding after every blend";
        each(Field::new("storage", storage, Slot::Word(&mut self.formats.buffers)));
        let depth = "store the depths of passes in this buffer format";
        each(Field::new("depth_storage", depth, Slot::Word(&mut self.formats.depth)));
        let stages = "keep the planes of every stage";
        each(Field::new("stages", stages, Slot::Switch(&mut self.stages)));
        let compression = "compress the EXR without loss: fast, as most programs do, smallest, or \
                           not at all";
        each(Field::new("compression", compression, Slot::Word(&mut self.compression)));
    }
}

impl OutputSettings {
    /// The settings of the output.
    #[must_use]
    pub fn rows() -> Vec<Setting> {
        Setting::of([("", Self::default())])
    }
}
