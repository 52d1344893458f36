// Plays recorded demos: surfaces and their contacts.
import * as Three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { unpack } from "./recording.js";

/** Milliseconds for which a frame is shown. */
const frameTime = 80;

class Player {
  constructor(stage) {
    this.stage = stage;
    this.scene = new Three.Scene();
    this.camera = new Three.PerspectiveCamera(35, 2, 0.01, 1000);
    this.renderer = new Three.WebGLRenderer({ antialias: true, alpha: true });
    const canvas = this.renderer.domElement;
    stage.append(canvas);
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.render());
    canvas.addEventListener("keydown", (event) => this.turn(event));
    this.scene.add(new Three.HemisphereLight(0xffffff, 0x667788, 2.2));
    const sun = new Three.DirectionalLight(0xffffff, 1.6);
    sun.position.set(3, 6, 4);
    this.scene.add(sun);
    this.material = new Three.MeshStandardMaterial({
      vertexColors: true, roughness: 0.6, side: Three.DoubleSide, transparent: true, opacity: 0.45, depthWrite: false,
    });
    this.bodies = new Three.Mesh(new Three.BufferGeometry(), this.material);
    this.lines = new Three.LineSegments(new Three.BufferGeometry(),
      new Three.LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true }));
    this.lines.renderOrder = 1;
    for (const object of [this.bodies, this.lines]) object.frustumCulled = false;
    this.scene.add(this.bodies, this.lines);
    new ResizeObserver(() => this.resize()).observe(stage);
  }

  /** Shows another recording from its first frame. */
  open(recording, hasFloor) {
    this.recording = recording;
    const attribute = () => new Three.BufferAttribute(new Float32Array(3 * recording.vertexCount), 3);
    [this.positions, this.normals] = [attribute(), attribute()];
    this.bodies.geometry.dispose();
    this.bodies.geometry = new Three.BufferGeometry();
    this.bodies.geometry.setAttribute("position", this.positions);
    this.bodies.geometry.setAttribute("normal", this.normals);
    this.bodies.geometry.setAttribute("color", colours(recording.vertexCounts));
    this.bodies.geometry.setIndex(new Three.BufferAttribute(recording.corners, 1));
    const box = usualBox(recording.frames);
    this.deep = usuallyDeep(recording.frames);
    this.setFloor(hasFloor ? box : null);
    const reach = box.getSize(new Three.Vector3()).length();
    this.controls.target.copy(box.getCenter(new Three.Vector3()));
    this.camera.position.copy(this.controls.target).add(new Three.Vector3(0.5, 0.45, 1.2).multiplyScalar(reach * 1.1));
    this.controls.update();
    this.resize();
    this.show(0);
  }

  setFloor(box) {
    if (this.floor) {
      this.scene.remove(this.floor);
      this.floor.dispose();
      this.floor = null;
    }
    if (!box) return;
    const size = 2 * Math.ceil(Math.max(box.max.x - box.min.x, box.max.z - box.min.z));
    this.floor = new Three.GridHelper(size, 2 * size, 0x888888, 0x888888);
    this.floor.material.transparent = true;
    this.floor.material.opacity = 0.5;
    this.scene.add(this.floor);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  show(frame) {
    this.frame = frame;
    const { positions, contacts } = this.recording.frames[frame];
    this.positions.array.set(positions);
    this.positions.needsUpdate = true;
    this.findNormals();
    const shades = new Float32Array(contacts.length);
    const shade = new Three.Color();
    for (let i = 0; i < contacts.length; i += 6) {
      const depth = length(contacts, i);
      // From blue, shallow, to red, deep.
      shade.setHSL(0.62 * (1 - Math.min(depth / this.deep, 1)), 0.95, 0.5);
      for (const end of [0, 3]) shade.toArray(shades, i + end);
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new Three.BufferGeometry();
    this.lines.geometry.setAttribute("position", new Three.BufferAttribute(contacts, 3));
    this.lines.geometry.setAttribute("color", new Three.BufferAttribute(shades, 3));
    this.contactCount = contacts.length / 6;
    this.render();
  }

  /** Sums of the surrounding triangles' normals; lights want no unit length. */
  findNormals() {
    const [p, n, c] = [this.positions.array, this.normals.array, this.recording.corners];
    n.fill(0);
    for (let t = 0; t < c.length; t += 3) {
      const [a, b, d] = [3 * c[t], 3 * c[t + 1], 3 * c[t + 2]];
      const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
      const [vx, vy, vz] = [p[d] - p[a], p[d + 1] - p[a + 1], p[d + 2] - p[a + 2]];
      const cross = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      for (const corner of [a, b, d]) for (let i = 0; i < 3; ++i) n[corner + i] += cross[i];
    }
    this.normals.needsUpdate = true;
  }

  /** Arrow keys turn, + and − come nearer and go away. */
  turn(event) {
    const sphere = new Three.Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    const steps = {
      ArrowLeft: () => (sphere.theta -= 0.1), ArrowRight: () => (sphere.theta += 0.1),
      ArrowUp: () => (sphere.phi -= 0.1), ArrowDown: () => (sphere.phi += 0.1),
      "+": () => (sphere.radius /= 1.1), "-": () => (sphere.radius *= 1.1),
    };
    if (!steps[event.key]) return;
    event.preventDefault();
    steps[event.key]();
    sphere.makeSafe();
    this.camera.position.setFromSpherical(sphere).add(this.controls.target);
    this.controls.update();
  }

  render() {
    this.renderer.render(this.scene, this.camera);
  }
}

/** The number that so large a part of them does not exceed; 0 of none. */
function quantile(numbers, part) {
  return Float64Array.from(numbers).sort()[Math.floor((numbers.length - 1) * part)] ?? 0;
}

/** Around nearly all points of nearly all frames: some bodies fly far. */
function usualBox(frames) {
  const bound = (part) => [0, 1, 2].map((axis) => {
    const some = frames.filter((_, i) => i % 4 === 0);
    return quantile(some.flatMap(({ positions }) => Array.from(positions.filter((_, i) => i % 15 === axis))), part);
  });
  return new Three.Box3(new Three.Vector3(...bound(0.005)), new Three.Vector3(...bound(0.995)));
}

function length(contacts, i) {
  return Math.hypot(contacts[i] - contacts[i + 3], contacts[i + 1] - contacts[i + 4], contacts[i + 2] - contacts[i + 5]);
}

/** The depth that few contacts exceed. */
function usuallyDeep(frames) {
  const depths = frames.flatMap(({ contacts }) => Array.from({ length: contacts.length / 6 }, (_, i) => length(contacts, 6 * i)));
  return quantile(depths, 0.98);
}

/** One for each body: blue and orange, then around the circle by the golden angle. */
function colours(vertexCounts) {
  const all = [];
  vertexCounts.forEach((count, body) => {
    const hue = 0.575 + (body === 1 ? 0.5 : 0.618034 * body);
    const [r, g, b] = new Three.Color().setHSL(hue % 1, 0.62, 0.48);
    for (let i = 0; i < count; ++i) all.push(r, g, b);
  });
  return new Three.BufferAttribute(Float32Array.from(all), 3);
}

/** Ties the player to the page's controls. */
export function start(recordings) {
  const at = (id) => document.getElementById(id);
  const stage = at("stage");
  if (recordings.length === 0) {
    stage.innerHTML = '<p class="absent">Not recorded.</p>';
    return;
  }
  let player;
  try {
    player = new Player(stage);
  } catch {
    stage.innerHTML = '<p class="absent">This browser shows no 3-D pictures (WebGL is off).</p>';
    return;
  }
  let playing = false;
  let shownSince = 0;
  const frameCount = () => player.recording.frames.length;
  const show = (frame) => {
    player.show(frame);
    at("frame").value = frame;
    const seconds = player.recording.frames[frame].time.toFixed(2);
    at("frame-text").textContent = `${seconds} s, ${player.contactCount} contacts`;
    stage.dataset.frame = frame;
    stage.dataset.contacts = player.contactCount;
  };
  const open = async ({ name, title, floor, packed }) => {
    at("demo").disabled = true; // one after the other
    player.open(await unpack(packed), floor);
    at("demo").disabled = false;
    player.renderer.domElement.setAttribute("aria-label", `${title}; arrow keys turn the picture`);
    at("frame").max = frameCount() - 1;
    at("deepest").textContent = player.deep > 0 ? `${player.deep.toFixed(2)} m and more` : "(no contacts)";
    stage.dataset.recording = name;
    show(0);
  };
  const tick = (time) => {
    if (!playing) return;
    if (time - shownSince > frameTime) {
      shownSince = time;
      show((player.frame + 1) % frameCount());
    }
    requestAnimationFrame(tick);
  };
  for (const { name, title } of recordings) at("demo").append(new Option(title, name));
  at("demo").addEventListener("change", async () => {
    await open(recordings.find(({ name }) => name === at("demo").value));
    at("demo").focus();
  });
  at("play").addEventListener("click", () => {
    if (!player.recording) return;
    playing = !playing;
    at("play").textContent = playing ? "Pause" : "Play";
    requestAnimationFrame(tick);
  });
  at("frame").addEventListener("input", () => show(Number(at("frame").value)));
  at("lines").addEventListener("change", () => {
    player.lines.visible = at("lines").checked;
    player.render();
  });
  at("wireframe").addEventListener("change", () => {
    player.material.wireframe = at("wireframe").checked;
    player.render();
  });
  at("opacity").addEventListener("input", () => {
    player.material.opacity = Number(at("opacity").value);
    player.material.depthWrite = player.material.opacity === 1;
    player.render();
  });
  open(recordings[0]);
}
