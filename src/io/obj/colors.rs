//! Read the colours of vertices, which follow their positions in lines `v`.

use crate::io::Reason;
use crate::number::srgb;
use glam::Vec3;

/// The numbers after the positions.
#[derive(Default)]
pub(super) struct Colors {
    /// Three or four numbers for each vertex; NaN stands for a number that is missing.
    numbers: Vec<[f64; 4]>,
    /// How many vertices have three or four numbers.
    given: usize,
    /// How many vertices have four numbers, and how many of these begin with 1.
    four: usize,
    weights: usize,
}

/// The colours of all vertices, the opacities if there are any, and what the reader chose.
pub(super) type Read = (Option<Vec<Vec3>>, Option<Vec<f32>>, Vec<String>);

impl Colors {
    /// Takes the numbers after the position of the vertex `before`; `None` if it has no colour.
    pub(super) fn read(&mut self, before: usize, numbers: Option<&[f64]>) -> Reason<()> {
        let Some(numbers) = numbers else { return Ok(()) };
        if let Some(wrong) = numbers.iter().find(|c| !(0.0..=255.0).contains(*c)) {
            let what = "give numbers in [0, 1], or codes from 0 to 255";
            return Err(format!("a colour of {wrong}; {what}"));
        }
        self.numbers.resize(before, [f64::NAN; 4]);
        let four = numbers.get(3).copied();
        self.numbers.push([numbers[0], numbers[1], numbers[2], four.unwrap_or(f64::NAN)]);
        self.given += 1;
        self.four += usize::from(four.is_some());
        self.weights += usize::from(four.is_some() && numbers[0] == 1.0);
        Ok(())
    }

    /// The colours of `count` vertices, in linear light.
    pub(super) fn finish(mut self, count: usize) -> Reason<Read> {
        if self.given == 0 {
            return Ok((None, None, Vec::new()));
        }
        let mut warnings = Vec::new();
        self.numbers.resize(count, [f64::NAN; 4]);
        if self.given < count {
            let missing = count - self.given;
            warnings.push(format!("{missing} of {count} vertices have no colour; they are white"));
        }
        let opacity = self.four > 0 && self.weights < self.four;
        if self.four > 0 {
            let how = if opacity { "x y z r g b opacity" } else { "x y z weight r g b" };
            warnings.push(format!("{} vertices of 7 numbers are read as {how}", self.four));
        }
        if !opacity {
            for numbers in self.numbers.iter_mut().filter(|numbers| !numbers[3].is_nan()) {
                numbers.rotate_left(1);
                numbers[3] = f64::NAN;
            }
        }
        if self.most() > 1.0 {
            self.codes()?;
            warnings.push("colours are read as codes from 0 to 255".into());
        }
        let color = |numbers: &[f64; 4]| match numbers[0].is_nan() {
            true => Vec3::ONE,
            false => {
                let linear = |i: usize| srgb::to_linear(numbers[i]) as f32;
                Vec3::new(linear(0), linear(1), linear(2))
            }
        };
        let of = |numbers: &[f64; 4]| if numbers[3].is_nan() { 1.0 } else { numbers[3] as f32 };
        let opacities = opacity.then(|| self.numbers.iter().map(of).collect::<Vec<f32>>());
        let opacities = opacities.filter(|all| all.iter().any(|&one| one != 1.0));
        Ok((Some(self.numbers.iter().map(color).collect()), opacities, warnings))
    }

    /// The largest number; NaN is smaller than all.
    fn most(&self) -> f64 {
        self.numbers.iter().flatten().fold(0.0, |most, &one| if one > most { one } else { most })
    }

    /// Divides codes of 8 bits by 255.
    fn codes(&mut self) -> Reason<()> {
        for (vertex, numbers) in (1..).zip(&mut self.numbers) {
            if let Some(part) = numbers.iter().find(|one| one.fract() != 0.0 && !one.is_nan()) {
                return Err(format!(
                    "vertex {vertex} has a colour of {part}, and another is above 1; give numbers \
                     in [0, 1], or codes from 0 to 255"
                ));
            }
            *numbers = numbers.map(|one| one / 255.0);
        }
        Ok(())
    }
}
