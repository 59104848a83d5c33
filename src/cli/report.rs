//! Reports of scenes, cameras, settings and times in words.

use super::say;
use glam::{DVec3, Vec3};
use splatref::frame::Exec;
use splatref::index::grouping::GroupCoverage;
use splatref::index::seen::Seen;
use splatref::io::scene_file::{Colored, GaussianReport, Loaded, ModelReport};
use splatref::io::scene_file::{OutputSettings, SceneFile};
use splatref::method::Method;
use splatref::method::session::Made;
pub(super) use splatref::report::short;
use splatref::scene::gaussians::UNDRAWABLE;
use splatref::scene::objects::detail::prefix::Estimate;
use splatref::scene::objects::{Detail, Split};
use splatref::scene::{Camera, Counts, Dropped, Gaussians, Groups, Objects, Projection, Sphere};
use splatref::scene::{Scene, Surfels};
use splatref::setting::{Fields, Word};
use splatref::source::derive::Origin;
use splatref::splat::Tally;
use std::time::Duration;

/// Prints a line with its label.
pub(super) fn line(label: &str, text: impl std::fmt::Display) {
    say(format!("{label:<10} {text}"));
}

/// Prints the models, what was derived for them, and what was dropped.
pub(super) fn scene(loaded: &Loaded) {
    let scene = &loaded.scene;
    if let Some(objects) = &scene.objects {
        return objects_of(loaded, objects);
    }
    if let (Some(gaussians), Some(report)) = (&scene.gaussians, &loaded.gaussians) {
        return gaussians_of(scene, gaussians, report);
    }
    let (name, all) = (&scene.name, content(scene.surfel_count(), scene.primitives.counts()));
    match loaded.models.as_slice() {
        [one] => line("scene", format!("{name}: {all}, {}", origin(one))),
        several => {
            line("scene", format!("{name}: {all}"));
            for model in several {
                let all = content(model.surfels as u64, model.primitives);
                line("  model", format!("{}: {all}, {}", model.name, origin(model)));
            }
        }
    }
    loaded.models.iter().for_each(colored);
    if scene.excerpt.is_some() && !scene.surfels.is_empty() {
        line("  read", format!("{} surfels, which may be seen", scene.surfels.len()));
    }
    line("  dropped", dropped(&loaded.dropped, loaded.dropped_primitives));
    offset(scene.offset);
    let (low, high) = scene.bounds();
    bounds(low, high);
    radius(&scene.surfels);
}

/// Prints a scene of 3D Gaussians, and how its file stores them.
fn gaussians_of(scene: &Scene, gaussians: &Gaussians, report: &GaussianReport) {
    let (count, degree) = (gaussians.len(), gaussians.degree());
    let name = &scene.name;
    line("scene", format!("{name}: {count} Gaussians, spherical harmonics of degree {degree}"));
    line("  read as", &report.convention);
    line("  colours", gaussians.encoding().name());
    line("  dropped", dropped_gaussians(report.dropped));
    offset(scene.offset);
    let (low, high) = scene.bounds();
    bounds(low, high);
}

/// How many Gaussians were dropped, and why.
pub(super) fn dropped_gaussians(count: u64) -> String {
    match count {
        0 => "none".into(),
        n => format!("{n} Gaussians with {UNDRAWABLE}"),
    }
}

/// How many geometries get a line; a hierarchy may have thousands of nodes.
const MOST_LINES: usize = 32;

