// The charts, drawn with Observable Plot from the rows.
import * as Plot from "@observablehq/plot";
import { contactMethods, label, methodNames, sized } from "./answers.js";
import { labels } from "./labels.js";
import { colours, families, family, front, grey, isDefault, short } from "./settings.js";

const style = { background: "transparent", fontSize: "13px" };

/** Puts a chart in its place, as wide as that, or says that there is nothing to draw. */
export function show(name, rows, draw) {
  const place = document.querySelector(`[data-plot="${name}"]`);
  if (!rows || rows.length === 0) {
    place.innerHTML = '<p class="absent">Not measured.</p>';
    return null;
  }
  // A place behind a click has no width yet.
  const plot = draw(rows, Math.max(document.querySelector("#about").clientWidth, 260));
  plot.setAttribute("aria-label", place.closest("section").querySelector("h2").textContent);
  place.replaceChildren(plot);
  return plot;
}

/** With `everyLabel` all points are labelled, else those of the front; `told` is called with how many had no room. */
export function speedAndAccuracy(rows, measure, { width, everyLabel, told }) {
  const known = rows.filter((row) => measure.of(row) !== null);
  // Nothing wrong at all has no place on a logarithmic axis: it stands at the lower end.
  const y = (row) => Math.max(measure.of(row), measure.least);
  const x = "time_over_lower_bound";
  const best = front(known, measure);
  const rank = (row) => (isDefault(row) ? 2 : best.includes(row) ? 1 : 0);
  const title = (row) => `${row.method}\n${row.settings.replaceAll(" ", "\n")}\n${figures(row)}`;
  const text = (row) => (isDefault(row) ? `${short(row)} (default)` : short(row));
  return Plot.plot({
    style, width, height: everyLabel ? 820 : 680, marginLeft: 60, marginBottom: 48, marginRight: 30, grid: true,
    // Room for labels.
    insetLeft: width < 600 ? 30 : 80, insetBottom: 24, insetTop: 16, insetRight: width < 600 ? 30 : 80,
    x: { type: "log", label: "time of a step, times the lower bound's →", labelOffset: 42, tickFormat: "~g" },
    y: { type: "log", label: `↑ ${measure.unit}`, tickFormat: "~g" },
    color: { domain: families.map((f) => f.name), range: families.map((f) => f.colour) },
    symbol: { legend: true, domain: families.map((f) => f.name), range: families.map((f) => f.symbol) },
    marks: [
      Plot.line(best, { x, y, stroke: "currentColor", strokeOpacity: 0.5 }),
      Plot.dot(known, { x, y, fill: family, symbol: family, r: 5, fillOpacity: 0.75, className: "points" }),
      Plot.dot(known.filter(isDefault), { x, y, r: 10, stroke: "currentColor", strokeWidth: 2 }),
      labels(everyLabel ? known : known.filter((row) => rank(row) > 0), { x, y, text, rank, told }),
      Plot.tip(known, Plot.pointer({ x, y, title, maxRadius: 30 })),
    ],
  });
}

export function figures(row) {
  const percent = (part, digits) => (part === null ? "–" : `${(part * 100).toFixed(digits)} %`);
  return `${row.time_over_lower_bound.toFixed(1)} × lower bound, force ${percent(row.force_error, 3)}, ` +
    `recall ${percent(row.recall, 1)}, direction ${row.direction_error.toFixed(3)}°, ${row.contacts} contacts`;
}

/** Verdicts, good to bad. */
const verdicts = ["ok", "unfinished", "drifting", "overlapping", "passed_through", "inverted", "exploded"];
const verdictColours = ["#009e73", "#f0e442", "#56b4e9", "#e69f00", "#cc79a7", "#0072b2", "#d55e00"];

export function stability(rows, width) {
  const known = [...new Set([...verdicts, ...rows.map((row) => row.verdict)])];
  return Plot.plot({
    style, width: Math.max(width, 700), height: 400, marginLeft: 190, marginTop: 40, marginBottom: 70, padding: 0.06,
    x: { label: "time step, s", type: "band", tickRotate: -45, labelOffset: 60 },
    y: { label: null, type: "band", domain: Object.keys(contactMethods), tickFormat: (method) => contactMethods[method] },
    fx: { label: "stiffness of the contact, N/m for each vertex" },
    color: { legend: true, domain: known, range: known.map((_, i) => verdictColours[i] ?? "#888888"),
      tickFormat: (verdict) => verdict.replaceAll("_", " ") },
    marks: [
      Plot.frame({ strokeOpacity: 0.2 }),
      Plot.cell(rows, { fx: "stiffness", x: "dt", y: "method", fill: "verdict", className: "points", inset: 0.5 }),
      Plot.tip(rows, Plot.pointer({ fx: "stiffness", x: "dt", y: "method", title: describe })),
    ],
  });
}

