//! The pages of `verify` and `compare`.

use super::chromium::{Browser, Page};
use std::path::Path;
use std::process::Command;

const SCENE: [&str; 5] = ["sphere", "--count", "400", "--size", "96x64"];

/// What a command printed in a folder; its exit code must be this one.
fn splatref(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let out = Command::new(env!("CARGO_BIN_EXE_splatref"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(code), "{}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// A client whose epsilon is half as wide, and the page about it.
fn verdict(folder: &Path) -> serde_json::Value {
    let [scene, rest @ ..] = SCENE;
    let render = [&["render", scene], &rest[..], &["--stages", "-o"]].concat();
    splatref(folder, 0, &[&render[..], &["mine.exr", "--epsilon", "1r"]].concat());
    splatref(folder, 0, &[&render[..], &["truth.exr"]].concat());
    let pages = ["--report", "page.html", "--json", "verdict.json"];
    splatref(folder, 1, &[&["verify", scene, "mine.exr"], &rest[..], &pages].concat());
    let json = std::fs::read_to_string(folder.join("verdict.json")).unwrap();
    serde_json::from_str(&json).unwrap()
}

/// The text of an element.
fn text(page: &mut Page<'_>, id: &str) -> String {
    page.text(&format!("document.getElementById('{id}').textContent"))
}

/// A number of the read-out: a row of a channel.
fn number(page: &mut Page<'_>, channel: &str, row: &str) -> String {
    page.text(&format!(
        "[...document.querySelectorAll(\"#read tbody[data-channel='{channel}'] tr\")] \
         .find(row => row.cells[0].textContent === '{row}').cells[1].textContent"
    ))
}

fn fits(page: &mut Page<'_>) -> bool {
    page.text("String(document.documentElement.scrollWidth <= innerWidth)") == "true"
}

#[test]
fn a_verdict_is_looked_at() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let json = verdict(folder.path());
    let worst = &json["stages"][1]["worst"];
    let [x, y] = [0, 1].map(|i| worst["pixel"][i].as_u64().unwrap());
    for [width, height] in [[1280, 900], [390, 844]] {
        let mut page = browser.open(&folder.path().join("page.html"), [width, height]);
        // The first wrong stage is shown first.
        page.wait("document.body.dataset.ready === '1 0 side'");
        assert!(fits(&mut page), "at {width}");
        assert!(text(&mut page, "says").contains("WRONG in"));

        // The list jumps to the worst pixel, with the client's number and what is right there.
        page.click("#worst button");
        page.wait(&format!(
            "document.getElementById('read').textContent.startsWith('({x}, {y}) WRONG')"
        ));
        assert!(text(&mut page, "read").contains("looks like: "));
        let shown = number(&mut page, "attributes.count", "client");
        assert_eq!(shown, worst["found"].as_f64().unwrap().to_string());
        assert_eq!(
            number(&mut page, "attributes.count", "right"),
            worst["interval"][0].as_f64().unwrap().to_string()
        );
        assert!(
            text(&mut page, "decisions").contains("visible if depth"),
            "as explain prints them"
        );
        assert!(fits(&mut page), "at {width}, with the decisions");

        // Arrows move the cursor by a pixel; every number is the client's, to the last digit.
        page.text("document.getElementById('views').focus() ?? ''");
        page.press("ArrowDown");
        page.press("ArrowDown");
        page.press("ArrowLeft");
        let (x, y) = (x - 1, y + 2);
        page.wait(&format!(
            "document.getElementById('read').textContent.startsWith('({x}, {y}) ')"
        ));
        let mine = splatref::io::exr::read(&folder.path().join("mine.exr")).unwrap();
        let truth = splatref::io::exr::read(&folder.path().join("truth.exr")).unwrap();
        for (picture, side) in [(&mine, "client"), (&truth, "reference")] {
            for channel in ["attributes.weight", "attributes.normal.X", "attributes.G"] {
                let Some(splatref::frame::image::Values::Float(values)) = picture.channel(channel)
                else {
                    panic!("no {channel}");
                };
                let value = values[(y * 96 + x) as usize];
                let found: f64 = number(&mut page, channel, side).parse().unwrap();
                assert_eq!(found, f64::from(value), "{side} {channel}");
            }
        }
        page.finish();
    }
}

#[test]
fn a_verdict_has_tabs_views_and_both_schemes() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    verdict(folder.path());
    let mut page = browser.open(&folder.path().join("page.html"), [1280, 900]);
    page.wait("document.body.dataset.ready === '1 0 side'");
    let paper = "getComputedStyle(document.body).backgroundColor";
    page.prefers("dark", "reduce");
    assert_eq!(page.text(paper), "rgb(13, 17, 23)");
    page.prefers("light", "no-preference");
    assert_eq!(page.text(paper), "rgb(255, 255, 255)");

    // Tabs by click and by keyboard.
    page.click("#tab0");
    page.wait("document.body.dataset.ready === '0 0 side'");
    assert!(text(&mut page, "scale").contains("world units, linear"), "a depth says its scale");
    page.text("document.getElementById('tab0').focus() ?? ''");
    page.press("ArrowLeft");
    page.wait("document.body.dataset.ready === '3 0 side'");
    assert_eq!(page.text("document.activeElement.id"), "tab3");
    assert_eq!(page.text("document.querySelector('[aria-selected=true]').id"), "tab3");

    // Blinking swaps the pictures by itself, with reduced motion only by hand.
    page.click("#blink");
    page.wait("document.getElementById('caption0').textContent === 'Reference'");
    page.wait("document.getElementById('caption0').textContent === 'Client'");
    page.click("#side");
    page.prefers("light", "reduce");
    page.click("#blink");
    page.wait("document.body.dataset.ready === '3 0 blink'");
    page.text("new Promise(done => setTimeout(() => done(''), 700))");
    assert_eq!(text(&mut page, "caption0"), "Client");
    page.click("#blink");
    page.wait("document.getElementById('caption0').textContent === 'Reference'");
    page.click("#slide");
    page.wait("document.getElementById('caption0').textContent === 'Client left, Reference right'");

    // A pixel of the picture is whole pixels of the screen, of one colour.
    page.click("#side");
    page.click("#plus");
    page.click("#plus");
    page.wait("document.body.dataset.ready === '3 0 side'");
    let colors = "(() => { const c = document.getElementById('view0'); const w = c.width; \
        const d = c.getContext('2d').getImageData(0, c.height >> 1, w, 1).data; let runs = [], last = 0; \
        for (let i = 1; i < w; i++) if (d[4 * i] !== d[4 * i - 4] || d[4 * i + 1] !== d[4 * i - 3]) { runs.push(i - last); last = i; } \
        const s = scale(c); return (runs.length > 3 && Number.isInteger(s) && runs.slice(1).every(run => run % s === 0)) })()";
    page.wait(colors);
    page.finish();
}

#[test]
fn a_comparison_is_looked_at() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    verdict(folder.path());
    splatref(folder.path(), 1, &["compare", "truth.exr", "mine.exr", "--report", "c.html"]);
    let mut page = browser.open(&folder.path().join("c.html"), [390, 844]);
    page.wait("document.body.dataset.ready.endsWith(' side')");
    assert!(fits(&mut page));
    assert_eq!(
        page.text("document.querySelector('[aria-selected=true]').textContent.trim().slice(0, 1)"),
        "\u{2717}"
    );
    page.click("#worst button");
    page.wait("document.getElementById('read').textContent.includes('DIFFERENT; difference ')");
    page.finish();
}

