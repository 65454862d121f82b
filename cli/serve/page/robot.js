// The robot from above, from what has a role: pose and trail, beams of the ring, floor sensors, lights, battery. It knows no
// robot: fields are found by the names that the roles prescribe.
const longestTrail = 4000;
const oldSeconds = 2;

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** The field of that name, wherever in the message it is. */
function find(message, name) {
  if (message === undefined) return undefined;
  if (typeof message[name] === 'number') return message[name];
  for (const frame of Object.values(message))
    if (frame !== null && typeof frame === 'object' && typeof frame[name] === 'number') return frame[name];
  return undefined;
}

/** All numbers of a message in the order of the spec. */
function numbers(topic, message) {
  const all = [];
  for (const frame of topic.frames) {
    const of = frame.name && topic.frames.length > 1 ? message[frame.name] : message;
    for (const field of frame.fields) all.push(of?.[field.name]);
  }
  return all;
}

export class Picture {
  // age: seconds since a topic's newest sample, as the server has it; undefined: not known
  constructor(canvas, text, age) {
    this.canvas = canvas;
    this.text = text;
    this.age = age;
    this.roles = new Map();    // topics by role
    this.newest = new Map();   // messages by channel
    this.trail = [];
    this.beams = [];
  }

  // Whether there is anything to draw.
  set(topics) {
    this.roles.clear();
    for (const topic of topics) {
      const battery = topic.frames.some(f => f.fields.some(each => each.name === 'state_of_charge' && each.unit === '%'));
      const role = topic.role || (battery ? 'battery' : '');
      if (!role) continue;
      if (!this.roles.has(role)) this.roles.set(role, []);
      this.roles.get(role).push(topic);
    }
    return ['pose', 'ring', 'floor', 'light', 'drive'].some(role => this.roles.has(role));
  }

  topic(role) { return this.roles.get(role)?.[0]; }
  message(role) {
    const topic = this.topic(role);
    return topic && this.newest.get(topic.channel);
  }

  take(channel, message) {
    this.newest.set(channel, message);
    if (this.topic('pose')?.channel !== channel) return;
    const [x, y] = [find(message, 'x'), find(message, 'y')];
    const pose = this.pose();
    const last = this.trail.at(-1);
    if (x === undefined || y === undefined || !pose) return;
    if (!last || Math.hypot(last[0] - pose.x, last[1] - pose.y) > 0.003) this.trail.push([pose.x, pose.y]);
    if (this.trail.length > longestTrail) this.trail.splice(0, longestTrail / 4);
  }

  forget() {
    this.newest.clear();
    this.trail = [];
    this.beams = [];
  }

  // In a message with velocities, too, the pose is the frame that has an orientation.
  pose() {
    const message = this.message('pose');
    if (message === undefined) return undefined;
    const frames = [message, ...Object.values(message).filter(each => each !== null && typeof each === 'object')];
    const frame = frames.find(each => typeof each.orientation === 'number');
    return frame && {x: frame.x, y: frame.y, heading: frame.orientation};
  }

  /** The channel on which the server says what the ring sees; undefined: there is no ring. */
  scanChannel() {
    const ring = this.topic('ring');
    return ring?.geometry && `${ring.channel}/scan`;
  }

  // The server knows the sensors' offsets from all that it has seen. metres: null where it does not know, undefined: nothing in sight.
  takeScan(scan) {
    const radius = this.topic('ring').geometry.radius_m;
    const step = (scan.end_angle - scan.start_angle) / Math.max(scan.ranges.length - 1, 1);
    this.beams = scan.ranges.map((range, i) => ({
      angle: scan.start_angle + i * step,
      metres: range === null ? null : range === 0 ? undefined : Math.max(range - radius, 0),
    }));
  }

