// The charts, drawn with Observable Plot from the rows.
import * as Plot from "@observablehq/plot";
import { labels } from "./labels.js";
import { names, shareFreed } from "./deep.js";
import { families, family, front, isDefault, short } from "./settings.js";

const style = { background: "transparent", fontSize: "13px" };

/** Puts a chart in its place, as wide as that, or says that there is nothing to draw. */
export function show(name, rows, draw) {
  const place = document.querySelector(`[data-plot="${name}"]`);
  if (!rows || rows.length === 0) {
    place.innerHTML = '<p class="absent">Not measured.</p>';
    return null;
  }
  const plot = draw(rows, Math.max(place.clientWidth, 300));
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
    color: { legend: true, domain: families.map((f) => f.name), range: families.map((f) => f.colour) },
    marks: [
      Plot.line(best, { x, y, stroke: "currentColor", strokeOpacity: 0.5 }),
      Plot.dot(known, { x, y, fill: family, r: 5, fillOpacity: 0.75, className: "points" }),
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
const verdictColours = ["#3a9d5d", "#c9b037", "#6aa7c9", "#e08a2c", "#b05fb5", "#7a5c3e", "#c22f3c"];

/** As the scenes call them, and as people do. */
const contactMethods = {
  ours: "raycontact, paper's law", pressure: "raycontact, pressure law", contact_system: "contact system, no Bullet",
  paper: "raycontact, paper's mode", classic: "raycontact, classic bodies",
  vf_dd_implicit: "Bullet VF, implicit", vf_dd_explicit: "Bullet VF, explicit", vf_ss: "Bullet VF, classic bodies",
  cl_ss: "Bullet CL, classic bodies",
};

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
    color: { legend: true, label: "part of the runs that end well", domain: [0, 1], range: ["#b8434e", "#3a9d5d"], tickFormat: "%" },
    marks: [
      Plot.cell([...cells.values()], { ...marks, fill: ({ ok, runs }) => ok / runs, className: "points" }),
      Plot.text([...cells.values()], { ...marks, text: ({ ok, runs }) => `${ok}/${runs}`, fill: "white", fontWeight: 600 }),
    ],
  });
}

/** The part of the overlapping poses of the open benchmark that each library's contacts part. */
export function freed(rows, width) {
  const shares = names(rows).map((library) => ({ library, ...shareFreed(rows, library) })).filter(({ of }) => of > 0);
  shares.sort((a, b) => b.share - a.share);
  return Plot.plot({
    style, width, height: 34 * shares.length + 60, marginLeft: Math.min(190, width / 3), marginRight: 110, marginBottom: 44,
    x: { label: "overlapping poses that come apart, % →", domain: [0, 100], labelOffset: 38 },
    y: { label: null, domain: shares.map(({ library }) => library) },
    marks: [
      Plot.barX(shares, { x: "share", y: "library", className: "points",
        fill: ({ library }) => (library.startsWith("raycontact") ? "#2b7fd4" : "#808890") }),
      Plot.text(shares, { x: "share", y: "library", dx: 6, textAnchor: "start", text: ({ freed, of }) => `${freed} of ${of}` }),
      Plot.ruleX([0]),
    ],
  });
}

