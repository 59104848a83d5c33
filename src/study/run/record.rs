//! The results so far, saved in `study.json`, so that a stopped study can be resumed.

use crate::error::{Error, Result};
use crate::study::chart::violin::quantile;
use crate::study::front::front;
use crate::study::sweep::Candidate;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A study, complete or not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// The subject. Two studies of the same subject have the same errors on every machine.
    pub of: Subject,
    /// The results of the candidates, in their order.
    pub candidates: Vec<Record>,
    /// The methods that cannot draw the scene, and why.
    pub left_out: Vec<(String, String)>,
    /// The machine that measured the times.
    pub machine: String,
}

/// The subject of a study.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Subject {
    /// The version of the program.
    pub splatref: String,
    /// The name of the scene.
    pub scene: String,
    /// The SHA-256 of the scene as loaded.
    pub scene_sha256: String,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The camera: all its numbers.
    pub camera: String,
    /// How the truth was computed, in a sentence.
    pub truth: String,
    /// The SHA-256 of the true picture.
    pub truth_sha256: String,
}

/// The results of a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The options that turn the scene into this candidate.
    pub options: String,
    /// The name of its method.
    pub method: String,
    /// Its errors, if they are measured.
    pub measured: Option<Measured>,
    /// The times of its pictures in ms, in the order in which they were taken.
    pub times: Vec<f64>,
}

/// The errors of a candidate; an undefined figure is absent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// How many surfels its scene has.
    pub surfels: u64,
    /// How long the first session took to prepare, in ms.
    pub prepared: f64,
    /// The figures by their names.
    pub figures: BTreeMap<String, f64>,
    /// The power of flicker by frequency: under shifts, and along the path; empty if it was not
    /// measured.
    pub spectra: [Vec<f64>; 2],
}

impl Record {
    /// A candidate without results.
    #[must_use]
    pub fn new(candidate: &Candidate) -> Self {
        let (options, method) = (candidate.options.clone(), candidate.method.to_owned());
        Self { options, method, measured: None, times: Vec::new() }
    }

    /// The name of its picture, such as `ewa_cutoff=1.5.png`. Different options give different names:
    /// a character that file names may not have becomes its code.
    #[must_use]
    pub fn picture_name(&self) -> String {
        let options = self.options.trim_start_matches("--method ");
        let mut name = String::new();
        for c in options.replace(" --", "_").replace(' ', "=").chars() {
            if c.is_ascii_alphanumeric() || "-_=.,".contains(c) {
                name.push(c);
            } else {
                name.push_str(&format!("%{:x}", u32::from(c)));
            }
        }
        name + ".png"
    }

    /// The times in ascending order.
    fn ascending(&self) -> Vec<f64> {
        let mut times = self.times.clone();
        times.sort_by(f64::total_cmp);
        times
    }

    /// The quartiles of the times in ms: the first, the median and the third; `None` before the
    /// first time.
    #[must_use]
    pub fn quartiles(&self) -> Option<[f64; 3]> {
        let times = self.ascending();
        (!times.is_empty()).then(|| [0.25, 0.5, 0.75].map(|share| quantile(&times, share)))
    }

    /// A figure, if it is known.
    #[must_use]
    pub fn figure(&self, name: &str) -> Option<f64> {
        self.measured.as_ref()?.figures.get(name).copied()
    }
}

impl Study {
    /// The front of median time and an error, among candidates that have both: indices by ascending
    /// time. A smaller `loss` is better.
    #[must_use]
    pub fn front(&self, loss: impl Fn(&Record) -> Option<f64>) -> Vec<usize> {
        let point = |record: &Record| {
            let time = record.quartiles().map_or(f64::NAN, |[_, median, _]| median);
            [time, loss(record).unwrap_or(f64::NAN)]
        };
        front(&self.candidates.iter().map(point).collect::<Vec<_>>())
    }

    /// Adds the results of an earlier study with the same subject.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the other study has another subject.
    pub fn resumed(mut self, before: Self) -> Result<Self> {
        if before.of != self.of {
            return Err(Error::Invalid(
                "the study to resume has another scene, camera, truth or version; leave out \
                 --resume, or give another -o"
                    .into(),
            ));
        }
        for record in &mut self.candidates {
            if let Some(known) = before.candidates.iter().find(|one| one.options == record.options)
            {
                record.measured.clone_from(&known.measured);
                record.times.clone_from(&known.times);
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(options: &[&str]) -> Study {
        let record = |options: &&str| Record {
            options: (*options).to_owned(),
            method: "ewa".into(),
            measured: None,
            times: Vec::new(),
        };
        let of = Subject {
            splatref: "0".into(),
            scene: "s".into(),
            scene_sha256: "h".into(),
            size: [2, 1],
            camera: "c".into(),
            truth: "t".into(),
            truth_sha256: "u".into(),
        };
        let candidates = options.iter().map(record).collect();
        Study { of, candidates, left_out: Vec::new(), machine: String::new() }
    }

    fn known(record: &mut Record, times: &[f64], rmse: f64) {
        let figures = BTreeMap::from([("rmse".to_owned(), rmse)]);
        let spectra = [vec![0.1, 1.0 / 3.0], Vec::new()];
        record.measured = Some(Measured { surfels: 3, prepared: 0.5, figures, spectra });
        record.times = times.to_vec();
    }

    #[test]
    fn what_was_kept_is_what_is_read() {
        let mut first = study(&["a", "b"]);
        known(&mut first.candidates[0], &[0.1, 1.0 / 3.0, 1e-300], 0.123_456_789_012_345_67);
        let text = serde_json::to_string(&first).unwrap();
        assert_eq!(serde_json::from_str::<Study>(&text).unwrap(), first);
    }

    #[test]
    fn a_study_goes_on_with_what_it_has() {
        let mut before = study(&["a", "gone", "b"]);
        known(&mut before.candidates[2], &[1.0], 0.5);
        let after = study(&["b", "new"]).resumed(before.clone()).unwrap();
        assert_eq!(after.candidates[0], before.candidates[2]);
        assert_eq!(after.candidates[1].measured, None);
        before.of.size = [3, 1];
        assert!(study(&["b"]).resumed(before).is_err());
    }

    #[test]
    fn the_front_needs_both_a_time_and_an_error() {
        let mut all = study(&["slow", "fast", "untimed", "unmeasured", "beaten"]);
        let set =
            [(0, &[9.0, 8.0, 10.0][..], 0.1), (1, &[1.0], 0.5), (2, &[], 0.0), (4, &[9.5], 0.2)];
        for (i, times, rmse) in set {
            known(&mut all.candidates[i], times, rmse);
        }
        all.candidates[3].times = vec![0.5];
        assert_eq!(all.front(|record| record.figure("rmse")), [1, 0]);
        assert_eq!(all.candidates[0].quartiles(), Some([8.0, 9.0, 10.0]));
        assert_eq!(all.candidates[2].quartiles(), None);
    }
}
