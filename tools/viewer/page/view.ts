// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The view: what the server says comes in, what hands want goes through the state onto the screen.
import { Vector3 } from 'three';
import { Cloud } from './cloud';
import { boundsOf, boxOf, ClipBox } from './clip_box';
import { COLOURS } from './cloud_material';
import { Connection, type Listener } from './connection';
import { Controls, eyeOnAll } from './controls';
import { element, notice } from './elements';
import { copied, exportCommand } from './export_command';
import { addRows, factsOf, placeOf, pointFacts, showFacts, type Act, type Facts } from './facts';
import { GraphLayer, LAYERS, type Found } from './graph_layer';
import { LiveCloud } from './live_cloud';
import { Marks } from './marks';
import { meaningOf } from './meaning';
import { Measure } from './measure';
import { Painter, type Frame } from './painter';
import { prefersDark } from './palette';
import { Panel, sessionsOf, type Actions } from './panel';
import { composed, save } from './picture';
import { Proposal } from './proposal';
import { Places, UnderMouse, worldRows } from './places';
import { Plots } from './plots';
import { POSE, type Graph, type Live, type Loop, type Place, type Scene, type TilePoints, type Told } from './protocol';
import { sectionAlong } from './section';
import { Sensor, sensorPose } from './sensor';
import type { FoundPoint, ShownCloud } from './shown_cloud';
import { colourOf, overlaidLoop, showKeyframes } from './shown_keyframes';
import { showSources } from './sources';
import { statusText } from './status_text';
import { TimeLine } from './time_line';
import { fromHash, OVERLAYS, toHash, type ViewState } from './view_state';

const WITHIN = 12;          // pixels, of a click from what it means
const NEAR = 5;             // pixels, of the mouse from the point that it is told of
const APART = 1.3;          // pixels between points, of tiles that are fine enough
const REMEMBERED = 300;     // ms, then the link has the state

export class View implements Listener, Actions {
  readonly state: ViewState = fromHash(location.hash);
  readonly canvas = element<HTMLCanvasElement>('view');
  readonly painter = new Painter(this.canvas, (frame) => this.frame(frame));
  readonly controls = new Controls(this.canvas, () => this.moved(), (x, y) => this.click(x, y));
  readonly panel = new Panel(this.state, this);
  readonly box = new ClipBox(() => { this.state.box = this.box.value; this.changed(); });
  readonly timeLine = new TimeLine(() => { this.state.time = this.timeLine.now; this.changed(); });
  readonly plots = new Plots(this.state.plots, (seconds) => this.timeLine.go(seconds), (shown) => {
    this.state.plots = shown;
    this.remember();
  });
  sceneShown: Scene | null = null;
  graphShown: Graph | null = null;
  cloud: ShownCloud | null = null;
  /** Of a run that goes on, what was said of it last. */
  liveShown: Live | null = null;
  layer: GraphLayer | null = null;
  readonly marks = new Marks();
  readonly places = new Places((message) => this.connection.send(message));
  private readonly measured = new Measure();
  private readonly sensor = new Sensor();
  private readonly connection: Connection;
  private chosen: Found | null = null;
  private facts: Facts | null = null;
  private readonly proposal = new Proposal((from, to) => this.connection.send({ add: [from, to] }), () => this.choose(this.chosen));
  private picking: 'measure' | 'section' | null = null;
  private keyframesShown: string | null = null;  // how
  private byLink = true;    // a link was entered, and the graph has not come since
  private timer = 0;
  private written = location.hash;  // the link as it was last seen or written

  constructor() {
    this.painter.over.add(this.measured.group, this.sensor);
    new UnderMouse(this.canvas, (x, y) => this.pointAt(x, y, NEAR)?.p ?? null, (p, then) => {
      if (this.graphShown?.world) this.places.ask(p, then);
    });
    new ResizeObserver(([footer]) => {
      document.body.style.setProperty('--foot', `${(footer.target as HTMLElement).offsetHeight}px`);
      this.painter.draw();
    }).observe(document.querySelector('footer')!);
    addEventListener('resize', () => this.painter.draw());
    addEventListener('hashchange', () => this.restore());
    prefersDark.addEventListener('change', () => this.repaint());
    this.canvas.addEventListener('webglcontextlost',
        () => notice('The browser took the graphics away: load the page anew.', true));
    this.connection = new Connection(this);
  }

