//! Tests of the background, of refused input, and of pictures of points in blocks.

use super::*;
use crate::number::Vector3;
use crate::scene::{Cloud, Environment};
use crate::splat::View;

#[test]
fn the_sky_is_behind() {
    let scene = Scene { environment: Some(Environment::Sky), ..lights("sky", vec![]) };
    let camera = camera([20, 14], 3.0, Lens::FieldOfView(60.0));
    let corners = [[-9.0, -9.0, 0.0], [0.0, -9.0, 0.0], [0.0, 9.0, 0.0]];
    let half = mesh(&[corners, [corners[0], corners[2], [-9.0, 9.0, 0.0]]]);
    let truth = see(&[half], &scene, true, &camera);
    assert!(truth.frame.scalar("A").unwrap().values().iter().all(|a| *a == 1.0));
    let (color, depth) = (truth.frame.color("").unwrap(), truth.frame.scalar("Z").unwrap());
    // The pixels of this camera are the samples.
    let Camera { fx, fy, cx, cy, .. } = camera;
    let fine = Camera { fx: 8.0 * fx, fy: 8.0 * fy, cx: 8.0 * cx, cy: 8.0 * cy, ..camera };
    let view = View::<f64>::new(&fine);
    for y in 0..14 {
        assert_eq!(*color.at(3, y), [1.0; 3], "white, unlit");
        let samples = (0..8).flat_map(|j| (0..8).map(move |i| (120 + i, 8 * y + j)));
        let all: Vec<_> = samples.map(|(x, y)| Environment::Sky.radiance(view.ray(x, y))).collect();
        let light = [0, 1, 2].map(|c| all.iter().map(|one| one[c]).sum::<f64>() / 64.0);
        let found = color.at(15, y).map(f64::from);
        assert!((0..3).all(|c| (found[c] - light[c]).abs() < 1e-6), "{y}: {found:?} {light:?}");
        assert!(depth.at(15, y).is_infinite());
    }
}

/// Compares each sample with the definition of the shader, at the point that a formula for the
/// plane gives.
#[test]
fn samples_are_shaded_each_at_its_own_point() {
    let position = Vec3::new(0.25, 0.5, 0.75);
    let light = Light::Point { position, color: Vec3::new(1.0, 0.5, 2.0) };
    let scene = lights("plane", vec![light, Light::DEFAULT]);
    let camera = camera([12, 9], 3.0, Lens::FieldOfView(60.0));
    let corners = [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0]];
    let plane = mesh(&[corners, [corners[0], corners[2], [-9.0, 9.0, 0.0]]]);
    let truth = see(&[plane], &scene, true, &camera);
    let color = truth.frame.color("").unwrap();
    let shader =
        crate::shade::phong::Shader::<f64>::new(View::new(&camera), &scene.lights, scene.material);
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    for (x, y) in (0..9).flat_map(|y| (0..12).map(move |x| (x, y))) {
        let mut sum = [0.0; 3];
        for (i, j) in (0..8).flat_map(|j| (0..8).map(move |i| (i, j))) {
            let at = |pixel: u32, i: u32| f64::from(pixel) + (f64::from(i) + 0.5) / 8.0;
            // The plane z = 0 is at depth 3.
            let (px, py) = (3.0 * (at(x, i) - cx) / fx, -3.0 * (at(y, j) - cy) / fy);
            let (p, n) = (Vector3::new(px, py, 0.0), Vector3::new(0.0, 0.0, 1.0));
            let lit = shader.surfel(p, n, [1.0; 3]);
            sum = [0, 1, 2].map(|c| sum[c] + lit[c] / 64.0);
        }
        let found = color.at(x, y).map(f64::from);
        assert!((0..3).all(|c| (found[c] - sum[c]).abs() < 1e-6), "{found:?} {sum:?}");
    }
}

#[test]
fn what_cannot_be_seen_is_refused() {
    let scene = lights("bad", vec![]);
    let exec = Exec::sequential();
    let camera = camera([4, 4], 3.0, Lens::FieldOfView(60.0));
    let see = |surface: Surface, camera: &Camera| {
        of_surfaces(&[surface], &scene, true, camera, &[], &exec, &|_, _, _| ()).map(|_| ())
    };
    let put = |shape, scale| Surface::Shape {
        shape,
        place: Similarity { scale, ..Similarity::IDENTITY },
        color: None,
    };
    assert!(see(put(Shape::Sphere, 1.0), &camera).is_ok());
    let line = see(put(Shape::Sheets { gap: -1.0 }, 1.0), &camera).unwrap_err().to_string();
    assert!(line.starts_with("sheets: gap -1"), "{line}");
    let line = see(put(Shape::Sphere, 0.0), &camera).unwrap_err().to_string();
    assert!(line.starts_with("transform: the scale"), "{line}");
    assert!(see(put(Shape::Sphere, 1.0), &Camera { near: 0.0, ..camera }).is_err());
    assert!(see(put(Shape::Sphere, 1.0), &Camera { width: 0, ..camera }).is_err());
    // A scene without content gives an empty picture.
    let none = of_surfaces(&[], &scene, true, &camera, &[], &exec, &|_, _, _| ()).unwrap();
    assert!(colors(&none).iter().all(|v| *v == 0.0));
}

/// A picture that begins in another column has other blocks, but the same pixels.
#[test]
fn blocks_of_points_have_no_seams() {
    let scene = Scene::lit("sphere", Shape::Sphere.surfels(300, 0).unwrap());
    let exec = Exec::new(2, 32).unwrap();
    let wide = camera([134, 10], 2.0, Lens::Focal(120.0));
    let rest = Camera { width: 34, cx: wide.cx - 100.0, ..wide };
    let see = |camera| of_points(&scene, camera, &[[3, 1]], &exec, &|_, _, _| ()).unwrap();
    let (wide, rest) = (see(&wide), see(&rest));
    let pairs = [
        (wide.frame.color("").unwrap(), rest.frame.color("").unwrap()),
        (&wide.shifted[0], &rest.shifted[0]),
    ];
    for (wide, rest) in pairs {
        for (x, y) in (0..10).flat_map(|y| (0..34).map(move |x| (x, y))) {
            let (a, b) = (wide.at(100 + x, y), rest.at(x, y));
            assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-6), "{x} {y}: {a:?} {b:?}");
        }
        assert!(wide.at(126, 5)[0] > 0.0 && wide.at(127, 5)[0] > 0.0, "the sphere is there");
    }
}

/// Half the light of the first disc, and half the light that it lets through from the second.
#[test]
fn layers_are_blended() {
    let cloud = Cloud {
        position: vec![Vec3::ZERO, Vec3::Z * -10.0],
        normal: Some(vec![Vec3::Z; 2]),
        radius: Some(vec![2.0; 2]),
        color: Some(vec![Vec3::X, Vec3::Y]),
        opacity: Some(vec![0.5; 2]),
        ..Cloud::default()
    };
    let exec = Exec::sequential();
    let (surfels, _) = Surfels::new_with(cloud, &exec).unwrap();
    let scene = Scene::unlit("discs", surfels);
    let camera = camera([6, 6], 5.0, Lens::Orthographic(1.0));
    let truth = of_points(&scene, &camera, &[], &exec, &|_, _, _| ()).unwrap();
    assert_eq!(truth.how, How::Layers);
    for color in truth.frame.color("").unwrap().values() {
        let off = (0..3).map(|c| (color[c] - [0.5, 0.25, 0.0][c]).abs());
        assert!(off.fold(0.0, |most: f32, off| most + off) < 1e-6, "{color:?}");
    }
}
