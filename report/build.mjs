// SPDX-License-Identifier: MIT OR Apache-2.0
// Makes docs/report/index.html from the measurements under docs/: one file that needs no network.
import { build } from "esbuild";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const docs = join(here, "../docs");
const output = join(docs, "report/index.html");

/** Rows as objects; numbers as numbers, empty fields as null. The measuring programs write no quotes. */
function readCsv(name) {
  const path = join(docs, name);
  if (!existsSync(path)) return null;
  const [head, ...lines] = readFileSync(path, "utf8").trim().split("\n").map((line) => line.split(","));
  const value = (text) => (text === "" ? null : Number.isNaN(Number(text)) ? text : Number(text));
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, value(line[i])])));
}

/** The table of failures in docs/stability.md, with its pictures. */
function readFailures() {
  const text = readFileSync(join(docs, "stability.md"), "utf8");
  const lines = text.split("\n");
  const first = lines.findIndex((line) => line.startsWith("| failure |"));
  if (first < 0) return null;
  const last = lines.findIndex((line, i) => i > first && !line.startsWith("|"));
  const cells = (line) => line.split("|").slice(1, -1).map((cell) => cell.trim());
  const rows = lines.slice(first + 2, last).map((line) => {
    const [name, ...counts] = cells(line);
    const link = /^\[(.*)\]\((.*)\)$/.exec(name);
    const picture = link && readFileSync(join(docs, link[2]), "utf8");
    return { name: link ? link[1] : name, counts, picture };
  });
  return { modes: cells(lines[first]).slice(1), rows };
}

/** The demos of report/recordings.json that were recorded, gzip in base 64. */
function readRecordings() {
  const known = JSON.parse(readFileSync(join(here, "recordings.json"), "utf8"));
  const path = ({ name }) => join(docs, `report/recordings/${name}.gz`);
  return known.filter((recording) => existsSync(path(recording))).map((recording) => {
    const { name, title, floor = false } = recording;
    return { name, title, floor, packed: readFileSync(path(recording)).toString("base64") };
  });
}

const data = {
  chart: readCsv("chart/chart.csv"),
  stability: readCsv("stability/map.csv"),
  detect: readCsv("performance/detect.csv"),
  figure8: readCsv("accuracy/figure8.csv"),
  failures: readFailures(),
  recordings: readRecordings(),
};

const bundle = await build({
  entryPoints: [join(here, "source/main.js")],
  bundle: true,
  minify: true,
  write: false,
  format: "iife",
  legalComments: "none",
  target: "es2022",
});
const script = bundle.outputFiles[0].text.replaceAll("</script", "<\\/script");
const replacements = {
  "/* style */": readFileSync(join(here, "source/style.css"), "utf8"),
  "/* data */": JSON.stringify(data).replaceAll("<", "\\u003c"),
  "/* script */": script,
};
let page = readFileSync(join(here, "source/index.html"), "utf8");
for (const [place, text] of Object.entries(replacements)) page = page.replace(place, () => text);
writeFileSync(output, page);
const absent = Object.entries(data).filter(([, value]) => !value || value.length === 0).map(([name]) => name);
console.log(`${output}: ${(page.length / 1e6).toFixed(2)} MB${absent.length ? `; not measured: ${absent}` : ""}`);
