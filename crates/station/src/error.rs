//! Why a lab could not be served, or ended.

use rumbo_session::TargetError;
use std::io;
use std::net::{IpAddr, SocketAddr};
use thiserror::Error;

/// Why the lab could not be served.
#[derive(Debug, Error)]
pub enum ServeError {
    /// Another program listens there.
    #[error(
        "port {} on {} is in use: is the lab already running? Close it, or choose another port with --port N \
         (0 takes any free one)",
        .0.port(), .0.ip()
    )]
    PortInUse(SocketAddr),
    /// No browser can ask for this address; this machine's own, if it has one.
    #[error("--listen: {0} is no address that a browser can ask for: give this computer's own{own}", own = such_as(.1))]
    Unspecified(IpAddr, Option<IpAddr>),
    /// The port could not be opened, or a thread not be started, for another reason.
    #[error("{}", not_served(.0, .1))]
    Io(SocketAddr, io::Error),
}

fn such_as(own: &Option<IpAddr>) -> String {
    own.map_or(String::new(), |own| format!(", such as {own}"))
}

fn not_served(at: &SocketAddr, error: &io::Error) -> String {
    let (ip, port) = (at.ip(), at.port());
    match error.kind() {
        io::ErrorKind::AddrNotAvailable => format!(
            "--listen {ip}: this computer has no such address; `ip address` (Windows: `ipconfig`) shows which it has"
        ),
        io::ErrorKind::PermissionDenied => format!(
            "port {port} is for administrators ({error}): choose one above 1023 with --port N (0 takes any free one)"
        ),
        _ => format!("the dashboard could not be served on {at}: {error}"),
    }
}

/// Why a session ended before it was asked to.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SessionError {
    /// The target is gone for good.
    #[error(transparent)]
    Target(TargetError),
    /// The session panicked.
    #[error("the session ended by a fault of its own; please report it")]
    Panicked,
}
