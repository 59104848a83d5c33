//! The client without habits draws the crate's picture, bit for bit; the verifier calls no lawful
//! habit wrong, and finds every bug.

use super::bug::Bug;
use super::cases::{Case, cases};
use super::manner::Manner;
use super::{How, render};
use crate::verify::client::Habit;
use crate::verify::client_is_right::differences;
use crate::verify::matrix::Picture;
use splatref::frame::{Exec, Frame};
use splatref::method::{Method, Session};
use splatref::verdict::Verdict;
use splatref::verdict::client::{Client, Rounding, Storage, Ties};

/// A case that is drawn and judged several times.
struct Stand<'a> {
    name: &'static str,
    case: &'a Case,
    session: Session<'a>,
}

/// What a client says of itself, and which planes it hands in.
#[derive(Clone, Copy)]
struct Word {
    rounding: Rounding,
    handed: fn(&str) -> bool,
    storage: Storage,
}

const fn word(rounding: Rounding) -> Word {
    Word { rounding, handed: |_| true, storage: Storage::Single }
}

impl Stand<'_> {
    fn draw(&self, how: How) -> Frame<f32> {
        let (scene, camera, settings) = self.case;
        render(scene, self.session.groups().unwrap(), camera, settings, how)
    }

    /// What is said of a client's picture.
    fn judge(&self, how: How, word: Word) -> Verdict {
        self.judge_frame(self.draw(how), how, word)
    }

    fn judge_frame(&self, mut frame: Frame<f32>, how: How, word: Word) -> Verdict {
        frame.planes.retain(|plane| (word.handed)(&plane.name));
        let mut client = Client::from(&frame);
        client.rounding = word.rounding;
        client.ties = ties(how);
        let images = ["group##", "group##.normal", "group##.weight"];
        client = images.iter().fold(client, |client, row| client.stored(row, word.storage));
        self.session.verify(&self.case.1, &client, 1.0).unwrap()
    }
}

fn stands<'a>(cases: &'a [(&'static str, Case)], exec: &'a Exec) -> Vec<Stand<'a>> {
    let stand = |(name, case): &'a (&'static str, Case)| {
        let session = Session::new(&case.0, Method::SinglePass(case.2), exec).unwrap();
        Stand { name, case, session }
    };
    cases.iter().map(stand).collect()
}

/// What a client with a habit may promise.
fn promises(how: How) -> &'static [Rounding] {
    match how.manner {
        Manner::Plain | Manner::AnyOrder | Manner::DepthBufferOfDepth => how.habit.promises(),
        _ => Habit::Reassociated.promises(),
    }
}

/// Every habit of numbers, and every way to build the passes.
fn lawful() -> Vec<How> {
    let habits = Habit::ALL.iter().map(|&habit| How::from(habit));
    let manners = Manner::ALL.iter().filter(|manner| **manner != Manner::OneShader);
    let manners = manners.map(|&manner| How { manner, ..How::default() });
    habits.chain(manners.skip(1)).collect()
}