  // --- what the server says ---------------------------------------------------------------------

  scene(scene: Scene): void {
    this.cloud?.dispose();
    this.painter.points.clear();
    if (this.layer) this.painter.over.remove(this.layer.group);
    const another = this.sceneShown === null || this.sceneShown.live;
    if (this.liveShown) this.choose(null);
    this.liveShown = null;
    document.body.classList.toggle('live', scene.live === true);
    this.sceneShown = scene;
    const ask = (tiles: number[]): void => this.connection.send({ tiles });
    this.cloud = scene.live ? new LiveCloud(scene, ask) : new Cloud(scene, ask);
    this.painter.points.add(this.cloud.group);
    this.layer = new GraphLayer(scene, this.cloud.origin);
    this.painter.over.add(this.layer.group);
    if (scene.live) this.timeLine.setLive(this.state.time);
    else this.timeLine.set(scene.seconds, this.state.time);
    this.plots.set(scene.plots ?? null, scene.seconds);
    showSources(scene.sources ?? []);
    this.fitBox();
    if (another) this.restoreEye();
    this.painter.draw();
  }

  graph(graph: Graph): void {
    this.graphShown = graph;
    this.keyframesShown = null;
    this.marks.north = graph.world?.north ?? null;
    this.layer?.set(graph);
    const sessions = sessionsOf(graph);
    this.cloud?.look.setSessions(graph.keyframes.session.map((session) => sessions.indexOf(session)));
    this.panel.offer(this.sceneShown!, graph);
    // What is told of is told anew, as it is now.
    if (this.chosen?.kind === 'loop') {
      const id = this.chosen.loop.id;
      const loop = graph.loops.find((one) => one.id === id);
      this.choose(loop ? { kind: 'loop', loop } : null);
    } else if (this.byLink) this.chooseByLink(graph);
    else this.layer?.mark(this.chosen);
    this.apply();
    this.painter.draw();
  }

  tile(tile: TilePoints): void {
    if (this.cloud?.take(tile)) {
      this.legend();
      this.fitToCloud();
      if (this.sceneShown?.live && !this.state.box) this.fitBox();
    }
    if (this.stays) this.painter.drawLater();
    else this.painter.draw();
  }

  /** A time of a run that goes on was scrubbed back to. */
  private get stays(): boolean {
    return this.sceneShown?.live === true && this.timeLine.now !== null;
  }

  live(live: Live): void {
    const { sceneShown: scene, cloud, layer } = this;
    if (!scene || !layer || !(cloud instanceof LiveCloud)) return;
    const { time, keyframe, pose } = scene.sweeps;
    time.splice(live.from, Infinity, ...live.sweeps.time);
    keyframe.splice(live.from, Infinity, ...live.sweeps.keyframe);
    pose.splice(POSE * live.from, Infinity, ...live.sweeps.pose);
    const begins = (!this.liveShown?.newest && live.newest) || scene.intensity !== live.intensity;
    scene.intensity = live.intensity;
    this.liveShown = live;
    layer.follow(live.from);
    cloud.follow(live);
    if (begins) this.panel.offer(scene, this.graphShown);
    this.plots.grow(live);
    showSources(live.sources ?? []);
    this.timeLine.grow(live.seconds);
    this.apply();
    if (this.timeLine.now === null) this.painter.motion();
    else {  // hardly anything that is seen is another: a whole picture for each sweep would take all the time there is
      this.status();
      this.painter.drawLater();
    }
  }

  place(place: Place): void {
    this.places.take(place);
  }

  told(told: Told): void {
    notice(told.text, told.problem);
  }

  lost(): void {
    element('status').textContent = 'no connection, trying again …';
  }

  back(): void {
    this.places.forget();
    this.cloud?.askAgain();
    this.painter.draw();
  }

