// Robots behind a central: the map as it grows, each robot on it with its heading, and what one asks of them.
import {colour} from './robot.js';

const longestTrail = 4000;
const [free, occupied] = [1, 2];   // cells of the map; all else is unknown

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function bytes(base64) {
  const text = atob(base64);
  const all = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) all[i] = text.charCodeAt(i);
  return all;
}

export class Fleet {
  // parts: the elements by name; order: says an object to the server
  constructor(parts, order) {
    this.parts = parts;
    this.order = order;
    this.robots = [];
    this.trails = new Map();   // places by the robot's index
    this.lines = new Map();    // of the table, by index
    this.orders = false;
    parts.map.addEventListener('click', event => this.click(event));
    for (const button of parts.orders.querySelectorAll('[data-order]'))
      button.addEventListener('click', () => this.ask({order: button.dataset.order}));
    parts.place.addEventListener('submit', event => {
      event.preventDefault();
      this.send(Number(parts.x.value), Number(parts.y.value));
    });
    parts.look.addEventListener('click', () => order({order: 'look'}));
  }

  // Whether this viewer may send robots.
  allow(may) {
    this.orders = may;
    this.parts.orders.hidden = !may;
    this.parts.map.classList.toggle('sends', may);
  }

  // Of a log that was wound: ways and map of before do not go on.
  forget() {
    this.trails.clear();
    this.grid = this.picture = undefined;
    this.changed = true;
  }

  take(state) {
    this.state = state;
    this.robots = state.robots;
    for (const {index, at} of this.robots) {
      if (!at) continue;
      if (!this.trails.has(index)) this.trails.set(index, []);
      const trail = this.trails.get(index);
      const last = trail.at(-1);
      if (!last || Math.hypot(last[0] - at.x_m, last[1] - at.y_m) > 0.01) trail.push([at.x_m, at.y_m]);
      if (trail.length > longestTrail) trail.splice(0, longestTrail / 4);
    }
    this.list();
    this.changed = true;
  }

  takeMap(grid) {
    const cells = bytes(grid.data);
    const columns = grid.column_count;
    this.grid = {cells, columns, rows: columns ? Math.floor(cells.length / columns) : 0, side: grid.cell_size.x,
      x: grid.pose.position.x, y: grid.pose.position.y};
    this.picture = undefined;
    this.changed = true;
  }

  recolour() {
    this.picture = undefined;
    this.changed = true;
  }

  // A line a robot, which stays: what is chosen keeps its focus.
  list() {
    const {state, parts} = this;
    const words = state.gone || `${state.own ? 'This server has the line' : 'By'} ${state.line}${state.scans ? '; it looks for robots' : ''}`;
    const unplaced = state.unplaced.length ? `. Not on the map, because it is not known where they were switched on: ${state.unplaced.join(', ')}` : '';
    parts.line.textContent = words + unplaced;
    parts.line.classList.toggle('missing', state.gone !== '');
    for (const [index, line] of this.lines)
      if (!this.robots.some(robot => robot.index === index)) {
        line.remove();
        this.lines.delete(index);
      }
    for (const robot of this.robots) {
      let line = this.lines.get(robot.index);
      if (!line) {
        line = element('tr');
        const name = element('th');
        name.scope = 'row';
        line.append(name, element('td'), element('td', '', 'number'), element('td', '', 'number'), element('td', '', 'number'));
        parts.table.tBodies[0].append(line);
        this.lines.set(robot.index, line);
      }
      const place = robot.at ? `${robot.at.x_m.toFixed(2)} m, ${robot.at.y_m.toFixed(2)} m` : '-';
      const heading = robot.at ? `${(robot.at.heading_rad * 180 / Math.PI).toFixed(0)}\u00b0` : '-';
      const link = robot.quality === null ? '-' : `${(robot.quality * 100).toFixed(0)} %${robot.call_back ? ` ${robot.call_back.replace('_', ' ')}` : ''}`;
      [robot.robot, robot.state, place, heading, link].forEach((text, i) => {
        if (line.children[i].textContent !== text) line.children[i].textContent = text;
      });
      line.children[1].className = ['no link', 'silent'].includes(robot.state) ? 'missing' : '';
      line.children[4].className = robot.call_back ? 'number late' : 'number';
    }
    const options = this.robots.map(robot => `${robot.index} ${robot.robot}`).join('|');
    if (options === this.options) return;
    this.options = options;
    const chosen = parts.robot.value;
    parts.robot.replaceChildren(...this.robots.map(robot => {
      const option = element('option', robot.robot);
      option.value = robot.index;
      return option;
    }));
    if (this.robots.some(robot => `${robot.index}` === chosen)) parts.robot.value = chosen;
  }

