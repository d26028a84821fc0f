//! One page's WebSocket: news from the board out, orders in.
//!
//! The two directions do not wait for each other: a page that is slow to read can still stop the robot. A page that
//! sends what is no order is told why and closed; the robot goes on.

use crate::board::{Board, ConsoleText, Cursor, LoggedEvent, News, State};
use crate::catalogue::{self, ModeEntry, ParameterState};
use crate::orders::{self, Order};
use crate::row::{Cell, Row};
use crate::target::Scene;
use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use rumbo_wire::Command;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::Duration;
use tokio::time::{sleep, timeout};

/// Longest message of a page [bytes].
pub(crate) const MAX_MESSAGE: usize = 4_096;
/// Rows of samples in one message.
const ROWS_PER_MESSAGE: usize = 500;
/// News within this time go out together: a page draws 60 times a second at most.
const GATHER: Duration = Duration::from_millis(15);
/// A page that takes nothing for this long is closed; it comes back by itself and gets the recent past.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);

/// What every connection shares.
#[derive(Clone, Debug)]
pub(crate) struct Hub {
    pub(crate) board: Arc<Board>,
    pub(crate) orders: SyncSender<Order>,
    pub(crate) stop: Arc<AtomicBool>,
}

/// To a page.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum ToPage<'a> {
    /// First of all: what the rest is made of.
    Hello {
        version: &'static str,
        columns: &'a [&'static str],
        modes: Vec<ModeEntry>,
    },
    /// What surrounds the robot; `None` with a real one.
    Scene { run: u32, scene: &'a Option<Scene> },
    /// The parameter table with its values.
    Parameters { parameters: &'a [ParameterState] },
    /// What changes slowly.
    State { state: &'a State },
    /// Rows of signals; what the page has of another run is over.
    Samples { run: u32, rows: Vec<Vec<Cell>> },
    /// What happened.
    Events { events: &'a [LoggedEvent] },
    /// What the USARTs of an emulated chip said.
    Consoles { run: u32, said: &'a [ConsoleText] },
    /// Why the connection is closed now.
    Error { text: &'a str },
}

/// Why a connection ends.
struct Goodbye {
    code: u16,
    text: String,
}

/// Serves one page until either side ends it.
pub(crate) async fn talk(socket: WebSocket, hub: Hub) {
    let (mut out, from_page) = socket.split();
    let goodbye = tokio::select! {
        goodbye = tell_news(&mut out, &hub.board) => goodbye,
        goodbye = take_orders(from_page, &hub) => goodbye,
    };
    if let Some(goodbye) = goodbye {
        // The page may be gone; then there is nobody to tell.
        let _ = timeout(SEND_TIMEOUT, say_goodbye(&mut out, goodbye)).await;
    }
}

async fn say_goodbye(
    out: &mut SplitSink<WebSocket, Message>,
    goodbye: Goodbye,
) -> Result<(), axum::Error> {
    if let Ok(text) = serde_json::to_string(&ToPage::Error {
        text: &goodbye.text,
    }) {
        out.send(Message::Text(text.into())).await?;
    }
    // A close frame has room for 123 bytes.
    let reason: String = goodbye
        .text
        .chars()
        .filter(char::is_ascii)
        .take(123)
        .collect();
    out.send(Message::Close(Some(CloseFrame {
        code: goodbye.code,
        reason: reason.into(),
    })))
    .await
}

async fn take_orders(mut from_page: SplitStream<WebSocket>, hub: &Hub) -> Option<Goodbye> {
    while let Some(Ok(message)) = from_page.next().await {
        let text = match message {
            Message::Text(text) => text,
            Message::Binary(_) => {
                return Some(Goodbye {
                    code: close_code::UNSUPPORTED,
                    text: "not understood: binary message".into(),
                });
            }
            Message::Close(_) => return None,
            Message::Ping(_) | Message::Pong(_) => continue,
        };
        let order = match orders::parse(&text) {
            Ok(order) => order,
            Err(error) => {
                return Some(Goodbye {
                    code: close_code::POLICY,
                    text: error.to_string(),
                });
            }
        };
        if order == Order::Robot(Command::Stop) {
            hub.stop.store(true, Ordering::SeqCst);
        }
        // A full queue holds many orders that wake the session all the same, and STOP has its own way.
        if hub.orders.try_send(order).is_err() {
            return Some(Goodbye {
                code: close_code::AGAIN,
                text: "too many orders at once".into(),
            });
        }
    }
    None
}

/// Ends when the page cannot be told any more.
async fn tell_news(out: &mut SplitSink<WebSocket, Message>, board: &Board) -> Option<Goodbye> {
    let mut changed = board.subscribe();
    let mut cursor = Cursor::default();
    let columns: Vec<_> = Row::names().collect();
    let hello = ToPage::Hello {
        version: env!("CARGO_PKG_VERSION"),
        columns: &columns,
        modes: catalogue::modes(),
    };
    send(out, &hello).await?;
    loop {
        let news = board.news(&mut cursor);
        if news.events_gone > 0 {
            return Some(Goodbye {
                code: close_code::AGAIN,
                text: "too slow: events were missed".into(),
            });
        }
        send_news(out, news).await?;
        sleep(GATHER).await;
        changed.changed().await.ok()?;
    }
}

async fn send_news(out: &mut SplitSink<WebSocket, Message>, news: News) -> Option<()> {
    let run = news.run;
    if let Some(scene) = &news.scene {
        send(out, &ToPage::Scene { run, scene }).await?;
    }
    if let Some(state) = &news.state {
        send(out, &ToPage::State { state }).await?;
    }
    if let Some(parameters) = &news.parameters {
        send(out, &ToPage::Parameters { parameters }).await?;
    }
    if !news.events.is_empty() {
        send(
            out,
            &ToPage::Events {
                events: &news.events,
            },
        )
        .await?;
    }
    if !news.consoles.is_empty() {
        let said = &news.consoles;
        send(out, &ToPage::Consoles { run, said }).await?;
    }
    for chunk in news.samples.chunks(ROWS_PER_MESSAGE) {
        send(
            out,
            &ToPage::Samples {
                run,
                rows: chunk.iter().map(Row::cells).collect(),
            },
        )
        .await?;
    }
    Some(())
}

async fn send(out: &mut SplitSink<WebSocket, Message>, message: &ToPage<'_>) -> Option<()> {
    let text = serde_json::to_string(message).ok()?;
    timeout(SEND_TIMEOUT, out.send(Message::Text(text.into())))
        .await
        .ok()?
        .ok()
}
