//! The files of a known study are readable, and have the same bytes everywhere.

use super::chart::chart;
use super::{csv, page};
use crate::study::run::{Loss, Measured, Record, Study, Subject};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;

const FIGURE: &str = "rmse";

/// Seven methods with five settings each. Pairs of points are close, and some lie on a line, so
/// that labels collide.
fn study() -> Study {
    let method = |m: u32| {
        (0..5_u32).map(move |s| {
            let (m, s) = (f64::from(m), f64::from(s));
            let time = 2.0 + 3.0 * m + 0.25 * s * s;
            let error = 0.4 / (1.0 + m) + 0.003 * s;
            (format!("--method m{m} --cutoff {s}"), format!("m{m}"), time, error)
        })
    };
    let record = |(options, method, time, error): (String, String, f64, f64)| Record {
        options,
        method,
        measured: Some(Measured {
            surfels: 1000,
            prepared: 0.5,
            figures: BTreeMap::from([(FIGURE.to_owned(), error)]),
            spectra: [vec![1.0, 0.5], vec![0.25, 0.125]],
        }),
        times: vec![time, 1.125 * time, 0.875 * time],
    };
    Study {
        of: Subject {
            splatref: "0".into(),
            scene: "a \"scene\" <of> tests".into(),
            scene_sha256: String::new(),
            size: [64, 48],
            camera: String::new(),
            truth: "the exact surface".into(),
            truth_sha256: String::new(),
        },
        candidates: (0..7).flat_map(method).map(record).collect(),
        left_out: Vec::new(),
        machine: "a machine".into(),
    }
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// Blessed after a look at the chart; look at it again if these bytes change.
#[test]
fn the_files_of_a_known_study_have_known_bytes() {
    let loss = Loss { title: "RMSE".into(), figure: FIGURE, of: |v| v };
    let study = study();
    let drawing = chart(&study, &loss);
    drawing.assert_readable();
    let picture = drawing.picture().unwrap();
    let png = vec![0x89, b'P', b'N', b'G'];
    let pictures = vec![png.clone(); study.candidates.len()];
    let page = page::page(&study, &drawing, &loss, &[FIGURE], &png, &pictures);
    assert!(!page.contains("<of>"), "names are escaped");
    let found = [
        drawing.svg().into_bytes(),
        picture.pixels,
        csv::csv(&study, &[FIGURE]).into_bytes(),
        page.into_bytes(),
    ];
    let known = [
        "20483036a1ba5b4a787d61cf859174bdfb2260d4a2b7b9e8fa22e8a58f8d2b3f",
        "e20dca77f933014c1a882565298faddfe3d7851ab470d316848a3bd3f91d40be",
        "6094496a7fdb49f91e798aa8ad59bbea24c5d7e213cb62c14e32a1f42f1153d1",
        "c42bf7e893ebe9a3e471d187a1c7ddd8c79d62e7be334e8015dba6ebcd5dce87",
    ];
    assert_eq!(found.map(|bytes| sha256(&bytes)), known);
}
