//! The parts of a Markdown file that the chores need: links, headings, code blocks and tables, each with its line.

use std::ops::Range;

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// The parts of one Markdown text.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Markdown {
    /// Targets of links and pictures, with their line (from 1).
    pub(crate) links: Vec<(usize, String)>,
    /// Anchors of the headings, as code hosts form them.
    pub(crate) anchors: Vec<String>,
    /// Fenced code blocks.
    pub(crate) blocks: Vec<Block>,
    /// Lines of tables and of code blocks, which may be as long as they are wide.
    pub(crate) wide: Vec<Range<usize>>,
}

/// A fenced code block.
#[derive(Debug, PartialEq)]
pub(crate) struct Block {
    /// The word after the fence, such as `sh`.
    pub(crate) language: String,
    /// Line (from 1) of the first line of code.
    pub(crate) line: usize,
    /// The code.
    pub(crate) text: String,
}

impl Markdown {
    /// Reads a text; every text is valid Markdown.
    pub(crate) fn parse(text: &str) -> Self {
        let mut parts = Self::default();
        let mut heading: Option<String> = None;
        let mut in_block = false;
        for (event, range) in Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter() {
            let line = 1 + text[..range.start].matches('\n').count();
            if let Event::Start(Tag::CodeBlock(_) | Tag::Table(_)) = event {
                parts.wide.push(line..line + text[range].lines().count());
            }
            match event {
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    parts.links.push((line, dest_url.into_string()));
                }
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => {
                    parts
                        .anchors
                        .extend(heading.take().map(|title| anchor(&title)));
                }
                Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(language))) => {
                    in_block = true;
                    parts.blocks.push(Block {
                        language: language.into_string(),
                        line: line + 1,
                        text: String::new(),
                    });
                }
                Event::End(TagEnd::CodeBlock) => in_block = false,
                Event::Text(words) | Event::Code(words) => {
                    if let Some(title) = &mut heading {
                        title.push_str(&words);
                    } else if let (true, Some(block)) = (in_block, parts.blocks.last_mut()) {
                        block.text.push_str(&words);
                    }
                }
                _ => {}
            }
        }
        parts
    }
}

/// Letters and digits in lower case, spaces as hyphens, everything else left out.
pub(crate) fn anchor(title: &str) -> String {
    title
        .trim()
        .chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            '-' | '_' => Some(c),
            c if c.is_alphanumeric() => Some(c.to_ascii_lowercase()),
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_headings_and_blocks_are_found_with_their_lines() {
        let text = "# The *two* commands, `run`\n\nSee [docs](docs/a.md#b)\nand ![](img/x.png).\n\n```sh\nrumbo list\n```\n";
        let parts = Markdown::parse(text);
        assert_eq!(
            parts.links,
            [(3, "docs/a.md#b".to_owned()), (4, "img/x.png".to_owned())]
        );
        assert_eq!(parts.anchors, ["the-two-commands-run"]);
        let block = Block {
            language: "sh".to_owned(),
            line: 7,
            text: "rumbo list\n".to_owned(),
        };
        assert_eq!(parts.blocks, [block]);
    }

    #[test]
    fn tables_and_code_blocks_are_wide() {
        let text = "Text\n\n| a |\n|---|\n| b |\n\nText\n\n- item\n\n  ```text\n  code\n  ```\n";
        assert_eq!(Markdown::parse(text).wide, [3..6, 11..14]);
    }

    #[test]
    fn a_link_inside_code_is_not_a_link() {
        let parts = Markdown::parse("`[a](b)`\n\n```text\n[c](d)\n```\n");
        assert_eq!(parts.links, []);
    }
}
