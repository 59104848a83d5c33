//! No bytes may make the PLY reader, or the derivation from what it read, panic or hang.
#![no_main]

use libfuzzer_sys::fuzz_target;
use splatref::frame::Exec;
use splatref::io::ply;
use splatref::scene::derive::{Derive, surfels};

fuzz_target!(|bytes: &[u8]| {
    let Ok(cloud) = ply::parse(bytes) else { return };
    cloud.check().expect("what is read fits together");
    assert!(cloud.position.len() * 3 <= bytes.len(), "three numbers take three bytes");
    if cloud.position.len() > 2000 {
        return;
    }
    let n = cloud.position.len() as u64;
    if let Ok((surfels, derived)) = surfels(cloud, &Derive::default(), &Exec::sequential(), &|_, _, _| ()) {
        assert_eq!(surfels.len() as u64 + derived.dropped.total(), n, "each is kept or counted");
        assert!(surfels.groups().is_none_or(|groups| groups.own().len() == surfels.len()));
        assert!(surfels.radius().iter().all(|r| *r > 0.0 && r.is_finite()));
        assert!(surfels.normal().iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }
});
