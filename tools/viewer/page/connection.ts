// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The line to the server, which finds back by itself when the server was away.
import { tilePoints, type Graph, type Live, type Place, type Scene, type TilePoints, type Told } from './protocol';

export interface Listener {
  scene(scene: Scene): void;
  /** The same scene as before: the line is back. */
  back(): void;
  graph(graph: Graph): void;
  live(live: Live): void;
  told(told: Told): void;
  tile(tile: TilePoints): void;
  place(place: Place): void;
  lost(): void;
}

const FIRST_WAIT = 300;  // ms
const LONGEST_WAIT = 4000;

export class Connection {
  private socket: WebSocket | null = null;
  private wait = FIRST_WAIT;
  private scene = '';

  constructor(private readonly listener: Listener) {
    this.open();
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  send(message: object): void {
    if (this.isOpen) this.socket!.send(JSON.stringify(message));
  }

  private open(): void {
    const url = new URL('/socket' + location.search, location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(url);
    socket.binaryType = 'arraybuffer';
    socket.onmessage = (event) => this.take(event.data);
    socket.onclose = () => {
      this.listener.lost();
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(LONGEST_WAIT, 1.5 * this.wait);
    };
    this.socket = socket;
  }

  private take(data: string | ArrayBuffer): void {
    if (typeof data !== 'string') {
      this.listener.tile(tilePoints(data));
      return;
    }
    const message = JSON.parse(data) as Scene | Graph | Live | Place | Told;
    if (message.type === 'scene') {
      this.wait = FIRST_WAIT;
      if (data === this.scene) this.listener.back();
      else this.listener.scene(message);
      this.scene = data;
    } else if (message.type === 'graph') this.listener.graph(message);
    else if (message.type === 'live') this.listener.live(message);
    else if (message.type === 'place') this.listener.place(message);
    else this.listener.told(message);
  }
}
