// Foxglove's own client of its protocol: prints what it understands of a server, as JSON.
// node foxglove_client.mjs NODE_MODULES URL TOPIC COUNT [TOPIC_TO_PUBLISH FIELDS]
import {createRequire} from 'node:module';
import {join} from 'node:path';

const [modules, url, topic, count, publishes, fields] = process.argv.slice(2);
const require = createRequire(join(modules, 'x.js'));
const {FoxgloveClient} = require('@foxglove/ws-protocol');
const {WebSocket} = require('ws');

const seen = {messages: [], statuses: []};
const finish = () => { console.log(JSON.stringify(seen)); process.exit(0); };
const client = new FoxgloveClient({ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL])});
client.on('error', error => { console.error(String(error.message ?? error)); process.exit(1); });
client.on('serverInfo', info => { seen.info = info; });
client.on('status', status => { seen.statuses.push(status); });
client.on('parameterValues', values => { seen.parameters = values; });
client.on('advertise', channels => {
  seen.channels = channels.map(({topic: name, encoding, schemaEncoding, schema}) => ({topic: name, encoding, schemaEncoding, schema: JSON.parse(schema)}));
  const channel = channels.find(each => each.topic === topic);
  client.subscribe(channel.id);
  if (seen.info.capabilities.includes('parameters')) client.getParameters(['/gyroscope/period_ms'], 'p');
  if (publishes) {
    const id = client.advertise({topic: publishes, encoding: 'json', schemaName: ''});
    client.sendMessage(id, new TextEncoder().encode(fields));
  }
  console.error('ready');
});
client.on('message', ({timestamp, data}) => {
  seen.messages.push({time_ns: String(timestamp), fields: JSON.parse(new TextDecoder().decode(data))});
  if (seen.messages.length >= Number(count)) finish();
});
setTimeout(finish, 20000);
