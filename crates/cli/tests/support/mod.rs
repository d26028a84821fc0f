//! Programs under test: started, their output read, and a page on their dashboard.
#![allow(dead_code, reason = "not every test needs all of it")]

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// Long enough for any machine; nothing is judged by it.
const PATIENCE: Duration = Duration::from_secs(60);

/// The full check, not the gate: all cases.
pub(crate) fn is_full() -> bool {
    std::env::var_os("RUMBO_FULL").is_some()
}

/// The folder of this test run.
pub(crate) fn folder() -> PathBuf {
    env!("CARGO_TARGET_TMPDIR").into()
}

/// A file in it, by its name.
pub(crate) fn file(name: &str, text: &str) -> PathBuf {
    let path = folder().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// `rumbo`, with its logs and keys kept out of the developer's own.
pub(crate) fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rumbo"));
    command.env("RUMBO_LOGS", folder().join("logs"));
    command.env("XDG_RUNTIME_DIR", folder());
    command
}

/// Runs it in the folder of this test run, to its end.
pub(crate) fn rumbo(arguments: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(folder()).args(arguments);
    command.output().unwrap()
}

/// The same in a folder of the test's own, which also has its logs.
pub(crate) fn rumbo_in(folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    let folder = folder.as_ref();
    let mut command = program();
    command.env("RUMBO_LOGS", folder.join("logs"));
    command.current_dir(folder).args(arguments);
    command.output().unwrap()
}

/// The only file of a folder.
pub(crate) fn only_file(folder: &Path) -> PathBuf {
    let files = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    assert_eq!(files.len(), 1, "{files:?}");
    files.remove(0)
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A `rumbo` that runs until it is dropped, and the first line that it printed.
pub(crate) struct Running {
    child: Child,
    pub(crate) said: String,
}

impl Running {
    pub(crate) fn start(arguments: &[&str]) -> Self {
        Self::of(program().args(arguments))
    }

    pub(crate) fn of(command: &mut Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut line)
            .unwrap();
        Self {
            child,
            said: line.trim().to_owned(),
        }
    }

    /// Asks it to end, as Ctrl-C does, and waits.
    pub(crate) fn end(self) {
        self.end_by("-TERM");
    }

    /// The same by this signal.
    pub(crate) fn end_by(mut self, signal: &str) {
        let process = self.child.id().to_string();
        let asked = Command::new("kill").args([signal, &process]).status();
        assert!(asked.unwrap().success());
        assert_eq!(self.child.wait().unwrap().code(), Some(0));
    }

    /// It has not ended by itself.
    pub(crate) fn is_alive(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A page on the dashboard whose address was printed.
pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    host: String,
    key: String,
}

impl Page {
    pub(crate) fn open(address: &str) -> Self {
        let host = address.split('/').nth(2).unwrap();
        let query = address.split_once('?').unwrap().1;
        let mut stream = TcpStream::connect(host).unwrap();
        write!(
            stream,
            "POST /key?{query} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nAuthorization: Bearer test\r\nConnection: close\r\n\r\n"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (_, key) = answer.split_once("\r\n\r\n").unwrap();
        Self::at(host, "/ws", key)
    }

    pub(crate) fn at(host: &str, path: &str, key: &str) -> Self {
        let uri = format!("ws://{host}{path}").parse().unwrap();
        let request = tungstenite::ClientRequestBuilder::new(uri)
            .with_header("Origin", format!("http://{host}"))
            .with_sub_protocol("rumbo")
            .with_sub_protocol(key);
        let stream = TcpStream::connect(host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        Self {
            socket: tungstenite::client(request, stream).unwrap().0,
            host: host.to_owned(),
            key: key.to_owned(),
        }
    }

    /// Another WebSocket of this page, at this path.
    pub(crate) fn beside(&self, path: &str) -> Self {
        Self::at(&self.host, path, &self.key)
    }

    pub(crate) fn send(&mut self, order: &Value) {
        self.socket.send(Message::text(order.to_string())).unwrap();
    }

    /// Reads on until `wanted` finds what it looks for.
    pub(crate) fn wait_for<T>(
        &mut self,
        what: &str,
        mut wanted: impl FnMut(&Value) -> Option<T>,
    ) -> T {
        let until = Instant::now() + PATIENCE;
        let mut events = Vec::new();
        while Instant::now() < until {
            let Message::Text(text) = self.socket.read().unwrap() else {
                continue;
            };
            let message: Value = serde_json::from_str(&text).unwrap();
            if let Some(found) = wanted(&message) {
                return found;
            }
            let listed = message["events"].as_array().into_iter().flatten();
            events.extend(listed.map(|event| event["text"].to_string()));
        }
        panic!("no {what}; events: {events:#?}");
    }

    /// Reads on until an event contains this.
    pub(crate) fn wait_for_event(&mut self, part: &str) {
        self.wait_for(part, |message| {
            let mut events = message["events"].as_array()?.iter();
            events.find(|event| {
                event["text"]
                    .as_str()
                    .is_some_and(|text| text.contains(part))
            })?;
            Some(())
        });
    }
}

/// The answer to a request, whole.
pub(crate) fn get(host: &str, path: &str) -> String {
    let mut stream = TcpStream::connect(host).unwrap();
    write!(
        stream,
        "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
    )
    .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// An image of `cargo xtask sketches`; `None` where they have not been built.
pub(crate) fn sketch(name: &str) -> Option<PathBuf> {
    let target = PathBuf::from(env!("CARGO_BIN_EXE_rumbo"));
    let path = target
        .parent()?
        .parent()?
        .join(format!("sketches/{name}.elf"));
    if path.is_file() {
        return Some(path);
    }
    let remedy = format!("{} is missing: run `cargo xtask sketches`", path.display());
    assert!(std::env::var_os("CI").is_none(), "{remedy}");
    eprintln!("not checked: {remedy}");
    None
}
