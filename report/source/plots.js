// The charts, drawn with Observable Plot from the rows.
import * as Plot from "@observablehq/plot";
import { families, family, front, isDefault } from "./settings.js";

const style = { background: "transparent", fontSize: "13px" };

/** Puts a chart in its place, or says that there is nothing to draw. */
export function show(name, rows, draw) {
  const place = document.querySelector(`[data-plot="${name}"]`);
  if (!rows || rows.length === 0) {
    place.innerHTML = '<p class="absent">Not measured.</p>';
    return null;
  }
  const plot = draw(rows);
  plot.setAttribute("aria-label", place.closest("section").querySelector("h2").textContent);
  place.replaceChildren(plot);
  return plot;
}

export function speedAndAccuracy(rows, measure) {
  const known = rows.filter((row) => measure.of(row) !== null);
  // Nothing wrong at all has no place on a logarithmic axis: it stands at the lower end.
  const error = (row) => Math.max(measure.of(row), measure.least);
  const x = "time_floor_multiple";
  const title = (row) => `${row.method}\n${row.settings.replaceAll(" ", "\n")}\n${figures(row)}`;
  return Plot.plot({
    style, width: 960, height: 520, marginLeft: 60, grid: true,
    x: { type: "log", label: "time of a step, times the floor's →", tickFormat: "~g" },
    y: { type: "log", label: `↑ ${measure.unit}`, tickFormat: "~g" },
    color: { legend: true, domain: families.map((f) => f.name), range: families.map((f) => f.colour) },
    marks: [
      Plot.line(front(known, measure), { x, y: error, stroke: "currentColor", strokeOpacity: 0.5 }),
      Plot.dot(known, { x, y: error, fill: family, r: 5, fillOpacity: 0.75, className: "points" }),
      Plot.dot(known.filter(isDefault), { x, y: error, r: 10, stroke: "currentColor", strokeWidth: 2 }),
      Plot.text(known.filter(isDefault), { x, y: error, text: () => "default", dy: -18, fill: "currentColor" }),
      Plot.tip(known, Plot.pointer({ x, y: error, title, maxRadius: 30 })),
    ],
  });
}

export function figures(row) {
  const percent = (part, digits) => (part === null ? "–" : `${(part * 100).toFixed(digits)} %`);
  return `${row.time_floor_multiple.toFixed(1)} × floor, force ${percent(row.force_error, 3)}, ` +
    `recall ${percent(row.recall, 1)}, direction ${row.direction_error.toFixed(3)}°, ${row.contacts} contacts`;
}

/** Verdicts, good to bad. */
const verdicts = ["ok", "unfinished", "overlapping", "passed_through", "inverted", "exploded"];
const verdictColours = ["#3a9d5d", "#c9b037", "#e08a2c", "#b05fb5", "#7a5c3e", "#c22f3c"];

export function stability(rows) {
  const known = [...new Set([...verdicts, ...rows.map((row) => row.verdict)])];
  return Plot.plot({
    style, width: 960, height: 420, marginLeft: 80, marginBottom: 50, padding: 0.06,
    x: { label: "time step, s", type: "band" },
    y: { label: "stiffness", type: "band", reverse: true },
    fx: { label: null },
    color: { legend: true, domain: known, range: known.map((_, i) => verdictColours[i] ?? "#888888") },
    marks: [
      Plot.cell(rows, { fx: "method", x: "dt", y: "stiffness", fill: "verdict", className: "points", inset: 0.5 }),
      Plot.tip(rows, Plot.pointer({ fx: "method", x: "dt", y: "stiffness", title: describe })),
    ],
  });
}

function describe(row) {
  return Object.entries(row).filter(([, value]) => value !== null).map(([name, value]) => `${name}: ${value}`).join("\n");
}

function label(row) {
  return row.method + (row.precision === "f64" ? " f64" : "") + (row.threads > 1 ? `, ${row.threads} threads` : "");
}

function growth(rows, size, unit) {
  const sized = rows.filter((row) => row.threads === 1).map((row) => ({ ...row, size: size(row), label: label(row) }));
  const known = sized.filter((row) => row.size > 0).sort((a, b) => a.size - b.size);
  const marks = { x: "size", y: "total_us", stroke: "label" };
  return Plot.plot({
    style, width: 960, height: 480, marginLeft: 70, marginRight: 150, grid: true,
    x: { type: "log", label: `${unit} →`, tickFormat: "~s" },
    y: { type: "log", label: "↑ µs per step", tickFormat: "~s" },
    color: { scheme: "spectral", legend: true },
    marks: [
      Plot.line(known, { ...marks, strokeWidth: (row) => (row.label === "raycontact" ? 3 : 1.5) }),
      Plot.dot(known, { ...marks, fill: "label", r: 3, className: "points" }),
      Plot.tip(known, Plot.pointer({ x: "size", y: "total_us", title: (row) => `${row.label}\n${row.workload}\n${row.total_us} µs` })),
    ],
  });
}

export function byTriangles(rows) {
  const isPair = (row) => row.workload.startsWith("pair") || row.workload === "stack2";
  return growth(rows, (row) => (isPair(row) ? row.triangles / 2 : 0), "triangles of each of two bodies");
}

export function byBodies(rows) {
  return growth(rows, (row) => Number(/^stack(\d+)$/.exec(row.workload)?.[1] ?? 0), "bodies of 1600 triangles");
}

export function parallel(rows) {
  const of = (row, threads) => rows.find((other) => other.workload === row.workload && other.method === row.method &&
    other.precision === row.precision && other.threads === threads);
  const pairs = rows.filter((row) => row.threads === 2 && of(row, 1))
    .map((row) => ({ workload: row.workload, method: row.method, speedup: of(row, 1).total_us / row.total_us }));
  return Plot.plot({
    style, width: 960, height: 340, marginBottom: 60,
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

export function figure8(rows) {
  const known = rows.map((row) => ({ ...row, percent: row.worst * 100 }));
  const marks = { x: "sides", y: "percent", stroke: "mode" };
  return Plot.plot({
    style, width: 960, height: 400, marginLeft: 60, grid: true,
    x: { type: "log", label: "sides of the cylinder →", tickFormat: "~g", ticks: [10, 20, 50, 100, 150] },
    y: { type: "log", label: "↑ tangential / normal force, %", tickFormat: "~g" },
    color: { legend: true, scheme: "tableau10" },
    marks: [
      Plot.line(known, { ...marks, strokeWidth: 2 }),
      Plot.dot(known, { ...marks, fill: "mode", r: 3, className: "points" }),
      Plot.tip(known, Plot.pointer({ x: "sides", y: "percent", title: (row) => `${row.mode}, ${row.sides} sides\nworst ${row.percent.toFixed(3)} %` })),
    ],
  });
}
