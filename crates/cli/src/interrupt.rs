//! Ctrl-C while there is something to lose: the first one asks for an end, the second one is an end.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use tokio::signal::ctrl_c;

/// Exit status of a command that was interrupted, as shells have it.
pub(crate) const STATUS: u8 = 130;

/// Becomes true with the first Ctrl-C. Where none can be heard, Ctrl-C ends the program as ever.
pub(crate) fn asked() -> Arc<AtomicBool> {
    let asked = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&asked);
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build();
    let Ok(runtime) = runtime else {
        return asked;
    };
    let (listens, listening) = channel();
    std::thread::spawn(move || {
        runtime.block_on(async {
            let mut first = pin!(ctrl_c());
            // Asked once, it listens.
            let heard = tokio::select! {
                biased;
                heard = &mut first => Some(heard),
                () = async {} => None,
            };
            // Who waits for this is still there.
            let _ = listens.send(());
            let heard = match heard {
                Some(heard) => heard,
                None => first.await,
            };
            if heard.is_ok() {
                told.store(true, Ordering::Relaxed);
            }
            if ctrl_c().await.is_ok() {
                std::process::exit(STATUS.into());
            }
        });
    });
    // An error is a thread that has ended: then nothing is heard.
    let _ = listening.recv();
    asked
}
