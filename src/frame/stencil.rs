//! The 8-bit stencil: the functions and operations of GPU APIs.
//!
//! Source: Vulkan 1.3 specification, chapter *Fragment Operations*, section *Stencil Test*; the
//! stencils of OpenGL, Direct3D 12 and WebGPU are the same. For each fragment, in this order:
//!
//! ```text
//!   passes = (reference & read_mask) FUNCTION (stored & read_mask)
//!   new    = operation(stored), the operation chosen by the Outcome
//!   stored = (stored & !write_mask) | (new & write_mask)
//! ```
//!
//! The read mask affects the test only. Operations act on the whole stored byte and the whole
//! reference, and the write mask decides which bits of the result are kept.

/// How the masked reference (left) is compared with the masked stored value (right).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Never passes.
    Never,
    /// reference < stored.
    Less,
    /// reference <= stored.
    LessOrEqual,
    /// reference > stored.
    Greater,
    /// reference >= stored.
    GreaterOrEqual,
    /// reference = stored.
    Equal,
    /// reference != stored.
    NotEqual,
    /// Always passes.
    Always,
}

/// How the stored value changes, before the write mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Keep the stored value.
    Keep,
    /// Set it to 0.
    Zero,
    /// Set it to the reference, without the read mask.
    Replace,
    /// Add one; 255 stays 255.
    IncrementClamp,
    /// Subtract one; 0 stays 0.
    DecrementClamp,
    /// Add one; 255 becomes 0.
    IncrementWrap,
    /// Subtract one; 0 becomes 255.
    DecrementWrap,
    /// Flip every bit.
    Invert,
}

/// The result of the tests of a fragment; it chooses the operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The stencil test failed; the depth test was not made.
    StencilFail,
    /// The stencil test passed, the depth test failed.
    DepthFail,
    /// Both passed, or there is no depth test.
    Pass,
}

/// The state of the stencil test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stencil {
    /// The comparison.
    pub function: Function,
    /// The value that is compared with the stored one, and that [`Operation::Replace`] writes.
    pub reference: u8,
    /// The bits that are compared.
    pub read_mask: u8,
    /// The bits that may change.
    pub write_mask: u8,
    /// The operation of [`Outcome::StencilFail`].
    pub fail: Operation,
    /// The operation of [`Outcome::DepthFail`].
    pub depth_fail: Operation,
    /// The operation of [`Outcome::Pass`].
    pub pass: Operation,
}

impl Stencil {
    /// No stencil: every fragment passes, nothing is written.
    pub const DISABLED: Self = Self {
        function: Function::Always,
        reference: 0,
        read_mask: 0xFF,
        write_mask: 0xFF,
        fail: Operation::Keep,
        depth_fail: Operation::Keep,
        pass: Operation::Keep,
    };

    /// Counts the fragments that pass the depth test; 255 stands for 255 or more.
    pub const COUNT: Self = Self { pass: Operation::IncrementClamp, ..Self::DISABLED };

    /// Whether a fragment passes where the stencil holds `stored`.
    #[inline]
    #[must_use]
    pub fn test(&self, stored: u8) -> bool {
        let reference = self.reference & self.read_mask;
        let stored = stored & self.read_mask;
        match self.function {
            Function::Never => false,
            Function::Less => reference < stored,
            Function::LessOrEqual => reference <= stored,
            Function::Greater => reference > stored,
            Function::GreaterOrEqual => reference >= stored,
            Function::Equal => reference == stored,
            Function::NotEqual => reference != stored,
            Function::Always => true,
        }
    }

