//! The memory limit of a command.

use splatref::memory::set_limit;
use std::fs;
use std::path::Path;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Sets the limit: `asked`, or three quarters of what the process may have: the memory of the
/// machine or of the container, or the limit of the process (`ulimit -v`, `ulimit -d`) or of its
/// control groups, whichever is least.
pub(super) fn limit(asked: Option<u64>) {
    set_limit(asked.unwrap_or_else(|| match total() {
        0 => u64::MAX, // a system that does not tell
        total => total / 4 * 3,
    }));
}

fn total() -> u64 {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let specifics = RefreshKind::nothing().with_memory(memory);
    let Ok(system) = System::new_with_specifics(specifics) else { return 0 };
    let container = system.cgroup_limits().map(|limits| limits.total_memory);
    let groups = groups(&fs::read_to_string("/proc/self/cgroup").unwrap_or_default());
    let machine = Some(system.total_memory()).filter(|&bytes| bytes > 0);
    let limits = [machine, container.filter(|&bytes| bytes > 0), process(), groups];
    limits.into_iter().flatten().min().unwrap_or(0)
}

/// The least limit that the system sets to the addresses or the data of this process.
#[cfg(unix)]
fn process() -> Option<u64> {
    use rustix::process::{Resource, getrlimit};
    let limits = [Resource::As, Resource::Data].map(|of| getrlimit(of).current);
    limits.into_iter().flatten().min()
}

#[cfg(not(unix))]
fn process() -> Option<u64> {
    None
}

/// The least limit of the control groups of this process, from its groups as /proc/self/cgroup
/// lists them. A group cannot have more than the groups around it.
fn groups(list: &str) -> Option<u64> {
    let limit = |folder: &Path, file: &str| -> Option<u64> {
        fs::read_to_string(folder.join(file)).ok()?.trim().parse().ok()
    };
    let of = |line: &str| {
        let mut fields = line.splitn(3, ':').skip(1);
        let (controllers, path) = (fields.next()?, fields.next()?.trim_start_matches('/'));
        let (root, file) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|name| name == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => return None,
        };
        let folders = Path::new(path).ancestors();
        folders.filter_map(|folder| limit(&Path::new(root).join(folder), file)).min()
    };
    list.lines().filter_map(of).min()
}

/// Parses `2G` or `500M`, binary multiples of bytes.
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    let units = [('K', 10), ('M', 20), ('G', 30), ('T', 40)];
    let unit = text.chars().next_back().map(|c| c.to_ascii_uppercase());
    let shift = units.into_iter().find(|(name, _)| Some(*name) == unit).map(|(_, shift)| shift);
    let digits = if shift.is_some() { &text[..text.len() - 1] } else { text };
    let number: f64 = digits
        .parse()
        .ok()
        .filter(|n: &f64| *n > 0.0 && n.is_finite())
        .ok_or("give a number of bytes, with K, M, G or T for their multiples, such as 2G")?;
    Ok((number * (1_u64 << shift.unwrap_or(0)) as f64) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_units() {
        let read = |text| bytes(text).ok();
        assert_eq!(read("2G"), Some(2 << 30));
        assert_eq!(read("1.5k"), Some(1536));
        assert_eq!(read("300"), Some(300));
        assert_eq!(read("0.5T"), Some(1 << 39));
        for wrong in ["", "G", "-1G", "2X", "nan", "infG", "0", "1 G"] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn groups_that_are_not_there_limit_nothing() {
        for list in ["", "0::/no/such/group\n", "7:cpu,cpuset:/\n", "nonsense\n::\n"] {
            assert!(groups(list).is_none_or(|bytes| bytes > 1 << 20), "{list}");
        }
    }

    #[test]
    fn the_machine_has_memory() {
        assert!(total() > 1 << 26, "{}", total());
    }
}
