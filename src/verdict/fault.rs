//! Compare one value of a client with the values that are allowed, in words.

use crate::frame::NO_ID;
use std::fmt;

/// The fault at a pixel.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// A number that no correct implementation leaves.
    Value {
        /// The channel.
        channel: String,
        /// The client's number.
        found: f64,
        /// The exact result of the stage.
        truth: f64,
        /// How far a correct implementation may be from the truth.
        radius: f64,
    },
    /// An index or a count that no correct implementation leaves.
    Whole {
        /// The channel.
        channel: String,
        /// The client's value.
        found: u32,
        /// The required value.
        truth: u32,
    },
    /// A surfel is certainly drawn, but has no record.
    NotProjected {
        /// The surfel.
        surfel: u32,
    },
    /// A surfel is certainly not drawn, but has a record.
    Projected {
        /// The surfel.
        surfel: u32,
    },
    /// The normal, opacity or colour of a record differs from its surfel's.
    Copied {
        /// The surfel.
        surfel: u32,
    },
    /// The client's surfel has no fragment at the pixel, or belongs to another group.
    Absent {
        /// The surfel, or the id of the primitive.
        surfel: u32,
    },
    /// The client's surfel has a fragment at the pixel, but the fragment is outside the cut-off.
    Outside {
        /// The surfel.
        surfel: u32,
        /// q of the fragment divided by the limit of q.
        rim: f64,
    },
    /// No fragment has the client's depth.
    NoSuchDepth {
        /// The client's depth.
        found: f64,
        /// The closest depth that a fragment has.
        closest: f64,
    },
    /// Two surfels are equally near, and the client keeps another one than its tie rule says.
    Tie {
        /// The surfel that should be there.
        surfel: u32,
        /// The client's surfel.
        found: u32,
    },
    /// A surfel is certainly in front, but was left out.
    LeftOut {
        /// The surfel, or the id of the primitive.
        surfel: u32,
        /// q of its fragment divided by the limit of q; 0 for a primitive without a rim.
        rim: f64,
        /// Its depth.
        depth: f64,
        /// The client's depth; +inf if the pixel is empty.
        found: f64,
    },
    /// A polygon without an id is certainly in front, but was left out.
    Hidden {
        /// Its depth.
        depth: f64,
        /// The client's depth; +inf if the pixel is empty.
        found: f64,
    },
}

impl Fault {
    /// Replaces the numbers of surfels. A channel that is numbered inside a record keeps its
    /// number.
    pub(crate) fn renumber(&mut self, of: impl Fn(u32) -> u32) {
        let numbers: [Option<&mut u32>; 2] = match self {
            Self::Whole { channel, found, truth } if channel.rsplit('.').next() == Some("id") => {
                [Some(found), Some(truth)]
            }
            Self::Tie { surfel, found } => [Some(surfel), Some(found)],
            Self::NotProjected { surfel }
            | Self::Projected { surfel }
            | Self::Copied { surfel }
            | Self::Absent { surfel }
            | Self::Outside { surfel, .. }
            | Self::LeftOut { surfel, .. } => [Some(surfel), None],
            Self::Value { .. }
            | Self::Whole { .. }
            | Self::NoSuchDepth { .. }
            | Self::Hidden { .. } => [None, None],
        };
        numbers.into_iter().flatten().for_each(|number| *number = of(*number));
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { channel, found, truth, radius } => {
                write!(f, "{channel} is {}, ", Plain(*found))?;
                if *radius == 0.0 {
                    write!(f, "right is {}", Plain(*truth))
                } else {
                    let [low, high] = [truth - radius, truth + radius].map(Plain);
                    write!(f, "right are {low} to {high}")
                }
            }
            Self::Whole { channel, found, truth } => {
                write!(f, "{channel} is {}, right is {}", whole(*found), whole(*truth))
            }
            Self::NotProjected { surfel } => {
                write!(f, "surfel {surfel} is drawn, and has no record")
            }
            Self::Projected { surfel } => {
                write!(f, "surfel {surfel} is not drawn, and has a record")
            }
            Self::Copied { surfel } => {
                write!(
                    f,
                    "normal, opacity or colour of the record are not those of surfel {surfel}"
                )
            }
            Self::Absent { surfel } => {
                write!(f, "the id is {}, which does not reach the pixel", whole(*surfel))
            }
            Self::NoSuchDepth { found, closest } => {
                let [found, closest] = [*found, *closest].map(Plain);
                write!(f, "no surfel has the depth {found}; the closest has {closest}")
            }
            Self::Tie { surfel, found } => {
                write!(f, "the id is {found}; surfel {surfel} is equally near and comes first")
            }
            Self::Outside { surfel, rim } => {
                let rim = Plain(*rim);
                write!(f, "the id is {surfel}, which is outside there: q is {rim} of its limit")
            }
            Self::LeftOut { surfel, depth, found, .. } => {
                let [depth, found] = [*depth, *found].map(Plain);
                write!(f, "surfel {surfel} at depth {depth} is left out; the client has {found}")
            }
            Self::Hidden { depth, found } => {
                let [depth, found] = [*depth, *found].map(Plain);
                write!(f, "a polygon at depth {depth} is left out; the client has {found}")
            }
        }
    }
}

/// Writes a number as short as it can be read back, with a power of ten where it has more than a
/// few zeros.
struct Plain(f64);

impl fmt::Display for Plain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        let size = value.abs();
        if value.is_finite() && size > 0.0 && !(1e-4..1e16).contains(&size) {
            write!(f, "{value:e}")
        } else {
            write!(f, "{value}")
        }
    }
}

/// An index in words.
fn whole(value: u32) -> String {
    if value == NO_ID { "none".into() } else { value.to_string() }
}

/// One value of a client at a pixel, and the values that are allowed there.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The stage that leaves the value.
    pub stage: &'static str,
    /// The value, and the allowed values. The value is wrong only if the error is above 1.
    pub fault: Fault,
    /// The error in bounds; NaN if the value has no bound.
    pub error: f64,
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { stage, fault, error } = self;
        let word = match *error {
            error if error.is_nan() => "open ",
            error if error > 1.0 => "WRONG",
            _ => "right",
        };
        write!(f, "{stage:<14} {word}  {fault}")?;
        match *error {
            error if !(error > 0.0 && error.is_finite()) => Ok(()),
            error if error < 0.001 => write!(f, "  ({error:.0e} bounds)"),
            error => write!(f, "  ({error:.3} bounds)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_numbers_have_a_power_of_ten() {
        let value = |found, truth, radius| {
            Fault::Value { channel: "A".into(), found, truth, radius }.to_string()
        };
        assert_eq!(value(3.0, 0.5, 0.25), "A is 3, right are 0.25 to 0.75");
        assert_eq!(value(0.0, 1e-45, 5e-46), "A is 0, right are 5e-46 to 1.5e-45");
        assert_eq!(value(f64::INFINITY, -3e30, 0.0), "A is inf, right is -3e30");
        let check = |error| {
            let fault = Fault::Outside { surfel: 3, rim: 1.5e-9 };
            Check { stage: "visibility", fault, error }.to_string()
        };
        let what = "right  the id is 3, which is outside there: q is 1.5e-9 of its limit";
        assert_eq!(check(1e-12), format!("visibility     {what}  (1e-12 bounds)"));
        assert_eq!(check(0.25), format!("visibility     {what}  (0.250 bounds)"));
    }
}
