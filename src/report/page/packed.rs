//! Planes as compressed bytes, within a limit.
//!
//! The 32 bits of a value are four bytes, the highest first. A channel is stored as four planes of
//! such bytes, because the highest bytes of neighbours are alike. The second picture is stored as
//! the bits in which it differs from the first, which are few where both are nearly equal. Every
//! plane of bytes is deflated and written as base64. Equal planes are stored once.
//!
//! If not everything fits, the low bytes of floats are left out, tab after tab: first everywhere
//! except at wrong and listed pixels, then there too. A channel of which not even the high bytes
//! fit is left out.

use super::{Mark, Report, Tab};
use crate::frame::Exec;
use crate::frame::image::{Image, Values};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec_zlib;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// How hard to compress: the highest bytes are worth it, the lowest are noise.
const LEVEL: [u8; 4] = [6, 6, 1, 1];
/// How many of the wrong pixels keep every bit, when not all pixels can.
const EXACT: usize = 20_000;
/// The bits of +inf, above those of all positive numbers.
const INFINITY: u32 = f32::INFINITY.to_bits();
/// What the element around a plane of bytes takes in the page.
const ELEMENT: usize = 80;

/// Everything of a report that has a value for each pixel.
pub(super) struct Packed {
    /// The planes of bytes, as deflated.
    store: Vec<Vec<u8>>,
    /// The pixels that are exact even where others are not, as bits of bytes.
    pub(super) exact: Option<usize>,
    /// Whether the errors of other pixels are rounded.
    pub(super) rounded: bool,
    /// By name.
    pub(super) channels: BTreeMap<String, Channel>,
    pub(super) tabs: Vec<TabPlanes>,
}

/// Where the values of a channel are.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Channel {
    /// Whether each picture has floats; none if it lacks the channel.
    pub(super) float: [Option<bool>; 2],
    /// The planes of bytes of each picture, the highest bytes first.
    pub(super) bytes: [Vec<usize>; 2],
    /// The number of bytes that are there for every pixel; 0 if the channel did not fit.
    pub(super) digits: usize,
}

/// Where the planes of a tab are.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct TabPlanes {
    pub(super) errors: Channel,
    pub(super) wrong: Option<usize>,
    pub(super) doubts: Option<usize>,
}

/// The planes of small numbers of a tab.
struct Marks {
    wrong: Option<usize>,
    doubts: Option<usize>,
}

/// The bits of a channel in both pictures.
struct Bits {
    float: [Option<bool>; 2],
    /// The second as the difference from the first.
    bits: [Vec<u32>; 2],
}

/// The compressed planes of bytes of one channel.
struct Variants {
    float: [Option<bool>; 2],
    /// Of each picture, by byte.
    full: [Vec<usize>; 2],
    /// The third and fourth byte where other pixels than the exact ones are 0.
    masked: [Vec<usize>; 2],
}

/// Compressed bytes by their content.
#[derive(Default)]
struct Store {
    all: Vec<Vec<u8>>,
    known: BTreeMap<Vec<u8>, usize>,
}

impl Store {
    fn add(&mut self, bytes: Vec<u8>) -> usize {
        let next = self.all.len();
        let place = *self.known.entry(bytes.clone()).or_insert(next);
        if place == next {
            self.all.push(bytes);
        }
        place
    }

    /// The bytes that a plane takes in the page.
    fn size(&self, place: usize) -> usize {
        self.all[place].len().div_ceil(3) * 4 + ELEMENT
    }
}

/// What has been chosen, and how much room is left.
struct Room<'s> {
    store: &'s Store,
    taken: BTreeSet<usize>,
    left: usize,
}

impl Room<'_> {
    /// Takes these planes if all of them fit.
    fn take(&mut self, wanted: &[usize]) -> bool {
        let new: BTreeSet<usize> =
            wanted.iter().copied().filter(|place| !self.taken.contains(place)).collect();
        let size: usize = new.iter().map(|&place| self.store.size(place)).sum();
        let fits = size <= self.left;
        if fits {
            self.left -= size;
            self.taken.extend(new);
        }
        fits
    }
}

impl Packed {
    /// A packing without any plane, to measure the rest of the page.
    pub(super) fn none(report: &Report) -> Self {
        let channels = names(report).into_iter().map(|name| (name, Channel::default()));
        let tabs = report.tabs.iter().map(|_| TabPlanes::default());
        let (channels, tabs) = (channels.collect(), tabs.collect());
        Self { store: Vec::new(), exact: None, rounded: false, channels, tabs }
    }

