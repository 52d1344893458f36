// The page: charts, tables and the player, from the data in the page itself.
import * as answers from "./answers.js";
import * as plots from "./plots.js";
import { code, front, isDefault, measures, short, variants } from "./settings.js";
import { head, ranking } from "./deep.js";
import { start } from "./player.js";

const data = window.measured;
const at = (id) => document.getElementById(id);

function element(name, text, className) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function fill(select, options) {
  for (const [value, text] of options) select.append(new Option(text, value));
}

async function copy(row) {
  const text = code(row);
  at("code").textContent = text;
  try {
    await navigator.clipboard.writeText(text);
    at("copied").textContent = "Copied.";
  } catch {
    at("copied").textContent = "The browser did not allow copying: the code is below.";
  }
}

function frontTable(rows, measure) {
  const table = at("front");
  const head = element("tr");
  for (const name of ["setting", "× lower bound", "force error", "contacts", "recall", "direction", ""]) {
    head.append(element("th", name));
  }
  const shown = front(rows, measure);
  shown.push(...rows.filter((row) => isDefault(row) && !shown.includes(row)));
  const percent = (part) => (part === null ? "–" : `${(part * 100).toFixed(2)} %`);
  const lines = shown.map((row) => {
    const line = element("tr");
    const numbers = [row.time_over_lower_bound.toFixed(1), percent(row.force_error), row.contacts, percent(row.recall),
      `${row.direction_error.toFixed(3)}°`];
    const setting = element("td", `${short(row)}${isDefault(row) ? " (default)" : ""}`);
    setting.title = `${row.method} ${row.settings}`;
    line.append(setting, ...numbers.map((number) => element("td", number, "number")));
    const button = element("button", "Copy C");
    button.type = "button";
    button.addEventListener("click", () => copy(row));
    const cell = element("td");
    cell.append(button);
    line.append(cell);
    return line;
  });
  table.replaceChildren(head, ...lines);
}

function choose() {
  if (!data.chart) {
    plots.show("choose", null);
    return;
  }
  const ofScene = data.chart.filter((row) => row.scene === at("scene").value);
  const rows = ofScene.filter((row) => variants.every(({ key, fits }) => at(`with-${key}`).checked || !fits(row)));
  const measure = measures.find((measure) => measure.key === at("measure").value);
  const everyLabel = at("labels").value === "all";
  let unlabelled = 0;
  const plot = plots.show("choose", rows, (rows, width) =>
    plots.speedAndAccuracy(rows, measure, { width, everyLabel, told: (count) => (unlabelled = count) }));
  at("unlabelled").textContent = unlabelled > 0 ? `${unlabelled} labels found no room: point at their points.` : "";
  // The row under the pointer is the plot's value; pressing holds it or lets it go.
  let pointed = null;
  plot.addEventListener("input", () => (pointed = plot.value ?? pointed));
  plot.addEventListener("click", () => pointed && copy(pointed));
  frontTable(rows, measure);
}

function failures() {
  const table = at("failure-table");
  if (!data.failures) {
    table.replaceWith(element("p", "Not measured.", "absent"));
    return;
  }
  const head = element("tr");
  for (const name of ["failure", ...data.failures.modes]) head.append(element("th", name));
  table.append(head);
  for (const { name, counts, picture } of data.failures.rows) {
    const line = element("tr");
    line.append(element("td", name));
    for (const count of counts) line.append(element("td", count, "number"));
    table.append(line);
    if (!picture) continue;
    const details = element("details");
    const image = element("img");
    image.alt = `${name}: from its start to where each mode leaves it`;
    image.src = `data:image/svg+xml,${encodeURIComponent(picture)}`;
    details.append(element("summary", name), image);
    at("failure-pictures").append(details);
  }
}

function deep() {
  const table = at("deep-table");
  const line = (cells, name) => {
    const made = element("tr");
    made.append(...cells.map(({ text, isBest }, i) => element(name, text, [i > 0 && "number", isBest && "best"].filter(Boolean).join(" "))));
    return made;
  };
  const rows = ranking(data.deep).map((cells) => line(cells, "td"));
  table.replaceChildren(line(head.map((text) => ({ text })), "th"), ...rows);
}

function stability() {
  const scene = at("map-scene").value;
  if (scene === "all") plots.show("stability", data.stability, plots.everyScene);
  else plots.show("stability", data.stability?.filter((row) => row.scene === scene), plots.stability);
}

const scenesOfHosts = plots.hostScenes(data.hosts);
function hosts() {
  plots.show("hosts", scenesOfHosts.get(at("host-scene").value), plots.hosts);
}

fill(at("scene"), [...new Set((data.chart ?? []).map((row) => row.scene))].map((scene) => [scene, scene]));
fill(at("measure"), measures.map((measure) => [measure.key, measure.name]));
fill(at("map-scene"), [["all", "all scenes"]]);
fill(at("map-scene"), [...new Set((data.stability ?? []).map((row) => row.scene))].map((s) => [s, s.replaceAll("_", " ")]));
fill(at("host-scene"), [...scenesOfHosts.keys()].map((scene) => [scene, scene]));
at("runs").textContent = data.stability?.length ?? 0;
for (const { key, name, isShown } of variants) {
  const box = element("input");
  Object.assign(box, { type: "checkbox", id: `with-${key}`, checked: isShown });
  box.addEventListener("change", choose);
  const label = element("label");
  label.append(box, ` ${name}`);
  at("variants").append(label);
}
for (const id of ["scene", "measure", "labels"]) at(id).addEventListener("change", choose);
at("map-scene").addEventListener("change", stability);
at("host-scene").addEventListener("change", hosts);
at("theme").addEventListener("click", () => {
  const root = document.documentElement;
  const isDark = (root.dataset.theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
  root.dataset.theme = isDark ? "light" : "dark";
});
/** The five questions: the place of each, and what answers it. */
const questions = ["speed", "accuracy", "parting", "steps", "growth"].map((name) => [name, answers[name](data)]);
for (const [name, { text }] of questions) document.querySelector(`#${name} .answer`).textContent = text;
function drawAll() {
  for (const [name, { rows }] of questions) plots.show(name, rows, plots[name]);
  choose();
  stability();
  hosts();
  plots.show("bodies", data.detect, plots.byBodies);
  plots.show("parallel", data.detect, plots.parallel);
  plots.show("figure8", data.figure8, plots.figure8);
}

/** A link into what is behind the click opens it. */
function open() {
  const details = location.hash && document.querySelector(location.hash)?.closest("details");
  if (details && !details.open) details.open = true;
}
addEventListener("hashchange", open);
open();

at("origin-list").append(...Object.entries(data.origins).map(([name, origin]) => element("li", `${name}: ${origin}`)));
start(data.recordings);
failures();
deep();
const scaling = element("img");
scaling.alt = "Time of a step by the number of ranks";
scaling.src = `data:image/svg+xml,${encodeURIComponent(data.scaling)}`;
at("scaling-picture").append(scaling);
let width = 0;
new ResizeObserver(([{ contentRect }]) => {
  if (contentRect.width === width) return;
  width = contentRect.width;
  drawAll();
}).observe(at("about"));
drawAll();
at("code").textContent = code((data.chart ?? []).find(isDefault) ?? { method: "raycontact is not measured", settings: "" });
