//! What a study tries: every method, and every setting that trades time for quality.
//!
//! A [`Candidate`] is the scene with some options on top, and is called by these options. The
//! candidates of a scene, in this order, no two alike:
//!
//! 1. each method of the table of methods, with what the scene has set that means something to it, as the
//!    option `--method` has it;
//! 2. each of them at every other [level of detail](DETAILS) that the scene has: points in an order
//!    at other sizes of surfels, shapes of fewer surfels;
//! 3. each method with one setting at another [value](TRADES), setting by setting, and for each
//!    setting method by method.
//!
//! In a scene without opacities a method that [blends](Method::blends) layers is tried as in 1 alone,
//! unless it is the one that is asked for: there are no layers to see.
//!
//! `Decided:` one setting at a time. All combinations would be thousands of pictures, and the study
//! names which setting buys what.

#[cfg(test)]
mod tests;
mod trades;

pub use trades::{DETAILS, Details, NOT_TRADED, Of, TRADES, Trade};

use crate::error::{Error, Result};
use crate::io::scene_file::{Choice, GroupChoice, MethodChoice, OutputSettings, SceneFile, Source};
use crate::method::Method;
use crate::setting::{Fields, Setting};

/// A scene and how it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The options of the command line that make it of the scene, such as
    /// `--method ewa --outline raycast`.
    pub options: String,
    /// The name of the method.
    pub method: &'static str,
    /// The scene with these options.
    pub file: SceneFile,
    /// Whether it is tried in scenes with opacities alone.
    pub needs_opacity: bool,
    /// Whether it imitates [formats](crate::method::buffer_formats) that the scene does not ask for: its errors are those of
    /// a GPU that has them, its times are of no use.
    pub imitates: bool,
}

/// The candidates of a scene; of one method alone if one is `only` asked for.
///
/// Whether a method can draw the scene is known when the scene is loaded.
///
/// # Errors
/// [`Error::Invalid`] if a setting of the scene is out of range or not of its method.
pub fn candidates(scene: &SceneFile, only: Option<&str>) -> Result<Vec<Candidate>> {
    let methods = Method::all().into_iter().map(|method| method.name());
    let methods = methods.filter(|name| only.is_none_or(|only| only == *name));
    let starts = methods.map(|name| start(scene, name)).collect::<Result<Vec<_>>>()?;
    let mut all = starts.clone();
    let blends = |one: &Candidate| Method::by_name(one.method).is_ok_and(|method| method.blends());
    let mark =
        |one: &Candidate| Candidate { needs_opacity: only.is_none() && blends(one), ..one.clone() };
    let starts: Vec<Candidate> = starts.iter().map(mark).collect();
    all.extend(starts.iter().flat_map(details));
    for trade in TRADES {
        for start in &starts {
            for value in trade.values {
                all.extend(traded(start, trade, value)?);
            }
        }
    }
    Ok(all)
}

/// A method in a scene.
fn start(scene: &SceneFile, name: &'static str) -> Result<Candidate> {
    let mut file = scene.clone();
    file.method.replace(name)?;
    let groups = file.method.method()?.grouping();
    file.groups.settings =
        groups.map_or_else(Choice::default, |groups| file.groups.settings.fitting(groups));
    // What else is kept or how is no question of this study.
    file.output = OutputSettings {
        number: scene.output.number,
        formats: scene.output.formats,
        ..OutputSettings::default()
    };
    let options = format!("--method {name}");
    Ok(Candidate { options, method: name, file, needs_opacity: false, imitates: false })
}

/// The same at every other level of detail.
fn details(start: &Candidate) -> Vec<Candidate> {
    let with = |option: String, file: SceneFile| {
        let options = format!("{} {option}", start.options);
        Candidate { options, file, ..start.clone() }
    };
    if start.file.all_models().any(|model| model.progressive) || start.file.hierarchy.is_some() {
        let sizes =
            DETAILS.surfel_sizes.iter().filter(|size| **size != start.file.refinement.surfel_size);
        let sized = sizes.map(|&size| {
            let mut file = start.file.clone();
            file.refinement.surfel_size = size;
            with(format!("--surfel-size {size}"), file)
        });
        return sized.collect();
    }
    let [model] = &start.file.models[..] else { return Vec::new() };
    let Source::Shape { count, .. } = model.source else { return Vec::new() };
    let fewer = DETAILS.parts.iter().map(|part| (count / part, start.file.clone()));
    fewer
        .filter(|(fewer, _)| *fewer > 0)
        .map(|(fewer, mut file)| {
            if let Source::Shape { count, .. } = &mut file.models[0].source {
                *count = fewer;
            }
            with(format!("--count {fewer}"), file)
        })
        .collect()
}

/// The same with another value of a setting; none if it has no such setting, or this value already.
fn traded(start: &Candidate, trade: &Trade, value: &str) -> Result<Option<Candidate>> {
    let mut file = start.file.clone();
    let method = file.method.method()?;
    let rows = match trade.of {
        Of::Method => MethodChoice::rows(),
        Of::Groups => GroupChoice::rows(),
        Of::Output => OutputSettings::rows(),
    };
    let Some(option) = rows.into_iter().find(|row| row.name == trade.setting) else {
        return Ok(None);
    };
    let changed = match trade.of {
        Of::Method => {
            let Some(read) = method.read(trade.setting, value) else { return Ok(None) };
            file.method.settings.push(option.name, read.map_err(Error::Invalid)?);
            file.method.method().is_ok_and(|changed| changed != method)
        }
        Of::Groups => {
            let Some(default) = method.grouping() else { return Ok(None) };
            let before = file.groups.grouping(default)?;
            let Some(read) = GroupChoice::ALONE.read(trade.setting, value) else { return Ok(None) };
            file.groups.settings.push(option.name, read.map_err(Error::Invalid)?);
            file.groups.grouping(default)? != before
        }
        Of::Output => {
            let before = file.output;
            let Some(read) = before.read(trade.setting, value) else { return Ok(None) };
            let read = read.map_err(Error::Invalid)?;
            file.output.set(option.name, &read).is_ok() && file.output != before
        }
    };
    let options = format!("{} {}", start.options, written(&option, value));
    let imitates = file.output.formats != start.file.output.formats;
    Ok(changed.then_some(Candidate { options, file, imitates, ..start.clone() }))
}

fn written(row: &Setting, value: &str) -> String {
    let join = if row.is_switch() { "=" } else { " " };
    format!("--{}{join}{value}", row.option)
}
