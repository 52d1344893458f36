// SPDX-License-Identifier: MIT OR Apache-2.0
// Makes docs/report/index.html from the measurements under docs/: one file that needs no network.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { existsSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, "../..");
const output = join(root, "docs/report/index.html");

/** What the page is made from: a hash for each file, by which cpp_tests/page_sources.cmake knows whether it is up to date. */
const sources = [];

function read(path) {
  const bytes = readFileSync(join(root, path));
  sources.push(`${path}=${createHash("sha256").update(bytes).digest("hex")}`);
  return bytes;
}

/** The fields of a line; those in quotes may hold commas. */
function fields(line) {
  return Array.from(line.matchAll(/("(?:[^"]|"")*"|[^,]*)(?:,|$)/g), ([, field]) =>
    field.startsWith('"') ? field.slice(1, -1).replaceAll('""', '"') : field).slice(0, -1);
}

/** By the name of each CSV file, its first line: date, commit, seed and command of its figures. */
const origins = {};

/** Rows as objects; numbers as numbers, empty fields as null. */
function readCsv(name) {
  const path = `docs/${name}`;
  if (!existsSync(join(root, path))) return null;
  const [origin, ...table] = read(path).toString().trim().split("\n");
  origins[name] = origin.replace("# ", "");
  const [head, ...lines] = table.map(fields);
  const value = (text) => (text === "" ? null : Number.isNaN(Number(text)) ? text : Number(text));
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, value(line[i])])));
}

/** The table of failures in docs/stability.md, with its pictures. */
function readFailures() {
  const lines = read("docs/stability.md").toString().split("\n");
  const first = lines.findIndex((line) => line.startsWith("| failure |"));
  if (first < 0) return null;
  const last = lines.findIndex((line, i) => i > first && !line.startsWith("|"));
  const cells = (line) => line.split("|").slice(1, -1).map((cell) => cell.trim());
  const rows = lines.slice(first + 2, last).map((line) => {
    const [name, ...counts] = cells(line);
    const link = /^\[(.*)\]\((.*)\)$/.exec(name);
    const picture = link && read(`docs/${link[2]}`).toString();
    return { name: link ? link[1] : name, counts, picture };
  });
  return { modes: cells(lines[first]).slice(1), rows };
}

/** The demos of evaluation/report/recordings.json that were recorded, gzip in base 64. */
function readRecordings() {
  const known = JSON.parse(read("evaluation/report/recordings.json").toString());
  const path = ({ name }) => `docs/report/recordings/${name}.gz`;
  return known.filter((recording) => existsSync(join(root, path(recording)))).map((recording) => {
    const { name, title, floor = false } = recording;
    return { name, title, floor, packed: read(path(recording)).toString("base64") };
  });
}

/** Text that the page unpacks by itself. */
function packed(text) {
  return gzipSync(text, { level: 9 }).toString("base64");
}

const data = {
  chart: readCsv("chart/chart.csv"),
  stability: readCsv("stability/map.csv"),
  detect: readCsv("performance/detect.csv"),
  figure8: readCsv("accuracy/figure8.csv"),
  hosts: readCsv("hosts/frame_rates.csv"),
  failures: readFailures(),
  deep: {
    detect: readCsv("penetration/detect.csv"),
    measure: readCsv("penetration/measure.csv"),
    free: readCsv("penetration/free.csv"),
    simulate: readCsv("penetration/simulate.csv"),
  },
  scaling: read("docs/distributed/scaling.svg").toString(),
  origins,
};
const recordings = readRecordings();

const bundle = await build({
  entryPoints: [join(here, "source/main.js")],
  bundle: true,
  minify: true,
  write: false,
  format: "iife",
  legalComments: "none",
  target: "es2022",
});
// What the bundle is made of, but for npm's packages, which package-lock.json holds fast.
for (const name of readdirSync(join(here, "source")).filter((name) => name.endsWith(".js"))) read(`evaluation/report/source/${name}`);
read("evaluation/report/package-lock.json");
const style = read("evaluation/report/source/style.css").toString();
let page = read("evaluation/report/source/index.html").toString();
const replacements = {
  "/* style */": style,
  "/* sources */": sources.join(" "),
  "/* recordings */": JSON.stringify(recordings).replaceAll("<", "\\u003c"),
  "/* data */": packed(JSON.stringify(data)),
  "/* program */": packed(bundle.outputFiles[0].text),
};
for (const [place, text] of Object.entries(replacements)) page = page.replace(place, () => text);
writeFileSync(output, page);
const absent = Object.entries(data).filter(([, value]) => !value || value.length === 0).map(([name]) => name);
console.log(`${output}: ${(page.length / 1e6).toFixed(2)} MB${absent.length ? `; not measured: ${absent}` : ""}`);
