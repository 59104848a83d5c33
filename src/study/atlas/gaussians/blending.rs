//! Entries about the order, the colours and the sums of splats.

use super::super::case::both;
use super::{
    BLUE, Blob, Failure, Found, ORANGE, SEEN, ahead, draw, measured, part, scene, share, truth,
    turn, worst,
};
use crate::error::Result;
use crate::frame::{Exec, Plane};
use crate::method::Session;
use crate::method::buffer_formats::{Buffers, Formats};
use crate::method::gaussians::{ColorBounds, Order, Settings, Support};
use crate::number::elementary::{cos, pow, sin};
use crate::scene::{Camera, Gaussians, Lens, Pose, Scene};
use glam::{DVec3, Vec3};

pub(in super::super) const FAILURES: [Failure; 6] = [
    Failure {
        id: "gaussians-popping",
        title: "Splats pop when the camera turns",
        why: "One ball is in front of a long panel, another ball is behind it. The camera turns \
              around them by 0.02 degrees, which reverses the order of their centres by depth. One \
              order holds for the whole picture, so both balls pop wherever the panel reaches them \
              [Radl et al. 2024, StopThePop]. The error compares the two frames.",
        swept: "standard deviation of the panel, distances of a ball from its centre",
        values: &[0.25, 0.375, 0.5, 1.5, 2.0, 3.0, 4.0],
        error: "greatest change of a pixel, of 255",
        limit: SEEN,
        cure: "`--order pixel`",
        at: popping,
    },
    Failure {
        id: "gaussians-steps",
        title: "Sort keys of 16 bits mix neighbours in a large scene",
        why: "Pairs of splats lie one behind the other, and one splat lies far away. Keys of 16 bits \
              divide the range of distances into 65,536 steps. Where both splats of a pair are in \
              one step, the first one in the file is drawn in front, and here it should be behind. \
              The truth is the greatest density along each ray, in f64.",
        swept: "distance of the farthest splat, gaps of a pair",
        values: &[16384.0, 32768.0, 65536.0, 98304.0, 131072.0, 262144.0, 1048576.0],
        error: "wrong pixels, per mille of those drawn",
        limit: 10.0,
        cure: "`--order distance`",
        at: steps,
    },
    Failure {
        id: "gaussians-8-bits",
        title: "Faint layers are lost in 8 bits",
        why: "Splats lie one behind the other. Together they let a tenth of the light through, so \
              each of many is faint. Buffers of 8 bits round the colour and the transmittance after \
              each splat. A splat that changes them by less than half a step is lost. The truth is \
              the picture in f32.",
        swept: "splats",
        values: &[1.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0],
        error: "greatest error of a pixel, of 255",
        limit: SEEN,
        cure: "`--storage f16`",
        at: layers,
    },
    Failure {
        id: "gaussians-negative",
        title: "A colour below 0 darkens the splats behind it",
        why: "A splat is in front of a bright one. A coefficient of degree 1 of its spherical \
              harmonics makes it less red from here. Beyond 1.02 its red is below 0, and it takes \
              more light from the splat behind than it hides. The draft of glTF does not bound \
              colours, but the original program trains with colours from 0. The truth is the \
              greatest density along each ray, in f64, with red from 0.",
        swept: "coefficient of degree 1",
        values: &[0.0, 0.5, 1.0, 1.5, 2.0, 3.0],
        error: "greatest error of a pixel, of 255",
        limit: SEEN,
        cure: "`--color-bounds zero`",
        at: negative,
    },
    Failure {
        id: "gaussians-tiles",
        title: "The picture depends on where the tiles are",
        why: "Opaque splats lie one behind the other. The original program draws a splat in every \
              pixel of the tiles of 16 x 16 pixels that its three standard deviations touch. Just \
              beyond them alpha is still 0.011. The principal point moves by 8 pixels, and the \
              picture is moved back. The error compares it with the picture before.",
        swept: "splats",
        values: &[1.0, 2.0, 4.0, 16.0, 32.0, 64.0],
        error: "greatest change of a pixel, of 255",
        limit: SEEN,
        cure: "`--support none`",
        at: tiles,
    },
    Failure {
        id: "gaussians-stop",
        title: "The early stop leaves a hole behind a dark splat",
        why: "A dark splat is in front of a bright and opaque one. gsplat ends a pixel before the \
              splat that takes the transmittance to 0.0001, and bounds alpha by 0.999. If the dark \
              splat lets less than a tenth through, the bright one is not drawn where it is opaque. \
              With a bound of 0.99, as in the original program, at most a hundredth of the light is \
              lost. The truth is the greatest density along each ray, in f64.",
        swept: "opacity of the splat in front",
        values: &[0.5, 0.75, 0.85, 0.88, 0.91, 0.94],
        error: "greatest error of a pixel, of 255",
        limit: SEEN,
        cure: "`--stop 0`",
        at: stop,
    },
];

