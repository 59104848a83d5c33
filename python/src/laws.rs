//! The laws of compositing against a function of Python.

use crate::error::value;
use numpy::{Element, PyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use splatref::composite::bins::Range;
use splatref::composite::groups::WeightedFragment;
use splatref::composite::over::Blend;
use splatref::composite::under::Under;
use splatref::laws::{
    Counterexample, Kind, Lawful, bins, epsilon, groups, means, over, sums, under,
};
use splatref::number::Exact;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// What the search unwinds with when a function raises an exception.
struct Raised;

/// Functions of Python that stand for an operator.
struct Operator<'py> {
    py: Python<'py>,
    functions: Vec<Bound<'py, PyAny>>,
    /// `numpy.float32` or `numpy.float64`, so that Python computes in this arithmetic.
    scalar: Bound<'py, PyAny>,
    error: RefCell<Option<PyErr>>,
    calls: RefCell<u32>,
}

/// A number that Python gets as a scalar of `numpy`.
trait Number: Exact + Element {
    fn of(value: f64) -> Self;
}

impl Number for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
}

impl<'py> Operator<'py> {
    /// Calls a function; an exception ends the search.
    fn call<T>(
        &self,
        function: usize,
        arguments: PyResult<Vec<Bound<'py, PyAny>>>,
        read: impl Fn(Bound<'py, PyAny>) -> PyResult<T>,
    ) -> T {
        let called = || {
            *self.calls.borrow_mut() += 1;
            if self.calls.borrow().is_multiple_of(1024) {
                self.py.check_signals()?;
            }
            let arguments = PyTuple::new(self.py, arguments?)?;
            read(self.functions[function].call1(arguments)?)
        };
        called().unwrap_or_else(|error| {
            *self.error.borrow_mut() = Some(error);
            resume_unwind(Box::new(Raised))
        })
    }

    fn number<R: Number>(&self, value: R) -> PyResult<Bound<'py, PyAny>> {
        self.scalar.call1((value.to_f64(),))
    }

    fn triple<R: Number>(&self, values: [R; 3]) -> Bound<'py, PyAny> {
        PyArray1::from_slice(self.py, &values).into_any()
    }
}

fn number<R: Number>(found: &Bound<'_, PyAny>) -> PyResult<R> {
    found.extract::<f64>().map(R::of).map_err(|_| value("the function must return a number"))
}

fn triple<R: Number>(found: &Bound<'_, PyAny>) -> PyResult<[R; 3]> {
    let numbers: [f64; 3] =
        found.extract().map_err(|_| value("the function must return a colour of three numbers"))?;
    Ok(numbers.map(R::of))
}

/// The parts of a tuple that the function returned.
fn parts<'py, const N: usize>(
    found: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<[Bound<'py, PyAny>; N]> {
    found.extract().map_err(|_| value(&format!("the function must return {what}")))
}

/// Tries the laws of an operator; a dictionary describes the counterexample.
#[pyfunction]
pub(crate) fn law<'py>(
    py: Python<'py>,
    operator: &str,
    functions: Vec<Bound<'py, PyAny>>,
    kinds: Vec<String>,
    number: &str,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let of = |word: &String| {
        let kind = Kind::ALL.into_iter().find(|kind| kind.name() == word);
        kind.ok_or_else(|| value(&format!("kind {word}; give algebraic, exact or odd inputs")))
    };
    let kinds = kinds.iter().map(of).collect::<PyResult<Vec<_>>>()?;
    let (scalar, double) = match number {
        "f32" => ("float32", false),
        "f64" => ("float64", true),
        _ => return Err(value(&format!("number {number}; give f32 or f64"))),
    };
    let scalar = py.import("numpy")?.getattr(scalar)?;
    let error = RefCell::new(None);
    let tried = Operator { py, functions, scalar, error, calls: RefCell::new(0) };
    // The search calls Python all the time, so it keeps the interpreter.
    let lawful = catch_unwind(AssertUnwindSafe(|| match double {
        false => tried.search::<f32>(operator, &kinds),
        true => tried.search::<f64>(operator, &kinds),
    }));
    match lawful {
        Ok(Some(Ok(()))) => Ok(None),
        Ok(Some(Err(found))) => described(py, &found).map(Some),
        Ok(None) => Err(value(&format!("no operator is called {operator}"))),
        Err(payload) if payload.is::<Raised>() => {
            Err(tried.error.take().unwrap_or_else(|| value("the function failed")))
        }
        Err(payload) => resume_unwind(payload),
    }
}

fn described<'py>(py: Python<'py>, found: &Counterexample) -> PyResult<Bound<'py, PyDict>> {
    let one = PyDict::new(py);
    one.set_item("law", found.law)?;
    one.set_item("kind", found.kind.name())?;
    one.set_item("picture", found.picture)?;
    one.set_item("inputs", &found.inputs)?;
    one.set_item("expected", &found.expected)?;
    one.set_item("found", &found.found)?;
    one.set_item("text", found.to_string())?;
    Ok(one)
}

