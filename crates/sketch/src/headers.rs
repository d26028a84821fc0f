//! The headers that a sketch includes, and the libraries that have them.
//!
//! Which libraries are compiled, the compiler says by the headers that it misses, one after the other, as in the Arduino
//! IDE: a header in a comment or in a branch for another chip needs none. The key of an image takes what the text
//! mentions, which is more, and runs no compiler.

use crate::build::{Build, SKETCH};
use crate::error::SketchError;
use crate::layout::Layout;
use crate::libraries::{Library, read, spelled};
use crate::preprocess;
use crate::source::Source;
use crate::toolchain::Toolchain;
use std::collections::{BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

/// How the compiler ends that it misses a header.
pub(crate) const MISSING: &str = ": No such file or directory";
/// Folder of a build with headers that include others.
const SPELLED: &str = "rumbo~spelled";
/// Most headers that a sketch may include by different names: FastLED has some thousands.
const MOST_HEADERS: usize = 10_000;

/// A library that is needed.
pub(crate) enum Found {
    /// That of this number beside the sketch.
    Beside(usize),
    Installed(Library),
}

/// The search for the headers that a build misses.
pub(crate) struct Search<'a> {
    toolchain: &'a Toolchain,
    /// Where our libraries are put.
    ours: PathBuf,
    source: &'a Source,
    layout: &'a Layout<'a>,
    /// What was found: a library is named by its first header's folder.
    found: BTreeSet<PathBuf>,
    /// Not compiled yet.
    next: VecDeque<Found>,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        toolchain: &'a Toolchain,
        ours: PathBuf,
        source: &'a Source,
        layout: &'a Layout<'a>,
    ) -> Self {
        Self {
            toolchain,
            ours,
            source,
            layout,
            found: BTreeSet::new(),
            next: VecDeque::new(),
        }
    }

    /// The next library to compile.
    pub(crate) fn next(&mut self) -> Option<Found> {
        self.next.pop_front()
    }

    /// A step of a build, again until it misses no header that there is.
    pub(crate) fn step<T>(
        &mut self,
        build: &mut Build<'_>,
        step: impl Fn(&mut Build<'_>) -> Result<T, SketchError>,
    ) -> Result<T, SketchError> {
        loop {
            let before = build.mark();
            let done = step(build)?;
            let mut said = build.said_since(before).iter();
            let missing = said.find_map(|one| {
                let header = one.text.split_once(MISSING)?.0.to_owned();
                Some((header, one.file.clone().unwrap_or_default()))
            });
            match missing {
                Some((header, by)) if self.look_for(build, &header, &by)? => build.back_to(before),
                _ => return Ok(done),
            }
        }
    }

    /// Looks for a header that a file includes; whether the build sees more now.
    fn look_for(
        &mut self,
        build: &mut Build<'_>,
        header: &str,
        by: &str,
    ) -> Result<bool, SketchError> {
        if let Some(index) = self.layout.library(header) {
            let folder = &self.layout.libraries[index].headers;
            let is_new = self.found.insert(folder.into());
            if is_new {
                build.look_in(folder.clone());
                self.next.push_back(Found::Beside(index));
            }
            return Ok(is_new);
        }
        if let Some(library) = self.toolchain.library(header, &self.ours)? {
            let is_new = self.found.insert(library.include[0].clone());
            if is_new {
                build.look_in_library(&library.include);
                self.next.push_back(Found::Installed(library));
            }
            return Ok(is_new);
        }
        let beside = beside(by, header);
        let (place, real) = if let Some(own) = self.own_spelling(&beside) {
            // From there up to the sketch's folder: a project of PlatformIO does not look for headers in that.
            let up = "../".repeat(beside.matches('/').count());
            (beside, format!("\"{up}{own}\""))
        } else if let Some(real) = self.other_spelling(header) {
            if self.found.insert(SPELLED.into()) {
                build.look_in(SPELLED.to_owned());
            }
            (format!("{SPELLED}/{header}"), format!("<{real}>"))
        } else {
            return Ok(false);
        };
        let is_new = self.found.insert(PathBuf::from(&place));
        if is_new {
            let text = format!("#include {real}\n");
            build.put(SKETCH, &place, text.as_bytes())?;
        }
        Ok(is_new)
    }

    /// How a file of the sketch is spelled where there is one.
    fn own_spelling(&self, name: &str) -> Option<String> {
        let mut own = self.source.files.keys();
        own.find(|own| own.eq_ignore_ascii_case(name)).cloned()
    }

    /// How a header is spelled where there is one: on Windows and macOS `servo.h` is `Servo.h`, and many sketches are
    /// from there.
    fn other_spelling(&self, header: &str) -> Option<String> {
        let own = self.own_spelling(header);
        let core = || spelled(&self.toolchain.core.join("cores/arduino"), header);
        own.or_else(core).or_else(|| self.toolchain.spelled(header))
    }
}

/// Where a header is, in the sketch, that a file of the sketch includes from its own folder.
fn beside(by: &str, header: &str) -> String {
    let folder = by.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(header.split('/')) {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

/// The files of the installed libraries that a sketch mentions, and of those that they mention.
pub(crate) fn mentioned(
    toolchain: &Toolchain,
    ours: &Path,
    source: &Source,
    layout: &Layout<'_>,
) -> Result<Vec<PathBuf>, SketchError> {
    let (mut all, mut next) = (BTreeSet::new(), Vec::new());
    let mut note = |bytes: &[u8], next: &mut Vec<String>| {
        let text = String::from_utf8_lossy(bytes);
        for name in preprocess::includes(&text) {
            if !source.files.contains_key(name) && all.insert(name.to_owned()) {
                next.push(name.to_owned());
            }
        }
        match all.len() > MOST_HEADERS {
            true => Err(SketchError::Refused(format!(
                "the sketch includes more than {MOST_HEADERS} different headers"
            ))),
            false => Ok(()),
        }
    };
    for bytes in source.files.values() {
        note(bytes, &mut next)?;
    }
    let mut files = BTreeSet::new();
    while let Some(header) = next.pop() {
        if layout.library(&header).is_some() {
            continue;
        }
        let found = match toolchain.library(&header, ours)? {
            None => match toolchain.spelled(&header) {
                Some(real) => toolchain.library(&real, ours)?,
                None => None,
            },
            found => found,
        };
        for file in found.into_iter().flat_map(|library| library.files) {
            if !files.contains(&file) {
                note(&read(&file)?, &mut next)?;
                files.insert(file);
            }
        }
    }
    Ok(files.into_iter().collect())
}
