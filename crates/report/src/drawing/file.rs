//! Drawings that are files: SVG as an editor such as Inkscape writes it, made part of the page.
//!
//! The page colours a drawing by its classes (`style.css`), as it does the computed ones; by the file's own style sheet it
//! looks alike in an editor. Texts are words of both languages, `{{name}}`. What an editor adds for itself does not go into
//! the page.

use crate::content::{ContentError, Source};
use crate::text::{Language, escape, put};
use crate::words::{Words, words};
use roxmltree::{Document, Node};

const SVG: &str = "http://www.w3.org/2000/svg";
/// Elements of a file that are not part of the picture.
const LEFT_OUT: [&str; 4] = ["style", "metadata", "title", "desc"];
/// Attributes that hold for the file, not for its place in a page, where a name may stand only once.
const FILE_ONLY: [&str; 5] = ["id", "width", "height", "version", "class"];

/// A drawing in one language.
///
/// # Errors
/// A file that is no SVG, or a text that is no word.
pub(crate) fn svg(language: Language, name: &str) -> Result<String, ContentError> {
    inlined(&Source::drawing(name)?, words(language)?)
}

fn inlined(source: &Source, words: &Words) -> Result<String, ContentError> {
    let document = Document::parse(&source.text).map_err(|error| ContentError {
        file: source.file.clone(),
        line: error.pos().row as usize,
        what: format!("is no SVG ({error}); save it as plain SVG"),
    })?;
    let mut svg = String::new();
    let drawing = Drawing { source, words };
    drawing.element(document.root_element(), &mut svg)?;
    Ok(svg)
}

struct Drawing<'a> {
    source: &'a Source,
    words: &'a Words,
}

impl Drawing<'_> {
    fn element(&self, node: Node<'_, '_>, svg: &mut String) -> Result<(), ContentError> {
        let name = node.tag_name().name();
        if node.tag_name().namespace() != Some(SVG) || LEFT_OUT.contains(&name) {
            return Ok(());
        }
        let whole = node.parent_element().is_none();
        put(svg, format_args!("<{name}"));
        if whole {
            *svg += " class=\"plot\"";
        }
        for attribute in node.attributes() {
            let key = attribute.name();
            let file_only = FILE_ONLY.contains(&key) && (whole || key == "id");
            if attribute.namespace().is_none() && !file_only {
                let value = escape(attribute.value());
                put(svg, format_args!(" {key}=\"{value}\""));
            }
        }
        *svg += ">";
        for child in node.children() {
            if child.is_element() {
                self.element(child, svg)?;
            } else if child.is_text() && ["text", "tspan"].contains(&name) {
                *svg += &self.text(child.text().unwrap_or_default(), child)?;
            }
        }
        put(svg, format_args!("</{name}>"));
        Ok(())
    }

    /// A text with its words.
    fn text(&self, text: &str, node: Node<'_, '_>) -> Result<String, ContentError> {
        let mut pieces = text.split("{{");
        let mut html = escape(pieces.next().unwrap_or_default());
        for piece in pieces {
            let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
            let Some(word) = self.words.get(name) else {
                let what =
                    format!("no word is called `{name}`; add it to words.md of both languages");
                return Err(self.source.error(node.range().start, what));
            };
            html += &escape(word);
            html += &escape(rest);
        }
        Ok(html)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source {
            file: "content/drawings/test.svg".into(),
            text: text.to_owned().into(),
        }
    }

    fn known() -> Words {
        Words::from([("wall".into(), "wall & floor".into())])
    }

    #[test]
    fn what_an_editor_adds_for_itself_is_left_out_of_the_page() {
        let text = r##"<?xml version="1.0"?><!-- made by hand -->
<svg width="10" height="5" viewBox="0 0 10 5" id="svg1" xmlns="http://www.w3.org/2000/svg"
     xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:version="1.4">
  <style>.l { stroke: black; }</style>
  <inkscape:namedview id="view"><inkscape:grid/></inkscape:namedview>
  <metadata>x</metadata>
  <g inkscape:label="Layer 1" id="g1" transform="scale(2)"><path class="l" id="p1" d="M0 0"/></g>
  <text class="s" x="1" y="2"><tspan id="t1" x="1" y="2">a {{wall}}</tspan></text>
</svg>"##;
        assert_eq!(
            inlined(&source(text), &known()).unwrap(),
            "<svg class=\"plot\" viewBox=\"0 0 10 5\"><g transform=\"scale(2)\"><path class=\"l\" d=\"M0 0\"></path></g>\
             <text class=\"s\" x=\"1\" y=\"2\"><tspan x=\"1\" y=\"2\">a wall &amp; floor</tspan></text></svg>"
        );
    }

    #[test]
    fn a_mistake_is_named_with_its_line() {
        let unknown = "<svg xmlns=\"http://www.w3.org/2000/svg\">\n<text>{{wal}}</text>\n</svg>";
        let broken = "<svg xmlns=\"http://www.w3.org/2000/svg\">\n<path>\n</svg>";
        for (text, expected) in [
            (unknown, "test.svg:2: no word is called `wal`"),
            (broken, "test.svg:3: is no SVG"),
        ] {
            let error = inlined(&source(text), &known()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
