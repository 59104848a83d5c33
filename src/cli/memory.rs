//! The memory limit of a command.

use splatref::memory::set_limit;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Sets the limit: `asked`, or three quarters of the memory of the machine or of the container that
/// the program runs in.
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
    match (system.total_memory(), container) {
        (machine, Some(container)) if container > 0 && container < machine => container,
        (machine, _) => machine,
    }
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
    fn the_machine_has_memory() {
        assert!(total() > 1 << 26, "{}", total());
    }
}
