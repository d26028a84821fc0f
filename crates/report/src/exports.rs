//! The report in a browser: what `web/lab/report.js`, the worker that makes it, sees of it.

use crate::text::Language;
use crate::{EXPERIMENTS, Plan, Request, html};
use rumbo_experiment::files::Library;
use serde_json::json;
use std::sync::atomic::{AtomicU64, Ordering};
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_name = postMessage)]
    fn post(part: f64);

    #[wasm_bindgen(js_namespace = console)]
    fn error(text: &str);
}

/// A panic says why on the console before it ends the worker.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| error(&panic.to_string())));
}

/// The experiments in the report's order, each with its `name` and its `title` in a language, as JSON.
#[wasm_bindgen]
pub fn experiments(language: &str) -> String {
    let language = Language::of_locale(language);
    let entry = |experiment: &crate::Experiment| json!({ "name": experiment.name, "title": experiment.title(language) });
    json!(EXPERIMENTS.iter().map(entry).collect::<Vec<_>>()).to_string()
}

/// The file that `rumbo experiments` writes of the named experiments, or of all if there is no name. It posts the part that
/// is done, 0 to 1, after each run.
#[wasm_bindgen]
pub fn report(only: Vec<String>, seed: u32, language: &str) -> Result<Vec<u8>, String> {
    let language = Language::of_locale(language);
    let request = Request {
        only,
        seed: seed.into(),
        ..Request::default()
    };
    let plan = Plan::new(&Library::new(), request).map_err(|error| error.to_string())?;
    let (stamp, all_s) = (plan.stamp(language), plan.simulated_s());
    let done_ms = AtomicU64::new(0);
    let data = plan.run(|simulated_s| {
        let length_ms = (1e3 * simulated_s) as u64;
        let before_ms = done_ms.fetch_add(length_ms, Ordering::Relaxed);
        post((before_ms + length_ms) as f64 / (1e3 * all_s));
    });
    let data = data.map_err(|error| error.to_string())?;
    let (page, _) = html(&data, language).map_err(|error| error.to_string())?;
    Ok(stamp.put_on(page))
}
