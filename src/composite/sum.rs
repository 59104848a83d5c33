//! Weighted accumulation and normalization \[ZP06, eq. 1\].

use crate::number::{Real, Vector3};

/// `sum + weight value`, component by component: a multiplication, then an addition.
#[inline(always)]
pub fn add<R: Real>(sum: [R; 3], weight: R, value: [R; 3]) -> [R; 3] {
    [sum[0] + weight * value[0], sum[1] + weight * value[1], sum[2] + weight * value[2]]
}

/// `a + b`, component by component.
#[inline(always)]
pub fn plus<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `sum / weight + 0`, component by component; 0 where the weight is 0. An underflow can give -0,
/// and adding 0 turns it into +0.
///
/// Law: if every value was v, the average is v up to the rounding of the sums.
#[inline(always)]
pub fn average<R: Real>(sum: [R; 3], weight: R) -> [R; 3] {
    let some = weight.gt(R::ZERO);
    // Not by `map`, because a loop over pixels does not vectorize with it.
    [part(some, sum[0], weight), part(some, sum[1], weight), part(some, sum[2], weight)]
}

/// A component of an average. It is not a closure, because a closure would not be inlined where
/// numbers are balls.
#[inline(always)]
fn part<R: Real>(some: R::Truth, sum: R, weight: R) -> R {
    R::select(some, sum / weight + R::ZERO, R::ZERO)
}

/// The direction of the average of normals: [`average`], divided by its length, plus 0.
///
/// Opposite normals that cancel leave the null vector. Averaging first keeps the squares of tiny
/// weights from underflowing.
#[inline(always)]
pub fn direction<R: Real>(sum: [R; 3], weight: R) -> [R; 3] {
    let [x, y, z] = average(sum, weight);
    let n = Vector3::new(x, y, z).normalized();
    [n.x + R::ZERO, n.y + R::ZERO, n.z + R::ZERO]
}