#[test]
fn a_suite_is_looked_at() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let command = format!(
        "'{}' render {{scene}}/scene.toml --stages -o {{out}} --epsilon 1r",
        env!("CARGO_BIN_EXE_splatref")
    );
    let suite = ["conformance", "ewa", "--only", "rim,ball", "-o", "my suite"];
    let report = ["--command", &command, "--report", "page.html"];
    splatref(folder.path(), 1, &[&suite[..], &report].concat());
    assert!(!folder.path().join("my suite/ewa/rim/verdict.html").exists(), "right");
    for [width, height] in [[1280, 900], [390, 844]] {
        let mut page = browser.open(&folder.path().join("page.html"), [width, height]);
        page.wait("document.readyState === 'complete'");
        assert!(fits(&mut page), "at {width}");
        let words = "[...document.querySelectorAll('td.word')].map(of => of.textContent).join()";
        assert_eq!(page.text(words), "right,wrong");
        assert!(page.text("document.body.textContent").contains("; looks like epsilon is half"));
        let drawn = "String([...document.images].every(of => of.naturalWidth > 8))";
        assert_eq!(
            (page.text(drawn), page.text("String(document.images.length)")),
            ("true".into(), "4".into())
        );

        // The wrong rule leads to its numbers.
        let link = page.text("document.querySelector('tbody a').href");
        assert!(link.ends_with("/my%20suite/ewa/ball/verdict.html"), "{link}");
        page.finish();
        let verdict = folder.path().join("my suite/ewa/ball/verdict.html");
        let mut page = browser.open(&verdict, [width, height]);
        page.wait("document.body.dataset.ready === '1 0 side'");
        assert!(text(&mut page, "says").contains("WRONG in"));
        page.finish();
    }
}
