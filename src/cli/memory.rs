//! The memory limit of a command.

use splatref::memory::{set_limit, usual_limit};

/// Sets the limit: `asked`, or three quarters of what the process may have.
pub(super) fn limit(asked: Option<u64>) {
    set_limit(asked.unwrap_or_else(usual_limit));
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
}
