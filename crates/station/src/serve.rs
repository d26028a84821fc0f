//! Starts the lab: binds the port, then runs the session and the web server in threads of their own.

use crate::board::SharedBoard;
use crate::door;
use crate::echo::{Echo, Print};
use crate::error::{ServeError, SessionError};
use crate::guard::{self, Guard};
use crate::lease::SharedLease;
use crate::order_sender::OrderSender;
use crate::recorder::RecordingSetting;
use crate::recordings::Recordings;
use crate::replay;
use crate::session::{Orders, Running, Seat};
use crate::socket::Hub;
use crate::subscribers::Subscribers;
use crate::tuning::{Tuner, Tuning};
use crate::web;
use crate::wired::Answer;
use rumbo_log::Log;
use rumbo_session::{Extras, Ghost, Replay, Target, TargetError};
use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};
use std::thread::JoinHandle;
use tokio::sync::oneshot;

/// The port of the dashboard unless another is asked for.
pub const DEFAULT_PORT: u16 = 8360;

/// The address of a dashboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ServeAt {
    /// An address of this machine: 127.0.0.1, which no other reaches, or one of the network.
    pub address: IpAddr,
    /// Its port; 0 takes any free one.
    pub port: u16,
}

impl ServeAt {
    /// For this machine only, on this port.
    #[must_use]
    pub fn here(port: u16) -> Self {
        Self {
            address: Ipv4Addr::LOCALHOST.into(),
            port,
        }
    }
}

impl Default for ServeAt {
    fn default() -> Self {
        Self::here(DEFAULT_PORT)
    }
}

/// How the lab is to be served.
#[derive(Debug)]
pub struct LabConfig {
    /// Where the dashboard is served.
    pub at: ServeAt,
    /// Seconds of the target per second of the wall clock; 0 starts paused. A real robot's is 1.
    pub speed: f64,
    /// Where runs are recorded; `None` for nowhere.
    pub recording: Option<RecordingSetting>,
    /// Prints warnings and faults as well.
    pub echo: Option<Print>,
    /// What searches for parameters, for the page in control.
    pub tuner: Option<Box<dyn Tuner>>,
    /// What answers a page of this computer that wires a robot.
    pub wired: Option<Answer>,
}

impl Default for LabConfig {
    fn default() -> Self {
        Self {
            at: ServeAt::default(),
            speed: 1.0,
            recording: None,
            echo: None,
            tuner: None,
            wired: None,
        }
    }
}

/// A target and the name of its robot; of a single one nothing.
pub type Named = (String, Box<dyn Target>);

/// Makes addresses that open the dashboard once each.
#[derive(Clone, Debug)]
pub struct Addresses(Arc<Guard>);

impl Addresses {
    /// The next one; `None` when the system gives no randomness.
    #[must_use]
    pub fn another(&self) -> Option<String> {
        self.0.another_url().ok()
    }
}

/// A lab being served; dropping it ends it, and stops the robot.
#[derive(Debug)]
pub struct Lab {
    url: String,
    viewers_url: String,
    key: String,
    addresses: Addresses,
    port: u16,
    opened: Receiver<()>,
    web_ends: Option<oneshot::Sender<()>>,
    session: Option<JoinHandle<Result<(), TargetError>>>,
    web: Option<JoinHandle<()>>,
}

impl Lab {
    /// The address to open in a browser, with its one-time token.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Further addresses, for whoever sits at the terminal.
    pub fn addresses(&self) -> Addresses {
        self.addresses.clone()
    }

    /// The address for viewers; it can be opened any number of times.
    pub fn viewers_url(&self) -> &str {
        &self.viewers_url
    }

    /// The port of the dashboard.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// The key of those who may drive: for programs of the user on this computer, which have no page to open.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Returns when [`Self::url`] has been opened, or when there is nothing to open any more.
    pub fn until_opened(&self) {
        // An error is the end of all that could say so.
        let _ = self.opened.recv();
    }

    /// Returns when the session has ended: the target is gone, or the process was asked to end.
    ///
    /// # Errors
    /// [`SessionError`].
    pub fn wait(mut self) -> Result<(), SessionError> {
        // Asked to end, the web side lets go of the session, which stops the robot and completes the log.
        match self.session.take().map(JoinHandle::join) {
            Some(Ok(ended)) => ended.map_err(SessionError::Target),
            Some(Err(_)) => Err(SessionError::Panicked),
            None => Ok(()),
        }
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        // The web side first: its connections hold senders of orders.
        drop(self.web_ends.take());
        let web = self.web.take().map(JoinHandle::join);
        let session = self.session.take().map(JoinHandle::join);
        // Nobody is left to read of a fault.
        drop((web, session));
    }
}

/// Serves the dashboard of `target` until the returned [`Lab`] is dropped. Prints nothing.
///
/// # Errors
/// [`ServeError`], when the port cannot be opened.
pub fn serve(config: LabConfig, target: Box<dyn Target>) -> Result<Lab, ServeError> {
    serve_all(config, vec![(String::new(), target)], Extras::default())
}

