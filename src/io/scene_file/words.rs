//! Settings as words: what scene files, the command line and the text in a picture call them.

use crate::method::ewa::Epsilon;
use crate::method::pyramid::{Occlusion, Weights};
use crate::method::single_pass::DepthTest;
use crate::method::template::LevelRule;
use crate::method::transparent::Holes;
use crate::shade::optics::BendingLayers;
use crate::source::Shape;
use crate::splat::{Kernel, Outline};

use super::{EnvironmentChoice, ExtensionChoice, MethodName, Number};

/// Something that a word stands for, or a line that says which words there are.
type Found<T> = Result<T, String>;

/// What the tree of [`crate::source::plant`] is called.
pub const TREE: &str = "tree";

/// The names of all that can be made without a file: [`Shape::ALL`] and [`TREE`].
#[must_use]
pub fn shapes() -> String {
    let names: Vec<&str> = Shape::ALL.iter().map(Shape::name).chain([TREE]).collect();
    names.join(", ")
}

/// `default`, `zpvbg01` or `zp06`.
///
/// # Errors
/// The words there are.
pub fn kernel(word: &str) -> Found<Kernel> {
    choose(
        "kernel",
        word,
        &[("default", Kernel::DEFAULT), ("zpvbg01", Kernel::ZPVBG01), ("zp06", Kernel::ZP06)],
    )
}

const OUTLINES: [(&str, Outline); 3] = [
    ("affine", Outline::Affine),
    ("perspective", Outline::Perspective),
    ("raycast", Outline::RayCast),
];

/// `affine`, `perspective` or `raycast`.
///
/// # Errors
/// The words there are.
pub fn outline(word: &str) -> Found<Outline> {
    choose("outline", word, &OUTLINES)
}

/// The word for an outline.
#[must_use]
pub fn of_outline(outline: Outline) -> &'static str {
    word_of(&OUTLINES, outline)
}

/// The methods.
const METHODS: [(&str, MethodName); 7] = [
    ("ewa", MethodName::Ewa),
    ("single-pass", MethodName::SinglePass),
    ("transparent", MethodName::Transparent),
    ("transparent-hq", MethodName::TransparentHq),
    ("peeling", MethodName::Peeling),
    ("pyramid", MethodName::Pyramid),
    ("template", MethodName::Template),
];

/// `ewa`, `single-pass`, `transparent`, `transparent-hq`, `peeling`, `pyramid` or `template`.
///
/// # Errors
/// The words there are.
pub fn method(word: &str) -> Found<MethodName> {
    choose("method", word, &METHODS)
}

/// The word for a method.
#[must_use]
pub fn of_method(name: MethodName) -> &'static str {
    word_of(&METHODS, name)
}

const DEPTHS: [(&str, bool); 2] = [("plain", false), ("voronoi", true)];

/// `plain` (false) or `voronoi` (true), the depth test of groups.
///
/// # Errors
/// The words there are.
pub fn depth(word: &str) -> Found<bool> {
    choose("depth", word, &DEPTHS)
}

/// The word for a depth test.
#[must_use]
pub fn of_depth(test: DepthTest) -> &'static str {
    word_of(&DEPTHS, test != DepthTest::Plain)
}

const HOLES: [(&str, Holes); 2] = [("skipped", Holes::Skipped), ("background", Holes::Background)];

/// `skipped` or `background`.
///
/// # Errors
/// The words there are.
pub fn holes(word: &str) -> Found<Holes> {
    choose("holes", word, &HOLES)
}

/// The word for what holes are.
#[must_use]
pub fn of_holes(holes: Holes) -> &'static str {
    word_of(&HOLES, holes)
}

const BENDS: [(&str, BendingLayers); 2] =
    [("single", BendingLayers::Single), ("multiple", BendingLayers::Multiple)];

/// `single` or `multiple`: how many layers bend light.
///
/// # Errors
/// The words there are.
pub fn bends(word: &str) -> Found<BendingLayers> {
    choose("bends", word, &BENDS)
}

/// The word for how many layers bend light.
#[must_use]
pub fn of_bends(layers: BendingLayers) -> &'static str {
    word_of(&BENDS, layers)
}

