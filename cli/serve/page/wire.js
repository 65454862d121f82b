// Foxglove's WebSocket protocol, version 1, from the page's side. Connects again when the connection is lost.
const subprotocol = 'foxglove.websocket.v1';
const decoder = new TextDecoder();
const encoder = new TextEncoder();

export class Wire {
  // on: {info, channels, message(topic, object, timeNs), status({level, message, id}), state(text)}:
  // 'connected', 'lost', or 'refused' where none ever came about
  constructor(token, on) {
    this.token = token;
    this.on = on;
    this.wanted = new Set();
    this.connect();
    // A page that is left may be kept by the browser, to be shown again: it must not keep what it has sent going.
    addEventListener('pagehide', () => this.socket.close());
  }

  connect() {
    this.channels = new Map();       // by topic
    this.topics = new Map();         // by subscription, which has its channel's number
    this.published = new Map();      // our channels, by topic
    const url = new URL(location.href);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    url.hash = '';
    url.search = this.token ? `?token=${encodeURIComponent(this.token)}` : '';
    const socket = new WebSocket(url, [subprotocol]);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => this.on.state('connected');
    socket.onclose = () => {
      this.on.state(this.known ? 'lost' : 'refused');
      setTimeout(() => this.connect(), 1000);
    };
    socket.onmessage = ({data}) => typeof data === 'string' ? this.text(JSON.parse(data)) : this.binary(data);
  }

  text(message) {
    if (message.op === 'serverInfo') {
      this.known = true;
      this.capabilities = message.capabilities;
      this.on.info(message);
    } else if (message.op === 'advertise') {
      for (const channel of message.channels) this.channels.set(channel.topic, channel);
      const topics = [...this.wanted];
      this.wanted.clear();
      this.subscribe(topics);
      this.on.channels(this.channels);
    } else if (message.op === 'status') {
      this.on.status(message);
    }
  }

  binary(data) {
    const view = new DataView(data);
    if (view.getUint8(0) !== 1) return;
    const topic = this.topics.get(view.getUint32(1, true));
    if (topic === undefined) return;
    const timeNs = view.getBigUint64(5, true);
    this.on.message(topic, JSON.parse(decoder.decode(new Uint8Array(data, 13))), timeNs);
  }

  send(object) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(object));
  }

  subscribe(topics) {
    const subscriptions = [];
    for (const topic of topics) {
      if (this.wanted.has(topic)) continue;
      this.wanted.add(topic);
      const channel = this.channels.get(topic);
      if (channel === undefined) continue;
      this.topics.set(channel.id, topic);
      subscriptions.push({id: channel.id, channelId: channel.id});
    }
    if (subscriptions.length) this.send({op: 'subscribe', subscriptions});
  }

  publish(topic, object) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    let id = this.published.get(topic);
    if (id === undefined) {
      id = this.published.size + 1;
      this.published.set(topic, id);
      this.send({op: 'advertise', channels: [{id, topic, encoding: 'json', schemaName: ''}]});
    }
    const payload = encoder.encode(JSON.stringify(object));
    const data = new Uint8Array(5 + payload.length);
    data[0] = 1;
    new DataView(data.buffer).setUint32(1, id, true);
    data.set(payload, 5);
    this.socket.send(data);
  }
}
