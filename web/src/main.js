// @ts-check
/**
 * The dashboard: connects the link, the store and the views. Nothing is drawn unless data arrived or a view changed.
 *
 * For tests and for the browser's console, `window.rumbo` gives the signals as plotted.
 */
import { Alarm } from './alarm.js';
import { CalibrationDialog } from './calibration_dialog.js';
import { CheckupDialog } from './checkup_dialog.js';
import { CodePanel } from './code_panel.js';
import { Consoles } from './consoles.js';
import { create, element, onFrame, setText } from './dom.js';
import { makeEnlargeable } from './enlarge.js';
import { EventList } from './events.js';
import { ExperimentPanel } from './experiment.js';
import { IDENTITY } from './geometry.js';
import { Header, titleWords } from './header.js';
import { makeHelp } from './help.js';
import { OWN_PROGRAM } from './layout.js';
import { LayoutDialog } from './layout_dialog.js';
import { LawPanel } from './law_panel.js';
import { Lessons } from './lessons.js';
import { Link } from './link.js';
import { LinkMeter } from './linkmeter.js';
import { Machine } from './machine.js';
import { WorldMap } from './map.js';
import { bodyOf } from './mounts.js';
import { CommandPanel } from './panel.js';
import { Notice } from './notice.js';
import { ParameterTable } from './parameters.js';
import { PlotDialog } from './plot_dialog.js';
import { Plots } from './plots.js';
import { ProfilePanel } from './profile.js';
import { PARTS, PartsPanel } from './parts.js';
import { ProgramPanel, isOwn } from './program.js';
import { Recordings } from './recordings.js';
import { ReplayBar } from './replay.js';
import { ReportDialog } from './report_dialog.js';
import { RobotPort } from './robot_port.js';
import { listen, offerRobots, openScenario } from './robots.js';
import { Runs } from './runs.js';
import { Seat, isOthers } from './seat.js';
import { Share } from './share.js';
import { isEmbedded, linkPages } from './site.js';
import { StateLine, pointerWords } from './stateline.js';
import { StepFigures, figures } from './step.js';
import { Store } from './store.js';
import { Tabs } from './tabs.js';
import { LANGUAGES, language, speak, t, translatePage, untranslated } from './text.js';
import { Timeline } from './timeline.js';
import { Tour } from './tour.js';
import { TuneDialog } from './tune_dialog.js';
import { Video } from './video.js';
import { Why } from './why.js';
import { WorkerLink, isSite } from './worker_link.js';
import { WorldEditor } from './world_editor.js';

translatePage();
const languages = element('language', HTMLSelectElement);
languages.replaceChildren(...Object.entries(LANGUAGES).map(([code, name]) => create('option', { value: code, textContent: name, lang: code })));
languages.value = language;
languages.addEventListener('change', () => speak(languages.value));

/** @typedef {import('./types.js').FromServer} FromServer */
/** @typedef {import('./types.js').State} State */

const store = new Store();
/** @type {State | null} */
let state = null;
/** The station's. @type {string | null} */
let version = null;
/** What is simulated around the robot. @type {import('./types.js').Scene | null} */
let simulated = null;
/** The page is of one of several robots in the world, which goes with the time of the first. */
let follows = false;
/** The names of all of them. @type {string[]} */
let robots = [];
/** The robot's, as far as they are known. @type {import('./types.js').Parameter[]} */
let table = [];
/** The sonars that the robot carries, by number. */
let sonars = [0, 1, 2];
/** One of them sits on a servo, as far as is known. */
let servo = true;

/** The robot's body, from the simulation, or else from the robot's parameters. */
function setBody() {
  const own = typeof state?.robot.rig === 'string' && table.length > 0 ? bodyOf(state.robot.rig, table) : null;
  map.body = own;
  sonars = (simulated ?? own)?.sonars.map(({ id }) => id).sort() ?? [0, 1, 2];
  servo = (simulated ?? own)?.sonars.some(({ on_servo }) => on_servo) ?? true;
  stateLine.sonars = sonars;
  stateLine.other_sonars = simulated?.other_sonars ?? [];
}

