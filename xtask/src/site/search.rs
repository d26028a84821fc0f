//! The index that `web/pages/search.js` searches: the text of the finished pages by their headings, and the items that
//! rustdoc describes, each with its first paragraph.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::{names_below, wrong};

/// Where the index stands in the site.
const INDEX: &str = "pages/search.json";
/// Tags within a word; what stands beside any other is another word.
const INLINE: [&str; 8] = ["a", "b", "code", "em", "span", "strong", "sub", "sup"];

/// A part of a page: what stands below a heading.
#[derive(Debug, Default, PartialEq)]
struct Section {
    anchor: String,
    heading: String,
    text: String,
}

/// Writes the index of the site's pages.
pub(super) fn write(site: &Path) -> Result<(), String> {
    let mut pages = Vec::new();
    for name in names_below(site)? {
        let of_sources = name.starts_with("api/src/");
        if !name.ends_with(".html") || name == "index.html" || of_sources {
            continue;
        }
        let path = site.join(&name);
        let html = fs::read_to_string(&path).map_err(|error| wrong(&path, &error))?;
        pages.extend(page(&name, &html));
    }
    let index = site.join(INDEX);
    fs::write(&index, json!(pages).to_string()).map_err(|error| wrong(&index, &error))
}

/// A page as the index has it: address, title, language, whether it is there in the other one too, sections. Nothing of
/// one without text.
fn page(name: &str, html: &str) -> Option<Value> {
    let title = between(html, "<title>", "</title>")?;
    let title = title.split(" · ").next()?.trim_end_matches(" - Rust");
    let sections = match name.starts_with("api/") {
        // The first paragraph; the rest lists what has a page of its own.
        true => vec![Section {
            text: text(between(html, "class=\"docblock\"><p>", "</p>")?),
            ..Section::default()
        }],
        false => sections(between(html, "<main>", "</main>")?),
    };
    let sections: Vec<Value> = sections
        .into_iter()
        .map(|it| json!([it.anchor, it.heading, it.text]))
        .collect();
    let address = name.strip_suffix("index.html").unwrap_or(name);
    let language = between(html, "<html lang=\"", "\"")?;
    let translated = html.contains(" hreflang=\"");
    Some(json!([
        address,
        text(title),
        language,
        translated,
        sections
    ]))
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    Some(text.split_once(before)?.1.split_once(after)?.0)
}

/// What stands below each heading of the first three levels; before the first one stands nothing.
fn sections(html: &str) -> Vec<Section> {
    let html = html.split("<nav").next().unwrap_or_default();
    let of_heading = |(at, _)| {
        let level = html[at..].chars().nth(2)?;
        ('1'..='3').contains(&level).then_some(at)
    };
    let mut starts: Vec<usize> = html.match_indices("<h").filter_map(of_heading).collect();
    starts.push(html.len());
    let sections = starts.windows(2).map(|ends| {
        let part = &html[ends[0]..ends[1]];
        let (heading, rest) = part.split_once("</h").unwrap_or((part, ""));
        Section {
            anchor: between(heading, " id=\"", "\"").unwrap_or_default().into(),
            heading: text(heading),
            text: text(rest.split_once('>').map_or("", |(_, rest)| rest)),
        }
    });
    sections.collect()
}

/// The text of HTML, its white space as single blanks.
fn text(html: &str) -> String {
    let mut pieces = html.split('<');
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (tag, rest) = piece.split_once('>').unwrap_or((piece, ""));
        let name = tag.trim_start_matches('/').split([' ', '/']).next();
        if !name.is_some_and(|name| INLINE.contains(&name)) {
            text.push(' ');
        }
        text += rest;
    }
    let entities = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\"")];
    let entities = entities.iter().chain(&[("&#39;", "'"), ("&amp;", "&")]);
    let text = entities.fold(text, |text, (entity, sign)| text.replace(entity, sign));
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_indexed_by_its_headings() {
        let html = "<html lang=\"es\"><title>Título · Rumbo</title><a hreflang=\"en\">English</a><main>\
            <h1 id=\"t\">Título</h1><p>Una <code>front_kp</code>, y <em>más</em>.</p><ul><li>a</li><li>b</li></ul>\
            <h2 id=\"dos\">Dos &amp; tres</h2><pre><code>x &lt; 1</code></pre><h4>Dentro</h4><nav class=\"on\">no</nav></main>";
        let expected = json!([
            "docs/es/",
            "Título",
            "es",
            true,
            [
                ["t", "Título", "Una front_kp, y más. a b"],
                ["dos", "Dos & tres", "x < 1 Dentro"]
            ]
        ]);
        assert_eq!(page("docs/es/index.html", html), Some(expected));
    }

    #[test]
    fn an_item_of_the_api_is_indexed_by_what_it_is() {
        let html = "<html lang=\"en\"><title>Cone in rumbo_plant::cone - Rust</title>\
            <div class=\"docblock\"><p>A cone on the <a>floor</a>.</p></div><div class=\"docblock\"><p>Position.</p></div>";
        let title = "Cone in rumbo_plant::cone";
        let text = "A cone on the floor.";
        let expected = json!(["api/x.html", title, "en", false, [["", "", text]]]);
        assert_eq!(page("api/x.html", html), Some(expected));
        assert_eq!(
            page("api/all.html", "<html lang=\"en\"><title>x</title>"),
            None
        );
    }
}
