use super::*;

/// The names in a directory.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<_> =
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_file_is_replaced_and_nothing_else_stays() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ply");
    fs::write(&path, "old").unwrap();
    write_atomically(&path, |out| {
        assert_eq!(fs::read_to_string(&path).unwrap(), "old", "untouched while writing");
        out.write_all(b"new")
    })
    .unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(names(directory.path()), ["a.ply"]);
}

#[test]
fn a_failure_leaves_the_old_file_and_no_partial_one() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ply");
    fs::write(&path, "old").unwrap();
    let error = write_atomically(&path, |out| {
        out.write_all(b"half")?;
        Err(io::Error::other("disk on fire"))
    })
    .unwrap_err();
    assert_eq!(error.to_string(), format!("{}: disk on fire", path.display()));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(directory.path()), ["a.ply"]);
}

#[test]
fn places_that_no_file_can_take_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let refused = |path: &Path| write_atomically(path, |_| Ok(())).unwrap_err().to_string();
    assert!(refused(directory.path()).contains("not a regular file"));
    assert!(refused(&directory.path().join("..")).contains("not a file name"));
    let missing = directory.path().join("missing/a.ply");
    assert!(refused(&missing).starts_with(&missing.display().to_string()));
    assert!(names(directory.path()).is_empty());
    let fixed = directory.path().join("fixed.ply");
    fs::write(&fixed, "old").unwrap();
    let mut permissions = fs::metadata(&fixed).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&fixed, permissions).unwrap();
    assert!(refused(&fixed).contains("read-only"));
    assert_eq!(fs::read_to_string(&fixed).unwrap(), "old");
}

/// Writers of one file overlap, as two processes with one number or two threads can. Each is half
/// done when the next begins, and the file that is put last is there as a whole.
#[test]
fn writers_of_one_file_do_not_meet() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ply");
    let mut inner = None;
    let outer = Pending::write(&path, |out| {
        out.write_all(&[b'a'; 100_000])?;
        let other = Pending::write(&path, |out| out.write_all(&[b'b'; 300_000]));
        inner = Some(other.map_err(io::Error::other)?);
        out.write_all(&[b'a'; 100_000])
    });
    inner.unwrap().put().unwrap();
    assert_eq!(fs::read(&path).unwrap(), [b'b'; 300_000]);
    outer.unwrap().put().unwrap();
    assert_eq!(fs::read(&path).unwrap(), [b'a'; 200_000]);
    assert_eq!(names(directory.path()), ["a.ply"]);
}

/// A file without a lock stands for the file of a killed process.
#[test]
fn abandoned_partial_files_are_removed_and_no_others() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let others = [".splatref-short.partial", ".splatref-abcdefGHIJ12.part", "a.partial"];
    for name in others.iter().chain(&[".splatref-abcdefGHIJ12.partial"]) {
        fs::write(at(name), "half").unwrap();
    }
    fs::create_dir(at(".splatref-abcdefGHIJ34.partial")).unwrap();
    let alive = File::create(at(".splatref-stillWRITING.partial")).unwrap();
    alive.lock().unwrap();
    let waiting = Pending::write(&at("b"), |out| out.write_all(b"whole")).unwrap();
    assert!(!at(".splatref-abcdefGHIJ12.partial").exists());
    remove_abandoned(directory.path());
    assert!(at(".splatref-stillWRITING.partial").exists(), "its writer holds the lock");
    assert!(others.iter().all(|name| at(name).exists()));
    drop(alive);
    remove_abandoned(directory.path());
    assert!(!at(".splatref-stillWRITING.partial").exists());
    waiting.put().unwrap();
    assert_eq!(fs::read(at("b")).unwrap(), b"whole");
    assert_eq!(names(directory.path()).len(), others.len() + 2);
}

#[test]
fn a_name_may_be_as_long_as_the_file_system_has_them() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a".repeat(255));
    write_atomically(&path, |out| out.write_all(b"long")).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "long");
}

#[cfg(unix)]
#[test]
fn permissions_stay_and_new_files_have_those_of_new_files() {
    use std::os::unix::fs::PermissionsExt;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.ply");
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    write_atomically(&path, |_| Ok(())).unwrap();
    let plain = directory.path().join("plain");
    fs::write(&plain, "").unwrap();
    assert_eq!(mode(&path), mode(&plain));
    fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
    write_atomically(&path, |_| Ok(())).unwrap();
    assert_eq!(mode(&path), 0o640);
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_stays_and_its_file_is_replaced() {
    use std::os::unix::fs::symlink;
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("far")).unwrap();
    fs::write(at("far/a.ply"), "old").unwrap();
    symlink("far/a.ply", at("link")).unwrap();
    symlink("link", at("second")).unwrap();
    symlink("far/new.ply", at("dangling")).unwrap();
    symlink("circle", at("circle")).unwrap();
    for (link, file) in [("second", "far/a.ply"), ("dangling", "far/new.ply")] {
        write_atomically(&at(link), |out| out.write_all(link.as_bytes())).unwrap();
        assert_eq!(fs::read_to_string(at(file)).unwrap(), link);
        assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink());
    }
    let error = write_atomically(&at("circle"), |_| Ok(())).unwrap_err().to_string();
    assert!(error.contains("circle of symbolic links"), "{error}");
    assert_eq!(names(&at("far")), ["a.ply", "new.ply"]);
}
