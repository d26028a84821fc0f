//! No two modules that stand side by side in a crate import each other in a circle: each can be read, tested and moved by
//! itself. The rule holds at every depth.
//!
//! Modules are the files below `src/`, and what a crate's root exports again is read from `src/lib.rs`; imports are read
//! from every path that begins with `crate::` or `super::`. Tests may import what they like.

use std::collections::{BTreeMap, BTreeSet};

use super::{Finding, Tree};

/// A module's path from the root of its crate.
type Module<'a> = Vec<&'a str>;
/// The modules that each module imports of those beside it, and where first: file and line.
type Imports<'a> = BTreeMap<Module<'a>, BTreeMap<Module<'a>, (&'a str, usize)>>;

/// The imports that are part of a circle, in each crate.
pub(super) fn check(tree: &Tree) -> Vec<Finding> {
    let files = tree.texts(|path| path.ends_with(".rs"));
    let sources = files.filter_map(|(path, _)| {
        let end = path.find("src/")? + "src/".len();
        Some(&path[..end])
    });
    let sources: BTreeSet<&str> = sources.collect();
    let of_crate = |source| in_crate(tree, source);
    sources.into_iter().flat_map(of_crate).collect()
}

fn in_crate(tree: &Tree, source: &str) -> Vec<Finding> {
    let imports = imports(tree, source);
    let mut circles = Vec::new();
    for (from, uses) in &imports {
        for (to, (path, line)) in uses {
            if let Some(way) = way(&imports, to, from) {
                let way: Vec<String> = way.iter().map(|module| module.join("::")).collect();
                let text = format!(
                    "modules import each other in a circle: {} -> {}; move what both need into a module of its own",
                    from.join("::"),
                    way.join(" -> ")
                );
                circles.push(Finding::error(path, *line, text));
            }
        }
    }
    circles
}

/// A path from one module to another by imports.
fn way<'a>(imports: &Imports<'a>, from: &Module<'a>, to: &Module<'a>) -> Option<Vec<Module<'a>>> {
    let mut seen = BTreeSet::from([from.clone()]);
    let mut ways = vec![vec![from.clone()]];
    while !ways.is_empty() {
        if let Some(way) = ways.iter().find(|way| way.last() == Some(to)) {
            return Some(way.clone());
        }
        let mut longer = Vec::new();
        for way in ways {
            let next = way.last().and_then(|last| imports.get(last));
            for module in next.into_iter().flat_map(BTreeMap::keys) {
                if seen.insert(module.clone()) {
                    longer.push([&way[..], std::slice::from_ref(module)].concat());
                }
            }
        }
        ways = longer;
    }
    None
}

/// The module that a file is: `a/b.rs` and `a/b/mod.rs` are `a::b`. None of a root.
fn module(file: &str) -> Option<Module<'_>> {
    let path = file.strip_suffix(".rs")?;
    let path = path.strip_suffix("/mod").unwrap_or(path);
    let is_root = ["lib", "main"].contains(&path);
    (!is_root).then(|| path.split('/').collect())
}

/// Those of the crate whose sources are in this folder.
fn imports<'a>(tree: &'a Tree, source: &str) -> Imports<'a> {
    let root = tree.text(&format!("{source}lib.rs")).unwrap_or_default();
    let exports: BTreeMap<&str, &str> = root
        .match_indices("pub use ")
        .filter_map(|(at, _)| {
            let (module, rest) = root[at + "pub use ".len()..].split_once("::")?;
            Some((module, paths(rest)))
        })
        .flat_map(|(module, names)| {
            let firsts = names.into_iter().filter_map(|path| path.first().copied());
            firsts.map(move |name| (name, module))
        })
        .collect();
    let files: Vec<_> = tree
        .texts(|path| path.starts_with(source) && path.ends_with(".rs"))
        .filter_map(|(path, text)| Some((path, text, module(&path[source.len()..])?)))
        .filter(|(_, _, own)| !own.contains(&"tests"))
        .collect();
    let modules: BTreeSet<&Module<'_>> = files.iter().map(|(_, _, own)| own).collect();
    let mut imports: Imports<'a> = BTreeMap::new();
    for (path, text, own) in &files {
        let text = text
            .split_once("\n#[cfg(test)]\nmod ")
            .map_or(*text, |(before, _)| before);
        for (at, mut used) in named(text, own) {
            if let Some(module) = used.first().and_then(|first| exports.get(first)) {
                used.insert(0, module);
            }
            let depth = std::iter::zip(own, &used)
                .take_while(|(a, b)| a == b)
                .count();
            if depth >= own.len() || depth >= used.len() {
                // What is above, below, or the module itself.
                continue;
            }
            let (from, to) = (own[..=depth].to_vec(), used[..=depth].to_vec());
            if modules.contains(&to) {
                let line = text[..at].lines().count().max(1);
                let uses = imports.entry(from).or_default();
                uses.entry(to).or_insert((path, line));
            }
        }
    }
    imports
}

/// The paths of the crate that stand in a module's text and not in a comment, and where.
fn named<'a>(text: &'a str, own: &Module<'a>) -> Vec<(usize, Module<'a>)> {
    let mut named = Vec::new();
    for start in ["crate::", "super::"] {
        for (at, _) in text.match_indices(start) {
            let line = &text[text[..at].rfind('\n').map_or(0, |end| end + 1)..at];
            let inside = |last: char| last.is_alphanumeric() || last == '_' || last == ':';
            if line.contains("//") || line.ends_with(inside) {
                continue;
            }
            let mut above = match start {
                "crate::" => Vec::new(),
                _ => own[..own.len() - 1].to_vec(),
            };
            let mut rest = &text[at + start.len()..];
            while let Some(further) = rest.strip_prefix("super::") {
                above.pop();
                rest = further;
            }
            named.extend(
                paths(rest)
                    .into_iter()
                    .map(|path| (at, [&above[..], &path].concat())),
            );
        }
    }
    named
}

/// The paths that a text begins with: one, or all in its braces.
fn paths(text: &str) -> Vec<Module<'_>> {
    let Some(list) = text.strip_prefix('{') else {
        let length = text.find(|next: char| !next.is_alphanumeric() && next != '_');
        let (name, rest) = text.split_at(length.unwrap_or(text.len()));
        if name.is_empty() {
            return Vec::new();
        }
        let further = rest.strip_prefix("::").map(paths).unwrap_or_default();
        return match further.is_empty() {
            true => vec![vec![name]],
            false => further
                .into_iter()
                .map(|path| [&[name], &path[..]].concat())
                .collect(),
        };
    };
    let (mut depth, mut begin, mut found) = (0, 0, Vec::new());
    for (at, next) in list.char_indices() {
        match next {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                found.extend(paths(list[begin..at].trim()));
                begin = at + 1;
                if next == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    found
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
        let circles = check(&Tree::of(&all));
        circles.iter().map(ToString::to_string).collect()
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
    fn modules_within_a_module_are_no_circle_either() {
        let found = found(&[
            ("crates/sim/src/a/one.rs", "use super::two::T;\n"),
            (
                "crates/sim/src/a/two.rs",
                "use crate::a::{A, one::{O, P}};\n",
            ),
            (
                "crates/sim/src/a/mod.rs",
                "mod one;\nmod two;\nuse one::O;\n",
            ),
        ]);
        assert_eq!(found.len(), 2);
        assert!(
            found[0].contains("a::one -> a::two -> a::one;"),
            "{found:?}"
        );
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
