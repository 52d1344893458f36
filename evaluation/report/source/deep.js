// The open benchmark of deep contact, as its CSV files have it: a row of numbers for each library.

export const head = ["library", "come apart", "start apart, end well", "start deep, end well", "overlap rightly told", "vertices inside, missed",
  "direction, convex", "direction, concave", "time, concave"];

export function names(rows) {
  return [...new Set(rows.map((row) => row.library))];
}

function sum(rows, column) {
  return rows.reduce((total, row) => total + (row[column] ?? 0), 0);
}

/** Poses that a library refuses are not among those it is asked for. */
export function shareFreed(rows, library) {
  const own = rows.filter((row) => row.library === library);
  const [freed, of] = [sum(own, "freed"), sum(own, "poses") - sum(own, "refused")];
  return { freed, of, share: of > 0 ? (100 * freed) / of : -1 };
}

/** Of the kinds of poses that the page of the benchmark adds up. */
const kinds = ["shallow", "deep", "concentric", "coincident", "contained", "edges", "apart"];

/** What each column holds of a library: its text, and a number of which the least is best; null where there is none. */
const columns = [
  ({ free }, library) => {
    const { share, of } = shareFreed(free, library);
    return of > 0 ? { text: `${share.toPrecision(4)} %`, rank: -share } : null;
  },
  ...[false, true].map((isDeep) => ({ simulate }, library) => {
    const own = simulate.filter((row) => row.library === library && (row.scene === "part") === isDeep);
    const of = sum(own, "scenes") - sum(own, "refused");
    const share = (100 * sum(own, "done")) / of;
    return of > 0 ? { text: `${share.toPrecision(3)} %`, rank: -share } : null;
  }),
  ({ detect }, library) => {
    const own = detect.filter((row) => row.library === library && row.verdicts_right !== null && kinds.includes(row.kind));
    const of = sum(own, "poses") - sum(own, "refused");
    const share = (100 * sum(own, "verdicts_right")) / of;
    return of > 0 ? { text: `${share.toPrecision(4)} %`, rank: -share } : null;
  },
  ({ detect }, library) => {
    const own = detect.filter((row) => row.library === library && row.inside !== null);
    const [missed, inside] = [sum(own, "missed"), sum(own, "inside")];
    return inside > 0 ? { text: `${missed} of ${inside}`, rank: missed / inside } : null;
  },
  ...["convex", "concave"].map((shapes) => ({ measure }, library) => {
    const row = measure.find((row) => row.library === library && row.kind === "random" && row.shapes === shapes &&
      row.judge === "hydroelastic");
    return row && row.median !== null ? { text: `${row.median.toPrecision(2)}°`, rank: row.median } : null;
  }),
  ({ detect }, library) => {
    const row = detect.find((row) => row.library === library && row.kind === "deep" && row.shapes === "concave");
    return row && row.contacts_ratio !== null ? { text: row.contacts_ratio.toPrecision(2), rank: row.contacts_ratio } : null;
  },
];

/** Cells for a table, those that part the most poses first. */
export function ranking(data) {
  const libraries = names(data.free).sort((a, b) => shareFreed(data.free, b).share - shareFreed(data.free, a).share);
  const rows = libraries.map((library) => columns.map((column) => column(data, library)));
  const best = columns.map((_, i) => Math.min(...rows.map((row) => row[i]?.rank ?? Infinity)));
  return rows.map((row, n) => [{ text: libraries[n] },
    ...row.map((cell, i) => ({ text: cell?.text ?? "–", isBest: cell?.rank === best[i] }))]);
}