    /// Packs as much as fits in this many bytes of the page.
    pub(super) fn new(report: &Report, bytes: usize, exec: &Exec) -> Self {
        let mut store = Store::default();
        let mask = exact(report);
        let exact = store.add(packed(&mask, LEVEL[0]));
        let marks: Vec<_> = report.tabs.iter().map(|tab| Marks::new(tab, &mut store)).collect();
        let names = names(report);
        let mut variants = |bits: Bits| bits.variants(&mask, &mut store, exec);
        let channels: Vec<Variants> =
            names.iter().map(|name| variants(Bits::of_channel(report, name))).collect();
        let errors = [None, Some(&mask)].map(|mask| -> Vec<Variants> {
            report.tabs.iter().map(|tab| variants(Bits::of_errors(tab, mask))).collect()
        });
        let mut packed = Self::none(report);
        for (errors, rounded) in errors.iter().zip([false, true]) {
            let mut room = Room { store: &store, taken: BTreeSet::new(), left: bytes };
            room.take(&[exact]);
            let marks: Vec<Marks> = marks.iter().map(|marks| marks.fitting(&mut room)).collect();
            let all: Vec<&Variants> = errors.iter().chain(&channels).collect();
            let mut chosen = chosen(&all, errors.len(), &mut room).into_iter();
            let tabs = marks.into_iter().zip(&mut chosen);
            let tabs =
                tabs.map(|(Marks { wrong, doubts }, errors)| TabPlanes { errors, wrong, doubts });
            packed.tabs = tabs.collect();
            packed.channels = names.iter().cloned().zip(chosen).collect();
            packed.rounded = rounded;
            if packed.channels.values().all(|channel| channel.digits == 4) {
                break;
            }
        }
        Self { store: store.all, exact: Some(exact), ..packed }
    }

    /// The elements of the page that hold the planes.
    pub(super) fn blobs(&self) -> String {
        let channels = self.channels.values().chain(self.tabs.iter().map(|tab| &tab.errors));
        let mut used: BTreeSet<usize> =
            channels.flat_map(|channel| channel.bytes.iter().flatten().copied()).collect();
        used.extend(self.exact);
        used.extend(self.tabs.iter().flat_map(|tab| [tab.wrong, tab.doubts]).flatten());
        let mut out = String::new();
        for place in used {
            let bytes = STANDARD.encode(&self.store[place]);
            let kind = "application/octet-stream";
            let _ = writeln!(out, "<script type=\"{kind}\" id=\"b{place}\">{bytes}</script>");
        }
        out
    }
}

impl Marks {
    fn new(tab: &Tab, store: &mut Store) -> Self {
        let wrong: Vec<u8> = tab.wrong.iter().map(|&wrong| u8::from(wrong)).collect();
        let mut add =
            |bytes: &[u8]| (!bytes.is_empty()).then(|| store.add(packed(bytes, LEVEL[0])));
        Self { wrong: add(&wrong), doubts: add(&tab.doubts) }
    }

    fn fitting(&self, room: &mut Room<'_>) -> Self {
        let mut fits = |place: Option<usize>| place.filter(|&place| room.take(&[place]));
        Self { wrong: fits(self.wrong), doubts: fits(self.doubts) }
    }
}

/// Decides for each channel which bytes are in the page; the first `errors` channels are errors.
/// The high bytes of all channels come before the low bytes of any, and the low bytes of errors
/// come last.
fn chosen(variants: &[&Variants], errors: usize, room: &mut Room<'_>) -> Vec<Channel> {
    let of = |variants: &&Variants| Channel { float: variants.float, ..Channel::default() };
    let mut chosen: Vec<Channel> = variants.iter().map(of).collect();
    let mut choose = |chosen: &mut Channel, planes: [Vec<usize>; 2], digits: usize| {
        if room.take(&planes.concat()) {
            chosen.bytes = planes;
            chosen.digits = digits;
        }
    };
    for (chosen, variants) in chosen.iter_mut().zip(variants) {
        // An index without its low bytes is another index.
        let digits = if variants.is_float() { 2 } else { 4 };
        choose(chosen, variants.high(digits), digits);
    }
    let order = (errors..variants.len()).chain(0..errors);
    for digits in [2, 3, 4] {
        for i in order.clone() {
            let there = chosen[i].digits;
            if (digits - 1..4).contains(&there) {
                choose(&mut chosen[i], variants[i].with(digits), digits);
            }
        }
    }
    chosen
}

impl Variants {
    fn is_float(&self) -> bool {
        is_float(self.float)
    }

    /// The planes of the highest bytes.
    fn high(&self, digits: usize) -> [Vec<usize>; 2] {
        [0, 1].map(|side| self.full[side].iter().take(digits).copied().collect())
    }

    /// All four planes, where only so many are there for every pixel.
    fn with(&self, digits: usize) -> [Vec<usize>; 2] {
        [0, 1].map(|side| {
            let low = self.masked[side].iter().skip(digits - 2);
            self.full[side].iter().take(digits).chain(low).copied().collect()
        })
    }
}

