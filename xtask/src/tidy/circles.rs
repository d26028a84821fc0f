//! No two first-level modules of a crate import each other in a circle: each can be read, tested and moved by itself.
//!
//! Modules and what the crate's root exports again are read from `src/lib.rs`, imports from every `crate::` path. Tests
//! may import what they like.

use std::collections::{BTreeMap, BTreeSet};

use super::{Finding, Tree};

/// The crates to which the rule applies.
const CRATES: [&str; 5] = [
    "crates/sim",
    "crates/experiment",
    "crates/log",
    "crates/session",
    "crates/station",
];

/// An import: the file and line that has it.
type Place<'a> = (&'a str, usize);
/// The modules that each module imports, and where first.
type Imports<'a> = BTreeMap<&'a str, BTreeMap<&'a str, Place<'a>>>;

/// Every import that is part of a circle.
pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    CRATES
        .iter()
        .flat_map(|folder| in_crate(tree, folder))
        .collect()
}

fn in_crate(tree: &Tree, folder: &str) -> Vec<Finding> {
    let imports = imports(tree, folder);
    let mut findings = Vec::new();
    for (from, uses) in &imports {
        for (to, (path, line)) in uses {
            if let Some(way) = way(&imports, to, from) {
                let text = format!(
                    "modules import each other in a circle: {from} -> {}; move what both need into a module of its own",
                    way.join(" -> ")
                );
                findings.push(Finding::error(path, *line, text));
            }
        }
    }
    findings
}

/// A path from one module to another by imports.
fn way<'a>(imports: &Imports<'a>, from: &'a str, to: &str) -> Option<Vec<&'a str>> {
    let mut seen = BTreeSet::from([from]);
    let mut ways = vec![vec![from]];
    while !ways.is_empty() {
        if let Some(way) = ways.iter().find(|way| way.last() == Some(&to)) {
            return Some(way.clone());
        }
        let mut longer = Vec::new();
        for way in ways {
            let next = way.last().and_then(|last| imports.get(last));
            for module in next.into_iter().flat_map(BTreeMap::keys) {
                if seen.insert(module) {
                    longer.push([&way[..], &[module]].concat());
                }
            }
        }
        ways = longer;
    }
    None
}

fn imports<'a>(tree: &'a Tree, folder: &str) -> Imports<'a> {
    let source = format!("{folder}/src/");
    let root = tree.text(&format!("{source}lib.rs")).unwrap_or_default();
    let modules: BTreeSet<&str> = root.lines().filter_map(declared).collect();
    let exports: BTreeMap<&str, &str> = root
        .match_indices("pub use ")
        .filter_map(|(at, _)| {
            let path = &root[at + "pub use ".len()..];
            let (module, rest) = path.split_once("::")?;
            Some((module, first_names(rest)))
        })
        .flat_map(|(module, names)| names.into_iter().map(move |name| (name, module)))
        .collect();
    let mut imports: Imports<'a> = BTreeMap::new();
    for (path, text) in tree.texts(|path| path.starts_with(&source) && path.ends_with(".rs")) {
        let below = &path[source.len()..];
        let own = below.split(['/', '.']).next().unwrap_or_default();
        if !modules.contains(own) || below.ends_with("/tests.rs") || below.contains("/tests/") {
            continue;
        }
        let text = text
            .split_once("\n#[cfg(test)]\nmod ")
            .map_or(text, |(before, _)| before);
        for (at, name) in named(text) {
            let module = exports.get(name).copied().unwrap_or(name);
            if let Some(module) = modules.get(module)
                && *module != own
            {
                let line = text[..at].lines().count().max(1);
                let uses = imports.entry(own).or_default();
                uses.entry(module).or_insert((path, line));
            }
        }
    }
    imports
}

/// The module that a line of the root declares.
fn declared(line: &str) -> Option<&str> {
    let (before, after) = line.trim().split_once("mod ")?;
    let name = after.strip_suffix(';')?;
    (before.is_empty() || before.starts_with("pub")).then_some(name)
}

/// What follows each `crate::` that is no comment, and where.
fn named(text: &str) -> impl Iterator<Item = (usize, &str)> {
    const PATH: &str = "crate::";
    let paths = text.match_indices(PATH).filter(|(at, _)| {
        let line = &text[text[..*at].rfind('\n').map_or(0, |end| end + 1)..*at];
        !line.contains("//") && !line.ends_with(|last: char| last.is_alphanumeric() || last == '_')
    });
    paths.flat_map(|(at, _)| {
        first_names(&text[at + PATH.len()..])
            .into_iter()
            .map(move |name| (at, name))
    })
}

/// The first name of a path, or of each path in its braces.
fn first_names(path: &str) -> Vec<&str> {
    let name = |path: &'_ str| {
        path.find(|next: char| !next.is_alphanumeric() && next != '_')
            .unwrap_or(path.len())
    };
    let Some(list) = path.strip_prefix('{') else {
        return vec![&path[..name(path)]];
    };
    let (mut depth, mut begin, mut names) = (0, 0, Vec::new());
    for (at, next) in list.char_indices() {
        match next {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                let path = list[begin..at].trim();
                names.push(&path[..name(path)]);
                begin = at + 1;
                if next == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let mut all = vec![(
            "crates/sim/src/lib.rs",
            "mod a;\npub mod b;\nmod c;\npub use c::{Deep, Wide};\n",
        )];
        all.extend(files);
        let findings = check(&Tree::of(&all));
        findings.iter().map(Finding::to_string).collect()
    }

    #[test]
    fn a_circle_of_three_is_named_at_each_import_of_it() {
        let found = found(&[
            ("crates/sim/src/a.rs", "//! A.\n\nuse crate::b::B;\n"),
            ("crates/sim/src/b/mod.rs", "use crate::{Deep, b::X};\n"),
            ("crates/sim/src/c.rs", "fn f() -> crate::a::A {}\n"),
        ]);
        assert_eq!(found.len(), 3);
        assert!(found[0].starts_with("crates/sim/src/a.rs:3: "), "{found:?}");
        assert!(found[0].contains("a -> b -> c -> a;"), "{found:?}");
    }

    #[test]
    fn arrows_one_way_are_no_circle_nor_are_comments_and_tests() {
        let found = found(&[
            ("crates/sim/src/a.rs", "use crate::b::{B, c::C};\n"),
            (
                "crates/sim/src/b.rs",
                "// As crate::a does.\nuse crate::c::Wide;\n\n#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}\n",
            ),
            ("crates/sim/src/b/tests.rs", "use crate::a::A;\n"),
            (
                "crates/sim/src/c.rs",
                "use other_crate::a::A;\nuse crate::c::C;\n",
            ),
        ]);
        assert_eq!(found, [""; 0]);
    }
}
