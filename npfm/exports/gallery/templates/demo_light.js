// A light as textures: its radiance, and where its luminance comes before a row and a column.
const LUMINANCE = [0.2126, 0.7152, 0.0722];

async function lightOf(index) {
  const { rows, columns } = DATA.lights[index];
  const radiance = await floats(index);
  const { down, across, total } = cumulated(radiance, rows, columns);
  return {
    light: numbers(columns, rows, 3, radiance),
    down: numbers(rows + 1, 1, 2, down),
    across: numbers(columns + 1, rows, 1, across),
    total,
  };
}

function cumulated(radiance, rows, columns) {
  const across = new Float32Array((columns + 1) * rows), before = [0];
  const cosine = (row) => Math.sin(Math.PI / 2 - (row * Math.PI) / rows);
  for (let row = 0; row < rows; row++) {
    const sums = [0];
    for (let column = 0; column < columns; column++) {
      const at = 3 * (row * columns + column);
      sums.push(sums[column] + LUMINANCE.reduce((sum, share, c) => sum + share * radiance[at + c], 0));
    }
    across.set(sums.map((sum) => (sums[columns] ? sum / sums[columns] : 0)), row * (columns + 1));
    before.push(before[row] + (sums[columns] * (cosine(row) - cosine(row + 1)) * 2 * Math.PI) / columns);
  }
  const total = before[rows];
  const down = Float32Array.from({ length: 2 * (rows + 1) }, (_, k) => (k % 2 ? cosine((k - 1) / 2) : before[k / 2] / total));
  return { down, across, total };
}
