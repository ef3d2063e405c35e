"""Pictures that the demo of the gallery renders in a browser, as numbers."""

import base64
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from browser import opened
from numpy.typing import NDArray

SCRIPT = """
state.running = false;
await ready;
const coded = (array) => {
  const bytes = Array.from(new Uint8Array(array.buffer), (byte) => String.fromCharCode(byte));
  return btoa(bytes.join(""));
};
const found = [];
for (const wanted of WANTED) {
  seed = wanted.seed;
  const plain = { light: [0, 0], figure: [0, 0], object: SPHERE, roughness: 0, right: NONE };
  Object.assign(state, plain, { size: SIDE });
  await choose(wanted.state);
  if (!byId("trouble").hidden) throw new Error(byId("trouble").textContent);
  while (pairs < PAIRS) pass(Math.min(64, PAIRS - pairs), [0.5, 0.5]);
  const sums = new Float32Array(4 * SIDE * SIDE);
  gl.bindFramebuffer(gl.FRAMEBUFFER, front.frame);
  gl.readPixels(0, 0, SIDE, SIDE, gl.RGBA, gl.FLOAT, sums);
  found.push(coded(sums.map((sum) => sum / PAIRS)));
}
return found;
"""


def pictures(
    page: Path,
    wanted: Sequence[tuple[Mapping[str, Any], int]],
    side: int,
    pairs: int,
    seconds: float = 120,
) -> list[NDArray[np.float64]]:
    """Render pictures, with rays through the centres of pixels as offline.

    Parameters
    ----------
    page : Path
        The demo.
    wanted : sequence of (mapping, int)
        Of each picture what is chosen in the page, and where the random numbers begin.
    side, pairs : int
        Pixels along one side, and pairs of light directions of each.
    seconds : float
        How long it may take.

    Returns
    -------
    list of ndarray, shape (side, side, 3)
        Linear radiance, row 0 at the top.
    """
    listed = json.dumps([{"state": dict(state), "seed": seed} for state, seed in wanted])
    given = f"const WANTED = {listed}, SIDE = {side}, PAIRS = {pairs};\n"
    coded = (base64.b64decode(text) for text in opened(page, given + SCRIPT, seconds=seconds))
    sums = (np.frombuffer(each, "<f4").reshape(side, side, 4) for each in coded)
    return [each[::-1, :, :3].astype(float) for each in sums]


def limit(made: Sequence[NDArray], reference: NDArray, seen: NDArray) -> float:
    """PSNR in dB that ever more samples lead to, of two pictures whose noise is independent.

    The mean product of their errors is that of what they have in common, which is no noise.
    """
    one, other = (picture[seen] - reference[seen] for picture in made)
    return float(10 * np.log10(reference[seen].max() ** 2 / abs(np.mean(one * other))))