    /// The new value of the stencil after a fragment that found `stored` there.
    #[inline]
    #[must_use]
    pub fn update(&self, stored: u8, outcome: Outcome) -> u8 {
        let operation = match outcome {
            Outcome::StencilFail => self.fail,
            Outcome::DepthFail => self.depth_fail,
            Outcome::Pass => self.pass,
        };
        let new = match operation {
            Operation::Keep => stored,
            Operation::Zero => 0,
            Operation::Replace => self.reference,
            Operation::IncrementClamp => stored.saturating_add(1),
            Operation::DecrementClamp => stored.saturating_sub(1),
            Operation::IncrementWrap => stored.wrapping_add(1),
            Operation::DecrementWrap => stored.wrapping_sub(1),
            Operation::Invert => !stored,
        };
        (stored & !self.write_mask) | (new & self.write_mask)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASKS: [u8; 5] = [0xFF, 0x00, 0x0F, 0xF0, 0xA5];

    /// For each function, whether it holds when reference - stored is negative, zero, positive.
    const TRUTH: [(Function, [bool; 3]); 8] = [
        (Function::Never, [false, false, false]),
        (Function::Less, [true, false, false]),
        (Function::Equal, [false, true, false]),
        (Function::LessOrEqual, [true, true, false]),
        (Function::Greater, [false, false, true]),
        (Function::NotEqual, [true, false, true]),
        (Function::GreaterOrEqual, [false, true, true]),
        (Function::Always, [true, true, true]),
    ];

    /// Computes the new value from the stored value and the reference.
    type Truth = fn(i32, i32) -> i32;

    /// The eight bits of a number, lowest first.
    fn bits(value: i32) -> [bool; 8] {
        std::array::from_fn(|i| value.rem_euclid(256) / (1 << i) % 2 == 1)
    }

    /// A number made of the bits for which `keep` holds.
    fn number(bits: [bool; 8], keep: impl Fn(usize) -> bool) -> i32 {
        (0..8).map(|i| if bits[i] && keep(i) { 1 << i } else { 0 }).sum()
    }

    #[test]
    fn every_function_follows_the_sign_of_the_difference() {
        for (function, truth) in TRUTH {
            for read_mask in MASKS {
                let masked = |v: u8| number(bits(v.into()), |i| bits(read_mask.into())[i]);
                for (reference, stored) in (0..=255).flat_map(|r| (0..=255).map(move |s| (r, s))) {
                    let state = Stencil { function, reference, read_mask, ..Stencil::DISABLED };
                    let sign = (masked(reference) - masked(stored)).signum();
                    let expected = truth[(sign + 1) as usize];
                    assert_eq!(state.test(stored), expected, "{state:?} on {stored}");
                }
            }
        }
    }

    #[test]
    fn every_operation_writes_the_bits_of_the_write_mask() {
        let operations: [(Operation, Truth); 8] = [
            (Operation::Keep, |s, _| s),
            (Operation::Zero, |_, _| 0),
            (Operation::Replace, |_, r| r),
            (Operation::IncrementClamp, |s, _| if s == 255 { 255 } else { s + 1 }),
            (Operation::DecrementClamp, |s, _| if s == 0 { 0 } else { s - 1 }),
            (Operation::IncrementWrap, |s, _| (s + 1).rem_euclid(256)),
            (Operation::DecrementWrap, |s, _| (s - 1).rem_euclid(256)),
            (Operation::Invert, |s, _| 255 - s),
        ];
        for (pass, truth) in operations {
            for write_mask in MASKS {
                let kept = bits(write_mask.into());
                for (reference, stored) in (0..=255).flat_map(|r| (0..=255).map(move |s| (r, s))) {
                    let state =
                        Stencil { reference, read_mask: 0, write_mask, pass, ..Stencil::DISABLED };
                    let new = bits(truth(stored.into(), reference.into()));
                    let expected =
                        number(new, |i| kept[i]) + number(bits(stored.into()), |i| !kept[i]);
                    let got = state.update(stored, Outcome::Pass);
                    assert_eq!(i32::from(got), expected, "{state:?} on {stored}");
                }
            }
        }
    }

    #[test]
    fn the_outcome_chooses_the_operation() {
        let state = Stencil {
            reference: 9,
            fail: Operation::Zero,
            depth_fail: Operation::Invert,
            pass: Operation::Replace,
            ..Stencil::DISABLED
        };
        let after = [Outcome::StencilFail, Outcome::DepthFail, Outcome::Pass];
        assert_eq!(after.map(|outcome| state.update(0x0F, outcome)), [0, 0xF0, 9]);
    }

    #[test]
    fn disabled_changes_nothing_and_count_saturates() {
        let outcomes = [Outcome::StencilFail, Outcome::DepthFail, Outcome::Pass];
        for stored in 0..=255 {
            assert!(Stencil::DISABLED.test(stored) && Stencil::COUNT.test(stored));
            assert!(outcomes.iter().all(|&o| Stencil::DISABLED.update(stored, o) == stored));
        }
        let counted = (0..300).fold(0, |stored, _| Stencil::COUNT.update(stored, Outcome::Pass));
        assert_eq!(counted, 255);
        assert_eq!(Stencil::COUNT.update(7, Outcome::DepthFail), 7, "hidden: not counted");
    }
}