/** A program that sends no telemetry has other plots, until it sends some. */
function showSilence() {
  const silent = state !== null && isOwn(state) && store.silent;
  document.body.classList.toggle('silent', silent);
  if (state) plots.setMode(silent ? OWN_PROGRAM : state.robot.mode);
}

/** Minimum time between two messages that nothing is sent: a held key would repeat it five times a second [ms]. */
const UNSENT_MS = 1_000;
let unsent_ms = -UNSENT_MS;

/** @param {import('./types.js').Order} order */
function send(order) {
  if (isOthers(order)) return header.setScene(follows ? null : simulated);
  if (link.send(order)) return;
  if (order.type !== 'stop' && performance.now() - unsent_ms < UNSENT_MS) return;
  unsent_ms = performance.now();
  complain(isSite ? 'not sent: the lab of this page is not there' : order.type === 'stop' ? 'STOP was not sent: there is no connection to the station' : 'not sent: there is no connection to the station');
}

/** In place of a USART: a hand. */
const HAND = 6;

/** What a hand does in the simulated world. @param {string} text */
const hand = (text) => send({ type: 'type', usart: HAND, text, ending: 'none' });

/** @param {string} text */
function complain(text) {
  events.add([{ t_s: state?.t_s ?? 0, level: 'warning', text }]);
}

/** Asks the session of the site. @param {Parameters<WorkerLink['ask']>[0]} what */
function askLab(what) {
  if (link instanceof WorkerLink) link.ask(what);
}

/** Shows a recording in place of the site's lab. @param {File} file */
function showRecording(file) {
  if (link instanceof WorkerLink) link.show(file).catch((error) => complain(`${file.name}: ${error}`));
}

/** When samples came last, and after how long without any the readings of sonars are drawn by themselves [ms]. */
let sampled_ms = -Infinity;
const QUIET_MS = 100;
/** When the data drawn next was received; and times from there to the frame after, while a test measures. */
const ages = { received_ms: 0, session_ms: 0, drawn: false, measured: /** @type {number[] | null} */ (null) };

const redraw = onFrame(() => {
  if (ages.measured && !ages.drawn) {
    const { received_ms } = ages;
    ages.drawn = true;
    requestAnimationFrame(() => ages.measured?.push(performance.timeOrigin + performance.now() - received_ms));
  }
  draw();
});

/** What the pointer moves. */
function drawMap() {
  map.draw();
  setText(pointer, pointerWords(map.pointed()));
}

/** All that moves. */
function draw() {
  drawMap();
  plots.update();
  stateLine.draw();
  timeline.draw();
  stepFigures.show(panel.mode);
  machine.draw();
  law.draw();
}
const header = new Header(send);
const seat = new Seat(send);
const parameters = new ParameterTable(send);
const replay = new ReplayBar(send, () => askLab('resume'));
const events = new EventList((t_s) => (replay.shown ? replay.seek(t_s) : timeline.lookAt(t_s)));
const consoles = new Consoles(send, (usart) => store.readings.printedBy(usart).length > 0, (usart) => plots.showPrinted(usart));
const parts = new PartsPanel(send);
const program = new ProgramPanel(send, complain, showRecording, (files) => openScenario(files, askLab, complain));
listen(askLab, () => simulated?.choice ?? null);
/** The runs that the consoles are of, and the plots. @type {[number | null, number | null]} */
let [consoleRun, shownRun] = [null, null];
const map = new WorldMap(element('map', HTMLCanvasElement), store, onFrame(drawMap));
const panel = new CommandPanel(send, map);
const experiment = new ExperimentPanel(send);
const lessons = new Lessons(send);
const editor = new WorldEditor(send, map);
const code = new CodePanel(send, (t_s) => timeline.lookAt(t_s ?? Infinity));
const machine = new Machine(store);
const law = new LawPanel(send, store);
const meter = new LinkMeter();
const tabs = new Tabs('tabs', (panel) => meter.show(panel === 'bytes'));
const profile = new ProfilePanel(send, () => tabs.show('event-panel'));
tabs.show('event-panel');
const stateLine = new StateLine(store, send);
const stepFigures = new StepFigures(store, (figures) => lessons.fill(figures));
const alarm = new Alarm();
const pointer = element('pointer', HTMLOutputElement);
element('ghost-here', HTMLButtonElement).addEventListener('click', () => send({ type: 'restart_ghost' }));
element('fit', HTMLButtonElement).addEventListener('click', () => map.fit());
const pause = element('pause', HTMLButtonElement);
const live = element('live', HTMLButtonElement);
const plots = new Plots(element('plots', HTMLDivElement), store, redraw, (following) => {
  pause.setAttribute('aria-pressed', String(!following));
  live.classList.toggle('good', following);
});
plots.follow(true);
const video = new Video(replay, () => [Math.max(0, plots.range_s[0]), Math.min(state?.replay?.duration_s ?? 0, plots.range_s[1])]);
plots.onPoint = onFrame(() => map.hover(plots.pointed_s));
const timeline = new Timeline(store, redraw);
live.addEventListener('click', () => timeline.follow());

