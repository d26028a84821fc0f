//! A running `rumbo lab` as an external process: its address, its page, its telemetry, and its end.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use serde_json::Value;

/// Longest wait for the lab to print its address, and for any of its answers.
const PATIENCE: Duration = Duration::from_secs(20);

/// A lab on a free port without a browser; stopped when dropped.
pub(crate) struct Lab {
    child: Child,
    /// The address it printed, with its one-time token.
    url: String,
    /// The key that replaced the token when the page was fetched.
    key: Option<String>,
}

impl Lab {
    /// Starts `command` with `--no-browser --port 0` and a folder for logs added and waits for the address it prints.
    pub(crate) fn start(command: Command) -> Result<Self, String> {
        // Keeps it out of the developer's own logs.
        Self::start_in(command, &std::env::temp_dir().join("rumbo-xtask-logs"))
    }

    /// The same with this folder for logs.
    pub(crate) fn start_in(mut command: Command, logs: &Path) -> Result<Self, String> {
        command.arg("--out").arg(logs);
        Self::listen(command)
    }

    fn listen(mut command: Command) -> Result<Self, String> {
        command
            .args(["--no-browser", "--port", "0"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped());
        let mut child = command
            .spawn()
            .map_err(|error| format!("cannot start the lab: {error}"))?;
        let stdout = child.stdout.take();
        let mut lab = Self {
            child,
            url: String::new(),
            key: None,
        };
        let (send, receive) = mpsc::channel();
        // The reader lives as long as the lab, so that the lab never writes to a closed pipe.
        std::thread::spawn(move || {
            for line in stdout
                .into_iter()
                .flat_map(|stdout| BufReader::new(stdout).lines())
                .map_while(Result::ok)
            {
                if let Some(start) = line.find("http://") {
                    let url = line[start..].split_whitespace().next().unwrap_or_default();
                    let _ = send.send(url.to_owned());
                }
            }
        });
        lab.url = receive
            .recv_timeout(PATIENCE)
            .map_err(|_| format!("the lab printed no address within {} s", PATIENCE.as_secs()))?;
        Ok(lab)
    }

    /// Starts `command`, which records nothing, with `--no-browser --port 0` added and waits for the address it prints.
    pub(crate) fn start_plain(command: Command) -> Result<Self, String> {
        Self::listen(command)
    }

    /// Opens the dashboard as a page does.
    pub(crate) fn open(&mut self) -> Result<Page, String> {
        Ok(Page(self.socket()?))
    }

    /// Asks it to end, as Ctrl-C does, and waits until it has.
    pub(crate) fn end(mut self) -> Result<(), String> {
        let pid = self.pid().to_string();
        crate::project::run(Command::new("kill").args(["-TERM", &pid]))?;
        self.child
            .wait()
            .map(drop)
            .map_err(|error| error.to_string())
    }

    /// Its process number.
    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// The address it printed, for a browser.
    pub(crate) fn url(&self) -> &str {
        &self.url
    }

    /// Fetches the page as a browser would, and once its key.
    pub(crate) fn page(&mut self) -> Result<String, String> {
        if self.key.is_none() {
            let query = self.url.split_once('?').map_or("", |(_, query)| query);
            self.key = Some(self.ask("POST", &format!("/key?{query}"))?);
        }
        self.ask("GET", "/")
    }

    /// Opens the dashboard's WebSocket.
    pub(crate) fn socket(&mut self) -> Result<tungstenite::WebSocket<TcpStream>, String> {
        self.page()?;
        let host = self.host()?;
        let address = format!("ws://{host}/ws");
        let uri = address
            .parse()
            .map_err(|error| format!("{address}: {error}"))?;
        let request = tungstenite::ClientRequestBuilder::new(uri)
            .with_header("Origin", format!("http://{host}"))
            .with_sub_protocol("rumbo")
            .with_sub_protocol(self.key.as_deref().unwrap_or_default());
        let (socket, _) = tungstenite::client(request, self.connect()?)
            .map_err(|error| format!("{address}: {error}"))?;
        Ok(socket)
    }

    /// The body of the answer to a request of the page.
    fn ask(&self, method: &str, path: &str) -> Result<String, String> {
        let host = self.host()?;
        let request = format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nAuthorization: Bearer xtask\r\nConnection: close\r\n\r\n"
        );
        let mut stream = self.connect()?;
        let mut bytes = Vec::new();
        stream
            .write_all(request.as_bytes())
            .and_then(|()| stream.read_to_end(&mut bytes))
            .map_err(|error| format!("{method} {path}: {error}"))?;
        let answer = String::from_utf8_lossy(&bytes);
        let (status, body) =
            parse(&answer).ok_or_else(|| format!("{method} {path}: not an HTTP answer"))?;
        match status {
            200 => Ok(body.to_owned()),
            _ => Err(format!("{method} {path}: status {status}: {}", body.trim())),
        }
    }

    fn connect(&self) -> Result<TcpStream, String> {
        let host = self.host()?;
        let connect = || {
            let stream = TcpStream::connect(host)?;
            stream.set_read_timeout(Some(PATIENCE))?;
            Ok(stream)
        };
        connect().map_err(|error: std::io::Error| format!("{host}: {error}"))
    }

    /// `address:port`.
    fn host(&self) -> Result<&str, String> {
        self.url
            .split('/')
            .nth(2)
            .ok_or_else(|| format!("`{}` is not an address", self.url))
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A page's WebSocket.
pub(crate) struct Page(tungstenite::WebSocket<TcpStream>);

impl Page {
    /// Sends an order.
    pub(crate) fn send(&mut self, order: &Value) -> Result<(), String> {
        let message = tungstenite::Message::text(order.to_string());
        self.0
            .send(message)
            .map_err(|error| format!("WebSocket: {error}"))
    }

    /// The next message.
    pub(crate) fn read(&mut self) -> Result<Value, String> {
        let message = self
            .0
            .read()
            .map_err(|error| format!("WebSocket: {error}"))?;
        let text = message
            .to_text()
            .map_err(|error| format!("WebSocket: {error}"))?;
        // A ping has no text.
        Ok(serde_json::from_str(text).unwrap_or_default())
    }
}

/// Status and body of an HTTP answer.
fn parse(answer: &str) -> Option<(u16, &str)> {
    let (head, body) = answer.split_once("\r\n\r\n")?;
    let status = head.lines().next()?.split(' ').nth(1)?;
    Some((status.parse().ok()?, body))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_has_a_status_and_a_body_and_something_else_has_not() {
        let answer = "HTTP/1.1 403 Forbidden\r\ncontent-length: 4\r\n\r\nbody";
        assert_eq!(parse(answer), Some((403, "body")));
        assert_eq!(parse("hello"), None);
    }
}
