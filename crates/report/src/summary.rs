//! The page around the chapters: what was run, whether it passed, the table of contents, what was left out.

use crate::chapters::{Experiment, Highlight};
use crate::data::Data;
use crate::judge::{self, KEPT, MISSED};
use crate::metric_names::shown;
use crate::page::{Cell, Page, Tone};
use crate::text::{Language, Text, escape, t};

const STYLE: &str = include_str!("style.css");

const TITLE: Text = t(
    "Experiments with a mobile robot",
    "Experimentos con un robot móvil",
);
const SUBTITLE: Text = t(
    "A differential-drive robot, mode by mode: rig, control scheme, mathematics, results",
    "Un robot diferencial, modo a modo: montaje, esquema de control, cálculos y resultados",
);
const VERSION: Text = t("Version", "Versión");
const SEED: Text = t("Seed", "Semilla");
const ROBOT: Text = t("Robot", "Robot");
const PROGRAM: Text = t("Program", "Programa");
const NATIVE: Text = t(
    "Rumbo's control core, native",
    "núcleo de control de Rumbo, ejecución nativa",
);
const IMAGE: Text = t(
    "{} on an emulated ATmega2560 (CRC-32 {})",
    "{} en un ATmega2560 emulado (CRC-32 {})",
);
const RECORDED: Text = t("Recorded runs", "Registros reales");
const NONE: Text = t("none given", "no se han indicado");
const ALL_PASS: Text = t(
    "All {} experiments meet their limits.",
    "Los {} experimentos cumplen sus límites.",
);
const ONE_PASSES: Text = t(
    "The experiment meets its limits.",
    "El experimento cumple sus límites.",
);
const SOME_MISS: Text = t(
    "{} of {} experiments miss a limit.",
    "{} de {} experimentos no cumplen algún límite.",
);
const SUMMARY: Text = t("Summary", "Resumen");
const CONTENTS: Text = t("Contents", "Contenidos");
const HEADER: [Text; 5] = [
    t("Experiment", "Experimento"),
    t("Result", "Resultado"),
    t("Quantity", "Magnitud"),
    t("Here", "Aquí"),
    t(
        "Robot of the original report",
        "Robot de la memoria original",
    ),
];
const SUMMARY_NOTE: Text = t(
    "Every value comes from one run with the seed above; another seed is another robot: other friction, battery, wheels and noise. \
     The last column is what the original work's own robot did, where it is known.",
    "Cada valor procede de una única ejecución con la semilla indicada; otra semilla es otro robot: cambian el rozamiento, la batería, \
     las ruedas y el ruido. La última columna recoge lo que hizo el robot del trabajo original, cuando se conoce.",
);
const SKIPPED: Text = t(
    "Recorded files that are not shown",
    "Ficheros registrados que no se muestran",
);
const HOW: Text = t("How to read this report", "Cómo leer este informe");
const HOW_SIGNALS: Text = t(
    "Curves show what the station received from the robot over the link, 25 times a second: speeds, ranges and pose are the robot's own \
     estimates. PWM is taken at the bridges. Curves called *true* come from the simulation itself, and so do all metrics: a program \
     cannot improve its marks by what it tells. Time counts from the instant at which the robot is armed.",
    "Las curvas muestran lo que la estación recibe del robot por el enlace, 25 veces por segundo: velocidades, distancias y pose son \
     estimaciones del propio robot. La PWM se mide en los puentes en H. Las curvas llamadas *reales* proceden de la simulación, igual \
     que todas las métricas: ningún programa puede mejorar su nota por lo que cuenta de sí mismo. El tiempo se cuenta desde el instante en \
     que se arma el robot.",
);
const HOW_SILENT: Text = t(
    "In some experiments the program under test sends no telemetry that this report reads; there all curves are true ones.",
    "En algunos experimentos el programa ensayado no envía telemetría que este informe pueda leer; en ellos todas las curvas son las reales.",
);
const HOW_COLOURS: Text = t(
    "Left is blue, right is orange (in grey: dark and light), what is ahead or true is green; what was asked for is dashed, and what is true dash-dotted where it lies \
     over what the robot believes. x points ahead, y to the left, headings \
     count counter-clockwise. Distances that limits judge are those of a robot that hears sound at 343.4 m/s, since none can know the \
     temperature of the air.",
    "El azul es la izquierda, el naranja la derecha (en gris: oscuro y claro) y el verde lo que está delante o es real; lo que se pide va a trazos, y lo real, a \
     trazo y punto donde se superpone a lo que cree el robot. El eje x apunta hacia delante, el y hacia la izquierda y los ángulos crecen en sentido antihorario. Las distancias sometidas a límites son las de un \
     robot que oye el sonido a 343,4 m/s, ya que ninguno puede conocer la temperatura del aire.",
);

/// The report as one HTML page, and each figure's identifier, in order.
#[must_use]
pub fn html(data: &Data, language: Language) -> (String, Vec<String>) {
    let mut page = Page::new(language);
    for experiment in &data.experiments {
        page.chapter(experiment.number, experiment.name, experiment.title);
        (experiment.write)(&mut page, data);
    }
    let figures = page.figure_ids().to_vec();
    let (chapters, contents) = page.finish();
    let front = front(data, language, &contents);
    let title = escape(TITLE.of(language));
    let page = format!(
        "<!doctype html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, \
         initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1><p class=\"subtitle\">{}</p></header>\n<main>\n{front}{chapters}</main>\n</body>\n</html>\n",
        language.tag(),
        escape(SUBTITLE.of(language)),
    );
    (page, figures)
}

