//! `splatref conformance`: runs a renderer on the suite of a method, and reports on every rule.

mod command;
mod page;
mod report;

use super::options::{ExecOptions, method};
use super::verify::{rounding, share};
use super::{Ended, Ending, output, progress, say};
use command::{Program, split};
use report::{Exhibit, Run, Tried};
use splatref::frame::Exec;
use splatref::io::conformance::{write, write_index};
use splatref::io::replace::Pending;
use splatref::method::Method;
use splatref::setting::{Fields, Refused, Value};
use splatref::verdict::client::Rounding;
use splatref::verdict::conformance::{Renderer, Report, Row, Rule};
use splatref::verdict::{Outcome, Verdict};
use splatref::{Error, Result};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(after_help = "\
Each rule has a small scene. For each scene, splatref writes a folder FOLDER/METHOD/RULE, runs the
command, and judges the planes that the command wrote. The folder has a README.md that lists the files
of the scene and the planes to leave. FOLDER/METHOD/README.md shows all scenes, with the conventions and
what the verdicts mean: the folder can be given away.

In the command, {scene} stands for the folder of the scene, and {out} for the EXR to write, which is
{scene}/client.exr. A command that writes other files describes them in {scene}/client.toml, as for
verify. splatref splits the command at blanks; quotes keep blanks together. No shell runs it: for a
shell, write sh -c '...'. What the command prints is kept in {scene}/client.log.

Examples:
  splatref conformance ewa --list
  splatref conformance ewa --command './mine {scene} {out}'
  splatref conformance ewa --command './mine {scene} {out}' --only rim,tie
  splatref conformance gaussians --preset khr --command './mine {scene} {out}'
  splatref conformance peeling --command 'python mine.py {scene} {out}' --junit junit.xml

Exit codes: 0 all right, 1 any wrong or failed, or their decisions biased to one side, 2 wrong usage or
the scenes could not be written, 3 any undecidable, 4 any unlike those of right renderers; with
--strict that is 1.")]
pub(super) struct Args {
    /// The method
    #[arg(value_parser = method)]
    method: &'static str,
    /// Choose a preset of the method's settings: for gaussians khr, inria, gsplat, mip, exact or 2dgs
    #[arg(long, value_name = "NAME")]
    preset: Option<String>,
    /// Run this command for each scene; without it, only write the scenes
    #[arg(long, value_name = "COMMAND", allow_hyphen_values = true)]
    command: Option<String>,
    /// Run only these rules; repeatable, or several between commas
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    only: Vec<String>,
    /// List the rules, and what each tests
    #[arg(long, conflicts_with_all = ["command", "only"])]
    list: bool,
    /// Write the folders of the scenes into this folder; it is made if it does not exist
    #[arg(short, long, value_name = "FOLDER", default_value = "out/conformance")]
    output: PathBuf,
    /// End the command after this many seconds [default: no limit]
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..))]
    timeout: Option<u64>,
    /// Set how precise the client's operations are, as for verify
    #[arg(long, value_name = "gpu|precise|ieee", value_parser = rounding)]
    promise: Option<Rounding>,
    /// Report "undecidable" if more than this fraction of the pixels has undecided sums
    #[arg(long, value_name = "X", default_value_t = Verdict::BUDGET, value_parser = share)]
    budget: f64,
    /// Exit with 1 also if a picture is right, but unlike that of any right renderer
    #[arg(long)]
    strict: bool,
    /// Write the report as JSON; docs/conformance.schema.json describes it
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
    /// Write the report as JUnit XML
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,
    /// Write a page that shows every rule; each that is not right links to the page of its verdict
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    exec: ExecOptions,
}

/// An error that prevents the verdicts exits with 2, because 1 says that a picture is wrong.
pub(super) fn run(args: &Args) -> Ended {
    suite(args).map_err(|error| Error::Usage(error.to_string()))
}

fn suite(args: &Args) -> Ended {
    let (method, rules) = rules(args)?;
    if args.list {
        let width = Report::width(&rules);
        rules.iter().for_each(|rule| say(format!("{:<width$}  {}", rule.name, rule.tests)));
        return Ok(Ending::Good);
    }
    let outputs: Vec<&PathBuf> = args.json.iter().chain(&args.junit).chain(&args.report).collect();
    for (i, path) in outputs.iter().enumerate() {
        output::check_folder(path)?;
        outputs[..i].iter().try_for_each(|other| output::check_two(other, path))?;
    }
    let exec = args.exec.exec()?;
    let folder = args.output.join(args.method);
    let words = args.command.as_deref().map(split).transpose().map_err(Error::Usage)?;
    write_index(&folder, &method, &options(args), &rules)?;
    let Some(words) = words else { return scenes(&rules, &folder, &exec) };
    let timeout = args.timeout.map(Duration::from_secs);
    let absolute = std::path::absolute(&folder).map_err(|source| Error::io(&folder, source))?;
    let mut program =
        Program { words, folder: absolute, timeout, promise: args.promise, exec: &exec };
    let tried = try_all(args, rules, &folder, &mut program, &exec)?;
    finish(args, &folder, &tried)
}

