//! A pseudo terminal: a serial port without hardware, for other programs to open.

use serialport::{SerialPort, TTYPort};
use std::io::{self, Read, Write};
use std::time::Duration;

/// The robot's side of a pseudo terminal.
#[derive(Debug)]
pub struct Pty {
    master: TTYPort,
    path: String,
    patience: Duration,
    /// A program has the other side open.
    open: bool,
}

impl Pty {
    /// Opens a new one. `patience`: longest wait for the other side to read or write.
    ///
    /// # Errors
    /// If the system has none left.
    pub fn new(patience: Duration) -> io::Result<Self> {
        let (mut master, slave) = TTYPort::pair()?;
        master.set_timeout(patience)?;
        let path = slave
            .name()
            .ok_or_else(|| io::Error::other("a pseudo terminal without a name"))?;
        Ok(Self {
            master,
            path,
            patience,
            open: false,
        })
    }

    /// The path that other programs open.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Appends what the other side has written; waits for it as long as its patience lasts.
    pub fn read(&mut self, into: &mut Vec<u8>) {
        let mut buffer = [0; 1_024];
        match self.master.read(&mut buffer) {
            Ok(count) => {
                self.open = true;
                into.extend_from_slice(&buffer[..count]);
            }
            Err(error) if error.kind() == io::ErrorKind::TimedOut => self.open = true,
            Err(_) => {
                self.open = false;
                std::thread::sleep(self.patience);
            }
        }
    }

    /// Writes to the other side. Bytes without a reader are lost, as on a real line.
    pub fn write(&mut self, bytes: &[u8]) {
        if self.open {
            // Lost, as on a real line.
            let _ = self.master.write_all(bytes);
        }
    }
}
