//! The panel as one file, which a browser opens without a web server, and a patch in it.
//!
//! `crates/web/one_file.py` makes the file: a page with all files of the panel in its document. One of them is the
//! document of the host, `host.json`. There `patchcord panel --export` puts the patch with which the panel begins.

use serde_json::json;

/// The name of the file in the folder that `crates/web/build-site` makes.
pub const ONE_FILE: &str = "patchcord.html";

/// The document of a host that is a Worker of the page and opens no patch.
pub const WORKER_HOST: &str = r#"{"host": "worker"}"#;

/// The page with a patch. `name` is that of its file. `None` if the page has no place for a patch: it has one already, or
/// another version made it.
///
/// # Examples
///
/// ```
/// use patchcord_panel::one_file::with_patch;
///
/// let page = r#"<body><script type="text/plain" data-path="host.json">{"host": "worker"}</script></body>"#;
/// let exported = with_patch(page, "spring.json", r#"{"patchcord": 1}"#);
/// assert!(exported.is_some_and(|page| page.contains(r#""patch":"spring.json""#)));
/// assert_eq!(with_patch("<body></body>", "spring.json", r#"{"patchcord": 1}"#), None);
/// ```
pub fn with_patch(page: &str, name: &str, text: &str) -> Option<String> {
    let (before, after) = page.split_once(&host_element(WORKER_HOST))?;
    let host = json!({ "host": "worker", "patch": name, "text": text }).to_string();
    // JSON has this character in strings only. Without it, no text can end the element.
    Some(format!("{before}{}{after}", host_element(&host.replace('<', "\\u003c"))))
}

/// The element of the page with the document of the host.
fn host_element(document: &str) -> String {
    format!(r#"<script type="text/plain" data-path="host.json">{document}</script>"#)
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;

    /// A page as `crates/web/one_file.py` makes it, without the other files.
    fn page() -> String {
        format!("<!doctype html>\n<body>{}\n<script>start()</script>\n</body>\n", host_element(WORKER_HOST))
    }

    /// The document of the host in a page.
    fn host(page: &str) -> Value {
        let (_, rest) = page.split_once(r#"data-path="host.json">"#).unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn a_page_without_a_patch_names_only_its_host() {
        assert_eq!(host(&page()), json!({ "host": "worker" }));
    }

    #[test]
    fn every_text_is_in_the_page_as_it_is() {
        let texts = [
            r#"{"patchcord": 1, "title": "</script><script>alert(1)</script>"}"#,
            r#"{"title": "<!-- <script> --> ]]> & &lt; \u003c \\ \" ' $& {}"}"#,
            "not JSON: </SCRIPT\n>\r\n\u{feff}\0\u{2028}ä</script x",
            "",
        ];
        for text in texts {
            for name in ["a.json", "</script><script>alert(1)</script>.json"] {
                let exported = with_patch(&page(), name, text).unwrap();
                assert_eq!(host(&exported), json!({ "host": "worker", "patch": name, "text": text }));
                assert_eq!(exported.matches('<').count(), page().matches('<').count(), "{exported}");
                assert!(!exported.contains('\0') && !exported.contains('\r'), "{exported:?}");
                assert!(exported.ends_with("</script>\n<script>start()</script>\n</body>\n"));
            }
        }
    }

    #[test]
    fn a_page_has_one_patch_at_most() {
        let exported = with_patch(&page(), "a.json", "{}").unwrap();
        assert_eq!(with_patch(&exported, "b.json", "{}"), None);
        assert_eq!(with_patch("", "b.json", "{}"), None);
    }
}
