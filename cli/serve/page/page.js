// The page: what comes from the server goes to where it is shown; what is pressed goes to the server.
import {Wire} from './wire.js';
import {Graphs} from './graphs.js';
import {Picture} from './robot.js';
import {Drive} from './drive.js';
import {Fleet} from './fleet.js';
import {showBuses, showBoards, showBounds, showOperator} from './states.js';

const by = id => document.getElementById(id);
// Behind the #: the token, and what is to be shown first: plot=CHANNEL.FIELD,... or map.
const asked = location.hash.slice(1).split('&');
const isWord = each => each.startsWith('plot=') || each === 'map';
const token = asked.find(each => !isWord(each)) ?? '';
const plots = new Set(asked.filter(each => each.startsWith('plot=')).flatMap(each => each.slice(5).split(',').map(decodeURIComponent)));
const graphs = new Graphs(by('graphs'));
const rows = new Map();      // of the table, by channel, frame and field
const topics = new Map();    // of the robot, by channel
const rates = new Map();     // rows of the bus, by interface and name
const rateOf = topic => rates.get(`${topic.interface}|${topic.name}`);
const picture = new Picture(by('picture'), by('picture-text'), topic => rateOf(topic)?.age_s);
let robot;
let paused = false;
let jumps;
let changed = false;         // since it was drawn

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function say({level = 0, message, id}) {
  const box = by('messages');
  const key = id ?? message;
  for (const each of [...box.children]) if (each.dataset.key === key) each.remove();
  const line = element('p', message, level === 2 ? 'error' : '');
  line.dataset.key = key;
  box.prepend(line);
  while (box.children.length > 4) box.lastChild.remove();
  if (id === undefined) setTimeout(() => line.remove(), 10000);  // what has a name is a state, and stays
}

function valueText(field, value) {
  if (value === undefined) return '';
  const plain = field.unit ? `${value} ${field.unit}` : `${value}`;
  if (field.values) {
    const names = field.flags ? field.values.filter(each => Math.floor(value / 2 ** each.bit) % 2 === 1)
      : field.values.filter(each => each.value === value);
    return [plain, ...names.map(each => each.name)].join(' ');
  }
  return plain;
}

function frameOf(topic, frame, message) {
  return topic.frames.length > 1 ? message[frame.name] : message;
}

// A line a field, when the first of it comes.
function rowsOf(topic) {
  // The topic's own line is for narrow pages; wide ones have it in the first column.
  const body = element('tbody');
  const heading = element('th', topic.channel.slice(1));
  heading.colSpan = 7;
  heading.scope = 'rowgroup';
  topic.heading = element('tr', undefined, 'topic');
  topic.heading.append(heading);
  body.append(topic.heading);
  by('values').append(body);
  for (const frame of topic.frames) {
    const key = `${topic.channel}|${frame.name}`;
    for (const field of frame.fields) {
      const id = `${key}|${field.name}`;
      if (rows.has(id)) continue;
      const line = element('tr');
      const first = field === topic.frames[0].fields[0] && frame === topic.frames[0];
      const name = element('th', topic.channel.slice(1));
      name.scope = 'row';
      const path = topic.frames.length > 1 ? `${frame.name}.${field.name}` : field.name;
      const value = element('td', '', 'number');
      value.dataset.field = `${topic.channel}.${path}`;
      const box = element('input');
      box.type = 'checkbox';
      box.setAttribute('aria-label', `Graph of ${topic.channel.slice(1)} ${path}`);
      box.addEventListener('change', () => {
        graphs.choose(key, field.name, field.unit, `${topic.channel.slice(1)}${frame.name && topic.frames.length > 1 ? `.${frame.name}` : ''}`, box.checked);
      });
      const choice = element('td');
      choice.append(box);
      if (plots.has(value.dataset.field)) {
        box.checked = true;
        box.dispatchEvent(new Event('change'));
      }
      line.append(name, element('td', path), value, choice);
      const timing = [0, 1, 2, 3].map(() => element('td', '', 'number'));
      line.append(...timing);
      body.append(line);
      rows.set(id, {topic, frame, field, first, line, value, timing, text: `${topic.channel} ${path}`.toLowerCase()});
    }
  }
  topic.rows = true;
}

const newest = new Map();    // messages by channel, of each field the last value that came

// A message has the fields of one page of a multiplexer only: the others stay as they were.
function together(topic, before, message) {
  if (topic.frames.length === 1) return {...before, ...message};
  const all = {...before};
  for (const [name, fields] of Object.entries(message)) all[name] = {...all[name], ...fields};
  return all;
}

