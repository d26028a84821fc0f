// @ts-check
/** The help page: keys, meaning of colours and lines, further reading. */
import { dialog } from './dialog.js';
import { clickable, create, withCode } from './dom.js';
import { t } from './text.js';

/** Keys and what they do. */
const KEYS = () => [
  [t('Space'), t('STOP, from anywhere but a line of text. In forms Enter ticks a box and presses a button.')],
  [t('arrow keys'), t('modes 0 and 10, armed: drive while held; letting go, another window or another field releases the wheels')],
  [t('gamepad'), t('modes 0 and 10, armed: left stick or cross drives while a shoulder button is held; B or circle is STOP')],
  ['P', t('hold the plots, or go on')],
  ['L', t('follow the newest data')],
  ['M', t('in the plots: set the mark, from which times and values are counted; Escape takes it away')],
  [t('+ − 0, arrow keys'), t('in the map: zoom, fit, move, and Enter picks the point in the middle; in the plots: zoom and move in time')],
  [t('fingers'), t('map and plots: one moves, two zoom')],
  [t('K , .'), t('replay: play or pause, one frame back, one frame on')],
  ['F8, F9, F10', t('code: go on or pause, breakpoint, step over; Ctrl+Enter runs it, Escape and then Tab leaves it')],
  ['? , F1', t('this page')],
];

/** Lines and colours. */
const LEGEND = () => [
  [t('blue'), t('left wheel, left sonar')], [t('orange'), t('right wheel, right sonar')], [t('green'), t('front sonar, heading; something good')],
  [t('thick line'), t('measured or estimated by the robot')], [t('dotted line'), t('ground truth, in the simulation')], [t('dashed line'), t('a setpoint')],
  [t('dotted upright lines'), t('the state of the mode changed')], [t('filled robot'), t('true pose')], [t('ring'), t('where the robot is, while it is small')], [t('dashed robot'), t('estimated pose')], [t('dotted robot'), t('the ghost: a simulated robot that gets the same commands')],
  [t('pink'), t('goal, route, mark')], [t('red cone'), t('a sonar without a reading')], [t('grey page'), t('what is shown is old: the link or the station is silent')],
];

/** @param {string} title @param {string[][]} lines */
function list(title, lines) {
  return create('section', {}, create('h2', { textContent: title }),
    create('dl', {}, ...lines.flatMap(([term = '', words = '']) => [create('dt', { textContent: term }), create('dd', { textContent: words })])));
}

/** Makes the help page; returns the function that opens it. @param {() => void} begin shows the first steps */
export function makeHelp(begin) {
  const made = dialog('help-dialog', t('Help'));
  const again = clickable({ id: 'tour-again', textContent: t('Show the first steps') }, () => {
    made.dialog.close();
    begin();
  });
  made.body.append(
    create('p', { textContent: t('Choose a mode, enter its setpoint, press ON. OFF stops the mode; STOP releases the wheels at once. The robot never starts because a page was opened.') }),
    create('div', { className: 'row' }, again),
    create('div', { className: 'help-lists' }, list(t('Keys'), KEYS()), list(t('Colours and lines'), LEGEND())),
    create('p', { className: 'hint' }, ...withCode(t('Every event says its cause and what to do. Each run is recorded; `rumbo list logs` finds it, `rumbo replay` shows it here.'))));
  return made.open;
}
