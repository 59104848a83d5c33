//! Verify the pictures of a session.

use super::client::{Client, Rounding};
use super::{Check, Verdict, ewa, gaps, table, unlike};
use crate::error::{Error, Result};
use crate::method::part::Part;
use crate::method::session::{Making, Names, named};
use crate::method::{Job, Method, Session};
use crate::number::ball::{Gpu, Ieee, Precise};
use crate::scene::Camera;
use std::borrow::Cow;

impl Session<'_> {
    /// Judges the planes of a client, stage by stage: may a correct implementation leave them? The
    /// picture cannot be judged if the sums of more than the fraction `budget` of its pixels are
    /// undecided, see [`Verdict::BUDGET`].
    ///
    /// After [`Session::set_region`], judges the pixels of the region alone. The client's planes still
    /// have the size of the picture; the other pixels are not looked at.
    ///
    /// # Errors
    /// [`Error::Invalid`] if no plane belongs to the method, if the picture has another size than
    /// the camera's, or if there are records for another method; else as
    /// [`Session::render`].
    pub fn verify(&self, camera: &Camera, client: &Client, budget: f64) -> Result<Verdict> {
        let mut verdict = self.verify_as(self.method(), camera, client, budget)?;
        gaps::list(&mut verdict, self.method().stages(), &self.job(camera)?, client.frame());
        verdict.unlike = unlike::found(client, self.scene().surfels.len(), &verdict.stages);
        Ok(verdict)
    }

    /// Judges as [`Session::verify`] does, but with another method for the same scene and groups, and
    /// without asking whether the errors are usual.
    pub(crate) fn verify_as(
        &self,
        method: &Method,
        camera: &Camera,
        client: &Client,
        budget: f64,
    ) -> Result<Verdict> {
        let spread = client.supposed.spread();
        let around = client.around.as_deref();
        let part = client.part.as_deref().map(|pieces| Part { pieces, spread, around });
        let job = Job { part, ..self.job(camera)? };
        self.check_client(camera, client)?;
        self.ask(&self.whole_job(camera)?, Making::Verdict)?;
        let names = self.numbers();
        let client = &*numbered(names.as_ref(), self.method(), client)?;
        let verdict = match client.rounding {
            Rounding::Gpu => table::verify::<Gpu>(method, &job, client, budget),
            Rounding::Precise => table::verify::<Precise>(method, &job, client, budget),
            Rounding::Ieee => table::verify::<Ieee>(method, &job, client, budget),
        }?;
        Ok(verdict.renumbered(|index| named(names.as_ref(), index)))
    }

    /// The numbers that are wrong in the records of a client.
    pub(super) fn wrong_fields(
        &self,
        camera: &Camera,
        client: &Client,
    ) -> Result<Vec<ewa::WrongField>> {
        let job = self.job(camera)?;
        Ok(match client.rounding {
            Rounding::Gpu => table::wrong_fields::<Gpu>(self.method(), &job, client),
            Rounding::Precise => table::wrong_fields::<Precise>(self.method(), &job, client),
            Rounding::Ieee => table::wrong_fields::<Ieee>(self.method(), &job, client),
        })
    }

    /// Every check at one pixel: each judged value of the client, and the values that are allowed
    /// there.
    ///
    /// # Errors
    /// As [`Session::verify`] and [`Session::explain`].
    pub fn checks(
        &self,
        camera: &Camera,
        client: &Client,
        pixel: (u32, u32),
    ) -> Result<Vec<Check>> {
        let job = self.whole_job(camera)?;
        self.check_client(camera, client)?;
        self.ask(&job, Making::Verdict)?;
        let names = self.numbers();
        let client = &*numbered(names.as_ref(), self.method(), client)?;
        let mut checks = match client.rounding {
            Rounding::Gpu => table::checks::<Gpu>(self.method(), &job, client, pixel),
            Rounding::Precise => table::checks::<Precise>(self.method(), &job, client, pixel),
            Rounding::Ieee => table::checks::<Ieee>(self.method(), &job, client, pixel),
        }?;
        let name = |index| named(names.as_ref(), index);
        checks.iter_mut().for_each(|check| check.fault.renumber(name));
        Ok(checks)
    }

    /// Fails unless the client has planes to judge, of the right size, and no records that cannot
    /// be judged.
    fn check_client(&self, camera: &Camera, client: &Client) -> Result<()> {
        let frame = client.frame();
        let (found, picture) = ([frame.width, frame.height], camera.size());
        if found != picture {
            let [width, height] = found;
            return Err(Error::Invalid(format!(
                "the planes have {width} x {height} pixels, but the camera's picture has {} x {}",
                picture[0], picture[1]
            )));
        }
        if frame.planes.is_empty() {
            let what =
                format!("no plane has the name of a plane of the method {}", self.method().name());
            return Err(Error::Invalid(what));
        }
        let name = self.method().name();
        let of_surfels = client.records.is_none() || matches!(self.method(), Method::Ewa(_));
        let of_gaussians =
            client.gaussian_records.is_none() || matches!(self.method(), Method::Gaussians(_));
        if !(of_surfels && of_gaussians) {
            let what = "only the methods ewa and gaussians judge records, each its own kind";
            return Err(Error::Invalid(format!("{what}, but this is {name}")));
        }
        Ok(())
    }
}

/// The client with indices of surfels in place of their ids.
fn numbered<'c>(
    names: Option<&Names<'_>>,
    method: &Method,
    client: &'c Client,
) -> Result<Cow<'c, Client>> {
    let Some(names) = names else { return Ok(Cow::Borrowed(client)) };
    let mut numbered = client.clone();
    names.number_given(numbered.frame_mut(), method.stages())?;
    Ok(Cow::Owned(numbered))
}
