//! How far long work is.

/// Who is told how far long work is: the name of the step, how much of the step is done, and of how much.
pub type Progress<'a> = &'a dyn Fn(&str, u64, u64);