pause.addEventListener('click', () => plots.follow(!plots.following));
live.addEventListener('click', () => plots.follow(true));
element('clear', HTMLButtonElement).addEventListener('click', () => {
  store.clear();
  redraw();
});
const plotDialog = new PlotDialog(plots);
plots.edit = plotDialog.open.bind(plotDialog);
element('add-plot', HTMLButtonElement).addEventListener('click', () => plotDialog.open(null));
const layoutDialog = new LayoutDialog(plots);
element('layouts', HTMLButtonElement).addEventListener('click', () => layoutDialog.open());
const checkup = new CheckupDialog(send, store, () => state);
element('checkup', HTMLButtonElement).addEventListener('click', () => checkup.open(sonars, servo));
const recordings = new Recordings(askLab, showRecording);
const runs = new Runs(() => {
  if (store.slow.t.length === 0) return null;
  const { scenario = null, world = null, rig = null, seed = null } = simulated?.choice ?? {};
  const parameters = Object.fromEntries(table.flatMap(({ name, value }) => (value === null ? [] : [[name, value]])));
  const name = `${new Date().toLocaleTimeString(language === 'en' ? 'en-GB' : language)}${seed === null ? '' : `, ${t('seed {}', seed)}`}`;
  const metrics = Object.fromEntries(state?.experiment?.limits.map((limit) => [limit.name, limit.value]) ?? []);
  return { name, store: store.frozen(), about: { scenario, world, 'sensor layout': rig, seed, program: state?.program?.name ?? null }, parameters, metrics };
}, () => plots.modes, send, plots, map, complain);
const why = new Why(plots, isSite ? (from_s, to_s) => (link instanceof WorkerLink ? link.explain(from_s, to_s) : Promise.reject(new Error('no lab'))) : null, (lesson) => lessons.open(lesson), () => tabs.show('why'));
const calibration = new CalibrationDialog(send);
new Share(() => ({ scene: simulated, table, version: version ?? '' }), () => (link instanceof WorkerLink ? link.share() : Promise.reject(new Error('no lab'))));
const report = new ReportDialog();
const tune = new TuneDialog(send);
/** @type {import('./wire_dialog.js').WireDialog | null} */
let wired = null;
// A site has nothing that compiles.
element('wire', HTMLButtonElement).hidden = isSite;
element('wire', HTMLButtonElement).addEventListener('click', async () => {
  const { WireDialog } = await import('./wire_dialog.js');
  (wired ??= new WireDialog(send)).open();
});
recordings.compare = tune.compare = runs.compare.bind(runs);
const robotPort = new RobotPort(askLab);
element('calibrate', HTMLButtonElement).addEventListener('click', () => calibration.open());
makeEnlargeable();
const tour = new Tour();
const help = makeHelp(() => tour.begin());
element('help', HTMLButtonElement).addEventListener('click', help);
addEventListener('keydown', (event) => {
  // Space is STOP: Enter ticks.
  if (event.key === 'Enter' && event.target instanceof HTMLInputElement && event.target.type === 'checkbox') {
    event.preventDefault();
    event.target.click();
  }
  if (event.key === 'F1') {
    event.preventDefault();
    help();
  }
  const typing = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement || event.target instanceof HTMLTextAreaElement;
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === 'p') plots.follow(!plots.following);
  if (event.key === 'l') plots.follow(true);
  if (event.key === '?') help();
  if (!replay.shown) return;
  if (event.key === 'k') replay.toggle();
  if (event.key === ',') replay.step(-1);
  if (event.key === '.') replay.step(1);
});

