//! Tests pages in a real browser: Chromium, over its debugging pipe.
//!
//! Without Chromium (`SPLATREF_CHROMIUM` or the command `chromium`) the tests say so and are
//! skipped.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod chromium;
mod verdict;

use chromium::{Browser, Page};
use std::path::Path;
use std::process::Command;

/// A study of few candidates in a folder of its own.
fn study(folder: &Path) {
    let out = Command::new(env!("CARGO_BIN_EXE_splatref"))
        .args(["study", "sphere", "--count", "400", "--size", "96x64", "--method", "blue", "-o"])
        .arg(folder)
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

/// What is drawn at the middle of a canvas: red, green and blue.
fn middle(page: &mut Page<'_>, canvas: &str) -> String {
    page.text(&format!(
        "(() => {{ const c = document.getElementById('{canvas}'); \
         return [...c.getContext('2d').getImageData(c.width / 2, c.height / 2, 1, 1).data].slice(0, 3).join(' ') }})()"
    ))
}

#[test]
fn a_study_is_looked_at() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    for [width, height] in [[1280, 800], [390, 800]] {
        let mut page = browser.open(&folder.path().join("index.html"), [width, height]);
        page.wait("document.body.dataset.ready?.endsWith(' side')");
        assert_eq!(page.text("String(document.documentElement.scrollWidth <= innerWidth)"), "true");
        let rows: usize =
            page.text("String(document.querySelectorAll('tbody tr').length)").parse().unwrap();
        assert!(rows >= 3, "{rows} candidates");

        // A click on the last point of the chart shows its picture.
        page.click(&format!("#chart g[data-point='{}']", rows - 1));
        page.wait(&format!("document.body.dataset.ready === '{} side'", rows - 1));
        assert!(
            page.text("document.getElementById('name').textContent")
                .starts_with(&format!("{rows}  "))
        );
        let [picture, truth] = ["picture", "truth"].map(|canvas| middle(&mut page, canvas));
        assert_ne!(picture, "0 0 0");

        // The truth in its place by blinking and by the slider.
        page.click("#blink");
        page.wait("document.getElementById('says').textContent === 'Truth'");
        assert_eq!(middle(&mut page, "picture"), truth);
        page.wait("document.getElementById('says').textContent === 'Picture'");
        assert_eq!(middle(&mut page, "picture"), picture);
        page.click("#slide");
        page.wait(&format!("document.body.dataset.ready === '{} slide'", rows - 1));
        page.text(
            "(() => { const s = document.getElementById('split'); s.value = 0; \
                   s.dispatchEvent(new Event('input')); return '' })()",
        );
        page.wait(&format!(
            "(() => {{ const c = document.getElementById('picture'); const d = \
                   c.getContext('2d').getImageData(c.width / 2, c.height / 2, 1, 1).data; \
                   return [...d].slice(0, 3).join(' ') === '{truth}' }})()"
        ));

        // The worst pixel is read out, and its address can be sent.
        page.click("#side");
        page.click("#worst");
        page.wait("document.getElementById('read').textContent.includes('picture')");
        assert!(page.text("location.hash").starts_with(&format!("#{rows},")));
        page.key("n");
        page.wait("document.body.dataset.ready === '0 side'");
        page.finish();
    }
}
