//! Name the mistake that a client most probably makes, from its wrong pixels.
//!
//! A mistake is one change to the reference that explains the client's error in size and place. Some
//! mistakes show directly, because the wrong pixels have something in common. For the others the
//! client is judged again, as if the mistake were the rule: with another setting, another camera or
//! another scene, with another rule for splats and sums, or with the mistake undone in the client's
//! planes. Count the wrong pixels in the first wrong stage and the next one. A mistake is named only
//! if at most one in eight of these stays wrong, and if no other mistake leaves fewer wrong pixels.
//! Where another mistake explains as much, both are named with their shares.
//!
//! The search goes from the usual to the unusual, and ends as soon as nothing stays wrong:
//!
//! 1. a number of the camera, or several together, if the pixels show it;
//! 2. mistakes that authors of renderers make often;
//! 3. rarer ones;
//! 4. other numbers, which are estimated: see [`search`](self);
//! 5. numbers that are coarser than the client says.
//!
//! Some numbers are estimated: what depths mean by a fitted line; the lens, an offset and a roll by
//! the pixels in which the client says surfel and depth, or by a map from each surfel's centre to the
//! place where the client shows it; the low-pass filter, the cut-off and radii by search.

mod cameras;
mod change;
mod coarse;
mod depths;
mod epsilon;
mod fields;
mod gaussians;
mod mistakes;
mod numbers;
mod off_planes;
mod plain;
mod planes;
mod pose;
mod sample;
mod search;
mod shown;
mod surfels;

use super::client::Client;
use super::{StageVerdict, Verdict};
use crate::error::{Error, Result};
use crate::method::Session;
use crate::scene::Camera;
use change::Change;
use shown::{Pixel, Shown};
use std::cell::OnceCell;

/// The client, what the verdict says about it, and the stages in which its mistake may lie.
struct Case<'a, 's> {
    session: &'a Session<'s>,
    camera: &'a Camera,
    client: &'a Client,
    verdict: &'a Verdict,
    wrong: &'a StageVerdict,
    /// The first wrong stage, after the stages before it that are not judged because they have no
    /// planes.
    stages: Vec<&'static str>,
    /// The wrong pixels.
    all: Wrong,
    /// A few pixels that trials judge first, and the wrong ones among them.
    pilot: Option<(&'a Client, Wrong)>,
    /// The client's depths beside the right ones, once they are asked for.
    depths: OnceCell<Option<Vec<(f64, f64)>>>,
    /// The pixels that show surfel and depth, once they are asked for.
    plane_depths: OnceCell<Option<Vec<Pixel>>>,
}

/// The wrong pixels of a verdict.
#[derive(Clone, Copy, Debug)]
struct Wrong {
    /// In the first wrong stage and the next one.
    near: u64,
    /// In all stages.
    all: u64,
    /// The logarithms of the errors in the first wrong stage and the next one, added.
    size: f64,
}

/// A mistake that explains the wrong pixels.
struct Explanation {
    what: String,
    change: Change,
    /// One in this many wrong pixels may stay wrong.
    most: u64,
    left: Wrong,
}

/// Mistakes in words, and as changes.
type Mistakes = Vec<(String, Change)>;

/// The fewest wrong pixels that a change can explain. Fewer may be cured by chance.
const FEWEST: u64 = 6;

/// One in this many wrong pixels may stay wrong. `Decided:` the right change left at most one in ten
/// in the tests' clients, where it was not exact, and wrong ones at least one in seven.
const MOST_LEFT: u64 = 8;

/// The same for a change that only widens what is allowed, and so explains more by chance.
const MOST_LEFT_WIDENED: u64 = 20;

impl Case<'_, '_> {
    /// The wrong pixels if a change were the rule; none if the client has no plane that shows it.
    fn judge(&self, change: &Change) -> Result<Option<Wrong>> {
        self.judge_client(change, self.client)
    }

    /// As [`Case::judge`]; none, too, if depths or a few pixels show that the change explains nothing.
    fn judge_twice(&self, change: &Change) -> Result<Option<Wrong>> {
        if off_planes::rejects(self, change) {
            return Ok(None);
        }
        if let Some((pilot, all)) = self.pilot {
            let left = self.judge_client(change, pilot)?;
            if left.is_none_or(|left| left.is_hopeless(all)) {
                return Ok(None);
            }
        }
        self.judge(change)
    }

