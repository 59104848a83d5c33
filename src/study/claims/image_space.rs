//! \[MKC08\] and \[MOC08\]: reconstruction in image space.

use super::subject::{Subject, colors};
use super::{Claim, Measured};
use crate::error::Result;
use crate::method::pyramid::{self, Weights};
use crate::method::{Method, ewa, template};

pub(super) const CLAIMS: [Claim; 7] = [
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
        from: "[MKC08] abstract, 3.5",
        says: "for large models the pyramid performs better than splatting",
        measured: "ms: `pyramid`; `ewa`",
        at_most: 1.0,
        timed: true,
        more: "image-space.md",
        of: |subject| times(subject, [pyramid(), splatting()]),
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

fn falloff(subject: &Subject<'_>) -> Result<Measured> {
    use crate::method::template::Falloff;
    let with = |falloff| template::Settings { falloff, ..template::Settings::default() }.into();
    by(subject, [with(Falloff::Linear), with(Falloff::Gaussian)], "normal")
}
