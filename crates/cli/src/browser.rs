//! Opens the dashboard in the browser.
//!
//! Everybody on the computer can read command lines, and the address contains a token. So the browser is opened on a
//! file that only this user can read, which redirects it to the address.

use crate::args::ServeArgs;
use crate::failure::Failure;
use crate::output;
use rumbo_station::{Addresses, Folder, Lab};
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Prints the address, opens the browser, and returns when the lab has ended.
pub(crate) fn show(lab: Lab, serve: ServeArgs) -> Result<(), Failure> {
    // Without it, programs beside the page are given the address.
    let key = KeyFile::write(&lab).ok();
    output::line(lab.url())?;
    if serve.listen.is_some() {
        output::line(&format!("viewers: {}", lab.viewers_url()))?;
    }
    open_while(lab.url(), serve, "the dashboard", || lab.until_opened());
    more_addresses(lab.addresses());
    let ended = lab.wait();
    drop(key);
    ended.map_err(Failure::input)
}

/// Prints another address whenever a person at the terminal presses Enter: the one before opens once.
fn more_addresses(addresses: Addresses) {
    let stdin = io::stdin();
    if !stdin.is_terminal() {
        return;
    }
    let _ = writeln!(
        io::stderr(),
        "Enter prints another address, for another browser"
    );
    std::thread::spawn(move || {
        for _ in stdin.lines().map_while(Result::ok) {
            if let Some(url) = addresses.another() {
                let _ = output::line(&url);
            }
        }
    });
}

/// A file with the key of those who may drive, which only this user can read: for programs such as `rumbo-ros`, which
/// find it by the port. Gone with the session.
struct KeyFile(PathBuf);

impl KeyFile {
    fn write(lab: &Lab) -> io::Result<Self> {
        let folder = dirs::runtime_dir().or_else(|| Some(dirs::data_local_dir()?.join("rumbo")));
        let folder = folder.ok_or(ErrorKind::NotFound)?;
        std::fs::create_dir_all(&folder)?;
        let mut file = NamedTempFile::new_in(&folder)?;
        file.write_all(lab.key().as_bytes())?;
        let path = folder.join(format!("rumbo-{}.key", lab.port()));
        // In place of that of a session that was killed.
        file.persist(&path)?;
        Ok(Self(path))
    }
}

impl Drop for KeyFile {
    fn drop(&mut self) {
        // It is worth nothing from now on.
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The same for a folder.
pub(crate) fn show_folder(folder: Folder, serve: ServeArgs) -> Result<(), Failure> {
    output::line(folder.url())?;
    open_while(folder.url(), serve, "the page", || folder.until_opened());
    folder.wait();
    Ok(())
}

/// Opens the browser if wanted, and explains; returns when the page has been loaded.
fn open_while(url: &str, serve: ServeArgs, page: &str, until_opened: impl FnOnce()) {
    let opening = (!serve.no_browser).then(|| open(url));
    let what = match &opening {
        None => "open the address above in a browser".to_owned(),
        Some(Err(_)) => "no browser could be opened; open the address above yourself".to_owned(),
        Some(Ok(_)) => {
            format!("{page} opens in the browser; if it does not, open the address above yourself")
        }
    };
    // The address alone is on stdout; this is for people, who may have closed stderr.
    let mut stderr = io::stderr();
    if stderr.is_terminal() {
        let _ = writeln!(stderr, "{what}. Ctrl-C ends the session");
    }
    if let Some(Ok(file)) = opening {
        until_opened();
        drop(file);
    }
}

/// Opens the browser at an address; the file is needed until the page is loaded.
fn open(url: &str) -> io::Result<NamedTempFile> {
    let mut file = tempfile::Builder::new()
        .prefix("rumbo-")
        .suffix(".html")
        .tempfile_in(folder())?;
    writeln!(
        file,
        "<!doctype html><meta charset=\"utf-8\"><title>Rumbo</title>\
         <meta http-equiv=\"refresh\" content=\"0;url={url}\"><a href=\"{url}\">Rumbo</a>"
    )?;
    open::that_detached(file.path())?;
    Ok(file)
}

/// A folder of this user's that the browser can read. One that is a snap sees neither the folder for the programs of
/// the session nor the one for temporary files.
fn folder() -> PathBuf {
    let snaps = Path::new("/snap").is_dir();
    let folder = if snaps {
        dirs::home_dir()
    } else {
        dirs::runtime_dir()
    };
    folder
        .filter(|folder| folder.is_dir())
        .unwrap_or_else(std::env::temp_dir)
}