fn popping(length: f64, exec: &Exec) -> Result<[Found; 2]> {
    // The panel's right half leads away.
    let panel = Blob {
        scale: DVec3::new(length, 0.5, 0.02),
        rotation: turn(DVec3::Y, 60.0),
        ..Blob::round(DVec3::ZERO, 0.0, ORANGE)
    };
    let ball = |x: f64| Blob::round(DVec3::X * x, 0.2, BLUE);
    let scene = scene(&[panel, ball(-1.0), ball(1.0)])?;
    let camera = |degrees: f64| {
        let angle = degrees.to_radians();
        let eye = DVec3::new(sin(angle), 0.0, cos(angle)) * 16.0;
        Camera::new(
            240,
            180,
            Pose { eye, target: DVec3::ZERO, up: DVec3::Y },
            Lens::FieldOfView(14.0),
        )
    };
    let [before, after] = [camera(-0.01)?, camera(0.01)?];
    both(|cured| {
        let order = if cured { Order::Pixel } else { Order::Depth };
        let settings = Settings { order, ..Settings::INRIA };
        // The second frame has the right order, so the first is the one to show.
        let second = draw(&scene, &after, settings, exec)?.0.color("blended")?.clone();
        measured(&scene, &before, settings, |found| worst(found, &second), exec)
    })
}

fn steps(gaps: f64, exec: &Exec) -> Result<[Found; 2]> {
    const GAP: f64 = 1.0 / 256.0;
    let camera = ahead([160, 120], 160.0)?;
    let far = gaps * GAP;
    let mut blobs = vec![Blob::round(-DVec3::Z * far, far / 100.0, DVec3::splat(0.5))];
    for i in 0..108 {
        let (x, y) = (f64::from(i % 12) - 5.5, f64::from(i / 12) - 4.0);
        let ray = DVec3::new(x * 0.075, y * 0.075, -1.0);
        // Each pair is somewhere else between two steps.
        let depth = 4.0 + 0.0137 * f64::from(i);
        let behind = ray.normalize() * GAP;
        blobs.push(Blob::round(ray * depth + behind, 0.06, ORANGE));
        blobs.push(Blob::round(ray * depth, 0.06, BLUE));
    }
    let truth = truth(&blobs, &camera, 1, exec);
    let scene = scene(&blobs)?;
    both(|cured| {
        let order = if cured { Order::Distance } else { Order::Steps };
        let settings = Settings { order, ..Settings::KHR };
        measured(&scene, &camera, settings, |found| share(found, &truth), exec)
    })
}

fn layers(count: f64, exec: &Exec) -> Result<[Found; 2]> {
    let camera = ahead([160, 120], 160.0)?;
    let opacity = 1.0 - pow(0.1, 1.0 / count);
    let layer = |i: u32| {
        let at = -DVec3::Z * (4.0 + f64::from(i) / 256.0);
        Blob { opacity, ..Blob::round(at, 0.8, ORANGE) }
    };
    let scene = scene(&(0..count as u32).map(layer).collect::<Vec<_>>())?;
    let mut session = Session::new(&scene, Settings::KHR.into(), exec)?;
    let truth = session.render(&camera)?.frame.color("blended")?.clone();
    let mut found = |buffers| {
        let formats = Formats { buffers, ..Formats::WHOLE };
        let frame = session.emulate(&camera, formats, false)?.frame;
        let error = worst(frame.color("blended")?, &truth);
        // The emulation says nothing about time.
        Ok(Found { error, picture: frame.color("")?.clone(), time: None })
    };
    Ok([found(Buffers::Unorm8)?, found(Buffers::F16)?])
}

