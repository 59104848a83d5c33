//! No bytes may make the PLY reader, or the derivation from what it read, panic or hang.
#![no_main]

use libfuzzer_sys::fuzz_target;
use splatref::frame::Exec;
use splatref::frame::Plane;
use splatref::io::ply;
use splatref::scene::{Paint, Texture};
use splatref::source::derive::{Derive, polygons, ribbons, surfels, tubes};

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut cloud) = ply::parse(bytes) else { return };
    cloud.check().expect("what is read fits together");
    assert!(cloud.position.len() * 3 <= bytes.len(), "three numbers take three bytes");
    if cloud.position.len() > 2000 {
        return;
    }
    if let Some(coordinates) = &cloud.coordinates {
        let texture = Texture::new(Plane::from_values(3, 2, vec![[0.25, 0.5, 1.0]; 6])).expect("a texture");
        cloud.paint = Some(Paint::new(texture, coordinates, 2));
    }
    let asked = Derive { radius: Some(1.0) };
    if let Ok((triangles, derived)) = polygons(cloud.clone(), &Exec::sequential(), &|_, _, _| ()) {
        let all = cloud.triangles.len() as u64;
        assert_eq!(triangles.len() as u64 + derived.dropped_primitives, all);
    }
    for lines in [ribbons(cloud.clone(), &asked), tubes(cloud.clone(), &asked)] {
        let Ok((lines, derived)) = lines else { continue };
        assert_eq!(lines.len() as u64 + derived.dropped_primitives, cloud.edges.len() as u64);
    }
    let n = cloud.position.len() as u64;
    if let Ok((surfels, derived)) = surfels(cloud, &Derive::default(), &Exec::sequential(), &|_, _, _| ()) {
        assert_eq!(surfels.len() as u64 + derived.dropped.total(), n, "each is kept or counted");
        assert!(surfels.groups().is_none_or(|groups| groups.own().len() == surfels.len()));
        assert!(surfels.radius().iter().all(|r| *r > 0.0 && r.is_finite()));
        assert!(surfels.normal().iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }
});
