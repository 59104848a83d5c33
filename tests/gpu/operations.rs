//! How exactly the device computes the operations that a promise speaks of.

use crate::device::Gpu;
use splatref::number::elementary;
use splatref::number::random::unit;

const COUNT: usize = 1 << 16;
/// Words of `Numbers` and of `Results`.
const NUMBERS: usize = 8;
const RESULTS: usize = 16;

/// A table of the operations: what shading languages grant, and what the device did.
pub(crate) fn table(gpu: &Gpu) -> String {
    let numbers: Vec<[f32; NUMBERS]> = (0..COUNT as u64).map(numbers).collect();
    let words: Vec<u32> = numbers.iter().flatten().map(|number| number.to_bits()).collect();
    let (inputs, outputs) = (gpu.storage(&words), gpu.output(RESULTS * COUNT));
    let kernel =
        gpu.compute(&gpu.module(&[include_str!("shaders/operations.wgsl")]), "operate", &[]);
    let resources = [(0, inputs.as_entire_binding()), (1, outputs.as_entire_binding())];
    let mut encoder = gpu.encoder();
    gpu.dispatch(&mut encoder, &kernel, &resources, [COUNT as u32 / 64, 1]);
    let words = gpu.read_buffer(encoder, &outputs);
    let results: &[[u32; RESULTS]] = words.as_chunks().0;

    // The largest distance from the exact result, in ulp of it.
    let error = |at: usize, exact: &dyn Fn([f64; 3]) -> f64| {
        let ulps = numbers.iter().zip(results).map(|(&[a, b, x, ..], result)| {
            let exact = exact([a, b, x].map(f64::from));
            let ulp =
                f64::from(f32::from_bits((exact as f32).to_bits() & 0x7f80_0000)) / 8_388_608.0;
            (f64::from(f32::from_bits(result[at])) - exact).abs() / ulp
        });
        format!("{:.3} ulp", ulps.fold(0.0, |most: f64, ulp| if ulp > most { ulp } else { most }))
    };
    let zeros = |at: usize| results.iter().all(|result| f32::from_bits(result[at]) == 0.0);
    let either = |truth: bool, yes: &'static str, no: &'static str| if truth { yes } else { no };
    let rows = [
        ("`exp(x)`, x from -2 to 0", "3 + 2 abs(x) ulp", error(0, &|[.., x]| elementary::exp(x))),
        ("`a / b`", "2.5 ulp", error(1, &|[a, b, _]| a / b)),
        ("`sqrt(a)`", "by way of 1 / sqrt, 2 ulp", error(2, &|[a, ..]| a.sqrt())),
        ("`a * b`", "either neighbour", error(3, &|[a, b, _]| a * b)),
        ("`a + b`", "either neighbour", error(4, &|[a, b, _]| a + b)),
        ("`a * b - c`", "may be fused", either(zeros(5), "rounded twice", "fused").into()),
        ("`(a + b) - c`", "any order", either(zeros(6), "as written", "regrouped").into()),
        ("denormal results", "may be flushed", either(zeros(7), "flushed", "kept").into()),
        ("denormal operands", "may be flushed", either(zeros(8), "flushed", "kept").into()),
    ];
    let row = |(operation, granted, done): &(&str, &str, String)| {
        format!("| {operation} | {granted} | {done} |\n")
    };
    let rows: String = rows.iter().map(row).collect();
    format!("| operation | granted | this device |\n|---|---|---|\n{rows}")
}

fn numbers(i: u64) -> [f32; NUMBERS] {
    let [s, t, u] = [0, 1, 2].map(|k| unit(7, 3 * i + k));
    // Equal steps of the bits are nearly equal steps of the logarithm.
    let between = |share: f32| f32::from_bits(0x3a80_0000 + (share * (20 << 23) as f32) as u32);
    let (a, b) = (between(s), between(t));
    let tiny = f32::MIN_POSITIVE * (1.0 + u);
    [a, b, -2.0 * u, a * b, 1e12, tiny, tiny * 0.25, 0.0]
}
