//! One page's WebSocket: news from the board out, orders in.
//!
//! The two directions do not wait for each other: a page that is slow to read can still stop the robot. A page that
//! sends what is no order is told why and closed; the robot goes on. A page that is slow loses samples of plots and gets every event.
//!
//! STOP is taken from every page, anything else from the page that has control ([`Lease`]).

use crate::board::{Board, Cursor, Heard, News};
use crate::catalogue::{self, ModeEntry};
use crate::console::ConsoleText;
use crate::guard::Role;
use crate::lease::{Lease, Place, Seat, View};
use crate::orders::{self, Order};
use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use futures_util::stream::SplitSink;
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use rumbo_log::{Burst, Cell, Level, LoggedEvent, ParameterState, Row, Scene, State};
use rumbo_wire::Command;
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{interval, sleep, timeout};

/// Longest message of a page [bytes].
pub(crate) const MAX_MESSAGE: usize = 4_096;
/// Rows of samples in one message.
const ROWS_PER_MESSAGE: usize = 250;
/// Rows that a page gets at once while it keeps up; of more it gets the newest.
const ROWS_AT_ONCE: usize = 500;
/// Refusals that wait for a page.
const REFUSALS_WAITING: usize = 8;
/// News within this time go out together: a page draws 60 times a second at most.
const GATHER: Duration = Duration::from_millis(15);
/// A page that takes nothing for this long is closed; it comes back by itself and gets the recent past.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);
/// A page is asked this often whether it is there; browsers answer by themselves.
const PING: Duration = Duration::from_secs(5);
/// A page that says nothing for this long, no answer either, is gone: its computer sleeps, or the network is cut.
const SILENCE: Duration = Duration::from_secs(15);

