//! The page of a suite: a row for each rule, with both pictures. A rule that is not right links to
//! the page of its verdict, in the folder of its scene.

use super::command;
use super::report::{Exhibit, Run, Tried};
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::png::encode_frame;
use splatref::io::scene_file::Number;
use splatref::report::page::PALETTE;
use splatref::report::{VerdictReport, page};
use splatref::study::chart::escaped;
use splatref::study::report::page::{filled, inline};
use splatref::verdict::Outcome;
use splatref::verdict::client::Client;
use splatref::verdict::conformance::{Case, Judged, Report, Row};
use std::fmt::Write;
use std::path::Path;

/// The page of a verdict, in the folder of its scene.
const VERDICT: &str = "verdict.html";

/// Draws what the page shows of a rule, and writes the page of its verdict if it is not right.
pub(super) fn rule(
    case: &Case,
    client: &Client,
    judged: &Judged,
    folder: &Path,
    exec: &Exec,
) -> Result<Exhibit> {
    let (session, camera) = (&case.session(exec)?, &case.camera);
    let own = session.define::<f32>(camera, false)?.frame;
    let pictures = [encode_frame(&client.frame().to_f32())?, encode_frame(&own)?];
    let linked = judged.verdict.outcome() != Outcome::Right;
    if linked {
        let [scene, planes] = command::files(folder);
        let replay = |(x, y)| format!("splatref explain {scene} {x} {y} --client {planes}");
        let likely = judged.likely.as_ref().map(|likely| likely.words.clone());
        let page = VerdictReport::new(session, camera, client, &judged.verdict, likely, &replay)?;
        let page = page.page(session, camera, Number::F32, exec)?;
        page::pending(&folder.join(VERDICT), &page, exec)?.put()?;
    }
    Ok(Exhibit { pictures, linked })
}

/// The page at `path` as text. Its links are relative to its folder.
pub(super) fn html(tried: &Tried, path: &Path, command: &str) -> Result<String> {
    let Report { method, rows } = &tried.report;
    let mut body = String::new();
    for (row, run) in rows.iter().zip(&tried.runs) {
        body += &one(row, run, path)?;
    }
    let summary = tried.report.summary();
    let texts = [
        ("title", escaped(&format!("splatref conformance {method}"))),
        ("style", [PALETTE, include_str!("page.css")].concat()),
        ("command", escaped(command)),
        ("summary", escaped(&summary.join("\n"))),
        ("rows", body),
    ];
    Ok(filled(include_str!("page.html"), &texts))
}

/// The row of a rule.
fn one(row: &Row, run: &Run, path: &Path) -> Result<String> {
    let (name, tests, word) = (escaped(&row.rule.name), escaped(&row.rule.tests), row.word());
    let name = match run.shown.linked {
        true => format!("<a href=\"{}\">{name}</a>", escaped(&link(path, &run.folder)?)),
        false => name,
    };
    let mut html = format!(
        "<tr class=\"{word}\"><th scope=\"row\">{name}</th><td class=\"word\">{word}</td><td>{tests}"
    );
    let cause = row.cause();
    if !cause.is_empty() {
        let _ = write!(html, "<p class=\"cause\">{}</p>", escaped(&cause));
    }
    html += "</td>";
    for (picture, side) in run.shown.pictures.iter().zip(["renderer", "splatref"]) {
        let image = picture.as_ref().map_or_else(String::new, |png| {
            let of = escaped(&row.rule.name);
            format!("<img src=\"{}\" alt=\"{of}, drawn by {side}\">", inline(png))
        });
        let _ = write!(html, "<td>{image}</td>");
    }
    let _ = writeln!(html, "<td>{:.2} s</td></tr>", run.seconds);
    Ok(html)
}

/// The way from the folder of a page to the page of a verdict, as a relative URL.
fn link(page: &Path, folder: &Path) -> Result<String> {
    let absolute =
        |path: &Path| std::path::absolute(path).map_err(|source| splatref::Error::io(path, source));
    let (from, to) = (absolute(page)?, absolute(&folder.join(VERDICT))?);
    let (from, to): (Vec<_>, Vec<_>) =
        (from.parent().unwrap_or(&from).components().collect(), to.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..".to_owned(), from.len() - shared);
    let down = to[shared..].iter().map(|part| percent(&part.as_os_str().to_string_lossy()));
    Ok(up.chain(down).collect::<Vec<_>>().join("/"))
}

/// A part of a path in a URL.
fn percent(part: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    let bytes = part.bytes();
    bytes.map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_relative_to_the_page() {
        let of = |page: &str, folder: &str| link(Path::new(page), Path::new(folder)).unwrap();
        assert_eq!(of("out/a.html", "out/ewa/rim"), "ewa/rim/verdict.html");
        assert_eq!(of("pages/a.html", "my out/ewa/rim"), "../my%20out/ewa/rim/verdict.html");
        assert_eq!(of("a.html", "#1/rim"), "%231/rim/verdict.html");
    }
}
