//! Map arrays without a call for each element.

/// `array::map` for code that runs once a pixel or more often.
///
/// The standard library's own is a call of a function that is compiled elsewhere, unless the crate
/// is compiled in one unit or with link-time optimization. Such calls doubled the time of a picture
/// with pyramids.
pub(crate) trait MapInline<T, const N: usize> {
    /// Calls `f` with each element in their order.
    fn map_inline<U>(self, f: impl FnMut(T) -> U) -> [U; N];
}

impl<T: Copy, const N: usize> MapInline<T, N> for [T; N] {
    #[inline(always)]
    fn map_inline<U>(self, mut f: impl FnMut(T) -> U) -> [U; N] {
        std::array::from_fn(|i| f(self[i]))
    }
}
