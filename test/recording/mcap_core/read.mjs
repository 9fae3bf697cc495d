// Reads a recording with @mcap/core, by its indexes and with checksums, and decodes it by the definitions in it.
// Prints for each topic: count, first and last times, a digest of all bytes, the last message decoded.
import {createHash} from 'node:crypto';
import {open} from 'node:fs/promises';
import {parse} from '@foxglove/rosmsg';
import {MessageReader} from '@foxglove/rosmsg2-serialization';
import {McapIndexedReader} from '@mcap/core';
import {FileHandleReadable} from '@mcap/nodejs';
import {loadDecompressHandlers} from '@mcap/support';

const readable = new FileHandleReadable(await open(process.argv[2], 'r'));
const reader = await McapIndexedReader.Initialize({readable, decompressHandlers: await loadDecompressHandlers()});
const topics = {};
for await (const message of reader.readMessages({validateCrcs: true})) {
  const channel = reader.channelsById.get(message.channelId);
  topics[channel.topic] ??= {channel, count: 0, first: message.logTime, digest: createHash('sha256')};
  const topic = topics[channel.topic];
  topic.count += 1;
  topic.last = message.logTime;
  topic.data = message.data;
  topic.digest.update(message.data);
}
const told = Object.entries(topics).map(([name, topic]) => {
  const schema = reader.schemasById.get(topic.channel.schemaId);
  const decoder = new MessageReader(parse(new TextDecoder().decode(schema.data), {ros2: true}));
  return [name, {type: schema.name, count: topic.count, first: topic.first, last: topic.last, digest: topic.digest.digest('hex'),
    message: decoder.readMessage(topic.data)}];
});
console.log(JSON.stringify(Object.fromEntries(told), (_, value) => typeof value === 'bigint' ? value.toString() : value));
