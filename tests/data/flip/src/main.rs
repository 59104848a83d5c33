//! Prints the references of src/verify/metrics/flip.rs.

fn code(x: u32, y: u32, c: u32, kind: u32) -> u8 {
    let value = match kind {
        0 => x * 4 + y * 2 + c * 40,
        1 => (x + 1) * 4 + y * 2 + c * 40,
        2 => x * x * 7 + y * 13 + x * y * 3 + c * 91,
        3 => {
            if (x / 8 + y / 8) % 2 == 0 {
                200 + c * 20
            } else {
                30 + c * 60
            }
        }
        _ => {
            if (x + 1) / 8 % 2 == 0 {
                200 - c * 70
            } else {
                30 + c * 60
            }
        }
    };
    (value % 256) as u8
}
fn main() {
    for (w, h, a, b, ppd) in [
        (64, 48, 0, 1, 67.0),
        (64, 48, 0, 2, 67.0),
        (64, 48, 3, 4, 67.0),
        (37, 12, 3, 2, 67.0),
        (90, 70, 4, 0, 30.0),
        (90, 70, 2, 3, 100.0),
    ] {
        let image = |kind| {
            let mut bytes = Vec::new();
            for y in 0..h {
                for x in 0..w {
                    for c in 0..3 {
                        bytes.push(code(x, y, c, kind));
                    }
                }
            }
            nv_flip::FlipImageRgb8::with_data(w, h, &bytes)
        };
        let map = nv_flip::flip(image(b), image(a), ppd);
        let pool = nv_flip::FlipPool::from_image(&map);
        let v = map.to_vec();
        println!(
            "([{w}, {h}], [{a}, {b}], {ppd:.1}, [{}, {}, {}]),",
            pool.mean(),
            v[0],
            v[((h / 3) * w + w / 2) as usize]
        );
    }
}