/** How many runs end well, by method and time step, of all scenes and stiffnesses. */
export function everyScene(rows, width) {
  const cells = new Map();
  for (const { method, dt, verdict } of rows) {
    const key = `${method} ${dt}`;
    const cell = cells.get(key) ?? { method, dt, ok: 0, runs: 0 };
    cell.runs += 1;
    if (verdict === "ok") cell.ok += 1;
    cells.set(key, cell);
  }
  const marks = { x: "dt", y: "method" };
  return Plot.plot({
    style, width: Math.max(width, 700), height: 340, marginLeft: 190, marginTop: 10, marginBottom: 60, padding: 0.06,
    x: { label: "time step, s", type: "band", labelOffset: 44 },
    y: { label: null, type: "band", domain: Object.keys(contactMethods), tickFormat: (method) => contactMethods[method] },
    color: { legend: true, label: "part of the runs that end well", domain: [0, 1], range: ["#d55e00", "#0072b2"], tickFormat: "%" },
    marks: [
      Plot.cell([...cells.values()], { ...marks, fill: ({ ok, runs }) => ok / runs, className: "points" }),
      Plot.text([...cells.values()], { ...marks, text: ({ ok, runs }) => `${ok}/${runs}`, fill: "white", fontWeight: 600 }),
    ],
  });
}

/** A line for each row: its name and figure, and below them a point at its value, with a line from its lowest to its highest. */
function ranked(rows, width, x) {
  const marks = { y: "name", stroke: ({ isOwn }) => (isOwn ? colours[0] : grey) };
  return Plot.plot({
    style, width, height: 42 * rows.length + 50, marginLeft: 10, marginRight: 16, marginBottom: 46, marginTop: 0,
    x: { labelOffset: 36, ...x }, y: { type: "band", axis: null, domain: rows.map((row) => row.name) },
    marks: [
      Plot.gridX({ ticks: 5 }),
      Plot.ruleY(rows, { ...marks, x1: "low", x2: "high", strokeWidth: 4, strokeOpacity: 0.5, dy: 8 }),
      Plot.dot(rows, { ...marks, x: "value", fill: marks.stroke, r: 5, dy: 8, className: "points" }),
      Plot.text(rows, { y: "name", frameAnchor: "left", dy: -7, text: ({ name, figure }) => `${name}: ${figure}`,
        fontWeight: 600, fontSize: width < 600 ? 11.5 : 13, fill: "currentColor", stroke: "var(--plot-background)" }),
    ],
  });
}

export function speed(rows, width) {
  return ranked(rows, width, { type: "log", label: "times raycontact's for the paper's work →", tickFormat: "~g", ticks: 5 });
}

export function parting(rows, width) {
  return ranked(rows, width, { label: "overlapping poses that come apart, % →", domain: [0, 100], ticks: 5 });
}

export function accuracy(rows, width) {
  const isNarrow = width < 600;
  const marks = { x: "time", y: "error" };
  const own = ({ name }) => (name.startsWith("raycontact") ? 0 : name === "Embree" ? 1 : 2);
  return Plot.plot({
    style, width, height: 420, marginLeft: 60, marginBottom: 48, marginRight: 34, grid: true,
    insetLeft: isNarrow ? 30 : 60, insetRight: isNarrow ? 20 : 80, insetTop: 24, insetBottom: 24,
    x: { type: "log", label: "time of a step, times the lower bound's →", labelOffset: 42, tickFormat: "~g", ticks: isNarrow ? 3 : 6 },
    y: { type: "log", label: "↑ direction of the force, degrees off", tickFormat: "~g" },
    symbol: { domain: [0, 1, 2], range: ["circle", "triangle", "square"] },
    marks: [
      Plot.dot(rows, { ...marks, fill: (row) => [colours[0], colours[1], grey][own(row)], symbol: own, r: 6, className: "points" }),
      labels(rows, { ...marks, text: ({ name }) => (isNarrow ? name.replace("raycontact, ", "") : name),
        rank: (row) => (own(row) === 0 ? 1 : 0), told: () => {} }),
    ],
  });
}