fn negative(coefficient: f64, exec: &Exec) -> Result<[Found; 2]> {
    let camera = ahead([160, 120], 320.0)?;
    // The middle of degree 1 is 0.4886 z, and the direction is -z.
    let red = 0.5 - 0.488_602_511_902_919_9 * coefficient;
    let blob = |red: f64| Blob {
        opacity: 0.9,
        ..Blob::round(-DVec3::Z * 4.0, 0.2, DVec3::new(red, 0.5, 0.5))
    };
    let behind = Blob::round(-DVec3::Z * 8.0, 0.6, DVec3::splat(0.9));
    let bounded = if red > 0.0 { red } else { 0.0 };
    let truth = truth(&[blob(bounded), behind], &camera, 1, exec);
    let scene = with_degree_1(scene(&[blob(0.5), behind])?, coefficient)?;
    both(|cured| {
        let bounds = if cured { ColorBounds::Zero } else { ColorBounds::None };
        let settings = Settings { bounds, ..Settings::KHR };
        measured(&scene, &camera, settings, |found| worst(found, &truth), exec)
    })
}

/// Gives the first Gaussian a coefficient of degree 1 along z, in red.
fn with_degree_1(scene: Scene, coefficient: f64) -> Result<Scene> {
    let Some(gaussians) = scene.gaussians else { return Ok(scene) };
    let mut arrays = gaussians.into_arrays();
    let look = |color: Vec3| [color, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO];
    arrays.degree = 1;
    arrays.harmonics = arrays.harmonics.into_iter().flat_map(look).collect();
    arrays.harmonics[2].x = coefficient as f32;
    Ok(Scene::of_gaussians(&scene.name, Gaussians::new(arrays)?.0))
}

fn tiles(count: f64, exec: &Exec) -> Result<[Found; 2]> {
    const SHIFT: u32 = 8;
    let camera = ahead([160, 120], 160.0)?;
    let shifted = Camera { cx: camera.cx + SHIFT as f32, cy: camera.cy + SHIFT as f32, ..camera };
    // A standard deviation is 12 pixels.
    let layer = |i: u32| {
        let depth = 4.0 + f64::from(i) / 256.0;
        Blob::round(-DVec3::Z * depth, 0.075 * depth, DVec3::splat(0.75))
    };
    let scene = scene(&(0..count as u32).map(layer).collect::<Vec<_>>())?;
    both(|cured| {
        let support = if cured { Support::None } else { Support::Tiles };
        let settings = Settings { support, ..Settings::INRIA };
        let size = [camera.width - SHIFT, camera.height - SHIFT];
        let moved = draw(&scene, &shifted, settings, exec)?.0;
        let back = part(moved.color("blended")?, [SHIFT; 2], size);
        let error = |found: &Plane<_>| worst(&part(found, [0; 2], size), &back);
        measured(&scene, &camera, settings, error, exec)
    })
}

fn stop(opacity: f64, exec: &Exec) -> Result<[Found; 2]> {
    let camera = ahead([160, 120], 160.0)?;
    let dark = Blob { opacity, ..Blob::round(-DVec3::Z * 4.0, 8.0, DVec3::new(0.1, 0.1, 0.2)) };
    let bright = Blob::round(-DVec3::Z * 8.0, 8.0, ORANGE);
    let blobs = [dark, bright];
    let truth = truth(&blobs, &camera, 1, exec);
    let scene = scene(&blobs)?;
    both(|cured| {
        let stop = if cured { 0.0 } else { Settings::GSPLAT.stop };
        let settings = Settings { stop, ..Settings::GSPLAT };
        measured(&scene, &camera, settings, |found| worst(found, &truth), exec)
    })
}
