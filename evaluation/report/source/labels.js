// Names beside points: none on another, and a line to the point where there was no room beside it.
import * as Plot from "@observablehq/plot";

const height = 14;
const font = "11px system-ui, sans-serif";
const boldFont = "600 12px system-ui, sans-serif";
/** From the point to the label's near side: first close by, then farther. */
const distances = [9, 16, 26, 38, 52, 68, 86, 106, 128, 152, 178];
const directions = Array.from({ length: 16 }, (_, i) => (i * Math.PI) / 8);
/** Points nearer than this, in pixels, share a label. */
const alike = 4;
/** What it costs to cover a point, or to lead a line across a label, in pixels of distance. */
const covering = 60;
const crossing = 50;

/** A mark: the names of the rows, those of highest `rank` placed first and those of none in thin letters. Then calls `told`
 * with how many had no room. */
export function labels(rows, { x, y, text, rank, told }) {
  const render = (index, scales, values, dimensions) => {
    const points = groups(index, values, rows, text, rank);
    const group = svg("g", { "aria-hidden": "true", class: "labels" });
    const placed = place(points, dimensions);
    for (const { point, box, end } of placed) {
      if (Math.hypot(end[0] - point.x, end[1] - point.y) > 10) {
        group.append(svg("line", { x1: point.x, y1: point.y, x2: end[0], y2: end[1], stroke: "currentColor", "stroke-opacity": 0.35 }));
      }
      const style = `font: ${point.isFirst ? boldFont : font}`;
      const label = svg("text", { x: box.left, y: box.top + height - 3, "text-anchor": "start", style });
      label.textContent = point.text;
      group.append(label);
    }
    told(points.length - placed.length);
    return group;
  };
  return Plot.dot(rows, { x, y, render });
}

function svg(name, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** Points in one place become one, with the shortest name among those of the highest rank. */
function groups(index, { x, y }, rows, text, rank) {
  const order = Array.from(index).sort((a, b) => rank(rows[b]) - rank(rows[a]) || text(rows[a]).length - text(rows[b]).length);
  const found = [];
  for (const i of order) {
    const near = found.find((point) => Math.hypot(point.x - x[i], point.y - y[i]) < alike);
    if (near) near.count += 1;
    else found.push({ x: x[i], y: y[i], name: text(rows[i]), isFirst: rank(rows[i]) > 0, count: 1 });
  }
  const context = document.createElement("canvas").getContext("2d");
  for (const point of found) {
    point.text = point.count > 1 ? `${point.name} +${point.count - 1}` : point.name;
    context.font = point.isFirst ? boldFont : font;
    point.width = context.measureText(point.text).width + 2;
  }
  return found;
}

/** One after the other, each where it costs least. */
function place(points, { width, height: whole, marginLeft, marginRight, marginTop, marginBottom }) {
  const frame = { left: marginLeft, right: width - marginRight + 24, top: marginTop, bottom: whole - marginBottom };
  const dots = points.map(({ x, y }) => ({ left: x - 4, right: x + 4, top: y - 4, bottom: y + 4 }));
  const placed = [];
  for (const point of points) {
    let best = null;
    for (const distance of distances) {
      for (const angle of directions) {
        const found = candidate(point, distance, angle);
        if (!isWithin(found.box, frame) || placed.some((other) => overlap(other.box, found.box))) continue;
        const covered = dots.filter((dot) => overlap(dot, found.box)).length;
        const crossed = placed.filter((other) => crosses(point, found.end, other.box) || crosses(other.point, other.end, found.box)).length;
        const cost = distance + covering * covered + crossing * crossed;
        if (!best || cost < best.cost) best = { ...found, point, cost };
      }
      if (best && best.cost <= distance) break;
    }
    if (best) placed.push(best);
  }
  return placed;
}

function candidate(point, distance, angle) {
  const end = [point.x + distance * Math.cos(angle), point.y + distance * Math.sin(angle)];
  const across = Math.abs(Math.cos(angle)) < 0.1 ? 0.5 : Math.cos(angle) > 0 ? 0 : 1;
  const left = end[0] - across * point.width;
  const top = end[1] - height / 2;
  return { end, box: { left, right: left + point.width, top, bottom: top + height } };
}

function isWithin(box, frame) {
  return box.left >= frame.left && box.right <= frame.right && box.top >= frame.top && box.bottom <= frame.bottom;
}

function overlap(a, b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

/** Whether the line from a point to its label runs through another label. */
function crosses(point, end, box) {
  for (let part = 0.2; part < 1; part += 0.2) {
    const at = [point.x + part * (end[0] - point.x), point.y + part * (end[1] - point.y)];
    if (at[0] > box.left && at[0] < box.right && at[1] > box.top && at[1] < box.bottom) return true;
  }
  return false;
}
