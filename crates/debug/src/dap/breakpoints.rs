//! Breakpoints as a client sets them: all of a kind, or of a file, at a time.

use super::inspect::source;
use super::message::{Arguments, Breakpoints, LineRange, Source, Wanted};
use super::{Adapter, LaunchHost};
use crate::control::{Breakpoint, DataBreakpoint};
use serde_json::{Value, json};
use std::path::Path;

impl<H: LaunchHost> Adapter<H> {
    pub(super) fn set_breakpoints(&mut self, set: &Breakpoints) -> Result<Value, String> {
        let first = self.lines_start_at;
        let name = path(&set.source)?.to_owned();
        let file = self.debugger()?.symbols.lines.file_named(Path::new(&name));
        let place = |adapter: &mut Self, wanted: &Wanted| {
            let symbols = &adapter.debugger()?.symbols;
            let Some(file) = file else {
                let found = symbols
                    .lines
                    .files
                    .iter()
                    .filter(|file| file.path.is_some());
                let found: Vec<_> = found.map(|file| &*file.name).take(10).collect();
                let found = found.join(", ");
                return Err(format!(
                    "{name} is no file of the program; it was compiled from {found}"
                ));
            };
            let line = u32::try_from(wanted.line - first + 1).unwrap_or(0);
            match symbols.stops_of_line(file, line) {
                (addresses, Some(line)) => {
                    let line = i64::from(line) - 1 + first;
                    Ok((addresses, json!({"line": line, "source": source(&symbols.lines.files[file])})))
                }
                _ => Err("there is no code from this line on: it is a comment, or was left out by the linker".into()),
            }
        };
        self.set_group(&format!("file {name}"), &set.breakpoints, place)
    }

    pub(super) fn set_function_breakpoints(&mut self, set: &Breakpoints) -> Result<Value, String> {
        self.set_group("functions", &set.breakpoints, |adapter, wanted| {
            let symbols = &adapter.debugger()?.symbols;
            let addresses: Vec<u32> =
                symbols.functions_named(&wanted.name).map(|function| symbols.body(function)).collect();
            match addresses.is_empty() {
                true => Err(format!(
                    "no function {} is in the program; it may be inlined, or left out since nothing calls it",
                    wanted.name
                )),
                false => Ok((addresses, json!({}))),
            }
        })
    }

    pub(super) fn set_instruction_breakpoints(
        &mut self,
        set: &Breakpoints,
    ) -> Result<Value, String> {
        self.set_group("instructions", &set.breakpoints, |adapter, wanted| {
            let address = address(&wanted.instruction_reference)? + wanted.offset;
            let bytes = adapter.debugger()?.chip().model().flash_bytes() as i64;
            match (0..bytes).contains(&address) && address % 2 == 0 {
                true => Ok((
                    vec![address as u32],
                    json!({"instructionReference": format!("0x{address:x}")}),
                )),
                false => Err(format!(
                    "0x{address:x} is no instruction: they are at even addresses of the flash"
                )),
            }
        })
    }

    /// Replaces a group: `place` finds the addresses of each, and what the client learns of them.
    fn set_group(
        &mut self,
        group: &str,
        wanted: &[Wanted],
        place: impl Fn(&mut Self, &Wanted) -> Result<(Vec<u32>, Value), String>,
    ) -> Result<Value, String> {
        let (mut set, mut shown) = (Vec::new(), Vec::new());
        for wanted in wanted {
            let id = self.number();
            let given = |text: &Option<String>| text.clone().filter(|text| !text.trim().is_empty());
            let hits = given(&wanted.hit_condition).map(|text| hits(&text));
            let hits = hits.transpose();
            match place(self, wanted).and_then(|placed| Ok((placed, hits?))) {
                Ok(((addresses, mut body), hits)) => {
                    body["id"] = json!(id);
                    body["verified"] = json!(true);
                    shown.push(body);
                    set.push(Breakpoint {
                        id,
                        group: group.to_owned(),
                        addresses,
                        condition: given(&wanted.condition),
                        hits: hits.unwrap_or(0),
                        log: given(&wanted.log_message),
                        reached: 0,
                    });
                }
                Err(message) => {
                    shown.push(json!({"id": id, "verified": false, "message": message}))
                }
            }
        }
        self.debugger()?.set_breakpoints(group, set);
        Ok(json!({"breakpoints": shown}))
    }

    /// The next breakpoint's number.
    fn number(&mut self) -> u64 {
        self.next_breakpoint += 1;
        self.next_breakpoint - 1
    }

    pub(super) fn breakpoint_locations(&mut self, lines: &LineRange) -> Result<Value, String> {
        let first = self.lines_start_at;
        let symbols = &self.debugger()?.symbols;
        let Some(file) = symbols.lines.file_named(Path::new(path(&lines.source)?)) else {
            return Ok(json!({"breakpoints": []}));
        };
        let range = lines.line..=lines.end_line.unwrap_or(lines.line);
        let all = symbols.lines.with_code(file).into_iter();
        let all = all.map(|line| i64::from(line) - 1 + first);
        let inside = all.filter(|line| range.contains(line));
        let inside: Vec<_> = inside.map(|line| json!({"line": line})).collect();
        Ok(json!({"breakpoints": inside}))
    }

    pub(super) fn data_breakpoint_info(&mut self, place: &Arguments) -> Result<Value, String> {
        let (frame, name) = self.named(place)?;
        Ok(match self.debugger()?.watched(&name, frame) {
            Ok((address, bytes)) => json!({
                "dataId": format!("0x{address:x}/{bytes}"), "description": name,
                "accessTypes": ["read", "write", "readWrite"],
            }),
            Err(error) => json!({"dataId": null, "description": error}),
        })
    }

    pub(super) fn set_data_breakpoints(&mut self, set: &Breakpoints) -> Result<Value, String> {
        let (mut data, mut shown) = (Vec::new(), Vec::new());
        for wanted in &set.breakpoints {
            let id = self.number();
            let parts = wanted.data_id.split_once('/');
            let place =
                parts.and_then(|(at, bytes)| Some((address(at).ok()? as u16, bytes.parse().ok()?)));
            let Some((address, bytes)) = place else {
                shown.push(json!({"id": id, "verified": false, "message": "not a variable of this program"}));
                continue;
            };
            let access = wanted.access_type.as_deref().unwrap_or("write");
            data.push(DataBreakpoint {
                id,
                address,
                bytes,
                reads: access != "write",
                writes: access != "read",
            });
            shown.push(json!({"id": id, "verified": true}));
        }
        self.debugger()?.set_data_breakpoints(data);
        Ok(json!({"breakpoints": shown}))
    }
}

fn path(source: &Source) -> Result<&str, String> {
    let path = source.path.as_deref().or(source.name.as_deref());
    path.ok_or_else(|| "the source has no path".into())
}

/// A number of a client: `0x1fa`.
pub(super) fn address(text: &str) -> Result<i64, String> {
    let digits = text.strip_prefix("0x").unwrap_or(text);
    i64::from_str_radix(digits, 16).map_err(|_| format!("{text} is no address"))
}

/// From which time on a breakpoint stops: `3`, `>= 3` or `> 2`.
fn hits(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let (more, digits) = match (text.strip_prefix(">="), text.strip_prefix('>')) {
        (Some(digits), _) => (0, digits),
        (None, Some(digits)) => (1, digits),
        (None, None) => (0, text),
    };
    let count: u64 = digits
        .trim()
        .parse()
        .map_err(|_| format!("hit count {text}: write a number, `>= 3` or `> 2`"))?;
    Ok(count + more)
}
