// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Foxglove's own client of its WebSocket protocol, as a child of foxglove.py: what it is told comes out as JSON, a line an
// event. Usage: foxglove_client.mjs URL PROTOCOL [ORIGIN]. It subscribes to each channel that is announced, checks each
// message of Foxglove's types by the published schema, and decodes it by the one announced. Ends when its input does.

import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";
import schemas from "@foxglove/schemas/internal.js";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";

const { foxgloveEnumSchemas, foxgloveMessageSchemas, generateProto } = schemas;
const asObject = { longs: String, enums: String, defaults: true };

function say(event, facts) {
  process.stdout.write(JSON.stringify({ event, ...facts }) + "\n");
}

function publishedTypes() {
  const root = new protobuf.Root();
  const timestamp = protobuf.common.get("google/protobuf/timestamp.proto");
  const duration = protobuf.common.get("google/protobuf/duration.proto");
  root.addJSON(timestamp.nested).addJSON(duration.nested);
  for (const schema of Object.values(foxgloveMessageSchemas)) {
    if (!["Timestamp", "Duration"].includes(schema.name)) {
      const enums = Object.values(foxgloveEnumSchemas).filter((one) => one.parentSchemaName === schema.name);
      protobuf.parse(generateProto(schema, enums), root, { keepCase: true });
    }
  }
  return root.resolveAll();
}

protobuf.Reader.discardUnknown = false;
const published = publishedTypes();

function announcedType(channel) {
  const bytes = Buffer.from(channel.schema, "base64");
  const set = descriptor.FileDescriptorSet.decode(bytes);
  // The program tells no names of JSON: fields are called as they are.
  for (const file of set.file) {
    const name = (type) => {
      type.field.forEach((field) => (field.jsonName = field.name));
      type.nestedType.forEach(name);
    };
    file.messageType.forEach(name);
  }
  return protobuf.Root.fromDescriptor(set).resolveAll().lookupType(channel.schemaName);
}

function hasUnknownFields(value) {
  if (value === null || typeof value !== "object" || ArrayBuffer.isView(value)) {
    return false;
  }
  return (value.$unknowns ?? []).length > 0 || Object.values(value).some(hasUnknownFields);
}

/// What is told of a cloud in place of its bytes.
function factsOf(decoded) {
  if (!(decoded.data instanceof Uint8Array)) {
    return decoded;
  }
  const { data, ...rest } = decoded;
  const floats = new Float32Array(data.slice().buffer);
  const stride = decoded.point_stride / 4;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < floats.length; i += stride) {
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], floats[i + k]);
      high[k] = Math.max(high[k], floats[i + k]);
    }
  }
  return { ...rest, points: floats.length / stride, low, high };
}

const [url, name, origin] = process.argv.slice(2);
const socket = new WebSocket(url, [name], origin ? { origin } : {});
const client = new protocol.FoxgloveClient({ ws: socket });
const channels = new Map(); // by subscription
const subscriptions = new Map(); // by channel's number

socket.on("unexpected-response", (_request, response) => {
  say("refused", { status: response.statusCode });
  process.exit();
});
client.on("error", (error) => say("error", { text: String(error) }));
client.on("close", (event) => {
  say("close", { code: event.code });
  process.exit();
});
client.on("serverInfo", (info) => say("serverInfo", { ...info, protocol: socket.protocol }));
client.on("status", (status) => say("status", status));
client.on("advertise", (added) => {
  for (const channel of added) {
    const subscription = client.subscribe(channel.id);
    channels.set(subscription, { ...channel, type: announcedType(channel) });
    subscriptions.set(channel.id, subscription);
  }
  say("advertise", { channels: added.map(({ schema: _, ...channel }) => channel) });
});
client.on("unadvertise", (removed) => {
  const topics = removed.map((id) => channels.get(subscriptions.get(id)).topic);
  for (const id of removed) {  // as Lichtblick does
    client.unsubscribe(subscriptions.get(id));
    channels.delete(subscriptions.get(id));
  }
  say("unadvertise", { topics });
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const channel = channels.get(subscriptionId);
  if (channel === undefined) {
    say("error", { text: `a message of subscription ${subscriptionId}` });
    return;
  }
  const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  const { type } = channel;
  const decoded = type.toObject(type.decode(bytes), asObject);
  if (channel.schemaName.startsWith("foxglove.")) {
    const theirs = published.lookupType(channel.schemaName);
    const message = theirs.decode(bytes);
    if (JSON.stringify(theirs.toObject(message, asObject)) !== JSON.stringify(decoded)) {
      say("error", { text: `${channel.topic}: the published schema reads otherwise` });
    }
    if (hasUnknownFields(message)) {
      say("error", { text: `${channel.topic}: fields that the published schema does not have` });
    }
  }
  say("message", { topic: channel.topic, type: channel.schemaName, stamp: String(timestamp), message: factsOf(decoded) });
});
process.stdin.on("end", () => socket.close()).resume();