/// Prints a scene of objects, whether its surfels are already in their places or not.
fn objects_of(loaded: &Loaded, objects: &Objects) {
    let ids = objects.ids();
    let mut used = vec![0_usize; loaded.models.len()];
    objects.objects().iter().for_each(|object| used[object.geometry] += 1);
    let surfels =
        loaded.models.iter().zip(&used).map(|(model, &used)| (model.surfels * used) as u64);
    let surfels: u64 = surfels.sum();
    let total = loaded.models.iter().zip(&used).fold(Counts::default(), |total, (model, used)| {
        let Counts { triangles, ribbons, tubes } = model.primitives;
        Counts {
            triangles: total.triangles + used * triangles,
            ribbons: total.ribbons + used * ribbons,
            tubes: total.tubes + used * tubes,
        }
    });
    line("scene", format!("{}: {}", loaded.scene.name, content(surfels, total)));
    let (count, geometries) = (objects.objects().len(), loaded.models.len());
    line("  objects", format!("{count} of {geometries} geometries, ids of {}", split(ids.split())));
    let all = loaded.models.iter().zip(used).zip(objects.geometries());
    for ((model, used), geometry) in all.take(MOST_LINES) {
        let all = content(model.surfels as u64, model.primitives);
        let of = origin(model);
        let detail = match &geometry.detail {
            None => String::new(),
            Some(Detail::Tree(tree)) => {
                format!(", {} nodes at {} px", geometry.surfels.len(), tree.threshold())
            }
            Some(Detail::Prefix(prefix)) => {
                let Estimate { count, distance } = prefix.estimate();
                format!(", ordered: {count} are {} apart", short(distance.into()))
            }
        };
        line("  geometry", format!("{}: {all}{detail}, {of}; used by {used} objects", model.name));
    }
    if geometries > MOST_LINES {
        line("  geometry", format!("and {} more", geometries - MOST_LINES));
    }
    loaded.models.iter().for_each(colored);
    if objects.have_detail() {
        line("  in view", format!("{} surfels and nodes", objects.drawn_total()));
        if objects.objects().len() == 1
            && let Some(disc) = objects.disc(0)
        {
            let (radius, side) = (short(disc.radius.into()), short(disc.side.into()));
            line("  discs", format!("of radius {radius}, {side} px at the nearest place"));
        }
    }
    line("  dropped", dropped(&loaded.dropped, loaded.dropped_primitives));
    let Sphere { center: middle, radius } = objects.bounding_sphere();
    let (middle, radius) = (point(middle.to_array()), short(radius));
    line("  bounds", format!("a sphere around {middle} of radius {radius}"));
    if surfels > 0 {
        median(objects.median_radius());
    }
}

/// Which bits of an id belong to the object.
fn split(split: Split) -> String {
    match split {
        Split::Even => "12 bits for the object and 20 for the surfel".into(),
        Split::Two => "1 bit, then 11 for the object and 20 for the surfel, or 14 and 17".into(),
        Split::Single(n) => format!("{} bits for the object and {n} for the surfel", 32 - n),
        Split::Stencil(n) => {
            let object = 40 - n;
            format!(
                "{object} bits for the object, 8 of them in the stencil, and {n} for the surfel"
            )
        }
    }
}

/// The content of a scene or a model in words.
fn content(surfels: u64, primitives: Counts) -> String {
    let Counts { triangles, ribbons, tubes } = primitives;
    let parts = [
        (surfels, "surfels"),
        (triangles as u64, "triangles"),
        (ribbons as u64, "segments of ribbons"),
        (tubes as u64, "segments of tubes"),
    ];
    let parts = parts.iter().filter(|(count, _)| *count > 0);
    let parts: Vec<String> = parts.map(|(count, what)| format!("{count} {what}")).collect();
    parts.join(", ")
}

/// The origin of a model's normals or tangents and of its radii.
fn origin(model: &ModelReport) -> String {
    let Some(derived) = &model.derived else { return "procedural".into() };
    let direction = if model.primitives.tubes > 0 { "tangents" } else { "normals" };
    let normals = format!("{direction} {}", normals(derived.normals));
    match derived.radii {
        Origin::Zero => normals,
        other => format!("{normals}, radii {}", radii(other)),
    }
}

/// Prints the range of the numbers that colour a model, if numbers do.
fn colored(model: &ModelReport) {
    let Some(Colored { by, low, high, without }) = &model.colored else { return };
    let name = &model.name;
    let mut text = format!("{name} by {}, viridis from {low} to {high}", by.escape_debug());
    if *without > 0 {
        text += &format!("; {without} points without a finite number are grey");
    }
    line("  coloured", text);
}