/// The same of all robots in a world, with what they are called and what their sessions can do besides. The time is the
/// first one's; STOP for any stops all.
///
/// # Errors
/// As [`serve`].
pub fn serve_all(config: LabConfig, robots: Vec<Named>, extras: Extras) -> Result<Lab, ServeError> {
    let LabConfig {
        at,
        speed,
        recording,
        echo,
        tuner,
        wired,
    } = config;
    let recordings =
        recording.map(|recording| Arc::new(Recordings::new(recording.folder, serve_replay)));
    let beside = Beside {
        recordings: recordings.clone(),
        tuning: tuner.map(|tuner| Arc::new(Tuning::new(tuner))),
        wired,
    };
    let (names, targets): (Vec<_>, Vec<_>) = robots.into_iter().unzip();
    let speakers = names.clone();
    start(at, beside, names, move |chairs| {
        let echo = echo.and_then(Echo::start);
        let robots = speakers.into_iter().zip(targets).zip(chairs);
        let seats = robots.map(|((name, target), (board, orders))| Seat {
            target,
            subscribers: Subscribers {
                board,
                echo: echo.as_ref().map(|echo| echo.of(name)),
                recorder: None,
            },
            orders,
        });
        Running::new(seats, speed, recordings, extras).run()
    })
}

/// Serves the same dashboard for a log, which it shows under this name; with `ghost`, the log's ghost can be started
/// again.
///
/// # Errors
/// [`ServeError`], when the port cannot be opened.
pub fn serve_log(
    at: ServeAt,
    speed: f64,
    name: String,
    log: Log,
    ghost: Option<Box<dyn Ghost>>,
) -> Result<Lab, ServeError> {
    let beside = Beside::default();
    start(at, beside, vec![String::new()], move |mut chairs| {
        if let Some((board, orders)) = chairs.pop() {
            replay::run(Replay::new(name, log, speed, ghost), &board, &orders);
        }
        Ok(())
    })
}

/// A replay beside a session, for this computer: paused at its beginning.
pub(crate) fn serve_replay(name: String, log: Log) -> Result<(String, Box<dyn Send>), ServeError> {
    let lab = serve_log(ServeAt::here(0), 0.0, name, log, None)?;
    Ok((lab.url().to_owned(), Box::new(lab)))
}

/// What a robot's session writes to, and where its orders come from.
type Chair = (Arc<SharedBoard>, Orders);

/// What pages may use beside the session.
#[derive(Default)]
struct Beside {
    recordings: Option<Arc<Recordings>>,
    tuning: Option<Arc<Tuning>>,
    wired: Option<Answer>,
}

/// Serves boards that `session` writes, one for each of these robots, in a thread of its own, until there are no more
/// orders.
fn start(
    at: ServeAt,
    beside: Beside,
    names: Vec<String>,
    session: impl FnOnce(Vec<Chair>) -> Result<(), TargetError> + Send + 'static,
) -> Result<Lab, ServeError> {
    guard::check_listen(at.address)?;
    let listener = bind(at)?;
    let at = SocketAddr::new(at.address, at.port);
    start_on(listener, beside, names, session).map_err(|error| ServeError::Io(at, error))
}

pub(crate) fn bind(at: ServeAt) -> Result<TcpListener, ServeError> {
    let at = SocketAddr::new(at.address, at.port);
    TcpListener::bind(at).map_err(|error| match error.kind() {
        io::ErrorKind::AddrInUse => ServeError::PortInUse(at),
        _ => ServeError::Io(at, error),
    })
}

fn start_on(
    listener: TcpListener,
    beside: Beside,
    names: Vec<String>,
    session: impl FnOnce(Vec<Chair>) -> Result<(), TargetError> + Send + 'static,
) -> io::Result<Lab> {
    let (opens, opened) = mpsc::channel();
    let at = listener.local_addr()?;
    let guard = Guard::new(at, opens.clone()).map_err(io::Error::other)?;
    let (url, viewers_url) = (guard.url(), guard.viewers_url());
    let key = guard.drivers_key().to_owned();
    let guard = Arc::new(guard);
    let addresses = Addresses(Arc::clone(&guard));

    let several = names.len() > 1;
    let (mut chairs, mut hubs) = (Vec::new(), Vec::new());
    let robots: Arc<[String]> = names.iter().filter(|_| several).cloned().collect();
    for (robot, (sender, orders)) in OrderSender::of(robots.len().max(1)).into_iter().enumerate() {
        let board = Arc::new(SharedBoard::default());
        chairs.push((Arc::clone(&board), orders));
        hubs.push(Hub {
            board,
            orders: Arc::new(sender),
            lease: SharedLease::default(),
            robot,
            robots: Arc::clone(&robots),
            local: at.ip().is_loopback(),
            recordings: beside.recordings.clone(),
            tuning: beside.tuning.clone(),
            wired: beside.wired,
        });
    }
    let session_over = opens.clone();
    let session = std::thread::Builder::new()
        .name("session".into())
        .spawn(move || {
            let ended = session(chairs);
            let _ = session_over.send(());
            ended
        })?;

    let router = web::router(guard, hubs);
    let (web_ends, ended) = oneshot::channel::<()>();
    // An error: the lab was dropped.
    let ended = async { drop(ended.await) };
    let web = door::spawn(listener, router, ended, move || {
        let _ = opens.send(());
    })?;
    Ok(Lab {
        url,
        viewers_url,
        key,
        addresses,
        port: at.port(),
        opened,
        web_ends: Some(web_ends),
        session: Some(session),
        web: Some(web),
    })
}
