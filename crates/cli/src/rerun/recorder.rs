//! What the program that recorded a log was, where it was not this one.

use rumbo_control::params::SCHEMA;
use rumbo_experiment::MODEL;
use rumbo_log::{Log, Manifest};
use rumbo_wire::PROTOCOL_VERSION;

/// The program that recorded, where it was not this one.
pub(super) struct Recorder {
    /// Which it was and which this is; empty where they are the same.
    pub(super) version: String,
    /// Which model of robot and world it had, where that was another one: then other metrics are expected.
    pub(super) model: Option<String>,
    /// What the robot's table of parameters was and is now, where they differ: then nothing else can be the same.
    pub(super) table: Option<String>,
    /// The protocol that the robot spoke, where it was another one: then it said the same in other bytes, at other
    /// instants.
    pub(super) protocol: Option<u8>,
}

impl Recorder {
    pub(super) fn of(log: &Log, recorded: &Manifest) -> Self {
        let here = env!("CARGO_PKG_VERSION");
        let version = match recorded.version == here {
            true => String::new(),
            false => format!("; recorded by version {}, this is {here}", recorded.version),
        };
        let model = (recorded.model != Some(MODEL)).then(|| {
            let number = recorded.model.map_or_else(
                || "before models had numbers".to_owned(),
                |number| format!("with model {number}"),
            );
            format!("recorded {number}, this is model {MODEL}: robot or world changed between them")
        });
        let hello = log.hello();
        let protocol = hello
            .map(|hello| hello.protocol)
            .filter(|protocol| *protocol != PROTOCOL_VERSION);
        let table = hello
            .filter(|_| recorded.program == "rumbo")
            .map(|hello| hello.schema)
            .filter(|table| *table != SCHEMA);
        let table = table.map(|table| {
            format!(
                "the robot had another table of parameters ({table:08x}, this program's is {SCHEMA:08x}); run it again with the program that \
                 recorded it"
            )
        });
        Self {
            version,
            model,
            table,
            protocol,
        }
    }

    /// Text before a difference; empty where the model is the same.
    pub(super) fn model_words(&self) -> String {
        self.model
            .as_ref()
            .map_or_else(String::new, |model| format!("{model}; "))
    }

    /// Why not all is compared; empty where it is.
    pub(super) fn protocol_words(&self) -> String {
        self.protocol.map_or_else(String::new, |protocol| {
            format!(
                "; the metrics alone are compared: the robot spoke protocol {protocol}, now {PROTOCOL_VERSION}, in other bytes at other instants"
            )
        })
    }
}