function take(channel, message, timeNs) {
  changed = true;
  if (channel === picture.scanChannel()) return picture.takeScan(message);
  const topic = topics.get(channel);
  if (topic === undefined) return;
  if (!topic.rows) rowsOf(topic);
  newest.set(channel, together(topic, newest.get(channel), message));
  const time = topic.time = Number(timeNs / 1000n) / 1000;
  for (const frame of topic.frames) {
    const fields = frameOf(topic, frame, message);
    if (!fields) continue;
    graphs.add(`${channel}|${frame.name}`, time, fields);
    const names = Object.keys(fields);
    frame.isPaged ||= names.length < frame.fields.length;
    if (!frame.isPaged) continue;
    for (const name of names) {
      const row = rows.get(`${channel}|${frame.name}|${name}`);
      if (row) row.time = time;
    }
  }
  picture.take(channel, newest.get(channel));
}

function setRobot(state) {
  robot = state;
  topics.clear();
  for (const topic of robot.topics) topics.set(topic.channel, topic);
  by('title').textContent = `${robot.robot}, ${robot.source}`;
  document.title = `${robot.robot}, ${robot.source}`;
  by('robot').hidden = !picture.set(robot.topics);
  by('main').classList.toggle('robotless', by('robot').hidden);
  const reports = robot.topics.some(topic => topic.role === 'status');
  by('boards').hidden = !reports;
  by('playback').hidden = robot.live;
  for (const part of ['graphs-part', 'bus-part', 'values-part']) by(part).hidden = robot.topics.length === 0;
  const may = robot.commands && wire.capabilities?.includes('clientPublish');
  by('command').hidden = !may || robot.topics.length === 0;
  const sensor = robot.topics.find(topic => topic.kind === 'sensor');
  const message = robot.topics.find(topic => topic.kind === 'message' && topic.frames[0].fields.length > 0);
  by('line').placeholder = sensor ? `publish ${sensor.name} 50ms` : message ? `set ${message.name} ${message.frames[0].fields[0].name}=0` : '';
  by('ask').hidden = !may || !reports;
  by('drive').hidden = by('stop').hidden = !may || !picture.topic('drive');
  if (may && picture.topic('drive')) drive.set(picture.topic('drive'));
  for (const field of plots) {  // in their order, before anything comes
    const topic = robot.topics.find(each => field.startsWith(`${each.channel}.`));
    if (topic && !topic.rows) rowsOf(topic);
  }
  wire.subscribe(robot.topics.map(topic => topic.channel));
  if (picture.scanChannel()) wire.subscribe([picture.scanChannel()]);
  if (by('silent').checked) robot.topics.forEach(topic => topic.rows || rowsOf(topic));
  fleet.allow(may);
  if (plots.size > 0) by('graphs-part').scrollIntoView();
}

let fleetSeen = false;
function setFleet(state) {
  by('fleet').hidden = false;
  fleet.take(state);
  if (!fleetSeen && asked.includes('map')) by('fleet').scrollIntoView();
  fleetSeen = true;
}

function setPlayback(state) {
  if (jumps !== undefined && jumps !== state.jumps) {  // what came before does not go on
    graphs.forget();
    picture.forget();
    fleet.forget();
    newest.clear();
    for (const row of rows.values()) row.time = undefined;
  }
  jumps = state.jumps;
  const bar = by('bar');
  bar.max = state.length_s;
  if (document.activeElement !== bar || !bar.dataset.held) bar.value = state.at_s;
  by('bar-text').textContent = `${state.at_s.toFixed(1)} of ${state.length_s.toFixed(1)} s${state.ended ? ', end' : ''}`;
  by('play').textContent = state.ended ? 'Play again' : state.paused ? 'Play log' : 'Pause log';
  by('play').dataset.asks = JSON.stringify(state.ended ? {at_s: 0, paused: false} : {paused: !state.paused});
}

const states = {
  '/ocm/robot': setRobot,
  '/ocm/playback': setPlayback,
  '/ocm/bus': state => {
    rates.clear();
    for (const bus of state.buses) for (const row of bus.rows) rates.set(`${bus.name}|${row.name}`, row);
    if (!paused) showBuses(by('buses'), state);
  },
  '/ocm/boards': state => { if (!paused) showBoards(by('board-table'), by('findings'), state); },
  '/ocm/bounds': state => { if (!paused) showBounds(by('bounds'), by('bounds-text'), by('bounds-table'), state); },
  '/ocm/fleet': state => { if (!paused) setFleet(state); },
  '/ocm/map': grid => fleet.takeMap(grid),
  '/ocm/operator': state => { if (!paused) showOperator(by('operator'), by('operator-text'), state); },
};