  draw() {
    const scale = window.devicePixelRatio || 1;
    const size = this.canvas.clientWidth;
    if (size === 0) return;
    if (this.canvas.width !== Math.round(size * scale)) this.canvas.width = this.canvas.height = Math.round(size * scale);
    const context = this.canvas.getContext('2d');
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, size, size);
    const pose = this.pose() ?? {x: 0, y: 0, heading: 0};
    const radius = this.topic('ring')?.geometry?.radius_m ?? 0.05;
    // As much of the room as the trail needs, a metre at least; the robot stays in sight.
    let reach = 0.5;
    let middle = [0, 0];
    if (this.trail.length) {
      const xs = this.trail.map(p => p[0]).concat(pose.x);
      const ys = this.trail.map(p => p[1]).concat(pose.y);
      middle = [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
      reach = Math.max(0.5, (Math.max(...xs) - Math.min(...xs)) / 2 + 0.3, (Math.max(...ys) - Math.min(...ys)) / 2 + 0.3);
    }
    const pixels = size / 2 / reach;
    const at = (x, y) => [size / 2 + (x - middle[0]) * pixels, size / 2 - (y - middle[1]) * pixels];
    this.grid(context, size, reach, middle, at);

    context.strokeStyle = colour('--series-0');
    context.lineWidth = 2;
    context.beginPath();
    this.trail.forEach(([x, y], i) => i === 0 ? context.moveTo(...at(x, y)) : context.lineTo(...at(x, y)));
    context.stroke();

    const to = (angle, metres) => at(pose.x + Math.cos(pose.heading + angle) * metres, pose.y + Math.sin(pose.heading + angle) * metres);
    const {beams} = this;
    context.strokeStyle = context.fillStyle = colour('--series-1');
    for (const {angle, metres} of beams) {
      if (metres === undefined) continue;
      if (metres === null) {
        context.font = '11px system-ui, sans-serif';
        context.fillText('?', ...to(angle, radius * 1.25));
        continue;
      }
      context.setLineDash([5, 3]);
      context.beginPath();
      context.moveTo(...to(angle, radius));
      context.lineTo(...to(angle, radius + metres));
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      context.arc(...to(angle, radius + metres), 4, 0, 2 * Math.PI);
      context.fill();
    }

    context.fillStyle = colour('--panel');
    context.strokeStyle = colour('--text');
    context.lineWidth = 2;
    context.beginPath();
    context.arc(...at(pose.x, pose.y), radius * pixels, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.beginPath();  // where it looks
    context.moveTo(...at(pose.x, pose.y));
    context.lineTo(...to(0, radius));
    context.stroke();
    this.lights(context, to, radius, pixels);
    this.floor(context, to, radius, pixels);
    this.describe(pose, beams);
  }

  grid(context, size, reach, middle, at) {
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find(each => reach / each < 6) ?? 100;
    context.strokeStyle = colour('--bar-back');
    context.fillStyle = colour('--dim');
    context.lineWidth = 1;
    context.font = '11px system-ui, sans-serif';
    context.beginPath();
    for (let i = Math.ceil((middle[0] - reach) / step); i * step <= middle[0] + reach; ++i) {
      const [x] = at(i * step, 0);
      context.moveTo(x, 0);
      context.lineTo(x, size);
    }
    for (let i = Math.ceil((middle[1] - reach) / step); i * step <= middle[1] + reach; ++i) {
      const [, y] = at(0, i * step);
      context.moveTo(0, y);
      context.lineTo(size, y);
    }
    context.stroke();
    context.fillText(`${step} m a square`, 6, size - 6);
  }

  lights(context, to, radius, pixels) {
    const lights = (this.roles.get('light') ?? []).toSorted((a, b) => (a.instance ?? 0) - (b.instance ?? 0));
    lights.forEach((topic, i) => {
      const light = this.newest.get(topic.channel);
      const angle = Math.PI / 2 - (i + 0.5) * 2 * Math.PI / lights.length;
      context.beginPath();
      context.arc(...to(angle, radius * 0.72), Math.max(2.5, radius * pixels * 0.14), 0, 2 * Math.PI);
      const of = name => Math.round(find(light, name) ?? 0);
      context.fillStyle = light ? `rgb(${of('red')} ${of('green')} ${of('blue')})` : 'transparent';
      context.fill();
      context.lineWidth = 1;
      context.stroke();
    });
  }

  // As grey as the floor is bright, within what was seen.
  floor(context, to, radius, pixels) {
    const topic = this.topic('floor');
    const message = this.message('floor');
    if (!topic || message === undefined) return;
    const values = numbers(topic, message);
    this.brightest = Math.max(this.brightest ?? 1, ...values.filter(Number.isFinite));
    values.forEach((value, i) => {
      const grey = Math.round(255 * Math.min(1, Math.max(0, value / this.brightest)));
      const angle = (values.length - 1 - 2 * i) / values.length * 0.9;
      const [x, y] = to(angle, radius * 0.4);
      const side = Math.max(4, radius * pixels * 0.16);
      context.fillStyle = `rgb(${grey} ${grey} ${grey})`;
      context.fillRect(x - side / 2, y - side / 2, side, side);
      context.strokeRect(x - side / 2, y - side / 2, side, side);
    });
  }

  describe(pose, beams) {
    const parts = [];
    if (this.pose()) parts.push(`at ${pose.x.toFixed(2)} m, ${pose.y.toFixed(2)} m, heading ${(pose.heading * 180 / Math.PI).toFixed(0)} degrees`);
    const seen = beams.filter(beam => beam.metres !== undefined && beam.metres !== null);
    const unknown = beams.filter(beam => beam.metres === null).length;
    // What was seen long ago says nothing of now.
    const age = beams.length ? this.age(this.topic('ring')) ?? 0 : 0;
    const when = age >= oldSeconds ? `, ${age.toFixed(0)} s ago` : '';
    if (seen.length) parts.push(`nearest obstacle ${(Math.min(...seen.map(b => b.metres)) * 100).toFixed(1)} cm${when}`);
    if (unknown) parts.push(`not known yet what ${unknown} of ${beams.length} sensors of the ring see`);
    else if (beams.length && !seen.length) parts.push(`no obstacle in sight${when}`);
    const charge = find(this.message('battery'), 'state_of_charge');
    if (charge !== undefined) parts.push(`battery ${charge} %`);
    const words = parts.length ? parts.join('; ') : 'nothing of its pose, ring or battery is published yet';
    if (this.text.textContent !== words) this.text.textContent = words;
  }
}
