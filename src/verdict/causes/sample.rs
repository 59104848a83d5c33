//! Try mistakes on parts of a large picture, because each trial judges the client again:
//!
//! 1. A pilot of 256 pixels rejects most mistakes, and says about where a number lies. The surfels around
//!    it are looked for once.
//! 2. The tiles with the most wrong pixels, 8192 pixels at most, say which mistakes explain them.
//! 3. Every fourth tile confirms the mistake. The whole picture decides only where few pixels are
//!    wrong, or where two mistakes explain about the same.

use super::change::Change;
use super::{Case, Explanation, FEWEST, Wrong};
use crate::error::Result;
use crate::frame::Rect;
use crate::method::Method;
use crate::method::part::Around;
use crate::method::tiled::pixels;
use crate::number::MapInline;
use crate::verdict::StageVerdict;
use crate::verdict::client::Client;
use crate::verdict::deferred::lists_surfels;
use crate::verdict::supposed::Supposed;
use std::cell::OnceCell;
use std::cmp::Reverse;
use std::sync::Arc;

/// The most pixels that are judged in each trial.
const MOST: usize = 8192;
/// The most explanations of the part that are tried on the whole picture.
const TRIED: usize = 3;

/// Whether the picture is so large that trials judge a part of it.
pub(super) fn is_large(case: &Case<'_, '_>) -> bool {
    case.wrong.errors.values().len() > 2 * MOST
}

/// Whether a verdict can judge some tiles alone. The passes of `deferred` choose surfels from the whole
/// picture, so that its client must list them.
fn has_tiles(case: &Case<'_, '_>) -> bool {
    let is_deferred = matches!(case.session.method(), Method::Deferred(_));
    !is_deferred || lists_surfels(case.client)
}

/// The fewest pixels that are judged first in each trial, and the side of the squares that they are in.
const PILOT: usize = 256;
const SIDE: u32 = 8;

/// The client as a part of its picture shows it, and as a few pixels of that part show it.
pub(super) struct Parts {
    part: Client,
    pilot: Client,
}

/// The parts with the most wrong pixels; none if the whole picture is judged.
pub(super) fn parts(case: &Case<'_, '_>) -> Option<Parts> {
    if !is_large(case) || !has_tiles(case) {
        return None;
    }
    let job = case.session.job(case.camera).ok()?;
    let grid = job.grid();
    let rects = grid.rects();
    let stages = near(case);
    let mut wrong = vec![0_u64; rects.len()];
    for stage in stages {
        let width = stage.errors.width() as usize;
        for (i, _) in stage.errors.values().iter().enumerate().filter(|(_, error)| **error > 1.0) {
            let [x, y] = [i % width, i / width].map_inline(|at| at as u32);
            wrong[grid.place(x, y).0] += 1;
        }
    }
    let mut tiles: Vec<usize> = (0..rects.len()).filter(|&tile| wrong[tile] > 0).collect();
    tiles.sort_by_key(|&tile| (Reverse(wrong[tile]), tile));
    let mut judged = 0;
    tiles.retain(|&tile| {
        judged += rects[tile].pixels();
        judged <= MOST
    });
    let of_tile = |tile: usize| {
        let rect = rects[tile];
        let corners = pixels(rect).filter(|(x, y)| x % SIDE == 0 && y % SIDE == 0);
        let squares = corners.map(|(x0, y0)| Rect { x0, y0, x1: x0 + SIDE, y1: y0 + SIDE });
        let mut squares: Vec<_> = squares.map(|square| square.intersection(&rect)).collect();
        squares.sort_by_cached_key(|square| {
            Reverse(near(case).map(|own| count(own, *square)).sum::<u64>())
        });
        squares.into_iter().map(move |square| (tile, square))
    };
    // The worst square of each tile, then the second of each.
    let mut squares: Vec<_> = tiles.iter().flat_map(|&tile| of_tile(tile).enumerate()).collect();
    squares.sort_by_key(|(turn, _)| *turn);
    let squares = squares.into_iter().map(|(_, square)| square).take(PILOT / SIDE.pow(2) as usize);
    // Levels are judged from the planes of the projection that the client hands in, so that its mistake
    // does not show in them.
    let is_first = case.session.method().projects_regions() && case.wrong.stage == "projection";
    let client = match is_first {
        true => case.client.with_planes(|name| name.starts_with("projection.")),
        false => case.client.clone(),
    };
    let of = |pieces: Arc<[_]>| {
        let around = Around::new(&job, &pieces).map(Arc::new);
        Client { part: Some(pieces), around, ..client.clone() }
    };
    let part = of(tiles.iter().map(|&tile| (tile, rects[tile])).collect());
    Some(Parts { part, pilot: of(squares.collect()) })
}