/// The pictures of every lawful way to draw and of every bug.
pub(crate) fn pictures(each: &mut dyn FnMut(Picture<'_>)) {
    let (cases, exec) = (cases(), Exec::sequential());
    for stand in stands(&cases, &exec) {
        for how in lawful().into_iter().chain(Bug::ALL.iter().map(|&bug| bug.into())) {
            let variant = match how.manner {
                Manner::Plain => how.habit.name(),
                manner => manner.name(),
            };
            each(Picture {
                session: &stand.session,
                camera: &stand.case.1,
                scene: stand.name,
                what: how.bug.map_or(variant, Bug::name).to_owned(),
                keeps: how.bug.is_none().then(|| promises(how)),
                ties: ties(how),
                frame: stand.draw(how),
            });
        }
    }
}

/// The fragment that stays of equally near ones.
fn ties(how: How) -> Ties {
    match (how.manner, how.habit) {
        (Manner::AnyOrder, _) => Ties::Any,
        (_, Habit::TiesToTheLast) => Ties::Last,
        _ => Ties::Lowest,
    }
}

/// What is wrong, in words.
fn said(verdict: &Verdict, of: &str) -> Option<String> {
    let stage = verdict.first_wrong()?;
    Some(format!("{of}: {}, {} pixels, {:?}", stage.stage, stage.wrong, stage.worst))
}

fn names(frame: &Frame<f32>) -> Vec<&str> {
    let mut names: Vec<_> = frame.planes.iter().map(|plane| plane.name.as_str()).collect();
    names.sort_unstable();
    names
}

#[test]
fn the_plain_client_has_the_bits_of_the_crate() {
    let (cases, exec) = (cases(), Exec::sequential());
    let mut found = Vec::new();
    for stand in stands(&cases, &exec) {
        let crates = stand.session.define::<f32>(&stand.case.1, true).unwrap().frame;
        let ours = stand.draw(How::default());
        let name = stand.name;
        assert_eq!(names(&ours), names(&crates), "{name}");
        let covered = ours.scalar("A").unwrap().values().iter().filter(|a| **a > 0.0).count();
        let groups = stand.session.groups().unwrap().len();
        println!("{name}: {groups} groups, {covered} pixels");
        assert!(covered > 100, "{name} has something to see");
        let differences = differences(&ours, &crates);
        if !differences.is_empty() {
            found.push(format!("{name}, {covered} pixels: {differences:?}"));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// Habits that change nothing here: no bounds cross, and nothing is so small.
const IDLE: [Habit; 4] =
    [Habit::Plain, Habit::ClampHighFirst, Habit::FlushDenormals, Habit::WideQuads];

#[test]
fn no_lawful_habit_is_called_wrong() {
    let (cases, exec) = (cases(), Exec::sequential());
    let stands = stands(&cases, &exec);
    let plain: Vec<_> = stands.iter().map(|stand| stand.draw(How::default())).collect();
    let mut found = Vec::new();
    for how in lawful() {
        let (habit, manner) = (how.habit.name(), how.manner.name());
        let mut seen = how.manner == Manner::Plain && IDLE.contains(&how.habit);
        for (stand, plain) in stands.iter().zip(&plain) {
            let frame = stand.draw(how);
            let differs = !differences(plain, &frame).is_empty();
            seen |= differs;
            // What leaves the same bits is judged once.
            let judged = differs || (how.manner == Manner::Plain && how.habit == Habit::Plain);
            for &promise in promises(how).iter().filter(|_| judged) {
                let verdict = stand.judge_frame(frame.clone(), how, word(promise));
                let of = format!("{}, {habit}, {manner}, {promise:?}", stand.name);
                found.extend(said(&verdict, &of));
                // But for the cases whose decisions are all at their limits.
                let share = verdict.undecided as f64 / verdict.covered as f64;
                assert!(share <= 0.005 || stand.name.starts_with("limits"), "{of}: {share}");
            }
        }
        assert!(seen, "{habit}, {manner}");
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// What a client may hand in: a part of the planes, and whether a plane is one of it.
type Part = (&'static str, fn(&str) -> bool);

const PARTS: [Part; 6] = [
    ("the picture", |plane| !plane.contains('.') && !plane.starts_with("group")),
    ("the sums and the picture", |plane| !plane.starts_with("group")),
    ("without ids", |plane| !plane.ends_with("id")),
    ("without depths", |plane| !plane.ends_with('Z') && !plane.ends_with("voronoi")),
    ("one image and the picture", |plane| plane.starts_with("group01") || !plane.contains("group")),
    ("images of ids", |plane| plane.ends_with("id") || !plane.starts_with("group")),
];

#[test]
fn parts_and_halves_are_right() {
    let (cases, exec) = (cases(), Exec::sequential());
    let mut found = Vec::new();
    for stand in stands(&cases, &exec) {
        for (part, handed) in PARTS {
            let gpu = Word { handed, ..word(Rounding::Gpu) };
            let of = format!("{}, {part}", stand.name);
            found.extend(said(&stand.judge(Habit::Coarse.into(), gpu), &of));
        }
        for (part, handed) in &PARTS[..2] {
            let how = How { manner: Manner::OneShader, ..How::from(Habit::Fused) };
            let ieee = Word { handed: *handed, ..word(Rounding::Ieee) };
            let of = format!("{}, {part}, one shader", stand.name);
            found.extend(said(&stand.judge(how, ieee), &of));
        }
        let halves = Word { storage: Storage::Half, ..word(Rounding::Gpu) };
        found.extend(said(&stand.judge(Bug::HalfImages.into(), halves), stand.name));
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The bugs that one with another rounding could take for rounding in every case: q within 1e-5 of
/// the rim, which the rounding of a projection moves by as much.
const BELOW_WHAT_A_GPU_MAY_ROUND: [Bug; 3] =
    [Bug::CutoffSmaller, Bug::CutoffLarger, Bug::RimOutside];

#[test]
fn every_bug_is_found_at_its_stage() {
    let (cases, exec) = (cases(), Exec::sequential());
    let stands = stands(&cases, &exec);
    let plain: Vec<_> = stands.iter().map(|stand| stand.draw(How::default())).collect();
    let mut other = Vec::new();
    for &bug in Bug::ALL {
        let promises = [Rounding::Ieee, Rounding::Gpu];
        let mut found = [None; 2];
        for (stand, plain) in stands.iter().zip(&plain) {
            if found.iter().all(Option::is_some) {
                break;
            }
            let frame = stand.draw(bug.into());
            // What leaves the bits of the plain client is right, as another test says.
            if differences(plain, &frame).is_empty() {
                continue;
            }
            for (promise, found) in promises.iter().zip(&mut found).filter(|(_, f)| f.is_none()) {
                let verdict = stand.judge_frame(frame.clone(), bug.into(), word(*promise));
                *found = verdict.first_wrong().map(|stage| (stand.name, stage.stage));
            }
        }
        println!("{}: {found:?}", bug.name());
        let missed = [false, BELOW_WHAT_A_GPU_MAY_ROUND.contains(&bug)];
        let right = found.map(|found| found.is_none_or(|(_, stage)| stage == stage_of(bug)));
        if found.map(|found| found.is_none()) != missed || right != [true; 2] {
            other.push(format!("{}: {found:?}", bug.name()));
        }
    }
    assert!(other.is_empty(), "{other:#?}");
}

/// The stage in which a bug is first to be seen.
fn stage_of(bug: Bug) -> &'static str {
    match bug {
        Bug::GroupNotSummed
        | Bug::GroupTwice
        | Bug::NearestSoFar
        | Bug::NearestOfTheFirst
        | Bug::NearestIgnored
        | Bug::NearestAlone
        | Bug::EpsilonSubtracted
        | Bug::EpsilonStrict
        | Bug::EpsilonHalf
        | Bug::EpsilonDouble
        | Bug::EpsilonOfNearness
        | Bug::CountOffByOne
        | Bug::CountOfAll
        | Bug::HalfSums
        | Bug::SumsSaturate
        | Bug::WeightOff
        | Bug::DepthOfTheLast
        | Bug::DepthOfTheHeaviest
        | Bug::IdOfTheFirst
        | Bug::IdTiesByGroup
        | Bug::ColorNotDivided
        | Bug::ColorByCount
        | Bug::NormalNotUnit => "compositing",
        Bug::NormalNotTurned | Bug::SpecularSign | Bug::Srgb | Bug::PixelNan => "shading",
        _ => "geometry",
    }
}
