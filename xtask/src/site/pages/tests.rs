use super::*;

/// The content of `docs/a.md` with this text, beside `docs/lessons/en/README.md`.
fn content(text: &str) -> String {
    let sources = BTreeMap::from([
        ("docs/a.md", text),
        ("docs/lessons/en/README.md", "# Lessons\n"),
    ]);
    let mut page = Page {
        path: "docs/a.md",
        sources: &sources,
        source_address: None,
        pictures: &mut BTreeSet::new(),
        runs: false,
    };
    page.content(text)
}

#[test]
fn a_link_leads_to_the_page_of_its_file() {
    for (link, expected) in [
        (
            "[x](lessons/en/README.md#b)",
            "<a href=\"../docs/lessons/en/#b\">x</a>",
        ),
        ("[x](lessons/en)", "<a href=\"../docs/lessons/en/\">x</a>"),
        (
            "[docs/lessons/en](lessons/en/README.md)",
            "<a href=\"../docs/lessons/en/\">Lessons</a>",
        ),
        ("[x](#b)", "<a href=\"#b\">x</a>"),
        (
            "[x](https://a.b/c.md)",
            "<a href=\"https://a.b/c.md\">x</a>",
        ),
        (
            "[x](../crates/plant/README.md)",
            "<a href=\"../api/rumbo_plant/index.html\">x</a>",
        ),
        (
            "[x](../crates/cli/src/main.rs)",
            "<span class=\"file\">x</span>",
        ),
        (
            "[x](../web/index.html#scenario=mode1&seed=1)",
            "<a class=\"run\" href=\"../#scenario=mode1&amp;seed=1\">x</a>",
        ),
    ] {
        assert_eq!(content(link), format!("<p>{expected}</p>\n"));
    }
}

#[test]
fn headings_have_the_anchors_of_code_hosts_and_each_its_own() {
    let html = content("# A `b`, c\n\n## Again\n\n## Again\n");
    for id in ["a-b-c", "again", "again-1"] {
        assert!(html.contains(&format!(" id=\"{id}\"")), "{html}");
    }
}

#[test]
fn nothing_of_a_page_needs_a_style_that_the_policy_forbids() {
    let html = content("| a | b | c |\n|--:|:-:|:--|\n| 1 | 2 | 3 |\n");
    assert!(
        html.contains("class=\"right\"") && !html.contains("style="),
        "{html}"
    );
}

#[test]
fn a_page_and_its_translation_name_each_other() {
    for (path, other) in [
        ("README.md", "README.es.md"),
        ("docs/lessons/en/README.md", "docs/lessons/es/README.md"),
    ] {
        assert_eq!(counterpart(path).as_deref(), Some(other));
        assert_eq!(counterpart(other).as_deref(), Some(path));
    }
    assert_eq!(counterpart("docs/a.md"), None);
}
