//! Try mistakes on a part of a large picture: the tiles with the most wrong pixels. Naming a mistake
//! tries many, and each trial judges the client again. The whole picture then decides.

use super::change::Change;
use super::{Case, Explanation, Wrong};
use crate::error::Result;
use crate::method::Method;
use crate::number::MapInline;
use crate::verdict::client::Client;
use crate::verdict::supposed::Supposed;
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

/// Whether a verdict can judge some tiles alone. The other methods have levels of the whole picture,
/// or passes that choose surfels from all of it.
fn has_tiles(method: &Method) -> bool {
    !matches!(method, Method::Pyramid(_) | Method::Template(_) | Method::Deferred(_))
}

/// The client as the tiles with the most wrong pixels show it; none if the whole picture is judged.
pub(super) fn client(case: &Case<'_, '_>) -> Option<Client> {
    if !is_large(case) || !has_tiles(case.session.method()) {
        return None;
    }
    let grid = case.session.job(case.camera).ok()?.grid();
    let rects = grid.rects();
    let stages = case.verdict.stages.iter().skip_while(|stage| stage.stage != case.wrong.stage);
    let mut wrong = vec![0_u64; rects.len()];
    for stage in stages.take(2) {
        let width = stage.errors.width() as usize;
        for (i, _) in stage.errors.values().iter().enumerate().filter(|(_, error)| **error > 1.0) {
            let [x, y] = [i % width, i / width].map_inline(|at| at as u32);
            wrong[grid.place(x, y).0] += 1;
        }
    }
    let mut tiles: Vec<usize> = (0..rects.len()).filter(|&tile| wrong[tile] > 0).collect();
    tiles.sort_by_key(|&tile| (Reverse(wrong[tile]), tile));
    let mut pixels = 0;
    tiles.retain(|&tile| {
        pixels += rects[tile].pixels();
        pixels <= MOST
    });
    Some(Client { tiles: Some(Arc::from(tiles)), ..case.client.clone() })
}

/// Those explanations of a part that explain the whole picture, with what they leave there.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn confirmed(
    whole: &Case<'_, '_>,
    mut found: Vec<Explanation>,
) -> Result<Vec<Explanation>> {
    found.sort_by_key(|one| one.left.all);
    found.truncate(TRIED);
    let mut confirmed = Vec::new();
    for one in found {
        // In the part nearly all pixels may be wrong.
        let coarse = matches!(one.change, Change::Supposed(Supposed::CoarseExp(_)));
        if coarse && !whole.is_one_in(2) {
            continue;
        }
        let Some(left) = whole.judge(&one.change)? else { continue };
        if whole.explains(left, one.most) {
            confirmed.push(Explanation { left, ..one });
        }
    }
    Ok(confirmed)
}

/// What is found by `search` in the part that a client shows, if the stage is wrong there.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn in_part(
    whole: &Case<'_, '_>,
    client: &Client,
    search: impl FnOnce(&Case<'_, '_>) -> Result<Vec<Explanation>>,
) -> Result<Vec<Explanation>> {
    let (session, camera, budget) = (whole.session, whole.camera, whole.verdict.budget);
    let verdict = session.verify_as(session.method(), camera, client, budget)?;
    let stage = verdict.stages.iter().find(|stage| stage.stage == whole.wrong.stage);
    let Some(wrong) = stage.filter(|stage| stage.wrong > 0) else { return Ok(Vec::new()) };
    let all = Wrong::of(&verdict, wrong.stage);
    let stages = whole.stages.clone();
    search(&Case { session, camera, client, verdict: &verdict, wrong, stages, all })
}

#[cfg(test)]
mod tests {
    use crate::frame::Exec;
    use crate::method::{Method, Session, ewa};
    use crate::scene::Scene;
    use crate::source::Shape;
    use crate::splat::Kernel;
    use crate::verdict::causes::likely_cause;
    use crate::verdict::client::Client;
    use crate::verdict::tests::camera;

    #[test]
    fn the_mistake_of_a_large_picture_is_named() {
        let exec = Exec::new(2, 32).unwrap();
        let scene = Scene::unlit("", Shape::Sphere.surfels(1500, 3).unwrap());
        let camera = camera(Shape::Sphere, [176, 128], None);
        let right = ewa::Settings::default();
        let kernel = Kernel { cutoff: 1.9, ..right.kernel };
        let session = Session::new(&scene, Method::Ewa(right), &exec).unwrap();
        let mistaken = Method::Ewa(ewa::Settings { kernel, ..right });
        let mistaken = Session::new(&scene, mistaken, &exec).unwrap();
        let client = Client::from(&mistaken.define::<f32>(&camera, true).unwrap().frame);
        let verdict = session.verify(&camera, &client, 1.0).unwrap();
        let named = likely_cause(&session, &camera, &client, &verdict).unwrap();
        assert_eq!(named.as_deref(), Some("the cut-off is 1.9, not 2"));
    }
}