/// What every connection shares.
#[derive(Clone, Debug)]
pub(crate) struct Hub {
    pub(crate) board: Arc<Board>,
    pub(crate) orders: SyncSender<Order>,
    pub(crate) stop: Arc<AtomicBool>,
    pub(crate) lease: Lease,
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
    Samples {
        run: u32,
        heard: Heard,
        rows: Vec<Vec<Cell>>,
    },
    /// What happened.
    Events { events: &'a [LoggedEvent] },
    /// What the USARTs of an emulated chip said.
    Consoles { run: u32, said: &'a [ConsoleText] },
    /// Raw bytes of the link.
    Bytes { bytes: Vec<LinkBytes> },
    /// Who has control.
    Control(View),
    /// Why the connection is closed now.
    Error { text: &'a str },
}

/// Bytes that crossed the link together, as the page gets them.
#[derive(Debug, Serialize)]
struct LinkBytes {
    t_s: f64,
    to_robot: bool,
    hex: String,
}

impl LinkBytes {
    fn of(burst: &Burst) -> Self {
        Self {
            t_s: burst.t_us as f64 / 1e6,
            to_robot: burst.to_robot,
            hex: burst
                .bytes
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect(),
        }
    }
}

/// Why a connection ends.
struct Goodbye {
    code: u16,
    text: String,
}

/// Serves one page until either side ends it.
pub(crate) async fn talk(socket: WebSocket, hub: Hub, role: Role) {
    let (mut out, mut from_page) = socket.split();
    let goodbye = match hub.lease.sit_down(role == Role::Controller) {
        Some(place) => {
            let (refuse, refusals) = mpsc::channel(REFUSALS_WAITING);
            // Control goes with the page's place, however long it takes to say goodbye.
            tokio::select! {
                goodbye = tell_news(&mut out, &hub, &place, refusals) => goodbye,
                goodbye = take_orders(&mut from_page, &hub, &place, &refuse) => goodbye,
            }
        }
        None => Some(Goodbye {
            code: close_code::AGAIN,
            text: "too many pages are open: close some of them".into(),
        }),
    };
    if let Some(goodbye) = goodbye {
        // The page may be gone; then nobody needs to know.
        let _ = timeout(SEND_TIMEOUT, async {
            say_goodbye(&mut out, goodbye).await?;
            // A connection with unread bytes would be reset, and the reason lost on its way.
            while let Some(Ok(_)) = from_page.next().await {}
            Ok::<(), axum::Error>(())
        })
        .await;
    }
}

/// Whether the page may have this order done; why not otherwise.
fn admit(order: &Order, place: &Place) -> Result<(), &'static str> {
    let may = match order {
        Order::Robot(Command::Stop) => true,
        Order::TakeControl => place.take(),
        Order::ReleaseControl => {
            place.release();
            true
        }
        _ => place.ask(),
    };
    match (may, place.seat()) {
        (true, _) => Ok(()),
        (false, Seat::Viewer) => Err("refused: this page may watch, and stop the robot"),
        (false, _) => Err("refused: another page has control; take it first"),
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

/// Ends when the page does, or says what is no order, or nothing any more.
async fn take_orders(
    mut from_page: impl Stream<Item = Result<Message, axum::Error>> + Unpin,
    hub: &Hub,
    place: &Place,
    refuse: &mpsc::Sender<&'static str>,
) -> Option<Goodbye> {
    // After silence nobody is left to hear why.
    while let Ok(Some(Ok(message))) = timeout(SILENCE, from_page.next()).await {
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
        if let Err(why) = admit(&order, place) {
            // Of many refusals a page need not read each.
            let _ = refuse.try_send(why);
            continue;
        }
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
async fn tell_news(
    out: &mut (impl Sink<Message> + Unpin),
    hub: &Hub,
    place: &Place,
    mut refusals: mpsc::Receiver<&'static str>,
) -> Option<Goodbye> {
    let (mut changed, mut moved) = (hub.board.subscribe(), hub.lease.subscribe());
    let mut cursor = Cursor::default();
    let columns: Vec<_> = Row::names().collect();
    let hello = ToPage::Hello {
        version: env!("CARGO_PKG_VERSION"),
        columns: &columns,
        modes: catalogue::modes(),
    };
    send(out, &hello).await?;
    let (mut told, mut run, mut t_s) = (None, 0, 0.0);
    let mut pings = interval(PING);
    loop {
        let view = place.view();
        if told.replace(view) != Some(view) {
            send(out, &ToPage::Control(view)).await?;
        }
        let mut news = hub.board.news(&mut cursor);
        if news.events_gone > 0 {
            return Some(Goodbye {
                code: close_code::AGAIN,
                text: "too slow: events were missed".into(),
            });
        }
        // Behind within a run, it goes on with the newest.
        let behind = news.samples.len().saturating_sub(ROWS_AT_ONCE);
        if std::mem::replace(&mut run, news.run) == news.run {
            news.samples.drain(..behind);
        }
        t_s = news.state.as_ref().map_or(t_s, |state| state.t_s);
        while let Ok(text) = refusals.try_recv() {
            news.events.push(LoggedEvent {
                t_s,
                level: Level::Warning,
                text: text.into(),
            });
        }
        send_news(out, news).await?;
        sleep(GATHER).await;
        tokio::select! {
            changed = changed.changed() => changed.ok()?,
            moved = moved.changed() => moved.ok()?,
            _ = pings.tick() => put(out, Message::Ping(Bytes::new())).await?,
            Some(text) = refusals.recv() => {
                let events = [LoggedEvent { t_s, level: Level::Warning, text: text.into() }];
                send(out, &ToPage::Events { events: &events }).await?;
            }
        }
    }
}

async fn send_news(out: &mut (impl Sink<Message> + Unpin), news: News) -> Option<()> {
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
    if !news.bytes.is_empty() {
        let bytes = news.bytes.iter().map(LinkBytes::of).collect();
        send(out, &ToPage::Bytes { bytes }).await?;
    }
    for chunk in news.samples.chunks(ROWS_PER_MESSAGE) {
        send(
            out,
            &ToPage::Samples {
                run,
                heard: news.heard,
                rows: chunk.iter().map(Row::cells).collect(),
            },
        )
        .await?;
    }
    Some(())
}

async fn send(out: &mut (impl Sink<Message> + Unpin), message: &ToPage<'_>) -> Option<()> {
    let text = serde_json::to_string(message).ok()?;
    put(out, Message::Text(text.into())).await
}

async fn put(out: &mut (impl Sink<Message> + Unpin), message: Message) -> Option<()> {
    timeout(SEND_TIMEOUT, out.send(message)).await.ok()?.ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::sink::unfold;
    use futures_util::stream::poll_fn;
    use std::future::ready;

    fn hub() -> Hub {
        Hub {
            board: Arc::new(Board::new()),
            orders: std::sync::mpsc::sync_channel(1).0,
            stop: Arc::default(),
            lease: Lease::new(),
        }
    }

    /// To a page, with room for one message on the way, as in full buffers of a connection.
    fn connection() -> (impl Sink<Message> + Unpin, mpsc::Receiver<Message>) {
        let (to_page, page) = mpsc::channel(1);
        let send = |to_page: mpsc::Sender<Message>, message| async move {
            to_page.send(message).await.map(|()| to_page)
        };
        (Box::pin(unfold(to_page, send)), page)
    }

    #[test]
    fn a_viewer_may_stop_and_nothing_else_and_so_may_a_page_without_control() {
        let hub = hub();
        let (driver, other, viewer) = (
            hub.lease.sit_down(true).unwrap(),
            hub.lease.sit_down(true).unwrap(),
            hub.lease.sit_down(false).unwrap(),
        );
        let (stop, arm) = (Order::Robot(Command::Stop), Order::Robot(Command::Arm));
        // STOP takes no control.
        assert!(admit(&stop, &other).is_ok() && other.seat() == Seat::Free);
        assert!(admit(&arm, &viewer).unwrap_err().contains("watch"));
        assert!(admit(&arm, &driver).is_ok());
        assert!(admit(&arm, &other).unwrap_err().contains("another page"));
        for order in [Order::Speed(2.0), Order::Seek(1.0), Order::TakeControl] {
            assert!(admit(&order, &viewer).is_err(), "{order:?}");
        }
        assert!(
            [&driver, &other, &viewer]
                .iter()
                .all(|page| admit(&stop, page).is_ok())
        );
        assert!(admit(&Order::TakeControl, &other).is_ok());
        assert!(admit(&arm, &driver).is_err());
    }

    #[tokio::test(start_paused = true)]
    async fn a_page_that_answers_no_ping_is_given_up_and_one_that_does_is_not() {
        let hub = hub();
        let place = hub.lease.sit_down(true).unwrap();
        let (refuse, refusals) = mpsc::channel(1);
        let (mut out, mut page) = connection();
        let begun = tokio::time::Instant::now();
        // It answers ten pings, and then none.
        let answers = poll_fn(|context| page.poll_recv(context))
            .filter(|message| ready(matches!(message, Message::Ping(_))))
            .enumerate()
            .filter_map(|(ping, _)| ready((ping < 10).then(|| Ok(Message::Pong(Bytes::new())))));
        let goodbye = tokio::select! {
            _ = tell_news(&mut out, &hub, &place, refusals) => panic!("the page takes all"),
            goodbye = take_orders(Box::pin(answers), &hub, &place, &refuse) => goodbye,
        };
        assert!(goodbye.is_none());
        let lasted = begun.elapsed();
        assert!(
            lasted >= 9 * PING + SILENCE && lasted < 10 * PING + SILENCE,
            "{lasted:?}"
        );
    }

    #[tokio::test]
    async fn a_page_that_takes_nothing_for_a_while_loses_samples_and_no_event() {
        const ROUNDS: usize = 300;
        let hub = hub();
        let board = Arc::clone(&hub.board);
        let place = hub.lease.sit_down(true).unwrap();
        let (mut out, mut page) = connection();
        let (_refuse, refusals) = mpsc::channel(1);
        let reader = async {
            for round in 0..ROUNDS {
                let rows: Vec<Row> = (0..100)
                    .map(|row| Row::unknown((100 * round + row) as i64))
                    .collect();
                board.push_samples(&rows);
                board.push_event(LoggedEvent {
                    t_s: 0.0,
                    level: Level::Info,
                    text: round.to_string(),
                });
                tokio::task::yield_now().await;
            }
            let (mut events, mut rows, mut last_s) = (Vec::new(), 0, 0.0);
            while events.len() < ROUNDS || last_s < (100 * ROUNDS - 1) as f64 / 1e3 {
                let text = match page.recv().await {
                    Some(Message::Text(text)) => text,
                    Some(Message::Ping(_)) => continue,
                    gone => panic!("the page was given up: {gone:?}"),
                };
                let message: serde_json::Value = serde_json::from_str(&text).unwrap();
                for event in message["events"].as_array().into_iter().flatten() {
                    events.push(event["text"].as_str().unwrap().to_owned());
                }
                for row in message["rows"].as_array().into_iter().flatten() {
                    rows += 1;
                    last_s = row[0].as_f64().unwrap();
                }
            }
            (events, rows)
        };
        let (events, rows) = tokio::select! {
            _ = tell_news(&mut out, &hub, &place, refusals) => panic!("the page was given up"),
            read = reader => read,
        };
        assert!(
            events
                .iter()
                .map(|text| text.parse::<usize>().unwrap())
                .eq(0..ROUNDS)
        );
        assert!(rows < 100 * ROUNDS, "{rows}");
    }
}
