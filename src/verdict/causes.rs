//! Name the mistake that a client most probably makes, from its wrong pixels.
//!
//! Some mistakes show directly, because the wrong pixels have something in common. For the others
//! the client is judged again, as if the mistake were the rule: with another setting, with another
//! camera, or with the mistake undone in its planes. Count the wrong pixels in the first wrong
//! stage and the next one. A mistake is named if at most one in five of these stays wrong. If
//! several mistakes qualify, the one that leaves the fewest wrong pixels in all stages is named.
//! The rarer mistakes are tried only where no common one explains everything. Some numbers are
//! estimated: what depths mean by a fitted line, and the low-pass filter, the cut-off and the field
//! of view by search.

mod depths;
mod epsilon;
mod search;

use super::client::{Band, Client, Storage, Ties};
use super::{StageVerdict, Verdict};
use crate::error::Result;
use crate::frame::Samples;
use crate::method::{Method, Session};
use crate::number::MapInline;
use crate::number::srgb;
use crate::scene::Camera;
use crate::setting::{Fields, Value};

/// What to change so that a mistake becomes the rule.
enum Change {
    Method(Method),
    Camera(Camera),
    Ties(Ties),
    Stored(&'static str, Storage),
    Accumulator(Storage),
    Flipped,
    /// Decode the picture as sRGB.
    Decoded,
    /// Divide colours by the weight, because the client did not.
    Divided,
    Band(Band),
    /// Move the depths back by this much.
    Moved(f64),
    /// Judge sums of fragments that lie behind the band.
    Behind,
    /// Read the depths another way.
    Depths(depths::Reading),
    /// Read normals from \[0, 1\].
    Unsigned,
    /// Read the components of colours in this order.
    Swapped([usize; 3]),
}

impl Change {
    /// Judges the client as if this were the rule. Only one changed copy of the client is in memory
    /// at a time. None if the client has no plane that shows this mistake.
    fn judge(
        &self,
        session: &Session<'_>,
        camera: &Camera,
        client: &Client,
        budget: f64,
    ) -> Result<Option<Verdict>> {
        let as_if = |client: Client| judged_as(session, session.method(), camera, &client, budget);
        let judge = |method, camera| judged_as(session, method, camera, client, budget);
        match self {
            Self::Method(method) => judge(method, camera),
            Self::Camera(camera) => judge(session.method(), camera),
            Self::Ties(ties) => as_if(Client { ties: *ties, ..client.clone() }),
            Self::Stored(plane, storage) => as_if(client.clone().stored(plane, *storage)),
            Self::Accumulator(accumulator) => {
                as_if(Client { accumulator: *accumulator, ..client.clone() })
            }
            Self::Flipped => as_if(client.flipped()),
            Self::Band(band) => as_if(epsilon::banded(client, *band)),
            Self::Moved(by) => as_if(epsilon::moved_back(client, *by)),
            Self::Behind => match epsilon::behind(session, camera, client) {
                Some((method, client)) => judged_as(session, &method, camera, &client, budget),
                None => Ok(None),
            },
            Self::Depths(reading) => as_if(reading.read(client)),
            Self::Unsigned => as_if(client.signed()),
            Self::Swapped(order) => {
                as_if(client.colors(&["", "resolved", "attributes"], |color, _| {
                    order.map_inline(|component| color[component])
                }))
            }
            Self::Decoded => {
                // Even an encoding in f32 loses this much, because a shading language's power does.
                let lost = 1.0 / 262_144.0;
                let storage = Storage::Srgb { relative: lost, least: lost };
                let decoded = client.colors(&[""], |color, _| color.map_inline(srgb::to_linear));
                as_if(decoded.stored("", storage))
            }
            Self::Divided => {
                as_if(client.colors(&["", "resolved"], |color, weight| {
                    color.map_inline(|part| part / weight)
                }))
            }
        }
    }
}

/// The verdict on a changed client, if any plane is left to judge.
fn judged_as(
    session: &Session<'_>,
    method: &Method,
    camera: &Camera,
    client: &Client,
    budget: f64,
) -> Result<Option<Verdict>> {
    if client.frame().planes.is_empty() {
        return Ok(None);
    }
    session.verify_as(method, camera, client, budget).map(Some)
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
    let Some(wrong) = verdict.first_wrong() else { return Ok(None) };
    if let Some(plain) = plain(wrong) {
        return Ok(Some(plain));
    }
    let all = wrong_of(verdict, wrong.stage);
    let mut best: Option<(u64, String)> = None;
    // A stage without planes is not judged, so its mistakes show in the first stage that is.
    let before = verdict.stages.iter().take_while(|stage| stage.stage != wrong.stage);
    let unseen = before.filter(|stage| stage.planes.is_empty()).chain([wrong]);
    let stages: Vec<_> = unseen.map(|stage| stage.stage).collect();
    // Common mistakes come first; the rare ones are tried only if some pixels stay wrong.
    for supposed in [common_mistakes, rare_mistakes] {
        for (what, change) in stages.iter().flat_map(|of| supposed(session, camera, client, of)) {
            let Some(verdict) = change.judge(session, camera, client, verdict.budget)? else {
                continue;
            };
            let [cured, left] = wrong_of(&verdict, wrong.stage);
            if 5 * cured <= all[0] && best.as_ref().is_none_or(|(least, _)| left < *least) {
                best = Some((left, what));
            }
        }
        if best.as_ref().is_some_and(|(left, _)| *left == 0) {
            break;
        }
    }
    if best.is_none() && stages.iter().any(|stage| VISIBLE.contains(stage)) {
        best = search::best(session, camera, client, (wrong.stage, verdict))?;
    }
    Ok(best.map(|(_, what)| what).or_else(|| common(session.method(), verdict, wrong)))
}

/// The stages that say where splats are.
const VISIBLE: [&str; 2] = ["visibility", "projection"];

/// The number of wrong pixels in a stage and the next one, and in all stages.
fn wrong_of(verdict: &Verdict, stage: &str) -> [u64; 2] {
    let from = verdict.stages.iter().skip_while(|own| own.stage != stage);
    let all = verdict.stages.iter().map(|stage| stage.wrong).sum();
    [from.take(2).map(|stage| stage.wrong).sum(), all]
}

/// The mistake that all wrong pixels of a stage show directly.
fn plain(wrong: &StageVerdict) -> Option<String> {
    let causes = &wrong.causes;
    let all = |count: u64| count == wrong.wrong;
    if all(causes.nan) {
        return Some(format!("NaN in {} of its pixels", causes.nan));
    }
    if all(causes.ties) {
        return Some(
            "ties: the client keeps another of the equally near surfels than it says".into(),
        );
    }
    let surfel = causes.left_out.keys().next()?;
    let one = causes.left_out.len() == 1 && wrong.wrong > 1 && all(causes.lacking());
    one.then(|| format!("surfel {surfel} is missing"))
}

/// What the wrong pixels of a stage have in common, if no changed rule explains them.
fn common(method: &Method, verdict: &Verdict, wrong: &StageVerdict) -> Option<String> {
    let causes = &wrong.causes;
    let most = |count: u64| 20 * count >= 19 * wrong.wrong;
    let discarded = most(causes.outside + causes.absent) && 2 * causes.outside > wrong.wrong;
    // Some depths are too near, and some lie where there is no surfel. A depth that means something
    // else is wrong in most pixels, or in empty ones alone.
    let few = 2 * wrong.wrong < verdict.covered && causes.strays < causes.below;
    if discarded || (most(causes.below) && causes.strays > 0 && few) {
        return Some("depth and id come from fragments that should be discarded".into());
    }
    let cutoff = method.splats().map(|splats| f64::from(splats.kernel.cutoff));
    // Where a surfel is left out, only its weight is missing later. If later stages have many more
    // wrong pixels, the shapes are wrong instead.
    let others = verdict.stages.iter().any(|stage| stage.wrong > 3 * wrong.wrong);
    if !most(causes.lacking()) || others {
        None
    } else if cutoff.is_some_and(|k| (0.98..1.1).contains(&(k * causes.least_rim))) {
        Some("q is compared with k, not with k^2".into())
    } else if causes.least_rim > 0.999 {
        Some("the cut-off is too small: fragments just inside it are left out".into())
    } else if causes.least_rim > 0.6 {
        Some("quads too small: the missing fragments lie near the rims of their splats".into())
    } else {
        Some("surfels are left out".into())
    }
}

/// The mistakes that show first in this stage, in words and as changes.
fn common_mistakes(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
    stage: &str,
) -> Vec<(String, Change)> {
    let mut all: Vec<(String, Change)> = Vec::new();
    match stage {
        "visibility" | "projection" => {
            for (what, dx, dy) in [
                ("half a pixel to the right and down", 0.5, 0.5),
                ("half a pixel to the left and up", -0.5, -0.5),
                ("half a pixel to the right", 0.5, 0.0),
                ("half a pixel down", 0.0, 0.5),
            ] {
                let moved = Camera { cx: camera.cx + dx, cy: camera.cy + dy, ..*camera };
                all.push((what.into(), Change::Camera(moved)));
            }
            all.push(("rows are flipped".into(), Change::Flipped));
            all.extend(depths::mistakes(session, camera, client));
            all.extend(settings(session, &VISIBILITY));
            let ties = if client.ties == Ties::Last { Ties::Lowest } else { Ties::Last };
            all.push(("ties are reversed".into(), Change::Ties(ties)));
            if let Some((depth, largest)) = client.depth_of_visibility() {
                let step = Storage::Steps(2.0 * largest / 65_535.0);
                all.push(("depth of 16 bits".into(), Change::Stored(depth, step)));
            }
        }
        "attributes" => {
            all.extend(settings(session, &ATTRIBUTES));
            all.extend(epsilon::other_unit(session.method()));
            all.push(("sums in half floats".into(), Change::Accumulator(Storage::Half)));
        }
        "normalization" | "shading" => {
            let what = "sRGB where linear colours are expected";
            all.push((what.into(), Change::Decoded));
            let what = "colours multiplied by the weight";
            all.push((what.into(), Change::Divided));
            let what = "normals are stored in [0, 1], not in [-1, 1]";
            all.push((what.into(), Change::Unsigned));
            for order in [[2, 1, 0], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1]] {
                let letters = order.map_inline(|component| ["R", "G", "B"][component]).concat();
                let what = format!("channels are swapped: red, green and blue are in {letters}");
                all.push((what, Change::Swapped(order)));
            }
        }
        _ => {}
    }
    all
}