/** How the first lines of a chart look; all others are grey. */
const looks = [["circle", null], ["square", "8 3"], ["triangle", "2 3"], ["diamond", "10 3 2 3"], ["star", "4 4"], ["wye", "12 4"]]
  .map(([symbol, strokeDasharray], i) => ({ colour: colours[i], symbol, strokeDasharray }));

function line(rows, place, { colour, symbol, strokeDasharray }) {
  const isFirst = strokeDasharray !== undefined;
  return [
    Plot.line(rows, { ...place, z: "name", stroke: colour, strokeWidth: isFirst ? 2 : 1, strokeDasharray, className: "lines" }),
    Plot.dot(rows, { ...place, fill: colour, symbol, r: isFirst ? 4 : 2, className: "points" }),
  ];
}

/** Lines by the rows' names: those of `first` with looks of their own and a legend, the others grey and named under the pointer. */
function lines(rows, first, { place, title, ...options }) {
  const others = rows.filter(({ name }) => !first.includes(name));
  const plain = { colour: grey, symbol: "circle" };
  const legend = document.createElement("div");
  legend.className = "legend";
  const entry = (name, look) => {
    const key = Plot.plot({ width: 44, height: 16, margin: 5, axis: null, x: { domain: [0, 2] }, y: { domain: [0, 1] },
      marks: [line([0, 1, 2].map((x) => ({ name, x, y: 0.5 })), { x: "x", y: "y" }, look)] });
    const whole = document.createElement("span");
    whole.append(key, name);
    legend.append(whole);
  };
  first.forEach((name, i) => entry(name, looks[i]));
  if (others.length > 0) entry("others: point at one for its name", plain);
  const figure = document.createElement("figure");
  figure.append(legend, Plot.plot({
    style, marginLeft: 60, marginBottom: 48, marginRight: 30, insetTop: 8, grid: true, ...options,
    marks: [
      line(others, place, plain),
      first.map((name, i) => line(rows.filter((row) => row.name === name), place, looks[i])),
      Plot.tip(rows, Plot.pointer({ ...place, title: (row) => `${row.name}\n${title(row)}` })),
    ],
  }));
  return figure;
}

export function steps(rows, width) {
  const first = ["pressure", "ours", "contact_system", "vf_dd_implicit", "vf_dd_explicit", "cl_ss"];
  return lines(rows.toSorted((a, b) => a.dt - b.dt), first.map((name) => contactMethods[name]), {
    width, height: 400, place: { x: "dt", y: "ok" }, title: ({ dt, ok, runs }) => `${dt} s: ${ok} of ${runs}`,
    x: { type: "log", label: "time step, s →", labelOffset: 42, tickFormat: "~g", ticks: width < 600 ? 3 : 6 },
    y: { label: "↑ scenes that end well", domain: [0, Math.max(...rows.map(({ runs }) => runs))] },
  });
}

/** Who makes the contact of a run in a host. */
const makers = {
  raycontact: ["raycontact", colours[0]], both: ["raycontact, the host's response", colours[2]],
  host: ["the host's own", grey], none: ["no contact", colours[3]],
};

/** Milliseconds of a step; pages that count frames say them by the second. */
const stepTime = (row) => row.ms_per_step ?? 1000 / row.frames_per_second;

/** A time step as the pages write it, 0.02 or 1/120, in seconds. */
function seconds(timeStep) {
  const [over, under = 1] = String(timeStep).split("/").map(Number);
  return over / under;
}

