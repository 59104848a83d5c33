//! `splatref`: the ground truth for point-splatting renderers.
//!
//! splatref is a tile-parallel software rasterizer that runs on the CPU. It implements published
//! splatting algorithms as specified. Authors of GPU backends use it to generate golden images, to
//! prove their compositing math, and to learn whether their picture is right. The documentation of
//! each stage is normative: an engineer who has only these pages gets the same bits in any other
//! language.
//!
//! # Start here
//!
//! What do you want to do?
//!
//! - **Render a scene**: [`SceneFile::open`] loads a shape, a PLY or a scene file, and
//!   [`Session::render`] draws it.
//! - **Render many views**: one [`Session`] draws its scene from as many cameras as you like.
//! - **Get every plane**: [`Session::define`] keeps the planes that each pass leaves.
//! - **Save them**: [`io::exr::write()`] puts all planes of a [`Frame`] into one file.
//! - **Understand a pixel**: [`Session::explain`] lists every decision at one pixel, in words.
//! - **Compare two pictures**: [`compare::compare`] says whether they are equal bit for bit, and
//!   where not.
//! - **Measure an error**: [`compare::metrics`] has the numbers that rank methods.
//! - **Verify your planes**: [`Session::verify`] recomputes each stage from your own planes,
//!   without a tolerance.
//! - **Find the mistake**: [`verdict::causes`] knows the usual ones, and tells which of them you
//!   make.
//! - **Test your operators against the laws**: [`laws`] tries your compositing at many inputs and
//!   returns a counterexample.
//! - **Write a GPU backend**: [`backends`] says what your GPU must promise, and which planes to
//!   export.
//! - **Implement a pass**: each method has a page with every formula, e.g. [`method::ewa`].
//! - **Choose a method**: [a chapter for each](#the-methods-a-chapter-each) says what to know
//!   before you use it.
//! - **Make a scene**: [`source`] samples shapes and meshes, and [`scene`] holds surfels, cameras
//!   and lights.
//!
//! # Example
//!
//! Open a scene by its name, render it into memory, and compare another renderer's picture with it:
//!
//! ```
//! use splatref::frame::Image;
//! use splatref::compare::{Criteria, Verdict, compare};
//! use splatref::{Exec, SceneFile};
//!
//! let exec = Exec::new(0, 32)?; // every core, tiles of 32 pixels
//! let mut file = SceneFile::open("sphere")?; // a shape, "bunny.ply" or "scene.toml"
//! file.camera.size = Some([64, 48]);
//! let ready = file.ready(&exec, &|_step, _done, _of| ())?;
//! let (mut session, _) = ready.session(&exec, &|_step, _done, _of| ())?;
//! let picture = session.render(&ready.camera)?;
//!
//! let depth = picture.frame.scalar("Z")?;
//! assert!(depth.at(32, 24).is_finite(), "the sphere is in the middle");
//! assert!(depth.at(0, 0).is_infinite(), "and not in the corner");
//!
//! let theirs = Image::from(&picture.frame); // or io::exr::read, or a Frame of your own planes
//! let found = compare(&Image::from(&picture.frame), &theirs, &Criteria::default())?;
//! assert_eq!(found.verdict(), Verdict::Equal);
//! # Ok::<(), splatref::Error>(())
//! ```
//!
//! # The contract
//!
//! 1. **One formula, several numbers.** The arithmetic of a splat or a fragment is written once,
//!    generic over [`number::Real`]. `f32` is the executable specification: the bits that a GPU
//!    gets from the same IEEE operations in the same order. `f64` is the truth of the same problem,
//!    because every input and every constant is an `f32`.
//! 2. **What may change the picture, how may not.** [`method::Method`] says what is computed.
//!    [`frame::Exec`] (threads, tile size) says how, and cannot change one bit.
//! 3. **Every pass can be seen.** Each stage leaves named planes. You can keep them, write them to
//!    one EXR file, compare them, and have them explained pixel by pixel.
//!
//! Bits are a function of (scene, camera, settings, number type) alone. They do not depend on
//! threads, tile size, build flags or the host. Therefore:
//!
//! - The code uses only + - * / sqrt, floor, comparisons and conversions, and `mul_add` nowhere.
//!   exp, pow, sin ... come only from [`number::elementary`].
//! - Sums run in ascending surfel index.
//! - clippy rejects the rest (`clippy.toml`).
//! - A program that links this crate gets scalar glam. The features `scalar-math` and `libm` of
//!   glam are on, because the SIMD of glam changes bits.
//!
//! # Conventions
//!
//! ```text
//!            +y up                      0 ───▶ X (pixels)
//!             │                         │ ┌───┬───┐
//!             │                         ▼ │0,0│1,0│  pixel (0, 0) is top left,
//!   camera ●──┼───▶ +x right            Y ├───┼───┤  its centre at (0.5, 0.5)
//!         ╱                               │0,1│1,1│
//!     -z ╱  the camera looks along -z     └───┴───┘
//!
//!   depth t = -z > 0, linear, world units
//! ```
//!
//! - An empty pixel has depth +inf, weight 0, colour 0, id [`frame::NO_ID`]. No plane ever holds a
//!   NaN, and -0 is stored as +0.
//! - Colours are linear RGB, not premultiplied. EXR holds the numbers, PNG previews are sRGB.
//! - Every tie: the lower surfel index wins. Every threshold states < or <=.
//!
//! # Read in this order
//!
//! 1. This page: the contract above, the pipeline and the glossary below.
//! 2. [`scene`], the input: surfels, camera, lights. [`source`] makes scenes. An [`index`] is built
//!    once and queried for every view.
//! 3. [`splat`] turns a surfel into its footprint on the screen. All methods but three stand on it.
//! 4. [`method::ewa`], because the other methods refer to it. Then read the method you came for:
//!    each has a chapter below.
//! 5. [`composite`], the algebra of fragments, and its [`laws`].
//! 6. [`compare`] says whether two pictures are equal, and how far they are apart. [`verdict`] says
//!    which planes a correct implementation may leave. Read [`backends`] if the other picture comes
//!    from a GPU.
//!
//! Read the rest when you need it: [`frame`] (planes and tiles), [`number`] (what a number must be
//! able to do), [`shade`] (lighting of finished planes), [`io`] (files). In the pages of the
//! modules `Decided:` marks what a source leaves open, and `Departs:` where this crate differs.
//!
//! # The pipeline
//!
//! ```text
//!   io::ply ─▶ Cloud ─▶ source::derive ─▶ Scene ──▶ splat::project ─▶ Splat ─▶ frame::Bins
//!                        Shape::surfels ──┘ │                                      │
//!   before any view:   index::grouping ◀────┤                                tiles │
//!                      index::order ◀───────┘                                      ▼
//!   method::ewa            visibility ─▶ attributes ─▶ normalization ────────────┐
//!   method::deferred       visibility ─▶ indices ─▶ the passes of ewa ───────────┤
//!   method::single_pass    depth-images of groups ─▶ compositing ────────────────┤
//!   method::transparent    blended groups ─▶ average ────────────────────────────┤
//!   method::transparent_hq nearest layer ─▶ blended groups ─▶ average ───────────┤
//!   method::peeling        layer after layer ────────────────────────────────────┤
//!   without splats, from surfels, triangles, ribbons and tubes:                  │
//!   method::pyramid        projection ─▶ pull ─▶ push ───────────────────────────┤
//!   method::template       projection ─▶ propagation ─▶ reconstruction ──────────┤
//!   without splats, from surfels and triangles:                                  │
//!   method::blue           discs ────────────────────────────────────────────────┤
//!   from 3D Gaussians, or surfels as 2D ones:                                    │
//!   method::gaussians      projection ─▶ blending in order ──────────────────────┤
//!                                                                                ▼
//!          compare ◀─ io::exr ◀─ Frame ◀─ scene::environment ◀─ shade::{phong, optics}
//! ```
//!
//! # The methods, a chapter each
//!
//! - [`method::ewa`]: EWA surface splatting \[ZPvBG01, GP03\]. The first geometry pass finds the
//!   nearest surface. The second adds the fragments within epsilon of that surface. *To know:* the
//!   visible surface is a band of depth. Its width epsilon is a setting, in world units or in
//!   median radii.
//! - [`method::deferred`]: an index buffer keeps some surfels, and the passes of EWA draw only
//!   these, in scenes of moving objects, with levels of detail and polygons \[GBP04\]. *To know:*
//!   each frame uses what the previous frame saw. One surfel a pixel is kept, so dense surfels
//!   flicker; prefiltered colours flicker less.
//! - [`method::single_pass`]: one geometry pass into a depth-image for each group \[ZP06, Algorithm
//!   1\]. *To know:* surfels of one group must not overlap, or only a little. [`index::grouping`]
//!   makes the groups, and c says how little.
//! - [`method::transparent`]: layers blended from back to front within each group, then the average
//!   of the groups \[ZP06, Algorithm 2\]. *To know:* every group has to cover the surface alone, so
//!   groups are extended. What a hole counts as is a setting.
//! - [`method::transparent_hq`]: the same behind a nearest layer in high quality, with reflection
//!   and refraction \[ZP06, Algorithm 3\]. *To know:* the single pass draws the nearest layer, and
//!   Algorithm 2 draws the layers behind it.
//! - [`method::peeling`]: depth peeling, layer after layer from the front \[Mam89, Eve02\]. *To
//!   know:* peeling is the slow truth of transparency with the same epsilon. Use it to judge the
//!   averages of [`method::transparent`].
//! - [`method::pyramid`]: one pixel a point; averages are pulled up a pyramid and pushed down it to
//!   fill the gaps \[MKC08\]. *To know:* no splats are drawn. Triangles, ribbons and tubes take
//!   part. An ellipse stands around the centre of a pixel.
//! - [`method::template`]: one pixel a point, and a search in k x k cells of each level for the
//!   ellipses that hold a pixel \[MOC08\]. *To know:* the rule of levels decides how much of an
//!   ellipse is reached, and what merges.
//!
//! - [`method::blue`]: opaque discs in squares on the screen, the nearest in each pixel \[BJFM19\].
//!   *To know:* the surfels of an order that are drawn, and their size, are chosen before. Nothing
//!   is filtered.
//!
//! - [`method::gaussians`]: 3D Gaussian splats, or surfels as 2D ones, blended from front to back. *To
//!   know:* programs differ in details. Each is a setting, and presets draw as they do.
//!
//! [`method::pyramid`] and [`method::template`] begin with [`mod@method::projection`].
//! [`method::Method`] holds any method as a value. [`method::Session`] draws one scene with one
//! method, from as many cameras as you like. The pages under `docs/` measure what each paper
//! claims. The program's feature `cli` has `study`: the true picture of a scene, every method and
//! setting against that picture and the clock, and the atlas of failures.
//!
//! # Glossary
//!
//! | term | meaning |
//! |---|---|
//! | surfel | a disc or ellipse of the scene: position, normal, radius, attributes |
//! | splat | a surfel on the screen: its footprint and its bounds |
//! | footprint | the kernel on the screen: centre, conic, plane of nearness, amplitude |
//! | conic | the matrix Q of the form q = d^T Q d at an offset d from the centre |
//! | kernel | the Gaussian of the disc, cut at k standard deviations |
//! | low-pass filter | the Gaussian of variance h px^2 that the kernel is convolved with |
//! | fragment | one splat at one pixel |
//! | nearness | 1/t, or -t under an orthographic camera: larger is nearer |
//! | visibility pass | finds the nearest fragment of every pixel |
//! | attribute pass | adds weighted attributes of the visible fragments |
//! | epsilon-z | the test that a fragment lies within epsilon of the nearest: t <= `t_min` + epsilon |
//! | normalization | sums divided by the sum of weights |
//! | group | surfels that share one depth-image, because they do not overlap, or only a little |
//! | depth-image | the planes that the splats of one group leave: one fragment a pixel |
//! | depth bin | a step of low-precision depth; fragments of one bin are one layer |
//! | Voronoi-enhanced depth | depth bin, then distance from the splat's own centre |
//! | projection to single pixels | the nearest sample of the scene in each pixel, with its radius in pixels |
//! | level, cell | an image of a pyramid, each half as wide as the finer one; a pixel of it |
//! | pull, push | average finer levels into coarser ones; go back and fill empty or occluded cells |
//! | displacement | the offset from the centre of a cell to the centre of its ellipse, in pixels |
//! | mipmap | the prefiltered colours of a surfel: averages over 2, 4, 8 ... of its radii |
//! | texture, texel | a picture on a mesh, placed by the coordinates (u, v) of the mesh's corners; a pixel of it |
//! | template | the k x k cells of a level around a pixel, in which it searches for ellipses |
//! | ribbon, tube | a flat strip, a bent cylinder: polylines drawn one pixel wide and reconstructed |
//! | layer | one of the surfaces that a ray passes through |
//! | opacity | alpha, the part of the light from behind that a surfel blocks |
//! | plane | one quantity for every pixel |
//! | tile, strip, bin | a square of pixels that one thread owns; the same in a fast path, 64 pixels wide if tiles are smaller; the list of its splats |
//! | ball | all values that a correct implementation may have: a midpoint and a radius |
//! | client | another renderer, whose planes are judged |
//! | certificate | the proof that a fragment may be the nearest: it may be there, and nothing certainly is nearer |
//! | doubt | a decision that correct implementations may take either way |
//! | margin | the distance of a decision from being undecided, in radii of its operands' balls |
//!
//! # Sources
//!
//! - \[ANA+20\] Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: FLIP: A Difference
//!   Evaluator for Alternating Images, HPG 2020.
//! - \[BHZK05\] Botsch, Hornung, Zwicker, Kobbelt: High-Quality Surface Splatting on Today's GPUs,
//!   PBG 2005.
//! - \[BJFM19\] Brandt, Jähn, Fischer, Meyer auf der Heide: Rendering of Complex Heterogenous Scenes
//!   using Progressive Blue Surfels, 2019.
//! - \[Eve02\] Everitt: Interactive Order-Independent Transparency, 2002.
//! - \[GBP04\] Guennebaud, Barthe, Paulin: Deferred Splatting, Eurographics 2004.
//! - \[GP03\] Guennebaud, Paulin: Efficient screen space approach for hardware accelerated surfel
//!   rendering, VMV 2003.
//! - \[HYCGG24\] Huang, Yu, Chen, Geiger, Gao: 2D Gaussian Splatting for Geometrically Accurate
//!   Radiance Fields, SIGGRAPH 2024.
//! - \[Lei79\] Leighton: A Graph Coloring Algorithm for Large Scheduling Problems, J. Res. NBS 84,
//!   1979.
//! - \[Mam89\] Mammen: Transparency and Antialiasing Algorithms, IEEE CG&A 9(4), 1989.
//! - \[MKC08\] Marroquim, Kraus, Cavalcanti: Efficient Image Reconstruction for Point-Based and
//!   Line-Based Rendering, Computers & Graphics 32, 2008.
//! - \[MOC08\] Marroquim, Oliveira, Cavalcanti: High Quality Image Reconstruction of Point Models,
//!   SIBGRAPI 2008.
//! - \[Sam89\] Samet: The Design and Analysis of Spatial Data Structures, 1989.
//! - \[TCH05\] Talton, Carr, Hart: Voronoi Rasterization of Sparse Point Sets, PBG 2005.
//! - \[WBSS04\] Wang, Bovik, Sheikh, Simoncelli: Image Quality Assessment, IEEE TIP 2004.
//! - \[ZP06\] Zhang, Pajarola: Single-Pass Point Rendering and Transparent Shading, PBG 2006.
//! - \[ZPvBG01\] Zwicker, Pfister, van Baar, Gross: Surface Splatting, SIGGRAPH 2001.
//! - \[ZRB+04\] Zwicker, Räsänen, Botsch, Dachsbacher, Pauly: Perspective Accurate Splatting,
//!   Graphics Interface 2004.

#![forbid(unsafe_code)]
#![warn(clippy::print_stdout, clippy::print_stderr)]

#[doc = include_str!("../docs/backends.md")]
pub mod backends {}
pub mod compare;
pub mod composite;
pub mod error;
pub mod frame;
pub mod index;
pub mod io;
pub mod laws;
pub mod memory;
pub mod method;
pub mod number;
pub mod progress;
#[cfg(feature = "cli")]
pub mod report;
pub mod scene;
pub mod setting;
pub mod shade;
pub mod source;
pub mod splat;
#[cfg(feature = "cli")]
pub mod study;
pub mod verdict;

pub use error::{Error, Result};
pub use frame::{Exec, Frame};
pub use io::scene_file::SceneFile;
pub use method::{Method, Session};
pub use scene::{Camera, Scene};
