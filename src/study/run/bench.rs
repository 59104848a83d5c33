//! Loads candidates, once for all that share a scene, and draws them by turns.

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::grouping::Grouping;
use crate::io::scene_file::{GroupChoice, Loaded, MethodChoice, OutputSettings, Ready, SceneFile};
use crate::method::{Method, Session};
use crate::progress::Progress;
use crate::scene::Groups;
use crate::scene::objects::detail::refine::Refinement;
use crate::study::sweep::Candidate;
use std::time::{Duration, Instant};

/// The scenes and groups of the candidates.
#[derive(Debug)]
pub struct Bench {
    /// Scenes of objects as they were read; candidates at several levels of detail share them.
    files: Vec<(SceneFile, Loaded)>,
    loads: Vec<Load>,
    groups: Vec<Grouped>,
}

/// A loaded scene.
#[derive(Debug)]
struct Load {
    /// The scene, and whether it was loaded as objects.
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

/// The groups of a scene.
#[derive(Debug)]
struct Grouped {
    load: usize,
    grouping: Grouping,
    groups: Groups,
}

/// A method that cannot draw the scene, and why.
pub type LeftOut = (&'static str, String);

/// A candidate that is ready to be drawn.
#[derive(Debug)]
pub struct Visit<'a> {
    /// The session of the candidate.
    pub session: Session<'a>,
    /// The camera.
    pub ready: &'a Ready,
    /// How long the session took to prepare, without groups that already existed.
    pub prepared: Duration,
}

impl Bench {
    /// Loads the scenes of candidates. Candidates whose methods cannot draw the scene are left out,
    /// with the reason. Candidates that need opacities are dropped if there are none.
    ///
    /// # Errors
    /// As [`SceneFile::ready`] if no candidate can be drawn.
    pub fn load(
        candidates: Vec<Candidate>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<(Self, Vec<Candidate>, Vec<LeftOut>)> {
        let mut bench = Self { files: Vec::new(), loads: Vec::new(), groups: Vec::new() };
        let (mut kept, mut left_out, mut first) = (Vec::new(), Vec::<LeftOut>::new(), None);
        for candidate in candidates {
            match bench.scene(&candidate, exec, progress) {
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

    /// The scene of a candidate: one that is already loaded, if it is the same.
    fn scene(
        &mut self,
        candidate: &Candidate,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<usize> {
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
        let ready = if is_flat {
            candidate.file.ready(exec, progress)?
        } else {
            candidate.file.ready_of(self.file(&plain, exec, progress)?, exec)?
        };
        self.loads.push(Load { key: (plain, objects), ready });
        Ok(self.loads.len() - 1)
    }

    /// The content of a scene of objects, read once for all levels of detail; geometries are
    /// shared.
    fn file(&mut self, plain: &SceneFile, exec: &Exec, progress: Progress<'_>) -> Result<Loaded> {
        let all = SceneFile { refinement: Refinement::default(), ..plain.clone() };
        if let Some((_, loaded)) = self.files.iter().find(|(file, _)| *file == all) {
            return Ok(loaded.clone());
        }
        let loaded = all.load(exec, progress)?;
        self.files.push((all, loaded.clone()));
        Ok(loaded)
    }

    /// Prepares a session of a loaded candidate.
    ///
    /// # Errors
    /// As [`Session::prepare`].
    pub fn visit<'a>(
        &'a mut self,
        candidate: &Candidate,
        exec: &'a Exec,
        progress: Progress<'_>,
    ) -> Result<Visit<'a>> {
        let method = candidate.file.method.method()?;
        let chosen = candidate.file.grouping(&method)?;
        let load = self.scene(candidate, exec, progress)?;
        let start = Instant::now();
        let known = self.known_groups(load, &method, chosen, exec, progress)?.cloned();
        let ready = &self.loads[load].ready;
        let session = Session::with_groups(&ready.loaded.scene, method, known, exec)?;
        Ok(Visit { session, ready, prepared: start.elapsed() })
    }

    /// The groups for a method that draws groups, made on its first visit.
    fn known_groups(
        &mut self,
        load: usize,
        method: &Method,
        chosen: Option<Grouping>,
        exec: &Exec,
        progress: Progress<'_>,
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
                let (groups, ..) = grouping.groups(&scene.surfels, exec, progress)?;
                self.groups.push(Grouped { load, grouping, groups });
                self.groups.len() - 1
            }
        };
        Ok(Some(&self.groups[found].groups))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::sweep::candidates;
    use std::path::Path;

    fn quiet(_: &str, _: u64, _: u64) {}

    #[test]
    fn levels_of_detail_share_what_is_read() {
        let exec = Exec::new(2, 32).unwrap();
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/bjfm19_prefixes.toml");
        let file = SceneFile::open(&golden).unwrap();
        let all = candidates(&file, None).unwrap();
        let (mut bench, kept, _) = Bench::load(all, &exec, &quiet).unwrap();
        assert_eq!(bench.files.len(), 1, "one file, whatever is asked of it");
        let (mut least, mut most) = (usize::MAX, 0);
        for candidate in kept.iter().filter(|one| one.method == "pyramid") {
            let found = bench.visit(candidate, &exec, &quiet).unwrap().ready.clone();
            let alone = candidate.file.ready(&exec, &quiet).unwrap();
            assert_eq!(
                found.identity(&exec).unwrap(),
                alone.identity(&exec).unwrap(),
                "{candidate:?}"
            );
            let surfels = found.loaded.scene.surfels.len();
            (least, most) = (least.min(surfels), most.max(surfels));
        }
        assert!(least < most, "sizes draw other prefixes: {least} to {most}");
    }
}
