//! Reads a scenario's file.

use super::fleet::read_fleet;
use super::{MetricBounds, ScenarioFile, SeedSpread, read_start};
use crate::files::commands::{MOST_COMMANDS, read_commands};
use crate::files::error::FileError;
use crate::files::faults::{MOST_FAULTS, read_sonar_faults, read_wire_faults};
use crate::files::names::read_mode;
use crate::files::parameters::read_parameters;
use crate::files::read::{Allowed, Source, Table};
use crate::files::robot::read_plant;
use rumbo_control::mode::ModeId;
use std::collections::BTreeMap;

const DURATION: Allowed = Allowed::new(0.1, 3600.0, "s");
const BOUND: Allowed = Allowed::new(-1e9, 1e9, "");

impl ScenarioFile {
    /// Reads a scenario. [`crate::files::Library::setup`] checks whether its robot, rig and world exist.
    ///
    /// # Errors
    /// All problems of the text, by line of `file`.
    pub fn parse(name: &str, file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(file, text);
        let parsed = source.parse()?;
        let root = source.root(&parsed);
        let given = read_mode(&root);
        let mode = if root.has("mode") {
            given
        } else {
            Some(ModeId::Manual)
        };
        root.require("duration_s", &DURATION.remedy());
        // A wrong one does not shorten anything else.
        let duration_s = root.number("duration_s", DURATION).unwrap_or(DURATION.max);
        let (commands, texts) =
            read_commands(root.tables("command", MOST_COMMANDS), mode, duration_s);
        let mut scenario = Self {
            name: name.into(),
            path: None,
            title: root
                .required_text("title", "one line that says what the experiment is")
                .value,
            group: root.text("group").map(|group| group.value),
            text: text.into(),
            robot: root
                .required_text("robot", "name of a robot, e.g. \"memoria\"")
                .value,
            rig: root.text("rig").map(|rig| rig.value).unwrap_or_default(),
            world: root
                .required_text("world", "name of a world, e.g. \"open\"")
                .value,
            policy: root.text("policy").map(|policy| policy.value),
            mode: mode.unwrap_or_default(),
            has_mode: root.has("mode"),
            duration_s,
            start: read_start(&root.table("start")),
            wheels_in_air: root.flag("wheels_in_air").is_some_and(|flag| flag.value),
            calibrated: root.flag("calibrated").is_some_and(|flag| flag.value),
            commands,
            texts,
            sonar_faults: read_sonar_faults(root.tables("sonar_fault", MOST_FAULTS), duration_s),
            wire_faults: read_wire_faults(root.tables("wire_fault", MOST_FAULTS), duration_s),
            limits: read_limits(&root.table("limits"), ""),
            parameters: read_parameters(&root.table("parameters")),
            spread: read_spread(&root.table("spread")),
            plant: read_plant(&root.table("plant"), ""),
            fleet: Vec::new(),
        };
        scenario.fleet = read_fleet(&root, &scenario);
        root.finish();
        source.verdict()?;
        Ok(scenario)
    }
}

fn read_spread(table: &Table<'_, '_>) -> SeedSpread {
    let none = table.flag("none").is_some_and(|flag| flag.value);
    table.finish();
    if none {
        SeedSpread::None
    } else {
        SeedSpread::Drawn
    }
}

/// Limits by metric. A dot in a metric's name may be quoted or not: TOML then nests, and the names are joined again.
fn read_limits(table: &Table<'_, '_>, prefix: &str) -> BTreeMap<String, MetricBounds> {
    let mut limits = BTreeMap::new();
    for key in table.keys() {
        let metric = format!("{prefix}{}", key.value);
        let below = table.table(key.value);
        if !below.has("min")
            && !below.has("max")
            && below
                .keys()
                .iter()
                .any(|inner| below.holds_table(inner.value))
        {
            limits.extend(read_limits(&below, &format!("{metric}.")));
            continue;
        }
        limits.insert(metric, read_bounds(table, key.value));
    }
    limits
}

/// The limits below a key, `{ min = 1, max = 2 }`, of which one may be missing.
pub(crate) fn read_bounds(table: &Table<'_, '_>, key: &str) -> MetricBounds {
    let below = table.table(key);
    let bounds = MetricBounds {
        min: below.number("min", BOUND),
        max: below.number("max", BOUND),
    };
    if below.keys().is_empty() && table.holds_table(key) {
        below.complain_here("has neither min nor max: write e.g. { max = 2.4 }");
    }
    if let MetricBounds {
        min: Some(min),
        max: Some(max),
    } = bounds
        && min > max
    {
        below.complain_here(&format!("min {min} is above max {max}: nothing could pass"));
    }
    below.finish();
    bounds
}
