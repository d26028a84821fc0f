//! Why a lab could not be served, or ended.

use rumbo_session::TargetError;
use std::net::{IpAddr, SocketAddr};
use std::{fmt, io};

/// Why the lab could not be served.
#[derive(Debug)]
pub enum ServeError {
    /// Another program listens there.
    PortInUse(SocketAddr),
    /// No browser can ask for this address; this machine's own, if it has one.
    Unspecified(IpAddr, Option<IpAddr>),
    /// The port could not be opened, or a thread not be started, for another reason.
    Io(SocketAddr, io::Error),
}

impl fmt::Display for ServeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PortInUse(at) => write!(
                f,
                "port {} on {} is in use: is the lab already running? Close it, or choose another port with --port N (0 takes any free one)",
                at.port(),
                at.ip()
            ),
            Self::Unspecified(at, own) => {
                write!(
                    f,
                    "--listen: {at} is no address that a browser can ask for: give this computer's own"
                )?;
                own.map_or(Ok(()), |own| write!(f, ", such as {own}"))
            }
            Self::Io(at, error) if error.kind() == io::ErrorKind::AddrNotAvailable => write!(
                f,
                "--listen {0}: this computer has no such address; `ip address` (Windows: `ipconfig`) shows which it has",
                at.ip()
            ),
            Self::Io(at, error) if error.kind() == io::ErrorKind::PermissionDenied => write!(
                f,
                "port {} is for administrators ({error}): choose one above 1023 with --port N (0 takes any free one)",
                at.port()
            ),
            Self::Io(at, error) => {
                write!(f, "the dashboard could not be served on {at}: {error}")
            }
        }
    }
}

impl std::error::Error for ServeError {}

/// Why a session ended before it was asked to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SessionError {
    /// The target is gone for good.
    Target(TargetError),
    /// The session panicked.
    Panicked,
}

impl fmt::Display for SessionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Target(error) => error.fmt(f),
            Self::Panicked => {
                f.write_str("the session ended by a fault of its own; please report it")
            }
        }
    }
}

impl std::error::Error for SessionError {}
