//! The array of an NPY file: its header, and where its numbers are.

use crate::frame::Image;
use crate::frame::image::Values;
use crate::io::Reason;
use exr::prelude::f16;

/// The types of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

/// The contents of a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Array {
    kind: Kind,
    /// Bytes of an element.
    size: usize,
    big_endian: bool,
    pub(super) height: u32,
    pub(super) width: u32,
    /// Numbers a pixel: 1 or 3.
    components: usize,
    /// How many elements lie between two rows, two columns and two components.
    strides: [u64; 3],
}

impl Array {
    /// Parses the dictionary: `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }`, with
    /// the keys in any order.
    pub(super) fn parse(text: &str) -> Reason<Self> {
        let dictionary = text.trim().strip_prefix('{').and_then(|t| t.strip_suffix('}'));
        let dictionary = dictionary.ok_or("header: not a dictionary; write it with numpy.save")?;
        let (big_endian, kind, size) = element(value(dictionary, "descr")?)?;
        let is_fortran = match value(dictionary, "fortran_order")? {
            "False" => false,
            "True" => true,
            other => return Err(format!("header: fortran_order is {other}, not True or False")),
        };
        let shape = value(dictionary, "shape")?;
        let sides = shape.trim_matches(['(', ')']).split(',').map(str::trim);
        let sides: Option<Vec<u32>> =
            sides.filter(|s| !s.is_empty()).map(|s| s.parse().ok()).collect();
        // Which side holds the rows, the columns and the components.
        let found =
            sides.as_deref().filter(|sides| !sides.contains(&0)).and_then(|sides| match *sides {
                [_, _] => Some((sides, [0, 1, 2])),
                [_, _, 1 | 3] => Some((sides, [0, 1, 2])),
                [1 | 3, _, _] => Some((sides, [1, 2, 0])),
                [1, _, _, 1 | 3] => Some((sides, [1, 2, 3])),
                [1, 1 | 3, _, _] => Some((sides, [2, 3, 1])),
                _ => None,
            });
        let Some((sides, axes)) = found else {
            return Err(format!(
                "header: the shape {shape}; save (height, width), (height, width, 1 or 3) or (1 or \
                 3, height, width), with at least one pixel"
            ));
        };
        let side = |axis: usize| sides.get(axis).copied().unwrap_or(1);
        let stride = |axis: usize| {
            let inner = if is_fortran { 0..axis.min(sides.len()) } else { axis + 1..sides.len() };
            sides.get(inner).unwrap_or_default().iter().map(|&side| u64::from(side))
        };
        // A product that is too large belongs to an array that `fits` refuses.
        let strides = axes.map(|axis| stride(axis).fold(1, u64::saturating_mul));
        let [height, width, components] = axes.map(side);
        let components = components as usize;
        Ok(Self { kind, size, big_endian, height, width, components, strides })
    }

    /// Whether the elements are `float16`.
    pub(super) fn is_half(&self) -> bool {
        (self.kind, self.size) == (Kind::Float, 2)
    }

    /// How many bytes the array has.
    pub(super) fn bytes(&self) -> u64 {
        let pixels = u64::from(self.height) * u64::from(self.width);
        pixels.saturating_mul((self.size * self.components) as u64)
    }

    /// Checks that exactly as many bytes follow.
    pub(super) fn fits(&self, rest: u64) -> Reason<()> {
        let (Self { width, height, .. }, bytes) = (self, self.bytes());
        if bytes == rest {
            return Ok(());
        }
        Err(format!(
            "header: declares {width} x {height} pixels in {bytes} bytes, but {rest} follow; write \
             it again"
        ))
    }

    /// Converts the bytes, which have the right length, to planes.
    pub(super) fn image(&self, bytes: &[u8], name: &str) -> Reason<Image> {
        let mut channels = Vec::new();
        for (component, name) in self.names(name).into_iter().enumerate() {
            channels.push((name, self.component(bytes, component)?));
        }
        channels.sort_by(|a: &(String, Values), b| a.0.cmp(&b.0));
        Ok(Image { width: self.width, height: self.height, channels, text: None })
    }

