//! The pages beside the lab: every Markdown file of `docs/`, of `examples/` and of the root as HTML, at the path that it
//! has in the project, so that its links and pictures lead where they lead there.
//!
//! A link to `web/index.html#scenario=...` is a run: it opens the lab set to that experiment, beside the text where
//! there is room (`web/pages/page.js`). A link to one of [`API`] leads to its documentation. A link to any other file
//! leads to the repository, where a workflow of GitHub builds the site, and is plain text elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd, html};

use super::{copy, wrong};
use crate::markdown::anchor;
use crate::project::Project;
use crate::tidy::{self, Tree};

/// Crates that others can use alone.
pub(super) const API: [&str; 4] = ["control", "wire", "plant", "emulator"];

const TEMPLATE: &str = include_str!("page.html");
/// The page of the lab, among the files of the project.
const LAB: &str = "web/index.html";
/// Everything comes from the site itself.
const POLICY: &str = "default-src 'self'; base-uri 'none'; form-action 'none'; object-src 'none'";

/// The places in the header of each page, in English and Spanish: Markdown file, anchor, name.
const PLACES: [[(&str, &str, &str); 2]; 4] = [
    [
        ("docs/lessons/en/README.md", "", "Lessons"),
        ("docs/lessons/es/README.md", "", "Lecciones"),
    ],
    [
        ("README.md", "#where-to-read-on", "Guides"),
        ("README.es.md", "#para-seguir-leyendo", "Guías"),
    ],
    [
        ("docs/theory/README.md", "", "Theory"),
        ("docs/theory/README.md", "", "Teoría"),
    ],
    [("docs/api.md", "", "API"), ("docs/api.md", "", "API")],
];

/// Writes the pages, their pictures and style into the site.
///
/// # Errors
/// A link that leads nowhere, with its file and line.
pub(super) fn write(project: &Project, site: &Path) -> Result<(), String> {
    let tree = Tree::read(project)?;
    let broken = tidy::broken_links(&tree);
    if !broken.is_empty() {
        let lines: Vec<String> = broken.iter().map(ToString::to_string).collect();
        return Err(lines.join("\n"));
    }
    let is_page = |path: &str| {
        let below = ["docs/", "examples/"];
        let within = below.iter().any(|folder| path.starts_with(folder)) || !path.contains('/');
        within && path.ends_with(".md")
    };
    let sources: BTreeMap<&str, &str> = tree.texts(is_page).collect();
    let source_address = source_address();
    let mut pictures = BTreeSet::new();
    for (path, text) in &sources {
        let mut page = Page {
            path,
            sources: &sources,
            source_address: source_address.as_deref(),
            pictures: &mut pictures,
            runs: false,
        };
        let content = page.content(text);
        let whole = page.whole(&content);
        let file = site.join(file_of(path));
        if let Some(folder) = file.parent() {
            fs::create_dir_all(folder).map_err(|error| wrong(folder, &error))?;
        }
        fs::write(&file, whole).map_err(|error| wrong(&file, &error))?;
    }
    for picture in pictures {
        copy(&project.root.join(&picture), &site.join(&picture))?;
    }
    Ok(())
}

/// Where the sources can be read, as a workflow of GitHub knows it.
fn source_address() -> Option<String> {
    let of = |name: &str| std::env::var(name).ok();
    let [server, repository, commit] =
        ["GITHUB_SERVER_URL", "GITHUB_REPOSITORY", "GITHUB_SHA"].map(of);
    Some(format!("{}/{}/blob/{}/", server?, repository?, commit?))
}

/// The file of the site that a Markdown file becomes.
fn file_of(path: &str) -> String {
    let stem = path.strip_suffix(".md").unwrap_or(path);
    match stem.strip_suffix("/README") {
        Some(folder) => format!("{folder}/index.html"),
        // At the root that is the lab.
        None => format!("{stem}.html"),
    }
}

/// The same as an address seen from the root: a folder stands for its first page.
fn address_of(path: &str) -> String {
    let file = file_of(path);
    file.strip_suffix("index.html")
        .map_or(file.clone(), str::to_owned)
}

/// The same page in the other language.
fn counterpart(path: &str) -> Option<String> {
    match path {
        "README.md" => return Some("README.es.md".to_owned()),
        "README.es.md" => return Some("README.md".to_owned()),
        _ => {}
    }
    let [english, spanish] = ["/en/", "/es/"];
    match path.contains(english) {
        true => Some(path.replace(english, spanish)),
        false => path
            .contains(spanish)
            .then(|| path.replace(spanish, english)),
    }
}

fn is_spanish(path: &str) -> bool {
    path.contains("/es/") || path.ends_with(".es.md")
}

