//! Run your renderer on the suite of a method: one small scene and one verdict for each rule.
//!
//! ```sh
//! cargo run --release --example conform
//! ```

use splatref::frame::Exec;
use splatref::setting::{Fields, Value};
use splatref::verdict::client::Client;
use splatref::verdict::conformance::{Case, Renderer, Rule, run};
use splatref::{Result, Session};

/// Your renderer. Here splatref stands in for it, with an epsilon of your choice.
struct Mine {
    epsilon: Option<f32>,
}

impl Renderer for Mine {
    fn draw(&mut self, case: &Case) -> Result<Client> {
        // Upload `case.scene.surfels`, draw with `case.camera`, and read your buffers back.
        let (exec, mut method) = (Exec::sequential(), case.method);
        if let Some(epsilon) = self.epsilon {
            let set = method.set("epsilon", &Value::Number(epsilon));
            set.expect("ewa has an epsilon");
        }
        let session = Session::new(&case.scene, method, &exec)?;
        Ok(Client::from(&session.define::<f32>(&case.camera, true)?.frame))
    }
}

// In your own crate, this line makes a test of `cargo test`.
splatref::conformance! { my_ewa_is_right: "ewa", Mine { epsilon: None }; }

fn main() -> Result<()> {
    let exec = Exec::new(0, 32)?;
    let small = |rule: &Rule| !rule.large;
    let report = run("ewa", &mut Mine { epsilon: None }, small, &exec)?;
    println!("{report}\n");
    assert!(report.is_right());

    // With another epsilon a ball has other fragments. A rim does not depend on epsilon.
    let report = run("ewa", &mut Mine { epsilon: Some(0.25) }, small, &exec)?;
    println!("{report}");
    let wrong: Vec<&str> = report
        .rows
        .iter()
        .filter(|row| row.word() == "wrong")
        .map(|row| row.rule.name.as_str())
        .collect();
    assert!(wrong.contains(&"ball") && !wrong.contains(&"rim"), "{wrong:?}");
    Ok(())
}
