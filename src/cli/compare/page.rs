//! The page of a comparison: a tab for each plane that was compared.

use splatref::compare::{
    ChannelComparison, ChannelValue, Comparison, Criteria, Difference, Tolerance, Verdict,
};
use splatref::frame::Image;
use splatref::frame::image::Values;
use splatref::number::Real;
use splatref::report::page::{Kind, LISTED, Mark, Measure, Report, Shown, Tab, worst};

/// What the page of a comparison shows: the second picture beside the first, which is the
/// reference.
pub(super) fn report(
    [first, second]: [Image; 2],
    found: &Comparison,
    criteria: &Criteria,
    facts: Vec<(String, String)>,
    verdict: &str,
) -> Report {
    let compared: Vec<&ChannelComparison> = match found.sizes {
        [one, other] if one == other => found.channels.iter().collect(),
        _ => Vec::new(),
    };
    let mut all: Vec<String> = found.channels.iter().map(|c| c.name.clone()).collect();
    all.sort();
    let pair = [&first, &second];
    let tabs = planes(&compared);
    let tabs = tabs.into_iter().map(|(name, parts)| {
        let tolerance = |channel: &str| criteria.tolerance_of(channel, &all);
        tab(name, &parts, pair, tolerance)
    });
    let tabs: Vec<Tab> = tabs.collect();
    let about = match found.sizes {
        [one, other] if one != other => "The sizes differ, so no pixel can be compared.".into(),
        [(width, height), _] => format!(
            "The first picture is the reference. The difference of a plane is the largest \
             difference of its channels; two indices differ by 1. The pictures have {width} x \
             {height} pixels."
        ),
    };
    Report {
        title: format!("splatref compare: {verdict}"),
        facts,
        about,
        sides: ["Second", "First"],
        pictures: [second, first],
        measure: Measure {
            name: "Difference",
            unit: "",
            limit: None,
            words: ["within tolerance", "DIFFERENT"],
        },
        tabs,
        doubts: Vec::new(),
        cause: None,
        explained: Vec::new(),
    }
}

/// The channels of each plane, and its name: three letters of a colour or a vector belong together.
fn planes<'a>(channels: &[&'a ChannelComparison]) -> Vec<(String, Vec<&'a ChannelComparison>)> {
    let mut planes: Vec<(String, Vec<&ChannelComparison>)> = Vec::new();
    let find = |name: &str| channels.iter().copied().find(|channel| channel.name == name);
    for channel in channels.iter().copied() {
        if planes.iter().any(|(_, parts)| parts.iter().any(|part| part.name == channel.name)) {
            continue;
        }
        let (layer, letter) = match channel.name.rsplit_once('.') {
            Some((layer, letter)) => (format!("{layer}."), letter),
            None => (String::new(), channel.name.as_str()),
        };
        let letters = [["R", "G", "B"], ["X", "Y", "Z"]];
        let three =
            letters.iter().filter(|letters| letters.contains(&letter)).find_map(|letters| {
                let parts = letters.iter().map(|letter| find(&format!("{layer}{letter}")));
                parts.collect::<Option<Vec<_>>>()
            });
        planes.push(match three {
            Some(parts) if layer.is_empty() => {
                (parts.iter().map(|part| part.name.as_str()).collect(), parts)
            }
            Some(parts) => (layer.trim_end_matches('.').to_owned(), parts),
            None => (channel.name.clone(), vec![channel]),
        });
    }
    planes
}

/// The tab of a plane.
fn tab(
    name: String,
    parts: &[&ChannelComparison],
    [first, second]: [&Image; 2],
    tolerance: impl Fn(&str) -> Tolerance,
) -> Tab {
    let pixels = first.width as usize * first.height as usize;
    let (mut errors, mut wrong) = (vec![0.0; pixels], vec![false; pixels]);
    for part in parts {
        let (Some(one), Some(other)) = (first.channel(&part.name), second.channel(&part.name))
        else {
            continue;
        };
        mark(one, other, tolerance(&part.name), &mut errors, &mut wrong);
    }
    let channels: Vec<String> = parts.iter().map(|part| part.name.clone()).collect();
    let is_index = first.channel(&channels[0]).or_else(|| second.channel(&channels[0]));
    let is_index = matches!(is_index, Some(Values::Index(_)));
    let mark = match parts.iter().filter_map(|part| part.verdict()).max() {
        None => Mark::NotJudged,
        Some(Verdict::Different) => Mark::Wrong,
        Some(Verdict::Equal | Verdict::Within) => Mark::Right,
    };
    let lines: Vec<String> = parts.iter().map(ToString::to_string).collect();
    let kind = Kind::from_names(&channels, is_index);
    Tab {
        says: lines.join("\n"),
        mark,
        planes: vec![Shown { name: name.clone(), kind, unit: "", meaning: "", channels }],
        doubts: Vec::new(),
        worst: worst(&errors, LISTED),
        name,
        errors,
        wrong,
    }
}

/// Adds the differences of a channel to those of its plane.
fn mark(
    first: &Values,
    second: &Values,
    tolerance: Tolerance,
    errors: &mut [f32],
    wrong: &mut [bool],
) {
    let pairs: Vec<(ChannelValue, ChannelValue)> = match (first, second) {
        (Values::Float(a), Values::Float(b)) => {
            let pairs = a.iter().zip(b);
            pairs.map(|(&a, &b)| (ChannelValue::Float(a), ChannelValue::Float(b))).collect()
        }
        (Values::Index(a), Values::Index(b)) => {
            let pairs = a.iter().zip(b);
            pairs.map(|(&a, &b)| (ChannelValue::Index(a), ChannelValue::Index(b))).collect()
        }
        _ => return,
    };
    for ((first, second), (error, wrong)) in pairs.into_iter().zip(errors.iter_mut().zip(wrong)) {
        if first.bits() == second.bits() {
            continue;
        }
        let difference = Difference { x: 0, y: 0, first, second };
        let size = match first {
            ChannelValue::Index(_) => 1.0,
            // NaN on one side, and two zeros of different signs, differ too.
            ChannelValue::Float(_) => difference.ulps().map_or(f64::INFINITY, |_| difference.abs()),
        };
        // A difference below the smallest f32, and that of the two zeros, is still one.
        *error = error.at_least(size as f32).at_least(f32::from_bits(1));
        *wrong |= !difference.passes(tolerance);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatref::compare::Relation;

    #[test]
    fn letters_of_a_plane_share_a_tab() {
        let channel =
            |name: &str| ChannelComparison { name: name.into(), relation: Relation::OnlyFirst };
        let names = ["A", "B", "G", "R", "Z", "a.Z", "normal.X", "normal.Y", "normal.Z"];
        let channels = names.map(channel);
        let found = planes(&channels.iter().collect::<Vec<_>>());
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["A", "RGB", "Z", "a.Z", "normal"]);
        assert_eq!(found[1].1[0].name, "R", "red comes first");
    }
}
