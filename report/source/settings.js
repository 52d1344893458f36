// Settings as chart.csv writes them: names, colours, and the options as C code.

/** What has one colour; the first that fits counts. */
export const families = [
  { name: "tolerance", colour: "#3b8fd0", fits: (row) => is(row, "sampling=tolerance") },
  { name: "spacing", colour: "#0b9c88", fits: (row) => is(row, "sampling=spacing") },
  { name: "automatic", colour: "#dd4422", fits: (row) => is(row, "sampling=automatic") },
  { name: "vertices", colour: "#ee8833", fits: (row) => is(row, "sampling=vertices") },
  { name: "the paper's mode", colour: "#7766cc", fits: (row) => row.method === "paper" },
  { name: "Embree, Algorithm 1", colour: "#c2489c", fits: (row) => row.method.startsWith("embree") },
  { name: "Bullet", colour: "#999933", fits: (row) => row.method.startsWith("bullet") },
  { name: "FCL", colour: "#808890", fits: (row) => row.method.startsWith("fcl") },
  { name: "proximity", colour: "#66bbdd", fits: () => true },
];

function is(row, sampling) {
  return row.method === "raycontact" && row.settings.startsWith(sampling);
}

export function family(row) {
  return families.find((family) => family.fits(row)).name;
}

export const measures = [
  { key: "force", name: "net force and torque", unit: "error, %", least: 0.01, of: (row) => percent(row.force_error) },
  { key: "missed", name: "vertices inside without a contact", unit: "missed, %", least: 0.01,
    of: (row) => percent(row.recall === null ? null : 1 - row.recall) },
  { key: "direction", name: "direction of the net force", unit: "degrees", least: 0.001,
    of: (row) => row.direction_error },
];

function percent(part) {
  return part === null ? null : part * 100;
}

const defaults = "sampling=automatic precision=f32 layout=wide edges=on weights=area";

export function isDefault(row) {
  return row.method === "raycontact" && row.settings === defaults;
}

/** The rows that none beats in time without being worse, by time. */
export function front(rows, measure) {
  const known = rows.filter((row) => measure.of(row) !== null);
  known.sort((a, b) => a.time_floor_multiple - b.time_floor_multiple || measure.of(a) - measure.of(b));
  let best = Infinity;
  return known.filter((row) => measure.of(row) < best && ((best = measure.of(row)), true));
}

/** The options in C; a comment for what is not the library. */
export function code(row) {
  if (row.method !== "raycontact" && row.method !== "paper") return `/* ${row.method}: not a setting of raycontact */\n`;
  const settings = Object.fromEntries(row.settings.split(" ").map((pair) => pair.split("=")));
  const [sampling, amount] = settings.sampling.split(":");
  const lines = [
    "rayc_detection_options detection;",
    "rayc_default_detection_options(sizeof detection, &detection);",
  ];
  if (sampling === "spacing") lines.push(`detection.sample_spacing = ${amount}; /* in the scene's unit of length */`);
  if (sampling === "vertices") lines.push("detection.sample_spacing = 0;");
  if (sampling === "tolerance") lines.push(`detection.force_tolerance = ${amount};`);
  if (settings.edges === "off") lines.push("detection.edges = 0;");
  if (row.method === "paper") lines.push("detection.escape = 0;");
  lines.push("rayc_response_options response;", "rayc_default_response_options(sizeof response, &response);");
  if (settings.weights === "paper") lines.push("response.weighting = RAYC_WEIGHTING_VERTEX; /* stiffness in N/m */");
  const precision = settings.precision === "f32" ? "RAYC_SCALAR_F32" : "RAYC_SCALAR_F64";
  lines.push(`/* meshes with precision ${precision} */`);
  if (settings.layout === "classic") lines.push("/* the classic octree: Octree::with_layout in Rust alone */");
  return lines.join("\n") + "\n";
}
