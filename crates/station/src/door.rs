//! The connections of the web server: time-outs, and a limit on their number.
//!
//! Anyone who reaches the port can open connections. Each takes a descriptor, and the logs need some too. So a
//! connection is closed when the head of a request is late, when it is old, and when many newer ones have come: the
//! oldest make room, and a new page can always connect. A connection that became a page's WebSocket has presented a key
//! and is exempt; the [lease](crate::lease) limits the number of pages.

use crate::ending::asked_to_end;
use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::io;
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::time::{sleep, timeout};

/// The head of each request must arrive within this time: a slow computer needs some seconds for a page of 80 files.
const HEAD: Duration = Duration::from_secs(10);
/// Lifetime of a connection without a WebSocket, even of one that does not read its answer.
const LIFE: Duration = Duration::from_secs(60);
/// A connection is closed after this many newer ones. A page has six; the usual limit is 1,024 descriptors.
const NEWER: u64 = 400;
/// Longest head of a request \[bytes\].
const LONGEST_HEAD: usize = 16 << 10;
/// Pause after a failed accept, for lack of descriptors for instance.
const RETRY: Duration = Duration::from_millis(50);

/// Accepts connections in a thread of its own until `ended`, or until the process is asked to end; `after` is called
/// then. Connections end with the thread.
pub(crate) fn spawn(
    listener: std::net::TcpListener,
    router: Router,
    ended: impl Future<Output = ()> + Send + 'static,
    after: impl FnOnce() + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    listener.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    let serve = move || {
        runtime.block_on(async {
            let Ok(listener) = TcpListener::from_std(listener) else {
                return;
            };
            tokio::select! {
                () = accept(listener, router) => {}
                () = ended => {}
                () = asked_to_end() => {}
            }
        });
        after();
    };
    std::thread::Builder::new().name("web".into()).spawn(serve)
}

/// Accepts connections for ever.
async fn accept(listener: TcpListener, router: Router) {
    let newest = watch::Sender::new(0);
    loop {
        match listener.accept().await {
            Ok((stream, _)) => {
                newest.send_modify(|number| *number += 1);
                tokio::spawn(serve(stream, router.clone(), newest.subscribe()));
            }
            Err(_) => sleep(RETRY).await,
        }
    }
}

/// Answers the requests of the newest connection.
async fn serve(stream: TcpStream, router: Router, mut newest: watch::Receiver<u64>) {
    // Messages are small and must not be delayed to be joined; if this fails, they are only late.
    let _ = stream.set_nodelay(true);
    let own = *newest.borrow_and_update();
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(LONGEST_HEAD)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    tokio::select! {
        // Closed by either side, or upgraded to a WebSocket, which is served elsewhere.
        _ = timeout(LIFE, connection) => {}
        _ = newest.wait_for(|newest| newest - own >= NEWER) => {}
    }
}
