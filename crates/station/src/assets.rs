//! The dashboard's files, built into the program. Only these are served: no path of a request is ever opened.

/// A file as it is served.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asset {
    pub(crate) path: &'static str,
    pub(crate) mime: &'static str,
    pub(crate) bytes: &'static [u8],
}

macro_rules! assets {
    ($($path:literal: $mime:expr),* $(,)?) => {
        &[$(Asset { path: concat!("/", $path), mime: $mime, bytes: include_bytes!(concat!("../../../web/", $path)) }),*]
    };
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";
const TEXT: &str = "text/plain; charset=utf-8";

/// All files.
pub(crate) const ASSETS: &[Asset] = assets![
    "index.html": HTML,
    "style.css": CSS,
    "icon.svg": SVG,
    "src/alarm.js": SCRIPT,
    "src/band.js": SCRIPT,
    "src/boot.js": SCRIPT,
    "src/calibration_dialog.js": SCRIPT,
    "src/checkup.js": SCRIPT,
    "src/checkup_dialog.js": SCRIPT,
    "src/code_editor.js": SCRIPT,
    "src/code_panel.js": SCRIPT,
    "src/comparison.js": SCRIPT,
    "src/computed.js": SCRIPT,
    "src/consoles.js": SCRIPT,
    "src/curves.js": SCRIPT,
    "src/debugger.js": SCRIPT,
    "src/decimal.js": SCRIPT,
    "src/diagram.js": SCRIPT,
    "src/dialog.js": SCRIPT,
    "src/displays.js": SCRIPT,
    "src/dom.js": SCRIPT,
    "src/enlarge.js": SCRIPT,
    "src/events.js": SCRIPT,
    "src/experiment.js": SCRIPT,
    "src/flash_form.js": SCRIPT,
    "src/gamepad.js": SCRIPT,
    "src/geometry.js": SCRIPT,
    "src/hand.js": SCRIPT,
    "src/hand_in.js": SCRIPT,
    "src/header.js": SCRIPT,
    "src/help.js": SCRIPT,
    "src/joystick.js": SCRIPT,
    "src/kept.js": SCRIPT,
    "src/kept_store.js": SCRIPT,
    "src/key.js": SCRIPT,
    "src/law.js": SCRIPT,
    "src/law_panel.js": SCRIPT,
    "src/layout.js": SCRIPT,
    "src/layout_dialog.js": SCRIPT,
    "src/lessons.js": SCRIPT,
    "src/light.js": SCRIPT,
    "src/link.js": SCRIPT,
    "src/linkmeter.js": SCRIPT,
    "src/machine.js": SCRIPT,
    "src/main.js": SCRIPT,
    "src/map.js": SCRIPT,
    "src/markdown.js": SCRIPT,
    "src/mounts.js": SCRIPT,
    "src/movements.js": SCRIPT,
    "src/movers.js": SCRIPT,
    "src/notice.js": SCRIPT,
    "src/overlay.js": SCRIPT,
    "src/panel.js": SCRIPT,
    "src/parameters.js": SCRIPT,
    "src/parts.js": SCRIPT,
    "src/picture.js": SCRIPT,
    "src/places.js": SCRIPT,
    "src/plot.js": SCRIPT,
    "src/plot_dialog.js": SCRIPT,
    "src/plots.js": SCRIPT,
    "src/profile.js": SCRIPT,
    "src/program.js": SCRIPT,
    "src/readings.js": SCRIPT,
    "src/recordings.js": SCRIPT,
    "src/replay.js": SCRIPT,
    "src/report_dialog.js": SCRIPT,
    "src/response.js": SCRIPT,
    "src/robot_port.js": SCRIPT,
    "src/robots.js": SCRIPT,
    "src/row.js": SCRIPT,
    "src/run_link.js": SCRIPT,
    "src/runs.js": SCRIPT,
    "src/seat.js": SCRIPT,
    "src/serial_ports.js": SCRIPT,
    "src/share.js": SCRIPT,
    "src/signals.js": SCRIPT,
    "src/site.js": SCRIPT,
    "src/sketch.js": SCRIPT,
    "src/source.js": SCRIPT,
    "src/spanish/code.js": SCRIPT,
    "src/spanish/files.js": SCRIPT,
    "src/spanish/guide.js": SCRIPT,
    "src/spanish/page.js": SCRIPT,
    "src/spanish/parameters.js": SCRIPT,
    "src/spanish/program.js": SCRIPT,
    "src/spanish/robot.js": SCRIPT,
    "src/spanish/scenarios.js": SCRIPT,
    "src/spanish/wiring.js": SCRIPT,
    "src/stateline.js": SCRIPT,
    "src/steering.js": SCRIPT,
    "src/step.js": SCRIPT,
    "src/store.js": SCRIPT,
    "src/stored.js": SCRIPT,
    "src/table.js": SCRIPT,
    "src/tabs.js": SCRIPT,
    "src/text.js": SCRIPT,
    "src/theme.js": SCRIPT,
    "src/timeline.js": SCRIPT,
    "src/touch.js": SCRIPT,
    "src/tour.js": SCRIPT,
    "src/types.js": SCRIPT,
    "src/tune_dialog.js": SCRIPT,
    "src/tune_search.js": SCRIPT,
    "src/tune_tables.js": SCRIPT,
    "src/units.js": SCRIPT,
    "src/value_field.js": SCRIPT,
    "src/video.js": SCRIPT,
    "src/why.js": SCRIPT,
    "src/wire_dialog.js": SCRIPT,
    "src/wiring.js": SCRIPT,
    "src/worker_link.js": SCRIPT,
    "src/world_editor.js": SCRIPT,
    "src/world_shapes.js": SCRIPT,
    "vendor/codemirror/codemirror.js": SCRIPT,
    "vendor/codemirror/LICENSE": TEXT,
    "vendor/uplot/uPlot.js": SCRIPT,
    "vendor/uplot/uPlot.css": CSS,
    "vendor/uplot/LICENSE": TEXT,
];

macro_rules! lessons {
    ($($language:literal: $($name:literal),*);*) => {
        &[$($(Asset {
            path: concat!("/lessons/", $language, "/", $name),
            mime: TEXT,
            bytes: include_bytes!(concat!("../../../docs/lessons/", $language, "/", $name)),
        }),*),*]
    };
}

/// The lessons, in Markdown.
const LESSONS: &[Asset] = lessons![
    "en": "README.md", "0-first-drive.md", "1-wheel-speed.md", "2-front-distance.md", "3-wall-follow.md", "4-odometry.md",
        "5-lying-sensor.md", "6-obstacles.md", "7-line.md";
    "es": "README.md", "0-first-drive.md", "1-wheel-speed.md", "2-front-distance.md", "3-wall-follow.md", "4-odometry.md",
        "5-lying-sensor.md", "6-obstacles.md", "7-line.md"
];

/// The file for the path of a request.
pub(crate) fn find(path: &str) -> Option<&'static Asset> {
    let path = if path == "/" { "/index.html" } else { path };
    ASSETS
        .iter()
        .chain(LESSONS)
        .find(|asset| asset.path == path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_module_of_the_dashboard_is_served() {
        let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web");
        for folder in ["src", "src/spanish"] {
            for module in std::fs::read_dir(web.join(folder)).unwrap() {
                let name = module.unwrap().file_name().into_string().unwrap();
                let served = find(&format!("/{folder}/{name}")).is_some();
                assert!(
                    served || !name.ends_with(".js"),
                    "{folder}/{name} is missing in ASSETS"
                );
            }
        }
    }

    #[test]
    fn every_lesson_is_served_in_both_languages() {
        let lessons = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/lessons");
        for language in ["en", "es"] {
            for lesson in std::fs::read_dir(lessons.join(language)).unwrap() {
                let name = lesson.unwrap().file_name().into_string().unwrap();
                let served = find(&format!("/lessons/{language}/{name}"));
                assert!(served.is_some(), "{language}/{name} is missing in LESSONS");
            }
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
