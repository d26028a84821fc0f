//! A robot behind a real port: serial (USB, rfcomm, a PTY) or TCP.
//!
//! Two threads read and write, so that the session never waits for the port. When the port disappears, opening it is
//! retried until it is back, ever more rarely if it only opens to close again; bytes to be sent meanwhile are dropped,
//! so that no old command takes effect afterwards. The robot has stopped by then, for lack of a heartbeat, and nothing
//! here arms it.

mod error;
#[cfg(unix)]
mod pty;
mod write;

pub use error::PortError;
#[cfg(unix)]
pub use pty::Pty;
pub use write::{WriteError, write_program};

use rumbo_log::{LogKind, Manifest};
pub use rumbo_session::DEFAULT_BAUD;
use rumbo_session::{LinkNews, Target, TargetError};
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Opening a port that is gone is retried this often.
const AGAIN: Duration = Duration::from_millis(250);
/// One that closes as soon as it is open is retried half as often each time, down to this.
const AGAIN_AT_MOST: Duration = Duration::from_secs(4);
/// What is open for less time was closed as soon as it was open.
const BRIEF: Duration = Duration::from_secs(1);
/// A thread that waits for the port checks this often whether it is still needed.
const LOOK: Duration = Duration::from_millis(100);
/// Longest wait for a computer to answer.
const TCP_PATIENCE: Duration = Duration::from_secs(2);
/// Most pieces queued for the session.
const WAITING: usize = 1_024;
/// After this many consecutive empty reads a serial port is gone.
const EMPTY_READS: u32 = 3;

/// Prefix of a TCP address.
pub const TCP: &str = "tcp:";

type Reader = Box<dyn Read + Send>;
type Writer = Box<dyn Write + Send>;

/// State shared by the threads and the target.
#[derive(Clone, Debug, Default)]
struct Shared {
    news: Arc<Mutex<Vec<LinkNews>>>,
    ended: Arc<AtomicBool>,
}

impl Shared {
    fn report(&self, news: LinkNews) {
        self.news
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(news);
    }
}

/// A port with a robot behind it.
#[derive(Debug)]
pub struct Port {
    address: String,
    baud: u32,
    began: Instant,
    incoming: Receiver<Vec<u8>>,
    /// `None` only while it is dropped.
    outgoing: Option<Sender<Vec<u8>>>,
    shared: Shared,
    thread: Option<JoinHandle<()>>,
}

impl Port {
    /// Opens a serial port by its name, or `tcp:host:port`.
    ///
    /// # Errors
    /// [`PortError`], if it cannot be opened now. A port lost later is reopened.
    pub fn open(address: &str, baud: u32) -> Result<Self, PortError> {
        let opened = open(address, baud).map_err(|error| PortError::new(address, &error))?;
        let (bytes, incoming) = sync_channel(WAITING);
        let (outgoing, commands) = channel();
        let shared = Shared::default();
        let keeper = Keeper {
            address: address.to_owned(),
            baud,
            bytes,
            commands,
            shared: shared.clone(),
        };
        let thread = std::thread::Builder::new()
            .name("port".into())
            .spawn(move || keeper.keep(opened))
            .map_err(|error| PortError::new(address, &error))?;
        Ok(Self {
            address: address.to_owned(),
            baud,
            began: Instant::now(),
            incoming,
            outgoing: Some(outgoing),
            shared,
            thread: Some(thread),
        })
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        // Bytes queued for sending, such as the last STOP, are sent before the thread ends.
        drop(self.outgoing.take());
        // Unblocks a reader that waits for room in the channel.
        self.incoming = std::sync::mpsc::channel().1;
        self.shared.ended.store(true, Ordering::SeqCst);
        let ended = self.thread.take().map(JoinHandle::join);
        drop(ended);
    }
}