/// The mistakes that are made less often.
fn rare_mistakes(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
    stage: &str,
) -> Vec<(String, Change)> {
    match stage {
        "visibility" => epsilon::moved(session, client),
        "attributes" => epsilon::bands(session, camera, client),
        _ => Vec::new(),
    }
}

/// A wrong setting: its name, the wrong value computed from the right one, and the mistake in
/// words.
type WrongSetting = (&'static str, fn(&Method, f32) -> Option<Value>, &'static str);

const VISIBILITY: [WrongSetting; 4] = [
    ("low_pass", |_, _| Some(Value::Number(0.0)), "the low-pass filter is missing"),
    ("low_pass", |_, h| Some(Value::Number(2.0 * h)), "the low-pass filter is added twice"),
    ("low_pass", |_, h| Some(Value::Number(0.5 * h)), "half of the low-pass filter is missing"),
    ("cull", switched, "culling is on where it should be off, or off where it should be on"),
];

const ATTRIBUTES: [WrongSetting; 4] = [
    ("epsilon", |method, _| epsilon::scaled(method, 0.5), "epsilon is half as wide"),
    ("epsilon", |method, _| epsilon::scaled(method, 2.0), "epsilon is twice as wide"),
    ("epsilon", |method, _| epsilon::scaled(method, 0.0), "epsilon is 0"),
    (
        "epsilon",
        |_, _| Some(Value::Text("inf".into())),
        "epsilon is ignored, or in a unit in which everything is within it",
    ),
];

