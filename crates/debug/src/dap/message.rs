//! Messages of the Debug Adapter Protocol: their frames, and the arguments of the requests that are understood.
//!
//! Source: <https://microsoft.github.io/debug-adapter-protocol/specification>, version 1.68.

use serde::Deserialize;
use serde_json::Value;

/// Longest message that is taken: a client's requests are short.
const LONGEST: usize = 4 << 20;
/// Longest header.
const LONGEST_HEADER: usize = 4 << 10;

/// A request.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Request {
    pub(crate) seq: i64,
    pub(crate) command: String,
    #[serde(default)]
    pub(crate) arguments: Value,
}

/// Bytes of a client, cut into requests.
#[derive(Debug, Default)]
pub(crate) struct Frames {
    bytes: Vec<u8>,
}

impl Frames {
    pub(crate) fn take(&mut self, bytes: &[u8]) {
        self.bytes.extend(bytes);
    }

    /// The next whole request; `Err`: the bytes are none, and nothing behind them can be understood.
    pub(crate) fn next(&mut self) -> Result<Option<Request>, String> {
        let Some(end) = self.bytes.windows(4).position(|four| four == b"\r\n\r\n") else {
            return match self.bytes.len() > LONGEST_HEADER {
                true => Err("no Content-Length: this is not the Debug Adapter Protocol".into()),
                false => Ok(None),
            };
        };
        let header = String::from_utf8_lossy(&self.bytes[..end]);
        let length = header.lines().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            name.eq_ignore_ascii_case("Content-Length")
                .then(|| value.trim().parse::<usize>().ok())?
        });
        let Some(length) = length.filter(|length| *length <= LONGEST) else {
            return Err(
                "no Content-Length of at most 4 MB: this is not the Debug Adapter Protocol".into(),
            );
        };
        let body = end + 4;
        if self.bytes.len() < body + length {
            return Ok(None);
        }
        let request = serde_json::from_slice(&self.bytes[body..body + length]);
        self.bytes.drain(..body + length);
        request
            .map(Some)
            .map_err(|error| format!("a message that is no request: {error}"))
    }
}

/// A message as it is sent.
pub(crate) fn framed(message: &Value) -> Vec<u8> {
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

/// What to debug: arguments of `launch`, which come before those of the command line.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Launch {
    /// Folder of a sketch, `.ino`, or image with debugging information.
    pub program: Option<String>,
    /// Scenario.
    pub scenario: Option<String>,
    /// Robot, in place of the scenario's.
    pub robot: Option<String>,
    /// World, in place of the scenario's.
    pub world: Option<String>,
    /// Wiring of the robot's board.
    pub wiring: Option<String>,
    /// Random seed.
    pub seed: Option<u64>,
    /// The program stands at its beginning.
    pub stop_on_entry: bool,
    /// The program as it runs otherwise, optimised.
    pub optimised: Option<bool>,
    /// Steps that begin in the program's own files end in them; `false`: in those of the core and of libraries too.
    pub just_my_code: Option<bool>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Source {
    pub(crate) path: Option<String>,
    pub(crate) name: Option<String>,
}

/// A breakpoint of any kind, as a client asks for it.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Wanted {
    pub(crate) line: i64,
    pub(crate) name: String,
    pub(crate) instruction_reference: String,
    pub(crate) offset: i64,
    pub(crate) condition: Option<String>,
    pub(crate) hit_condition: Option<String>,
    pub(crate) log_message: Option<String>,
    pub(crate) data_id: String,
    pub(crate) access_type: Option<String>,
}

/// Breakpoints of a kind; those of lines are of a source.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Breakpoints {
    pub(crate) source: Source,
    pub(crate) breakpoints: Vec<Wanted>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct LineRange {
    pub(crate) source: Source,
    pub(crate) line: i64,
    pub(crate) end_line: Option<i64>,
}

impl Arguments {
    /// What is typed for the program in place of an expression: behind a `>`.
    pub(crate) fn typed(&self) -> Option<&str> {
        let typed = self.expression.trim().strip_prefix('>');
        typed.filter(|_| self.context == "repl")
    }
}

/// Arguments of what is asked of a program that stands: of the stack, of variables by frame, reference and name, of steps.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Arguments {
    pub(crate) variables_reference: usize,
    pub(crate) frame_id: usize,
    pub(crate) name: String,
    pub(crate) value: String,
    pub(crate) expression: String,
    pub(crate) context: String,
    pub(crate) start: usize,
    pub(crate) count: usize,
    pub(crate) start_frame: usize,
    pub(crate) levels: usize,
    pub(crate) granularity: String,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Disassemble {
    pub(crate) memory_reference: String,
    #[serde(default)]
    pub(crate) offset: i64,
    #[serde(default)]
    pub(crate) instruction_offset: i64,
    pub(crate) instruction_count: usize,
}
