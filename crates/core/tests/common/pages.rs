//! Parts of the documents that tests write.

use std::fs;

use super::files::rooted;

/// Holds the part of a page between two marks against what it should be, or writes it anew where that is asked for.
pub fn check_part(page: &str, mark: &str, fresh: &str, package: &str) {
    let text = fs::read_to_string(rooted(page)).unwrap();
    let (open, close) = (format!("<!-- {mark} -->\n"), format!("<!-- end of {mark} -->"));
    let (before, rest) = text.split_once(&open).unwrap_or_else(|| panic!("{page} has no {mark}"));
    let (stored, after) = rest.split_once(&close).unwrap_or_else(|| panic!("{page} has no end of {mark}"));
    if std::env::var_os("PATCHCORD_BLESS").is_some() {
        fs::write(rooted(page), format!("{before}{open}{fresh}{close}{after}")).unwrap();
    } else {
        assert!(
            stored == fresh,
            "{page} is stale: PATCHCORD_BLESS=1 cargo test -p {package} rewrites {mark}; read the text about it too\n{fresh}"
        );
    }
}

/// Holds sentences against a page's text.
pub fn check_told(page: &str, sentences: &[String]) {
    let text = fs::read_to_string(rooted(page)).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
    let missing: Vec<_> = sentences.iter().filter(|sentence| !text.contains(*sentence)).collect();
    assert!(missing.is_empty(), "{page} does not say: {missing:#?}");
}
