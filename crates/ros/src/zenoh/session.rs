//! A session of Zenoh, for any number of nodes of a domain.
//!
//! `rmw_zenoh_cpp` starts no router: nodes connect to the one at an endpoint, `tcp/localhost:7447`, and from there to each
//! other. Where nobody listens at the endpoint, the session does so itself, in the router's place.

use super::token::{all_tokens, read_token};
use crate::bridge::{BridgeError, Reach};
use std::collections::BTreeMap;
use std::fmt;
use std::net::{IpAddr, TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use zenoh::sample::{Sample, SampleKind};
use zenoh::{Config, Wait};

/// Who listens at an endpoint answers within this time.
const ANSWERS: Duration = Duration::from_secs(1);
/// And it is a Zenoh within this one \[ms\].
const CONNECTS_MS: u32 = 4_000;
/// Topics whose users disagree are remembered up to this number.
const MOST_TROUBLES: usize = 1_000;

/// Where a router is, or may be: `tcp/localhost:7447`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    host: String,
    port: u16,
}

impl Default for Endpoint {
    fn default() -> Self {
        Self {
            host: "localhost".into(),
            port: 7447,
        }
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tcp/{}:{}", self.host, self.port)
    }
}

impl FromStr for Endpoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let place = text.strip_prefix("tcp/");
        let parts = place.and_then(|place| place.rsplit_once(':'));
        let is_host = |c: char| c.is_ascii_alphanumeric() || "-._:[]".contains(c);
        match parts.map(|(host, port)| (host, port.parse())) {
            Some((host, Ok(port))) if port > 0 && !host.is_empty() && host.chars().all(is_host) => {
                let host = host.to_owned();
                Ok(Self { host, port })
            }
            _ => Err("an endpoint is tcp/HOST:PORT, as in tcp/localhost:7447".into()),
        }
    }
}

impl Endpoint {
    /// It is an address that only this computer reaches.
    fn is_here(&self) -> bool {
        let host = self.host.trim_matches(['[', ']']);
        let address = host.parse::<IpAddr>();
        host == "localhost" || address.is_ok_and(|address| address.is_loopback())
    }

    /// Somebody listens there.
    fn answers(&self) -> bool {
        let host = self.host.trim_matches(['[', ']']);
        let addresses = (host, self.port).to_socket_addrs();
        let mut addresses = addresses.into_iter().flatten();
        addresses.any(|address| TcpStream::connect_timeout(&address, ANSWERS).is_ok())
    }
}

/// What is wrong with a topic or service and has not been said yet, by its name; and the types of those used.
#[derive(Debug, Default)]
struct Others {
    used: BTreeMap<String, (String, String)>,
    troubles: BTreeMap<String, String>,
}

/// A session that is open, for any number of nodes ([`Zenoh::new`](super::Zenoh::new)).
#[derive(Clone)]
pub struct Session {
    pub(super) session: zenoh::Session,
    pub(super) domain: u16,
    listens: bool,
    here: bool,
    numbers: Arc<AtomicUsize>,
    others: Arc<Mutex<Others>>,
}

impl fmt::Debug for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "domain {} on Zenoh", self.domain)
    }
}

impl Session {
    /// Opens a session at an endpoint: connects to who is there, or else listens there.
    ///
    /// # Errors
    /// If neither can be done.
    pub fn open(domain: u16, reach: Reach, endpoint: &Endpoint) -> Result<Self, BridgeError> {
        let listens = !endpoint.answers();
        let refused = |error: &dyn fmt::Display| {
            let does = if listens { "listen at" } else { "connect to" };
            BridgeError::Endpoint(endpoint.to_string(), does, error.to_string())
        };
        let config = configuration(reach, endpoint, listens).map_err(|error| refused(&error))?;
        let session = zenoh::open(config).wait();
        let session = session.map_err(|error| refused(&error))?;
        let others: Arc<Mutex<Others>> = Arc::default();
        let heard = Arc::clone(&others);
        let tokens = session.liveliness().declare_subscriber(all_tokens(domain));
        let tokens = tokens
            .history(true)
            .callback(move |token| hear(&heard, &token))
            .background();
        tokens.wait().map_err(|error| refused(&error))?;
        Ok(Self {
            session,
            domain,
            listens,
            here: listens && reach == Reach::Computer && endpoint.is_here(),
            numbers: Arc::default(),
            others,
        })
    }

