//! Clients of the verdict that draw with a graphics API: right ones must be found right, and ones
//! with a seeded bug must be found wrong. `docs/gpu-clients.md` has the figures.

mod bugs;
mod clients;
mod device;
mod ewa_compute;
mod ewa_raster;
mod judge;
mod operations;
mod planes;
mod pyramid;
mod raster;
mod scenes;
mod single_pass;
mod table;

use bugs::Bug;
use clients::RightClient;
use device::{Gpu, gpu};
use ewa_raster::Variant;
use judge::judge;
use scenes::{Job, of_ewa};
use splatref::verdict::Outcome;
use splatref::verdict::client::Rounding;

/// Draws every scene of a client and expects every verdict to be right.
fn is_right(client: &RightClient) {
    let Some(gpu) = gpu() else { return };
    let mut accused = Vec::new();
    for job in (client.jobs)() {
        let judged = judge(&job, &(client.draw)(gpu, &job), Rounding::Gpu);
        println!("{}: {judged:?}", job.name);
        if judged.outcome != Outcome::Right {
            accused.push(format!("{}: {judged:?}", job.name));
        }
    }
    assert!(accused.is_empty(), "{}:\n{}", client.name, accused.join("\n"));
}

#[test]
fn ewa_by_the_rasterizer_with_splatrefs_records() {
    is_right(&clients::EWA_RECORDS);
}

#[test]
fn ewa_by_the_rasterizer_with_its_own_projection() {
    is_right(&clients::EWA_PROJECTION);
}

#[test]
fn ewa_by_the_rasterizer_with_16_bit_sums() {
    is_right(&clients::EWA_HALF);
}

#[test]
fn ewa_in_compute_with_splatrefs_records() {
    is_right(&clients::COMPUTE_RECORDS);
}

#[test]
fn ewa_in_compute_with_its_own_projection() {
    is_right(&clients::COMPUTE_PROJECTION);
}

#[test]
fn algorithm_1_by_the_rasterizer() {
    is_right(&clients::SINGLE_PASS);
}

#[test]
fn the_pyramid_by_points_and_compute() {
    is_right(&clients::PYRAMID);
}

/// Whether the rasterizer with its own projection is found wrong in a scene if it has this bug.
fn exposes(gpu: &Gpu, job: &Job, bug: Bug) -> bool {
    let client = ewa_raster::draw(gpu, job, Variant { bug, ..Variant::default() });
    let judged = judge(job, &client, Rounding::Gpu);
    println!("{bug:?} in {}: {judged:?}", job.name);
    judged.outcome == Outcome::Wrong
}

#[test]
fn each_seeded_bug_is_found() {
    let Some(gpu) = gpu() else { return };
    let jobs = of_ewa();
    let missed = |&bug: &Bug| !jobs.iter().any(|job| exposes(gpu, job, bug));
    let missed: Vec<Bug> = Bug::ALL.into_iter().filter(missed).collect();
    assert!(missed.is_empty(), "no scene exposes {missed:?}");
}

#[test]
#[ignore = "writes docs/gpu-clients.md"]
fn write_the_page() {
    if let Some(gpu) = gpu() {
        table::write(gpu);
    }
}
