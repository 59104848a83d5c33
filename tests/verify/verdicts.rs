//! The verifier on the client: no lawful habit is called wrong, and every bug is found.

use crate::cases::{Case, cases};
use crate::client::{Bug, Habit, How, render};
use splatref::frame::{Exec, Image};
use splatref::method::{Method, Session};
use splatref::verify::client::{Client, Rounding};
use splatref::verify::verdict::{Outcome, Verdict};

/// What is said of a client's picture of a case.
fn judge((scene, camera, settings): &Case, how: How, rounding: Rounding) -> Verdict {
    let exec = Exec::sequential();
    let session = Session::new(scene, Method::Ewa(*settings), &exec).unwrap();
    let image = Image::from(&render(scene, camera, settings, how));
    let mut client = Client::of_image(&image, session.method().stages()).unwrap();
    client.rounding = rounding;
    session.verify(camera, &client, 1.0).unwrap()
}

#[test]
fn no_lawful_habit_is_called_wrong() {
    for (name, case) in cases() {
        for habit in Habit::ALL {
            let plain = matches!(habit, Habit::Plain | Habit::Fused);
            let promises =
                if plain { &[Rounding::Gpu, Rounding::Ieee][..] } else { &[Rounding::Gpu] };
            for promise in promises {
                let verdict = judge(&case, How { habit: *habit, bug: None }, *promise);
                for stage in &verdict.stages {
                    let wrong = stage.worst.as_ref();
                    println!(
                        "{name} {} {promise:?} {} {} {wrong:?}",
                        habit.name(),
                        stage.stage,
                        stage.wrong
                    );
                }
                println!(
                    "{name} {} {promise:?}: {:?} {} / {}",
                    habit.name(),
                    verdict.outcome(),
                    verdict.undecided,
                    verdict.covered
                );
            }
        }
    }
}

#[test]
fn every_bug_is_found() {
    for bug in Bug::ALL {
        let how = How { habit: Habit::Plain, bug: Some(*bug) };
        for promise in [Rounding::Ieee, Rounding::Gpu] {
            let mut line = format!("{} {promise:?}:", bug.name());
            for (name, case) in cases() {
                let verdict = judge(&case, how, promise);
                if verdict.outcome() == Outcome::Wrong {
                    let first = verdict.first_wrong().unwrap();
                    line += &format!(" {name} ({} {})", first.stage, first.wrong);
                }
            }
            println!("{line}");
        }
    }
}
