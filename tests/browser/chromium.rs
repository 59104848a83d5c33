//! As much of Chromium's debugging protocol as the tests need.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A browser without a window.
pub(crate) struct Browser {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    next: u64,
    /// Errors of pages, and what they asked the network for.
    complaints: Vec<String>,
    _profile: tempfile::TempDir,
}

/// A page that is loaded.
pub(crate) struct Page<'b> {
    browser: &'b mut Browser,
    session: String,
}

impl Browser {
    /// Starts Chromium; says so and returns nothing where there is none.
    pub(crate) fn start() -> Option<Self> {
        let named = std::env::var("SPLATREF_CHROMIUM").ok();
        let program = named.clone().unwrap_or_else(|| "chromium".into());
        if Command::new(&program).arg("--version").output().is_err() {
            assert!(named.is_none(), "SPLATREF_CHROMIUM names no program: {program}");
            println!("skipped: there is no Chromium (package chromium, or SPLATREF_CHROMIUM)");
            return None;
        }
        let profile = tempfile::tempdir().unwrap();
        // The browser reads what comes from descriptor 3 and writes to 4.
        let pipes = "exec \"$@\" 3<&0 4>&1 0</dev/null 1>/dev/null 2>&1";
        let flags = "--headless --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
                     --remote-debugging-pipe";
        let mut child = Command::new("sh")
            .args(["-c", pipes, "sh", &program])
            .args(flags.split_whitespace())
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (to, from) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let from = BufReader::new(from);
        Some(Self { child, to, from, next: 0, complaints: Vec::new(), _profile: profile })
    }

    /// Opens a page of a size in px, with all that it says against it.
    pub(crate) fn open(&mut self, path: &Path, [width, height]: [u32; 2]) -> Page<'_> {
        let target = self.ask("", "Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session =
            self.ask("", "Target.attachToTarget", attach)["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            self.ask(&session, &format!("{domain}.enable"), json!({}));
        }
        let screen = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.ask(&session, "Emulation.setDeviceMetricsOverride", screen);
        let address = format!("file://{}", path.display()).replace(' ', "%20");
        self.ask(&session, "Page.navigate", json!({ "url": address }));
        let mut page = Page { browser: self, session };
        page.wait(&format!(
            "location.href.startsWith('{address}') && document.readyState === 'complete'"
        ));
        page
    }

    /// Asks and waits for the answer; what happens meanwhile is noted.
    fn ask(&mut self, session: &str, method: &str, parameters: Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": parameters });
        if !session.is_empty() {
            message["sessionId"] = session.into();
        }
        self.to.write_all(message.to_string().as_bytes()).unwrap();
        self.to.write_all(&[0]).unwrap();
        loop {
            let mut bytes = Vec::new();
            assert!(self.from.read_until(0, &mut bytes).unwrap() > 0, "the browser has gone");
            bytes.pop();
            let answer: Value = serde_json::from_slice(&bytes).unwrap();
            if answer["id"] == self.next {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
            self.note(&answer);
        }
    }

    fn note(&mut self, event: &Value) {
        let parameters = &event["params"];
        match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => self.complaints.push(parameters.to_string()),
            Some("Log.entryAdded") if parameters["entry"]["level"] == "error" => {
                self.complaints.push(parameters.to_string());
            }
            Some("Network.requestWillBeSent") => {
                let url = parameters["request"]["url"].as_str().unwrap_or_default();
                if !url.starts_with("data:")
                    && !url.starts_with("blob:")
                    && !url.starts_with("file:")
                {
                    self.complaints.push(format!("asked for {url}"));
                }
            }
            _ => {}
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Page<'_> {
    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.browser.ask(&self.session, method, parameters)
    }

    fn value(&mut self, script: &str) -> Value {
        let asked = json!({ "expression": script, "awaitPromise": true, "returnByValue": true });
        let answer = self.ask("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{script}: {answer}");
        answer["result"]["value"].clone()
    }

    /// The text that a script comes to.
    pub(crate) fn text(&mut self, script: &str) -> String {
        self.value(script).as_str().unwrap_or_else(|| panic!("no text: {script}")).to_owned()
    }

    /// Waits until a script is true, looking each time that a picture is drawn, at most 1200 times.
    pub(crate) fn wait(&mut self, script: &str) {
        let looks = format!(
            "(async () => {{ for (let i = 0; i < 1200; i++) {{ if ({script}) return true; \
             await new Promise(done => requestAnimationFrame(done)); }} return false; }})()"
        );
        let mut tries = 0;
        // While a page is loaded its scripts may be thrown away.
        while self.value(&looks) != Value::Bool(true) {
            tries += 1;
            let complaints = &self.browser.complaints;
            assert!(tries < 3, "never true: {script}; {complaints:?}");
        }
    }

    /// Clicks the middle of what a selector finds first, which is brought into view.
    pub(crate) fn click(&mut self, selector: &str) {
        let place = self.text(&format!(
            "(() => {{ const e = document.querySelector(\"{selector}\"); e.scrollIntoView({{ block: 'center', inline: 'center' }}); \
             const b = e.getBoundingClientRect(); return (b.left + b.width / 2) + ' ' + (b.top + b.height / 2) }})()"
        ));
        let (x, y) = place.split_once(' ').unwrap();
        let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.ask("Input.dispatchMouseEvent", event);
        }
    }

    /// Presses a key that types a letter.
    pub(crate) fn key(&mut self, letter: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.ask(
                "Input.dispatchKeyEvent",
                json!({ "type": kind, "key": letter, "text": letter }),
            );
        }
    }

    /// Presses a key by its name: `ArrowLeft`.
    pub(crate) fn press(&mut self, name: &str) {
        for kind in ["rawKeyDown", "keyUp"] {
            self.ask("Input.dispatchKeyEvent", json!({ "type": kind, "key": name }));
        }
    }

    /// Shows the page as a person wants it who prefers a scheme and less motion.
    pub(crate) fn prefers(&mut self, scheme: &str, motion: &str) {
        let features = json!([
            { "name": "prefers-color-scheme", "value": scheme },
            { "name": "prefers-reduced-motion", "value": motion },
        ]);
        self.ask("Emulation.setEmulatedMedia", json!({ "features": features }));
    }

    /// Asserts that nothing went wrong and nothing was asked of the network.
    pub(crate) fn finish(self) {
        assert!(self.browser.complaints.is_empty(), "{:?}", self.browser.complaints);
    }
}