/// The first wrong stage and the next one.
pub(super) fn near<'a>(case: &'a Case<'_, '_>) -> impl Iterator<Item = &'a StageVerdict> {
    case.verdict.stages.iter().skip_while(|stage| stage.stage != case.wrong.stage).take(2)
}

/// Number of wrong pixels in a rectangle.
fn count(stage: &StageVerdict, rect: Rect) -> u64 {
    pixels(rect).filter(|(x, y)| *stage.errors.at(*x, *y) > 1.0).count() as u64
}

/// One in this many tiles is judged where that is enough, and the fewest pixels that must be wrong
/// there.
const ONE_IN: usize = 4;
const ENOUGH: u64 = 1024;
/// Two explanations whose shares differ by more than this in those tiles differ in the picture.
const NEAR_PERCENT: u64 = 5;

/// The client in tiles that are spread evenly over the picture, and what is wrong there. None if too
/// few pixels are wrong there.
fn spread(case: &Case<'_, '_>) -> Result<Option<(Client, Wrong)>> {
    let grid = case.session.job(case.camera)?.grid();
    let columns = grid.columns as usize;
    let tiles = grid.rects().into_iter().enumerate();
    let some =
        tiles.filter(|(tile, _)| (tile % columns + 2 * (tile / columns)).is_multiple_of(ONE_IN));
    let part: Arc<[_]> = some.collect();
    let wrong = |stage| part.iter().map(|(_, rect)| count(stage, *rect)).sum::<u64>();
    // Records are judged wherever they are.
    if case.client.has_records() || near(case).map(wrong).sum::<u64>() < ENOUGH {
        return Ok(None);
    }
    let all = case.verdict.stages.iter().map(wrong).sum();
    let wrong = Wrong { near: near(case).map(wrong).sum(), all, size: 0.0 };
    Ok(Some((Client { part: Some(part), ..case.client.clone() }, wrong)))
}

/// Those explanations of a part that explain the whole picture, with what they leave there, or in
/// every fourth tile if there is only one.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn confirmed(
    whole: &Case<'_, '_>,
    mut found: Vec<Explanation>,
) -> Result<Vec<Explanation>> {
    found.sort_by_key(|one| one.left.all);
    found.truncate(TRIED);
    // In the part nearly all pixels may be wrong.
    let is_coarse = |change: &_| matches!(change, Change::Supposed(Supposed::CoarseExp(_)));
    found.retain(|one| !is_coarse(&one.change) || whole.is_one_in(2));
    if let Some((client, all)) = spread(whole)? {
        found = explained(whole, &client, all, found)?;
        let best = found.iter().map(|one| one.left.all).min().unwrap_or(0);
        found.retain(|one| 100 * (one.left.all - best) <= NEAR_PERCENT * all.all);
        // One mistake is named without its share, and so needs no exact counts.
        if found.len() < 2 {
            return Ok(found);
        }
    }
    explained(whole, whole.client, whole.all, found)
}

/// Those explanations that explain what is wrong in a client, with what they leave there.
fn explained(
    case: &Case<'_, '_>,
    client: &Client,
    all: Wrong,
    some: Vec<Explanation>,
) -> Result<Vec<Explanation>> {
    let mut found = Vec::new();
    for one in some {
        let left = case.judge_client(&one.change, client)?;
        let left = left.filter(|left| left.is_at_most(one.most, all));
        found.extend(left.map(|left| Explanation { left, ..one }));
    }
    Ok(found)
}

