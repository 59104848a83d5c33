//! How much memory the process may have.

use std::fs;
use std::path::Path;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// How many bytes the process may have: the memory of the machine or of the container, or the limit
/// of the process (`ulimit -v`, `ulimit -d`) or of its control groups, whichever is least. 0 if the
/// system does not tell.
pub(super) fn total() -> u64 {
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

#[cfg(test)]
mod tests {
    use super::*;

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