  // --- what hands want --------------------------------------------------------------------------

  reset(): void {
    this.state.eye = null;
    this.lookAtAll();
    this.painter.motion();
    this.remember();
  }

  above(): void {
    Object.assign(this.controls.eye, { pitch: 1.5707, yaw: -Math.PI / 2 });
    this.moved();
  }

  fly(): void {
    this.controls.flying = !this.controls.flying;
    this.panel.pressed('fly', this.controls.flying);
  }

  measure(): void {
    this.pick('measure');
  }

  section(): void {
    this.pick('section');
  }

  /** Two points are to be clicked, or no more. */
  private pick(what: 'measure' | 'section'): void {
    this.picking = this.picking === what ? null : what;
    for (const one of ['measure', 'section'] as const) this.panel.pressed(one, this.picking === one);
    document.body.classList.toggle('measuring', this.picking !== null);
    this.measured.clear();
    this.tell(this.picking ? { title: what, rows: [['from', 'click a point']] } : null);
    this.painter.draw();
  }

  private picked(p: Vector3): void {
    const { measured, cloud, sceneShown: scene } = this;
    const facts = measured.add(p, cloud!.origin);
    if (this.picking === 'measure' || measured.ends.length < 2) {
      this.tell({ ...facts, title: this.picking === 'measure' ? facts.title : 'section' });
      return;
    }
    const whole = boundsOf(scene!, cloud!), [a, b] = measured.ends;
    const section = sectionAlong(a, b, whole[2], whole[5]);
    this.pick('section');
    if (!section) return;
    this.state.box = section.box;
    this.fitBox();
    this.controls.eye = { ...section.eye, target: section.eye.target.sub(cloud!.origin) };
    this.moved();
    this.changed();
  }

  play(): void {
    this.timeLine.toggle();
  }

  newest(): void {
    this.timeLine.goLive();
  }

  picture(): void {
    const { cloud, sceneShown, marks, canvas } = this;
    if (!cloud || !sceneShown || !marks.shown) return;
    this.painter.paint(cloud, this.state.shading);
    save(composed(canvas, marks.shown, this.panel.legendOf(sceneShown.title)), `${sceneShown.title}.png`);
  }

  export(): void {
    if (!this.sceneShown?.map) return;
    const command = exportCommand(this.sceneShown, this.state, this.timeLine.now);
    this.choose(null);
    const facts: Facts = { title: 'export', rows: [['command', command]], acts: [{ text: 'copy', run: async () => {
      const done = await copied(command, document.querySelector('#facts dd')!);
      notice(done ? 'The command is copied.' : 'Copy what is selected.');
    } }] };
    if (this.state.box) facts.rows.push(['box', 'crops by x and y; all heights are exported']);
    this.tell(facts);
  }

  close(): void {
    if (this.picking) this.pick(this.picking);
    if (this.state.only !== null) this.only(this.state.only);
    if (this.state.overlaid) this.overlay(null);
    this.choose(null);
    this.painter.draw();
  }

  changed(): void {
    this.apply();
    this.remember();
    this.painter.draw();
  }

  choose(found: Found | null): void {
    this.chosen = found;
    this.layer?.mark(found);
    this.tell(found && this.graphShown && this.sceneShown
      ? this.factsOf(found, this.graphShown, this.sceneShown) : null,
      found && this.graphShown && placeOf(found, this.graphShown));
    this.painter.draw();
  }

  /** What the link shows alone is told of. */
  private chooseByLink(graph: Graph): void {
    this.byLink = false;
    const loop = overlaidLoop(graph, this.state);
    const at = this.state.only === null ? -1 : graph.keyframes.id.indexOf(this.state.only);
    this.choose(loop ? { kind: 'loop', loop } : at >= 0 ? { kind: 'keyframe', at } : null);
  }

  /** Where the place of what is told of is on the Earth, follows. */
  private tell(facts: Facts | null, p: Vector3 | null = null): void {
    this.facts = facts;
    showFacts(facts);
    if (!facts || !p || !this.graphShown?.world) return;
    this.places.ask(p, (world) => {
      if (this.facts === facts) addRows(worldRows(world));
    });
  }