/// The other value of a switch.
fn switched(method: &Method, _: f32) -> Option<Value> {
    method.splats().map(|splats| Value::Switch(!splats.cull))
}

/// The method with each of some wrong settings. Settings that the method does not have are left
/// out.
fn settings(session: &Session<'_>, wrong: &[WrongSetting]) -> Vec<(String, Change)> {
    let method = session.method();
    let with = |(name, value, what): &WrongSetting| {
        let own = method.values().into_iter().find(|(own, _)| own == name)?.1;
        let number = match own {
            Value::Number(number) => number,
            _ => 0.0,
        };
        let mut changed = *method;
        changed.set(name, &value(method, number)?).ok()?;
        let other = changed != *method && changed.check().is_ok();
        other.then(|| ((*what).to_owned(), Change::Method(changed)))
    };
    wrong.iter().filter_map(with).collect()
}

/// The planes of unit normals.
const NORMALS: [&str; 2] = ["normal", "projection.normal"];

impl Client {
    /// The planes with their rows in reverse order.
    fn flipped(&self) -> Self {
        let radii = self.radii.iter().map(|(name, radii)| (name.clone(), radii.flipped()));
        let radii = radii.collect();
        Self { radii, ..self.mapped(|_, samples| samples.flipped()) }
    }

    /// The planes with normals read from \[0, 1\]. A null vector stays one.
    fn signed(&self) -> Self {
        let signed = self.mapped(|name, samples| match samples {
            Samples::Vector(plane) if NORMALS.contains(&name) => {
                let of = |normal: &[f64; 3]| match normal {
                    [0.0, 0.0, 0.0] => [0.0; 3],
                    _ => normal.map_inline(|part| 2.0 * part - 1.0),
                };
                Samples::Vector(plane.map(of))
            }
            other => other.clone(),
        });
        // Halving and shifting rounded the normals.
        let lost = 2.0 / 16_777_216.0;
        let storage = Storage::Float { relative: lost, least: lost };
        NORMALS.into_iter().fold(signed, |client, name| match client.storage(name) {
            Storage::Single | Storage::Rounded => client.stored(name, storage),
            _ => client,
        })
    }

    /// The planes with changed colours in the planes of these names. `of` gets each colour and the
    /// weight at its pixel, or 1 if there is no weight.
    fn colors(&self, names: &[&str], of: impl Fn([f64; 3], f64) -> [f64; 3]) -> Self {
        let weight = ["weight", "attributes.weight"];
        let weight = weight.iter().find_map(|name| self.frame().scalar(name).ok());
        self.mapped(|name, samples| match samples {
            Samples::Color(plane) if names.contains(&name) => {
                let mut plane = plane.clone();
                for (i, color) in plane.values_mut().iter_mut().enumerate() {
                    let weight = weight.map_or(1.0, |weight| weight.values()[i]);
                    *color = of(*color, if weight > 0.0 { weight } else { 1.0 });
                }
                Samples::Color(plane)
            }
            other => other.clone(),
        })
    }
}
