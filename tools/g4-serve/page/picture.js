// SPDX-License-Identifier: MIT
// Saves the picture as a PNG file.

const margin = 10;
const kept_ms = 60_000;

/**
 * @param {HTMLCanvasElement[]} layers  Of the same size, the lowest first.
 * @param {string} caption @param {string} colour  Of the caption. @param {number} ratio  Pixels per CSS pixel.
 */
function drawn(layers, caption, colour, ratio) {
  const canvas = document.createElement('canvas');
  canvas.width = layers[0].width;
  canvas.height = layers[0].height;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  for (const layer of layers) context.drawImage(layer, 0, 0);
  context.fillStyle = colour;
  context.font = `${12 * ratio}px system-ui, "DejaVu Sans", sans-serif`;
  context.fillText(caption, margin * ratio, canvas.height - margin * ratio);
  return canvas;
}

/**
 * @param {HTMLCanvasElement[]} layers @param {string} caption @param {string} colour @param {number} ratio
 * @param {string} name  Of the file.
 */
export function save_picture(layers, caption, colour, ratio, name) {
  drawn(layers, caption, colour, ratio).toBlob((blob) => {
    if (!blob) return;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), kept_ms);
  }, 'image/png');
}
