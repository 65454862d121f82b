// History of every field that came, and graphs of those that were chosen.
import {colour} from './robot.js';

const mostPoints = 20000;  // of a frame; older ones go
const shortestSpan = 10e3; // ms, of a graph of what has just begun

// It measures with an inline style, which the page forbids; the newest values are beside a graph's name.
Dygraph.PLUGINS = Dygraph.PLUGINS.filter(plugin => plugin !== Dygraph.Plugins.Legend);

/** What came of one frame of a channel: times in ms, and a list of numbers a field. */
class Track {
  constructor() {
    this.times = [];
    this.values = new Map();
  }

  add(time, fields, keepMs) {
    const known = this.times.length;
    this.times.push(time);
    for (const [name, value] of Object.entries(fields)) {
      let list = this.values.get(name);
      if (list === undefined) this.values.set(name, list = new Array(known).fill(null));
      list.push(typeof value === 'number' ? value : null);
    }
    for (const list of this.values.values()) if (list.length <= known) list.push(null);
    // In pieces: taking one from the front costs as much as taking many.
    const first = this.times.findIndex(at => at >= time - keepMs);
    const cut = Math.max(first, this.times.length - mostPoints);
    if (cut > Math.max(200, this.times.length / 4)) {
      this.times.splice(0, cut);
      for (const list of this.values.values()) list.splice(0, cut);
    }
  }
}

export class Graphs {
  constructor(element) {
    this.element = element;
    this.tracks = new Map();   // by channel and frame
    this.graphs = new Map();   // by track and unit
    this.keepMs = 15 * 60e3;
    this.spanMs = 5 * 60e3;
    this.newest = 0;
  }

  add(key, time, fields) {
    let track = this.tracks.get(key);
    if (track === undefined) this.tracks.set(key, track = new Track());
    track.add(time, fields, this.keepMs);
    this.newest = Math.max(this.newest, time);
  }

  forget() {
    this.tracks.clear();
    this.newest = 0;
  }

  // A field in or out of its graph; fields of a frame in the same unit share one.
  choose(key, field, unit, title, on) {
    const id = `${key} ${unit}`;
    let graph = this.graphs.get(id);
    if (graph === undefined) {
      if (!on) return;
      graph = this.create(key, unit, title);
      this.graphs.set(id, graph);
    }
    if (on) graph.fields.push(field);
    else graph.fields = graph.fields.filter(each => each !== field);
    if (graph.fields.length === 0) {
      graph.plot?.destroy();
      graph.box.remove();
      this.graphs.delete(id);
      return;
    }
    graph.plot?.destroy();
    graph.plot = undefined;
    this.draw(graph);
  }

  create(key, unit, title) {
    const box = document.createElement('figure');
    box.className = 'graph';
    box.style.margin = '0 0 .8rem';
    const name = document.createElement('figcaption');
    name.className = 'name';
    const about = document.createElement('strong');
    const point = document.createElement('span');
    name.append(about, point);
    const plot = document.createElement('div');
    plot.className = 'plot';
    plot.tabIndex = 0;
    plot.setAttribute('role', 'img');
    box.append(name, plot);
    this.element.append(box);
    const graph = {key, unit, title, fields: [], box, about, point, area: plot, window: null};
    plot.addEventListener('keydown', event => this.press(graph, event));
    return graph;
  }

  press(graph, event) {
    if (!graph.plot) return;
    const [from, to] = graph.plot.xAxisRange();
    const width = to - from;
    const moves = {'+': [0.25, -0.25], '-': [-0.5, 0.5], ArrowLeft: [-0.2, -0.2], ArrowRight: [0.2, 0.2]};
    if (event.key === 'Escape' || event.key === '0') this.show(graph, null);
    else if (moves[event.key]) this.show(graph, [from + width * moves[event.key][0], to + width * moves[event.key][1]]);
    else return;
    event.preventDefault();
  }

  show(graph, window) {
    graph.window = window;
    this.draw(graph);
  }

  showAll() {
    for (const graph of this.graphs.values()) this.show(graph, null);
  }

  rows(graph, track) {
    const lists = graph.fields.map(field => track.values.get(field) ?? []);
    const begin = this.newest - this.keepMs;
    const rows = [];
    for (let i = 0; i < track.times.length; ++i)
      if (track.times[i] >= begin) rows.push([track.times[i], ...lists.map(list => list[i] ?? null)]);
    return rows;
  }

  draw(graph) {
    const track = this.tracks.get(graph.key);
    const rows = track ? this.rows(graph, track) : [];
    graph.about.textContent = `${graph.title} ${graph.fields.join(', ')}${graph.unit ? ` in ${graph.unit}` : ''}`;
    graph.area.setAttribute('aria-label', `Graph of ${graph.about.textContent}, ${rows.length} samples`);
    if (rows.length === 0) return;
    const begin = Math.min(rows[0][0], this.newest - shortestSpan);
    const dateWindow = graph.window ?? [Math.max(this.newest - this.spanMs, begin), this.newest];
    if (graph.plot) {
      graph.plot.updateOptions({file: rows, dateWindow});
      return;
    }
    graph.plot = new Dygraph(graph.area, rows, {
      labels: ['time', ...graph.fields],
      colors: graph.fields.map((_, i) => colour(`--series-${i % 6}`)),
      legend: 'never',
      strokeWidth: 1.6,
      dateWindow,
      axisLineColor: colour('--line'),
      gridLineColor: colour('--line'),
      axes: {
        x: {axisLabelWidth: 72, ticker: Dygraph.dateTicker, axisLabelFormatter: Dygraph.dateAxisLabelFormatter, valueFormatter: Dygraph.dateString_},
        y: {axisLabelWidth: 60},
      },
      highlightCallback: (_, x, points) => {
        graph.point.textContent = points.filter(p => p.yval !== null && !Number.isNaN(p.yval))
          .map(p => `${p.name} ${p.yval}`).join('  ');
      },
      unhighlightCallback: () => { graph.point.textContent = ''; },
      zoomCallback: (from, to, ranges) => {
        graph.window = graph.plot && !graph.plot.isZoomed('x') ? null : [from, to];
      },
    });
    // A double click shows all again, and goes on with time.
    graph.area.addEventListener('dblclick', () => this.show(graph, null));
  }

  drawAll() {
    for (const graph of this.graphs.values()) this.draw(graph);
  }

  recolour() {
    for (const graph of this.graphs.values()) {
      graph.plot?.destroy();
      graph.plot = undefined;
      this.draw(graph);
    }
  }
}
