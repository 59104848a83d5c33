//! Report the progress of long work.

/// Receives the progress of long work: the name of the step, the units that are done, and the units in all.
pub type Progress<'a> = &'a dyn Fn(&str, u64, u64);
