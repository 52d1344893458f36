// Settings as chart.csv writes them: names, colours, and the options as C code.

/** Colours of Okabe and Ito, as style.css has them for light and dark. */
export const colours = ["blue", "vermilion", "green", "orange", "purple", "sky"].map((name) => `var(--${name})`);
export const grey = "var(--grey)";
const [blue, vermilion, green, orange, purple, sky] = colours;

/** What has one colour and one shape; the first that fits counts. */
export const families = [
  { name: "ray lengths", colour: orange, symbol: "square", fits: (row) => row.method === "raycontact" && row.settings.includes("law=ray-length") },
  { name: "accuracy", colour: blue, symbol: "circle", fits: (row) => is(row, "sampling=(accuracy|automatic|tolerance)") },
  { name: "spacing", colour: green, symbol: "triangle", fits: (row) => is(row, "sampling=spacing") },
  { name: "vertices", colour: sky, symbol: "diamond", fits: (row) => is(row, "sampling=vertices") },
  { name: "the paper's mode", colour: purple, symbol: "star", fits: (row) => row.method === "paper" },
  { name: "Embree, Algorithm 1", colour: vermilion, symbol: "wye", fits: (row) => row.method.startsWith("embree") },
  { name: "Bullet", colour: grey, symbol: "cross", fits: (row) => row.method.startsWith("bullet") },
  { name: "FCL", colour: grey, symbol: "square", fits: (row) => row.method.startsWith("fcl") },
  { name: "proximity", colour: grey, symbol: "circle", fits: () => true },
];

function is(row, sampling) {
  return row.method === "raycontact" && row.settings.match(sampling) !== null;
}

export function family(row) {
  return families.find((family) => family.fits(row)).name;
}

/** What can be left out of the chart. */
export const variants = [
  { key: "single", name: "single precision", isShown: true, fits: (row) => isOurs(row) && row.settings.includes("precision=f32") },
  { key: "classic", name: "classic octree", isShown: false, fits: (row) => row.settings.includes("layout=classic") },
  { key: "no-edges", name: "without edges", isShown: false,
    fits: (row) => row.method === "raycontact" && row.settings.includes("edges=off") },
  { key: "ray-lengths", name: "ray lengths instead of pressure", isShown: true,
    fits: (row) => row.method === "raycontact" && row.settings.includes("law=ray-length") },
  { key: "weights", name: "the paper's weights", isShown: false,
    fits: (row) => row.method === "raycontact" && row.settings.includes("weights=paper") },
  { key: "others", name: "other programs", isShown: true, fits: (row) => !isOurs(row) },
];

function isOurs(row) {
  return row.method === "raycontact" || row.method === "paper";
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

/** C's; until an accuracy took its place, the sampling was automatic. */
const defaults = /^law=pressure sampling=(accuracy:0.01|automatic) precision=f64 layout=wide edges=on weights=area$/;

export function isDefault(row) {
  return row.method === "raycontact" && defaults.test(row.settings);
}

/** Errors that differ by less than a hundredth are alike, and so are times by less than three. */
const alike = { error: 0.99, time: 1.03 };

/** The rows that none beats in time without being worse, by time. Of rows alike in both, that with the fewest words. */
export function front(rows, measure) {
  const known = rows.filter((row) => measure.of(row) !== null);
  known.sort((a, b) => a.time_over_lower_bound - b.time_over_lower_bound || measure.of(a) - measure.of(b));
  const best = [];
  for (const row of known) {
    const last = best.at(-1);
    const isAsFast = last && row.time_over_lower_bound <= last.time_over_lower_bound * alike.time;
    const isBetter = !last || measure.of(row) < measure.of(last) * alike.error;
    const isSimpler = last && measure.of(row) * alike.error <= measure.of(last) && short(row).length < short(last).length;
    if (isAsFast && (isBetter || isSimpler)) best.pop();
    if (isBetter || (isAsFast && isSimpler)) best.push(row);
  }
  return best;
}

/** The settings as pairs of a name and a value. */
function settingsOf(row) {
  return Object.fromEntries(row.settings.split(" ").map((pair) => pair.split("=")));
}

/** In a few words: what is not said is as in the defaults. */
export function short(row) {
  const { law, sampling, precision, layout, edges, weights } = settingsOf(row);
  if (!isOurs(row)) return row.method + (row.settings.includes("weights=area") ? ", area weights" : "");
  const words = [row.method === "paper" ? "the paper's mode" : sampling.replace(":", " ")];
  if (precision === "f32") words.push("single");
  if (layout === "classic") words.push("classic");
  if (row.method === "raycontact" && law === "ray-length") words.push("ray lengths");
  if (row.method === "raycontact" && edges === "off") words.push("no edges");
  if (row.method === "raycontact" && weights === "paper") words.push("paper's weights");
  return words.join(", ");
}

/** The options in C; a comment for what is not the library. */
export function code(row) {
  if (!isOurs(row)) return `/* ${row.method}: not a setting of raycontact */\n`;
  const { law, sampling, precision, layout, edges, weights } = settingsOf(row);
  const isPaper = row.method === "paper";
  const lines = [
    "rayc_detection_options detection;",
    `rayc_${isPaper ? "paper" : "default"}_detection_options(sizeof detection, &detection);`,
  ];
  if (!isPaper) {
    const [kind, amount] = sampling.replace("automatic", "accuracy").replace("tolerance", "accuracy").split(":");
    if (/automatic|tolerance/.test(sampling)) lines.push(`/* measured with the sampling "${sampling}", of which an accuracy has taken the place */`);
    if (law === "ray-length") lines.push("detection.law = RAYC_LAW_RAY_LENGTH;");
    if (kind !== "accuracy") lines.push(`detection.sampling = RAYC_SAMPLING_${kind.toUpperCase()};`);
    if (amount && `${kind}:${amount}` !== "accuracy:0.01") lines.push(`detection.sampling_value = ${amount};${kind === "spacing" ? " /* in the scene's unit of length */" : ""}`);
    if (edges === "off") lines.push("detection.edges = 0;");
  }
  lines.push("rayc_response_options response;", "rayc_default_response_options(sizeof response, &response);");
  if (weights === "paper") lines.push("response.weighting = RAYC_WEIGHTING_VERTEX; /* stiffness in N/m */");
  lines.push(`/* meshes with precision ${precision === "f32" ? "RAYC_SCALAR_F32" : "RAYC_SCALAR_F64"} */`);
  if (layout === "classic") {
    lines.push("/* for rayc_query_pair; scenes have the fast tree */");
    lines.push("rayc_octree_options octree;", "rayc_default_octree_options(sizeof octree, &octree);");
    lines.push("octree.layout = RAYC_OCTREE_LAYOUT_CLASSIC;");
  }
  return lines.join("\n") + "\n";
}
