// SPDX-License-Identifier: MIT
// foxglove.mjs URL: Foxglove's client, with each subprotocol: all channels are advertised and send messages.
import { createRequire } from "node:module";

const url = process.argv[2];
const require = createRequire(`${process.cwd()}/`);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

function fail(what) {
  console.error(what);
  process.exit(1);
}

/** Resolves when each channel has sent three messages. */
function use(subprotocols) {
  return new Promise((resolve) => {
    const socket = new WebSocket(url, subprotocols);
    const client = new FoxgloveClient({ ws: socket });
    const left = new Map();
    client.on("error", fail);
    client.on("status", (status) => fail(status.message));
    client.on("advertise", (channels) => {
      const topics = channels.map((channel) => channel.topic).join(" ");
      if (topics !== "/scan /points /diagnostics /g4lidar/from_device") fail(`the channels are ${topics}`);
      for (const channel of channels) left.set(client.subscribe(channel.id), 3);
    });
    client.on("message", ({ subscriptionId }) => {
      left.set(subscriptionId, left.get(subscriptionId) - 1);
      if (left.size < 4 || [...left.values()].some((count) => count > 0)) return;
      client.close();
      resolve(socket.protocol);
    });
  });
}

const sdk = "foxglove.sdk.v1";
const old = FoxgloveClient.SUPPORTED_SUBPROTOCOL;
for (const [offered, wanted] of [[[sdk, old], sdk], [[old], old], [[sdk], sdk]]) {
  const used = await use(offered);
  if (used !== wanted) fail(`${offered} became ${used}`);
}
console.log("Foxglove's client reads all channels with each subprotocol");