impl Target for Port {
    fn now_us(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn advance(&mut self, _dt_us: u64) -> Result<(), TargetError> {
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        let sent = self
            .outgoing
            .as_ref()
            .map(|outgoing| outgoing.send(bytes.to_vec()));
        match sent {
            Some(Ok(())) => Ok(()),
            _ => Err(TargetError::PortEnded(self.address.clone())),
        }
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        self.incoming
            .try_iter()
            // A flood is read in parts, so that orders are handled in between.
            .take(WAITING)
            .for_each(|bytes| into.extend(bytes));
    }

    fn baud(&self) -> u32 {
        self.baud
    }

    fn manifest(&self) -> Manifest {
        Manifest {
            kind: LogKind::Robot,
            program: "unknown".into(),
            port: Some(self.address.clone()),
            ..Manifest::default()
        }
    }

    fn news(&mut self) -> Option<LinkNews> {
        let mut news = self
            .shared
            .news
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        (!news.is_empty()).then(|| news.remove(0))
    }
}

fn open(address: &str, baud: u32) -> io::Result<(Reader, Writer)> {
    if let Some(host) = address.strip_prefix(TCP) {
        let mut last = io::Error::new(io::ErrorKind::NotFound, "no such host");
        for at in host.to_socket_addrs()? {
            match TcpStream::connect_timeout(&at, TCP_PATIENCE) {
                Ok(stream) => {
                    stream.set_nodelay(true)?;
                    stream.set_read_timeout(Some(LOOK))?;
                    return Ok((Box::new(stream.try_clone()?), Box::new(stream)));
                }
                Err(error) => last = error,
            }
        }
        return Err(last);
    }
    let port = serialport::new(address, baud).timeout(LOOK).open()?;
    Ok((Box::new(port.try_clone()?), Box::new(port)))
}

/// Names of the serial ports of this computer, and the devices behind them as far as the system knows.
///
/// # Errors
/// If the system does not list them.
pub fn serial_ports() -> io::Result<Vec<(String, String)>> {
    use serialport::SerialPortType;
    // Where a container has no /sys, the library would panic.
    #[cfg(target_os = "linux")]
    if let Err(error) = std::fs::read_dir("/sys/class/tty") {
        let why =
            format!("the serial ports of this computer are not listed: /sys/class/tty: {error}");
        return Err(io::Error::new(error.kind(), why));
    }
    let ports = serialport::available_ports()?;
    let what = |kind: SerialPortType| match kind {
        SerialPortType::UsbPort(usb) => usb
            .product
            .unwrap_or_else(|| format!("USB {:04x}:{:04x}", usb.vid, usb.pid)),
        SerialPortType::BluetoothPort => "Bluetooth".into(),
        SerialPortType::PciPort => "built in".into(),
        SerialPortType::Unknown => String::new(),
    };
    Ok(ports
        .into_iter()
        .map(|port| (port.port_name, what(port.port_type)))
        .collect())
}

/// Keeps the port open, and reopens it.
struct Keeper {
    address: String,
    baud: u32,
    bytes: SyncSender<Vec<u8>>,
    commands: Receiver<Vec<u8>>,
    shared: Shared,
}

impl Keeper {
    fn keep(self, opened: (Reader, Writer)) {
        let (mut opened, mut pause) = (Some(opened), AGAIN);
        // What is said of a port that opened again; nothing of the first one.
        let mut back = None;
        loop {
            if let Some((reader, writer)) = opened.take() {
                let (since, trusted) = (Instant::now(), pause == AGAIN);
                let proof = if trusted { Duration::ZERO } else { BRIEF };
                let Err(error) = self.transfer(reader, writer, proof, &mut back) else {
                    return;
                };
                let brief = since.elapsed() < BRIEF;
                // One that was not said to be back is not said to be gone again.
                if back.is_none() {
                    let lost = self.lost(&error, brief);
                    self.shared.report(LinkNews::Lost(lost));
                }
                pause = if brief {
                    (pause * 2).min(AGAIN_AT_MOST)
                } else {
                    AGAIN
                };
            }
            if !self.pause(pause) {
                return;
            }
            if let Ok(again) = open(&self.address, self.baud) {
                while self.commands.try_recv().is_ok() {}
                back = Some(LinkNews::Back(format!("port {} is back", self.address)));
                opened = Some(again);
            }
        }
    }

    fn lost(&self, error: &io::Error, brief: bool) -> String {
        let address = &self.address;
        if brief {
            format!(
                "port {address} closes as soon as it is open ({error}): is the robot behind it on, and no other program connected to it? It is tried again every few seconds"
            )
        } else {
            format!("port {address} is gone ({error}); waiting for it")
        }
    }

    /// Waits this long, and drops the bytes for a robot that is not connected; `false` once the target is dropped.
    fn pause(&self, long: Duration) -> bool {
        let until = Instant::now() + long;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.commands.recv_timeout(left) {
                Ok(_) => {}
                Err(RecvTimeoutError::Timeout) => return true,
                Err(RecvTimeoutError::Disconnected) => return false,
            }
        }
    }

    /// Transfers bytes until the target is dropped or the port is gone; reports that it is `back` after `proof`.
    fn transfer(
        &self,
        reader: Reader,
        mut writer: Writer,
        proof: Duration,
        back: &mut Option<LinkNews>,
    ) -> io::Result<()> {
        let since = Instant::now();
        let (lost, gone) = channel();
        let (bytes, ended) = (self.bytes.clone(), Arc::new(AtomicBool::new(false)));
        let over = Arc::clone(&ended);
        let listening = std::thread::Builder::new()
            .name("port reader".into())
            .spawn(move || {
                if let Err(error) = listen(reader, &bytes, &over) {
                    // Without a receiver the writer has already ended.
                    let _ = lost.send(error);
                }
            })?;
        let outcome = loop {
            if let Ok(error) = gone.try_recv() {
                break Err(error);
            }
            if since.elapsed() >= proof
                && let Some(news) = back.take()
            {
                self.shared.report(news);
            }
            match self.commands.recv_timeout(LOOK) {
                Ok(bytes) => match writer.write_all(&bytes).and_then(|()| writer.flush()) {
                    // The port accepts nothing now: a sender that needs an answer repeats its bytes.
                    Err(error) if error.kind() == io::ErrorKind::TimedOut => {}
                    Err(error) => break Err(error),
                    Ok(()) => {}
                },
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break Ok(()),
            }
        };
        ended.store(true, Ordering::SeqCst);
        // A reader that failed has reported its error.
        drop(listening.join());
        outcome
    }
}

/// Forwards received bytes.
fn listen(mut reader: Reader, bytes: &SyncSender<Vec<u8>>, ended: &AtomicBool) -> io::Result<()> {
    let (mut buffer, mut empty) = ([0; 4_096], 0);
    while !ended.load(Ordering::SeqCst) {
        match reader.read(&mut buffer) {
            Ok(0) => {
                empty += 1;
                if empty >= EMPTY_READS {
                    return Err(io::Error::new(
                        io::ErrorKind::UnexpectedEof,
                        "the other side closed it",
                    ));
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(count) => {
                empty = 0;
                if bytes.send(buffer[..count].to_vec()).is_err() {
                    return Ok(());
                }
            }
            Err(error) if is_patience(error.kind()) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Whether the error means only that nothing arrived for a while.
fn is_patience(kind: io::ErrorKind) -> bool {
    matches!(
        kind,
        io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
    )
}