  private pointAt(x: number, y: number, within: number): FoundPoint | null {
    return this.cloud?.find(this.painter.camera, this.painter.width, this.painter.height, x, y, within) ?? null;
  }

  /** The points of a keyframe alone, or those of all again. */
  private only(id: number): void {
    this.state.only = this.state.only === id ? null : id;
    this.state.overlaid = null;
    this.choose(this.chosen);
    this.changed();
  }

  /** The points of a loop's keyframes alone, the one to the other as somebody says, or those of all again. */
  private overlay(overlaid: ViewState['overlaid']): void {
    this.state.overlaid = overlaid;
    this.state.only = null;
    this.choose(this.chosen);
    this.changed();
  }

  private factsOf(found: Found, graph: Graph, scene: Scene): Facts {
    const facts = factsOf(found, graph, scene, (what, loop) => this.change(what, loop));
    if (scene.points === 0 || scene.live) return facts;
    if (found.kind === 'keyframe') {
      const id = graph.keyframes.id[found.at];
      facts.acts = [{ text: this.state.only === id ? 'all points' : 'its points alone', run: () => this.only(id) }];
      if (scene.editable) facts.acts.push(this.proposal.act(id));
    } else if (found.kind === 'loop' && found.loop.from >= 0 && found.loop.to >= 0) {
      facts.acts = [...(facts.acts ?? []), ...this.overlayActs(found.loop)];
    }
    return facts;
  }

  private overlayActs(loop: Loop): Act[] {
    const shown = this.state.overlaid?.loop === loop.id ? this.state.overlaid.by : null;
    if (!shown) return [{ text: 'overlay', run: () => this.overlay({ loop: loop.id, by: 'map' }) }];
    const by = OVERLAYS.filter((one) => one !== 'loop' || loop.pose.length > 0);
    return [...by.map((one) => ({ text: `by the ${one}`, pressed: one === shown, run: () => this.overlay({ loop: loop.id, by: one }) })),
      { text: 'all points', run: () => this.overlay(null) }];
  }

  private change(what: 'revoke' | 'restore', loop: Loop): void {
    notice('The map is being optimised …');
    this.connection.send({ [what]: loop.id });
  }

  private click(x: number, y: number): void {
    if (!this.cloud || !this.sceneShown) return;
    const { camera, width, height } = this.painter;
    const found = this.picking ? null : this.layer?.find(camera, width, height, x, y, WITHIN) ?? null;
    if (found) {
      this.choose(found);
      return;
    }
    const point = this.pointAt(x, y, WITHIN);
    if (this.picking) {
      if (point) this.picked(point.p);
    } else {
      this.choose(null);
      this.tell(point && pointFacts(point, this.graphShown, this.sceneShown), point?.p);
    }
    this.painter.draw();
  }

  // --- the state --------------------------------------------------------------------------------

  private moved(): void {
    const { target, distance, yaw, pitch } = this.controls.eye;
    const p = target.clone().add(this.cloud?.origin ?? new Vector3());
    this.state.eye = [p.x, p.y, p.z, distance, yaw, pitch];
    this.painter.motion();
    this.remember();
  }

  private restore(): void {
    clearTimeout(this.timer);
    this.written = location.hash;
    if (location.hash.slice(1) === toHash(this.state)) return;
    Object.assign(this.state, fromHash(location.hash));
    if (this.liveShown) this.timeLine.go(this.state.time ?? Infinity);
    else if (this.sceneShown) this.timeLine.set(this.sceneShown.seconds, this.state.time);
    this.restoreEye();
    this.panel.show();
    this.plots.show(this.state.plots);
    this.fitBox();
    if (this.graphShown) this.chooseByLink(this.graphShown);
    this.apply();
    this.painter.draw();
  }

  private restoreEye(): void {
    this.lookAtAll();
    if (this.state.eye && this.cloud) {
      const [x, y, z, distance, yaw, pitch] = this.state.eye;
      this.controls.eye = { target: new Vector3(x, y, z).sub(this.cloud.origin), distance, yaw, pitch };
    }
  }

