// Drives while something is held: a button, or an arrow key. What is held is said again and again; the server stops the robot when
// it hears nothing for half a second. A page that could not say it for so long (frozen, or its computer asleep) releases by itself.
const again = 100;       // ms
const longest = 500;     // ms, from one saying to the next: the server's patience

export class Drive {
  constructor(pad, speeds, units, publish) {
    this.pad = pad;
    this.speeds = speeds;
    this.units = units;
    this.publish = publish;
    this.held = new Map();   // directions by what is held
    for (const button of pad.querySelectorAll('button')) {
      const direction = [Number(button.dataset.x), Number(button.dataset.z)];
      button.addEventListener('pointerdown', event => {
        button.setPointerCapture(event.pointerId);
        this.hold(button, direction);
      });
      for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) button.addEventListener(end, () => this.release(button));
      // By the keyboard: Enter or Space while the button has the focus.
      button.addEventListener('keydown', event => {
        if (event.key !== 'Enter') return;
        event.preventDefault();
        if (!event.repeat) this.hold(button, direction);
      });
      button.addEventListener('keyup', event => { if (event.key === 'Enter') this.release(button); });
    }
    const keys = {ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1]};
    pad.addEventListener('keydown', event => {
      if (event.key === ' ') this.stop();
      else if (!keys[event.key]) return;
      else if (!event.repeat) this.hold(event.key, keys[event.key]);  // a key that is still down does not undo a stop
      event.preventDefault();
    });
    pad.addEventListener('keyup', event => this.release(event.key));
    pad.addEventListener('focusout', event => { if (!pad.contains(event.relatedTarget)) this.leave(); });
    addEventListener('blur', () => this.leave());
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.leave(); });
    addEventListener('pagehide', () => this.leave());
  }

  set(topic) {
    this.topic = topic;
    const unit = name => topic.frames[0].fields.find(field => field.name === name)?.unit ?? '';
    this.units[0].textContent = unit('x');
    this.units[1].textContent = unit('z');
  }

  hold(what, direction) {
    if (this.held.has(what)) return;
    this.held.set(what, direction);
    this.say();
    if (this.held.size > 0) this.timer ??= setInterval(() => this.say(), again);
  }

  release(what) {
    if (this.held.delete(what)) this.say();
    if (this.held.size === 0) this.end();
  }

  stop() {
    this.held.clear();
    this.end();
    if (this.topic) this.publish(this.topic.channel, {x: 0, z: 0});
  }

  // Nothing where it does not drive: another viewer may.
  leave() {
    if (this.held.size > 0) this.stop();
  }

  end() {
    clearInterval(this.timer);
    this.timer = this.said = undefined;
  }

  say() {
    let [x, z] = [0, 0];
    const now = performance.now();
    if (this.said !== undefined && now - this.said >= longest) return this.stop();
    this.said = now;
    for (const [forward, left] of this.held.values()) {
      x += forward * Number(this.speeds[0].value);
      z += left * Number(this.speeds[1].value);
    }
    this.publish(this.topic.channel, {x: Number(x.toFixed(4)), z: Number(z.toFixed(4))});
  }
}
