//! Claims of \[MKC08\] and \[MOC08\]: reconstruction in image space.

use super::subject::{Subject, colors};
use super::{Claim, Measured};
use crate::error::Result;
use crate::method::pyramid::{self, Weights};
use crate::method::{Method, ewa, template};

pub(super) const CLAIMS: [Claim; 15] = [
    Claim {
        id: "mkc08-gaussian",
        from: "[MKC08] 3.3, Fig. 4",
        says: "elliptical Gaussian weights provide a better quality than box filters",
        measured: "RMSE to the truth: `--weights gaussian`; `--weights box`",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: |subject| truth(subject, [weights(Weights::Gaussian), weights(Weights::Box)]),
    },
    Claim {
        id: "mkc08-speed",
        from: "[MKC08] abstract, 6",
        says: "for large models the pyramid performs better than splatting",
        measured: "ms: `pyramid`; `ewa`",
        at_most: 1.0,
        timed: true,
        more: "image-space.md",
        of: |subject| times(subject, [pyramid(), splatting()]),
    },
    Claim {
        id: "mkc08-small",
        from: "[MKC08] 6, Table 1",
        says: "the time of small models is dominated by the pull-push interpolation",
        measured: "ms of 10,000 points: projection; pull and push",
        at_most: 1.0,
        timed: true,
        more: "image-space.md",
        of: |subject| parts(&subject.of_count(10_000)?, |projection, rest| [projection, rest]),
    },
    Claim {
        id: "mkc08-large",
        from: "[MKC08] 6, Table 1",
        says: "the time of large models is dominated by the projection of points",
        measured: "ms of 1,000,000 points, or of a whole scan: pull and push; projection",
        at_most: 1.0,
        timed: true,
        more: "image-space.md",
        of: |subject| parts(&subject.of_count(1_000_000)?, |projection, rest| [rest, projection]),
    },
    Claim {
        id: "moc08-gaps",
        from: "[MOC08] 3.1",
        says: "splats can be projected orthogonally instead of perspectively without leaving gaps",
        measured: "holes, per mille: `--template 5`; limit",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: gaps,
    },
    Claim {
        id: "moc08-ppr",
        from: "[MOC08] 4, Fig. 7",
        says: "5 x 5 renders smoother silhouettes with less artifacts than the pyramid",
        measured: "RMSE to the truth: `--template 5`; `pyramid`",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: |subject| truth(subject, [template(5), pyramid()]),
    },
    Claim {
        id: "moc08-silhouettes",
        from: "[MOC08] 4, Fig. 7",
        says: "silhouettes are smoother with 5 x 5 than with the pyramid",
        measured: "length of the outline divided by the true length, minus 1: `--template 5`; `pyramid`",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: silhouettes,
    },
    Claim {
        id: "moc08-flicker",
        from: "[MOC08] 5",
        says: "artifacts and flickering during animation are less than with the pyramid",
        measured: "deviation of luminance, moved by eighths of a pixel: `--template 5`; `pyramid`",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: flickering,
    },
    Claim {
        id: "moc08-splatting",
        from: "[MOC08] 3.2",
        says: "a 5 x 5 kernel has similar quality as surface splatting",
        measured: "RMSE to the truth, at most 1.1 times: `--template 5`; `ewa`",
        at_most: 1.1,
        timed: false,
        more: "image-space.md",
        of: |subject| truth(subject, [template(5), splatting()]),
    },
    Claim {
        id: "moc08-larger",
        from: "[MOC08] 3.2",
        says: "larger templates merge less splats and generate smoother reconstructions",
        measured: "mean error of the normal, degrees: `--template 5`; `--template 3`",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: |subject| by(subject, [template(5), template(3)], "normal"),
    },
    Claim {
        id: "moc08-seven",
        from: "[MOC08] 3.2, Fig. 5",
        says: "there is little gain between the 5 x 5 and 7 x 7 kernels",
        measured: "RMSE to the truth, at most 1.1 times: `--template 5`; `--template 7`",
        at_most: 1.1,
        timed: false,
        more: "image-space.md",
        of: |subject| truth(subject, [template(5), template(7)]),
    },
    Claim {
        id: "moc08-five-speed",
        from: "[MOC08] 3.2",
        says: "from 3 x 3 to 5 x 5 frames per second fall by almost 40 %",
        measured: "ms, at most 0.65 times: `--template 3`; `--template 5`",
        at_most: 0.65,
        timed: true,
        more: "image-space.md",
        of: |subject| times(subject, [template(3), template(5)]),
    },
    Claim {
        id: "moc08-seven-speed",
        from: "[MOC08] 3.2, Fig. 5",
        says: "from 5 x 5 to 7 x 7 frames per second fall by around 38 %",
        measured: "ms, at most 0.65 times: `--template 5`; `--template 7`",
        at_most: 0.65,
        timed: true,
        more: "image-space.md",
        of: |subject| times(subject, [template(5), template(7)]),
    },
    Claim {
        id: "moc08-speed",
        from: "[MOC08] 4, Table 1",
        says: "for the smaller models 3 x 3 is only approximately 15 % slower than the pyramid",
        measured: "ms, at most 1.15 times: `--template 3`; `pyramid`",
        at_most: 1.15,
        timed: true,
        more: "image-space.md",
        of: |subject| times(subject, [template(3), pyramid()]),
    },
    Claim {
        id: "moc08-falloff",
        from: "[MOC08] 3.2",
        says: "the Gaussian leaves clear silhouette traces where 1 - d does not",
        measured: "mean error of the normal, degrees: `--falloff linear`; `--falloff gaussian`",
        at_most: 1.0,
        timed: false,
        more: "image-space.md",
        of: falloff,
    },
];

