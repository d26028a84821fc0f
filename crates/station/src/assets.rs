//! The dashboard's files, built into the program. Only these are served: no path of a request is ever opened.

use include_dir::{Dir, include_dir};

/// What the page itself is.
pub(crate) const HTML: &str = "text/html; charset=utf-8";

/// A file as it is served.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asset {
    pub(crate) mime: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// The page's modules, and the lessons in Markdown.
static MODULES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../web/src");
static LESSONS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../docs/lessons");

macro_rules! files {
    ($($path:literal),* $(,)?) => {
        [$((concat!("/", $path), include_bytes!(concat!("../../../web/", $path)).as_slice())),*]
    };
}

/// All others.
static FILES: [(&str, &[u8]); 8] = files![
    "index.html",
    "style.css",
    "icon.svg",
    "vendor/codemirror/codemirror.js",
    "vendor/codemirror/LICENSE",
    "vendor/uplot/uPlot.js",
    "vendor/uplot/uPlot.css",
    "vendor/uplot/LICENSE",
];

/// The file for the path of a request.
pub(crate) fn find(path: &str) -> Option<Asset> {
    let path = if path == "/" { "/index.html" } else { path };
    let within = |folder: &'static Dir<'_>, at: &str| {
        let file = folder.get_file(path.strip_prefix(at)?)?;
        Some(file.contents())
    };
    let listed = FILES.iter().find(|(own, _)| *own == path);
    let bytes = listed
        .map(|(_, bytes)| *bytes)
        .or_else(|| within(&MODULES, "/src/"))
        .or_else(|| within(&LESSONS, "/lessons/"))?;
    let mime = match path.rsplit(['.', '/']).next()? {
        "html" => HTML,
        "css" => "text/css; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "svg" => "image/svg+xml",
        _ => "text/plain; charset=utf-8",
    };
    Some(Asset { mime, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_lessons_and_licences_are_served_as_what_they_are() {
        for (path, mime) in [
            ("/", "text/html"),
            ("/src/main.js", "text/javascript"),
            ("/src/spanish/page.js", "text/javascript"),
            ("/vendor/uplot/uPlot.css", "text/css"),
            ("/vendor/uplot/LICENSE", "text/plain"),
            ("/lessons/en/README.md", "text/plain"),
            ("/lessons/es/7-line.md", "text/plain"),
        ] {
            let asset = find(path).expect(path);
            assert!(asset.mime.starts_with(mime), "{path}: {}", asset.mime);
            assert!(!asset.bytes.is_empty(), "{path}");
        }
    }

    #[test]
    fn a_path_outside_the_list_is_nothing() {
        for path in [
            "/../Cargo.toml",
            "/package.json",
            "/src/../index.html",
            "//index.html",
            "",
        ] {
            assert!(find(path).is_none(), "{path}");
        }
    }
}
