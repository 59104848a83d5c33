//! The average of up to four cells.

use super::Client;
use super::bug::Bug;
use crate::verify::client::number::{Number, Vector};

/// The cells that take part, and their weights.
pub(super) struct Mean<'a> {
    client: &'a Client<'a>,
    weights: [Option<Number>; 4],
    inverse: Number,
}

impl<'a> Mean<'a> {
    pub(super) fn new(client: &'a Client<'a>, weights: [Option<Number>; 4]) -> Self {
        let total = client.in_pairs(weights.map(|weight| weight.unwrap_or(client.zero())));
        let inverse = match client.how.bug {
            Some(Bug::AverageOfFour) => client.number(0.25),
            _ => total.reciprocal(),
        };
        Self { client, weights, inverse }
    }

    /// The average of a number; plus 0, so that there is no -0.
    pub(super) fn of(&self, numbers: [Number; 4]) -> Number {
        let part = |j: usize| self.weights[j].map_or(self.client.zero(), |w| w * numbers[j]);
        let average = self.client.in_pairs([part(0), part(1), part(2), part(3)]) * self.inverse;
        let (least, greatest) = (self.least(numbers), self.greatest(numbers));
        let bounded = match self.client.how.bug {
            Some(Bug::AverageOfFour | Bug::AverageUnbounded) => average,
            _ => average.clamped(least, greatest),
        };
        bounded + self.client.zero()
    }

    /// The average of three numbers.
    pub(super) fn vector(&self, vectors: [Vector; 4]) -> Vector {
        [0, 1, 2].map(|i| self.of(vectors.map(|vector| vector[i])))
    }

    pub(super) fn least(&self, numbers: [Number; 4]) -> Number {
        let none = self.client.number(f32::INFINITY);
        self.taking().fold(none, |least, j| least.smaller(numbers[j]))
    }

    pub(super) fn greatest(&self, numbers: [Number; 4]) -> Number {
        let none = self.client.number(f32::NEG_INFINITY);
        self.taking().fold(none, |greatest, j| greatest.larger(numbers[j]))
    }

    fn taking(&self) -> impl Iterator<Item = usize> {
        (0..4).filter(|&j| self.weights[j].is_some())
    }
}