  private remember(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      if (location.hash !== this.written) return;  // another link was entered, and is about to be shown
      history.replaceState(null, '', `#${toHash(this.state)}`);
      this.written = location.hash;
    }, REMEMBERED);
  }

  private apply(): void {
    const { cloud, layer, state } = this;
    if (!cloud || !layer || !this.sceneShown) return;
    cloud.look.set('colourBy', COLOURS.indexOf(colourOf(state, this.sceneShown, this.graphShown)));
    cloud.look.set('hideMoving', !state.moving);
    const shown = [state.colour, state.only, state.overlaid?.loop, state.overlaid?.by].join();
    if (this.graphShown && shown !== this.keyframesShown) showKeyframes(cloud, this.graphShown, state);
    this.keyframesShown = this.graphShown ? shown : null;
    const { now } = this.timeLine;
    if (cloud instanceof LiveCloud) cloud.showAt(now, state.grow);
    const share = now === null || !state.grow || this.sceneShown.live ? 2 : now / Math.max(this.sceneShown.seconds, 1e-9);
    cloud.look.set('until', 65535 * share + 0.5);
    layer.showUntil(state.grow ? now : null);
    cloud.look.setBox(state.box && boxOf(state.box, cloud.origin));
    for (const one of LAYERS) layer.show(one, state.layers.includes(one));
    this.plots.at(now);
    const pose = sensorPose(now, this.liveShown, layer, cloud.origin);
    this.sensor.place(pose, this.controls.eye.distance);
    if (pose && element<HTMLInputElement>('follow').checked) this.controls.eye.target.setFromMatrixPosition(pose);
    this.legend();
  }

  private legend(): void {
    const { sceneShown: scene, cloud, graphShown: graph, state } = this;
    if (!scene || !cloud) return;
    const { least, most, ramp, key } = meaningOf(state, scene, cloud, graph);
    this.panel.legend(least, most, ramp, key);
  }

  private lookAtAll(): void {
    if (!this.sceneShown || !this.cloud) return;
    this.controls.size = Math.max(2, this.cloud.extent?.size ?? this.sceneShown.cube.edge);
    const panel = element<HTMLDetailsElement>('panel').open ? element('title').parentElement!.offsetWidth : 0;
    this.controls.eye = eyeOnAll(this.cloud.extent, this.controls.size, this.painter.width, this.painter.height, panel);
  }

  /** With the first points it is known how large what there is to see is. */
  private fitToCloud(): void {
    if (!this.state.eye && !this.stays) this.lookAtAll();
    else if (this.cloud?.extent) this.controls.size = Math.max(2, this.cloud.extent.size);
  }

  private fitBox(): void {
    if (this.sceneShown && this.cloud) this.box.set(boundsOf(this.sceneShown, this.cloud), this.state.box);
  }

  private repaint(): void {
    this.plots.draw();
    this.layer?.draw();
    this.layer?.mark(this.chosen);
    if (this.sceneShown) this.panel.offer(this.sceneShown, this.graphShown);
    this.apply();
    this.painter.draw();
  }

  // --- a frame ----------------------------------------------------------------------------------

  private frame(frame: Frame): boolean {
    const keys = this.controls.step(frame.seconds);
    const plays = this.timeLine.step(frame.seconds);
    const { camera, width, height } = this.painter;
    this.controls.apply(camera, width, height);
    if (this.cloud) {
      const ratio = Math.min(devicePixelRatio, 2);
      this.cloud.look.setSize(this.state.size, ratio, height * ratio / (2 * Math.tan(0.5 * camera.fov * Math.PI / 180)));
      this.cloud.update(camera, height, APART, this.painter.budget(this.panel.budget));
      this.status();
    }
    this.marks.draw(this.controls.eye, camera, height);
    this.painter.paint(this.cloud, this.state.shading);
    return keys || plays || this.controls.busy;
  }

  private status(): void {
    if (!this.connection.isOpen || !this.cloud || !this.sceneShown) return;
    element('status').textContent = statusText(this.sceneShown, this.cloud, this.liveShown);
  }
}
