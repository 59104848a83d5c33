//! The files of a case are the case: what is read back draws the same picture.

use splatref::frame::Exec;
use splatref::io::conformance::write;
use splatref::io::scene_file::SceneFile;
use splatref::method::Method;
use splatref::verdict::client::Client;
use splatref::verdict::conformance::{Case, Renderer, Rule, run};

#[test]
fn what_is_written_is_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let exec = Exec::new(0, 32).unwrap();
    for method in Method::all() {
        for rule in Rule::all(method.name()).unwrap().iter().filter(|rule| !rule.large) {
            let name = format!("{}-{}", method.name(), rule.name);
            let (place, case) = (folder.path().join(&name), rule.case(&exec).unwrap());
            write(&place, rule, &case, &exec).unwrap();
            let file = SceneFile::read(&place.join("scene.toml")).unwrap();
            let ready = file.ready(&exec, &|_, _, _| ()).unwrap();
            assert_eq!(ready.loaded.scene.sha256(), case.scene.sha256(), "{name}");
            assert_eq!(ready.loaded.scene.surfels, case.scene.surfels, "{name}");
            assert_eq!((ready.camera, ready.method), (case.camera, case.method), "{name}");
            assert_eq!(ready.grouping, None, "{name}");
        }
    }
}

/// A renderer that does not keep one rule.
struct Wrong(&'static str, Exec);

impl Renderer for Wrong {
    fn draw(&mut self, case: &Case) -> splatref::Result<Client> {
        let Self(broken, exec) = self;
        let rules = Rule::all(case.method.name())?;
        let rule = rules.iter().find(|rule| rule.name == case.rule && rule.name == *broken);
        let broken = rule.map(|rule| rule.broken(exec)).transpose()?;
        let case = broken.as_ref().unwrap_or(case);
        let picture = case.session(exec)?.define::<f32>(&case.camera, true)?;
        Ok(Client::from(&picture.frame))
    }
}

#[test]
fn a_report_names_the_rule_that_is_broken() {
    let exec = Exec::new(0, 32).unwrap();
    let few = |rule: &Rule| ["rim", "tie", "epsilon-inside"].contains(&rule.name.as_str());
    let report = run("ewa", &mut Wrong("", Exec::sequential()), few, &exec).unwrap();
    assert!(report.is_right(), "{report}");
    let report = run("ewa", &mut Wrong("epsilon-inside", Exec::sequential()), few, &exec).unwrap();
    assert!(!report.is_right());
    let said = report.to_string();
    assert!(said.contains("\nepsilon-inside  wrong "), "{said}");
    assert!(said.ends_with("ewa: 2 right, 1 wrong"), "{said}");
}

splatref::conformance! {
    #[ignore = "slow: .ci/run runs it"]
    the_macro_makes_tests_that_pass: "blue", Wrong("", Exec::new(0, 32).unwrap());
    #[ignore = "slow: .ci/run runs it"]
    #[should_panic = "rim"]
    the_macro_makes_tests_that_name_the_rule: "blue", Wrong("rim", Exec::new(0, 32).unwrap());
}
