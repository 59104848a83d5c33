//! Marked blocks of the pages under `docs/`: a bench writes the block, people write around it.

/// A page in which the text of one block is another.
///
/// A block is what lies between a line `<!-- bench: NAME -->` and the next line `<!-- end -->`; the
/// two lines stay, and an empty line stands after the first and before the second.
///
/// # Errors
/// What is wrong with the page: no such block, two of them, or one without an end.
pub(crate) fn replaced(page: &str, name: &str, text: &str) -> Result<String, String> {
    let opening = format!("<!-- bench: {name} -->\n");
    let mut parts = page.split(&opening);
    let (Some(before), Some(rest), None) = (parts.next(), parts.next(), parts.next()) else {
        return Err(format!("a page must have the line {} once", opening.trim_end()));
    };
    let end = match (rest.find("<!-- end -->\n"), rest.find("<!-- bench: ")) {
        (Some(end), next) if next.is_none_or(|next| end < next) => end,
        _ => return Err(format!("the block {name} has no line <!-- end -->")),
    };
    Ok(format!("{before}{opening}\n{}\n\n{}", text.trim(), &rest[end..]))
}
