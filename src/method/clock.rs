//! Time the stages of a picture: the laps of [`Picture::timings`](super::Picture::timings).
//!
//! All clocks of the methods read [`now`]. A test puts a virtual time in its place that passes for
//! one kind of [`Work`] alone, so the test sees which lap holds this work.

use crate::number::MapInline;
use std::time::{Duration, Instant};

#[cfg(test)]
use virtual_time::now;
#[cfg(test)]
pub(crate) use virtual_time::spend;

/// The laps in order: the name of a stage, or of several that ran as one, and the wall time.
pub type Laps = Vec<(&'static str, Duration)>;

/// Measures the wall times of stages.
pub(crate) struct Clock {
    start: Instant,
    laps: Laps,
}

impl Default for Clock {
    fn default() -> Self {
        Self { start: now(), laps: Vec::new() }
    }
}

impl Clock {
    /// A clock for stages whose work does not come in the order of their names.
    pub(crate) fn of_stages(names: &[&'static str]) -> Self {
        let laps = names.iter().map(|name| (*name, Duration::ZERO)).collect();
        Self { laps, ..Self::default() }
    }

    /// Leaves the work since the last lap out.
    pub(crate) fn restart(&mut self) {
        self.start = now();
    }

    /// The laps.
    pub(crate) fn into_laps(self) -> Laps {
        self.laps
    }

    /// Ends stages that ran one after the other in every tile. Each stage gets a share of the wall
    /// time in proportion to its time in all tiles.
    pub(crate) fn shares<const N: usize>(
        &mut self,
        names: [&'static str; N],
        tiles: &[[Duration; N]],
    ) {
        let shares = wall_shares(now() - self.start, tiles);
        for (name, time) in names.into_iter().zip(shares) {
            self.add(name, time);
        }
        self.restart();
    }

    /// Ends work on a stage that began at the last lap or at `restart`.
    pub(crate) fn lap(&mut self, name: &'static str) {
        self.add(name, now() - self.start);
        self.restart();
    }

    /// Adds time to a stage, which may have been worked on before.
    fn add(&mut self, name: &'static str, time: Duration) {
        match self.laps.iter_mut().find(|(stage, _)| *stage == name) {
            Some((_, sum)) => *sum += time,
            None => self.laps.push((name, time)),
        }
    }
}

/// Divides the wall time among stages in proportion to their time in all tiles.
fn wall_shares<const N: usize>(wall: Duration, tiles: &[[Duration; N]]) -> [Duration; N] {
    let sums: [Duration; N] = std::array::from_fn(|i| tiles.iter().map(|tile| tile[i]).sum());
    let total: Duration = sums.iter().sum();
    sums.map_inline(|part| match total.as_secs_f64() {
        0.0 => Duration::ZERO,
        total => wall.mul_f64(part.as_secs_f64() / total),
    })
}

/// The times of the stages of a tile; the work between two laps belongs to the second.
pub(crate) struct Stopwatch<const N: usize> {
    last: Instant,
    times: [Duration; N],
}

impl<const N: usize> Stopwatch<N> {
    /// Starts a tile.
    pub(crate) fn start() -> Self {
        Self { last: now(), times: [Duration::ZERO; N] }
    }

    /// Stage `stage` ends.
    pub(crate) fn lap(&mut self, stage: usize) {
        let now = now();
        self.times[stage] += now - self.last;
        self.last = now;
    }

    /// The time of each stage.
    pub(crate) fn times(self) -> [Duration; N] {
        self.times
    }
}

#[cfg(not(test))]
fn now() -> Instant {
    Instant::now()
}

/// Marks a function that does a kind of work. It is nothing but in the crate's own tests.
#[cfg(not(test))]
#[inline(always)]
pub(crate) fn spend(_: Work) {}

/// A kind of work, which belongs to one stage of a method. The functions that do the work name it
/// to [`spend`], so that `tests/laps.rs` can ask which lap holds it.
#[cfg_attr(test, derive(Clone, Copy, Debug, PartialEq))]
pub(crate) enum Work {
    /// Surfels, Gaussians or primitives are projected.
    Project,
    /// The splats of a tile are gathered.
    Gather,
    /// Visibility splatting.
    Visibility,
    /// The limits of the epsilon-z test.
    Limits,
    /// Attribute splatting.
    Attributes,
    /// Sums become averages.
    Normalize,
    /// The planes of the picture are written.
    Store,
    /// Phong shading of pixels.
    Shade,
    /// The light behind a pixel is added.
    Environment,
    /// Fragments are drawn into the images of groups.
    Images,
    /// The images of groups become sums.
    Composite,
    /// Layers are blended.
    Blend,
    /// Groups are averaged.
    Average,
    /// The nearest layer is laid over the layers behind it.
    Over,
    /// A layer is peeled off.
    Peel,
    /// The levels of a pyramid become coarser.
    Pull,
    /// The levels of a pyramid become finer.
    Push,
    /// Centres move up the levels.
    Propagate,
    /// Pixels search the levels.
    Search,
    /// Discs are drawn.
    Discs,
    /// Colours leave the space of blending.
    Display,
    /// The triangles beside surfels are drawn into the depth.
    Polygons,
    /// The triangles beside surfels are shown.
    ShowPolygons,
    /// Surfels are copied.
    Copy,
    /// Every surfel becomes a pixel of the index buffer.
    Indices,
    /// Pass 3 of `deferred`, without the visibility splatting itself.
    Difference,
    /// Colours are filtered for a view.
    Filter,
    /// The surfels of passes 1 and 3 of `deferred` are ranked for pass 4.
    Rank,
    /// The splats of pass 4 of `deferred` are gathered.
    GatherRanked,
    /// The depth of pass 1 of `deferred` is copied into a tile of pass 4.
    Load,
}

/// A time that passes for one kind of work alone.
#[cfg(test)]
pub(crate) mod virtual_time {
    use super::Work;
    use std::cell::RefCell;
    use std::time::{Duration, Instant};

    /// The time of one piece of work. Shares of whole seconds are exact.
    const TICK: Duration = Duration::from_secs(1);

    struct Time {
        /// When the picture began.
        begin: Instant,
        /// The work that takes time.
        slow: Work,
        /// The time since then.
        passed: Duration,
        /// All work that was done, each kind once.
        done: Vec<Work>,
    }

    thread_local! {
        /// The virtual time of this thread; without one, time is real.
        static TIME: RefCell<Option<Time>> = const { RefCell::new(None) };
    }

    pub(super) fn now() -> Instant {
        TIME.with_borrow(|time| match time {
            Some(time) => time.begin + time.passed,
            None => Instant::now(),
        })
    }

    /// Spends time, if this work takes time.
    pub(crate) fn spend(work: Work) {
        TIME.with_borrow_mut(|time| {
            let Some(time) = time else { return };
            if time.slow == work {
                time.passed += TICK;
            }
            if !time.done.contains(&work) {
                time.done.push(work);
            }
        });
    }

    /// Runs `draw` on this thread in a virtual time in which only the work `slow` takes time.
    /// Returns its result, the time that passed, and the kinds of work that were done.
    pub(crate) fn with_slow<T>(slow: Work, draw: impl FnOnce() -> T) -> (T, Duration, Vec<Work>) {
        let time = Time { begin: Instant::now(), slow, passed: Duration::ZERO, done: Vec::new() };
        TIME.set(Some(time));
        let drawn = draw();
        let Time { passed, done, .. } = TIME.take().expect("the time that was set");
        (drawn, passed, done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_in_two_parts_has_one_lap() {
        let ms = Duration::from_millis;
        let mut clock = Clock::of_stages(&["visibility"]);
        clock.add("attributes", ms(2));
        clock.shares(["difference", "attributes"], &[[ms(0); 2]]);
        clock.add("difference", ms(8));
        clock.add("attributes", ms(16));
        let laps = [("visibility", ms(0)), ("attributes", ms(18)), ("difference", ms(8))];
        assert_eq!(clock.into_laps(), laps);
    }
}
