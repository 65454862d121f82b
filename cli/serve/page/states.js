// What the server says of bus, boards, response times and the Operator, as tables and lists.
function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function table(into, heads, lines) {
  const head = element('thead');
  const row = element('tr');
  for (const text of heads) {
    const cell = element('th', text);
    cell.scope = 'col';
    row.append(cell);
  }
  head.append(row);
  const body = element('tbody');
  for (const line of lines) {
    const made = element('tr');
    line.forEach((cell, i) => {
      const [text, className] = Array.isArray(cell) ? cell : [cell, ''];
      const part = element(i === 0 ? 'th' : 'td', text, className);
      if (i === 0) part.scope = 'row';
      made.append(part);
    });
    body.append(made);
  }
  into.replaceChildren(head, body);
}

/** "1 request", "2 requests" of "request*". */
const counted = (number, what) => `${number} ${what.replace('*', number === 1 ? '' : 's')}`;

const percent = share => share === null ? 'not known' : `${(share * 100).toFixed(1)} %`;

function span(seconds) {
  if (seconds < 120) return `${seconds} s`;
  if (seconds < 7200) return `${Math.floor(seconds / 60)} min`;
  return `${Math.floor(seconds / 3600)} h ${Math.floor(seconds / 60) % 60} min`;
}

export function showBuses(into, state) {
  const parts = [];
  for (const bus of state.buses) {
    const name = element('h3', bus.name);
    const meter = element('progress', undefined, 'load');
    meter.max = 1;
    meter.value = bus.load ?? 0;
    meter.setAttribute('aria-label', `Load of ${bus.name}`);
    const text = element('p', `${percent(bus.load)} now, worst ${percent(bus.worst_load)}; ${bus.rate_hz.toFixed(0)} frames/s; ${counted(bus.frames, 'frame*')}`);
    parts.push(name, meter, text);
    const counts = [['errors', 'error frame*'], ['lost', 'lost'], ['incomplete', 'incomplete sample*'], ['wrong_length', 'of a wrong length'],
      ['unknown', 'unknown'], ['transport_lost', 'message* of several frames that lost one'],
      ['not_in_load', 'not in the load'], ['not_shown', 'not shown']]
      .filter(([key]) => bus[key] > 0).map(([key, words]) => counted(bus[key], words));
    if (counts.length) parts.push(element('p', counts.join(', '), 'warning'));
    const broken = bus.rows.filter(row => row.known && row.count === 0 && row.frames > 0);
    if (broken.length) parts.push(element('p', `no whole sample: ${broken.map(row => `${row.name} (${row.frames} frames, ${row.incomplete} incomplete samples, ${percent(row.share)})`).join(', ')}`, 'warning'));
    const strange = bus.rows.filter(row => !row.known);
    if (strange.length) parts.push(element('p', `identifiers that the spec does not know: ${strange.slice(0, 12).map(row => `${row.name} (${row.count})`).join(', ')}${strange.length > 12 ? ' ...' : ''}`, 'small'));
  }
  parts.push(element('p', `${counted(state.viewers, 'viewer*')}${state.lost ? `; ${counted(state.lost, 'message*')} lost on the way to viewers` : ''}${state.refused ? `; ${counted(state.refused, 'request*')} refused` : ''}`, 'small'));
  into.replaceChildren(...parts);
}

// Of a board that has not said how it is.
function boardText(board) {
  if (!board.has_status) return 'has no status';
  return `${board.heard ? 'sends; ' : ''}${board.asked ? 'no answer' : 'not asked yet'}`;
}

export function showBoards(into, findings, state) {
  table(into, ['Board', 'Up', 'Reset', 'Spec', 'CPU', 'Bus', 'Publishes'], state.boards.map(board => board.answers
    ? [board.board, span(board.uptime_s), board.reset || '?', [board.same_spec ? 'same' : 'another', board.same_spec ? '' : 'warning'],
      board.load_percent === null ? '-' : `${board.load_percent} %`, board.bus || '?', board.publishing || '-']
    : [board.board, boardText(board), '', '', '', '', '']));
  findings.replaceChildren(...state.findings.map(finding => {
    const line = element('li');
    line.append(element('span', finding.severity, finding.severity), ` ${finding.board ? `${finding.board}: ` : ''}${finding.what}. `,
      element('span', finding.remedy, 'small'));
    return line;
  }));
}

export function showBounds(section, text, into, state) {
  section.hidden = !state.rows?.length;
  if (section.hidden) return;
  text.textContent = state.about;
  table(into, ['Message', 'Period', 'Measured, at least', 'Proved bound', 'Deadline'], state.rows.map(row => [row.name, `${row.period_ms} ms`,
    row.measured_ms === null ? 'not yet' : [`${row.measured_ms.toFixed(3)} ms`, row.exceeds ? 'problem' : 'fine'],
    row.bound_ms === null ? ['none', 'problem'] : `${row.bound_ms.toFixed(3)} ms`, row.deadline_ms === null ? '-' : `${row.deadline_ms} ms`]));
}

const old = ns => `${(ns / 1e9).toFixed(1)} s`;

export function showOperator(section, into, state) {
  section.hidden = !state.running;
  if (section.hidden) return;
  const {status, why} = state;
  const list = element('dl');
  const pair = (name, value, className) => list.append(element('dt', name), element('dd', value, className));
  pair('Operator', status.operator);
  pair('Configuration', status.configuration, 'fine');
  pair('for', old(status.for_ns));
  if (status.on_hold) pair('On hold', 'monitors lead to the fall-back only', 'warning');
  if (status.requested) pair('Asked for', status.requested);
  for (const [name, truth] of Object.entries(status.monitors)) pair(`Monitor ${name}`, truth, truth === 'yes' ? 'warning' : '');
  const {passed, limited, refused} = status.set_points;
  pair('Set points', `${passed} passed on, ${limited} limited, ${refused} refused`);
  const changes = element('ul');
  for (const change of (why.changes ?? []).slice(-8).reverse())
    changes.append(element('li', change.from ? `${change.from} to ${change.to}: ${change.cause}${change.conditions?.length ? ` (${change.conditions.join(', ')})` : ''}` : `started in ${change.to}`));
  into.replaceChildren(list, element('h3', 'Why it switched'), changes);
}
