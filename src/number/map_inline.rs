//! Map arrays without a call for each element.

/// `array::map` for code that runs once a pixel or more often.
///
/// The standard library's own is a call of a function that is compiled elsewhere, unless the crate
/// is compiled in one unit or with link-time optimization. Such calls doubled the time of a picture
/// with pyramids.
pub(crate) trait MapInline<T, const N: usize> {
    /// Calls `f` with each element in their order. There must be at least one.
    fn map_inline<U: Copy>(self, f: impl FnMut(T) -> U) -> [U; N];
}

impl<T: Copy, const N: usize> MapInline<T, N> for [T; N] {
    // A loop, because `std::array::from_fn` makes such calls, too.
    #[inline(always)]
    fn map_inline<U: Copy>(self, mut f: impl FnMut(T) -> U) -> [U; N] {
        const { assert!(N > 0) };
        let mut mapped = [f(self[0]); N];
        for i in 1..N {
            mapped[i] = f(self[i]);
        }
        mapped
    }
}