    fn judge_client(&self, change: &Change, client: &Client) -> Result<Option<Wrong>> {
        let budget = self.verdict.budget;
        match change.judge(self.session, self.camera, client, budget) {
            Ok(verdict) => Ok(verdict.map(|verdict| Wrong::of(&verdict, self.wrong.stage))),
            // The method cannot draw the scene with this mistake.
            Err(Error::Invalid(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The depth that the client stores at each pixel, and the right one.
    fn depths(&self) -> Option<&Vec<(f64, f64)>> {
        let pairs = || depths::pairs(self.session, self.camera, self.client);
        self.depths.get_or_init(pairs).as_ref()
    }

    /// The pixels that show surfel and depth, see [`off_planes`].
    fn plane_depths(&self) -> Option<&Vec<Pixel>> {
        self.plane_depths.get_or_init(|| off_planes::in_part(self)).as_ref()
    }

    /// Whether at least one in so many covered pixels is wrong.
    fn is_one_in(&self, pixels: u64) -> bool {
        pixels * self.wrong.wrong >= self.verdict.covered
    }

    /// Whether so few pixels stay wrong that the mistake is explained.
    fn explains(&self, left: Wrong, most_left: u64) -> bool {
        left.is_at_most(most_left, self.all)
    }

    /// The share of the wrong pixels that are explained.
    fn share(&self, left: Wrong) -> f64 {
        1.0 - left.all as f64 / self.all.all as f64
    }

    /// Adds those of some mistakes that explain the wrong pixels.
    fn try_all(&self, some: Mistakes, found: &mut Vec<Explanation>) -> Result<()> {
        if self.all.near < FEWEST {
            return Ok(());
        }
        for (what, change) in some {
            let Some(left) = self.judge_twice(&change)? else { continue };
            let most = if change.widens() { MOST_LEFT_WIDENED } else { MOST_LEFT };
            if self.explains(left, most) {
                found.push(Explanation { what, change, most, left });
            }
        }
        Ok(())
    }

    /// The mistakes of one kind for all stages in which the mistake may lie.
    fn of_stages(&self, some: fn(&Self, &str) -> Mistakes) -> Mistakes {
        self.stages.iter().flat_map(|stage| some(self, stage)).collect()
    }

    /// The best explanation in words: two, with their shares, if they explain the same.
    fn in_words(&self, mut found: Vec<Explanation>) -> Option<Likely> {
        found.sort_by_key(|one| one.left.all);
        let mut mistakes: Vec<String> = found.iter().map(|one| one.what.clone()).collect();
        mistakes.dedup();
        let mut found = found.into_iter();
        let best = found.next()?;
        let near = |other: &Explanation| {
            other.what != best.what && 100 * (other.left.all - best.left.all) <= self.all.all
        };
        let percent = |one: &Explanation| 100.0 * self.share(one.left);
        let words = match found.find(near) {
            Some(other) => format!(
                "{} (explains {:.1} %), or {} ({:.1} %)",
                best.what,
                percent(&best),
                other.what,
                percent(&other)
            ),
            None => best.what,
        };
        Some(Likely { words, mistakes })
    }
}

impl Wrong {
    /// Whether at most one in so many of all wrong pixels is left.
    fn is_at_most(&self, one_in: u64, all: Self) -> bool {
        one_in * self.near <= all.near && one_in * self.all <= all.all
    }

    /// Whether so many of a few wrong pixels stay wrong that no larger part can be explained.
    fn is_hopeless(&self, all: Self) -> bool {
        2 * self.near > all.near || 2 * self.all > all.all
    }

    fn of(verdict: &Verdict, stage: &str) -> Self {
        let near = verdict.stages.iter().skip_while(|own| own.stage != stage).take(2);
        let log = |error: &f32| libm::log(1.0 + f64::from(if *error < 1e9 { *error } else { 1e9 }));
        let size = |stage: &StageVerdict| -> f64 {
            stage.errors.values().iter().filter(|error| **error > 1.0).map(log).sum()
        };
        Self {
            near: near.clone().map(|stage| stage.wrong).sum(),
            all: verdict.stages.iter().map(|stage| stage.wrong).sum(),
            size: near.map(size).sum(),
        }
    }
}

/// The mistake that a client most probably makes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Likely {
    /// The mistake in words: two, with their shares, if they explain the same.
    pub words: String,
    /// Every mistake that explains nearly all wrong pixels, the best first.
    pub mistakes: Vec<String>,
}

impl From<String> for Likely {
    fn from(words: String) -> Self {
        Self { mistakes: vec![words.clone()], words }
    }
}

/// The mistake that a client most probably makes, in words; none if no known mistake fits.
///
/// # Errors
/// As [`Session::verify`].
pub fn likely_cause(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
    verdict: &Verdict,
) -> Result<Option<String>> {
    Ok(likely(session, camera, client, verdict)?.map(|likely| likely.words))
}

/// The mistake that a client most probably makes, with the others that explain its wrong pixels;
/// none if no known mistake fits.
///
/// # Errors
/// As [`Session::verify`].
pub fn likely(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
    verdict: &Verdict,
) -> Result<Option<Likely>> {
    let Some(wrong) = verdict.first_wrong() else { return Ok(None) };
    // A stage without planes is not judged, so its mistakes show in the first stage that is.
    let before = verdict.stages.iter().take_while(|stage| stage.stage != wrong.stage);
    let unseen = before.filter(|stage| stage.planes.is_empty()).chain([wrong]);
    let stages = unseen.map(|stage| stage.stage).collect();
    let all = Wrong::of(verdict, wrong.stage);
    let (pilot, depths, plane_depths) = (None, OnceCell::new(), OnceCell::new());
    let case =
        Case { session, camera, client, verdict, wrong, stages, all, pilot, depths, plane_depths };
    if let Some(plain) = plain::plain(&case) {
        return Ok(Some(plain.into()));
    }
    let found = match sample::parts(&case) {
        Some(parts) => sample::confirmed(&case, sample::in_part(&case, &parts, explanations)?)?,
        None => explanations(&case)?,
    };
    fields::with(&case, case.in_words(found).or_else(|| plain::common(&case).map(Likely::from)))
}

/// The mistakes that explain the wrong pixels of a case.
fn explanations(case: &Case<'_, '_>) -> Result<Vec<Explanation>> {
    let Case { session, wrong, all, .. } = *case;
    let shown = Shown::new(session, case.camera, case.client);
    let mut found = Vec::new();
    if let Some(shown) = &shown {
        found.extend(search::of_camera(case, shown)?);
    }
    // The depths of many pixels do not fit by chance, so nothing else is tried.
    if !found.is_empty() {
        return Ok(found);
    }
    for supposed in [mistakes::common, mistakes::rare] {
        case.try_all(case.of_stages(supposed), &mut found)?;
        if found.iter().any(|one| one.left.all == 0) {
            break;
        }
    }
    if found.is_empty() && wrong.wrong >= FEWEST {
        case.try_all(mistakes::choices(session), &mut found)?;
        // A client with another setting is right by that setting.
        found.retain(|one| one.left.all == 0);
    }
    // Where trials judge the whole of a large picture, a search takes too long.
    if found.is_empty() && (case.client.part.is_some() || !sample::is_large(case)) {
        // If pixels show the camera, it is right, or wrong in another way.
        found.extend(search::best(case, shown.is_none())?);
    }
    if found.is_empty() {
        found.extend(coarse::promised(case)?);
    }
    if found.is_empty() {
        case.try_all(coarse::mistakes(case), &mut found)?;
    }
    let nearer = 20 * wrong.causes.below >= 19 * wrong.wrong;
    if found.is_empty() && wrong.stage == "visibility" && nearer && case.is_one_in(20) {
        // Quads may be a little larger than the crate's bounds, so more may stay wrong.
        let left = case.judge(&Change::Discarded)?;
        let what = "depth and id come from fragments that should be discarded".to_owned();
        let (change, most) = (Change::Discarded, 5);
        let left = left.filter(|left| most * left.near <= all.near);
        found.extend(left.map(|left| Explanation { what, change, most, left }));
    }
    Ok(found)
}