  ask(order) {
    if (this.parts.robot.value !== '') this.order({robot: Number(this.parts.robot.value), ...order});
  }
  send(x, y) {
    this.ask({x_m: Number(x.toFixed(3)), y_m: Number(y.toFixed(3))});
  }

  // On a robot it chooses that one, elsewhere it sends the chosen one there.
  click(event) {
    if (!this.orders || !this.view) return;
    const box = this.parts.map.getBoundingClientRect();
    const [x, y] = this.view.place(event.clientX - box.left, event.clientY - box.top);
    const robot = this.robots.find(each => each.at && Math.hypot(each.at.x_m - x, each.at.y_m - y) < this.radius(each));
    if (robot) this.parts.robot.value = robot.index;
    else this.send(x, y);
    this.changed = true;
  }

  radius(robot) {
    return robot.body ? Math.hypot(robot.body.width_cm, robot.body.length_cm) / 200 : 0.12;
  }

  // All that is known, and all robots, in the middle of the canvas, a metre as long in both directions.
  frame(width, height) {
    const xs = [];
    const ys = [];
    if (this.grid) {
      const {x, y, side, columns, rows} = this.grid;
      xs.push(x, x + columns * side);
      ys.push(y, y + rows * side);
    }
    for (const {at, target} of this.robots)
      for (const each of [at, target]) if (each) { xs.push(each.x_m); ys.push(each.y_m); }
    if (xs.length === 0) { xs.push(0); ys.push(0); }
    const [left, right, low, high] = [Math.min(...xs) - 0.3, Math.max(...xs) + 0.3, Math.min(...ys) - 0.3, Math.max(...ys) + 0.3];
    const pixels = Math.min(width / (right - left), height / (high - low));
    const [middleX, middleY] = [(left + right) / 2, (low + high) / 2];
    return {
      pixels,
      at: (x, y) => [width / 2 + (x - middleX) * pixels, height / 2 - (y - middleY) * pixels],
      place: (x, y) => [middleX + (x - width / 2) / pixels, middleY - (y - height / 2) / pixels],
    };
  }

  // The map as an image, a pixel a cell, the top first.
  image() {
    const {cells, columns, rows} = this.grid;
    const canvas = document.createElement('canvas');
    canvas.width = Math.max(columns, 1);
    canvas.height = Math.max(rows, 1);
    const context = canvas.getContext('2d');
    for (const [state, name] of [[free, '--ground'], [occupied, '--text']]) {
      context.fillStyle = colour(name);
      for (let row = 0; row < rows; ++row) {
        for (let from = 0; from < columns;) {
          if (cells[row * columns + from] !== state) { ++from; continue; }
          let to = from + 1;
          while (to < columns && cells[row * columns + to] === state) ++to;
          context.fillRect(from, rows - 1 - row, to - from, 1);
          from = to;
        }
      }
    }
    return canvas;
  }

