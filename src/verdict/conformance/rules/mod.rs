//! The table of rules: for each its name, what it tests, which methods have it, what it draws, and
//! what a renderer draws that does not keep it.

mod cameras;
mod gaussians;
mod layers;
mod lights;
mod meshes;
mod settings;
mod surfels;

use super::sketch::Sketch;
use super::{Rule, Varies};
use crate::method::Method;
use crate::setting::Fields;

/// A rule of the table.
pub(super) struct Row {
    pub(super) name: &'static str,
    /// What is tested, in a sentence.
    pub(super) tests: &'static str,
    pub(super) of: Of,
    /// Draws the scene on an empty sketch.
    pub(super) draw: fn(&mut Sketch),
    /// Changes the scene into what a renderer draws that does not keep the rule.
    pub(super) otherwise: fn(&mut Sketch),
}

/// A setting at a value that is not its default.
pub(super) struct SettingRow {
    pub(super) of: Of,
    pub(super) name: &'static str,
    pub(super) value: &'static str,
    /// Draws a scene in which the value shows.
    pub(super) draw: fn(&mut Sketch),
}

impl SettingRow {
    /// Whether a method with these settings can have the value too.
    fn is_possible(&self, method: &Method) -> bool {
        let mut sketch = Sketch::default();
        (self.draw)(&mut sketch);
        sketch.set(self.name, self.value);
        sketch.method(*method).is_ok()
    }
}

/// The methods that have a rule.
#[derive(Clone, Copy)]
pub(super) enum Of {
    All,
    /// Methods that draw splats by a kernel.
    Splats,
    /// Methods that blend layers by their opacity.
    Blending,
    /// Methods that draw every surfel opaque.
    Opaque,
    /// Methods that draw groups.
    Groups,
    Only(&'static [&'static str]),
    But(&'static [&'static str]),
}

impl Of {
    fn has(self, method: &Method) -> bool {
        match self {
            Self::All => true,
            Self::Splats => method.splats().is_some(),
            Self::Blending => method.blends(),
            Self::Opaque => !method.blends(),
            Self::Groups => method.grouping().is_some(),
            Self::Only(names) => names.contains(&method.name()),
            Self::But(names) => !names.contains(&method.name()),
        }
    }
}

/// The rules of a method, the simple ones first and the large scenes last.
pub(super) fn of_method(method: &Method) -> Vec<Rule> {
    let of_surfels = [surfels::ROWS, cameras::ROWS, lights::ROWS, layers::ROWS, meshes::ROWS];
    let tables = if method.draws_gaussians() { &gaussians::TABLES[..] } else { &of_surfels[..] };
    let rule = |row: &'static Row| Rule {
        name: row.name.to_owned(),
        tests: row.tests.to_owned(),
        large: false,
        method: *method,
        draw: row.draw,
        varies: Varies::Otherwise(row.otherwise),
    };
    let own = |row: &&'static Row| row.of.has(method);
    let simple = tables.iter().copied().flatten().filter(own).map(rule);
    // A value may be impossible beside the other settings of a preset.
    let settings = settings::ROWS.iter().filter(|row| row.of.has(method));
    let settings = settings.filter(|row| row.is_possible(method)).map(|row| setting(method, row));
    let large = settings::LARGE.iter().map(|row| Rule { large: true, ..rule(row) });
    simple.chain(settings).chain(large).collect()
}

/// The rule that a setting has a value.
fn setting(method: &Method, row: &'static SettingRow) -> Rule {
    let (mut own, mut help) = (*method, "");
    own.fields(&mut |field| {
        if field.name == row.name {
            help = field.help;
        }
    });
    Rule {
        name: format!("{}-{}", row.name.replace('_', "-"), row.value.replace(',', "-")),
        tests: format!("The setting `{}` is {}: {help}.", row.name, row.value),
        large: false,
        method: *method,
        draw: row.draw,
        varies: Varies::Setting(row.name, row.value),
    }
}