const WEIGHTS: [(&str, Weights); 2] = [("box", Weights::Box), ("gaussian", Weights::Gaussian)];

/// `box` or `gaussian`: the weights of the pull-push interpolation.
///
/// # Errors
/// The words there are.
pub fn weights(word: &str) -> Found<Weights> {
    choose("weights", word, &WEIGHTS)
}

/// The word for weights.
#[must_use]
pub fn of_weights(weights: Weights) -> &'static str {
    word_of(&WEIGHTS, weights)
}

const OCCLUSIONS: [(&str, Occlusion); 2] =
    [("behind", Occlusion::Behind), ("outside", Occlusion::Outside)];

/// `behind` or `outside` the interval of the parent: what is occluded.
///
/// # Errors
/// The words there are.
pub fn occluded(word: &str) -> Found<Occlusion> {
    choose("occluded", word, &OCCLUSIONS)
}

/// The word for what is occluded.
#[must_use]
pub fn of_occluded(occlusion: Occlusion) -> &'static str {
    word_of(&OCCLUSIONS, occlusion)
}

const LEVELS: [(&str, LevelRule); 2] =
    [("covering", LevelRule::Covering), ("published", LevelRule::Published)];

/// `covering` or `published`: the level at which a centre stays.
///
/// # Errors
/// The words there are.
pub fn levels(word: &str) -> Found<LevelRule> {
    choose("levels", word, &LEVELS)
}

/// The word for a rule of levels.
#[must_use]
pub fn of_levels(rule: LevelRule) -> &'static str {
    word_of(&LEVELS, rule)
}

/// `none`, `add` or `enlarge`.
///
/// # Errors
/// The words there are.
pub fn extension(word: &str) -> Found<ExtensionChoice> {
    let words = [
        ("none", ExtensionChoice::None),
        ("add", ExtensionChoice::Add),
        ("enlarge", ExtensionChoice::Enlarge),
    ];
    choose("extend", word, &words)
}

/// `f32` or `f64`.
///
/// # Errors
/// The words there are.
pub fn number(word: &str) -> Found<Number> {
    choose("number", word, &[("f32", Number::F32), ("f64", Number::F64)])
}

/// The word for a number type.
#[must_use]
pub fn of_number(number: Number) -> &'static str {
    match number {
        Number::F32 => "f32",
        Number::F64 => "f64",
    }
}

/// `sky`, or else the name of a file.
#[must_use]
pub fn environment(text: &str) -> EnvironmentChoice {
    match text {
        "sky" => EnvironmentChoice::Sky,
        file => EnvironmentChoice::File(file.into()),
    }
}

/// A depth: `0.25` in world units, `1.5r` in median radii; `inf` and `infr` are numbers too.
///
/// # Errors
/// What such a text looks like.
pub fn epsilon(text: &str) -> Found<Epsilon> {
    let (number, in_radii) = match text.strip_suffix('r') {
        Some(number) => (number, true),
        None => (text, false),
    };
    let value: f32 = number.trim().parse().map_err(|_| {
        format!(
            "epsilon `{text}`; give world units such as 0.25, median radii such as 1.5r, or inf"
        )
    })?;
    Ok(if in_radii { Epsilon::MedianRadii(value) } else { Epsilon::World(value) })
}

/// The text for a depth; [`epsilon`] reads it back exactly.
#[must_use]
pub fn of_epsilon(epsilon: Epsilon) -> String {
    match epsilon {
        Epsilon::World(value) => format!("{value:?}"),
        Epsilon::MedianRadii(value) => format!("{value:?}r"),
    }
}

/// The word of a value; every value has one.
fn word_of<T: Copy + PartialEq>(words: &[(&'static str, T)], value: T) -> &'static str {
    words.iter().find(|(_, of)| *of == value).map_or("", |(word, _)| word)
}

/// The value of a word.
fn choose<T: Copy>(what: &str, word: &str, words: &[(&str, T)]) -> Found<T> {
    let found = words.iter().find(|(of, _)| *of == word).map(|(_, value)| *value);
    found.ok_or_else(|| {
        let known: Vec<&str> = words.iter().map(|(of, _)| *of).collect();
        format!("{what} `{word}`; give one of {}", known.join(", "))
    })
}
