//! The links of the finished site: each leads to a file of it, and to a place in that file.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::{names_below, wrong};
use crate::tidy;

/// The links of the finished pages that lead to no file of the site, or to no place in it.
pub(super) fn check(site: &Path) -> Result<(), String> {
    let mut lost = Vec::new();
    let mut texts: BTreeMap<String, String> = BTreeMap::new();
    for name in names_below(site)? {
        let path = site.join(&name);
        let text = match name.ends_with(".html") && !name.starts_with("api/") {
            true => fs::read_to_string(&path).map_err(|error| wrong(&path, &error))?,
            false => String::new(),
        };
        texts.insert(name, text);
    }
    for (name, text) in texts.iter().filter(|(name, _)| *name != "index.html") {
        for target in [" href=\"", " src=\""]
            .into_iter()
            .flat_map(|attribute| text.split(attribute).skip(1))
            .filter_map(|rest| rest.split('"').next())
            .filter(|target| !target.contains("://"))
        {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let mut path = match file {
                "" => name.clone(),
                file => tidy::resolve(name, file),
            };
            if path.is_empty() || file.ends_with('/') {
                path = format!("{path}/index.html")
                    .trim_start_matches('/')
                    .to_owned();
            }
            let found = texts.get(&path);
            // After the `#` of the lab stands a run.
            let without = anchor.is_empty() || path == "index.html";
            let there = |text: &String| without || text.contains(&format!(" id=\"{anchor}\""));
            if !found.is_some_and(there) {
                lost.push(format!("site/{name}: the link `{target}` leads nowhere"));
            }
        }
    }
    match lost.is_empty() {
        true => Ok(()),
        false => Err(lost.join("\n")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_of_a_finished_page_that_leads_nowhere_is_found() {
        let site = std::env::temp_dir().join(format!("rumbo-pages-{}", std::process::id()));
        fs::create_dir_all(site.join("docs")).unwrap();
        let page = |links: &str| fs::write(site.join("docs/a.html"), links).unwrap();
        fs::write(site.join("index.html"), "").unwrap();
        page("<h1 id=\"b\"> <a href=\"#b\"> <a href=\"../#scenario=x\"> <a href=\"a.html#b\">");
        assert_eq!(check(&site), Ok(()));
        for lost in ["b.html", "#c", "a.html#c", "../other/"] {
            page(&format!("<a href=\"{lost}\">"));
            let what = check(&site).unwrap_err();
            assert_eq!(
                what,
                format!("site/docs/a.html: the link `{lost}` leads nowhere")
            );
        }
        fs::remove_dir_all(&site).unwrap();
    }
}
