//! What ran: enough to run it again.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How a log came about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogKind {
    /// A session with the simulated robot, as fast as the wall clock.
    #[default]
    Lab,
    /// A scenario without a window.
    Run,
    /// A robot behind a link.
    Robot,
    /// The calibration of a simulated robot, without a window.
    Calibration,
    /// A simulated robot that a caller stepped: a program in Python.
    Episode,
}

/// The program of a log that `rumbo import` made of another program's table or bag.
pub const ANOTHER: &str = "another";

/// What ran. Files are attached to the log under the names given here.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Manifest {
    /// How the log came about.
    pub kind: LogKind,
    /// Version of Rumbo that wrote it.
    pub version: String,
    /// Number of the model of robot and world that a simulated run was made with; `None` of a real robot, and of logs
    /// before models had numbers.
    pub model: Option<u32>,
    /// When it began, UTC; `None` for runs without a window that go to a folder of one's own: those logs depend on
    /// nothing but their inputs.
    pub started: Option<String>,
    /// Name of the scenario.
    pub scenario: Option<String>,
    /// Name of the robot.
    pub robot: Option<String>,
    /// Name of the one of several robots in the world that the log is of.
    pub member: Option<String>,
    /// Name of the world.
    pub world: Option<String>,
    /// Name of the rig.
    pub rig: Option<String>,
    /// Name of the wiring, where a firmware image was asked to use one.
    pub wiring: Option<String>,
    /// Name of the policy, where another one than the scenario's was asked for.
    pub policy: Option<String>,
    /// The program at the pins: `rumbo`, `baseline`, `original` on a real robot, [`ANOTHER`], or the file of an image.
    pub program: String,
    /// Hash of the image that ran on the emulated Mega, or that the robot named in HELLO.
    pub image: Option<String>,
    /// Seed of everything random.
    pub seed: Option<u64>,
    /// How long the run was to last, where that is not what its scenario says \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Parameters changed on the command line, in their order.
    pub parameters: Vec<(String, f64)>,
    /// Lines of text sent besides the scenario's commands, with their times \[s\].
    pub texts: Vec<(f64, String)>,
    /// Lines typed on the USB port of an emulated Mega, with their times \[s\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub usb_texts: Vec<(f64, String)>,
    /// What was done with buttons, switches and potentiometers, `name=value`, with its times \[s\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub part_texts: Vec<(f64, String)>,
    /// Where a hand put the robot, `robot=X Y HEADING` in m and rad, with its times \[s\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hand_texts: Vec<(f64, String)>,
    /// What was sent behind each of those lines, by name; LF where it is missing.
    pub line_ending: Option<String>,
    /// What the robot's EEPROM held at the start, as hexadecimal digits; `None` where it was erased.
    pub eeprom: Option<String>,
    /// The simulation advanced in steps of this length \[us\].
    pub step_us: u64,
    /// The port, where there was one.
    pub port: Option<String>,
    /// Speed of the link \[baud\].
    pub baud: u32,
    /// The files it was made of: `scenario`, `robot`, `world`, as text.
    #[serde(skip)]
    pub files: BTreeMap<String, String>,
}

impl Manifest {
    /// As the log's metadata has it: each field as JSON, texts as they are.
    pub(crate) fn to_metadata(&self) -> BTreeMap<String, String> {
        let Ok(serde_json::Value::Object(fields)) = serde_json::to_value(self) else {
            return BTreeMap::new();
        };
        fields
            .into_iter()
            .filter(|(_, value)| !value.is_null())
            .map(|(key, value)| match value {
                serde_json::Value::String(text) => (key, text),
                other => (key, other.to_string()),
            })
            .collect()
    }

    /// What the log's metadata says; `None` where that is no manifest.
    pub(crate) fn from_metadata(metadata: &BTreeMap<String, String>) -> Option<Self> {
        const TEXTS: [&str; 15] = [
            "kind",
            "version",
            "started",
            "scenario",
            "robot",
            "member",
            "world",
            "rig",
            "wiring",
            "policy",
            "program",
            "image",
            "port",
            "eeprom",
            "line_ending",
        ];
        let fields = metadata.iter().map(|(key, text)| {
            let value = match TEXTS.contains(&key.as_str()) {
                true => serde_json::Value::String(text.clone()),
                false => serde_json::from_str(text).unwrap_or_default(),
            };
            (key.clone(), value)
        });
        serde_json::from_value(serde_json::Value::Object(fields.collect())).ok()
    }