/// Prints what was subtracted from the coordinates of the files, with every digit.
pub(super) fn offset(offset: DVec3) {
    if offset != DVec3::ZERO {
        let DVec3 { x, y, z } = offset;
        line("  offset", format!("({x}, {y}, {z}), subtracted from the coordinates of the files"));
    }
}

/// Prints the bounding box.
pub(super) fn bounds(low: Vec3, high: Vec3) {
    let [low, high] = [low, high].map(|corner| point(corner.to_array().map(f64::from)));
    line("  bounds", format!("{low} to {high}"));
}

/// Prints the median radius, if there are surfels.
pub(super) fn radius(surfels: &Surfels) {
    if surfels.median_radius() > 0.0 {
        median(surfels.median_radius());
    }
}

fn median(radius: f32) {
    line("  radius", format!("{}, the median", short(f64::from(radius))));
}

const FACETS: &str = "from ellipses, one for each triangle";

pub(super) fn normals(origin: Origin) -> &'static str {
    match origin {
        Origin::File | Origin::Given => "from the file",
        Origin::Tangents => "derived from the tangents",
        Origin::Triangles => "derived from the triangles",
        Origin::Facets => FACETS,
        Origin::Neighbours => "derived from the nearest neighbours",
        Origin::Edges => "derived from the edges",
        Origin::Zero => "0",
    }
}

pub(super) fn radii(origin: Origin) -> &'static str {
    match origin {
        Origin::File => "from the file",
        Origin::Given => "from the scene file",
        Origin::Tangents => "derived from the tangents",
        Origin::Facets => FACETS,
        Origin::Triangles | Origin::Edges => "derived from the edges",
        Origin::Zero => "0",
        Origin::Neighbours => "derived from the nearest neighbours",
    }
}

/// How many points were dropped, and why, and how many primitives.
pub(super) fn dropped(dropped: &Dropped, primitives: u64) -> String {
    let points = match dropped.total() {
        0 => None,
        total => Some(format!("{total} points: {}", dropped.reasons())),
    };
    let lost = format!("{primitives} triangles or lines with a degenerate corner");
    match (points, primitives) {
        (None, 0) => "none".into(),
        (Some(points), 0) => points,
        (None, _) => lost,
        (Some(points), _) => format!("{points}; {lost}"),
    }
}

pub(super) fn camera(camera: &Camera) {
    let world = camera.view_from_world.row(2);
    let towards = point([world.x, world.y, world.z].map(|v| f64::from(-v)));
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    let scale = if fx == fy { short(fy) } else { format!("{} x {}", short(fx), short(fy)) };
    let kind = match camera.projection {
        Projection::Perspective => format!("perspective, focal length {scale} px"),
        Projection::Orthographic => format!("orthographic, {scale} px a world unit"),
    };
    let eye = point(camera.eye().to_array());
    line("camera", format!("{kind}, at {eye} looking along {towards}"));
    let middle = camera.size().map(|side| f64::from(side) / 2.0);
    if [cx, cy] != middle {
        line("", format!("principal point ({}, {})", short(cx), short(cy)));
    }
    if let Some(other) = camera.other_eye {
        let apart = f64::from(other) - f64::from(camera.view_from_world.w_axis.x);
        let side = if apart < 0.0 { "left" } else { "right" };
        line("", format!("{side} eye of a stereo pair, {} apart", short(apart.abs())));
    }
}

/// Says if the scene reaches beyond the far plane of another renderer.
pub(super) fn far(file: &SceneFile, scene: &Scene, camera: &Camera) {
    let Some(far) = file.camera.far else { return };
    let Sphere { center: middle, radius } = scene.bounding_sphere();
    let reach = radius - camera.view_from_world.as_dmat4().transform_point3(middle).z;
    if reach > far {
        let (far, reach) = (short(far), short(reach));
        line("", format!("far plane {far}, but the scene reaches to {reach}: all of it is drawn"));
    }
}

/// Prints the method, its settings, and the values that they give in a scene.
pub(super) fn method(method: &Method, scene: &Scene, camera: &Camera) {
    settings(method);
    for (name, value) in method.settings_in_scene(scene, camera) {
        line("", format!("{name} = {value}"));
    }
}