/// The options that choose the same rules again.
fn options(args: &Args) -> String {
    let preset = args.preset.iter().map(|preset| format!(" --preset {preset}"));
    let only = (!args.only.is_empty()).then(|| format!(" --only {}", args.only.join(",")));
    preset.chain(only).fold(args.method.to_owned(), |all, option| all + &option)
}

/// The method, and the rules to run.
fn rules(args: &Args) -> Result<(Method, Vec<Rule>)> {
    let mut method = Method::by_name(args.method)?;
    if let Some(preset) = &args.preset {
        set_preset(&mut method, preset)?;
    }
    let all = Rule::of(&method);
    let known = |name: &&String| all.iter().any(|rule| rule.name == **name);
    if let Some(unknown) = args.only.iter().find(|name| !known(name)) {
        let method = args.method;
        return Err(Error::Usage(format!(
            "--only {unknown}: {method} has no such rule; `splatref conformance {method} --list` lists \
             the rules"
        )));
    }
    let taken = |rule: &Rule| args.only.is_empty() || args.only.contains(&rule.name);
    let taken = all.into_iter().filter(taken).collect();
    Ok((method, taken))
}

/// Sets the preset with this name.
fn set_preset(method: &mut Method, preset: &str) -> Result<()> {
    let found = method.set("preset", &Value::Text(preset.into()));
    found.map_err(|refused| {
        Error::Usage(match refused {
            Refused::Wrong(what) => format!("--{what}"),
            Refused::Unknown | Refused::Idle(_) => {
                format!("--preset {preset}: the method {} has no presets; remove it", method.name())
            }
        })
    })
}

/// Writes the scenes, and runs nothing.
fn scenes(rules: &[Rule], folder: &Path, exec: &Exec) -> Ended {
    let steps = progress::Steps::new("writing");
    for (i, rule) in rules.iter().enumerate() {
        steps.show(&rule.name, i as u64, rules.len() as u64);
        write(&folder.join(&rule.name), rule, &rule.case(exec)?, exec)?;
    }
    drop(steps);
    say(format!("wrote {} scenes into {}", rules.len(), folder.display()));
    say("give --command to run a renderer on them");
    Ok(Ending::Good)
}

/// Runs the command on every rule, and prints the table row by row.
fn try_all(
    args: &Args,
    rules: Vec<Rule>,
    folder: &Path,
    program: &mut Program<'_>,
    exec: &Exec,
) -> Result<Tried> {
    let (width, count) = (Report::width(&rules), rules.len() as u64);
    let mut tried = Tried::new(args.method);
    for (i, rule) in rules.into_iter().enumerate() {
        let case = rule.case(exec)?;
        let place = folder.join(&rule.name);
        write(&place, &rule, &case, exec)?;
        let steps = progress::Steps::new("running");
        steps.show(&format!("running {}", rule.name), i as u64, count);
        let start = Instant::now();
        let drawn = program.draw(&case);
        let seconds = start.elapsed().as_secs_f64();
        let name = rule.name.clone();
        let judged = drawn.and_then(|client| Ok((case.judge(&client, args.budget, exec)?, client)));
        // A page that cannot be written is no failure of the renderer.
        let shown = match &judged {
            Ok((judged, client)) if args.report.is_some() => {
                page::rule(&case, client, judged, &place, exec)?
            }
            _ => Exhibit::default(),
        };
        drop(steps);
        let row = Row::new(rule, judged.map(|(judged, _)| judged));
        say(format!("{name:<width$}  {row}"));
        tried.push(row, Run { seconds, folder: place, shown });
    }
    Ok(tried)
}

/// Prints what all rules say together, and writes the requested files.
fn finish(args: &Args, folder: &Path, tried: &Tried) -> Ended {
    let report = &tried.report;
    report.summary().iter().for_each(say);
    let wrong = report.rows.iter().find(|row| row.outcome() == Some(Outcome::Wrong));
    if let Some(row) = wrong {
        let [scene, client] = command::files(&folder.join(&row.rule.name));
        say(format!("look closer: splatref verify {scene} {client}"));
    }
    let command = args.command.as_deref().unwrap_or_default();
    let json = args.json.as_ref().map(|path| (path, tried.json(command)));
    let junit = args.junit.as_ref().map(|path| (path, Ok(tried.junit())));
    let page = args.report.as_ref().map(|path| (path, page::html(tried, path, command)));
    let files = json.into_iter().chain(junit).chain(page).map(|(path, text)| {
        let text = text?;
        Pending::write(path, |file| file.write_all(text.as_bytes()))
    });
    files.collect::<Result<Vec<_>>>()?.into_iter().try_for_each(Pending::put)?;
    Ok(tried.ending().or_strict(args.strict))
}
