// Unpacks a recording: the format is described in evaluation/bench/src/record/pack.rs.

/** One frame after the other, positions and contacts in the scene's unit of length. */
export async function unpack(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const headerEnd = bytes.indexOf(10);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(0, headerEnd)));
  const table = tables(bytes, headerEnd + 1);
  const vertexCount = header.vertex_counts.reduce((sum, count) => sum + count, 0);
  const place = (numbers) => Float32Array.from(numbers, (number, i) => header.lower[i % 3] + number * header.unit);

  const corners = Uint32Array.from(table(3 * header.triangle_count, 3));
  let before = new Uint16Array(3 * vertexCount);
  const frames = header.times.map((time, frame) => {
    const moved = table(3 * vertexCount, 3);
    before = Uint16Array.from(moved, (difference, i) => difference + before[i]);
    return { time, positions: place(before), contacts: place(table(6 * header.contact_counts[frame], 6)) };
  });
  return { vertexCounts: header.vertex_counts, vertexCount, corners, frames };
}

/** Reads tables of 16-bit numbers, each the zigzagged difference from the one `stride` before, all low bytes first. */
function tables(bytes, start) {
  let at = start;
  return (count, stride) => {
    const values = new Uint16Array(count);
    for (let i = 0; i < count; ++i) {
      const zigzagged = bytes[at + i] | (bytes[at + count + i] << 8);
      const before = i < stride ? 0 : values[i - stride];
      values[i] = before + ((zigzagged >> 1) ^ -(zigzagged & 1));
    }
    at += 2 * count;
    return values;
  };
}
