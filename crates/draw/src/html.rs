//! The common parts of generated HTML pages: the frame and the style sheet.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The style sheet of every page.
const STYLE: &str = include_str!("html.css");

/// Returns a complete page with a title and a body.
///
/// Texts in the title and in the body are escaped, so they cannot become tags.
///
/// # Examples
///
/// ```
/// use maud::html;
/// use patchcord_draw::html::page;
///
/// let page = page("a < b", html! { p { "Results" } });
/// assert!(page.contains("<title>a &lt; b</title>"));
/// assert!(page.contains("<p>Results</p>"));
/// ```
pub fn page(title: &str, body: Markup) -> String {
    let page = html! {
        (DOCTYPE) "\n"
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { "\n" (PreEscaped(STYLE)) }
            }
            "\n"
            body { (body) }
        }
        "\n"
    };
    page.into_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_become_tags() {
        let page = page("a < b", html! { p { ("a < b & \"c\" > d") } });
        assert!(page.contains("<title>a &lt; b</title>"));
        assert!(page.contains("<p>a &lt; b &amp; &quot;c&quot; &gt; d</p>"));
    }
}