    /// Notes what the robot's EEPROM holds at the start.
    pub fn remember(&mut self, memory: &[u8]) {
        let used = memory.iter().rposition(|byte| *byte != 0xFF);
        self.eeprom = used.map(|last| {
            let bytes = memory.iter().take(last + 1);
            bytes.map(|byte| format!("{byte:02x}")).collect()
        });
    }

    /// What it held.
    pub fn memory(&self) -> Vec<u8> {
        let digits = self.eeprom.as_deref().unwrap_or_default().as_bytes();
        let digit = |digit: u8| (digit as char).to_digit(16).unwrap_or(0);
        let byte = |two: &[u8]| two.iter().fold(0, |byte, one| byte << 4 | digit(*one));
        digits
            .chunks(2)
            .map(|two| (byte(two) & 0xFF) as u8)
            .collect()
    }

    /// The name of its log, without the ending: when, what, which seed, which of several robots.
    #[must_use]
    pub fn stem(&self) -> String {
        let when = self.started.as_ref().map(|started| {
            started
                .replace(['-', ':'], "")
                .replace('T', "-")
                .replace('Z', "")
        });
        let what = self.scenario.clone().unwrap_or_else(|| match self.kind {
            LogKind::Robot => "robot".into(),
            LogKind::Lab | LogKind::Run => "run".into(),
            LogKind::Calibration => "calibration".into(),
            LogKind::Episode => "episode".into(),
        });
        let seed = self.seed.map(|seed| seed.to_string());
        let parts = [when, Some(what), seed, self.member.clone()];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        parts.join("-")
    }
}

/// How a run ended: its metrics against the scenario's limits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// No limit was missed.
    pub pass: bool,
    /// All metrics, units in the names; not a number where what is measured did not happen.
    pub metrics: BTreeMap<String, f64>,
    /// Why it did not pass, a line each.
    pub failures: Vec<String>,
}

impl Outcome {
    pub(crate) fn to_metadata(&self) -> BTreeMap<String, String> {
        let metric = |(name, value): (&String, &f64)| (format!("metric.{name}"), value.to_string());
        let mut metadata: BTreeMap<String, String> = self.metrics.iter().map(metric).collect();
        metadata.insert("passed".into(), self.pass.to_string());
        metadata.insert("failures".into(), self.failures.join("\n"));
        metadata
    }

    pub(crate) fn from_metadata(metadata: &BTreeMap<String, String>) -> Self {
        let failures = metadata
            .get("failures")
            .map(String::as_str)
            .unwrap_or_default();
        Self {
            pass: metadata.get("passed").is_some_and(|pass| pass == "true"),
            metrics: metadata
                .iter()
                .filter_map(|(name, value)| {
                    Some((name.strip_prefix("metric.")?.into(), value.parse().ok()?))
                })
                .collect(),
            failures: failures.lines().map(str::to_owned).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_and_an_outcome_survive_the_way_through_metadata() {
        let manifest = Manifest {
            kind: LogKind::Run,
            version: "1".into(),
            scenario: Some("7".into()),
            seed: Some(u64::MAX),
            model: Some(2),
            parameters: vec![("kv".into(), 0.03)],
            texts: vec![(1.5, "ON".into())],
            step_us: 10_000,
            ..Manifest::default()
        };
        let mut manifest = manifest;
        manifest.remember(&[0x01, 0xFF, 0xA9, 0xFF, 0xFF]);
        assert_eq!(manifest.memory(), [0x01, 0xFF, 0xA9]);
        assert_eq!(
            Manifest::from_metadata(&manifest.to_metadata()),
            Some(manifest)
        );
        let outcome = Outcome {
            pass: false,
            metrics: [("a_s".to_owned(), 0.1 + 0.2), ("b".to_owned(), 1e-300)].into(),
            failures: vec!["one".into(), "two".into()],
        };
        assert_eq!(Outcome::from_metadata(&outcome.to_metadata()), outcome);
    }
}
