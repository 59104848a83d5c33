//! Weighted accumulation and normalization \[ZP06, eq. 1\].

use crate::number::{Exact, Vector3};

/// `sum + weight value`, component by component: a multiplication, then an addition.
#[inline(always)]
pub fn add<R: Exact>(sum: [R; 3], weight: R, value: [R; 3]) -> [R; 3] {
    [sum[0] + weight * value[0], sum[1] + weight * value[1], sum[2] + weight * value[2]]
}

/// `a + b`, component by component.
#[inline(always)]
pub fn plus<R: Exact>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `sum / weight + 0`, component by component; 0 where no weight has arrived. Adding 0 turns a -0,
/// of an underflow, into +0.
///
/// Law: if every value was v, the average is v up to the rounding of the sums.
#[inline(always)]
pub fn average<R: Exact>(sum: [R; 3], weight: R) -> [R; 3] {
    if weight > R::ZERO {
        [sum[0] / weight + R::ZERO, sum[1] / weight + R::ZERO, sum[2] / weight + R::ZERO]
    } else {
        [R::ZERO; 3]
    }
}

/// The direction of the average of normals: [`average`], divided by its length, plus 0.
///
/// Opposite normals that cancel leave the null vector. Averaging first keeps the squares of tiny
/// weights from underflowing.
#[inline(always)]
pub fn direction<R: Exact>(sum: [R; 3], weight: R) -> [R; 3] {
    let [x, y, z] = average(sum, weight);
    let n = Vector3::new(x, y, z).normalized();
    [n.x + R::ZERO, n.y + R::ZERO, n.z + R::ZERO]
}
