//! Test your own compositing operator: a wrong operator breaks a law, and you get a counterexample.
//!
//! ```sh
//! cargo run --release --example laws
//! ```

use splatref::composite::over::Blend;
use splatref::laws::{self, Counterexample, Kind};

/// Puts a nearer layer over the layers below. Colours are multiplied by their opacity.
fn right(below: Blend<f32>, alpha: f32, color: [f32; 3]) -> Blend<f32> {
    let mix = |nearer: f32, farther: f32| alpha * nearer + (1.0 - alpha) * farther;
    Blend {
        color: std::array::from_fn(|i| mix(color[i], below.color[i])),
        alpha: mix(1.0, below.alpha),
    }
}

/// The same with a common mistake: the colour is not multiplied by its opacity.
fn wrong(below: Blend<f32>, alpha: f32, color: [f32; 3]) -> Blend<f32> {
    let through = 1.0 - alpha;
    Blend {
        color: std::array::from_fn(|i| color[i] + through * below.color[i]),
        alpha: alpha + through * below.alpha,
    }
}

fn main() -> Result<(), Counterexample> {
    // A law calls your operator many times. Run your shader in it, or write the formula down again.
    laws::over(&right)?;
    println!("right: every law holds");

    let Err(found) = laws::over(&wrong) else { panic!("the mistake went unnoticed") };
    println!("wrong: {found}");
    assert_eq!(found.law, "blending is its closed form, up to rounding");

    // b + a (c - b) is right up to rounding: an opaque layer is a rounding off. Leave out exact laws.
    let lerp = |below: f32, a: f32, c: f32| below + a * (c - below);
    let rounds = |below: Blend<f32>, alpha: f32, color: [f32; 3]| Blend {
        color: std::array::from_fn(|i| lerp(below.color[i], alpha, color[i])),
        alpha: lerp(below.alpha, alpha, 1.0),
    };
    let Err(found) = laws::over(&rounds) else { panic!("the rounding went unnoticed") };
    println!("b + a (c - b): {found}");
    laws::over::of_kinds(&[Kind::Algebraic, Kind::Odd], &rounds)?;

    // Every operator has its laws: the epsilon-z test of a visibility pass, for example.
    laws::epsilon(&|t: f32, nearest: f32, epsilon: f32| t <= nearest + epsilon)?;
    let rounds = laws::epsilon(&|t: f32, nearest: f32, epsilon: f32| t - nearest <= epsilon);
    let Err(found) = rounds else { panic!("the rounding of the difference went unnoticed") };
    println!("t - nearest <= epsilon: {found}");
    Ok(())
}
