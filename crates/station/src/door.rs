//! The connections of the web server: for how long one may ask for nothing, and how many there are.
//!
//! Anyone who reaches the port can open connections. Each takes a descriptor, and the logs need some too. So a
//! connection ends when the head of a request does not come, when it is old, and when many newer ones have come: the
//! oldest make room, and a new page always finds a place. A connection that became a page's WebSocket has shown a key
//! and is none of these any more; how many pages there may be is up to the [lease](crate::lease).

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::time::{sleep, timeout};

/// The head of a request comes within this time, the first one and each next one on the same connection.
const HEAD: Duration = Duration::from_secs(5);
/// A connection without a WebSocket is over by then, whatever it does: also one that does not read its answer.
const LIFE: Duration = Duration::from_secs(60);
/// With so many newer ones a connection ends. A page has six; the usual limit is 1,024 descriptors.
const NEWER: u64 = 400;
/// The longest head of a request \[bytes\].
const LONGEST_HEAD: usize = 16 << 10;
/// Pause after one that could not be accepted, for want of descriptors for instance.
const AGAIN: Duration = Duration::from_millis(50);

/// Accepts connections for ever.
pub(crate) async fn keep(listener: TcpListener, router: Router) {
    let newest = watch::Sender::new(0);
    loop {
        match listener.accept().await {
            Ok((stream, _)) => {
                newest.send_modify(|number| *number += 1);
                tokio::spawn(converse(stream, router.clone(), newest.subscribe()));
            }
            Err(_) => sleep(AGAIN).await,
        }
    }
}

/// Answers the requests of a connection, the last one that has come.
async fn converse(stream: TcpStream, router: Router, mut newest: watch::Receiver<u64>) {
    // News are small and must not wait to be gathered. Should that fail, they are late and nothing worse.
    let _ = stream.set_nodelay(true);
    let own = *newest.borrow_and_update();
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(LONGEST_HEAD)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    tokio::select! {
        // Its end, by whichever side, or its WebSocket, which is served elsewhere.
        _ = timeout(LIFE, connection) => {}
        _ = newest.wait_for(|newest| newest - own >= NEWER) => {}
    }
}
