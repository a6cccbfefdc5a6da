//! Generated parts of the documents.

use std::fs;

use super::files::repository_path;

/// Asserts that the part of a page between `<!-- mark -->` and `<!-- end of mark -->` is `fresh`, or writes it if
/// PATCHCORD_BLESS is set. The message names `package`, the crate whose tests write the part.
pub(crate) fn assert_part_up_to_date(page: &str, mark: &str, fresh: &str, package: &str) {
    let text = fs::read_to_string(repository_path(page)).unwrap();
    let (open, close) = (format!("<!-- {mark} -->\n"), format!("<!-- end of {mark} -->"));
    let (before, rest) = text.split_once(&open).unwrap_or_else(|| panic!("{page} has no {mark}"));
    let (stored, after) = rest.split_once(&close).unwrap_or_else(|| panic!("{page} has no end of {mark}"));
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        fs::write(repository_path(page), format!("{before}{open}{fresh}{close}{after}")).unwrap();
    } else {
        assert!(
            stored == fresh,
            "{page} is stale: PATCHCORD_BLESS=1 cargo test -p {package} rewrites {mark}; check the text around it too\n{fresh}"
        );
    }
}

/// Asserts that a page contains the sentences. Line breaks do not matter.
pub(crate) fn assert_page_contains(page: &str, sentences: &[String]) {
    let text =
        fs::read_to_string(repository_path(page)).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
    let missing: Vec<_> = sentences.iter().filter(|sentence| !text.contains(*sentence)).collect();
    assert!(missing.is_empty(), "{page} does not say: {missing:#?}");
}
