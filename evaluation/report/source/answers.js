// What answers the five questions at the head of the page: rows for each chart, and a sentence, from the measurements.
import { names, shareFreed } from "./deep.js";
import { isDefault } from "./settings.js";

function median(numbers) {
  const [sorted, half] = [[...numbers].sort((a, b) => a - b), numbers.length / 2];
  return (sorted[Math.ceil(half) - 1] + sorted[Math.floor(half)]) / 2;
}

const rounded = (number) => String(Number(number.toPrecision(2)));
/** Digits in threes, as in 10 000. */
const digits = (number) => String(number).replace(/\B(?=(\d{3})+$)/g, "\u00a0");

/** What measuring programs call the methods of detection, and what people do. */
export const methodNames = {
  raycontact: "raycontact, default", "raycontact-paper": "raycontact, paper's options", "raycontact-rust": "raycontact, from Rust",
  "raycontact-paper-classic": "raycontact, paper's options and octree", "lower-bound": "lower bound",
  "embree-refit": "Embree, tree refitted", "embree-low": "Embree, tree rebuilt", "embree4-refit": "Embree 4, tree refitted",
  "parry3d-refit": "Parry, tree refitted", "obvhs-refit": "obvhs, tree refitted", "fcl-aabb": "FCL", "bullet-vf": "Bullet VF",
};
const tracers = ["raycontact-paper", "raycontact", "embree-refit", "embree-low", "obvhs-refit", "parry3d-refit"];
const precision = (method) => (method === "raycontact" ? "f64" : "f32");

/** Times as multiples of the paper's work in raycontact, for each ray tracer the median of all scenes. */
export function speed({ detect }) {
  const time = (workload, method) => detect.find((row) => row.workload === workload && row.method === method &&
    row.precision === precision(method) && row.threads === 1).total_us;
  const scenes = [...new Set(detect.map((row) => row.workload))];
  const rows = tracers.map((method) => {
    const ratios = scenes.map((scene) => time(scene, method) / time(scene, "raycontact-paper"));
    const [value, low, high] = [median(ratios), Math.min(...ratios), Math.max(...ratios)];
    return { name: methodNames[method], method, value, low, high, figure: rounded(value), isOwn: method.startsWith("raycontact") };
  }).sort((a, b) => a.value - b.value);
  const [best, own] = [rows.find((row) => !row.isOwn), rows.find((row) => row.method === "raycontact")];
  return { rows, text: `For the paper's work ${best.name.split(",")[0]}, the fastest of the others, takes ${best.figure} times as ` +
    `long as raycontact; raycontact's default does more and takes ${own.figure} times as long (medians of ${scenes.length} scenes).` };
}

/** What the chart of speed against accuracy has of the many settings. */
const settings = [
  [methodNames.raycontact, isDefault],
  ["raycontact, accuracy 0.1", ({ settings }) =>
    /^law=pressure sampling=(accuracy|tolerance):0.1 precision=f64 layout=wide edges=on weights=area/.test(settings)],
  ["raycontact, paper's options", ({ method, settings }) => method === "paper" && /f32 layout=wide/.test(settings)],
  ["Embree", ({ method, settings }) => method === "embree-refit" && /weights=paper/.test(settings)],
  ["FCL", ({ method }) => method === "fcl-aabb"],
  ["Bullet CL", ({ method }) => method === "bullet-cl"],
  ["Bullet VF", ({ method }) => method === "bullet-vf"],
  ["closest features", ({ method }) => method === "proximity"],
];

/** Time and direction of the force, medians of all scenes. */
export function accuracy({ chart }) {
  const rows = settings.map(([name, fits]) => ({ name, own: chart.filter(fits) })).filter(({ own }) => own.length > 0)
    .map(({ name, own }) => ({ name, time: median(own.map((row) => row.time_over_lower_bound)),
      error: median(own.map((row) => row.direction_error)) }));
  const [own, embree] = [methodNames.raycontact, "Embree"].map((name) => rows.find((row) => row.name === name));
  const figures = ({ time, error }) => `${rounded(error)}° off in ${rounded(time)} times the lower bound's time`;
  return { rows, text: `The force of raycontact's default is ${figures(own)}, that of the paper's method on Embree ` +
    `${figures(embree)} (medians of ${new Set(chart.map((row) => row.scene)).size} scenes).` };
}