impl Operator<'_> {
    /// Tries the laws; `None` if there is no such operator.
    fn search<R: Number>(&self, operator: &str, kinds: &[Kind]) -> Option<Lawful> {
        Some(match operator {
            "over" => self.over::<R>(kinds),
            "under" => self.under::<R>(kinds),
            "epsilon" => epsilon::of_kinds(kinds, &|t: R, nearest, band| {
                let arguments =
                    || Ok(vec![self.number(t)?, self.number(nearest)?, self.number(band)?]);
                self.call(0, arguments(), |found| found.is_truthy())
            }),
            "sums" => {
                let add = |sum: [R; 3], weight: R, color: [R; 3]| {
                    let arguments =
                        || Ok(vec![self.triple(sum), self.number(weight)?, self.triple(color)]);
                    self.call(0, arguments(), |found| triple(&found))
                };
                let average = |sum: [R; 3], total: R| {
                    let arguments = || Ok(vec![self.triple(sum), self.number(total)?]);
                    self.call(1, arguments(), |found| triple(&found))
                };
                sums::of_kinds(kinds, &add, &average)
            }
            "means" => {
                means::of_kinds(kinds, &|takes: [bool; 4], weights: [R; 4], values: [R; 4]| {
                    let arguments = || {
                        let takes = PyArray1::from_slice(self.py, &takes).into_any();
                        let of = |values: &[R]| PyArray1::from_slice(self.py, values).into_any();
                        Ok(vec![takes, of(&weights), of(&values)])
                    };
                    self.call(0, arguments(), |found| number(&found))
                })
            }
            "bins" => self.bins::<R>(kinds),
            "groups" => groups::of_kinds(kinds, &|samples: &[WeightedFragment<R>], band: R| {
                self.compose(samples, band)
            }),
            _ => return None,
        })
    }

    fn over<R: Number>(&self, kinds: &[Kind]) -> Lawful {
        over::of_kinds(kinds, &|below: Blend<R>, alpha, color| {
            let arguments = || {
                let (color, below_color) = (self.triple(color), self.triple(below.color));
                Ok(vec![below_color, self.number(below.alpha)?, self.number(alpha)?, color])
            };
            self.call(0, arguments(), |found| {
                let [color, alpha] = parts(&found, "a colour and an opacity")?;
                Ok(Blend { color: triple(&color)?, alpha: number(&alpha)? })
            })
        })
    }

    fn under<R: Number>(&self, kinds: &[Kind]) -> Lawful {
        under::of_kinds(kinds, &|front: Under<R>, alpha, color| {
            let arguments = || {
                let (color, front_color) = (self.triple(color), self.triple(front.color));
                let (through, opacity) = (self.number(front.through)?, self.number(front.alpha)?);
                Ok(vec![front_color, opacity, through, self.number(alpha)?, color])
            };
            self.call(0, arguments(), |found| {
                let what = "a colour, an opacity, and what is let through";
                let [color, alpha, through] = parts(&found, what)?;
                let (alpha, through) = (number(&alpha)?, number(&through)?);
                Ok(Under { color: triple(&color)?, alpha, through })
            })
        })
    }

    fn bins<R: Number>(&self, kinds: &[Kind]) -> Lawful {
        let range = |range: &Range| {
            let numbers = (range.nearest, range.farthest, range.count);
            Ok::<_, PyErr>(numbers.into_pyobject(self.py)?.into_any())
        };
        let bin = |of: &Range, t: R| {
            let arguments = || Ok(vec![range(of)?, self.number(t)?]);
            self.call(0, arguments(), |found| number(&found))
        };
        let voronoi = |of: &Range, t: R, ratio: R| {
            let arguments = || Ok(vec![range(of)?, self.number(t)?, self.number(ratio)?]);
            self.call(1, arguments(), |found| number(&found))
        };
        bins::of_kinds(kinds, &bin, &voronoi)
    }

    /// Composes the samples of all groups at a pixel. Samples are rows of nine numbers: depth,
    /// weight, normal, colour and opacity, the last three times the weight.
    fn compose<R: Number>(
        &self,
        samples: &[WeightedFragment<R>],
        band: R,
    ) -> (WeightedFragment<R>, u32) {
        use numpy::PyArrayMethods;
        let arguments = || {
            let rows = samples.iter().flat_map(|one| {
                let WeightedFragment { depth, weight, normal, color, opacity } = *one;
                let ([x, y, z], [r, g, b]) = (normal, color);
                [depth, weight, x, y, z, r, g, b, opacity]
            });
            let rows: Vec<R> = rows.collect();
            let rows = PyArray1::from_vec(self.py, rows).reshape([samples.len(), 9])?;
            Ok(vec![rows.into_any(), self.number(band)?])
        };
        self.call(0, arguments(), |found| {
            let what = "a row of nine sums, and how many samples passed";
            let [sums, passed] = parts(&found, what)?;
            let sums: [f64; 9] = sums.extract().map_err(|_| value("nine sums are returned"))?;
            let [depth, weight, x, y, z, r, g, b, opacity] = sums.map(R::of);
            let sums =
                WeightedFragment { depth, weight, normal: [x, y, z], color: [r, g, b], opacity };
            let passed = passed.extract::<f64>().map_err(|_| value("a count is returned"))?;
            Ok((sums, passed as u32))
        })
    }
}
