//! Writes a program to an Arduino at a serial port: the port and the clock around [`Programmer`].

use super::{EMPTY_READS, PortError, TCP, is_patience};
use rumbo_flash::{BAUD, FlashError, PortAction, Programmer};
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Longest wait for bytes before the programmer gets its turn again.
const TURN: Duration = Duration::from_millis(20);
/// Longest wait until the port takes a page.
const PATIENCE: Duration = Duration::from_secs(2);

/// Why a program was not written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The port cannot be opened.
    #[error(transparent)]
    Port(PortError),
    /// It is no serial port.
    #[error(
        "it is no serial port: the Mega is written over its USB cable; `rumbo list ports` shows the ports"
    )]
    Network,
    /// The port was lost meanwhile.
    #[error("the port is gone ({0}): plug it in and write again")]
    Lost(io::Error),
    /// The board does not take it.
    #[error(transparent)]
    Board(FlashError),
}

/// Has the programmer write its program to the board at this port, and calls `turn` every few milliseconds.
///
/// # Errors
/// Why it was not written, or not completely.
pub fn write_program(
    address: &str,
    programmer: &mut Programmer,
    mut turn: impl FnMut(&Programmer),
) -> Result<(), WriteError> {
    if address.starts_with(TCP) {
        return Err(WriteError::Network);
    }
    let opened = serialport::new(address, BAUD).timeout(PATIENCE).open();
    let opened = opened.map_err(|error| PortError::new(address, &error.into()));
    let mut port = opened.map_err(WriteError::Port)?;
    let began = Instant::now();
    let (mut buffer, mut empty) = ([0; 1_024], 0);
    loop {
        turn(programmer);
        let now_us = u64::try_from(began.elapsed().as_micros()).unwrap_or(u64::MAX);
        match programmer.poll(now_us).map_err(WriteError::Board)? {
            PortAction::Lines(pulled) => {
                // A port without these lines leaves the reset to the board's button.
                let _ = port.write_data_terminal_ready(pulled);
                let _ = port.write_request_to_send(pulled);
            }
            PortAction::Send(bytes) => {
                let sent = port.set_timeout(PATIENCE).map_err(io::Error::from);
                sent.and_then(|()| port.write_all(&bytes))
                    .map_err(WriteError::Lost)?;
            }
            PortAction::Wait => {
                port.set_timeout(TURN)
                    .map_err(|error| WriteError::Lost(error.into()))?;
                match port.read(&mut buffer) {
                    Ok(0) if empty == EMPTY_READS => {
                        return Err(WriteError::Lost(io::ErrorKind::UnexpectedEof.into()));
                    }
                    Ok(0) => empty += 1,
                    Ok(count) => {
                        empty = 0;
                        programmer.receive(&buffer[..count]);
                    }
                    Err(error) if is_patience(error.kind()) => {}
                    Err(error) => return Err(WriteError::Lost(error)),
                }
            }
            PortAction::Done => return Ok(()),
        }
    }
}
