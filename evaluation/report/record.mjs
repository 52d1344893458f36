// SPDX-License-Identifier: MIT OR Apache-2.0
// Runs the scenes that evaluation/report/recordings.json lists and packs their surfaces into docs/report/recordings.
// Usage: node record.mjs <folder of the scenes' programs> <the measuring program>
import { spawnSync } from "node:child_process";
import { mkdirSync, readFileSync, statSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [programs, bench] = process.argv.slice(2);
const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const folder = join(root, "docs/report/recordings");
mkdirSync(folder, { recursive: true });

function run(program, options, isRight) {
  const { status, error } = spawnSync(program, options, { stdio: "inherit" });
  if (!isRight(status)) throw error ?? new Error(`'${[program, ...options].join(" ")}' ended with ${status}`);
}

for (const { name, scene, options = [], paper } of JSON.parse(readFileSync(join(root, "evaluation/report/recordings.json")))) {
  const frames = join(root, "out/recordings", name);
  // 1 says that the scene ended otherwise than it should, which may be what is to be shown.
  run(join(programs, scene), [...options, "--out", frames], (status) => status === 0 || status === 1);
  const file = join(folder, `${name}.gz`);
  run(bench, ["record", join(frames, `${scene}.pvd`), "--out", file, ...(paper ? ["--paper"] : [])], (status) => status === 0);
  console.log(`${file}: ${(statSync(file).size / 1e6).toFixed(2)} MB`);
}
