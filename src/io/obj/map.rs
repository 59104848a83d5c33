//! Read the options of `map_Kd`.
//!
//! | option | arguments | what the reader does |
//! |---|---|---|
//! | `-s u v w`, `-o u v w` | 1 to 3 numbers; v and w may be missing | u' = u s.u + o.u and v' = v s.v + o.v, each in f64 and rounded to f32 once; w is skipped |
//! | `-blendu`, `-blendv`, `-clamp`, `-cc` | `on` or `off` | `on`, `on`, `off` and `off` are what it does |
//! | `-mm base gain` | 2 numbers | 0 1 is what it does |
//! | `-t u v w` | 1 to 3 numbers | 0 is what it does |
//! | `-bm`, `-boost`, `-texres`, `-imfchan`, `-type`, `-colorspace` | 1 word | not read |
//! | any other word that begins with `-` | 1 word | not read |
//!
//! A warning names an option with another value, and an option that is not read. The name of the
//! file follows the options and reaches to the end of the line. If the options leave no name, the
//! whole text is the name.

use glam::Vec2;

/// A texture of a material.
#[derive(Debug, PartialEq)]
pub(super) struct Map {
    pub(super) name: String,
    scale: [f64; 2],
    offset: [f64; 2],
    /// The options that are not read, as they stand.
    pub(super) ignored: Vec<String>,
}

impl Map {
    /// Parses the text after `map_Kd`, which is not empty.
    pub(super) fn parse(text: &str) -> Self {
        let whole =
            Self { name: text.to_owned(), scale: [1.0; 2], offset: [0.0; 2], ignored: Vec::new() };
        let mut map = Self { ignored: Vec::new(), name: String::new(), ..whole };
        let mut rest = text;
        while rest.starts_with('-') {
            let (option, mut after) = super::lines::statement(rest);
            let mut arguments = Vec::new();
            while arguments.len() < most_arguments(option) {
                let (word, next) = super::lines::statement(after);
                // The last word is the name of the file, and not an argument.
                let is_argument = match option {
                    "-s" | "-o" | "-t" => word.parse::<f64>().is_ok_and(f64::is_finite),
                    _ => !word.starts_with('-') || word.parse::<f64>().is_ok(),
                };
                if next.is_empty() || !is_argument {
                    break;
                }
                arguments.push(word);
                after = next;
            }
            map.set(option, &arguments);
            rest = after;
        }
        if rest.is_empty() {
            return Self { name: text.to_owned(), ..map };
        }
        Self { name: rest.to_owned(), ..map }
    }

    fn set(&mut self, option: &str, arguments: &[&str]) {
        let number = |i: usize| arguments.get(i).and_then(|word| word.parse::<f64>().ok());
        let is_default = match option {
            "-s" | "-o" => {
                let (to, default) =
                    if option == "-s" { (&mut self.scale, 1.0) } else { (&mut self.offset, 0.0) };
                *to = [0, 1].map(|i| number(i).unwrap_or(default));
                !arguments.is_empty()
            }
            "-blendu" | "-blendv" => arguments == ["on"],
            "-clamp" | "-cc" => arguments == ["off"],
            "-mm" => (number(0), number(1)) == (Some(0.0), Some(1.0)),
            "-t" => !arguments.is_empty() && (0..3).all(|i| number(i).is_none_or(|v| v == 0.0)),
            _ => false,
        };
        if !is_default {
            let words = std::iter::once(&option).chain(arguments);
            self.ignored
                .push(words.map(|word| super::lines::shown(word)).collect::<Vec<_>>().join(" "));
        }
    }

    /// Texture coordinates of a file at this texture.
    pub(super) fn place(&self, at: Vec2) -> Vec2 {
        if (self.scale, self.offset) == ([1.0; 2], [0.0; 2]) {
            return at;
        }
        let one = |value: f32, i: usize| (f64::from(value) * self.scale[i] + self.offset[i]) as f32;
        Vec2::new(one(at.x, 0), one(at.y, 1))
    }
}

/// How many arguments an option has at most.
fn most_arguments(option: &str) -> usize {
    match option {
        "-s" | "-o" | "-t" => 3,
        "-mm" => 2,
        _ => 1,
    }
}
