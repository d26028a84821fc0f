//! Documents: relative links reach a file and a heading, lines of text fit on a screen, decision records are numbered
//! without gaps.

use super::{Finding, Tree};
use crate::markdown::Markdown;

/// Folder of the decision records.
const RECORDS: &str = "docs/adr/";

/// Longest line of text, in characters.
const WIDTH: usize = 120;

/// Checks all Markdown files.
pub(crate) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = records(tree);
    for (path, text) in tree.texts(is_document) {
        let parts = Markdown::parse(text);
        let long = (1..).zip(text.lines()).filter(|(line, text)| {
            let breaks = !is_definition(text) && !parts.wide.iter().any(|wide| wide.contains(line));
            text.chars().count() > WIDTH && breaks
        });
        findings.extend(long.map(|(line, text)| {
            let length = text.chars().count();
            let what = format!("{length} characters; a line of text has at most {WIDTH}: break it");
            Finding::error(path, line, what)
        }));
    }
    findings.extend(broken_links(tree));
    findings
}

/// The links of all Markdown files that lead nowhere.
pub(crate) fn broken_links(tree: &Tree) -> Vec<Finding> {
    let files = tree.texts(is_document);
    let links = files.flat_map(|(path, text)| {
        let links = Markdown::parse(text).links.into_iter();
        links.filter_map(move |(line, target)| {
            Some(Finding::error(path, line, broken(tree, path, &target)?))
        })
    });
    links.collect()
}

/// The address of a link, apart from the text: `[name]: address`.
fn is_definition(line: &str) -> bool {
    line.starts_with('[') && line.contains("]: ")
}

fn is_document(path: &str) -> bool {
    path.ends_with(".md") && !path.contains("node_modules/")
}

/// The problem of a link in the file `from`, if any. Addresses with a scheme are not followed: other sites, and figures
/// from the report's runs (`run:`).
fn broken(tree: &Tree, from: &str, target: &str) -> Option<String> {
    let of_scheme = |name: &str| name.chars().all(|letter| letter.is_ascii_alphabetic());
    if target
        .split_once(':')
        .is_some_and(|(name, _)| of_scheme(name))
    {
        return None;
    }
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = if file.is_empty() {
        from.to_owned()
    } else {
        resolve(from, file)
    };
    if !tree.has_file(&path) && !tree.has_folder(&path) {
        return Some(format!(
            "the link `{target}` leads to `{path}`, which is not in the project"
        ));
    }
    let headings = |text| Markdown::parse(text).anchors;
    let missing = !anchor.is_empty()
        && path.ends_with(".md")
        && !tree
            .text(&path)
            .map(headings)
            .unwrap_or_default()
            .iter()
            .any(|known| known == anchor);
    missing.then(|| format!("the link `{target}` names a heading that `{path}` does not have"))
}

/// The path that a link `target` in the file `from` means, relative to the root.
pub(crate) fn resolve(from: &str, target: &str) -> String {
    let mut folders: Vec<&str> = from.split('/').collect();
    folders.pop();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(folders.pop()),
            folder => folders.push(folder),
        }
    }
    folders.join("/")
}

/// Records are named `0001-title.md`, numbered without gaps, and start with `# 0001: Title`.
fn records(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    let records = tree.texts(|path| path.starts_with(RECORDS) && path != "docs/adr/README.md");
    for (expected, (path, text)) in (1..).zip(records) {
        let number = path[RECORDS.len()..].split('-').next().unwrap_or_default();
        let wanted = format!("{expected:04}");
        if number != wanted {
            findings.push(Finding::error(
                path,
                1,
                format!("decision record numbered `{number}`; expected {wanted}"),
            ));
        } else if !text.starts_with(&format!("# {wanted}: ")) {
            findings.push(Finding::error(
                path,
                1,
                format!("a decision record starts with `# {wanted}: title`"),
            ));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        check(&Tree::of(files))
            .iter()
            .map(Finding::to_string)
            .collect()
    }

    #[test]
    fn links_to_files_folders_and_headings_are_followed() {
        let readme = "[a](docs/a.md#the-end) [b](docs) [c](#top)\n\n# Top\n";
        assert_eq!(
            found(&[
                ("README.md", readme),
                ("docs/a.md", "# The end\n[up](../README.md)\n")
            ]),
            [""; 0]
        );
    }

    #[test]
    fn a_link_to_nowhere_is_found_with_its_line() {
        let found = found(&[("docs/a.md", "# A\n\n[b](b.md)\n")]);
        assert_eq!(found.len(), 1);
        assert!(
            found[0].starts_with("docs/a.md:3: the link `b.md` leads to `docs/b.md`"),
            "{found:?}"
        );
    }

    #[test]
    fn a_link_to_a_missing_heading_is_found() {
        assert!(found(&[("a.md", "[b](#b)\n")])[0].contains("names a heading"));
    }

    #[test]
    fn a_line_of_text_has_at_most_120_characters_but_tables_code_and_addresses_have_their_width() {
        let (fits, long) = ("é".repeat(120), "é".repeat(121));
        let page =
            format!("{fits}\n\n| a |\n|---|\n| {long} |\n\n```text\n{long}\n```\n\n[a]: {long}\n");
        assert_eq!(found(&[("a.md", &page)]), [""; 0]);
        let page = format!("{page}\n- {long}\n");
        let what = "a.md:13: 123 characters; a line of text has at most 120: break it";
        assert_eq!(found(&[("a.md", &page)]), [what]);
    }

    #[test]
    fn records_are_numbered_without_gaps() {
        let first = ("docs/adr/0001-records.md", "# 0001: Records\n");
        assert_eq!(
            found(&[first, ("docs/adr/0002-link.md", "# 0002: Link\n")]),
            [""; 0]
        );
        assert!(
            found(&[first, ("docs/adr/0003-link.md", "# 0003: Link\n")])[0]
                .contains("expected 0002")
        );
        assert!(found(&[("docs/adr/0001-records.md", "# Records\n")])[0].contains("starts with"));
    }
}