/// Prints the method and its settings.
pub(super) fn settings(method: &Method) {
    let values = method.values().into_iter().map(|(name, value)| (name, value.text()));
    let settings: Vec<String> = values.map(|(name, value)| format!("{name} = {value}")).collect();
    line("method", format!("{}, {}", method.name(), settings.join(", ")));
}

/// Prints the groups, and how they were made.
pub(super) fn groups(groups: Option<&Groups>, made: Option<&Made>) {
    let Some(groups) = groups else { return };
    let Some((report, extended)) = made else {
        return line("groups", format!("{}, from the file", groups.len()));
    };
    line(
        "groups",
        format!(
            "{} at c = {}, degree {} at most and {:.1} on average",
            report.groups, report.overlap, report.max_degree, report.average_degree
        ),
    );
    if let Some(extended) = extended {
        let mean = |of: fn(&GroupCoverage) -> f64| {
            extended.groups.iter().map(of).sum::<f64>() / extended.groups.len() as f64
        };
        line(
            "",
            format!(
                "each covers {:.0} % of the surface, {:.0} % after extension; {:.0} % surfels \
                 added",
                100.0 * mean(|group| group.before),
                100.0 * mean(|group| group.after),
                extended.percent
            ),
        );
    }
}

pub(super) fn picture(camera: &Camera, output: OutputSettings) {
    let number = output.number.word();
    let stages = if output.stages { ", with the planes of every stage" } else { "" };
    let formats = output.formats;
    let stored = match formats.keep_all() {
        true => String::new(),
        false => format!(", stored as {}, depths {}", formats.buffers.word(), formats.depth.word()),
    };
    let Camera { width, height, .. } = *camera;
    line("picture", format!("{width} x {height} pixels, {number}{stored}{stages}"));
}

/// Prints how many of the surfels in view a method selected, if it selects.
pub(super) fn selection(scene: &Scene, seen: Option<&Seen>) {
    let Some(seen) = seen else { return };
    let of = |counts: &[u32]| counts.iter().map(|&count| u64::from(count)).sum::<u64>();
    let objects = scene.objects.as_ref();
    let all = objects.map_or_else(|| of(seen.counts()), Objects::drawn_total);
    let selected = of(seen.selected());
    let culled = 100.0 * (all - selected) as f64 / all.max(1) as f64;
    line("selected", format!("{selected} of {all} surfels, {culled:.1} % culled"));
}

/// Prints how many surfels were drawn, and why the others were not.
pub(super) fn tally(tally: &Tally) {
    line(
        "surfels",
        format!(
            "{} drawn, {} behind the camera, {} degenerate, {} back-facing, {} outside",
            tally.visible, tally.behind, tally.degenerate, tally.back_facing, tally.outside
        ),
    );
    if tally.visible == 0 && tally.back_facing > 0 {
        let all = tally.behind + tally.degenerate + tally.outside == 0;
        let who = if all { "all surfels" } else { "all surfels in view" };
        let what = "face away from the camera, so the picture shows none; give --cull=off to draw";
        line("", format!("{who} {what} their backs"));
    }
}

/// The number of threads in words.
pub(super) fn threads(exec: &Exec) -> String {
    match exec.threads() {
        1 => "1 thread".into(),
        n => format!("{n} threads"),
    }
}

/// Prints one time, or the minimum and the lower median of several.
pub(super) fn time(what: &str, mut times: Vec<Duration>) {
    times.sort();
    let show = |time: Duration| format!("{:>10.2} ms", time.as_secs_f64() * 1e3);
    match times.as_slice() {
        [] => {}
        [one] => line("", format!("{what:<14}{}", show(*one))),
        [least, ..] => {
            let median = times[(times.len() - 1) / 2];
            line("", format!("{what:<14}{} {}", show(*least), show(median)));
        }
    }
}

fn point(v: [f64; 3]) -> String {
    format!("({})", v.map(short).join(", "))
}
