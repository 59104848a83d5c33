//! Candidates, loaded once for all that share a scene, and drawn by turns.

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::grouping::Grouping;
use crate::io::scene_file::{GroupChoice, MethodChoice, OutputSettings, Ready, SceneFile};
use crate::method::{Method, Session};
use crate::scene::Groups;
use crate::study::sweep::Candidate;
use std::time::{Duration, Instant};

/// Scenes and groups of candidates.
#[derive(Debug)]
pub struct Bench<'e> {
    exec: &'e Exec,
    loads: Vec<Load>,
    groups: Vec<Grouped>,
}

/// A scene that is loaded.
#[derive(Debug)]
struct Load {
    /// What was loaded, and whether as objects.
    key: (SceneFile, bool),
    ready: Ready,
}

impl Load {
    /// Whether no surfel has an opacity.
    fn is_opaque(&self) -> bool {
        let scene = &self.ready.loaded.scene;
        let shared = scene.objects.iter().flat_map(|objects| objects.geometries());
        let all = shared.map(|geometry| &geometry.surfels).chain([&scene.surfels]);
        all.into_iter().all(|surfels| surfels.opacity().is_none())
    }
}

/// Groups of a scene.
#[derive(Debug)]
struct Grouped {
    load: usize,
    grouping: Grouping,
    groups: Groups,
}

/// A method that cannot draw the scene, and why.
pub type LeftOut = (&'static str, String);

/// What is ready to be drawn.
#[derive(Debug)]
pub struct Visit<'a> {
    /// The session of the candidate.
    pub session: Session<'a>,
    /// Where the scene is seen from.
    pub ready: &'a Ready,
    /// How long the session took to prepare, without groups that had been made before.
    pub prepared: Duration,
}

impl<'e> Bench<'e> {
    /// Loads the scenes of candidates; those that their methods cannot draw are left out, and why. Those
    /// that need opacities are dropped where there are none.
    ///
    /// # Errors
    /// As [`SceneFile::ready`] if no candidate can be drawn.
    pub fn load(
        candidates: Vec<Candidate>,
        exec: &'e Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<(Self, Vec<Candidate>, Vec<LeftOut>)> {
        let mut bench = Self { exec, loads: Vec::new(), groups: Vec::new() };
        let (mut kept, mut left_out, mut first) = (Vec::new(), Vec::<LeftOut>::new(), None);
        for candidate in candidates {
            match bench.scene(&candidate, progress) {
                Ok(load) if candidate.needs_opacity && bench.loads[load].is_opaque() => {}
                Ok(_) => kept.push(candidate),
                Err(error @ Error::Invalid(_)) => {
                    let why = (candidate.method, error.to_string());
                    if !left_out.contains(&why) {
                        left_out.push(why);
                    }
                    first.get_or_insert(error);
                }
                Err(error) => return Err(error),
            }
        }
        match first {
            Some(error) if kept.is_empty() => Err(error),
            _ => Ok((bench, kept, left_out)),
        }
    }

    /// The scene of a candidate, of those that are loaded if it is among them.
    fn scene(&mut self, candidate: &Candidate, progress: &dyn Fn(&str, u64, u64)) -> Result<usize> {
        let method = candidate.file.method.method()?;
        let plain = SceneFile {
            method: MethodChoice::default(),
            groups: GroupChoice::default(),
            output: OutputSettings::default(),
            ..candidate.file.clone()
        };
        let objects = method.draws_objects();
        let is_flat = !plain.has_objects();
        let same = |load: &Load| load.key.0 == plain && (is_flat || load.key.1 == objects);
        if let Some(found) = self.loads.iter().position(same) {
            method.check_scene(&self.loads[found].ready.loaded.scene)?;
            return Ok(found);
        }
        let ready = candidate.file.ready(self.exec, progress)?;
        self.loads.push(Load { key: (plain, objects), ready });
        Ok(self.loads.len() - 1)
    }

    /// A session of a candidate that is loaded.
    ///
    /// # Errors
    /// As [`Session::prepare`].
    pub fn visit(
        &mut self,
        candidate: &Candidate,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Visit<'_>> {
        let method = candidate.file.method.method()?;
        let chosen = candidate.file.grouping(&method)?;
        let load = self.scene(candidate, progress)?;
        let start = Instant::now();
        let known = self.known_groups(load, &method, chosen, progress)?.cloned();
        let ready = &self.loads[load].ready;
        let session = Session::with_groups(&ready.loaded.scene, method, known, self.exec)?;
        Ok(Visit { session, ready, prepared: start.elapsed() })
    }

    /// The groups of a method that draws some, made on the first visit.
    fn known_groups(
        &mut self,
        load: usize,
        method: &Method,
        chosen: Option<Grouping>,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Option<&Groups>> {
        let Some(default) = method.grouping() else { return Ok(None) };
        let scene = &self.loads[load].ready.loaded.scene;
        if let (None, Some(groups)) = (chosen, scene.surfels.groups()) {
            return Ok(Some(groups));
        }
        let grouping = chosen.unwrap_or(default);
        let is_it = |known: &Grouped| known.load == load && known.grouping == grouping;
        let found = match self.groups.iter().position(is_it) {
            Some(found) => found,
            None => {
                let (groups, ..) = grouping.groups(&scene.surfels, self.exec, progress)?;
                self.groups.push(Grouped { load, grouping, groups });
                self.groups.len() - 1
            }
        };
        Ok(Some(&self.groups[found].groups))
    }
}
