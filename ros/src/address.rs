//! Where a station is, how to get in, and why not.
//!
//! Anybody who drives the robot needs a key. `rumbo` leaves it in a file that only its user can read, by the port of the
//! dashboard; from elsewhere the address that it prints has a token, for which the station gives the key once.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;
use thiserror::Error;
use tungstenite::handshake::HandshakeError;
use tungstenite::handshake::client::{Response, generate_key};
use tungstenite::http::Request;
use tungstenite::{Error, WebSocket, client::client};

/// The port of the dashboard unless another is asked for.
const DEFAULT_PORT: u16 = 8360;
/// A station answers within this time.
const ANSWERS: Duration = Duration::from_secs(5);
/// One that sends nothing for so long, not even a ping, is gone: those come every 5 s.
pub(crate) const SILENCE: Duration = Duration::from_secs(15);

/// Where a station is, and a token of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Address {
    /// Host and port.
    pub(crate) host: String,
    port: u16,
    /// `token=...`; empty: the key is in a file.
    pub(crate) query: String,
}

impl FromStr for Address {
    type Err = String;

    /// As `rumbo` prints it, or its host and port.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "an address is as rumbo prints it: http://127.0.0.1:8360/".to_owned();
        let rest = text.strip_prefix("http://").unwrap_or(text);
        let (host, path) = rest.split_once('/').unwrap_or((rest, ""));
        let query = path.split_once('?').map_or("", |(_, query)| query);
        let has_port = host.rfind(':') > host.rfind(']');
        let host = match has_port {
            true => host.to_owned(),
            false => format!("{host}:{DEFAULT_PORT}"),
        };
        let (name, port) = host.rsplit_once(':').ok_or_else(wrong)?;
        let plain = |c: char| c.is_ascii_alphanumeric() || "-.[]:".contains(c);
        if name.is_empty()
            || !name.chars().all(plain)
            || !query.chars().all(|c| c.is_ascii_graphic())
        {
            return Err(wrong());
        }
        Ok(Self {
            port: port.parse().map_err(|_| wrong())?,
            query: query.to_owned(),
            host,
        })
    }
}

/// Why there is no session, or none any more.
#[derive(Debug, Error)]
pub(crate) enum StationError {
    /// Nobody answers there.
    #[error(
        "no rumbo at {0} ({1}); start `rumbo lab` or `rumbo connect`, or give the address that it prints"
    )]
    Nobody(String, io::Error),
    /// No key is known for this address: the file where it would be.
    #[error(
        "no key for {0} in {1}; start rumbo as the same user on this computer, or give the whole address that it \
         prints, with its token"
    )]
    NoKey(String, PathBuf),
    /// It refuses, and says why.
    #[error("{0}: {1}")]
    Refused(String, String),
    /// It does not speak as a station of this version does.
    #[error("{0} does not speak as this rumbo-ros does ({1}); build both from one checkout")]
    Foreign(String, String),
    /// It is a log that is shown.
    #[error(
        "a log is shown there, and no robot; `rumbo export LOG --ros2bag` makes a bag of it, which `ros2 bag play` \
         plays"
    )]
    Log,
    /// It has closed the connection, and said why.
    #[error("the session is over: {0}")]
    Closed(String),
    /// It has fallen silent.
    #[error("the session is over: nothing has come for {} s", SILENCE.as_secs())]
    Silent,
}

/// The file in which `rumbo` leaves the key of the dashboard at this port.
fn key_file(port: u16) -> PathBuf {
    let folder = dirs::runtime_dir().or_else(|| Some(dirs::data_local_dir()?.join("rumbo")));
    folder.unwrap_or_default().join(format!("rumbo-{port}.key"))
}

impl Address {
    fn connected(&self) -> Result<TcpStream, StationError> {
        let open = || {
            let stream = TcpStream::connect(&self.host)?;
            stream.set_nodelay(true)?;
            stream.set_read_timeout(Some(ANSWERS))?;
            stream.set_write_timeout(Some(ANSWERS))?;
            Ok(stream)
        };
        open().map_err(|error| StationError::Nobody(self.host.clone(), error))
    }

    /// The key that opens the WebSocket.
    pub(crate) fn key(&self) -> Result<String, StationError> {
        if self.query.is_empty() {
            let file = key_file(self.port);
            let key = std::fs::read_to_string(&file).ok();
            let key = key.filter(|key| key.bytes().all(|c| c.is_ascii_alphanumeric()));
            // Where nobody is there is no key either.
            return key.map_or_else(
                || {
                    self.connected()?;
                    Err(StationError::NoKey(self.host.clone(), file))
                },
                Ok,
            );
        }
        let mut stream = self.connected()?;
        let Self { host, query, .. } = self;
        // As a page without a key, which shows something random.
        let request = format!(
            "POST /key?{query} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nAuthorization: Bearer {}\r\n\
             Content-Length: 0\r\nConnection: close\r\n\r\n",
            generate_key()
        );
        let mut answer = String::new();
        let asked = stream.write_all(request.as_bytes());
        let answered = asked.and_then(|()| stream.read_to_string(&mut answer));
        answered.map_err(|error| StationError::Nobody(host.clone(), error))?;
        match answer.split_once("\r\n\r\n") {
            Some((head, key)) if head.starts_with("HTTP/1.1 200") => Ok(key.to_owned()),
            Some((_, why)) => Err(StationError::Refused(host.clone(), why.to_owned())),
            None => Err(StationError::Foreign(host.clone(), "no HTTP".to_owned())),
        }
    }

    /// A WebSocket to the page of this robot, or of the first one.
    pub(crate) fn socket(
        &self,
        key: &str,
        robot: Option<&str>,
    ) -> Result<WebSocket<TcpStream>, StationError> {
        let host = &self.host;
        let foreign = |why: String| StationError::Foreign(host.clone(), why);
        let robot = robot.map_or_else(String::new, |name| format!("?robot={name}"));
        let request = Request::builder()
            .uri(format!("ws://{host}/ws{robot}"))
            .header("Host", host)
            .header("Origin", format!("http://{host}"))
            .header("Connection", "Upgrade")
            .header("Upgrade", "websocket")
            .header("Sec-WebSocket-Version", "13")
            .header("Sec-WebSocket-Key", generate_key())
            .header("Sec-WebSocket-Protocol", format!("rumbo, {key}"))
            .body(())
            .map_err(|error| foreign(error.to_string()))?;
        match client(request, self.connected()?) {
            Ok((socket, _)) => Ok(socket),
            Err(HandshakeError::Failure(Error::Http(response))) => {
                Err(StationError::Refused(host.clone(), said(&response)))
            }
            Err(HandshakeError::Failure(error)) => Err(foreign(error.to_string())),
            Err(HandshakeError::Interrupted(_)) => Err(foreign("it does not answer".to_owned())),
        }
    }
}

/// What a refusal says.
fn said(response: &Response) -> String {
    let body = response.body().as_deref().unwrap_or_default();
    match body.is_empty() {
        true => response.status().to_string(),
        false => String::from_utf8_lossy(body).into_owned(),
    }
}