/** Who makes the contact of a run in a host. */
const makers = {
  raycontact: ["raycontact", "#2b7fd4"], both: ["raycontact, the host's response", "#17a398"],
  host: ["the host's own", "#808890"], none: ["no contact", "#c9b037"],
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
      isNarrow ? Plot.text(known, { y: "name", frameAnchor: "left", dy: -12, lineAnchor: "bottom", lineWidth: width / 14, text: "name" }) : null,
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

/** What the measuring program's names mean: raycontact alone is the default, through the C library. */
const methodNames = {
  raycontact: "raycontact", "raycontact-rust": "raycontact, from Rust", "raycontact-paper": "raycontact, paper's work",
  "raycontact-paper-classic": "raycontact, paper's work and octree", "lower-bound": "lower bound",
};
const inDouble = ["raycontact", "raycontact-rust"];

/** The default is in double precision; all else that names none is in single. */
function label(row) {
  const method = methodNames[row.method] ?? row.method;
  const usual = inDouble.includes(row.method) ? "f64" : "f32";
  return method + (row.precision === usual ? "" : ` ${row.precision}`) + (row.threads > 1 ? `, ${row.threads} threads` : "");
}

/** Other instructions than the processor's best are left to the tables. */
const isDrawn = (row) => row.threads === 1 && !/-(avx2|baseline)$/.test(row.method);
const lineColours = ["#2b7fd4", "#7fb2e5", "#17a398", "#dd4422", "#c2489c", "#ee8833", "#7766cc", "#a3a33a", "#b0703a", "#808890", "#50a050",
  "#20b8cc"];

function growth(rows, size, unit, width) {
  const sized = rows.filter(isDrawn).map((row) => ({ ...row, size: size(row), label: label(row) }));
  const known = sized.filter((row) => row.size > 0).sort((a, b) => a.size - b.size);
  const found = known.map((row) => row.label).sort();
  const own = Object.values(methodNames).flatMap((name) => [name, `${name} f32`, `${name} f64`]).filter((name) => found.includes(name));
  const labels = [...new Set([...own, ...found])];
  const marks = { x: "size", y: "total_us", stroke: "label" };
  return Plot.plot({
    style, width, height: 480, marginLeft: 70, marginBottom: 48, marginRight: 30, grid: true,
    x: { type: "log", label: `${unit} →`, labelOffset: 42, tickFormat: "~s" },
    y: { type: "log", label: "↑ µs per step", tickFormat: "~s" },
    color: { domain: labels, range: labels.map((_, i) => lineColours[i % lineColours.length]), legend: true },
    marks: [
      Plot.line(known, { ...marks, strokeWidth: (row) => (row.method.startsWith("raycontact") ? 2.5 : 1.5) }),
      Plot.dot(known, { ...marks, fill: "label", r: 3, className: "points" }),
      Plot.tip(known, Plot.pointer({ x: "size", y: "total_us", title: (row) => `${row.label}\n${row.workload}\n${row.total_us} µs` })),
    ],
  });
}

export function byTriangles(rows, width) {
  const isPair = (row) => row.workload.startsWith("pair") || row.workload === "stack2";
  return growth(rows, (row) => (isPair(row) ? row.triangles / 2 : 0), "triangles of each of two bodies", width);
}

export function byBodies(rows, width) {
  return growth(rows, (row) => Number(/^stack(\d+)$/.exec(row.workload)?.[1] ?? 0), "bodies of 1600 triangles", width);
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
    color: { legend: true, scheme: "tableau10" },
    marks: [
      Plot.ruleY([1], { strokeDasharray: "4" }),
      Plot.barY(pairs, { fx: "workload", x: "method", y: "speedup", fill: "method", className: "points" }),
      Plot.tip(pairs, Plot.pointerX({ fx: "workload", x: "method", y: "speedup" })),
    ],
  });
}

export function figure8(rows, width) {
  // Nothing at all has no place on a logarithmic axis: it stands at the lower end.
  const known = rows.map((row) => ({ ...row, percent: Math.max(row.worst * 100, 0.001) }));
  const marks = { x: "sides", y: "percent", stroke: "mode" };
  return Plot.plot({
    style, width, height: 400, marginLeft: 60, marginBottom: 48, marginRight: 30, grid: true,
    x: { type: "log", label: "sides of the cylinder →", labelOffset: 42, tickFormat: "~g", ticks: [10, 20, 50, 100, 150] },
    y: { type: "log", label: "↑ tangential / normal force, %", tickFormat: "~g" },
    color: { legend: true, scheme: "tableau10" },
    marks: [
      Plot.line(known, { ...marks, strokeWidth: 2 }),
      Plot.dot(known, { ...marks, fill: "mode", r: 3, className: "points" }),
      Plot.tip(known, Plot.pointer({ x: "sides", y: "percent", title: (row) => `${row.mode}, ${row.sides} sides\nworst ${row.percent.toFixed(3)} %` })),
    ],
  });
}