  draw() {
    const canvas = this.parts.map;
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0 || height === 0) return;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
      this.changed = true;
    }
    if (!this.changed) return;
    this.changed = false;
    const context = canvas.getContext('2d');
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    const view = this.view = this.frame(width, height);
    if (this.grid) {
      const {x, y, side, columns, rows} = this.grid;
      const [left, top] = view.at(x, y + rows * side);
      context.imageSmoothingEnabled = false;
      context.drawImage(this.picture ??= this.image(), left, top, columns * side * view.pixels, rows * side * view.pixels);
    }
    this.robots.forEach((robot, i) => this.drawRobot(context, view, robot, colour(`--series-${i % 6}`)));
    this.scaleBar(context, view, height);
    this.describe();
  }

  drawRobot(context, view, robot, ink) {
    context.lineWidth = 2;
    context.strokeStyle = context.fillStyle = ink;
    const trail = this.trails.get(robot.index) ?? [];
    context.beginPath();
    trail.forEach(([x, y], i) => i === 0 ? context.moveTo(...view.at(x, y)) : context.lineTo(...view.at(x, y)));
    context.stroke();
    if (!robot.at) return;
    const [x, y] = view.at(robot.at.x_m, robot.at.y_m);
    if (robot.target) {
      const [toX, toY] = view.at(robot.target.x_m, robot.target.y_m);
      context.setLineDash([5, 4]);
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(toX, toY);
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      for (const side of [-1, 1]) {
        context.moveTo(toX - 6, toY - 6 * side);
        context.lineTo(toX + 6, toY + 6 * side);
      }
      context.stroke();
    }
    const radius = Math.max(6, this.radius(robot) * view.pixels);
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = colour('--panel');
    context.fill();
    context.lineWidth = this.orders && this.parts.robot.value === `${robot.index}` ? 4 : 2;
    context.stroke();
    context.beginPath();  // where it looks
    context.moveTo(x, y);
    context.lineTo(x + Math.cos(robot.at.heading_rad) * radius * 1.4, y - Math.sin(robot.at.heading_rad) * radius * 1.4);
    context.stroke();
    // How good its link is: a bar below it, and in words where it is bad.
    const share = robot.quality ?? 0;
    context.fillStyle = colour('--bar-back');
    context.fillRect(x - 16, y + radius + 4, 32, 5);
    context.fillStyle = robot.call_back || !robot.linked ? colour('--bad') : colour('--good');
    context.fillRect(x - 16, y + radius + 4, 32 * share, 5);
    context.strokeStyle = colour('--text');
    context.lineWidth = 1;
    context.strokeRect(x - 16, y + radius + 4, 32, 5);
    const words = robot.robot + (robot.linked ? robot.call_back ? `, ${robot.call_back.replace('_', ' ')}` : '' : ', no link');
    context.font = '13px system-ui, sans-serif';
    context.textAlign = 'center';
    context.lineWidth = 4;
    context.strokeStyle = colour('--ground');
    context.strokeText(words, x, y - radius - 6);
    context.fillStyle = colour('--text');
    context.fillText(words, x, y - radius - 6);
    context.textAlign = 'start';
  }

  scaleBar(context, view, height) {
    const metres = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find(each => each * view.pixels > 60) ?? 100;
    context.fillStyle = colour('--text');
    context.fillRect(8, height - 10, metres * view.pixels, 3);
    context.font = '11px system-ui, sans-serif';
    context.fillText(`${metres} m`, 8, height - 14);
  }

  describe() {
    const parts = [];
    if (this.grid) {
      const {cells, side} = this.grid;
      let count = 0;
      for (const cell of cells) if (cell === free) ++count;
      parts.push(`${(count * side * side).toFixed(2)} m\u00b2 free${this.state?.map_by ? `, drawn by ${this.state.map_by}` : ''}`);
    } else {
      parts.push('nothing of the map is known yet');
    }
    for (const {robot, at, target} of this.robots) {
      if (!at) continue;
      parts.push(`${robot} at ${at.x_m.toFixed(2)} m, ${at.y_m.toFixed(2)} m${target ? `, sent to ${target.x_m.toFixed(2)} m, ${target.y_m.toFixed(2)} m` : ''}`);
    }
    const words = parts.join('; ');
    if (this.parts.text.textContent !== words) this.parts.text.textContent = words;
  }
}