/// What stands before the chapters.
fn front(data: &Data, language: Language, contents: &str) -> String {
    let mut page = Page::new(language);
    page.html(&verdict(data, language));
    page.html(&facts(data, language));
    page.html(&format!(
        "<h2 class=\"on\">{}</h2>\n",
        escape(SUMMARY.of(language))
    ));
    summary(&mut page, data);
    page.p(SUMMARY_NOTE);
    if !data.real.skipped.is_empty() {
        page.section(SKIPPED);
        let rows: Vec<_> = data
            .real
            .skipped
            .iter()
            .map(|skipped| {
                let file = format!("<code translate=\"no\">{}</code>", escape(&skipped.file));
                vec![Cell::html(file), Cell::text(skipped.why.of(language))]
            })
            .collect();
        page.table(&[], &rows);
    }
    page.html(&format!(
        "<h2 class=\"on\">{}</h2>\n<nav>{contents}</nav>\n",
        escape(CONTENTS.of(language))
    ));
    page.html(&format!(
        "<h2 class=\"on\">{}</h2>\n",
        escape(HOW.of(language))
    ));
    if data.outcomes.values().any(|outcome| !outcome.tells()) {
        page.p(HOW_SILENT);
    }
    page.p(HOW_SIGNALS);
    page.p(HOW_COLOURS);
    page.finish().0
}

fn verdict(data: &Data, language: Language) -> String {
    let all = data.experiments.len();
    let missed = data
        .experiments
        .iter()
        .filter(|experiment| !data.passes(experiment))
        .count();
    let (class, text) = match (missed, all) {
        (0, 1) => ("good", ONE_PASSES.of(language).to_owned()),
        (0, _) => ("good", ALL_PASS.with(language, &[&all.to_string()])),
        _ => (
            "bad",
            SOME_MISS.with(language, &[&missed.to_string(), &all.to_string()]),
        ),
    };
    format!("<p class=\"verdict {class}\">{}</p>\n", escape(&text))
}

fn facts(data: &Data, language: Language) -> String {
    let program = match &data.firmware {
        None => NATIVE.of(language).to_owned(),
        Some([file, crc]) => IMAGE.with(language, &[file, crc]),
    };
    let files: Vec<&str> = data
        .real
        .runs
        .values()
        .map(|run| run.file.as_str())
        .collect();
    let recorded = if files.is_empty() {
        NONE.of(language).to_owned()
    } else {
        files.join(", ")
    };
    let rows = [
        (VERSION, format!("Rumbo {}", env!("CARGO_PKG_VERSION"))),
        (SEED, data.seed.to_string()),
        (ROBOT, data.robot[0].clone()),
        (PROGRAM, program),
        (RECORDED, recorded),
    ];
    let rows: String = rows
        .iter()
        .map(|(name, value)| {
            format!(
                "<dt>{}</dt><dd>{}</dd>\n",
                escape(name.of(language)),
                escape(value)
            )
        })
        .collect();
    format!("<dl class=\"facts\">\n{rows}</dl>\n")
}

/// Each experiment's verdict and most telling values.
fn summary(page: &mut Page, data: &Data) {
    let mut rows = Vec::new();
    for experiment in &data.experiments {
        let (verdict, tone) = if data.passes(experiment) {
            (KEPT, Tone::Good)
        } else {
            (MISSED, Tone::Bad)
        };
        let link = format!(
            "<a href=\"#{}\">{}</a>",
            experiment.name,
            escape(page.say(experiment.title))
        );
        let mut first = vec![Cell::html(link), Cell::text(page.say(verdict)).tone(tone)];
        for cells in highlights(page.language, data, experiment) {
            let mut row = std::mem::replace(&mut first, vec![Cell::text(""), Cell::text("")]);
            row.extend(cells);
            rows.push(row);
        }
    }
    let header = HEADER.map(|text| page.say(text));
    page.table(&header, &rows);
}

fn highlights(language: Language, data: &Data, experiment: &Experiment) -> Vec<[Cell; 3]> {
    let row = |highlight: &Highlight| {
        let outcome = data.outcome(highlight.scenario)?;
        let shown = shown(language, outcome, highlight.metric)?;
        let ours = judge::value(language, &shown, outcome.metric(highlight.metric)?);
        let real = highlight
            .real
            .map(|real| judge::value(language, &shown, real))
            .unwrap_or_default();
        let name = highlight.of.map_or_else(
            || shown.name.clone(),
            |of| format!("{}: {}", judge::capital(of.of(language)), shown.bare),
        );
        Some([Cell::text(&name), Cell::text(&ours), Cell::text(&real)])
    };
    let rows: Vec<_> = experiment.highlights.iter().filter_map(row).collect();
    if rows.is_empty() {
        vec![[Cell::text(""), Cell::text(""), Cell::text("")]]
    } else {
        rows
    }
}
