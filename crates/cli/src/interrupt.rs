//! Ctrl-C, SIGTERM or the end of the terminal while there is something to lose: the first one requests an orderly end,
//! the second one ends the program.

use rumbo_station::asked_to_end;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

/// Exit status of a command that was interrupted, as shells have it.
pub(crate) const STATUS: u8 = 130;

/// Becomes true with the first of them. Where none can be received, each ends the program as usual.
pub(crate) fn asked() -> Arc<AtomicBool> {
    let asked = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&asked);
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build();
    let Ok(runtime) = runtime else {
        return asked;
    };
    let (listens, listening) = channel();
    std::thread::spawn(move || {
        runtime.block_on(async {
            let mut first = pin!(asked_to_end());
            // Polled once to register the handlers.
            let is_asked = tokio::select! {
                biased;
                () = &mut first => true,
                () = async {} => false,
            };
            // The receiver still exists.
            let _ = listens.send(());
            if !is_asked {
                first.await;
            }
            flag.store(true, Ordering::Relaxed);
            asked_to_end().await;
            std::process::exit(STATUS.into());
        });
    });
    // An error means that the thread has ended: then no signal is received.
    let _ = listening.recv();
    asked
}
