use super::*;
use crate::text::Language;

fn source(text: &str) -> Source {
    Source {
        file: "content/en/test.md".into(),
        text: text.to_owned().into(),
    }
}

/// What becomes of a text with a value, a table, a figure, and a section that this run does not show.
fn written(text: &str) -> Result<String, ContentError> {
    let mut places = Places::new(Language::English);
    for name in ["speed", "limits", "curve"] {
        if text.contains(name) {
            match name {
                "speed" => places.value(name, "<3 m/s>"),
                "limits" => places.block(name, "<table></table>"),
                _ => places.figure(name, Some("<svg viewBox=\"0 0 1 1\"></svg>".into())),
            }
        }
    }
    places.section("recorded", false);
    let mut page = Page::new(Language::English);
    write(&mut page, &source(text), &places, |_, title| {
        format!("<h2>{title}</h2>\n")
    })
}

#[test]
fn values_tables_figures_and_formulas_take_their_places() {
    let html = written(
        "# Title\n\nAt *most*\n{{speed}}, as `{{speed}}`.\n\n{{limits}}\n\n![Speed $v$ of\nboth](run:curve)\n\n$$v = 1$$\n",
    )
    .unwrap();
    for part in [
        "<h2>Title</h2>",
        "<p>At <em>most</em> &lt;3 m/s&gt;, as <code translate=\"no\">&lt;3 m/s&gt;</code>.</p>",
        "\n<table></table>",
        "<figure id=\"fig-curve\">",
        "aria-label=\"Speed v of both\"",
        "<div class=\"formula\"><math",
    ] {
        assert!(html.contains(part), "{part}: {html}");
    }
}

#[test]
fn a_section_that_the_run_does_not_have_is_left_out_with_its_subsections() {
    let html = written(
        "## One\n\na\n\n## Two {.recorded}\n\n{{file}}\n\n### Three\n\nb\n\n## Four\n\nc\n",
    );
    assert_eq!(
        html.unwrap(),
        "<h3>One</h3>\n<p>a</p>\n<h3>Four</h3>\n<p>c</p>\n"
    );
}

#[test]
fn a_mistake_is_named_with_its_file_and_line() {
    for (text, line, what) in [
        ("a\n\nb {{spede}}\n", 3, "`spede` is no word and no place"),
        (
            "a\n\n![b](run:curves)\n",
            3,
            "`curves` is no word and no place",
        ),
        (
            "a\n\n## B {.recordd}\n",
            3,
            "no section of this text is called `recordd`",
        ),
        ("a\n\n{{limits\n", 3, "ends with }}"),
        ("a\n\nb {{limits}}\n", 3, "stands alone in its paragraph"),
        ("a\n\n{{curve}}\n", 3, "write ![its caption](run:curve)"),
        ("a\n\nb ![c](run:curve)\n", 3, "alone in its paragraph"),
        ("a\n\n![b](curve)\n", 3, "write run:name"),
        ("a\n\n![b](run:speed)\n", 3, "write {{speed}}"),
        ("a\n\nb $$v$$\n", 3, "put empty lines around it"),
        ("a\n\nb $\\frac{1$\n", 3, "begins no formula"),
        ("a\n\nb $\\nothing{1}$\n", 3, "is no formula in TeX"),
        ("a\n\n<b>c</b>\n", 3, "HTML is not taken"),
        (
            "a\n\n![b](../drawings/none.svg)\n",
            1,
            "there is no such file",
        ),
    ] {
        let error = written(text).unwrap_err();
        assert!(
            error.line == line && error.what.contains(what),
            "{text:?}: {error}"
        );
    }
}

#[test]
fn a_value_that_no_text_shows_is_an_error() {
    let mut places = Places::new(Language::English);
    places.value("speed", "3");
    let mut page = Page::new(Language::English);
    let error = write(&mut page, &source("a\n"), &places, |_, _| String::new()).unwrap_err();
    let said = error.to_string();
    assert!(
        said.starts_with("content/en/test.md:2: ") && said.contains("`speed`"),
        "{said}"
    );
}