fn pyramid() -> Method {
    pyramid::Settings::default().into()
}

fn weights(weights: Weights) -> Method {
    pyramid::Settings { weights, ..pyramid::Settings::default() }.into()
}

fn template(size: u32) -> Method {
    template::Settings { size, ..template::Settings::default() }.into()
}

fn splatting() -> Method {
    ewa::Settings::default().into()
}

fn truth(subject: &Subject<'_>, methods: [Method; 2]) -> Result<Measured> {
    by(subject, methods, "rmse")
}

fn by(subject: &Subject<'_>, [first, second]: [Method; 2], metric: &str) -> Result<Measured> {
    let truth = subject.truth()?;
    let (first, second) = (subject.draw(first, None)?, subject.draw(second, None)?);
    let error = |frame| subject.error(frame, truth, metric);
    Ok(Measured {
        numbers: [error(&first)?, error(&second)?],
        pictures: colors(&[&first, &second, truth])?,
    })
}

fn times(subject: &Subject<'_>, [first, second]: [Method; 2]) -> Result<Measured> {
    let numbers = subject.times([subject.session(first, None)?, subject.session(second, None)?])?;
    Ok(Measured { numbers, pictures: Vec::new() })
}

/// The median times of the pyramid's projection and of its pull and push, over nine frames, in ms.
fn parts(subject: &Subject<'_>, order: fn(f64, f64) -> [f64; 2]) -> Result<Measured> {
    let mut session = subject.session(pyramid(), None)?;
    let [projection, all] = subject.laps(&mut session, [&["projection"], &["pull", "push"]])?;
    Ok(Measured { numbers: order(projection, all), pictures: Vec::new() })
}

fn gaps(subject: &Subject<'_>) -> Result<Measured> {
    let (drawn, truth) = (subject.draw(template(5), None)?, subject.truth()?);
    let numbers = [subject.error(&drawn, truth, "holes")?, 1.0];
    Ok(Measured { numbers, pictures: colors(&[&drawn, truth])? })
}

fn silhouettes(subject: &Subject<'_>) -> Result<Measured> {
    let found = by(subject, [template(5), pyramid()], "outline")?;
    Ok(Measured { numbers: found.numbers.map(|length| (length - 1.0).abs()), ..found })
}

fn flickering(subject: &Subject<'_>) -> Result<Measured> {
    let of = |method| subject.flicker(subject.session(method, None)?);
    Ok(Measured { numbers: [of(template(5))?, of(pyramid())?], pictures: Vec::new() })
}

fn falloff(subject: &Subject<'_>) -> Result<Measured> {
    use crate::method::template::Falloff;
    let with = |falloff| template::Settings { falloff, ..template::Settings::default() }.into();
    by(subject, [with(Falloff::Linear), with(Falloff::Gaussian)], "normal")
}