/** What a step of a host's scene takes, by time step and contact, in the order of the host's page. */
export function hosts(rows, width) {
  const name = ({ time_step, contact }) => `${time_step} s, ${contact.replaceAll("`", "")}`;
  const figures = ({ time, time_step }) =>
    `${Number(time.toPrecision(3))} ms (${Number((1000 * seconds(time_step) / time).toPrecision(2))})`;
  const known = rows.map((row) => ({ ...row, name: row.host === "own engine" ? row.scene : name(row), time: stepTime(row) }));
  const found = Object.keys(makers).filter((by) => known.some((row) => row.by === by));
  // On narrow screens names stand above their points.
  const isNarrow = width < 700;
  const times = known.map(({ time }) => time);
  const marks = { x: "time", y: "name" };
  const letters = Math.max(...known.map((row) => row.name.length));
  return Plot.plot({
    style, width, height: (isNarrow ? 62 : 28) * known.length + 64,
    marginLeft: isNarrow ? 8 : 30 + 6.6 * letters, marginRight: 140, marginBottom: 44,
    x: { type: "log", label: "milliseconds of a step →", labelOffset: 38, domain: [Math.min(...times) / 1.3, Math.max(...times)],
      tickFormat: "~g", ticks: 4 },
    y: { type: "point", label: null, domain: known.map((row) => row.name), axis: isNarrow ? null : "left", padding: 0.6 },
    color: { legend: true, domain: found.map((by) => makers[by][0]), range: found.map((by) => makers[by][1]) },
    marks: [
      Plot.ruleY(known, { y: "name", strokeOpacity: 0.15 }),
      Plot.dot(known, { ...marks, fill: ({ by }) => makers[by][0], r: 6, className: "points" }),
      Plot.text(known, { ...marks, dx: 11, textAnchor: "start", text: figures, fill: "currentColor", stroke: "var(--plot-background)" }),
      isNarrow ? Plot.text(known, { y: "name", frameAnchor: "left", dy: -12, lineAnchor: "bottom", lineWidth: width / 15, text: "name" }) : null,
    ],
  });
}

/** The scenes of hosts, each with its rows. */
export function hostScenes(rows) {
  const scenes = new Map();
  for (const row of rows ?? []) {
    const scene = row.host === "own engine" ? "an engine of one's own" : `${row.host}: ${row.scene.replaceAll("_", " ")}`;
    scenes.set(scene, [...(scenes.get(scene) ?? []), row]);
  }
  return scenes;
}

function describe(row) {
  return Object.entries(row).filter(([, value]) => value !== null).map(([name, value]) => `${name}: ${value}`).join("\n");
}

function byTime(rows, width, unit) {
  const first = ["raycontact", "raycontact-paper", "embree-refit", "parry3d-refit", "fcl-aabb", "bullet-vf"];
  return lines(rows, first.map((name) => methodNames[name]), {
    width, height: 480, place: { x: "size", y: "total_us" }, title: ({ workload, total_us }) => `${workload}\n${total_us} µs`,
    x: { type: "log", label: `${unit} →`, labelOffset: 42, tickFormat: "~s", ticks: width < 600 ? 3 : 6 },
    y: { type: "log", label: "↑ µs per step", tickFormat: "~s" },
  });
}

export function growth(rows, width) {
  return byTime(rows, width, "triangles of each of two bodies");
}

export function byBodies(rows, width) {
  return byTime(sized(rows, (row) => Number(/^stack(\d+)$/.exec(row.workload)?.[1] ?? 0)), width, "bodies of 1600 triangles");
}

export function parallel(rows, width) {
  const of = (row, threads) => rows.find((other) => other.workload === row.workload && other.method === row.method &&
    other.precision === row.precision && other.threads === threads);
  const pairs = rows.filter((row) => row.threads === 2 && of(row, 1))
    .map((row) => ({ workload: row.workload, method: label({ ...row, threads: 1 }), speedup: of(row, 1).total_us / row.total_us }));
  return Plot.plot({
    style, width, height: 340, marginBottom: 60,
    x: { axis: null }, y: { label: "↑ times as fast as one thread", grid: true, domain: [0, 2.1] },
    fx: { label: null, tickRotate: -25 },
    color: { legend: true, range: colours },
    marks: [
      Plot.ruleY([1], { strokeDasharray: "4" }),
      Plot.barY(pairs, { fx: "workload", x: "method", y: "speedup", fill: "method", className: "points" }),
      Plot.tip(pairs, Plot.pointerX({ fx: "workload", x: "method", y: "speedup" })),
    ],
  });
}

export function figure8(rows, width) {
  // Nothing at all has no place on a logarithmic axis: it stands at the lower end.
  const known = rows.map((row) => ({ ...row, name: row.mode, percent: Math.max(row.worst * 100, 0.001) }));
  return lines(known, [...new Set(known.map((row) => row.name))], {
    width, height: 400, place: { x: "sides", y: "percent" }, title: ({ sides, percent }) => `${sides} sides\nworst ${percent.toFixed(3)} %`,
    x: { type: "log", label: "sides of the cylinder →", labelOffset: 42, tickFormat: "~g", ticks: [10, 20, 50, 100, 150] },
    y: { type: "log", label: "↑ tangential / normal force, %", tickFormat: "~g" },
  });
}
