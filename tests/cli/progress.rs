//! Progress of long work on a terminal. Elsewhere there is none, which every other test holds.

use std::io::ErrorKind;
use std::process::Command;

/// Takes seconds.
const LONG: [&str; 4] = ["study", "failures", "--only", "deferred-motion"];

/// `script` of util-linux gives a program a terminal.
#[test]
fn long_work_is_seen_on_a_terminal() {
    let at = tempfile::tempdir().unwrap();
    let command = format!("{} {}", env!("CARGO_BIN_EXE_splatref"), LONG.join(" "));
    let mut script = Command::new("script");
    let out = match script.args(["-qefc", &command, "/dev/null"]).current_dir(at.path()).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!("skipped: there is no `script`");
            return;
        }
        out => out.unwrap(),
    };
    let said = String::from_utf8(out.stdout).unwrap();
    assert!(out.status.success(), "{said}");
    let shown: Vec<&str> = said.split(['\r', '\n']).filter(|line| line.contains('%')).collect();
    assert!(shown.iter().any(|line| line.contains("deferred-motion [")), "{said}");
    // What was found stands below, on a line that nothing was drawn on.
    assert!(said.lines().any(|line| line.trim().starts_with("total ")), "{said}");
}
