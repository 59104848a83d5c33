use super::*;
use crate::scene::{Cloud, Shape};
use std::time::Instant;

#[test]
#[ignore = "speed"]
fn speed() {
    let exec = Exec::new(2, 32).unwrap();
    let t = Instant::now();
    let surfels = Shape::Sphere.surfels(1_000_000, 0).unwrap();
    println!("shape {:?}", t.elapsed());
    for f in [1.0, 1.26, 2.0] {
        let mut cloud = surfels.clone().into_cloud();
        cloud.radius.as_mut().unwrap().iter_mut().for_each(|r| *r *= f);
        let surfels = Surfels::new(cloud).unwrap().0;
        let t = Instant::now();
        let show = |what: &str, done, of| {
            if done == 0 || done == of {
                println!("  {what} {done} {:?}", t.elapsed())
            }
        };
        let found = group(&surfels, &Rules::default(), &exec, &show).unwrap();
        println!("{:?} {:?}", found.1, t.elapsed());
        for k in [4, 8] {
            let t = Instant::now();
            let f = group_into(&surfels, &Rules::default(), k, &exec, &|_, _, _| ()).unwrap();
            println!("into {k} {:?} {:?}", f.1, t.elapsed());
            if k == 4 {
                let x = extend(&surfels, &f.0, &Extension::Add { most: 0.5 }, &exec, &|_, _, _| ())
                    .unwrap()
                    .1;
                println!("{x:?}");
            }
        }
        let t = Instant::now();
        let tree = Tree::new(&surfels, 0..surfels.len() as u32);
        println!("tree {:?}", t.elapsed());
        let c = clipped::by_lower(&tree, 1.0, &exec, &|_, _| ()).unwrap();
        for e in [Extension::Add { most: 0.5 }, Extension::Enlarge] {
            let t = Instant::now();
            let (_, x) = extend(&surfels, &found.0, &e, &exec, &|_, _, _| ()).unwrap();
            println!(
                "{e:?} {:?} {} {:?} {:?}",
                t.elapsed(),
                x.percent,
                x.groups[0],
                x.groups.last()
            );
        }
        println!("area {:?} {:?}", clipped::area(&tree, &c).0 * std::f64::consts::PI, t.elapsed());
    }
    let same = Cloud {
        position: vec![glam::Vec3::ONE; 1_000_000],
        normal: Some(vec![glam::Vec3::Z; 1_000_000]),
        radius: Some(vec![1.0; 1_000_000]),
        ..Cloud::default()
    };
    let surfels = Surfels::new(same).unwrap().0;
    let t = Instant::now();
    println!(
        "{:?} {:?}",
        group(&surfels, &Rules::default(), &exec, &|_, _, _| ()).map(|f| f.1),
        t.elapsed()
    );
}
