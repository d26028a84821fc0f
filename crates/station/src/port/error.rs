//! Why a port cannot be opened, with what to do about it on this system.

use std::io;
use thiserror::Error;

/// A port that cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct PortError(String);

impl PortError {
    pub(super) fn new(address: &str, error: &io::Error) -> Self {
        let remedy = match error.kind() {
            _ if address.starts_with(super::TCP) => {
                "write it as tcp:host:port, and see that something listens there".into()
            }
            io::ErrorKind::PermissionDenied => permission(address),
            // As the system names what has no speed and no bits.
            _ if is_file(address) || error.to_string().contains("typewriter") => {
                format!("it is no serial port; {}", present())
            }
            io::ErrorKind::ResourceBusy => IN_USE.into(),
            // A lock that another program holds is reported as a port that does not exist.
            _ if error.to_string().contains("exclusive lock") => IN_USE.into(),
            io::ErrorKind::NotFound | io::ErrorKind::InvalidInput => present(),
            _ => format!("is another program using it? {}", present()),
        };
        Self(format!(
            "port {address} cannot be opened ({error}): {remedy}"
        ))
    }
}

const IN_USE: &str =
    "another program has it open, such as another rumbo or a serial monitor: close that one";

/// A file or a folder, which no port is.
fn is_file(path: &str) -> bool {
    std::fs::metadata(path).is_ok_and(|data| data.is_file() || data.is_dir())
}

/// Who may open it.
fn permission(address: &str) -> String {
    permission_on(std::env::consts::OS, address, group(address).as_deref())
}

fn permission_on(system: &str, address: &str, group: Option<&str>) -> String {
    match (system, group) {
        ("linux", Some(group)) => {
            format!("join its group with `sudo usermod -aG {group} $USER`, then log in again")
        }
        ("linux", None) => {
            format!("only its owner may open it; allow everybody with `sudo chmod a+rw {address}`")
        }
        ("windows", _) => {
            "another program has it open; close that one, such as the serial monitor of the Arduino IDE".into()
        }
        _ => "check its permissions with `ls -l`; on macOS use the /dev/cu.* name, and close the Arduino IDE's serial monitor".into(),
    }
}

/// The group that may read and write a file, if it is one to be joined.
#[cfg(unix)]
fn group(path: &str) -> Option<String> {
    use std::os::unix::fs::MetadataExt;
    /// Read and write, for the group.
    const MAY: u32 = 0o060;
    let data = std::fs::metadata(path).ok()?;
    if data.mode() & MAY != MAY || data.gid() == 0 {
        return None;
    }
    let id = data.gid().to_string();
    let groups = std::fs::read_to_string("/etc/group").ok()?;
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)? == id).then(|| name.to_owned())
    })
}

#[cfg(not(unix))]
fn group(_path: &str) -> Option<String> {
    None
}

/// What there is instead.
fn present() -> String {
    let names: Vec<String> = super::serial_ports()
        .unwrap_or_default()
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    if names.is_empty() {
        "this computer has no serial port now; is the robot plugged in, or its Bluetooth bound (`rfcomm bind`)?".into()
    } else {
        format!("there is {}", names.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_user_who_may_not_open_a_port_gets_advice_for_this_system() {
        for (system, group, part) in [
            ("linux", Some("dialout"), "usermod -aG dialout $USER"),
            ("linux", None, "chmod a+rw /dev/x"),
            ("windows", None, "another program has it open"),
            ("macos", Some("wheel"), "/dev/cu.*"),
        ] {
            let said = permission_on(system, "/dev/x", group);
            assert!(said.contains(part) && !said.contains('\n'), "{said}");
        }
    }

    #[test]
    fn every_reason_that_a_port_cannot_be_opened_has_its_remedy() {
        use io::ErrorKind::{NotFound, PermissionDenied, ResourceBusy};
        let said = |error: io::Error| PortError::new("/dev/none", &error).to_string();
        assert!(said(ResourceBusy.into()).contains("another program has it open"));
        let locked = io::Error::new(NotFound, "Unable to acquire exclusive lock on serial port");
        assert!(said(locked).contains("another program has it open"));
        assert!(said(PermissionDenied.into()).starts_with("port /dev/none cannot be opened"));
        let absent = said(NotFound.into());
        assert!(absent.contains("there is ") || absent.contains("has no serial port now"));
    }
}
