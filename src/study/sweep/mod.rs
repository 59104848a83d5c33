//! The candidates of a study: every method, and every setting that trades time for quality.
//!
//! A [`Candidate`] is the scene with some options applied; these options are its name. The
//! candidates of a scene, in this order, all different:
//!
//! 1. each method of the table of methods, with those settings of the scene that apply to it, as
//!    with the option `--method`;
//! 2. each of them at every other [level of detail](DETAILS) of the scene: ordered points at other
//!    surfel sizes, shapes with fewer surfels;
//! 3. each method with one setting at another [value](TRADES), setting by setting, and method by
//!    method for each setting.
//!
//! A scene without opacities has no layers to see, so a method that [blends](Method::blends) layers
//! is tried only as in 1, unless it is the requested method.
//!
//! `Decided:` one setting at a time. All combinations would be thousands of pictures, and the study
//! shows what each setting buys.

#[cfg(test)]
mod tests;
mod trades;

pub use trades::{DETAILS, Details, NOT_TRADED, Of, TRADES, Trade};

use crate::error::{Error, Result};
use crate::io::scene_file::{Choice, GroupChoice, MethodChoice, OutputSettings, SceneFile, Source};
use crate::method::Method;
use crate::setting::{Fields, Setting};

/// A scene and the way to draw it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The command-line options that turn the scene into this candidate, such as `--method ewa
    /// --outline raycast`.
    pub options: String,
    /// The name of the method.
    pub method: &'static str,
    /// The scene with these options.
    pub file: SceneFile,
    /// Whether it is tried only in scenes with opacities.
    pub needs_opacity: bool,
    /// Whether it emulates [formats](crate::method::buffer_formats) that the scene does not ask for.
    /// Its errors are those on a GPU with these formats; its times mean nothing.
    pub imitates: bool,
}

/// The candidates of a scene; with `only`, those of one method.
///
/// Whether a method can draw the scene is known only when the scene is loaded.
///
/// # Errors
/// [`Error::Invalid`] if a setting of the scene is out of range, or does not belong to its method.
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
    // A study does not vary what else is stored, or how.
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

/// The same with another value of a setting; `None` if it has no such setting, or has this value
/// already.
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