    /// One component of each pixel.
    fn component(&self, bytes: &[u8], component: usize) -> Reason<Values> {
        let [down, right, deep] = self.strides;
        let rows = 0..u64::from(self.height);
        let places = rows.flat_map(|row| {
            let first = row * down + component as u64 * deep;
            (0..u64::from(self.width)).map(move |column| first + column * right)
        });
        let numbers = places.map(|place| self.bits(&bytes[place as usize * self.size..]));
        if self.kind == Kind::Float {
            let float = |bits: u64| match self.size {
                2 => f16::from_bits(bits as u16).to_f32(),
                4 => f32::from_bits(bits as u32),
                _ => f64::from_bits(bits) as f32,
            };
            return Ok(Values::Float(numbers.map(float).collect()));
        }
        numbers.map(|bits| self.index(bits)).collect::<Reason<_>>().map(Values::Index)
    }

    /// The bits of the first element of some bytes.
    fn bits(&self, bytes: &[u8]) -> u64 {
        let element = bytes[..self.size].iter();
        let append = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
        if self.big_endian { element.fold(0, append) } else { element.rev().fold(0, append) }
    }

    /// An index of 32 bits.
    fn index(&self, bits: u64) -> Reason<u32> {
        let refused = |number: String| {
            Err(format!("{number} is no index; give -1 (none), or 0 to {}", u32::MAX))
        };
        match (self.kind, self.size) {
            (_, 4) => Ok(bits as u32),
            (Kind::Signed, _) => {
                let unused = 64 - 8 * self.size;
                match (bits << unused).cast_signed() >> unused {
                    -1 => Ok(crate::frame::NO_ID),
                    number => u32::try_from(number).or_else(|_| refused(number.to_string())),
                }
            }
            _ => u32::try_from(bits).or_else(|_| refused(bits.to_string())),
        }
    }

    /// The names of the channels.
    fn names(&self, name: &str) -> Vec<String> {
        if self.components == 1 {
            return vec![name.to_owned()];
        }
        match (name, name.strip_suffix(".RGB")) {
            ("RGB", _) => ["R", "G", "B"].map(str::to_owned).to_vec(),
            (_, Some(layer)) => ["R", "G", "B"].map(|c| format!("{layer}.{c}")).to_vec(),
            _ => ["X", "Y", "Z"].map(|c| format!("{name}.{c}")).to_vec(),
        }
    }
}

/// The byte order, the kind and the size of an element.
fn element(descr: &str) -> Reason<(bool, Kind, usize)> {
    let descr = descr.trim_matches(['\'', '"']);
    let (order, kind) = descr.split_at_checked(1).unwrap_or_default();
    let kind = match kind {
        "f2" | "f4" | "f8" => Some(Kind::Float),
        "i1" | "i2" | "i4" | "i8" => Some(Kind::Signed),
        "b1" | "u1" | "u2" | "u4" | "u8" => Some(Kind::Unsigned),
        _ => None,
    };
    let size = descr.get(2..).and_then(|size| size.parse().ok());
    match (order, kind, size) {
        ("<" | "|" | ">", Some(kind), Some(size)) => Ok((order == ">", kind, size)),
        _ => Err(format!(
            "header: elements `{descr}`; save as float16, float32, float64, bool, or integers of 8 \
             to 64 bits"
        )),
    }
}

/// The text of a value in a dictionary that nests only parentheses.
fn value<'a>(dictionary: &'a str, key: &str) -> Reason<&'a str> {
    let quoted = [format!("'{key}'"), format!("\"{key}\"")];
    let start = quoted.iter().find_map(|quoted| {
        dictionary.find(quoted.as_str()).map(|at| &dictionary[at + quoted.len()..])
    });
    let missing = || format!("header: no `{key}`; write it with numpy.save");
    let text = start.and_then(|rest| rest.trim_start().strip_prefix(':')).ok_or_else(missing)?;
    let text = text.trim_start();
    let end =
        if text.starts_with('(') { text.find(')').map(|end| end + 1) } else { text.find(',') };
    Ok(text[..end.unwrap_or(text.len())].trim())
}