// On a telephone one part at a time.
const views = element('views', HTMLElement);
views.addEventListener('click', ({ target }) => {
  if (!(target instanceof HTMLButtonElement)) return;
  document.querySelector('main')?.setAttribute('data-view', target.value);
  for (const each of views.querySelectorAll('button')) each.setAttribute('aria-pressed', String(each === target));
});

const top = element('top', HTMLElement);
// Dialogs open below it, however many lines it takes.
new ResizeObserver(() => document.documentElement.style.setProperty('--header', `${top.offsetHeight}px`)).observe(top);

/** @param {FromServer} message */
function receive(message) {
  header.received();
  switch (message.type) {
    case 'hello':
      // A station of another version serves another page.
      if (version !== null && message.version !== version) location.reload();
      version = message.version;
      store.begin(message.columns, message.modes);
      events.clear();
      consoles.clear();
      panel.setModes(message.modes);
      plots.modes = message.modes;
      stateLine.modes = message.modes;
      machine.modes = law.modes = message.modes;
      parameters.setModes(message.modes);
      tune.modes = message.modes;
      robots = message.robots ?? [];
      document.body.classList.toggle('several', robots.length > 0);
      follows = message.robot > 0;
      map.own = message.robot;
      offerRobots(robots, message.robot);
      meter.clear();
      break;
    case 'scene':
      store.setRun(message.run);
      store.start = message.scene?.start ?? IDENTITY;
      if (message.run !== consoleRun) consoles.clear();
      simulated = message.scene?.of_ghost ? null : message.scene;
      recordings.titles = new Map(message.scene?.experiments.map(({ name, title }) => [name, title]));
      // The first robot's page has the time and the choice for all.
      header.setScene(follows ? null : simulated);
      document.title = [...(robots.length > 0 ? [robots[map.own]] : []), ...(simulated ? [titleWords(recordings.titles.get(simulated.choice.scenario) ?? '')] : []), 'Rumbo'].filter(Boolean).join(' · ');
      map.setScene(message.scene);
      editor.setScene(simulated);
      tune.setScene(simulated);
      panel.setScene(message.scene);
      experiment.setScene(simulated);
      runs.setScene(simulated);
      stateLine.setScene(simulated);
      setBody();
      document.body.classList.toggle('simulated', simulated !== null);
      document.body.classList.toggle('haunted', false);
      break;
    case 'state':
      state = message.state;
      // The same scenario again has no new scene.
      lessons.setRun(message.run);
      if (message.run !== shownRun) {
        // The time that is held was of another run, as what explained it.
        why.clear();
        plots.follow(true);
        shownRun = message.run;
      }
      store.playhead_s = state.replay ? state.t_s : timeline.at_s;
      plots.whole_s = state.replay?.duration_s ?? null;
      setBody();
      header.show(state);
      replay.show(state);
      video.show(state);
      if (state.replay) editor.close();
      store.limits = state.experiment?.limits ?? null;
      store.experiment_end_s = state.experiment?.duration_s ?? Infinity;
      experiment.show(state);
      panel.show(state);
      stateLine.show(state);
      alarm.show(state);
      stepFigures.show(panel.mode);
      if (simulated && !isEmbedded && !isOwn(state) && !state.replay && !document.body.classList.contains('viewer')) tour.offer();
      if (isOwn(state)) tour.end();
      else tour.show(state);
      program.show(state);
      code.show(state, message.run);
      wired?.show(state, message.orders);
      parts.show(state.program?.parts ?? [], (signal) => store.readings.truth.columns.get(signal)?.at(-1) ?? null);
      profile.show(state);
      document.body.classList.toggle('own', isOwn(state));
      if (isOwn(state)) consoles.offerPorts(state.program?.link_usart ?? null);
      showSilence();
      if (state.replay) redraw();
      machine.setMode(state.robot.mode);
      law.setMode(isOwn(state) || state.robot.foreign ? -1 : state.robot.mode);
      if (table.length > 0 && state.robot.rig !== null) checkup.meet(sonars, servo);
      calibration.show(state);
      law.on_rad = state.robot.task.from?.[2] ?? NaN;
      meter.update(state);
      map.target = state.robot.armed && state.robot.task.route && state.robot.task.end === null ? state.robot.reference : null;
      map.setTask(state.robot.task);
      parameters.setMode(state.robot.mode, state.robot.text ? t('parameters are not available over the text protocol') : state.robot.foreign ? t('the robot has another table: not shown') : '');
      // Check and calibration use commands that such a robot does not have.
      document.body.classList.toggle('foreign', state.robot.foreign || Boolean(state.robot.text));
      map.servo_rad = state.robot.servo_rad;
      map.hand = simulated && !state.replay && state.experiment?.phase !== 'running' && !document.body.classList.contains('viewer') ? hand : null;
      break;
    case 'parameters':
      parameters.show(message.parameters);
      calibration.setParameters(message.parameters);
      tune.setParameters(message.parameters);
      lessons.setParameters(message.parameters);
      runs.setParameters(message.parameters);
      law.setParameters(message.parameters);
      table = message.parameters;
      setBody();
      break;
    case 'events':
      events.add(message.events);
      break;
    case 'consoles':
      if (message.run !== consoleRun) {
        consoles.clear();
        parts.clear();
      }
      consoleRun = message.run;
      consoles.add(message.said.filter(({ usart }) => usart !== PARTS));
      for (const { text } of message.said.filter(({ usart }) => usart === PARTS)) parts.tell(text);
      break;
    case 'bytes':
      meter.add(message.bytes);
      break;
    case 'samples':
      store.setRun(message.run);
      Object.assign(ages, { received_ms: message.heard[0], session_ms: message.heard[1], drawn: false });
      for (const row of message.rows) store.push(row);
      sampled_ms = performance.now();
      if (store.haunted) document.body.classList.add('haunted');
      redraw();
      break;
    case 'readings':
      store.setRun(message.run);
      for (const group of message.groups) store.pushReadings(group);
      // Else they are drawn with the next samples: three sonars would double the frames.
      if (performance.now() - sampled_ms > QUIET_MS) redraw();
      break;
    case 'world':
      editor.receive(message);
      break;
    case 'sketch':
      code.receive(message);
      break;
    case 'debug':
      code.debugger.receive(message.messages);
      break;
    case 'control':
      seat.show(message);
      recordings.page = runs.page = report.page = message.page;
      tune.setControl(message);
      break;
    case 'error':
      break;
  }
}

