//! Control the size of surfels by the time of the last frame \[BJFM19, 4.3\].
//!
//! The paper's rule is "a simple reactive algorithm that increases or decreases the surfel size
//! based on the frame-time of the last rendered frame". With the size s of that frame, its time t
//! and the target time T, in f64:
//!
//! ```text
//!   deviation = t / T
//!   s'        = s                                    if low <= deviation <= high
//!               (s 3 + s deviation) / 4              otherwise, at least `least`, at most `most`
//! ```
//!
//! The result is rounded to f32. A size out of \[least, most\] is clamped into it first.
//!
//! `Decided:` `s_old` of the paper is the size of the last frame. Its formula has one number, but
//! its sentence speaks of a moving average over three frames.
//!
//! If a frame takes b / s^2, because every surfel takes the same time, the size settles: near the
//! target size the error halves from frame to frame. From a size much too small it overshoots, in
//! one frame, from s = x s' to (3 x + 1 / x) / 4 of the target size s'. That is the first frame
//! after a load step of n, where x = n^(-1/2). If a time is known d frames late, the size swings:
//! `e(i + 1) = e(i) - e(i - d) / 2` dies out for d up to 2, and grows for d from 3 on, until
//! \[least, most\] ends it.

use crate::error::{Error, Result};
use crate::number::Real;

/// Sets the size of surfels by the time of frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    /// T: the time that a frame should take, greater than 0, in any unit.
    pub target: f64,
    /// The deviations within which the size stays: the paper's are 0.9 and 1.1.
    pub dead_zone: [f64; 2],
    /// The least and the largest size in pixels: the paper's are 1 and 8.
    pub sizes: [f32; 2],
}

impl Controller {
    /// The paper's controller, for a target time.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the time is not greater than 0, or not finite.
    pub fn new(target: f64) -> Result<Self> {
        if target > 0.0 && target.is_finite() {
            return Ok(Self { target, dead_zone: [0.9, 1.1], sizes: [1.0, 8.0] });
        }
        Err(Error::Invalid(format!("a frame time of {target}; give one greater than 0")))
    }

    /// The size of the next frame, after a frame of this size that took this time, in the unit of
    /// the target. A time that is NaN or less than 0 leaves the size as it is.
    #[must_use]
    pub fn next(&self, size: f32, time: f64) -> f32 {
        let [least, most] = self.sizes;
        let size = size.clamped(least, most);
        let deviation = time / self.target;
        let [low, high] = self.dead_zone;
        let deviates = (0.0..low).contains(&deviation) || deviation > high;
        if !deviates {
            return size;
        }
        let old = f64::from(size);
        let next = (old * 3.0 + old * deviation) / 4.0;
        next.clamped(least.into(), most.into()) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The sizes of frames whose surfels take `cost / s^2`; each frame's time is known `late`
    /// frames late.
    fn frames(from: f32, cost: f64, late: usize, count: usize) -> Vec<f32> {
        let controller = Controller::new(1.0).unwrap();
        let mut sizes = vec![from; late + 1];
        for _ in 0..count {
            let known = f64::from(sizes[sizes.len() - 1 - late]);
            let next = controller.next(sizes[sizes.len() - 1], cost / (known * known));
            sizes.push(next);
        }
        sizes.split_off(late)
    }

    proptest! {
        #[test]
        fn sizes_settle_where_a_frame_takes_what_it_should(from in 1.0..8.0_f32, cost in 0.01..1000.0_f64) {
            let sizes = frames(from, cost, 0, 24);
            let last = f64::from(sizes[sizes.len() - 1]);
            let deviation = cost / (last * last);
            let settled = (0.9..=1.1).contains(&deviation);
            let at_an_end = (last == 8.0 && deviation > 1.1) || (last == 1.0 && deviation < 0.9);
            prop_assert!(settled || at_an_end, "{last} {deviation}");
            prop_assert_eq!(sizes[sizes.len() - 2], sizes[sizes.len() - 1], "and stays");
            // No frame but the first passes the target size.
            let wanted = cost.sqrt();
            prop_assert!(sizes[1..].iter().all(|&s| f64::from(s) >= 0.866 * wanted || s == 8.0));
        }

        #[test]
        fn sizes_never_leave_their_range(size in any::<f32>(), time in any::<f64>(), target in 1e-9..1e9_f64) {
            let next = Controller::new(target).unwrap().next(size, time);
            prop_assert!(size.is_nan() || (1.0..=8.0).contains(&next), "{next}");
        }

        #[test]
        fn the_dead_zone_keeps_every_bit(size in 1.0..8.0_f32, deviation in 0.9..1.1_f64) {
            prop_assert_eq!(Controller::new(2.0).unwrap().next(size, 2.0 * deviation), size);
            prop_assert_ne!(Controller::new(2.0).unwrap().next(4.0, 2.0 * (deviation + 0.21)), 4.0);
        }
    }

    #[test]
    fn a_step_by_hand() {
        let controller = Controller::new(10.0).unwrap();
        assert_eq!(controller.next(2.0, 20.0), 2.5);
        assert_eq!(controller.next(2.0, 5.0), 1.75);
        assert_eq!([0.9, 1.1].map(|d| controller.next(2.0, d * 10.0)), [2.0; 2]);
        assert_eq!([1000.0, 0.0].map(|t| controller.next(4.0, t)), [8.0, 3.0]);
        assert_eq!([f64::NAN, -1.0].map(|t| controller.next(4.0, t)), [4.0; 2]);
        assert_eq!(controller.next(4.0, f64::INFINITY), 8.0);
        assert!(
            [0.0, -1.0, f64::NAN, f64::INFINITY].map(Controller::new).iter().all(Result::is_err)
        );
    }

    /// After a load step of n the size overshoots in one frame, as the page says.
    #[test]
    fn a_load_step_overshoots_once() {
        for step in [2.0, 4.0, 9.0, 25.0] {
            // Settled at 1.25 before the step.
            let wanted = 1.25 * f64::sqrt(step);
            let sizes = frames(1.25, 1.25 * 1.25 * step, 0, 30);
            let x = 1.0 / f64::sqrt(step);
            let first = wanted * (3.0 * x + 1.0 / x) / 4.0;
            assert!((f64::from(sizes[1]) - first.at_most(8.0)).abs() < 1e-5, "{step}");
            assert!(sizes[1..].is_sorted_by(|a, b| a >= b) || first < wanted, "{step}: {sizes:?}");
        }
    }

    /// If times are known late, the swing after a load step of 2 dies out, up to two frames.
    #[test]
    fn late_times_make_sizes_swing() {
        let swing = |late: usize| {
            let sizes = frames(2.0, 8.0, late, 400);
            let end = &sizes[300..];
            let most = end.iter().fold(0.0_f32, |most, &s| most.at_least(s));
            let least = end.iter().fold(9.0_f32, |least, &s| least.at_most(s));
            most / least
        };
        assert_eq!([0, 1, 2].map(swing), [1.0; 3]);
        assert!(
            [3, 4, 6, 8].map(swing).is_sorted_by(|a, b| 1.5 < *a && a <= b),
            "{:?}",
            [3, 4, 6, 8].map(swing)
        );
    }
}
