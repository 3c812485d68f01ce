// SPDX-License-Identifier: MIT
// The connection to the server, which reconnects automatically. docs/serve.md describes the messages.

const subprotocol = 'g4lidar.page.v1';
const first_wait_s = 0.5;
const longest_wait_s = 5;
/** The server sends a status twice a second; after this time without one the connection is lost. */
const silence_s = 5;

/**
 * @typedef {object} Handlers
 * @property {(message: any) => void} on_message  A JSON message.
 * @property {(data: ArrayBuffer) => void} on_data  A binary message.
 * @property {() => void} on_change  The state has changed.
 */

export class Connection {
  /** @param {Handlers} handlers */
  constructor(handlers) {
    this.handlers = handlers;
    /** @type {'connecting' | 'open' | 'waiting'} */
    this.state = 'waiting';
    /** Why it is not open; empty if it is. */
    this.why = '';
    this.opened = 0;
    this.attempts = 0;
    this.retry_at_ms = 0;
    this.heard_at_ms = 0;
    /** @type {WebSocket | null} */
    this.socket = null;
  }

  start() {
    this.#connect();
    setInterval(() => this.#look(), 250);
    addEventListener('online', () => this.retry_now());
    document.addEventListener('visibilitychange', () => {
      if (!document.hidden) this.retry_now();
    });
  }

  /** @param {object} message  Dropped while there is no connection. */
  send(message) {
    if (this.state === 'open') this.socket?.send(JSON.stringify(message));
  }

  retry_now() {
    if (this.state === 'waiting') this.#connect();
  }

  /** The time until the next attempt, in seconds. */
  get wait_s() {
    return Math.max(0, (this.retry_at_ms - performance.now()) / 1000);
  }

  #connect() {
    const url = new URL('.', location.href);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    this.attempts++;
    this.#become('connecting');
    this.heard_at_ms = performance.now();
    const socket = new WebSocket(url, subprotocol);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.attempts = 0;
      this.opened++;
      this.why = '';
      this.#become('open');
    };
    socket.onmessage = (event) => {
      this.heard_at_ms = performance.now();
      if (typeof event.data === 'string') {
        this.#take(event.data);
      } else {
        this.handlers.on_data(event.data);
      }
    };
    socket.onclose = (event) => this.#close(event.reason || 'the server does not answer');
    this.socket = socket;
  }

  /** @param {string} text */
  #take(text) {
    let message;
    try {
      message = JSON.parse(text);
    } catch {
      return; // a newer server may send another format
    }
    this.handlers.on_message(message);
  }

  #look() {
    if (this.state === 'waiting') {
      if (performance.now() >= this.retry_at_ms) this.#connect();
      else this.handlers.on_change();
    } else if (performance.now() > this.heard_at_ms + 1000 * silence_s) {
      this.#close('the server is silent');
    }
  }

  /** @param {string} why */
  #close(why) {
    const socket = this.socket;
    if (!socket) return;
    this.socket = null;
    socket.onopen = socket.onclose = socket.onmessage = null;
    socket.close();
    this.why = why;
    const wait_s = Math.min(longest_wait_s, first_wait_s * 2 ** this.attempts);
    this.retry_at_ms = performance.now() + 1000 * wait_s;
    this.#become('waiting');
  }

  /** @param {'connecting' | 'open' | 'waiting'} state */
  #become(state) {
    this.state = state;
    this.handlers.on_change();
  }
}