if (isSite) {
  linkPages();
  // Where the browser allows it, the site opens without a network from now on.
  navigator.serviceWorker?.register('offline.js').catch(() => {});
}

const notice = new Notice();
const link = new (isSite ? WorkerLink : Link)(receive, (now, why) => {
  header.setOpen(now === 'open');
  notice.show(now, why);
});

if (link instanceof WorkerLink) link.onPort = (news) => robotPort.show(news);

Object.assign(window, {
  rumbo: {
    /** A signal as plotted. @param {string} name */
    series: (name) => store.series(name),
    /** The sample that the map shows. */
    shown: () => store.latest,
    /** The states of the run, one after the other. */
    stretches: () => store.stretches,
    /** The slow state last received. */
    state: () => state,
    /** Where a place from the robot's origin is on the map [px]. @param {[number, number]} at */
    onMap: (at) => map.toCanvas(at),
    /** Where a place of the world is on the map [px]. @param {[number, number]} at */
    worldOnMap: (at) => map.worldToCanvas(at),
    /** What stands and moves in the world. */
    world: () => map.world(),
    /** The other robots in the world. */
    others: () => map.others().map(({ other: { name }, at }) => ({ name, ...at })),
    /** The plots and what is seen of them. */
    plots: () => ({ layout: plots.layout, range_s: plots.range_s, mark_s: plots.mark_s, following: plots.following }),
    /** The modes, as the control core describes them. */
    modes: () => plots.modes,
    /** The figures of every step of the setpoint. */
    figures: () => store.steps.map((step) => figures(store, step)),
    /** What is seen of a plot's axes. @param {string} title */
    scales: (title) => plots.scales(title),
    /** For measurements: times from reception to the frame after drawing [ms], the clocks of page and session, a frame at once. */
    ages,
    draw,
    /** Texts shown that have no translation. */
    untranslated: () => [...untranslated],
  },
});
