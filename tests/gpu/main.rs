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
use clients::{RightClient, Seeded};
use device::{Gpu, gpu};
use judge::judge;
use scenes::Job;
use splatref::verdict::Outcome;
use splatref::verdict::client::Rounding;

/// Draws every scene of a client and expects that no verdict accuses it.
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

/// Whether a scene exposes a bug.
fn exposes(gpu: &Gpu, seeded: &Seeded, job: &Job, bug: Bug) -> bool {
    let judged = judge(job, &(seeded.draw)(gpu, job, bug), Rounding::Gpu);
    println!("{bug:?} in {}: {judged:?}", job.name);
    judged.outcome == Outcome::Wrong
}

#[test]
fn each_seeded_bug_is_found() {
    let Some(gpu) = gpu() else { return };
    let mut missed: Vec<Bug> = Vec::new();
    for seeded in &clients::SEEDED {
        let jobs = (seeded.jobs)();
        let unseen = |bug: &Bug| !jobs.iter().any(|job| exposes(gpu, seeded, job, *bug));
        missed.extend(seeded.bugs.iter().filter(|bug| unseen(bug)));
    }
    assert!(missed.is_empty(), "no scene exposes {missed:?}");
}

#[test]
#[ignore = "writes docs/gpu-clients.md"]
fn write_the_page() {
    if let Some(gpu) = gpu() {
        table::write(gpu);
    }
}