/** The part of the overlapping poses of the open benchmark that each library's contacts part. */
export function parting({ deep: { free } }) {
  const rows = names(free).map((name) => ({ name, ...shareFreed(free, name) })).filter(({ of }) => of > 0)
    .map(({ name, share, freed, of }) => ({ name, low: 0, value: share, high: share, figure: `${digits(freed)} of ${digits(of)}`,
      isOwn: name.startsWith("raycontact") })).sort((a, b) => b.value - a.value);
  const [own, best] = [rows.find((row) => row.name === "raycontact"), rows.find((row) => !row.isOwn)];
  return { rows, text: `raycontact parts ${own.figure} overlapping poses, and ${best.name}, the best of the others, ${best.figure}.` };
}

/** As the scenes of the map call them, and as people do. */
export const contactMethods = {
  ours: "raycontact, paper's law", pressure: "raycontact, pressure law", contact_system: "contact system, no Bullet",
  paper: "raycontact, paper's mode", classic: "raycontact, classic bodies",
  vf_dd_implicit: "Bullet VF, implicit", vf_dd_explicit: "Bullet VF, explicit", vf_ss: "Bullet VF, classic bodies",
  cl_ss: "Bullet CL, classic bodies",
};

/** The part of the scenes that end well by time step, at the stiffness that the bodies suggest: the middle one of three. */
export function steps({ stability }) {
  const key = ({ scene, method }) => `${scene} ${method}`;
  const stiffnesses = Map.groupBy(stability, key);
  const middle = (row) => row.stiffness === median([...new Set(stiffnesses.get(key(row)).map((row) => row.stiffness))]);
  const cells = Map.groupBy(stability.filter(middle), (row) => `${row.method} ${row.dt}`);
  const rows = [...cells.values()].map((runs) => ({ name: contactMethods[runs[0].method], dt: runs[0].dt, runs: runs.length,
    ok: runs.filter((run) => run.verdict === "ok").length }));
  const own = rows.filter((row) => row.name === contactMethods.pressure);
  const isWell = ({ dt }) => own.every((row) => row.dt > dt || row.ok === row.runs);
  const most = Math.max(...rows.filter((row) => row.name.startsWith("Bullet")).map((row) => row.ok));
  return { rows, text: `With raycontact all ${own[0].runs} scenes end well at steps of up to ` +
    `${Math.max(...own.filter(isWell).map((row) => row.dt))} s; with Bullet's own contact at most ${most} do, at any step.` };
}

/** Other instructions than the processor's best are left to the tables. */
const isDrawn = (row) => row.threads === 1 && !/-(avx2|baseline)$/.test(row.method);

/** The default is in double precision; all else that names none is in single. */
export function label(row) {
  const method = methodNames[row.method] ?? row.method;
  const usual = ["raycontact", "raycontact-rust"].includes(row.method) ? "f64" : "f32";
  return method + (row.precision === usual ? "" : row.precision === "f32" ? ", single precision" : ", double precision");
}

/** Rows with a size and a name, by size. */
export function sized(rows, size) {
  return rows.filter(isDrawn).map((row) => ({ ...row, size: size(row), name: label(row) })).filter((row) => row.size > 0)
    .sort((a, b) => a.size - b.size);
}

/** Times by triangles of each of two bodies. */
export function growth({ detect }) {
  const isPair = (row) => row.workload.startsWith("pair") || row.workload === "stack2";
  const rows = sized(detect, (row) => (isPair(row) ? row.triangles / 2 : 0));
  const times = (method) => {
    const own = rows.filter((row) => row.name === methodNames[method]);
    return rounded(own.at(-1).total_us / own[0].total_us);
  };
  return { rows, text: `Bodies of ${digits(rows.at(-1).size / rows[0].size)} times as many triangles take raycontact's default ` +
    `${times("raycontact")} times as long, the paper's options ${times("raycontact-paper")} times, and Embree ${times("embree-refit")} times.` };
}
