//! `splatref conformance`: a command that is run on the suite of a method.

use super::*;
use serde_json::Value;
use tempfile::TempDir;

/// splatref as the command, with more options.
fn itself(more: &str) -> String {
    format!("splatref render {{scene}}/scene.toml -o {{out}} {more}")
}

/// Exit code and what was printed.
fn conformance(at: &TempDir, arguments: &[&str]) -> (i32, String) {
    let output = splatref(at.path(), &[&["conformance"], arguments].concat());
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

#[test]
fn splatref_is_right_by_every_method() {
    let at = TempDir::new().unwrap();
    let of_surfels = |method: &splatref::method::Method| !method.draws_gaussians();
    for method in splatref::method::Method::all().into_iter().filter(of_surfels) {
        let command = itself("--stages");
        let only = "middle,ball,nothing,unlit";
        let arguments = [method.name(), "--command", &command, "--only", only];
        let (code, said) = conformance(&at, &arguments);
        assert_eq!(code, 0, "{said}");
        let ending = format!("{}: 4 right", method.name());
        // With all planes, none is missing.
        assert_eq!(said.lines().collect::<Vec<_>>()[4..], [ending], "{said}");
    }
    let scene = at.path().join("out/conformance/transparent/ball");
    let files = names(&scene);
    let wanted = [
        "README.md",
        "client.exr",
        "client.log",
        "client.png",
        "colors.npy",
        "members.npy",
        "normals.npy",
        "positions.npy",
        "radii.npy",
        "records.bin",
        "reference.exr",
        "reference.png",
        "scene.json",
        "scene.toml",
        "surfels.ply",
    ];
    assert_eq!(files, wanted);
    let page = fs::read_to_string(scene.join("README.md")).unwrap();
    for line in ["# transparent: ball", "| cutoff | 2 |", "| 8 | conic | f32 x 3 |", "`R G B`"] {
        assert!(page.contains(line), "{line}: {page}");
    }
    let json: Value =
        serde_json::from_str(&fs::read_to_string(scene.join("scene.json")).unwrap()).unwrap();
    assert_eq!(json["camera"]["view_from_world"]["opencv"][2][3], 8.0);
    assert_eq!(json["settings"]["epsilon"], "2r");
}

/// Both files of a scene of Gaussians hold the scene; the GLB bit for bit.
#[test]
fn scenes_of_gaussians_are_files_of_other_programs() {
    let at = TempDir::new().unwrap();
    let command = itself("--stages");
    let only = "middle,rotation-x";
    let (code, said) = conformance(&at, &["gaussians", "--command", &command, "--only", only]);
    assert_eq!(code, 0, "{said}");
    assert!(said.ends_with("gaussians: 2 right\n"), "{said}");
    let scene = at.path().join("out/conformance/gaussians/rotation-x");
    let wanted = [
        "README.md",
        "client.exr",
        "client.log",
        "client.png",
        "harmonics.npy",
        "opacities.npy",
        "positions.npy",
        "records.bin",
        "reference.exr",
        "reference.png",
        "rotations.npy",
        "scales.npy",
        "scene.json",
        "scene.toml",
        "splats.glb",
        "splats.ply",
    ];
    assert_eq!(names(&scene), wanted);
    let said = succeeds(&scene, &["convert", "splats.ply", "again.glb"]);
    assert!(said.contains("gaussians  1, spherical harmonics"), "{said}");
    let page = fs::read_to_string(scene.join("README.md")).unwrap();
    assert!(page.contains("| splats.glb |") && !page.contains("surfels.ply"), "{page}");
}

/// The page of a suite shows every scene, and its commands run, with splatref as the renderer.
#[test]
fn the_page_of_a_suite_can_be_followed() {
    for (options, names) in [
        ("gaussians --preset khr --only middle,tie", ["middle", "tie"]),
        ("ewa --only rim,tie", ["rim", "tie"]),
    ] {
        let at = TempDir::new().unwrap();
        let words: Vec<&str> = options.split(' ').collect();
        succeeds(at.path(), &[&["conformance"], &words[..], &["-o", "suite"]].concat());
        let folder = at.path().join("suite").join(words[0]);
        let page = fs::read_to_string(folder.join("README.md")).unwrap();
        assert!(page.starts_with(&format!("# Test a renderer of `{}`\n", words[0])), "{page}");
        for name in names {
            for link in [format!("({name}/reference.png)"), format!("({name}/README.md)")] {
                assert!(page.contains(&link), "{link}: {page}");
                assert!(folder.join(link.trim_matches(['(', ')'])).exists(), "{link}");
            }
            // A file that the page names is there, and all of them are named.
            for file in self::names(&folder.join(name)) {
                assert!(page.contains(&file), "{file}: {page}");
            }
            let picture = "render scene.toml --stages -o again.exr";
            succeeds(&folder.join(name), &picture.split(' ').collect::<Vec<_>>());
            succeeds(&folder.join(name), &["compare", "again.exr", "reference.exr"]);
        }
        // The renderer of the page is splatref itself.
        let mine = format!("./mine {0} {0}/client.exr", names[0]);
        assert!(page.contains(&mine), "{page}");
        let page = page.replace(
            &mine,
            &format!("splatref render {0}/scene.toml --stages -o {0}/client.exr", names[0]),
        );
        let page =
            page.replace("'./mine {scene} {out}'", &format!("'{}'", itself("--stages").trim()));
        assert!(!page.contains("'./mine"), "{page}");
        assert_eq!(guide::follow_page(&folder, &page), 3, "{page}");
        assert!(folder.join("report.html").exists());
        let again = folder.join("out/conformance").join(words[0]);
        let scenes = names.iter().map(|name| (*name).to_owned());
        let wanted: Vec<String> = ["README.md".into()].into_iter().chain(scenes).collect();
        assert_eq!(self::names(&again), wanted);
    }
}

/// A page that cannot be written ends the command; the renderer is not to blame.
#[test]
fn a_page_that_cannot_be_written_is_no_failure_of_the_renderer() {
    let at = TempDir::new().unwrap();
    fs::create_dir_all(at.path().join("out/conformance/ewa/rim/verdict.html/taken")).unwrap();
    let command = itself("--stages --low-pass 0.6");
    let words = ["conformance", "ewa", "--only", "rim", "--command", &command];
    let line = fails(at.path(), &[&words[..], &["--report", "page.html"]].concat(), 2);
    assert!(line.contains("verdict.html"), "{line}");
    assert!(!at.path().join("page.html").exists());
}

#[test]
fn a_wrong_command_is_found_by_the_rules_that_it_breaks() {
    let at = TempDir::new().unwrap();
    let command = itself("--stages --low-pass 0.6");
    let (code, said) = conformance(
        &at,
        &[
            "ewa",
            "--command",
            &command,
            "--only",
            "rim,low-pass,nothing",
            "--json",
            "r.json",
            "--junit",
            "r.xml",
        ],
    );
    assert_eq!(code, 1, "{said}");
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[1].starts_with("low-pass  wrong        visibility in "), "{said}");
    assert!(lines[0].contains("; looks like the low-pass filter has another variance"), "{said}");
    assert_eq!(lines[2], "nothing   right");
    let mistake = "the low-pass filter has another variance: 0.6 px^2, not 0.25";
    let common = format!("looks like {mistake}: explains 2 of 2 wrong rules");
    assert_eq!(lines[3], common);
    assert!(lines[4].starts_with("ewa: 1 right, 2 wrong"), "{said}");
    let look = "look closer: splatref verify out/conformance/ewa/rim/scene.toml \
                out/conformance/ewa/rim/client.exr";
    assert_eq!(lines[5], look);
    // The command that it names says the same.
    let words: Vec<&str> = look.split(' ').skip(3).collect();
    assert_eq!(splatref(at.path(), &words).status.code(), Some(1));

    let json: Value =
        serde_json::from_str(&fs::read_to_string(at.path().join("r.json")).unwrap()).unwrap();
    assert_eq!((&json["right"], &json["counts"]["wrong"]), (&false.into(), &2.into()));
    assert_eq!(json["rules"][1]["verdict"]["first_wrong"], "visibility");
    assert_eq!(json["looks_like"]["mistake"], mistake);
    assert_eq!(
        (&json["looks_like"]["explains"], &json["looks_like"]["wrong"]),
        (&2.into(), &2.into())
    );
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/conformance.schema.json");
    let schema: Value = serde_json::from_str(&fs::read_to_string(schema).unwrap()).unwrap();
    fits(&json, &schema, "");
    let xml = fs::read_to_string(at.path().join("r.xml")).unwrap();
    assert!(xml.contains("tests=\"4\" failures=\"2\" errors=\"0\""), "{xml}");
    assert!(xml.contains(&format!("<property name=\"looks like\" value=\"{common}\"/>")), "{xml}");
    assert_eq!(xml.matches("<testcase ").count(), 4, "{xml}");
    assert_eq!(xml.matches("<failure type=\"wrong\" message=\"visibility in ").count(), 2, "{xml}");
}