const wire = new Wire(token, {
  info: () => {},
  channels: () => wire.subscribe(Object.keys(states)),
  message: (topic, message, timeNs) => (states[topic] ?? (each => take(topic, each, timeNs)))(message),
  status: say,
  state: text => {
    const words = {lost: 'connection lost, trying again', refused: 'no connection, trying again: open the address that amiroctl serve has printed'};
    by('link').textContent = words[text] ?? text;
    by('link').classList.toggle('lost', text in words);
  },
});
const drive = new Drive(by('pad'), [by('forward-speed'), by('turn-speed')], [by('forward-unit'), by('turn-unit')],
  (channel, message) => wire.publish(channel, message));

const fleet = new Fleet({map: by('map'), text: by('map-text'), line: by('fleet-line'), table: by('fleet-table'), orders: by('fleet-orders'),
  robot: by('fleet-robot'), place: by('fleet-place'), x: by('place-x'), y: by('place-y'), look: by('fleet-look')},
(order) => wire.publish('/ocm/fleet', order));

function ageText(seconds) {
  return seconds < 1 ? `${(seconds * 1000).toFixed(0)} ms` : `${seconds.toFixed(1)} s`;
}

// Rate, jitter, age and share of the topic, beside its first field; the age of a field that the newest message lacks, beside that one.
function timingOf(row) {
  const rate = rateOf(row.topic);
  const cells = ['', '', '', ''];
  if (rate && row.first) {
    if (rate.rate_hz !== null) cells[0] = rate.rate_hz.toFixed(1);
    if (rate.jitter_ms !== null) cells[1] = `${rate.jitter_ms.toFixed(2)} ms`;
    if (rate.age_s !== null) cells[2] = ageText(rate.age_s);
    if (rate.share !== null) cells[3] = `${(rate.share * 100).toFixed(1)} %`;
  }
  if (row.time !== undefined && (!row.first || row.time < row.topic.time))
    cells[2] = ageText((rate?.age_s ?? 0) + (row.topic.time - row.time) / 1000);
  const health = rate && row.first && rate.health !== 'fine' ? rate.health : '';
  if (health) cells[2] += ` ${health}`;
  return {cells, health};
}

function drawValues() {
  const filter = by('filter').value.toLowerCase();
  const shown = new Set();
  for (const row of rows.values()) {
    const hidden = !row.text.includes(filter);
    if (row.line.hidden !== hidden) row.line.hidden = hidden;
    if (hidden) continue;
    shown.add(row.topic);
    const message = newest.get(row.topic.channel);
    const text = message ? valueText(row.field, frameOf(row.topic, row.frame, message)?.[row.field.name]) : '';
    if (row.value.textContent !== text) row.value.textContent = text;
    const {cells, health} = timingOf(row);
    cells.forEach((cell, i) => { if (row.timing[i].textContent !== cell) row.timing[i].textContent = cell; });
    const className = health ? `number ${health}` : 'number';
    if (row.timing[2].className !== className) row.timing[2].className = className;
  }
  for (const {topic} of rows.values()) if (topic.heading.hidden === shown.has(topic)) topic.heading.hidden = !shown.has(topic);
}

setInterval(() => {
  if (paused || document.hidden) return;
  drawValues();
  if (changed) graphs.drawAll();
  changed = false;
  if (!by('robot').hidden) picture.draw();
  if (!by('fleet').hidden) fleet.draw();
}, 200);

by('pause').addEventListener('click', () => {
  paused = !paused;
  by('pause').textContent = paused ? 'Go on' : 'Pause';
  by('pause').setAttribute('aria-pressed', paused);
});
by('stop').addEventListener('click', () => drive.stop());
by('all').addEventListener('click', () => graphs.showAll());
by('minutes').addEventListener('change', () => {
  graphs.spanMs = Number(by('minutes').value) * 60e3;
  graphs.drawAll();
});
by('silent').addEventListener('change', () => {
  if (by('silent').checked) robot?.topics.forEach(topic => topic.rows || rowsOf(topic));
});
by('filter').addEventListener('input', drawValues);
by('ask').addEventListener('click', () => {
  for (const topic of robot.topics)
    if (topic.role === 'status' || topic.role === 'refusal') wire.publish('/ocm/command', {line: `once ${topic.name}`});
});
by('command').addEventListener('submit', event => {
  event.preventDefault();
  wire.publish('/ocm/command', {line: by('line').value});
  by('line').select();
});
by('play').addEventListener('click', () => wire.publish('/ocm/playback', JSON.parse(by('play').dataset.asks ?? '{"paused":true}')));
by('speed').addEventListener('change', () => wire.publish('/ocm/playback', {speed: Number(by('speed').value)}));
by('bar').addEventListener('pointerdown', () => { by('bar').dataset.held = '1'; });
by('bar').addEventListener('pointerup', () => { delete by('bar').dataset.held; });
by('bar').addEventListener('change', () => wire.publish('/ocm/playback', {at_s: Number(by('bar').value)}));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  graphs.recolour();
  fleet.recolour();
});