/// What is found by `search` in a part, if the stage is wrong there.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn in_part(
    whole: &Case<'_, '_>,
    Parts { part, pilot }: &Parts,
    search: impl FnOnce(&Case<'_, '_>) -> Result<Vec<Explanation>>,
) -> Result<Vec<Explanation>> {
    let (session, camera, budget) = (whole.session, whole.camera, whole.verdict.budget);
    let judge = |client| session.verify_as(session.method(), camera, client, budget);
    let (verdict, at_first) = (judge(part)?, judge(pilot)?);
    let stage = verdict.stages.iter().find(|stage| stage.stage == whole.wrong.stage);
    let Some(wrong) = stage.filter(|stage| stage.wrong > 0) else { return Ok(Vec::new()) };
    let all = Wrong::of(&verdict, wrong.stage);
    let stages = whole.stages.clone();
    let at_first = Wrong::of(&at_first, wrong.stage);
    let pilot = (at_first.near >= FEWEST).then_some((pilot, at_first));
    let (client, verdict) = (part, &verdict);
    let (depths, plane_depths) = (OnceCell::new(), OnceCell::new());
    let of_part =
        Case { session, camera, client, verdict, wrong, stages, all, pilot, depths, plane_depths };
    search(&of_part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use crate::method::{Method, Session, ewa, single_pass};
    use crate::scene::{Camera, Lens, Scene, Surfels};
    use crate::source::Shape;
    use crate::splat::{Kernel, Outline};
    use crate::verdict::causes::likely_cause;
    use crate::verdict::tests::camera;

    #[test]
    fn the_mistake_of_a_large_picture_is_named() {
        let exec = Exec::new(2, 32).unwrap();
        let scene = Scene::unlit("", Shape::Sphere.surfels(600, 3).unwrap());
        let camera = camera(Shape::Sphere, [176, 128], None);
        let right = ewa::Settings::default();
        let named = |method, mistaken: (&Scene, Method), by: &Camera| {
            let session = Session::new(&scene, method, &exec).unwrap();
            let mistaken = Session::new(mistaken.0, mistaken.1, &exec).unwrap();
            let client = Client::from(&mistaken.define::<f32>(by, true).unwrap().frame);
            let verdict = session.verify(&camera, &client, 1.0).unwrap();
            likely_cause(&session, &camera, &client, &verdict).unwrap().unwrap_or_default()
        };
        let kernel = Kernel { cutoff: 1.9, ..right.kernel };
        let mistaken = ewa::Settings { kernel, ..right };
        let cutoff = named(right.into(), (&scene, mistaken.into()), &camera);
        assert_eq!(cutoff, "the cut-off is 1.9, not 2");
        // Errors fall only close to the right lens.
        let wide = Camera { fx: 0.9 * camera.fx, fy: 0.9 * camera.fy, ..camera };
        let lens = named(right.into(), (&scene, right.into()), &wide);
        assert!(lens.starts_with("another field of view"), "{lens}");
        for (by, name) in
            [(-0.5, "the picture is -0.5 px too far right"), (0.5, "half a pixel to the right")]
        {
            let moved = Camera { cx: camera.cx + by, ..camera };
            assert_eq!(named(right.into(), (&scene, right.into()), &moved), name);
        }
        // Half a degree is not half a pixel.
        let turn = glam::Mat4::from_rotation_z(0.5_f32.to_radians());
        let tilted = Camera { view_from_world: turn * camera.view_from_world, ..camera };
        let tilt = named(right.into(), (&scene, right.into()), &tilted);
        assert_eq!(tilt, "the camera is tilted by 0.5 degrees");
        let method = Method::by_name("deferred").unwrap();
        for by in [0.9, 1.001] {
            let wrong = Camera { fx: by * camera.fx, fy: by * camera.fy, ..camera };
            let lens = named(method, (&scene, method), &wrong);
            assert!(lens.starts_with("another field of view"), "{lens}");
        }
        // Parts of the pyramid and the template have the projection alone.
        let mut cloud = scene.surfels.clone().into_cloud();
        cloud.radius.iter_mut().flatten().for_each(|radius| *radius *= 1.2);
        let larger = Scene::unlit("", Surfels::new(cloud).unwrap().0);
        for method in ["pyramid", "template"] {
            let method = Method::by_name(method).unwrap();
            let radii = named(method, (&larger, method), &camera);
            assert_eq!(radii, "radii are 1.2 times as large", "{}", method.name());
        }
    }

    #[test]
    fn a_part_with_levels_is_judged_as_in_the_whole_picture() {
        let exec = Exec::new(2, 32).unwrap();
        let mut wrong = [0; 5];
        let changes = [
            Change::Supposed(Supposed::PullSide(2.0)),
            Change::Flipped,
            Change::Unsigned,
            Change::Decoded(1),
        ];
        for scene in [Shape::Sphere.surfels(300, 3).unwrap(), Shape::Torus.surfels(200, 1).unwrap()]
        {
            let scene = Scene::unlit("", scene);
            let camera = camera(Shape::Sphere, [90, 70], None);
            let moved = Camera { cx: camera.cx + 0.7, ..camera };
            let all: Vec<_> = exec.grid(90, 70).rects().into_iter().enumerate().collect();
            for method in ["pyramid", "template"] {
                let method = Method::by_name(method).unwrap();
                let session = Session::new(&scene, method, &exec).unwrap();
                let client = Client::from(&session.define::<f32>(&moved, true).unwrap().frame);
                for change in &changes {
                    let judged = |part| {
                        let client = Client { part, ..client.clone() };
                        change.judge(&session, &camera, &client, 1.0).unwrap().unwrap()
                    };
                    let whole = judged(None);
                    for part in [&all[..2], &all[5..6]] {
                        let own = judged(Some(part.into()));
                        for (i, (whole, own)) in whole.stages.iter().zip(&own.stages).enumerate() {
                            let at = part.iter().flat_map(|(_, rect)| pixels(*rect));
                            let errors: Vec<_> = at.map(|(x, y)| *whole.errors.at(x, y)).collect();
                            assert_eq!(own.errors.values(), errors, "{}", own.stage);
                            wrong[i] += own.wrong;
                        }
                    }
                }
            }
        }
        assert!(wrong[..4].iter().all(|wrong| *wrong > 100), "{wrong:?}");
    }

    #[test]
    fn a_part_of_deferred_is_judged_as_in_the_whole_picture() {
        let exec = Exec::new(2, 32).unwrap();
        let scene = Scene::unlit("", Shape::Torus.surfels(600, 3).unwrap());
        let camera = camera(Shape::Torus, [112, 96], None);
        let moved = Camera { cx: camera.cx + 0.7, ..camera };
        let method = Method::by_name("deferred").unwrap();
        let mut session = Session::new(&scene, method, &exec).unwrap();
        // In the second frame, pass 1 draws what the first one has seen.
        session.render(&camera).unwrap();
        let client = Client::from(&session.define::<f32>(&moved, true).unwrap().frame);
        let all: Vec<_> = exec.grid(112, 96).rects().into_iter().enumerate().collect();
        let inner =
            |(tile, rect): (usize, Rect)| (tile, Rect { x0: rect.x0 + 5, y1: rect.y1 - 9, ..rect });
        let mut wrong = [0; 6];
        for part in [all.clone(), all.iter().step_by(5).copied().map(inner).collect()] {
            let judged = |part| {
                let client = Client { part, ..client.clone() };
                session.verify_as(&method, &camera, &client, 1.0).unwrap()
            };
            let (whole, own) = (judged(None), judged(Some(part.clone().into())));
            for (i, (whole, own)) in whole.stages.iter().zip(&own.stages).enumerate() {
                let at = part.iter().flat_map(|(_, rect)| pixels(*rect));
                let errors: Vec<_> = at.map(|(x, y)| *whole.errors.at(x, y)).collect();
                assert_eq!(own.errors.values(), errors, "{}", own.stage);
                wrong[i] += own.wrong;
            }
        }
        // Visibility, indices, difference and sums.
        assert!(wrong[..4].iter().all(|wrong| *wrong > 50), "{wrong:?}");
        let unlisted = client.with_planes(|name| name != "indices.id");
        let unlisted = Client { part: Some(all.into()), ..unlisted };
        assert!(session.verify_as(&method, &camera, &unlisted, 1.0).is_err());
    }

    #[test]
    fn a_part_is_judged_as_in_the_whole_picture() {
        let exec = Exec::new(2, 32).unwrap();
        let scene = Scene::unlit("", Shape::Sphere.surfels(600, 3).unwrap());
        let corner =
            |(tile, rect): (usize, Rect)| (tile, Rect { x0: rect.x1 - 9, y0: rect.y1 - 9, ..rect });
        let all = exec.grid(112, 96).rects().into_iter().enumerate();
        let part: Arc<[_]> = all.step_by(5).map(corner).collect();
        let rules = [
            Supposed::Nothing,
            Supposed::Moved([0.5, -0.5]),
            Supposed::CentersWhole,
            Supposed::Mirrored,
            Supposed::Transposed,
            Supposed::Spread(2.0),
            Supposed::FilterOnRadius,
            Supposed::Limit(1e9),
        ];
        let mut wrong = 0;
        for lens in [None, Some(Lens::Orthographic(2.5)), Some(Lens::FieldOfView(15.0))] {
            let camera = camera(Shape::Sphere, [112, 96], lens);
            for outline in [Outline::Affine, Outline::Perspective, Outline::RayCast] {
                let settings = |cutoff| {
                    let right = ewa::Settings::default();
                    ewa::Settings { kernel: Kernel { outline, cutoff, ..right.kernel }, ..right }
                };
                let grouped = |cutoff| {
                    let right = single_pass::Settings::default();
                    Method::SinglePass(single_pass::Settings { splats: settings(cutoff), ..right })
                };
                for methods in [
                    [2.0, 1.8].map(|cutoff| Method::Ewa(settings(cutoff))),
                    [2.0, 1.8].map(grouped),
                ] {
                    let [right, mistaken] =
                        methods.map(|method| Session::new(&scene, method, &exec).unwrap());
                    let client =
                        Client::from(&mistaken.define::<f32>(&camera, true).unwrap().frame);
                    for supposed in rules {
                        let judged = |part| {
                            let client = Client { supposed, part, ..client.clone() };
                            right.verify_as(right.method(), &camera, &client, 1.0).unwrap()
                        };
                        let (whole, own) = (judged(None), judged(Some(part.clone())));
                        for (whole, own) in whole.stages.iter().zip(&own.stages) {
                            let at = part.iter().flat_map(|(_, rect)| pixels(*rect));
                            let errors: Vec<_> = at.map(|(x, y)| *whole.errors.at(x, y)).collect();
                            assert_eq!(own.errors.values(), errors, "{supposed:?} {outline:?}");
                            wrong += own.wrong;
                        }
                    }
                }
            }
        }
        assert!(wrong > 1000, "{wrong}");
    }
}