/// Asserts what a schema says, in the words that docs/conformance.schema.json uses.
fn fits(json: &Value, schema: &Value, place: &str) {
    let kind = match json {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let is = |name: &Value| name == kind || (name == "number" && kind == "integer");
    let kinds = &schema["type"];
    let found = kinds.as_array().map_or_else(|| is(kinds), |all| all.iter().any(is));
    assert!(found, "{place} is {kind}, not {kinds}");
    for (i, item) in json.as_array().into_iter().flatten().enumerate() {
        fits(item, &schema["items"], &format!("{place}/{i}"));
    }
    let Some(fields) = json.as_object() else { return };
    for name in schema["required"].as_array().into_iter().flatten() {
        assert!(fields.contains_key(name.as_str().unwrap()), "{place} lacks {name}");
    }
    let further = &schema["additionalProperties"];
    for (name, field) in fields {
        match &schema["properties"][name] {
            Value::Null if further.is_object() => fits(field, further, &format!("{place}/{name}")),
            Value::Null => assert_ne!(further, false, "{place} has {name}"),
            own => fits(field, own, &format!("{place}/{name}")),
        }
    }
}

#[test]
fn a_command_that_fails_is_a_row_and_does_not_stop_the_others() {
    let at = TempDir::new().unwrap();
    let run =
        |command: &str| conformance(&at, &["blue", "--only", "rim,tie", "--command", command]);
    let rows = |said: &str, what: &str| {
        assert_eq!(said.matches(what).count(), 2, "{what}: {said}");
        assert!(said.contains("blue: 0 right, 2 failed"), "{said}");
    };
    let (code, said) = run("splatref render {scene}/nothing.toml");
    assert_eq!(code, 1);
    rows(&said, "failed       exit code 1; it said: splatref: ");
    let (_, said) = run("splatref info {scene}/scene.toml");
    rows(&said, "failed       wrote no client.exr and no client.toml; it said: ");
    let (_, said) = run("./nowhere {scene}");
    rows(&said, "failed       ./nowhere: ");
    let (_, said) = run(&itself("--size 20x20"));
    rows(&said, "failed       the planes have 20 x 20 pixels");
    // What an earlier run left is not judged.
    assert_eq!(run(&itself("")).0, 0);
    let (_, said) = run("splatref info {scene}/scene.toml");
    rows(&said, "wrote no client.exr");
}

#[cfg(unix)]
#[test]
fn a_command_that_hangs_is_ended() {
    let at = TempDir::new().unwrap();
    let shell = "sh -c 'exec sleep 60' {scene}";
    let (code, said) =
        conformance(&at, &["blue", "--only", "rim", "--timeout", "1", "--command", shell]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("rim  failed       ran longer than 1 s, and was ended"), "{said}");
}

/// A client that leaves only its colours gets a verdict, and is told what would tell more.
#[cfg(unix)]
#[test]
fn a_description_stands_for_the_picture() {
    let at = TempDir::new().unwrap();
    let scene = at.path().join("out/conformance/ewa/rim");
    succeeds(at.path(), &["conformance", "ewa", "--only", "rim"]);
    succeeds(at.path(), &["render", scene.join("scene.toml").to_str().unwrap(), "-o", "mine.exr"]);
    fs::write(at.path().join("mine.toml"), "[planes.RGB]\nfile = \"mine.exr\"\n").unwrap();
    // A shell copies both files into the folder.
    let command = "sh -c 'cp mine.exr $0 && cp mine.toml $0/client.toml' {scene}";
    let (code, said) = conformance(&at, &["ewa", "--only", "rim", "--command", command]);
    assert_eq!(code, 0, "{said}");
    let more = "1 of the verdicts would tell more with visibility.Z, visibility.id of the stage \
                visibility";
    assert!(said.contains(more), "{said}");
}

#[test]
fn rules_are_listed_and_wrong_usage_is_refused() {
    let at = TempDir::new().unwrap();
    let list = succeeds(at.path(), &["conformance", "pyramid", "--list"]);
    assert!(list.lines().count() > 25, "{list}");
    assert!(list.lines().any(|line| line.starts_with("weights-box ")), "{list}");
    let refused = |arguments: &[&str]| fails(at.path(), &[&["conformance"], arguments].concat(), 2);
    assert!(refused(&["pyramid", "--only", "rmi"]).contains("pyramid --list"));
    assert!(refused(&["wea", "--list"]).contains("give one of"));
    assert!(refused(&["ewa", "--command", "mine"]).contains("{scene}"));
    assert!(refused(&["ewa", "--command", "mine '{scene}"]).contains("not closed"));
    let files = ["ewa", "--command", "mine {scene}", "--json", "a", "--junit", "./a"];
    assert!(refused(&files).contains("the same file"));
    assert_eq!(names(at.path()), [""; 0]);
    let said = succeeds(at.path(), &["conformance", "ewa", "--only", "rim,tie", "-o", "suite"]);
    assert!(said.starts_with("wrote 2 scenes into suite"), "{said}");
}
