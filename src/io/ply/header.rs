//! Parse the header of a PLY file: which elements the body holds, in which order and of which
//! types.

use glam::DVec3;
use std::collections::BTreeSet;

/// How numbers are stored in the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    Little,
    Big,
}

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(name: &str, line: u64) -> Result<Self, String> {
        match name {
            "char" | "int8" => Ok(Self::I8),
            "uchar" | "uint8" => Ok(Self::U8),
            "short" | "int16" => Ok(Self::I16),
            "ushort" | "uint16" => Ok(Self::U16),
            "int" | "int32" => Ok(Self::I32),
            "uint" | "uint32" => Ok(Self::U32),
            "float" | "float32" => Ok(Self::F32),
            "double" | "float64" => Ok(Self::F64),
            _ => Err(format!(
                "line {line}: unknown type {}; the types are char, uchar, short, ushort, int, \
                 uint, float, double",
                quote(name)
            )),
        }
    }

    /// The type's name in the description of the format.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    /// How many bytes it takes in a binary body.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// One number, or a list that begins with its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PropertyKind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// The count that the header claims; it may be false.
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct PlyHeader {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// The names in lines `comment TextureFile NAME`, each once.
    pub(super) textures: Vec<String>,
    /// What a line `comment splatref offset X Y Z` says was subtracted from positions.
    pub(super) offset: Option<DVec3>,
    /// Where the body starts, in bytes.
    pub(super) body: usize,
    /// The line that the body starts on, counted from 1.
    pub(super) line: u64,
}

/// Reads the header of a file.
pub(super) fn parse(bytes: &[u8]) -> Result<PlyHeader, String> {
    let mut lines = Lines { bytes, at: 0, number: 0 };
    if lines.next().as_deref() != Some("ply") {
        return Err("line 1: not a PLY file: the first line must be `ply`".into());
    }
    let (mut format, mut offset) = (None, None);
    let (mut elements, mut textures) = (Vec::new(), Vec::new());
    let mut names = BTreeSet::new();
    loop {
        let Some(text) = lines.next() else {
            let what = "the header has no end_header: the file is truncated, or not a PLY file";
            return Err(format!("line {}: {what}", lines.number));
        };
        let line = lines.number;
        // A header line has at most five words; a comment may have more.
        let words: Vec<&str> = text.split_ascii_whitespace().take(6).collect();
        match words[..] {
            ["end_header"] => break,
            ["comment", "TextureFile", _, ..] => {
                // A name may contain blanks.
                let name = text.split_once("TextureFile").map_or("", |(_, name)| name.trim());
                if !textures.iter().any(|known| known == name) {
                    textures.push(name.to_owned());
                }
            }
            ["comment", "splatref", "offset", x, y, z] => {
                let number =
                    |word: &str| word.parse::<f64>().ok().filter(|value| value.is_finite());
                if let (Some(x), Some(y), Some(z)) = (number(x), number(y), number(z)) {
                    offset = Some(DVec3::new(x, y, z));
                }
            }
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, version] => {
                if format.replace(parse_format(name, version, line)?).is_some() {
                    return Err(format!("line {line}: the format is given twice; keep one"));
                }
            }
            ["element", name, count] => {
                elements.push(parse_element(name, count, line)?);
                unique(&mut names, name.to_owned(), None, line)?;
            }
            ["property", ref rest @ ..] => {
                let property = parse_property(rest, &text, line)?;
                let Some(element) = elements.last_mut() else {
                    let what = "a property before the first element; declare the element first";
                    return Err(format!("line {line}: {what}"));
                };
                unique(&mut names, element.name.clone(), Some(property.name.clone()), line)?;
                element.properties.push(property);
            }
            _ => return Err(unknown_line(&text, line)),
        }
    }
    let format = format.ok_or_else(|| {
        format!("line {}: no format line; add `format ascii 1.0` or a binary one", lines.number)
    })?;
    Ok(PlyHeader { format, elements, textures, offset, body: lines.at, line: lines.number + 1 })
}

fn unknown_line(text: &str, line: u64) -> String {
    format!(
        "line {line}: {} is not a line of a PLY header, which has format, comment, obj_info, \
         element NAME COUNT, property TYPE NAME, property list TYPE TYPE NAME, end_header",
        quote(text)
    )
}

fn parse_format(name: &str, version: &str, line: u64) -> Result<Format, String> {
    let format = match name {
        "ascii" => Format::Ascii,
        "binary_little_endian" => Format::Little,
        "binary_big_endian" => Format::Big,
        _ => {
            return Err(format!(
                "line {line}: unknown format {}; it must be ascii, binary_little_endian or \
                 binary_big_endian",
                quote(name)
            ));
        }
    };
    if version != "1.0" {
        return Err(format!(
            "line {line}: unknown format version {}; only 1.0 is read",
            quote(version)
        ));
    }
    Ok(format)
}

fn parse_element(name: &str, count: &str, line: u64) -> Result<Element, String> {
    let count = count.parse().map_err(|_| {
        let count = quote(count);
        format!("line {line}: element {}: {count} is not a count below 2^64", quote(name))
    })?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new() })
}

/// Parses the words after `property`; `text` is the whole line.
fn parse_property(words: &[&str], text: &str, line: u64) -> Result<Property, String> {
    let (kind, name) = match *words {
        ["list", count, item, name] => {
            let (count, item) = (Scalar::parse(count, line)?, Scalar::parse(item, line)?);
            if !count.is_integer() {
                let what = format!("counts its list in {}; use uchar or int", count.name());
                return Err(format!("line {line}: property {} {what}", quote(name)));
            }
            (PropertyKind::List { count, item }, name)
        }
        [kind, name] => (PropertyKind::One(Scalar::parse(kind, line)?), name),
        _ => return Err(unknown_line(text, line)),
    };
    Ok(Property { name: name.to_owned(), kind })
}

/// Notes the name of an element, or of a property with its element, and refuses it if it is known.
fn unique(
    names: &mut BTreeSet<(String, Option<String>)>,
    element: String,
    property: Option<String>,
    line: u64,
) -> Result<(), String> {
    let what = match &property {
        Some(property) => format!("property {} of element {}", quote(property), quote(&element)),
        None => format!("element {}", quote(&element)),
    };
    if names.insert((element, property)) {
        return Ok(());
    }
    Err(format!("line {line}: {what} is declared twice; rename or remove one"))
}

/// The lines of a header. Bytes that are not UTF-8 are replaced; only comments may hold them.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u64,
}

impl<'a> Lines<'a> {
    /// The next line without its LF or CR LF; `None` at the end of the file.
    fn next(&mut self) -> Option<std::borrow::Cow<'a, str>> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&b| b == b'\n');
        let line = &rest[..end.unwrap_or(rest.len())];
        self.at += end.map_or(rest.len(), |end| end + 1);
        self.number += 1;
        Some(String::from_utf8_lossy(line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// Prepares text of a file for one line of a message: escaped, at most 40 characters.
pub(super) fn quote(text: &str) -> String {
    let mut shown: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if text.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    format!("`{shown}`")
}
