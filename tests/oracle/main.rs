//! The oracle: the picture by other means, known answers, laws, and bits.
//!
//! - [`eye`], [`naive`], [`pixel`]: a renderer in f64 without tiles, bins or bounds, that shares no
//!   formula with the crate; [`scenes`]: what it renders.
//! - [`tolerance`]: the tables of how far the crate may be from it, and why.
//! - [`stages`]: every stage of every path against the oracle.
//! - [`single_pass`], [`single_pass_stages`]: the same for the single-pass method;
//!   [`single_pass_identity`]: where it is the 2+1-pass method, and why not elsewhere;
//!   [`single_pass_laws`]: what groups may change in a picture; [`depth_range`]: its range of
//!   depth.
//! - [`known`]: pictures whose numbers are known in closed form.
//! - [`bounds`]: no pixel outside a splat's bounds is inside the splat.
//! - [`counter`]: a third number runs every formula and counts its operations.
//! - [`three`]: a number whose comparisons have three outcomes; [`three_outcomes`]: every decision
//!   and every formula that it can be asked.
//! - [`bits`]: fast and plain, threads and tiles, to the last bit.
//! - [`laws`]: what compositing must keep; [`groups_laws`], [`bins_laws`], [`over_laws`]: the laws
//!   of the operator over depth-images, of depth bins and of alpha-blending.
//! - [`transparent`], [`surroundings`], [`number`]: Algorithms 2 and 3, environments and refraction
//!   by other means; `transparent_stages` compares, `transparent_known` and `transparent_glass` are
//!   known answers, `transparent_laws` laws, `transparent_refused` refusals.
//! - [`peeling`]: depth peeling by other means, and every layer against it.
//! - [`template`], [`template_projection`], [`rounded`]: reconstruction with templates by other
//!   means, each number with a bound of its rounding; `template_stages` compares every plane on the
//!   scenes of `template_cases`, `template_known` are known answers, `template_laws`,
//!   `template_cover` and `template_mirror` laws.
//! - [`pyramid`]: every stage of the pull-push pyramid by other means, from [`pyramid_projection`]
//!   and [`pyramid_pieces`], [`pyramid_levels`] and [`pyramid_shade`], over numbers that bound
//!   their rounding, [`pyramid_number`]; [`pyramid_cases`]: what is drawn; [`pyramid_tolerance`]:
//!   its table. `pyramid_laws` are laws, `pyramid_known` known answers, `pyramid_rays` triangles
//!   against rays.
#![expect(
    clippy::disallowed_methods,
    reason = "std's functions, so that the oracle shares no code with the crate; its bits are free"
)]

mod bins_laws;
mod bits;
mod bounds;
mod counter;
mod depth_range;
mod eye;
mod goldens;
mod groups_laws;
mod known;
mod laws;
mod naive;
mod number;
mod over_laws;
mod peeling;
mod pixel;
mod pyramid;
mod pyramid_cases;
mod pyramid_known;
mod pyramid_laws;
mod pyramid_levels;
mod pyramid_number;
mod pyramid_pieces;
mod pyramid_projection;
mod pyramid_rays;
mod pyramid_shade;
mod pyramid_tolerance;
mod rounded;
mod scenes;
mod single_pass;
mod single_pass_identity;
mod single_pass_laws;
mod single_pass_stages;
mod stages;
mod surroundings;
mod template;
mod template_cases;
mod template_cover;
mod template_known;
mod template_laws;
mod template_mirror;
mod template_projection;
mod template_stages;
mod template_tolerance;
mod three;
mod three_outcomes;
mod tolerance;
mod transparent;
mod transparent_cases;
mod transparent_glass;
mod transparent_known;
mod transparent_laws;
mod transparent_refused;
mod transparent_stages;
mod transparent_tolerance;