struct Page<'a> {
    path: &'a str,
    sources: &'a BTreeMap<&'a str, &'a str>,
    source_address: Option<&'a str>,
    pictures: &'a mut BTreeSet<String>,
    /// It has links that open the lab set to an experiment.
    runs: bool,
}

/// What a link is on the page.
enum Link {
    To(String),
    /// Opens the lab.
    Run(String),
    /// To a file that is not on the site.
    Nowhere,
}

impl Page<'_> {
    /// From the page to the root of the site.
    fn root(&self) -> String {
        match self.path.matches('/').count() {
            0 => "./".to_owned(),
            depth => "../".repeat(depth),
        }
    }

    /// The text as HTML.
    fn content(&mut self, text: &str) -> String {
        let mut events: Vec<Event<'_>> = Parser::new_ext(text, Options::ENABLE_TABLES).collect();
        name_headings(&mut events);
        self.name_pages(&mut events);
        let mut closing = Vec::new();
        let events = events.into_iter().filter_map(|event| match event {
            Event::Start(Tag::Link {
                dest_url, title, ..
            }) => {
                let (opening, end) = self.link(&dest_url, &title);
                closing.push(end);
                Some(Event::InlineHtml(opening.into()))
            }
            Event::End(TagEnd::Link) => {
                Some(Event::InlineHtml(closing.pop().unwrap_or_default().into()))
            }
            Event::Start(Tag::Image { ref dest_url, .. }) if !dest_url.contains(':') => {
                self.pictures.insert(tidy::resolve(self.path, dest_url));
                Some(event)
            }
            // Marks of generated parts.
            Event::Html(text) if text.trim_start().starts_with("<!--") => None,
            event => Some(event),
        });
        let mut html = String::new();
        html::push_html(&mut html, events);
        // What is wider than the page is scrolled by itself, with the keyboard too. The policy allows no `style`.
        html.replace("<pre><code", "<pre tabindex=\"0\"><code")
            .replace(
                "<table>",
                "<div class=\"wide\" tabindex=\"0\" role=\"group\" aria-label=\"↔\"><table>",
            )
            .replace("</table>", "</table></div>")
            .replace("style=\"text-align: right\"", "class=\"right\"")
            .replace(" style=\"text-align: center\"", "")
            .replace(" style=\"text-align: left\"", "")
    }

    /// A link whose text is the path of a page has the page's title in its place.
    fn name_pages(&self, events: &mut [Event<'_>]) {
        for index in 1..events.len() {
            let (before, after) = events.split_at_mut(index);
            let (Some(Event::Start(Tag::Link { dest_url, .. })), Some(Event::Text(text))) =
                (before.last(), after.first_mut())
            else {
                continue;
            };
            let file = dest_url.split('#').next().unwrap_or_default();
            let path = tidy::resolve(self.path, file);
            let named = path == **text || path.strip_suffix("/README.md") == Some(text);
            if let Some(title) = self
                .sources
                .get(&*path)
                .filter(|_| named)
                .and_then(|text| title(text))
            {
                *text = title.into();
            }
        }
    }

    fn link(&mut self, target: &str, title: &str) -> (String, &'static str) {
        let title = match title {
            "" => String::new(),
            title => format!(" title=\"{}\"", escaped(title)),
        };
        match self.resolve(target) {
            Link::To(address) => (format!("<a href=\"{}\"{title}>", escaped(&address)), "</a>"),
            Link::Run(address) => {
                self.runs = true;
                let address = escaped(&address);
                (
                    format!("<a class=\"run\" href=\"{address}\"{title}>"),
                    "</a>",
                )
            }
            Link::Nowhere => ("<span class=\"file\">".to_owned(), "</span>"),
        }
    }

    fn resolve(&self, target: &str) -> Link {
        if target.starts_with('#') || target.contains("://") || target.starts_with("mailto:") {
            return Link::To(target.to_owned());
        }
        let (file, anchor) = match target.split_once('#') {
            Some((file, anchor)) => (file, format!("#{anchor}")),
            None => (target, String::new()),
        };
        let path = tidy::resolve(self.path, file);
        let root = self.root();
        if path == LAB {
            return Link::Run(format!("{root}{anchor}"));
        }
        let readme = format!("{path}/README.md");
        let page = [path.as_str(), readme.as_str()]
            .into_iter()
            .find(|path| self.sources.contains_key(path));
        if let Some(page) = page {
            return Link::To(format!("{root}{}{anchor}", address_of(page)));
        }
        let of_crate = path
            .strip_prefix("crates/")
            .map(|path| path.trim_end_matches("/README.md"));
        if let Some(name) = of_crate.filter(|name| API.contains(name)) {
            return Link::To(format!("{root}api/rumbo_{name}/index.html"));
        }
        match self.source_address {
            Some(address) => Link::To(format!("{address}{path}{anchor}")),
            None => Link::Nowhere,
        }
    }

    /// The page around its content.
    fn whole(&self, content: &str) -> String {
        let spanish = is_spanish(self.path);
        let word = |[english, spanish_word]: [&'static str; 2]| match spanish {
            true => spanish_word,
            false => english,
        };
        let root = self.root();
        let mut places = format!("<a href=\"{root}\">{}</a>", word(["Lab", "Laboratorio"]));
        for place in PLACES {
            let (path, anchor, name) = place[usize::from(spanish)];
            let folder = path
                .strip_suffix("README.md")
                .filter(|folder| !folder.is_empty());
            let here =
                path == self.path || folder.is_some_and(|folder| self.path.starts_with(folder));
            let current = if here { " aria-current=\"true\"" } else { "" };
            let address = address_of(path);
            places += &format!("<a href=\"{root}{address}{anchor}\"{current}>{name}</a>");
        }
        let other = counterpart(self.path).filter(|other| self.sources.contains_key(&**other));
        let language = other.map_or(String::new(), |other| {
            let (code, name) = if spanish {
                ("en", "English")
            } else {
                ("es", "Español")
            };
            let address = address_of(&other);
            format!("<a href=\"{root}{address}\" lang=\"{code}\" hreflang=\"{code}\">{name}</a>")
        });
        let script = match self.runs {
            true => format!("<script type=\"module\" src=\"{root}pages/page.js\"></script>"),
            false => String::new(),
        };
        let fields = [
            ("language", if spanish { "es" } else { "en" }),
            ("policy", POLICY),
            ("title", &self.title()),
            ("root", &root),
            ("script", &script),
            ("pages", word(["Pages", "Páginas"])),
            ("places", &places),
            ("other_language", &language),
            ("on", &self.neighbours()),
            ("content", content),
        ];
        // The content comes last: what looks like a field there stays.
        fields
            .iter()
            .fold(TEMPLATE.to_owned(), |page, (name, value)| {
                page.replace(&format!("{{{{{name}}}}}"), value)
            })
    }

    fn title(&self) -> String {
        let text = self.sources.get(self.path).copied().unwrap_or_default();
        escaped(&title(text).unwrap_or_else(|| "Rumbo".to_owned()))
    }

    /// The lessons before and after this one.
    fn neighbours(&self) -> String {
        let Some((folder, _)) = self.path.rsplit_once('/') else {
            return String::new();
        };
        if !folder.starts_with("docs/lessons/") || self.path.ends_with("README.md") {
            return String::new();
        }
        let of_folder = |path: &&&str| {
            let within = path.rsplit_once('/').is_some_and(|(own, _)| own == folder);
            within && !path.ends_with("README.md")
        };
        let lessons: Vec<&&str> = self.sources.keys().filter(of_folder).collect();
        let place = lessons.iter().position(|path| **path == self.path);
        let at = |index: Option<usize>| Some(lessons.get(index?)?.to_owned().to_owned());
        let before = at(place.and_then(|index| index.checked_sub(1)));
        let after = at(place.map(|index| index + 1));
        let link = |path: Option<&str>, rel: &str, arrow: [&str; 2]| {
            path.map_or(String::new(), |path| {
                let page = Page {
                    path,
                    sources: self.sources,
                    source_address: None,
                    pictures: &mut BTreeSet::new(),
                    runs: false,
                };
                let address = address_of(path);
                let [left, right] = arrow;
                let title = page.title();
                format!(
                    "<a rel=\"{rel}\" href=\"{}{address}\">{left}{title}{right}</a>",
                    self.root()
                )
            })
        };
        format!(
            "<nav class=\"on\">{}{}</nav>",
            link(before, "prev", ["← ", ""]),
            link(after, "next", ["", " →"])
        )
    }
}

/// The first heading.
fn title(text: &str) -> Option<String> {
    let first = text.lines().find_map(|line| line.strip_prefix("# "))?;
    Some(first.replace('`', ""))
}

/// A text in an attribute or between tags.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('"', "&quot;")
}

/// Gives each heading the anchor that code hosts give it.
fn name_headings(events: &mut [Event<'_>]) {
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    for index in 0..events.len() {
        if !matches!(events[index], Event::Start(Tag::Heading { .. })) {
            continue;
        }
        let words = events[index..]
            .iter()
            .take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))))
            .filter_map(|event| match event {
                Event::Text(words) | Event::Code(words) => Some(&**words),
                _ => None,
            });
        let name = anchor(&words.collect::<String>());
        let count = taken.entry(name.clone()).or_default();
        let unique = match *count {
            0 => name,
            again => format!("{name}-{again}"),
        };
        *count += 1;
        if let Event::Start(Tag::Heading { id, .. }) = &mut events[index] {
            *id = Some(unique.into());
        }
    }
}

#[cfg(test)]
mod tests;