    /// Nobody listened at the endpoint: the session does.
    #[must_use]
    pub fn listens(&self) -> bool {
        self.listens
    }

    /// Nobody else's computer gets there: it listens itself, at an address that only this one has.
    #[must_use]
    pub fn is_here(&self) -> bool {
        self.here
    }

    /// A number that nothing else of the session has.
    pub(super) fn number(&self) -> usize {
        self.numbers.fetch_add(1, Ordering::Relaxed)
    }

    /// Notes the type of a topic or service that is used.
    pub(super) fn uses(&self, name: &str, kind: &str, hash: &str) {
        let mut others = self.others.lock().unwrap_or_else(PoisonError::into_inner);
        let with = (kind.to_owned(), hash.to_owned());
        others.used.insert(name.to_owned(), with);
    }

    /// What is wrong with one of these topics and services, once.
    pub(super) fn trouble(&self, names: &[String]) -> Option<String> {
        let mut others = self.others.lock().unwrap_or_else(PoisonError::into_inner);
        names.iter().find_map(|name| others.troubles.remove(name))
    }
}

/// Takes a token of anybody's.
fn hear(others: &Mutex<Others>, token: &Sample) {
    let Some((does, of)) = read_token(token.key_expr().as_str()) else {
        return;
    };
    let mut others = others.lock().unwrap_or_else(PoisonError::into_inner);
    let Some((kind, hash)) = others.used.get(&of.name) else {
        return;
    };
    let name = &of.name;
    let trouble = match (of.kind == *kind, of.hash == *hash) {
        (true, true) => return,
        (false, _) => format!("{name}: somebody {does} {} there, it is {kind}", of.kind),
        (true, false) => format!("{name}: somebody {does} another version of {kind} there"),
    };
    if token.kind() == SampleKind::Put && others.troubles.len() < MOST_TROUBLES {
        others.troubles.insert(of.name, trouble);
    }
}

fn configuration(reach: Reach, endpoint: &Endpoint, listens: bool) -> zenoh::Result<Config> {
    let (own, everywhere) = match reach {
        Reach::Computer => ("127.0.0.1", false),
        Reach::Networks => ("0.0.0.0", true),
    };
    let port = endpoint.port;
    let (connect, listen) = match (listens, reach) {
        (false, _) => (format!(r#"["{endpoint}"]"#), format!("tcp/{own}:0")),
        (true, Reach::Computer) => ("[]".into(), endpoint.to_string()),
        (true, Reach::Networks) => ("[]".into(), format!("tcp/{own}:{port}")),
    };
    let mut config = Config::default();
    for (key, value) in [
        ("mode", r#""peer""#.to_owned()),
        ("connect/endpoints", connect),
        // One that listens and is no Zenoh is an error, not waited for; one that goes later is looked for again.
        ("connect/timeout_ms", CONNECTS_MS.to_string()),
        ("connect/exit_on_failure", "true".into()),
        ("listen/endpoints", format!(r#"["{listen}"]"#)),
        ("listen/exit_on_failure", "true".into()),
        ("scouting/multicast/enabled", everywhere.to_string()),
        ("scouting/gossip/enabled", "true".into()),
        ("timestamping/enabled", "true".into()),
    ] {
        config.insert_json5(key, &value)?;
    }
    Ok(config)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn an_endpoint_is_read_and_written_and_nothing_else_is_one() {
        for text in ["tcp/localhost:7447", "tcp/192.168.1.7:1", "tcp/[::1]:7447"] {
            let endpoint = text.parse::<Endpoint>().unwrap();
            assert_eq!(endpoint.to_string(), text);
            assert_eq!(endpoint.is_here(), !text.contains("192"), "{text}");
        }
        for text in [
            "",
            "localhost:7447",
            "udp/localhost:7447",
            "tcp/localhost",
            "tcp/:7447",
            "tcp/localhost:0",
            "tcp/localhost:70000",
            "tcp/a\"b:7447",
        ] {
            assert!(text.parse::<Endpoint>().is_err(), "{text}");
        }
    }
}
