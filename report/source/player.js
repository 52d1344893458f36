// Plays a recorded demo: two surfaces and their contacts.
import * as Three from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
}

/** Positions out of 16-bit numbers. */
function positions(recording, text) {
  const numbers = new Uint16Array(bytes(text));
  const { lower, upper } = recording;
  return Float32Array.from(numbers, (number, i) => lower[i % 3] + (number / 65535) * (upper[i % 3] - lower[i % 3]));
}

export class Player {
  constructor(recording, stage) {
    this.recording = recording;
    this.count = recording.frames.length;
    this.frame = 0;
    this.playing = false;
    this.last = 0;
    this.scene = new Three.Scene();
    this.camera = new Three.PerspectiveCamera(35, 2, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.renderer = new Three.WebGLRenderer({ antialias: true, alpha: true });
    stage.append(this.renderer.domElement);
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The two bodies; arrow keys turn them");
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.render());
    canvas.addEventListener("keydown", (event) => this.turn(event));
    this.scene.add(new Three.HemisphereLight(0xffffff, 0x667788, 2.2));
    const sun = new Three.DirectionalLight(0xffffff, 1.6);
    sun.position.set(3, -4, 6);
    this.scene.add(sun);
    this.addBodies();
    const first = positions(recording, recording.frames[0].positions);
    const box = new Three.Box3().setFromArray(first);
    this.controls.target.copy(box.getCenter(new Three.Vector3()));
    const reach = box.getSize(new Three.Vector3()).length();
    this.camera.position.copy(this.controls.target).add(new Three.Vector3(0.5, -1.2, 0.55).multiplyScalar(reach * 1.1));
    this.controls.update();
    new ResizeObserver(() => this.resize(stage)).observe(stage);
    this.resize(stage);
    this.show(0);
  }

  addBodies() {
    const { recording } = this;
    const corners = new Uint32Array(bytes(recording.triangles));
    this.attribute = new Three.BufferAttribute(new Float32Array(3 * recording.vertex_count), 3);
    this.normals = new Three.BufferAttribute(new Float32Array(3 * recording.vertex_count), 3);
    this.materials = [0x2f7fc1, 0xd9822b].map((color, body) => {
      const own = corners.filter((_, i) => corners[i - (i % 3)] < recording.first_count === (body === 0));
      const geometry = new Three.BufferGeometry();
      geometry.setAttribute("position", this.attribute);
      geometry.setAttribute("normal", this.normals);
      geometry.setIndex(new Three.BufferAttribute(own, 1));
      const material = new Three.MeshStandardMaterial({
        color, roughness: 0.6, side: Three.DoubleSide, transparent: true, opacity: 0.45, depthWrite: false,
      });
      const mesh = new Three.Mesh(geometry, material);
      mesh.frustumCulled = false;
      this.scene.add(mesh);
      return material;
    });
    this.corners = corners;
    this.lines = new Three.LineSegments(new Three.BufferGeometry(),
      new Three.LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true }));
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 1;
    this.scene.add(this.lines);
    this.deepest = Math.max(...recording.frames.map((frame) => frame.deepest));
  }

  resize(stage) {
    const { clientWidth: width, clientHeight: height } = stage;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  show(frame) {
    this.frame = frame;
    const recorded = this.recording.frames[frame];
    this.attribute.array.set(positions(this.recording, recorded.positions));
    this.attribute.needsUpdate = true;
    this.findNormals();
    const ends = positions(this.recording, recorded.contacts);
    const colours = new Float32Array(ends.length);
    const colour = new Three.Color();
    for (let i = 0; i < ends.length; i += 6) {
      const depth = Math.hypot(ends[i] - ends[i + 3], ends[i + 1] - ends[i + 4], ends[i + 2] - ends[i + 5]);
      // From blue, shallow, to red, deep.
      colour.setHSL(0.62 * (1 - Math.min(depth / this.deepest, 1)), 0.95, 0.5);
      for (const end of [0, 3]) colour.toArray(colours, i + end);
    }
    this.lines.geometry.dispose();
    this.lines.geometry = new Three.BufferGeometry();
    this.lines.geometry.setAttribute("position", new Three.BufferAttribute(ends, 3));
    this.lines.geometry.setAttribute("color", new Three.BufferAttribute(colours, 3));
    this.contactCount = ends.length / 6;
    this.render();
  }

  /** Sums of the surrounding triangles' normals; lights want no unit length. */
  findNormals() {
    const [p, n, c] = [this.attribute.array, this.normals.array, this.corners];
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
    const offset = this.camera.position.clone().sub(this.controls.target);
    const sphere = new Three.Spherical().setFromVector3(new Three.Vector3(offset.x, offset.z, -offset.y));
    const steps = {
      ArrowLeft: () => (sphere.theta -= 0.1), ArrowRight: () => (sphere.theta += 0.1),
      ArrowUp: () => (sphere.phi -= 0.1), ArrowDown: () => (sphere.phi += 0.1),
      "+": () => (sphere.radius /= 1.1), "-": () => (sphere.radius *= 1.1),
    };
    if (!steps[event.key]) return;
    event.preventDefault();
    steps[event.key]();
    sphere.makeSafe();
    const turned = new Three.Vector3().setFromSpherical(sphere);
    this.camera.position.copy(this.controls.target).add(new Three.Vector3(turned.x, -turned.z, turned.y));
    this.controls.update();
  }

  render() {
    this.renderer.render(this.scene, this.camera);
  }
}

/** Ties the player to the page's controls. */
export function start(recording) {
  const stage = document.getElementById("stage");
  if (!recording) {
    stage.innerHTML = '<p class="absent">Not recorded.</p>';
    return;
  }
  const at = (id) => document.getElementById(id);
  let player;
  try {
    player = new Player(recording, stage);
  } catch (error) {
    stage.innerHTML = '<p class="absent">This browser shows no 3-D pictures (WebGL is off).</p>';
    return;
  }
  at("frame").max = player.count - 1;
  at("deepest").textContent = `${player.deepest.toFixed(2)} m`;
  const show = (frame) => {
    player.show(frame);
    at("frame").value = frame;
    at("frame-text").textContent = `${frame + 1} of ${player.count}, ${player.contactCount} contacts`;
    stage.dataset.frame = frame;
    stage.dataset.contacts = player.contactCount;
  };
  const tick = (time) => {
    if (!player.playing) return;
    if (time - player.last > 80) {
      player.last = time;
      show((player.frame + 1) % player.count);
    }
    requestAnimationFrame(tick);
  };
  at("play").addEventListener("click", () => {
    player.playing = !player.playing;
    at("play").textContent = player.playing ? "Pause" : "Play";
    requestAnimationFrame(tick);
  });
  at("frame").addEventListener("input", () => show(Number(at("frame").value)));
  at("lines").addEventListener("change", () => {
    player.lines.visible = at("lines").checked;
    player.render();
  });
  at("wireframe").addEventListener("change", () => {
    for (const material of player.materials) material.wireframe = at("wireframe").checked;
    player.render();
  });
  at("opacity").addEventListener("input", () => {
    for (const material of player.materials) {
      material.opacity = Number(at("opacity").value);
      material.depthWrite = material.opacity === 1;
    }
    player.render();
  });
  show(0);
}