impl Bits {
    /// The errors of a tab. With a mask, other errors are rounded to three bits after the leading
    /// one, because their digits are noise that takes as much room as those of a plane.
    fn of_errors(tab: &Tab, mask: Option<&Vec<u8>>) -> Self {
        let rounded =
            |bits: u32| if bits < INFINITY { (bits + 0x8_0000) & 0xfff0_0000 } else { bits };
        let of = |(i, error): (usize, &f32)| match mask {
            Some(mask) if mask[i] == 0 => rounded(error.to_bits()),
            _ => error.to_bits(),
        };
        let bits = tab.errors.iter().enumerate().map(of).collect();
        Self { float: [Some(true), None], bits: [bits, Vec::new()] }
    }

    /// A channel of both pictures.
    fn of_channel(report: &Report, name: &str) -> Self {
        let [first, second] = [0, 1].map(|side| bits(&report.pictures[side], name));
        let float = [&first, &second].map(|bits| bits.as_ref().map(|(float, _)| *float));
        let [first, mut second] = [first, second].map(|bits| bits.unwrap_or_default().1);
        second.iter_mut().zip(&first).for_each(|(bits, &other)| *bits ^= other);
        Self { float, bits: [first, second] }
    }

    /// Compresses every plane of bytes.
    fn variants(&self, mask: &[u8], store: &mut Store, exec: &Exec) -> Variants {
        let mut jobs: Vec<(usize, usize, bool)> = Vec::new();
        for side in (0..2).filter(|&side| !self.bits[side].is_empty()) {
            jobs.extend((0..4).map(|byte| (side, byte, false)));
            if is_float(self.float) {
                jobs.extend((2..4).map(|byte| (side, byte, true)));
            }
        }
        let done = exec.ordered(jobs.clone(), |(side, byte, masked)| {
            let of = |(&bits, &exact): (&u32, &u8)| {
                if masked && exact == 0 { 0 } else { bits.to_be_bytes()[byte] }
            };
            let bytes: Vec<u8> = self.bits[side].iter().zip(mask).map(of).collect();
            packed(&bytes, LEVEL[byte])
        });
        let (full, masked) = Default::default();
        let mut variants = Variants { float: self.float, full, masked };
        for ((side, _, masked), bytes) in jobs.into_iter().zip(done) {
            let planes = if masked { &mut variants.masked } else { &mut variants.full };
            planes[side].push(store.add(bytes));
        }
        variants
    }
}

/// Whether all pictures that have a channel have floats.
fn is_float(float: [Option<bool>; 2]) -> bool {
    float.into_iter().flatten().all(|float| float)
}

/// The bits of a channel, and whether they are floats. A NaN has its quiet bit, so that it stays
/// one without its low bytes.
fn bits(picture: &Image, name: &str) -> Option<(bool, Vec<u32>)> {
    let of = |v: &f32| if v.is_nan() { v.to_bits() | 0x0040_0000 } else { v.to_bits() };
    match picture.channel(name)? {
        Values::Float(values) => Some((true, values.iter().map(of).collect())),
        Values::Index(values) => Some((false, values.clone())),
    }
}

/// The names of all channels, in the order in which they get room: the first wrong tab, the last
/// tab, which is the picture, then the others.
fn names(report: &Report) -> Vec<String> {
    let wrong = report.tabs.iter().find(|tab| tab.mark == Mark::Wrong);
    let mut names: Vec<String> = Vec::new();
    for tab in wrong.into_iter().chain(report.tabs.last()).chain(&report.tabs) {
        for name in tab.planes.iter().flat_map(|plane| &plane.channels) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
    }
    names
}

/// The pixels that keep every bit: 1 where a pixel is listed, and at the first wrong pixels and
/// their neighbours.
fn exact(report: &Report) -> Vec<u8> {
    let [picture, _] = &report.pictures;
    let [width, height] = [picture.width as usize, picture.height as usize];
    let mut mask = vec![0; width * height];
    let wrong = |i: &usize| report.tabs.iter().any(|tab| tab.wrong.get(*i) == Some(&true));
    let wrong = (0..mask.len()).filter(wrong).take(EXACT);
    let listed = report.tabs.iter().flat_map(|tab| tab.worst.iter().copied());
    for i in wrong.chain(listed) {
        let (x, y) = (i % width, i / width);
        for row in y.saturating_sub(1)..(y + 2).min(height) {
            let from = row * width;
            mask[from + x.saturating_sub(1)..from + (x + 2).min(width)].fill(1);
        }
    }
    mask
}

/// The differences from byte to byte, deflated.
fn packed(bytes: &[u8], level: u8) -> Vec<u8> {
    let before = std::iter::once(&0).chain(bytes);
    let differences: Vec<u8> =
        bytes.iter().zip(before).map(|(byte, before)| byte.wrapping_sub(*before)).collect();
    compress_to_vec_zlib(&differences, level)
}
