//! When a session is to end: the process is asked to, or its terminal has gone.

/// Ends when the process is interrupted or terminated by the system.
pub async fn asked_to_end() {
    // Without a handler the process ends at once, as it does anyway.
    let interrupted = async {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    };
    tokio::select! {
        () = interrupted => {}
        () = terminated() => {}
    }
}

/// Somebody asks the program to end (SIGTERM), or its terminal has gone (SIGHUP).
#[cfg(unix)]
async fn terminated() {
    use tokio::signal::unix::{SignalKind, signal};
    let asked = async |kind| match signal(kind) {
        Ok(mut signal) => drop(signal.recv().await),
        Err(_) => std::future::pending().await,
    };
    let hung_up = async {
        match outlives_its_terminal() {
            true => std::future::pending().await,
            false => asked(SignalKind::hangup()).await,
        }
    };
    tokio::select! {
        () = asked(SignalKind::terminate()) => {}
        () = hung_up => {}
    }
}

/// The same where there are no such signals.
#[cfg(not(unix))]
async fn terminated() {
    std::future::pending().await
}

/// Whether the program was started under `nohup`: SIGHUP, signal 1, is ignored, and stays so.
#[cfg(unix)]
fn outlives_its_terminal() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & 1 != 0)
}
